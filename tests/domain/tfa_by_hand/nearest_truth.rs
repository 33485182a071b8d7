//! The same by the nearest target: what a track is near to is its symbol.

use super::notation::{assert_sets, recording, target, tracks, tracks_at, truth_set};
use trackloom_domain::evaluation::{
    EvaluationInput, SymbolRule, TfaReport, TfaSettings, evaluate_temporal_automaton,
};
use trackloom_domain::model::scan::Recording;
use trackloom_domain::model::track::TrackSet;
use trackloom_domain::model::truth::TruthSet;

fn evaluate(
    recording: Option<&Recording>,
    truth: &TruthSet,
    tracks: &TrackSet,
    gate_m: f64,
    max_gap_s: f64,
) -> TfaReport {
    let settings = TfaSettings {
        symbols: SymbolRule::NearestTruth {
            gate_m,
            max_gap_s: Some(max_gap_s),
        },
        ..TfaSettings::PAPER
    };
    evaluate_temporal_automaton(
        &EvaluationInput {
            recording,
            truth: Some(truth),
            tracks,
        },
        &settings,
    )
    .unwrap()
}

/// Empty scans at 8, 16, … s.
fn empty_scans(count: usize) -> Recording {
    recording(&[], &[&". ".repeat(count)])
}

#[test]
fn truth_is_interpolated_between_its_points_up_to_a_gap() {
    // B, far away, makes 10 s a step.
    let truth = truth_set(&[
        (
            "A",
            &[(0.0, 0.0, 0.0), (20.0, 200.0, 0.0), (50.0, 500.0, 0.0)],
        ),
        ("B", &[(10.0, 0.0, 9e5)]),
    ]);
    let tracks = tracks_at(&[(
        "1",
        &[
            (0.0, 0.0, 3.0),
            (10.0, 100.0, 3.0),
            (20.0, 200.0, -3.0),
            (50.0, 500.0, 0.0),
        ],
    )]);
    let report = evaluate(None, &truth, &tracks, 5.0, 20.0);
    assert_eq!(target(&report, "A"), "A correct; errors 0");
    assert_eq!(
        (report.targets[0].symbols, report.targets[0].log_probability),
        (4, Some(0.0))
    );
    assert_sets(&report, [1, 1, 0], [Some(1.0), Some(0.5), Some(0.0)]);

    let report = evaluate(None, &truth, &tracks, 5.0, 19.0);
    assert_eq!(
        report.targets[0].symbols, 3,
        "the truth has no place at 10 s"
    );
    assert_eq!(
        target(&report, "A"),
        "A correct; errors 0",
        "nor has the track anything near it"
    );
}

#[test]
fn a_track_that_ends_before_its_target_is_not_correct() {
    let truth = truth_set(&[(
        "A",
        &[(0.0, 0.0, 0.0), (20.0, 200.0, 0.0), (50.0, 500.0, 0.0)],
    )]);
    let tracks = tracks_at(&[(
        "1",
        &[(0.0, 0.0, 3.0), (10.0, 100.0, 3.0), (20.0, 200.0, -3.0)],
    )]);
    let report = evaluate(None, &truth, &tracks, 5.0, 20.0);
    assert_eq!(
        target(&report, "A"),
        "A false at 3: expected A, took null (ended), track 1; errors 1"
    );
}

#[test]
fn the_gate_is_the_largest_distance() {
    let truth = truth_set(&[("A", &[(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (2.0, 0.0, 0.0)])]);
    let tracks = tracks_at(&[("1", &[(0.0, 3.0, 4.0), (1.0, 3.0, 4.1), (2.0, 0.0, 0.0)])]);
    let report = evaluate(None, &truth, &tracks, 5.0, 1.0);
    assert_eq!(
        target(&report, "A"),
        "A false at 2: expected A, took ε (epsilon), track 1; errors 1"
    );
    assert_eq!(
        super::notation::tracks(&report),
        ["1 matched A, scans 1..3, symbols 2, errors 1"]
    );
}

#[test]
fn a_track_that_goes_over_to_another_target() {
    let truth = truth_set(&[
        ("A", &[(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (2.0, 0.0, 0.0)]),
        ("B", &[(0.0, 9.0, 0.0), (1.0, 9.0, 0.0), (2.0, 9.0, 0.0)]),
    ]);
    let paths = tracks_at(&[("1", &[(0.0, 1.0, 0.0), (1.0, 1.0, 0.0), (2.0, 8.0, 0.0)])]);
    let report = evaluate(None, &truth, &paths, 20.0, 1.0);
    assert_eq!(
        target(&report, "A"),
        "A false at 3: expected A, took B (target B), track 1; errors 1"
    );
    assert_eq!(target(&report, "B"), "B missed; errors 3");
    assert_sets(&report, [0, 1, 1], [Some(0.0), Some(0.5), Some(0.5)]);
}

#[test]
fn it_is_not_one_to_one_and_ties_go_to_the_smaller_id() {
    let truth = truth_set(&[
        ("10", &[(0.0, 2.0, 0.0), (1.0, 2.0, 0.0)]),
        ("9", &[(0.0, -2.0, 0.0), (1.0, -2.0, 0.0)]),
    ]);
    let paths = tracks_at(&[
        ("1", &[(0.0, 0.0, 0.0), (1.0, 0.0, 0.0)]),
        ("2", &[(0.0, -1.0, 0.0), (1.0, -1.0, 0.0)]),
    ]);
    let report = evaluate(None, &truth, &paths, 5.0, 1.0);
    assert_eq!(target(&report, "9"), "9 correct; errors 0");
    assert_eq!(target(&report, "10"), "10 missed; errors 2");
    assert_eq!(
        tracks(&report),
        [
            "1 matched 9, scans 1..2, symbols 2, errors 0",
            "2 redundant 9, scans 1..2, symbols 2, errors 0"
        ]
    );
    assert_eq!(report.violations, [], "targets may be shared");
}

#[test]
fn a_track_near_nothing_is_an_empty_false_output_track() {
    let truth = truth_set(&[("A", &[(0.0, 0.0, 0.0), (1.0, 0.0, 0.0)])]);
    let report = evaluate(
        None,
        &truth,
        &tracks_at(&[("1", &[(0.0, 99.0, 0.0), (1.0, 99.0, 0.0)])]),
        5.0,
        1.0,
    );
    assert_eq!(tracks(&report), ["1 false, empty"]);
    assert_eq!(target(&report, "A"), "A missed; errors 2");
}

#[test]
fn the_scans_of_a_recording_are_the_axis() {
    let recording = empty_scans(4);
    let truth = truth_set(&[
        ("A", &[(8.0, 0.0, 0.0), (32.0, 0.0, 0.0)]),
        ("later", &[(90.0, 0.0, 0.0), (99.0, 0.0, 0.0)]),
    ]);
    let paths = tracks_at(&[("1", &[(8.0, 0.0, 0.0), (16.0, 0.0, 0.0), (17.0, 0.0, 0.0)])]);
    let report = evaluate(Some(&recording), &truth, &paths, 5.0, 60.0);
    assert_eq!(
        target(&report, "A"),
        "A false at 3: expected A, took null (ended), track 1; errors 2"
    );
    assert_eq!(
        report.targets.len(),
        1,
        "the other was never there to be seen"
    );
    assert_eq!(
        report.warnings,
        [
            "the truth reaches 67.0 s behind its last scan of the recording: nothing is judged there",
            "1 target(s) exist at no scan of the recording and were left out"
        ],
        "17 s belongs to the scan at 16 s, which has a nearer point"
    );
}

#[test]
fn empty_output_misses_every_target() {
    let truth = truth_set(&[("A", &[(0.0, 0.0, 0.0)]), ("B", &[(0.0, 5.0, 0.0)])]);
    let report = evaluate(None, &truth, &TrackSet::default(), 5.0, 1.0);
    assert_sets(&report, [0, 2, 0], [None, Some(1.0), Some(0.0)]);
    let recording = empty_scans(2);
    let truth = truth_set(&[("A", &[(8.0, 0.0, 0.0), (16.0, 0.0, 0.0)])]);
    let report = evaluate(Some(&recording), &truth, &TrackSet::default(), 5.0, 8.0);
    assert_eq!(target(&report, "A"), "A missed; errors 2");
}
