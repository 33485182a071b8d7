//! How near truth and tracks ever come, where they never come near: the least distance at one time, and the shift of their clocks
//! that would bring them together.
//!
//! # Method
//! 1. The least distance: at each step a sweep along x, no farther than the least so far.
//! 2. The shift: for some points of the tracks the nearest place on any target's path, at whatever time. Where at least half of the
//!    points are within the gate there, and half of all need the same shift, give or take a usual gap of the truth, that is it.

use super::comparison::{Comparison, Presence};
use crate::model::space::{Place, Space};
use crate::model::track::TrackSet;
use crate::model::truth::{TruthPoint, TruthSet};

/// Points of tracks that are looked at for a shift.
const SAMPLES: usize = 64;
/// With more points of truth no shift is looked for.
const MAX_TRUTH_POINTS: usize = 100_000;

/// The least distance of a truth and a track that exist at one step; infinite where there is no such step.
pub fn least_distance(comparison: &Comparison) -> f64 {
    let mut least = f64::INFINITY;
    for step in &comparison.steps {
        let mut tracks: Vec<&Presence> = comparison.tracks[step.tracks.clone()].iter().collect();
        tracks.sort_by(|left, right| left.position_m.x.total_cmp(&right.position_m.x));
        for truth in &comparison.truths[step.truths.clone()] {
            let from = tracks.partition_point(|track| track.position_m.x < truth.position_m.x);
            for sweep in [
                &mut tracks[from..].iter() as &mut dyn Iterator<Item = _>,
                &mut tracks[..from].iter().rev(),
            ] {
                for track in sweep {
                    if (track.position_m.x - truth.position_m.x).abs() >= least {
                        break;
                    }
                    least = least.min((track.position_m - truth.position_m).norm());
                }
            }
        }
    }
    least
}

/// By how much the times of the tracks would have to be later for the tracks to be within `gate_m` of the truth (s), both in
/// `space`.
pub fn clock_shift_s(
    truth: &TruthSet,
    tracks: &TrackSet,
    space: Space,
    gate_m: f64,
) -> Option<f64> {
    let segments: Vec<&[TruthPoint]> = truth
        .targets()
        .iter()
        .flat_map(|target| target.points.windows(2))
        .collect();
    let points: Vec<(f64, Place)> = tracks
        .tracks
        .iter()
        .flat_map(|track| &track.points)
        .map(|point| (point.time_s, space.cut(point.estimate.position)))
        .collect();
    if segments.is_empty() || segments.len() > MAX_TRUTH_POINTS {
        return None;
    }
    let sampled: Vec<_> = points
        .iter()
        .step_by(points.len().div_ceil(SAMPLES).max(1))
        .collect();
    let mut shifts_s: Vec<f64> = sampled
        .iter()
        .filter_map(|(time_s, at_m)| Some(nearest_time_s(&segments, space, at_m, gate_m)? - time_s))
        .collect();
    shifts_s.sort_unstable_by(f64::total_cmp);
    let middle_s = *shifts_s.get(shifts_s.len() / 2)?;
    let mut gaps_s: Vec<f64> = segments
        .iter()
        .map(|pair| pair[1].time_s - pair[0].time_s)
        .collect();
    gaps_s.sort_unstable_by(f64::total_cmp);
    let agreeing = shifts_s
        .iter()
        .filter(|shift_s| (*shift_s - middle_s).abs() <= gaps_s[gaps_s.len() / 2])
        .count();
    (2 * agreeing >= sampled.len() && sampled.len() > 2).then_some(middle_s)
}

/// When a target is nearest to a place, if it comes within the gate.
fn nearest_time_s(
    segments: &[&[TruthPoint]],
    space: Space,
    at_m: &Place,
    gate_m: f64,
) -> Option<f64> {
    let mut best = (gate_m, None);
    for pair in segments {
        let from_m = space.cut(pair[0].position);
        let along_m = space.cut(pair[1].position) - from_m;
        let share = if along_m.norm_squared() > 0.0 {
            ((at_m - from_m).dot(&along_m) / along_m.norm_squared()).clamp(0.0, 1.0)
        } else {
            0.0
        };
        let distance_m = (from_m + along_m * share - at_m).norm();
        if distance_m < best.0 || (distance_m == gate_m && best.1.is_none()) {
            best = (
                distance_m,
                Some(pair[0].time_s + share * (pair[1].time_s - pair[0].time_s)),
            );
        }
    }
    best.1
}

#[cfg(test)]
mod tests {
    use super::super::tests::{GONE, compare, tracks_of, truth_of};
    use super::*;

    #[test]
    fn the_least_distance_is_over_all_steps_and_both_sides() {
        let comparison = compare(
            &[("A", &[0.0, 100.0]), ("B", &[GONE, 40.0])],
            &[("T", &[30.0, 47.0]), ("U", &[-20.0, 500.0])],
            1.0,
        );
        assert_eq!(least_distance(&comparison), 7.0);
        assert_eq!(
            least_distance(&compare(
                &[("A", &[0.0, GONE])],
                &[("T", &[GONE, 0.0])],
                1.0
            )),
            f64::INFINITY
        );
    }

    #[test]
    fn tracks_that_are_late_need_an_earlier_clock() {
        // 10 m a step along x; the track is where the target was three steps before.
        let path: Vec<f64> = (0..20).map(|step| 10.0 * f64::from(step)).collect();
        let late: Vec<f64> = path.iter().map(|x| x - 30.0).collect();
        let (truth, tracks) = (truth_of(&[("A", &path)]), tracks_of(&[("T", &late)]));
        assert_eq!(
            clock_shift_s(&truth, &tracks, Space::Plane, 5.0),
            Some(-3.0)
        );
        let away: Vec<f64> = path.iter().map(|x| x + 1e6).collect();
        assert_eq!(
            clock_shift_s(&truth, &tracks_of(&[("T", &away)]), Space::Plane, 5.0),
            None
        );
    }
}
