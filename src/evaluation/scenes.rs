//! Small scenes for the tests of this folder: truths and tracks on a line, compared at steps one second apart.

use super::EvaluationInput;
use super::comparison::{Alignment, Comparison, PointSettings};
use crate::model::state::{Position, State};
use crate::model::track::{Track, TrackPoint, TrackSet};
use crate::model::truth::{Target, TruthPoint, TruthSet};

/// The place of somebody at each step; NaN where he does not exist.
pub type Places<'a> = (&'a str, &'a [f64]);

pub const GONE: f64 = f64::NAN;

fn seen<'a>(places: &'a [f64]) -> impl Iterator<Item = (f64, f64)> + use<'a> {
    places.iter().enumerate().filter(|(_, x_m)| !x_m.is_nan()).map(|(step, &x_m)| (step as f64, x_m))
}

pub fn truth_of(truths: &[Places]) -> TruthSet {
    let point = |(time_s, x_m)| TruthPoint { time_s, position_m: Position::new(x_m, 0.0), velocity_mps: None };
    let target = |(id, places): &Places| Target { truth_id: (*id).to_owned(), points: seen(places).map(point).collect() };
    TruthSet::new(truths.iter().map(target).collect()).unwrap()
}

pub fn tracks_of(tracks: &[Places]) -> TrackSet {
    let point = |(time_s, x_m)| TrackPoint {
        time_s,
        sensor: None,
        state: State::new(x_m, 0.0, 0.0, 0.0),
        has_velocity: false,
        covariance: None,
        status: None,
        first_candidate: 0,
        candidates: 0,
    };
    let track = |(id, places): &Places| Track { track_id: (*id).to_owned(), points: seen(places).map(point).collect() };
    TrackSet { tracks: tracks.iter().map(track).collect(), ..Default::default() }
}

/// Compares within a gate; pairs are listed up to twice the gate.
pub fn compare(truths: &[Places], tracks: &[Places], gate_m: f64) -> Comparison {
    let (truth, tracks) = (truth_of(truths), tracks_of(tracks));
    let input = EvaluationInput { recording: None, truth: Some(&truth), tracks: &tracks };
    let alignment = Alignment::Interpolate { max_gap_s: 0.0 };
    Comparison::of_points(&input, &truth, &PointSettings { alignment, gate_m, reach_m: 2.0 * gate_m })
}
