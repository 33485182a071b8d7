//! The same where every candidate of enough weight is kept.

use super::notation::{assert_sets, recording, target, track_set, tracks};
use trackloom_domain::evaluation::temporal_automaton::{Order, TfaEvaluation};
use trackloom_domain::evaluation::{
    DecisionPolicy, EvaluationInput, TfaReport, TfaSettings, evaluate_temporal_automaton,
};

pub fn gated(min_weight: f64) -> TfaSettings {
    TfaSettings {
        decision: DecisionPolicy::AllGated { min_weight },
        ..TfaSettings::PAPER
    }
}

/// The report, the same by both searches.
pub fn evaluate_gated(
    truth: &[&str],
    clutter: &[&str],
    track_lines: &[&str],
    min_weight: f64,
) -> TfaReport {
    let (recording, tracks) = (recording(truth, clutter), track_set(track_lines));
    let input = EvaluationInput {
        recording: Some(&recording),
        truth: None,
        tracks: &tracks,
    };
    let report = evaluate_temporal_automaton(&input, &gated(min_weight)).unwrap();
    let mut deep = evaluate_temporal_automaton(
        &input,
        &TfaSettings {
            search: Order::DepthFirst,
            ..gated(min_weight)
        },
    )
    .unwrap();
    assert_eq!(
        (deep.parameters.search, report.parameters.search),
        ("depth_first", "breadth_first")
    );
    deep.parameters = report.parameters.clone();
    assert_eq!(deep, report);
    report
}

#[test]
fn a_detection_of_enough_weight_is_accepted_though_another_was_more_probable() {
    let line = ["1: a1 c2=0.6|a2=0.3|.=0.1 a3"];
    let report = evaluate_gated(&["A: a1 a2 a3"], &[". c2"], &line, 0.25);
    assert_eq!(target(&report, "A"), "A correct; errors 0");
    assert!((report.targets[0].log_probability.unwrap() - 0.3_f64.ln()).abs() < 1e-12);
    assert_eq!(
        tracks(&report),
        ["1 matched A, scans 1..3, symbols 3, errors 1"],
        "classes are of what was most probable"
    );
    assert_sets(&report, [1, 0, 0], [Some(1.0), Some(0.0), Some(0.0)]);
    assert_eq!(
        (
            report.violations.len(),
            report.parameters.decision,
            report.parameters.min_weight
        ),
        (0, "all_gated", Some(0.25))
    );

    let report = evaluate_gated(&["A: a1 a2 a3"], &[". c2"], &line, 0.5);
    assert_eq!(
        target(&report, "A"),
        "A false at 2: expected a2, took c2 (clutter), track 1; errors 1"
    );
}

#[test]
fn epsilon_is_a_choice_of_enough_weight_or_where_nothing_else_is() {
    let truth = ["A: a1 . a3"];
    let accepted = |line: &str, min_weight| {
        evaluate_gated(&truth, &[". c2"], &[line], min_weight)
            .counts
            .correct
            == 1
    };
    assert!(accepted("1: a1 c2=0.7|.=0.3 a3", 0.25));
    assert!(!accepted("1: a1 c2=0.7|.=0.3 a3", 0.5));
    assert!(accepted("1: a1 c2=0.4|.=0.3 a3", 0.5), "neither has enough");
    assert!(accepted("1: a1 _ a3", 0.5));
}

#[test]
fn a_track_that_may_have_been_nothing_may_begin_later_and_end_earlier() {
    let report = evaluate_gated(
        &["A: . a2 a3 ."],
        &["c1 . . c4"],
        &["1: c1=0.6|.=0.4 a2 a3 c4=0.3|.=0.7"],
        0.1,
    );
    assert_eq!(target(&report, "A"), "A correct; errors 0");
    assert_eq!(
        report.targets[0].log_probability,
        Some(0.0),
        "what is outside the string is no part of it"
    );
    let sure = evaluate_gated(&["A: . a2 a3 ."], &["c1 . . c4"], &["1: c1 a2 a3 c4"], 0.1);
    assert_eq!(target(&sure, "A"), "A missed; errors 2");
}

#[test]
fn the_best_of_several_paths_gives_the_probability() {
    let lines = [
        "1: a1=0.5|.=0.5 a2=0.5|c2=0.5",
        "2: a1=0.9|.=0.1 a2=0.4|.=0.6",
    ];
    let report = evaluate_gated(&["A: a1 a2"], &[". c2"], &lines, 0.1);
    let expected = (0.9_f64 * 0.4).ln();
    assert!((report.targets[0].log_probability.unwrap() - expected).abs() < 1e-12);
}

#[test]
fn probabilities_scan_by_scan_are_the_weights_along_the_path() {
    let lines = [
        "1: a1=0.8|.=0.2 c2=0.6|.=0.4 a3=0.5|c3=0.5",
        "2: b1=0.7|.=0.3 b2 c3",
    ];
    let (recording, tracks) = (
        recording(
            &["A: a1 . a3", "B: b1 b2 b3 b4", "C: . . . k4"],
            &[". c2 c3"],
        ),
        track_set(&lines),
    );
    let input = EvaluationInput {
        recording: Some(&recording),
        truth: None,
        tracks: &tracks,
    };
    let evaluation = TfaEvaluation::new(input, None, gated(0.1)).unwrap();
    let curves = evaluation.scan_probabilities(100).unwrap();
    let row = |index: usize| {
        (
            curves[index].target,
            curves[index].track,
            curves[index].probability,
        )
    };
    let ln = |index: usize| curves[index].log_probability;
    assert_eq!(
        [0, 1, 2].map(row),
        [(0, Some(0), 0.8), (0, Some(0), 0.4), (0, Some(0), 0.5)]
    );
    let by_hand = 0.8_f64.ln() + 0.4_f64.ln() + 0.5_f64.ln();
    assert!((ln(2).unwrap() - by_hand).abs() < 1e-12);
    assert!((evaluation.report().targets[0].log_probability.unwrap() - by_hand).abs() < 1e-12);
    assert_eq!(
        [3, 4, 5, 6].map(row),
        [
            (1, Some(1), 0.7),
            (1, Some(1), 1.0),
            (1, Some(1), 0.0),
            (1, Some(1), 0.0)
        ]
    );
    assert_eq!(
        (ln(4), ln(5), ln(6)),
        (Some(0.7_f64.ln()), None, None),
        "B was left at scan 3"
    );
    assert_eq!(
        (row(7), ln(7), curves.len()),
        ((2, None, 0.0), None, 8),
        "no track speaks for C"
    );
    assert!(evaluation.scan_probabilities(7).is_none());
}
