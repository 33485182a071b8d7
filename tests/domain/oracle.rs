//! The oracle is told the truth, so the evaluator must find it right: tracker and evaluator agree what truth is.

use serde_json::{Value, json};
use trackloom_domain::experiment::observer::Silent;
use trackloom_domain::experiment::{self, presets};

/// The `result` of a Liang scene under the oracle.
fn judged(targets: u32, seed: u32, confirm_hits: u32, confirm_window: u32) -> experiment::Outcome {
    let mut preset = presets::find(&format!("liang2009-{targets}")).unwrap();
    preset.body["seed"] = json!(seed);
    preset.body["associator"] = json!({"method": "oracle"});
    preset.body["tracker"]["confirm_hits"] = json!(confirm_hits);
    preset.body["tracker"]["confirm_window"] = json!(confirm_window);
    let plan = experiment::plan(preset.kind, &preset.body).unwrap();
    experiment::run(&plan, vec![], &mut Silent).unwrap()
}

/// For each target the numbers of the scans in which it was detected, from the simulated detections themselves.
fn detected_scans(outcome: &experiment::Outcome) -> std::collections::BTreeMap<String, Vec<u32>> {
    let csv = outcome
        .artifacts
        .iter()
        .find(|artifact| artifact.name == "detections.csv")
        .unwrap();
    let text = std::str::from_utf8(&csv.bytes).unwrap();
    let mut lines = text.lines();
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    let column = |name: &str| header.iter().position(|field| *field == name).unwrap();
    let (scan, truth_id) = (column("scan"), column("truth_id"));
    let mut scans: std::collections::BTreeMap<String, Vec<u32>> = Default::default();
    for fields in lines
        .map(|line| line.split(',').collect::<Vec<_>>())
        .filter(|fields| !fields[truth_id].is_empty())
    {
        scans
            .entry(fields[truth_id].to_owned())
            .or_default()
            .push(fields[scan].parse().unwrap());
    }
    scans
}

/// The strings of a target: cut where five scans or more in a row had no detection.
fn strings(scans: &[u32]) -> Vec<Vec<u32>> {
    let mut strings: Vec<Vec<u32>> = Vec::new();
    for &scan in scans {
        match strings.last_mut() {
            Some(string) if scan - string.last().unwrap() <= 5 => string.push(scan),
            _ => strings.push(vec![scan]),
        }
    }
    strings
}

fn is_confirmed(string: &[u32], hits: usize, window: u32) -> bool {
    string
        .windows(hits)
        .any(|part| part[hits - 1] - part[0] < window)
}

fn verdicts(outcome: &experiment::Outcome) -> Vec<(String, String)> {
    let targets = outcome.result["tfa"]["targets"].as_array().unwrap();
    let text = |target: &Value, name: &str| target[name].as_str().unwrap().to_owned();
    targets
        .iter()
        .map(|target| (text(target, "truth_id"), text(target, "verdict")))
        .collect()
}

const SCENES: [u32; 5] = [10, 30, 50, 80, 100];

#[test]
fn confirmed_at_the_first_detection_every_target_that_was_ever_detected_is_correct() {
    for (targets, seed) in SCENES
        .iter()
        .flat_map(|&targets| (1..=20).map(move |seed| (targets, seed)))
    {
        let outcome = judged(targets, seed, 1, 1);
        let detected = detected_scans(&outcome);
        for (truth_id, verdict) in verdicts(&outcome) {
            let expected = if detected.contains_key(&truth_id) {
                "correct"
            } else {
                "missed"
            };
            assert_eq!(
                verdict, expected,
                "target {truth_id} of {targets}, seed {seed}"
            );
        }
        let counts = &outcome.result["tfa"]["counts"];
        assert_eq!(
            counts["correct"],
            detected.len(),
            "{targets} targets, seed {seed}"
        );
        assert_eq!(counts["false"], 0, "{targets} targets, seed {seed}");
        assert!(detected.len() > targets as usize / 2);
    }
}

#[test]
fn with_m_of_n_exactly_the_targets_whose_detections_satisfy_it_are_correct() {
    let mut unsatisfied = 0;
    for (targets, seed) in SCENES
        .iter()
        .flat_map(|&targets| (1..=20).map(move |seed| (targets, seed)))
    {
        let outcome = judged(targets, seed, 3, 4);
        let detected = detected_scans(&outcome);
        for (truth_id, verdict) in verdicts(&outcome) {
            let confirmed: Vec<bool> = detected.get(&truth_id).map_or(Vec::new(), |scans| {
                strings(scans)
                    .iter()
                    .map(|string| is_confirmed(string, 3, 4))
                    .collect()
            });
            let expected = match (
                confirmed.is_empty(),
                confirmed.contains(&true),
                confirmed.contains(&false),
            ) {
                (false, true, false) => "correct",
                (_, false, _) => "missed",
                _ => "false",
            };
            unsatisfied += u32::from(expected != "correct");
            assert_eq!(
                verdict, expected,
                "target {truth_id} of {targets}, seed {seed}"
            );
        }
    }
    assert!(
        unsatisfied > 20,
        "the rule was hardly tried: only {unsatisfied} targets fail it"
    );
}
