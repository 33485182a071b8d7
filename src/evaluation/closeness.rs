//! Truth and tracks that never come near each other: most often their units or their origins differ, and every metric is at its
//! worst without a word.

use super::comparison::{Comparison, Presence, Shape, Step};

/// A warning where a step has both, and no pair of any step is within the gate.
pub fn warning(comparison: &Comparison) -> Option<String> {
    let is_any_near = comparison.steps.iter().any(|step| comparison.matchable(step).next().is_some());
    if is_any_near || comparison.shape == Shape::Boxes {
        return None;
    }
    let nearest = comparison.steps.iter().filter_map(|step| nearest_of(comparison, step)).reduce(f64::min)?;
    let unit = if comparison.shape == Shape::Bearings { "degrees" } else { "m" };
    Some(format!(
        "truth and tracks are never nearer than {} {unit}, and the gate is {} {unit}: nothing is ever matched; are their units and \
         origins the same?",
        two_digits(nearest),
        comparison.gate
    ))
}

/// The least distance of a truth and a track of a step.
fn nearest_of(comparison: &Comparison, step: &Step) -> Option<f64> {
    let truths = &comparison.truths[step.truths.clone()];
    let mut tracks: Vec<&Presence> = comparison.tracks[step.tracks.clone()].iter().collect();
    tracks.sort_by(|left, right| left.position_m[0].total_cmp(&right.position_m[0]));
    let mut nearest = None;
    for truth in truths {
        for turn in comparison.shape.turns() {
            let x = truth.position_m[0] + turn;
            let middle = tracks.partition_point(|track| track.position_m[0] < x);
            look(comparison.shape, truth, x, tracks[middle..].iter().copied(), &mut nearest);
            look(comparison.shape, truth, x, tracks[..middle].iter().rev().copied(), &mut nearest);
        }
    }
    nearest
}

/// Goes away from x until nothing farther on can be nearer.
fn look<'a>(shape: Shape, truth: &Presence, x: f64, tracks: impl Iterator<Item = &'a Presence>, nearest: &mut Option<f64>) {
    for track in tracks {
        if nearest.is_some_and(|nearest| (track.position_m[0] - x).abs() >= nearest) {
            return;
        }
        let distance = shape.distance(&truth.position_m, &track.position_m);
        *nearest = Some(nearest.map_or(distance, |nearest: f64| nearest.min(distance)));
    }
}

/// `2200` for 2214.7: how far is said roughly.
fn two_digits(distance: f64) -> f64 {
    format!("{distance:.1e}").parse().unwrap_or(distance)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::state::Position;

    fn comparison(truths: &[[f64; 2]], tracks: &[[f64; 2]], shape: Shape) -> Comparison {
        let presence =
            |(id, at): (usize, &[f64; 2])| Presence { id: id as u32, position_m: Position::from(*at), velocity_mps: None, point: 0 };
        let mut comparison = Comparison {
            shape,
            gate: 10.0,
            truth_ids: Vec::new(),
            track_ids: Vec::new(),
            steps: Vec::new(),
            truths: Vec::new(),
            tracks: Vec::new(),
            pairs: Vec::new(),
            warnings: Vec::new(),
        };
        let listed = |places: &[[f64; 2]]| places.iter().enumerate().map(presence).collect();
        comparison.push_step(0.0, listed(truths), listed(tracks), |_, _, _| {});
        comparison
    }

    #[test]
    fn how_near_they_come_is_said() {
        // Nearest: (1000, 2000) and (1, 2): √(999² + 1998²) = 2 233.8.
        let told = warning(&comparison(&[[1000.0, 2000.0], [1030.0, 2000.0]], &[[1.0, 2.0], [-5.0, 0.0]], Shape::Points)).unwrap();
        assert!(told.starts_with("truth and tracks are never nearer than 2200 m, and the gate is 10 m:"), "{told}");
        let across_north = warning(&comparison(&[[350.0, 0.0]], &[[15.0, 0.0], [300.0, 0.0]], Shape::Bearings)).unwrap();
        assert!(across_north.contains("than 25 degrees"), "{across_north}");
    }

    #[test]
    fn the_nearest_of_many_is_that_of_brute_force() {
        let places = |factor: f64, shift: f64| -> Vec<[f64; 2]> {
            (0..60)
                .map(|index| [(f64::from(index) * factor).sin() * 500.0 + shift, (f64::from(index) * factor * 1.7).cos() * 900.0])
                .collect()
        };
        let (truths, tracks) = (places(1.3, 0.0), places(2.1, 1500.0));
        let compared = comparison(&truths, &tracks, Shape::Points);
        let brute = truths.iter().flat_map(|a| tracks.iter().map(move |b| (a[0] - b[0]).hypot(a[1] - b[1]))).fold(f64::INFINITY, f64::min);
        assert!((nearest_of(&compared, &compared.steps[0]).unwrap() - brute).abs() < 1e-9);
    }

    #[test]
    fn nothing_is_said_of_one_side_alone() {
        assert_eq!(warning(&comparison(&[], &[[1.0, 2.0]], Shape::Points)), None);
    }
}
