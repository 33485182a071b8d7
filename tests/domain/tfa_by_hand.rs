//! Scenes small enough to judge by eye, each with the verdicts, errors, classes and probabilities it must give.
//! The notation is explained in `tfa_by_hand/notation.rs`.

mod all_gated;
mod files;
mod naive;
mod nearest_detection;
mod nearest_truth;
mod notation;
mod tolerant;

use notation::{
    BY_DETECTION, assert_sets, evaluate, recording, target, track_set, tracks, truth_set,
};
use trackloom_domain::evaluation::{
    EvaluationInput, SymbolRule, TfaSettings, evaluate_temporal_automaton,
};
use trackloom_domain::model::track::TrackSet;

const NO: Option<f64> = Some(0.0);
const ALL: Option<f64> = Some(1.0);

#[test]
fn correct() {
    let report = evaluate(&["A: a1 a2 . a4"], &[". c2 c3 ."], &["1: a1 a2 . a4"]);
    assert_eq!(target(&report, "A"), "A correct; errors 0");
    assert_eq!(
        tracks(&report),
        ["1 matched A, scans 1..4, symbols 3, errors 0"]
    );
    assert_sets(&report, [1, 0, 0], [ALL, NO, NO]);
    assert!(report.consistent && report.targets[0].reachable);
    assert_eq!(report.targets[0].log_probability, Some(0.0));
    assert_eq!(report.violations, []);
}

#[test]
fn missed() {
    let report = evaluate(&["A: a1 a2 a3", "B: b1 b2 b3"], &[], &["1: b1 b2 b3"]);
    assert_eq!(target(&report, "A"), "A missed; errors 3");
    assert_eq!(target(&report, "B"), "B correct; errors 0");
    assert_sets(&report, [1, 1, 0], [ALL, Some(0.5), NO]);
    assert!(!report.consistent);
    assert_eq!(report.targets[0].log_probability, None);
    assert_eq!(
        (
            report.ratios.correct_per_target,
            report.ratios.output_tracks_per_target
        ),
        (Some(0.5), Some(0.5))
    );
}

#[test]
fn false_by_clutter() {
    let report = evaluate(&["A: a1 a2 a3 a4"], &[". . c3 ."], &["1: a1 a2 c3 a4"]);
    assert_eq!(
        target(&report, "A"),
        "A false at 3: expected a3, took c3 (clutter), track 1; errors 1"
    );
    assert_eq!(report.targets[0].at_time_s, Some(24.0));
    assert_eq!(
        tracks(&report),
        ["1 matched A, scans 1..4, symbols 4, errors 1"]
    );
    assert_sets(&report, [0, 0, 1], [NO, NO, ALL]);
    assert_eq!(report.targets[0].log_probability, None);
}

#[test]
fn false_by_clutter_where_the_target_was_not_seen() {
    let report = evaluate(&["A: a1 . a3"], &[". c2 ."], &["1: a1 c2 a3"]);
    assert_eq!(
        target(&report, "A"),
        "A false at 2: expected ε, took c2 (clutter), track 1; errors 1"
    );
}

#[test]
fn false_by_another_target() {
    let report = evaluate(&["A: a1 a2 a3", "B: . b2 b3"], &[], &["1: a1 a2 b3"]);
    assert_eq!(
        target(&report, "A"),
        "A false at 3: expected a3, took b3 (target B), track 1; errors 1"
    );
    assert_eq!(target(&report, "B"), "B missed; errors 2");
    assert_eq!(
        tracks(&report),
        ["1 matched A, scans 1..3, symbols 3, errors 1"]
    );
    assert_sets(&report, [0, 1, 1], [NO, Some(0.5), Some(0.5)]);
}

#[test]
fn swap_of_two_targets() {
    let report = evaluate(
        &["A: a1 a2 a3 a4 a5", "B: b1 b2 b3 b4 b5"],
        &[],
        &["1: a1 a2 a3 b4 b5", "2: b1 b2 b3 a4 a5"],
    );
    assert_eq!(
        target(&report, "A"),
        "A false at 4: expected a4, took b4 (target B), track 1; errors 2"
    );
    assert_eq!(
        target(&report, "B"),
        "B false at 4: expected b4, took a4 (target A), track 2; errors 2"
    );
    assert_eq!(
        tracks(&report),
        [
            "1 matched A, scans 1..5, symbols 5, errors 2",
            "2 matched B, scans 1..5, symbols 5, errors 2"
        ]
    );
    assert_sets(&report, [0, 0, 2], [NO, NO, ALL]);
}

#[test]
fn false_by_epsilon() {
    for hole in [".", "_"] {
        let report = evaluate(&["A: a1 a2 a3 a4"], &[], &[&format!("1: a1 a2 {hole} a4")]);
        assert_eq!(
            target(&report, "A"),
            "A false at 3: expected a3, took ε (epsilon), track 1; errors 1"
        );
        assert_sets(&report, [0, 0, 1], [NO, NO, ALL]);
    }
}

#[test]
fn false_because_the_track_ended() {
    let report = evaluate(&["A: a1 a2 . a4 a5"], &[], &["1: a1 a2"]);
    assert_eq!(
        target(&report, "A"),
        "A false at 4: expected a4, took null (ended), track 1; errors 2"
    );
    assert_eq!(
        tracks(&report),
        ["1 matched A, scans 1..2, symbols 2, errors 2"]
    );
}

#[test]
fn false_because_the_track_went_on() {
    let report = evaluate(
        &["A: a1 a2 a3"],
        &[". . . . c5 c6"],
        &["1: a1 a2 a3 . c5 c6"],
    );
    assert_eq!(
        target(&report, "A"),
        "A false at 5: expected null, took c5 (clutter), track 1; errors 2"
    );
    assert_eq!(
        tracks(&report),
        ["1 matched A, scans 1..6, symbols 5, errors 2"]
    );
    assert_sets(&report, [0, 0, 1], [NO, NO, ALL]);
}

#[test]
fn late_birth_is_missed_though_matched() {
    let report = evaluate(&["A: a1 a2 a3 a4"], &[], &["1: _ _ a3 a4"]);
    assert_eq!(target(&report, "A"), "A missed; errors 4");
    assert_eq!(
        tracks(&report),
        ["1 matched A, scans 3..4, symbols 2, errors 2"]
    );
    assert_eq!(report.missed_with_matched_track, 1);
    assert_eq!(report.targets[0].matched_track_id.as_deref(), Some("1"));
    assert_sets(&report, [0, 1, 0], [NO, ALL, NO]);
}

#[test]
fn tentative_scans_belong_to_the_confirmed_track() {
    let report = evaluate(
        &["A: a1 a2 a3"],
        &["c1 c2 ."],
        &["1: a1? a2? a3", "2: c1? c2?"],
    );
    assert_eq!(target(&report, "A"), "A correct; errors 0");
    assert_eq!(
        tracks(&report),
        ["1 matched A, scans 1..3, symbols 3, errors 0"]
    );
    assert_eq!(
        report.warnings,
        ["1 track(s) were never confirmed and are not output tracks"]
    );
    assert_sets(&report, [1, 0, 0], [ALL, NO, NO]);
}

#[test]
fn a_gap_of_four_is_one_string() {
    let report = evaluate(&["A: a1 . . . . a6"], &[], &["1: a1 . . . . a6"]);
    assert_eq!(target(&report, "A"), "A correct; errors 0");
    assert_eq!(
        (report.targets[0].strings, report.targets[0].symbols),
        (1, 2)
    );
    assert_eq!(
        tracks(&report),
        ["1 matched A, scans 1..6, symbols 2, errors 0"]
    );
    assert_sets(&report, [1, 0, 0], [ALL, NO, NO]);
}

#[test]
fn a_gap_of_five_is_two_strings_and_two_output_tracks() {
    let report = evaluate(&["A: a1 a2 . . . . . a8"], &[], &["1: a1 a2 . . . . . a8"]);
    assert_eq!(target(&report, "A"), "A correct; errors 0");
    assert_eq!(
        (report.targets[0].strings, report.targets[0].symbols),
        (2, 3)
    );
    assert_eq!(
        tracks(&report),
        [
            "1 matched A, scans 1..2, symbols 2, errors 1",
            "1 redundant A, scans 8..8, symbols 1, errors 2"
        ]
    );
    assert_sets(&report, [1, 0, 0], [Some(0.5), NO, NO]);
}

#[test]
fn a_track_that_bridges_a_gap_of_five_is_false() {
    let report = evaluate(
        &["A: a1 a2 . . . . . a8"],
        &[". . . . c5"],
        &["1: a1 a2 . . c5 . . a8"],
    );
    assert_eq!(
        target(&report, "A"),
        "A false at 5: expected null, took c5 (clutter), track 1; errors 3"
    );
    assert_eq!(
        tracks(&report),
        ["1 matched A, scans 1..8, symbols 4, errors 1"]
    );
    // The track is left for one of the two strings: c5 is too much there, and a8 is missing in the other.
    assert_eq!(report.targets[0].least_errors, Some(3));
    assert!(
        report.warnings[0].starts_with("1 track(s) go on across a gap of 5 scans or more"),
        "{:?}",
        report.warnings
    );
    assert!(
        report.warnings[0].contains("first track '1' of target 'A'"),
        "{:?}",
        report.warnings
    );
}

#[test]
fn one_string_correct_and_one_missed_make_the_target_false() {
    let report = evaluate(&["A: a1 a2 . . . . . a8 a9"], &[], &["1: a1 a2"]);
    assert_eq!(
        target(&report, "A"),
        "A false at 8: expected a8, took ε (epsilon), track null; errors 2"
    );
    assert_sets(&report, [0, 0, 1], [NO, NO, ALL]);
    let report = evaluate(
        &["A: a1 a2 . . . . . a8 a9"],
        &[],
        &["1: _ a2", "2: _ _ _ _ _ _ _ _ a9"],
    );
    assert_eq!(target(&report, "A"), "A missed; errors 4");
}

#[test]
fn leading_and_trailing_epsilon_do_not_count() {
    let report = evaluate(&["A: . a2 a3 . ."], &[], &["1: . a2 a3 . ."]);
    assert_eq!(target(&report, "A"), "A correct; errors 0");
    assert_eq!(
        tracks(&report),
        ["1 matched A, scans 2..3, symbols 2, errors 0"]
    );
    assert_sets(&report, [1, 0, 0], [ALL, NO, NO]);
}

#[test]
fn empty_truth() {
    let report = evaluate(&[], &["c1 c2"], &["1: c1 c2"]);
    assert_sets(&report, [0, 0, 0], [NO, None, None]);
    assert_eq!(tracks(&report), ["1 false, scans 1..2, symbols 2"]);
    assert_eq!(
        (
            report.ratios.correct_per_target,
            report.ratios.output_tracks_per_target
        ),
        (None, None)
    );
    let json = serde_json::to_value(&report).unwrap();
    assert_eq!(
        json["probability"],
        serde_json::json!({ "correct": 0.0, "missed": null, "false": null })
    );
}

#[test]
fn empty_output() {
    let report = evaluate(&["A: a1 a2", "B:"], &[], &[]);
    assert_eq!(target(&report, "A"), "A missed; errors 2");
    assert_eq!(target(&report, "B"), "B missed; errors 0");
    assert_sets(&report, [0, 2, 0], [None, ALL, NO]);
}

#[test]
fn nothing_at_all() {
    assert_sets(&evaluate(&[], &[], &[]), [0, 0, 0], [None, None, None]);
}

#[test]
fn a_target_that_only_the_truth_names_is_missed() {
    let (recording, tracks) = (recording(&["A: a1 a2"], &[]), track_set(&["1: a1 a2"]));
    let truth = truth_set(&[("A", &[(8.0, 0.0, 0.0)]), ("Z", &[(8.0, 9.0, 9.0)])]);
    let input = EvaluationInput {
        recording: Some(&recording),
        truth: Some(&truth),
        tracks: &tracks,
    };
    let report = evaluate_temporal_automaton(&input, &BY_DETECTION).unwrap();
    assert_eq!(target(&report, "A"), "A correct; errors 0");
    assert_eq!(target(&report, "Z"), "Z missed; errors 0");
    assert_sets(&report, [1, 1, 0], [ALL, Some(0.5), NO]);
}

#[test]
fn a_confirmed_track_without_detections_is_a_false_output_track() {
    let report = evaluate(&["A: a1 a2"], &[], &["1: a1 a2", "2: . ."]);
    assert_eq!(
        tracks(&report),
        [
            "1 matched A, scans 1..2, symbols 2, errors 0",
            "2 false, empty"
        ]
    );
    assert_sets(&report, [1, 0, 0], [Some(0.5), NO, NO]);
}

#[test]
fn tracks_of_more_than_half_clutter_are_false() {
    let report = evaluate(
        &["A: a1 a2 a3 a4"],
        &[". . c3 c4"],
        &["1: a1 a2 c3 c4", "2: _ a2 c3 c4"],
    );
    assert_eq!(
        tracks(&report),
        [
            "1 matched A, scans 1..4, symbols 4, errors 2",
            "2 false, scans 2..4, symbols 3"
        ]
    );
    assert_eq!(
        (
            report.counts.matched_tracks,
            report.counts.redundant_tracks,
            report.counts.false_tracks
        ),
        (1, 0, 1)
    );
}

#[test]
fn a_track_of_two_targets_follows_the_one_with_most_detections_then_the_smaller_id() {
    let truth = ["10: a1 a2 a3 a4", "9: b1 b2 b3 b4"];
    assert_eq!(
        tracks(&evaluate(&truth, &[], &["1: a1 a2 a3 b4"])),
        ["1 matched 10, scans 1..4, symbols 4, errors 1"]
    );
    assert_eq!(
        tracks(&evaluate(&truth, &[], &["1: a1 a2 b3 b4"])),
        ["1 matched 9, scans 1..4, symbols 4, errors 2"]
    );
}

#[test]
fn the_matched_follower_has_most_detections_then_fewest_errors_then_the_earliest_start() {
    let truth = ["A: a1 a2 a3 a4 a5 a6"];
    let report = evaluate(
        &truth,
        &["c1 . . . . ."],
        &["1: a1 a2", "2: _ _ _ a4 a5 a6", "3: c1 _ _ a4 a5"],
    );
    assert_eq!(
        tracks(&report),
        [
            "1 redundant A, scans 1..2, symbols 2, errors 4",
            "2 matched A, scans 4..6, symbols 3, errors 3",
            "3 redundant A, scans 1..5, symbols 3, errors 4"
        ]
    );
    let fewest_errors = evaluate(
        &["A: a1 a2 a3 a4 . a6"],
        &[". . . . c5 ."],
        &["1: a1 a2 . . c5", "2: _ _ a3 a4"],
    );
    assert_eq!(
        tracks(&fewest_errors),
        [
            "1 redundant A, scans 1..5, symbols 3, errors 4",
            "2 matched A, scans 3..4, symbols 2, errors 3"
        ],
        "c5 is an error more"
    );
    let tie = evaluate(
        &truth,
        &[". . c3 . . ."],
        &["1: _ _ _ a4 a5", "2: a1 a2 c3"],
    );
    assert_eq!(
        tracks(&tie),
        [
            "1 redundant A, scans 4..5, symbols 2, errors 4",
            "2 matched A, scans 1..3, symbols 3, errors 4"
        ],
        "c3 in place of a3 is no further error, so the start decides"
    );
    let smaller_id = evaluate(&truth, &[], &["10: a1 a2", "9: a1 a2"]);
    assert_eq!(smaller_id.targets[0].matched_track_id.as_deref(), Some("9"));
}

#[test]
fn of_two_tracks_on_one_string_the_longest_follower_speaks() {
    let report = evaluate(
        &["A: a1 a2 a3 a4"],
        &[". c2 c3 c4"],
        &["1: a1 c2 c3 c4", "2: a1 a2 a3 c4"],
    );
    assert_eq!(
        target(&report, "A"),
        "A false at 4: expected a4, took c4 (clutter), track 2; errors 1"
    );
    assert_sets(&report, [0, 0, 1], [NO, NO, ALL]);
}

#[test]
fn of_two_equally_long_followers_the_smaller_id_speaks() {
    let report = evaluate(
        &["A: a1 a2 a3"],
        &[". . c3"],
        &["10: a1 a2 c3", "9: a1 a2 ."],
    );
    assert_eq!(
        target(&report, "A"),
        "A false at 3: expected a3, took null (ended), track 9; errors 1"
    );
}

#[test]
fn a_string_is_correct_when_one_of_several_tracks_follows_it_to_the_end() {
    let report = evaluate(
        &["A: a1 a2 a3"],
        &[". c2 ."],
        &["1: a1 c2 a3", "2: a1 a2 a3"],
    );
    assert_eq!(target(&report, "A"), "A correct; errors 0");
    assert_eq!(
        tracks(&report),
        [
            "1 redundant A, scans 1..3, symbols 3, errors 1",
            "2 matched A, scans 1..3, symbols 3, errors 0"
        ]
    );
    assert_sets(&report, [1, 0, 0], [Some(0.5), NO, NO]);
}

#[test]
fn a_detection_shared_by_tracks_is_a_violation() {
    let report = evaluate(
        &["A: a1 a2", "B: b1 b2"],
        &[],
        &["1: a1 a2", "2: b1 a2", "3: _ a2"],
    );
    let json = serde_json::to_value(&report.violations).unwrap();
    assert_eq!(
        json,
        serde_json::json!([
            { "kind": "detection_shared_by_tracks", "scan": 2, "time_s": 16.0, "detection_ids": ["a2"], "track_ids": ["1", "2", "3"] }
        ])
    );
    assert_eq!(
        target(&report, "B"),
        "B false at 2: expected b2, took a2 (target A), track 2; errors 1"
    );
}

#[test]
fn several_detections_claimed_by_a_track_are_a_violation_and_the_most_probable_counts() {
    let doubted = evaluate(
        &["A: a1 a2"],
        &["c1 c2"],
        &["1: c1=0.3|a1=0.6|.=0.1 c2=0.0|a2=1.0"],
    );
    assert_eq!(target(&doubted, "A"), "A correct; errors 0");
    assert_eq!(doubted.targets[0].log_probability, Some(0.6_f64.ln()));
    assert_eq!(
        (doubted.violations, doubted.counts.violations),
        (vec![], 0),
        "doubt between detections is a decision for one"
    );

    let report = evaluate(
        &["A: a1 a2"],
        &["c1 c2"],
        &["1: c1=0.7|a1=0.8 c2=0.0|a2=1.0"],
    );
    assert_eq!(target(&report, "A"), "A correct; errors 0");
    let json = serde_json::to_value(&report.violations).unwrap();
    assert_eq!(
        json,
        serde_json::json!([
            { "kind": "several_detections_in_track", "scan": 1, "time_s": 8.0, "detection_ids": ["c1", "a1"], "track_ids": ["1"] }
        ])
    );
}

#[test]
fn tied_candidates_go_to_the_detection_listed_first() {
    let first = evaluate(&["A: a1 a2"], &["c1 ."], &["1: a1=0.4|c1=0.4|.=0.2 a2"]);
    assert_eq!(target(&first, "A"), "A correct; errors 0");
    let second = evaluate(&["A: a1 a2"], &["c1 ."], &["1: c1=0.4|a1=0.4|.=0.2 a2"]);
    assert_eq!(target(&second, "A"), "A missed; errors 2");
    let with_none = evaluate(&["A: a1 a2"], &[], &["1: a1 .=0.5|a2=0.5"]);
    assert_eq!(target(&with_none, "A"), "A correct; errors 0");
    let none_wins = evaluate(&["A: a1 a2 a3"], &[], &["1: a1 a2=0.4|.=0.6 a3"]);
    assert_eq!(
        target(&none_wins, "A"),
        "A false at 2: expected a2, took ε (epsilon), track 1; errors 1"
    );
}

#[test]
fn weights_multiply_along_the_path_epsilon_included() {
    let report = evaluate(&["A: a1 . a3"], &[], &["1: a1=0.5 .=0.8 a3=0.75|.=0.25"]);
    let by_hand = 0.5_f64.ln() + 0.8_f64.ln() + 0.75_f64.ln();
    assert!((report.targets[0].log_probability.unwrap() - by_hand).abs() < 1e-12);
}

#[test]
fn a_detection_that_the_scan_does_not_have_is_reported_and_counts_as_clutter() {
    let report = evaluate(&["A: a1 a2 a3"], &[], &["1: a1 x7 a3", "2: _ a1"]);
    assert_eq!(
        target(&report, "A"),
        "A false at 2: expected a2, took x7 (clutter), track 1; errors 1"
    );
    let json = serde_json::to_value(&report.unknown_detections).unwrap();
    assert_eq!(
        json,
        serde_json::json!([
            { "track_id": "1", "scan": 2, "time_s": 16.0, "detection_id": "x7" },
            { "track_id": "2", "scan": 2, "time_s": 16.0, "detection_id": "a1" }
        ])
    );
    assert_eq!(tracks(&report)[1], "2 false, scans 2..2, symbols 1");
}

#[test]
fn track_points_without_a_scan_are_left_out_and_told() {
    let recording = recording(&["A: a1 a2"], &[]);
    let tracks = track_set(&["1: a1 a2 a3 ."]);
    let input = EvaluationInput {
        recording: Some(&recording),
        truth: None,
        tracks: &tracks,
    };
    let report = evaluate_temporal_automaton(&input, &BY_DETECTION).unwrap();
    assert_eq!(target(&report, "A"), "A correct; errors 0");
    assert_eq!(
        report.warnings,
        [
            "2 track point(s) belong to no scan and were left out, first: track '1' at 24 s, track '1' at 32 s"
        ]
    );
}

#[test]
fn scans_missing_from_the_numbers_exist_and_are_empty() {
    let mut parts = recording(&["A: a1 a2 a3"], &[]).into_parts();
    for (scan, number) in parts.scans.iter_mut().zip([1, 2, 8]) {
        scan.number = number;
    }
    let recording = trackloom_domain::model::scan::Recording::new(parts).unwrap();
    let tracks = track_set(&["1: a1 a2 a3"]);
    let input = EvaluationInput {
        recording: Some(&recording),
        truth: None,
        tracks: &tracks,
    };
    let report = evaluate_temporal_automaton(&input, &BY_DETECTION).unwrap();
    assert_eq!(report.targets[0].strings, 2, "scans 3 to 7 are five ε");
    assert_eq!(
        notation::tracks(&report),
        [
            "1 matched A, scans 1..2, symbols 2, errors 1",
            "1 redundant A, scans 8..8, symbols 1, errors 2"
        ]
    );
}

#[test]
fn other_lengths_of_gap_end_strings_when_asked() {
    let (recording, tracks) = (
        recording(&["A: a1 . a3 . . a6"], &[]),
        track_set(&["1: a1 . a3 . . a6"]),
    );
    let input = EvaluationInput {
        recording: Some(&recording),
        truth: None,
        tracks: &tracks,
    };
    let strings = |max_missed| {
        evaluate_temporal_automaton(
            &input,
            &TfaSettings {
                max_missed,
                ..BY_DETECTION
            },
        )
        .unwrap()
        .targets[0]
            .strings
    };
    assert_eq!([1, 2, 3].map(strings), [3, 2, 1]);
    let faults = evaluate_temporal_automaton(
        &input,
        &TfaSettings {
            max_missed: 0,
            ..BY_DETECTION
        },
    )
    .unwrap_err();
    assert_eq!(
        (faults[0].pointer.as_str(), faults[0].code.as_str()),
        ("/tfa/max_missed", "out_of_range")
    );
}

#[test]
fn inputs_that_the_symbols_need_are_asked_for() {
    let tracks = TrackSet::default();
    let nothing = EvaluationInput {
        recording: None,
        truth: None,
        tracks: &tracks,
    };
    let fault = |input: &EvaluationInput, symbols| {
        let faults = evaluate_temporal_automaton(
            input,
            &TfaSettings {
                symbols,
                ..BY_DETECTION
            },
        )
        .unwrap_err();
        (faults[0].pointer.clone(), faults[0].code.clone())
    };
    let pair = |pointer: &str, code: &str| (pointer.to_owned(), code.to_owned());
    assert_eq!(
        fault(&nothing, SymbolRule::DetectionId),
        pair("/detections", "missing")
    );
    assert_eq!(
        fault(
            &nothing,
            SymbolRule::NearestTruth {
                gate_m: 1.0,
                max_gap_s: Some(1.0)
            }
        ),
        pair("/truth", "missing")
    );
    let unknown_origins = trackloom_domain::model::scan::Recording::default();
    let input = EvaluationInput {
        recording: Some(&unknown_origins),
        ..nothing
    };
    assert_eq!(
        fault(&input, SymbolRule::DetectionId),
        pair("/tfa/symbols", "unsupported")
    );
}

#[test]
fn the_names_that_tools_rely_on() {
    let report = evaluate(&["A: a1 a2"], &[". c2"], &["1: a1 c2"]);
    let json = serde_json::to_value(&report).unwrap();
    assert_eq!(json["parameters"]["symbols"], "detection_id");
    assert_eq!(json["parameters"]["decision"], "most_probable");
    assert_eq!(json["parameters"]["max_missed"], 5);
    for name in ["targets", "output_tracks", "correct", "missed", "false"] {
        assert!(json["counts"][name].is_u64(), "counts.{name}");
    }
    assert_eq!(
        json["probability"],
        serde_json::json!({ "correct": 0.0, "missed": 0.0, "false": 1.0 })
    );
    assert_eq!(
        json["targets"][0],
        serde_json::json!({
            "truth_id": "A", "verdict": "false", "reachable": false, "at_scan": 2, "at_time_s": 16.0, "expected": "a2",
            "took": "c2", "took_kind": "clutter", "took_truth_id": null, "track_id": "1", "errors": 1, "least_errors": 1,
            "log_probability": null,
            "symbols": 2, "strings": 1, "start_scan": 1, "end_scan": 2, "matched_track_id": "1"
        })
    );
    assert_eq!(
        json["output_tracks"][0],
        serde_json::json!({
            "track_id": "1", "part": 1, "class": "matched", "follows": "A", "start_scan": 1, "end_scan": 2, "symbols": 2, "errors": 1
        })
    );
}
