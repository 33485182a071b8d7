//! The automaton in files, its sizes, long lists of violations, and settings that make no sense.

use super::notation::{recording, track_set};
use trackloom_domain::evaluation::temporal_automaton::TfaEvaluation;
use trackloom_domain::evaluation::{
    DecisionPolicy, EvaluationInput, SymbolRule, TfaSettings, evaluate_temporal_automaton,
};

const MINIMAL: TfaSettings = TfaSettings {
    minimise: true,
    ..TfaSettings::PAPER
};

#[test]
fn the_automaton_is_written_as_json_and_as_a_graph() {
    let (recording, tracks) = (
        recording(&["A: a1 . a3"], &[]),
        track_set(&["1: a1=0.5 . a3"]),
    );
    let input = EvaluationInput {
        recording: Some(&recording),
        truth: None,
        tracks: &tracks,
    };
    let evaluation = TfaEvaluation::new(input, None, TfaSettings::PAPER).unwrap();
    let file = evaluation.automaton_file(3).unwrap();
    assert_eq!(
        serde_json::to_value(&file).unwrap(),
        serde_json::json!({
            "minimised": false, "start_state": 0, "states": 4, "final_states": [3],
            "transitions": [
                { "from": 0, "to": 1, "scan": 1, "time_s": 8.0, "symbol": "a1", "weight": 0.5 },
                { "from": 1, "to": 2, "scan": 2, "time_s": 16.0, "symbol": "ε", "weight": 1.0 },
                { "from": 2, "to": 3, "scan": 3, "time_s": 24.0, "symbol": "a3", "weight": 1.0 }
            ]
        })
    );
    assert_eq!(
        file.dot(),
        "digraph automaton {\n  rankdir=LR;\n  node [shape=circle];\n  3 [shape=doublecircle];\n  0 -> 1 [label=\"1: a1 (0.5)\"];\n  \
         1 -> 2 [label=\"2: ε\"];\n  2 -> 3 [label=\"3: a3\"];\n}\n"
    );
    assert!(evaluation.automaton_file(2).is_none(), "too large");
}

#[test]
fn quotes_in_names_do_not_break_the_graph() {
    let (recording, tracks) = (recording(&["A: a\"1\\"], &[]), track_set(&["1: a\"1\\"]));
    let input = EvaluationInput {
        recording: Some(&recording),
        truth: None,
        tracks: &tracks,
    };
    let dot = TfaEvaluation::new(input, None, TfaSettings::PAPER)
        .unwrap()
        .automaton_file(9)
        .unwrap()
        .dot();
    assert!(dot.contains(r#"[label="1: a\"1\\"];"#), "{dot}");
}

#[test]
fn minimising_changes_the_sizes_and_no_verdict() {
    let truth = ["A: a1 a2 a3 a4", "B: b1 b2 b3 b4"];
    let (recording, tracks) = (
        recording(&truth, &[]),
        track_set(&["1: a1 a2 a3 b4", "2: b1 b2 a3 b4", "3: a1 a2 a3 b4"]),
    );
    let input = EvaluationInput {
        recording: Some(&recording),
        truth: None,
        tracks: &tracks,
    };
    let mut plain = evaluate_temporal_automaton(&input, &TfaSettings::PAPER).unwrap();
    let evaluation = TfaEvaluation::new(input, None, MINIMAL).unwrap();
    let minimal = evaluation.report();
    assert_eq!(
        (
            plain.automaton.states,
            plain.automaton.transitions,
            plain.automaton.minimised
        ),
        (13, 12, None)
    );
    let smallest = minimal.automaton.minimised.unwrap();
    assert_eq!(
        (smallest.states, smallest.transitions),
        (6, 6),
        "the first and third track are one path, and all end alike"
    );
    plain.automaton = minimal.automaton;
    assert_eq!(plain, minimal);
    let file = serde_json::to_value(evaluation.automaton_file(100).unwrap()).unwrap();
    assert_eq!(
        (file["minimised"].as_bool(), file["states"].as_u64()),
        (Some(true), Some(6))
    );
    assert!(file["transitions"][0].get("weight").is_none());
}

#[test]
fn only_the_first_thousand_violations_and_unknown_detections_are_listed() {
    let words = |name: &str| {
        (1..=1203)
            .map(|scan| format!("{name}{scan} "))
            .collect::<String>()
    };
    let truth = format!("A: {}", words("a"));
    let lines = ["1", "2", "3"]
        .map(|track| format!("{track}: {}", words(if track == "3" { "z" } else { "a" })));
    let (recording, tracks) = (
        recording(&[&truth], &[]),
        track_set(&[&lines[0], &lines[1], &lines[2]]),
    );
    let input = EvaluationInput {
        recording: Some(&recording),
        truth: None,
        tracks: &tracks,
    };
    let report = evaluate_temporal_automaton(&input, &TfaSettings::PAPER).unwrap();
    assert_eq!(
        (
            report.counts.violations,
            report.violations.len(),
            report.violations_left_out
        ),
        (1203, 1000, 203)
    );
    assert_eq!(
        (report.violations[0].scan, report.violations[999].scan),
        (1, 1000)
    );
    assert_eq!(
        (
            report.counts.unknown_detections,
            report.unknown_detections.len(),
            report.unknown_detections_left_out
        ),
        (1203, 1000, 203)
    );
}

#[test]
fn every_setting_that_makes_no_sense_is_named() {
    let (recording, tracks) = (recording(&["A: a1"], &[]), track_set(&["1: a1"]));
    let input = EvaluationInput {
        recording: Some(&recording),
        truth: None,
        tracks: &tracks,
    };
    let pointers = |settings: TfaSettings| -> Vec<String> {
        evaluate_temporal_automaton(&input, &settings)
            .unwrap_err()
            .into_iter()
            .map(|fault| fault.pointer)
            .collect()
    };
    let all = TfaSettings {
        symbols: SymbolRule::NearestDetection { gate_m: 0.0 },
        decision: DecisionPolicy::AllGated { min_weight: -0.5 },
        max_missed: 0,
        ..TfaSettings::PAPER
    };
    assert_eq!(
        pointers(all),
        [
            "/tfa/max_missed",
            "/tfa/symbols/gate_m",
            "/tfa/decision/min_weight",
            "/tfa/decision/policy"
        ]
    );
    for gate_m in [-1.0, f64::NAN, f64::INFINITY] {
        let settings = TfaSettings {
            symbols: SymbolRule::NearestTruth {
                gate_m,
                max_gap_s: Some(1.0),
            },
            ..TfaSettings::PAPER
        };
        assert_eq!(pointers(settings), ["/tfa/symbols/gate_m"]);
    }
    for min_weight in [0.0, 1.5, f64::NAN] {
        assert_eq!(
            pointers(super::all_gated::gated(min_weight)),
            ["/tfa/decision/min_weight"]
        );
    }
}
