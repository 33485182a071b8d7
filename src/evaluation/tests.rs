//! Small scenes for the tests of this folder: truths and tracks on a line, compared at steps one second apart.

use super::EvaluationInput;
use super::comparison::{Comparison, PointSettings};
use super::credit::Credit;
use super::events::EventLog;
use super::metrics::{METRICS, Metric, MetricReport, Sequence};
use super::paths::Alignment;
use super::steps::StepSettings;
use crate::model::space::Space;
use crate::model::state::{Position, State};
use crate::model::track::{Kinematics, Track, TrackPoint, TrackSet};
use crate::model::truth::{Target, TruthPoint, TruthSet};
use crate::registry;

/// The place of somebody at each step; NaN where he does not exist.
pub type Places<'a> = (&'a str, &'a [f64]);

/// A track's name, its first step, and its places in the plane.
type Path<'a> = (&'a str, f64, &'a [(f64, f64)]);

pub const GONE: f64 = f64::NAN;

fn seen<'a>(places: &'a [f64]) -> impl Iterator<Item = (f64, f64)> + use<'a> {
    places
        .iter()
        .enumerate()
        .filter(|(_, x_m)| !x_m.is_nan())
        .map(|(step, &x_m)| (step as f64, x_m))
}

pub fn truth_of(truths: &[Places]) -> TruthSet {
    let point = |(time_s, x_m)| TruthPoint::in_plane(time_s, Position::new(x_m, 0.0), None);
    let target = |(id, places): &Places| Target {
        truth_id: (*id).to_owned(),
        points: seen(places).map(point).collect(),
    };
    TruthSet::new(Space::Plane, truths.iter().map(target).collect()).unwrap()
}

fn place(x_m: f64, y_m: f64) -> Kinematics {
    Kinematics::of_plane(&State::new(x_m, y_m, 0.0, 0.0), false, None)
}

pub fn tracks_of(tracks: &[Places]) -> TrackSet {
    let point = |(time_s, x_m)| TrackPoint {
        height_m: None,
        time_s,
        sensor: None,
        estimate: place(x_m, 0.0),
        status: None,
        nis: None,
        known_at_s: None,
        existence: None,
        mode_row: None,
        first_candidate: 0,
        candidates: 0,
    };
    let track = |(id, places): &Places| Track {
        track_id: (*id).to_owned(),
        points: seen(places).map(point).collect(),
    };
    TrackSet {
        tracks: tracks.iter().map(track).collect(),
        ..Default::default()
    }
}

/// Compares within a gate; pairs are listed up to twice the gate.
pub fn compare(truths: &[Places], tracks: &[Places], gate_m: f64) -> Comparison {
    let (truth, tracks) = (truth_of(truths), tracks_of(tracks));
    compare_sets(&truth, &tracks, gate_m)
}

fn compare_sets(truth: &TruthSet, tracks: &TrackSet, gate_m: f64) -> Comparison {
    let input = EvaluationInput {
        recording: None,
        truth: Some(truth),
        tracks,
    };
    let alignment = Alignment::Interpolate {
        max_gap_s: Some(0.0),
    };
    Comparison::of_points(
        &input,
        truth,
        &PointSettings {
            alignment,
            gate_m,
            reach_m: 2.0 * gate_m,
            steps: StepSettings::default(),
            credit: Credit::Afterwards,
        },
    )
}

/// A metric of the table with these parameters, on comparisons as so many sequences.
pub fn evaluate(
    name: &str,
    parameters: serde_json::Value,
    comparisons: &[Comparison],
) -> MetricReport {
    let method = METRICS.iter().find(|method| method.name == name).unwrap();
    let metric: Box<dyn Metric> =
        (method.build)(&registry::check(&parameters, method.parameters).unwrap()).unwrap();
    let logs: Vec<EventLog> = comparisons.iter().map(EventLog::new).collect();
    let sequence = |(comparison, events)| Sequence {
        comparison,
        events,
        input: None,
    };
    metric.evaluate(
        &comparisons
            .iter()
            .zip(&logs)
            .map(sequence)
            .collect::<Vec<_>>(),
    )
}

/// Checks quantities of a report; `None` must come with a reason.
pub fn assert_quantities(report: &MetricReport, expected: &[(&str, Option<f64>)]) {
    for &(name, value) in expected {
        let found = report
            .quantities
            .iter()
            .find(|quantity| quantity.name == name)
            .unwrap_or_else(|| panic!("no quantity {name}"));
        match (found.value, value) {
            (Some(found), Some(value)) => assert!(
                (found - value).abs() < 1e-12,
                "{name} is {found}, not {value}"
            ),
            (found, value) => assert_eq!(found, value, "{name}"),
        }
        assert_eq!(found.reason.is_none(), found.value.is_some(), "{name}");
    }
}

/// The numbers of one truth or one track.
pub fn line(lines: &[super::metrics::Line], id: &str) -> Vec<(&'static str, Option<f64>)> {
    let line = lines.iter().find(|line| line.id == id).unwrap();
    line.quantities
        .iter()
        .map(|quantity| (quantity.name, quantity.value))
        .collect()
}

/// The scene `main` of the reference: T1 and T3 on A, T2 on B with one error of exactly 10 m, T4 false.
pub fn main_scene(gate_m: f64) -> Comparison {
    let truth = [(0, "A", 0.0, 10), (2, "B", 50.0, 8)];
    let target = |(from, id, y_m, count): (u32, &str, f64, u32)| {
        let point = |step| {
            TruthPoint::in_plane(
                f64::from(step),
                Position::new(10.0 * f64::from(step), y_m),
                None,
            )
        };
        Target {
            truth_id: id.to_owned(),
            points: (from..from + count).map(point).collect(),
        }
    };
    let tracks: [Path; 4] = [
        (
            "T1",
            0.0,
            &[
                (1.0, 2.0),
                (9.0, 1.0),
                (20.5, -1.5),
                (32.0, 0.0),
                (39.5, 0.5),
                (51.0, -1.0),
            ],
        ),
        (
            "T2",
            3.0,
            &[
                (28.0, 51.0),
                (41.0, 51.0),
                (50.0, 48.0),
                (63.0, 54.0),
                (64.0, 58.0),
                (80.5, 50.5),
                (89.0, 50.0),
            ],
        ),
        ("T3", 7.0, &[(70.0, -3.0), (80.0, -3.0), (90.0, -3.0)]),
        ("T4", 4.0, &[(200.0, 200.0), (205.0, 200.0), (210.0, 200.0)]),
    ];
    in_the_plane(truth.map(target).to_vec(), &tracks, gate_m)
}

/// The scene `swap` of the reference: two crossing targets, identities exchanged after 5 s.
pub fn swap_scene(gate_m: f64) -> Comparison {
    let target = |(id, sign): (&str, f64)| {
        let position = |step: u32| {
            Position::new(
                10.0 * f64::from(step),
                sign * (5.0 * f64::from(step) - 27.0),
            )
        };
        let point = |step| TruthPoint::in_plane(f64::from(step), position(step), None);
        Target {
            truth_id: id.to_owned(),
            points: (0..11).map(point).collect(),
        }
    };
    let followed = |sign: f64, error_m: f64| -> Vec<(f64, f64)> {
        let y_m =
            |step: u32| sign * (5.0 * f64::from(step) - 27.0) * if step > 5 { -1.0 } else { 1.0 };
        (0..11)
            .map(|step| (10.0 * f64::from(step) + error_m, y_m(step)))
            .collect()
    };
    let (one, two) = (followed(1.0, 1.0), followed(-1.0, -0.5));
    in_the_plane(
        [("A", 1.0), ("B", -1.0)].map(target).to_vec(),
        &[("S1", 0.0, &one), ("S2", 0.0, &two)],
        gate_m,
    )
}

fn in_the_plane(targets: Vec<Target>, tracks: &[Path], gate_m: f64) -> Comparison {
    let truth = TruthSet::new(Space::Plane, targets).unwrap();
    let mut set = tracks_of(
        &tracks
            .iter()
            .map(|&(id, _, _)| (id, &[][..]))
            .collect::<Vec<_>>(),
    );
    let like = tracks_of(&[("", &[0.0])]).tracks[0].points[0].clone();
    for (track, (_, start_s, places)) in set.tracks.iter_mut().zip(tracks) {
        let point = |(step, &(x_m, y_m)): (usize, &(f64, f64))| TrackPoint {
            height_m: None,
            time_s: start_s + step as f64,
            estimate: place(x_m, y_m),
            ..like.clone()
        };
        track.points = places.iter().enumerate().map(point).collect();
    }
    compare_sets(&truth, &set, gate_m)
}

#[test]
fn places_in_a_volume_are_apart_by_all_axes() {
    let truth = truth_of(&[("A", &[0.0, 3.0])]);
    let truth = TruthSet::new(Space::Volume, truth.targets().to_vec()).unwrap();
    let mut tracks = tracks_of(&[("T", &[30.0, 33.0])]);
    tracks.space = Space::Volume;
    for point in &mut tracks.tracks[0].points {
        point.estimate.position.z = 40.0;
    }
    let comparison = compare_sets(&truth, &tracks, 60.0);
    let distances: Vec<f64> = comparison.pairs.iter().map(|pair| pair.distance).collect();
    assert_eq!(distances, [50.0, 50.0]);
    let in_plane = tracks_of(&[("T", &[30.0, 33.0])]);
    let comparison = compare_sets(&truth, &in_plane, 60.0);
    let distances: Vec<f64> = comparison.pairs.iter().map(|pair| pair.distance).collect();
    assert_eq!(
        (comparison.space, distances),
        (Some(Space::Plane), vec![30.0; 2])
    );
    assert_eq!(comparison.warnings.len(), 1, "that heights are left out");
}
