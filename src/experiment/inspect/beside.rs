//! What was seen beside the truth: whether the two meet in time and place at all.

use super::clocks::{hours, shifts_s};
use super::places_with_times;
use crate::experiment::input::move_truth;
use crate::model::dataset::Dataset;
use crate::model::state::Position;
use crate::model::truth::TruthSet;

/// Places that are looked at; more tell no more.
const MOST_PLACES: usize = 2000;
/// Silence of a target across which its way is taken for straight (s).
const MAX_GAP_S: f64 = 600.0;
/// How near a place is to be to a target: so much of the way across the truth, and at least so much (m).
const NEAR: f64 = 0.05;
const LEAST_NEAR_M: f64 = 1.0;
/// The share of places near targets above which a shift of the clock explains them.
const EXPLAINED: f64 = 0.1;

/// A sentence for each thing that seems wrong of a set of detections or tracks and its truth.
pub fn suspicions(dataset: &Dataset, truth: &TruthSet) -> Vec<String> {
    let mut truth = truth.clone();
    match (dataset.frame(), truth.frame) {
        (Some(frame), Some(_)) if move_truth(&mut truth, frame).is_err() => return Vec::new(),
        (None, Some(_)) => return vec![one_origin("truth", "file")],
        (Some(_), None) => return vec![one_origin("file", "truth")],
        _ => {}
    }
    let seen = sampled(dataset);
    if seen.is_empty() || truth.targets().is_empty() || !truth.space().has_places() {
        return Vec::new();
    }
    let near_m = (NEAR * across_m(&truth)).max(LEAST_NEAR_M);
    let share = |shift_s: f64| share_near(&seen, &truth, (near_m, shift_s));
    if share(0.0) > 0.0 {
        return Vec::new();
    }
    let best = shifts_s()
        .map(|shift_s| (shift_s, share(shift_s)))
        .max_by(|a, b| a.1.total_cmp(&b.1).then(b.0.abs().total_cmp(&a.0.abs())));
    vec![match best {
        Some((shift_s, share)) if share > EXPLAINED => format!(
            "nothing lies near the truth as its times are, {:.0} % does {} {}: `clock_offset_s` {shift_s} reads the file so",
            100.0 * share,
            hours(shift_s),
            if shift_s > 0.0 { "later" } else { "earlier" }
        ),
        _ if !meet(&seen, &truth) => "the file and the truth have no time in common".to_owned(),
        _ => format!(
            "nothing ever lies within {near_m:.0} m of the truth: are the two in the same units, from the same origin?"
        ),
    }]
}

fn one_origin(with: &str, without: &str) -> String {
    format!("the {with} has an origin on the Earth, the {without} has none: `origin` says it")
}

/// Times (s) and places (m), evenly of all.
fn sampled(dataset: &Dataset) -> Vec<(f64, Position)> {
    let all = places_with_times(dataset);
    let step = all.len().div_ceil(MOST_PLACES).max(1);
    all.into_iter().step_by(step).collect()
}

/// From one corner of the box around the truth to the other.
fn across_m(truth: &TruthSet) -> f64 {
    let mut points = truth.targets().iter().flat_map(|target| &target.points);
    let Some(first) = points.next().map(|point| point.position.xy()) else {
        return 0.0;
    };
    let (mut least, mut most) = (first, first);
    for point in points {
        least = least.inf(&point.position.xy());
        most = most.sup(&point.position.xy());
    }
    (most - least).norm()
}

/// How many of what was seen lie near a target, with their times shifted.
fn share_near(seen: &[(f64, Position)], truth: &TruthSet, (near_m, shift_s): (f64, f64)) -> f64 {
    let is_near = |&&(time_s, place_m): &&(f64, Position)| {
        truth.targets().iter().any(|target| {
            let at = target.position_at(truth.space(), time_s + shift_s, MAX_GAP_S);
            at.is_some_and(|at| (at.xy() - place_m).norm() < near_m)
        })
    };
    seen.iter().filter(is_near).count() as f64 / seen.len() as f64
}

/// Whether they have some time in common.
fn meet(seen: &[(f64, Position)], truth: &TruthSet) -> bool {
    truth.targets().iter().any(|target| {
        let span = target.points.first().zip(target.points.last());
        span.is_some_and(|(first, last)| {
            seen.iter()
                .any(|(time_s, _)| (first.time_s..=last.time_s).contains(time_s))
        })
    })
}
