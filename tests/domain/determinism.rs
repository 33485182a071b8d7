//! The same spec and seed give the same bytes, whoever computes beside it; and a target's noise is its own.

use serde_json::json;
use trackloom_domain::experiment::observer::Silent;
use trackloom_domain::experiment::{self, presets};

fn result_bytes(preset: &presets::Preset) -> Vec<u8> {
    let plan = experiment::plan(preset.kind, &preset.body).unwrap();
    let outcome = experiment::run(&plan, vec![], &mut Silent).unwrap();
    let mut bytes = serde_json::to_vec(&outcome.result).unwrap();
    for artifact in outcome.artifacts {
        bytes.extend(artifact.bytes);
    }
    bytes
}

#[test]
fn the_same_job_gives_the_same_bytes_on_one_thread_and_on_eight() {
    let mut scored = presets::find("liang2009-polar-100").unwrap();
    scored.body["associator"] = json!({"method": "jpda"});
    scored.body["tracker"]["confirmation"] = json!({"rule": "score"});
    for preset in [presets::find("liang2009-100").unwrap(), scored] {
        let alone = result_bytes(&preset);
        assert!(alone.len() > 100_000);
        std::thread::scope(|scope| {
            let runs: Vec<_> = (0..8)
                .map(|_| scope.spawn(|| result_bytes(&preset)))
                .collect();
            for run in runs {
                assert!(
                    run.join().unwrap() == alone,
                    "a run beside seven others differs"
                );
            }
        });
    }
}

#[test]
fn another_seed_gives_another_result() {
    let mut preset = presets::find("liang2009-10").unwrap();
    let first = result_bytes(&preset);
    preset.body["seed"] = json!(2);
    assert!(first != result_bytes(&preset));
}

/// (time, truth id, x, y) of every detection that came from a target with a number up to `last`.
fn detections_of_targets(count: u32, last: u32) -> Vec<String> {
    let preset = presets::find("liang2009-10").unwrap();
    let mut scenario = preset.body["input"]["scenario"].clone();
    scenario["targets"]["count"] = json!(count);
    let plan = experiment::plan(
        experiment::JobKind::Simulate,
        &json!({"scenario": scenario, "seed": 5}),
    )
    .unwrap();
    let outcome = experiment::run(&plan, vec![], &mut Silent).unwrap();
    let csv = outcome
        .artifacts
        .iter()
        .find(|artifact| artifact.name == "detections.csv")
        .unwrap();
    let mut reader = csv_rows(std::str::from_utf8(&csv.bytes).unwrap());
    reader.retain(|row| row["truth_id"].parse::<u32>().is_ok_and(|id| id <= last));
    let mut lines: Vec<String> = reader
        .iter()
        .map(|row| {
            format!(
                "{} {} {} {}",
                row["time_s"], row["truth_id"], row["x_m"], row["y_m"]
            )
        })
        .collect();
    lines.sort();
    lines
}

fn csv_rows(text: &str) -> Vec<std::collections::BTreeMap<String, String>> {
    let mut lines = text.lines();
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    lines
        .map(|line| {
            header
                .iter()
                .map(|name| name.to_string())
                .zip(line.split(',').map(str::to_owned))
                .collect()
        })
        .collect()
}

#[test]
fn adding_a_target_leaves_the_detections_of_the_others_unchanged() {
    let few = detections_of_targets(10, 10);
    assert!(few.len() > 100);
    assert_eq!(few, detections_of_targets(11, 10));
    assert_eq!(few, detections_of_targets(60, 10));
}
