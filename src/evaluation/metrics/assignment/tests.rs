//! Assignment, divergence and swaps of scenes worked by hand.

use super::*;
use crate::evaluation::metrics::Line;
use crate::evaluation::tests::{
    GONE, assert_quantities, compare, evaluate, line, main_scene, swap_scene,
};

fn numbers(lines: &[Line], id: &str) -> Vec<f64> {
    line(lines, id)
        .into_iter()
        .map(|(_, value)| value.unwrap_or(f64::INFINITY))
        .collect()
}

#[test]
fn the_main_scene_by_hand() {
    let report = evaluate("assignment", json!({}), &[main_scene(10.0)]);
    // A is there at 0..=9, established at once, broken at 6. B is there at 2..=9, established at 3.
    assert_eq!(
        numbers(&report.per_truth, "A"),
        [10.0, 1.0, 0.0, 1.0, 1.0, 0.9]
    );
    assert_eq!(
        numbers(&report.per_truth, "B"),
        [8.0, 1.0, 1.0, 0.0, 0.0, 7.0 / 8.0]
    );
    assert_eq!(
        numbers(&report.per_track, "T4"),
        [3.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 3.0]
    );
    assert_quantities(
        &report,
        &[
            ("associated_share", Some(16.0 / 18.0)),
            ("mean_establishment_length", Some(0.5)),
        ],
    );
    assert_quantities(
        &report,
        &[
            ("false_tracks", Some(1.0)),
            ("breaks", Some(1.0)),
            ("swaps", Some(0.0)),
            ("truths_established", Some(2.0)),
        ],
    );
}

#[test]
fn crossing_tracks_swap() {
    let report = evaluate("assignment", json!({}), &[swap_scene(10.0)]);
    assert_quantities(
        &report,
        &[
            ("swaps", Some(2.0)),
            ("divergences", Some(2.0)),
            ("divergence_length", Some(0.0)),
            ("breaks", Some(0.0)),
        ],
    );
    let swaps = report.series.iter().find(|series| series.name == "swaps");
    let values: Vec<f64> = swaps.unwrap().values.iter().flatten().copied().collect();
    assert_eq!((values.len(), values.iter().sum::<f64>()), (11, 2.0));
}

#[test]
fn every_point_is_counted_at_its_step() {
    // T is on A, U joins it at 1, F is far off at 2; nobody is there at 3.
    let tracks = [
        ("T", &[1.0, 1.0, 1.0, GONE][..]),
        ("U", &[GONE, 2.0, 2.0, GONE][..]),
        ("F", &[GONE, GONE, 90.0, GONE][..]),
    ];
    let scene = compare(&[("A", &[0.0; 4])], &tracks, 10.0);
    let report = evaluate("assignment", json!({}), &[scene]);
    let over_time = |series: &Series| {
        let values: Vec<f64> = series.values.iter().flatten().copied().collect();
        (series.name, values)
    };
    let found: Vec<_> = report.series.iter().map(over_time).collect();
    let expected = [
        ("associated", vec![1.0, 1.0, 1.0, 0.0]),
        ("missed", vec![0.0, 0.0, 0.0, 1.0]),
        ("redundant", vec![0.0, 1.0, 1.0, 0.0]),
        ("unassigned", vec![0.0, 0.0, 1.0, 0.0]),
        ("swaps", vec![0.0; 4]),
        ("divergences", vec![0.0; 4]),
    ];
    assert_eq!(found, expected);
}

#[test]
fn a_track_keeps_its_truth_up_to_the_divergence_gate() {
    // 1, 15, 15, 30, 30, 5 m from A at a gate of 10.
    let scene = || {
        [compare(
            &[("A", &[0.0; 6])],
            &[("T", &[1.0, 15.0, 15.0, 30.0, 30.0, 5.0])],
            10.0,
        )]
    };
    let report = evaluate("assignment", json!({"divergence_gate": 20.0}), &scene());
    assert_eq!(
        numbers(&report.per_track, "T"),
        [6.0, 4.0, 0.0, 1.0, 2.0, 0.0, 0.0, 0.0, 0.0]
    );
    assert_eq!(
        numbers(&report.per_truth, "A"),
        [6.0, 1.0, 0.0, 1.0, 2.0, 4.0 / 6.0]
    );
    assert_eq!(report.parameters["divergence_gate"], 20.0);
    let report = evaluate("assignment", json!({}), &scene());
    assert_eq!(
        numbers(&report.per_track, "T")[..5],
        [6.0, 2.0, 0.0, 1.0, 4.0]
    );
    // Below the gate it is the gate.
    assert_eq!(
        Assignment {
            divergence_gate: Some(3.0)
        }
        .reach_m(10.0),
        10.0
    );
}

#[test]
fn the_track_that_has_kept_a_truth_longest_is_associated() {
    // T has A from the start, U joins at 1. T leaves at 3, so U is associated; T comes back and is redundant.
    let tracks = [
        ("U", &[GONE, 1.0, 1.0, 1.0, 1.0][..]),
        ("T", &[2.0, 2.0, 2.0, 40.0, 2.0]),
    ];
    let report = evaluate(
        "assignment",
        json!({}),
        &[compare(&[("A", &[0.0; 5])], &tracks, 10.0)],
    );
    assert_eq!(numbers(&report.per_track, "U")[5..7], [1.0, 2.0]);
    assert_eq!(
        numbers(&report.per_track, "T"),
        [5.0, 4.0, 0.0, 1.0, 1.0, 1.0, 1.0, 0.0, 0.0]
    );
    assert_quantities(
        &report,
        &[
            ("breaks", Some(0.0)),
            ("redundancies", Some(2.0)),
            ("redundancy_length", Some(3.0)),
        ],
    );
}

#[test]
fn a_truth_that_ends_frees_its_track_without_divergence() {
    let truths = [
        ("A", &[0.0, 0.0, GONE, GONE][..]),
        ("B", &[GONE, GONE, GONE, 3.0]),
    ];
    let report = evaluate(
        "assignment",
        json!({}),
        &[compare(&truths, &[("T", &[1.0; 4])], 10.0)],
    );
    assert_eq!(
        numbers(&report.per_track, "T")[..5],
        [4.0, 3.0, 1.0, 0.0, 0.0]
    );
}

#[test]
fn edges() {
    let report = evaluate(
        "assignment",
        json!({}),
        &[compare(&[("A", &[0.0; 3])], &[], 10.0)],
    );
    assert_quantities(
        &report,
        &[
            ("associated_share", Some(0.0)),
            ("mean_establishment_length", None),
            ("false_tracks_share", None),
        ],
    );
    assert_eq!(
        line(&report.per_truth, "A")[2],
        ("establishment_length", None)
    );
    let report = evaluate(
        "assignment",
        json!({}),
        &[compare(&[], &[("T", &[0.0; 3])], 10.0)],
    );
    assert_quantities(
        &report,
        &[
            ("associated_share", None),
            ("false_tracks", Some(1.0)),
            ("false_track_length", Some(3.0)),
        ],
    );
    let report = evaluate("assignment", json!({}), &[compare(&[], &[], 10.0)]);
    assert_quantities(
        &report,
        &[
            ("associated_share", None),
            ("truths", Some(0.0)),
            ("truths_established_share", None),
        ],
    );
    let report = evaluate(
        "assignment",
        json!({}),
        &[main_scene(10.0), swap_scene(10.0)],
    );
    assert_quantities(
        &report,
        &[
            ("associated_share", Some(38.0 / 40.0)),
            ("truths", Some(4.0)),
            ("mean_establishment_length", Some(0.25)),
        ],
    );
    assert!(report.per_track.is_empty());
}
