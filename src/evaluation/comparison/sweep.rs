//! The pairs of a step that are within reach: for each truth the tracks whose x is near enough are looked at, at every turn.

use super::{Presence, presence_after, turns};
use crate::evaluation::extent::Extent;
use crate::evaluation::paths::Paths;
use crate::model::space::{Place, Space};

type Lists<'l> = (&'l [Presence], &'l [Presence]);
type Found<'f> = &'f mut dyn FnMut(usize, usize, f64, f64);

/// What is looked for.
pub(super) struct Sweep<'s, 't> {
    pub paths: &'s Paths<'t>,
    pub space: Space,
    pub gate_m: f64,
    pub reach_m: f64,
}

/// All tracks are at the time of the step.
pub(super) fn near_pairs(
    (truths, tracks): Lists,
    sweep: &Sweep,
    extent: &mut Extent,
    found: Found,
) {
    let (mut pairs, mut looked_at) = (0, 0);
    let by_x = sorted_by_x(tracks);
    for (truth, place) in truths.iter().enumerate() {
        for turn in turns(Some(sweep.space)) {
            let position_m = place.position_m + Place::new(*turn, 0.0, 0.0);
            let from = by_x.partition_point(|&(x_m, _)| x_m < position_m.x - sweep.reach_m);
            for &(x_m, track) in &by_x[from..] {
                if x_m > position_m.x + sweep.reach_m {
                    break;
                }
                looked_at += 1;
                let distance_m = (tracks[track].position_m - position_m).norm();
                pairs += sweep.tell((truth, track), distance_m, found);
            }
        }
        // One truth has no more pairs than there are tracks.
        if !extent.goes_on_with(pairs, 4 * std::mem::take(&mut looked_at)) {
            return;
        }
    }
}

fn sorted_by_x(tracks: &[Presence]) -> Vec<(f64, usize)> {
    let places = tracks.iter().enumerate();
    let mut by_x: Vec<(f64, usize)> = places
        .map(|(index, track)| (track.position_m.x, index))
        .collect();
    by_x.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    by_x
}

impl Sweep<'_, '_> {
    /// Tells a pair within reach; how many that are.
    fn tell(&self, (truth, track): (usize, usize), distance_m: f64, found: Found) -> usize {
        if distance_m > self.reach_m {
            return 0;
        }
        let similarity = (1.0 - distance_m / (2.0 * self.gate_m)).max(0.0);
        found(truth, track, distance_m, similarity);
        1
    }

    /// Tracks are `after_s` later than the step, within its window.
    pub(super) fn own_time_pairs(
        &self,
        (truths, tracks): Lists,
        (step_s, after_s): (f64, &[f64]),
        window_s: (f64, f64),
        extent: &mut Extent,
        found: Found,
    ) {
        let (mut pairs, mut looked_at) = (0, 0);
        let by_x = sorted_by_x(tracks);
        for (truth, target) in truths.iter().enumerate() {
            let (least_m, most_m) = self.span_of_x(target, step_s, window_s);
            let from = by_x.partition_point(|&(x_m, _)| x_m < least_m - self.reach_m);
            for &(x_m, track) in &by_x[from..] {
                if x_m > most_m + self.reach_m {
                    break;
                }
                looked_at += 1;
                let times_s = (step_s, after_s[track]);
                let beside = presence_after(self.paths, self.space, target, times_s);
                let distance_m = self.distance(&beside.position_m, &tracks[track].position_m);
                pairs += self.tell((truth, track), distance_m, found);
            }
            if !extent.goes_on_with(pairs, 8 * std::mem::take(&mut looked_at)) {
                return;
            }
        }
    }

    fn distance(&self, left: &Place, right: &Place) -> f64 {
        let shortest =
            |least: f64, turn: &f64| least.min((left + Place::new(*turn, 0.0, 0.0) - right).norm());
        turns(Some(self.space)).iter().fold(f64::INFINITY, shortest)
    }

    /// Between which values of x a target is during the window of a step; directions may be anywhere.
    fn span_of_x(&self, target: &Presence, step_s: f64, (from_s, to_s): (f64, f64)) -> (f64, f64) {
        if self.space == Space::Bearing {
            return (f64::NEG_INFINITY, f64::INFINITY);
        }
        let x_at = |after_s: f64| {
            let moved = presence_after(self.paths, self.space, target, (step_s, after_s));
            moved.position_m.x
        };
        let mut span = (target.position_m.x, target.position_m.x);
        let points = &self.paths.targets()[target.id as usize].points;
        let first = points.partition_point(|point| point.time_s < from_s);
        let inside = points[first..]
            .iter()
            .take_while(|point| point.time_s <= to_s);
        let ends = [x_at(from_s - step_s), x_at(to_s - step_s)];
        for x_m in ends.into_iter().chain(inside.map(|point| point.position.x)) {
            span = (span.0.min(x_m), span.1.max(x_m));
        }
        span
    }
}
