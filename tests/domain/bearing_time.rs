//! Bearing-time records from simulation or file to tracks.

use serde_json::{Value, json};
use trackloom_domain::experiment::observer::Silent;
use trackloom_domain::experiment::{Input, JobKind, Outcome, RunError, plan, presets, run};
use trackloom_domain::formats::{ReadOptions, format_named};
use trackloom_domain::model::fault::Fault;

fn outcome(kind: JobKind, body: &Value, inputs: Vec<Option<Input>>) -> Result<Outcome, Vec<Fault>> {
    let plan = plan(kind, body)?;
    run(&plan, inputs, &mut Silent).map_err(|error| match error {
        RunError::Faults(faults) => faults,
        RunError::Stopped => Vec::new(),
    })
}

fn found(result: Result<Outcome, Vec<Fault>>) -> Vec<(String, String)> {
    result
        .expect_err("there are faults")
        .into_iter()
        .map(|fault| (fault.pointer, fault.code))
        .collect()
}

fn preset() -> Value {
    presets::find("wang-bat-record")
        .expect("the preset is there")
        .body
}

fn file(outcome: &Outcome, name: &str) -> Vec<u8> {
    outcome
        .artifacts
        .iter()
        .find(|artifact| artifact.name == name)
        .unwrap_or_else(|| panic!("no {name}"))
        .bytes
        .clone()
}

/// The preset with two targets and a quarter of its time.
fn short() -> Value {
    let mut body = preset();
    body["input"]["scenario"]["scans"] = json!(30);
    body["input"]["scenario"]["targets"]["crossings"] = json!([]);
    body
}

#[test]
fn the_preset_keeps_its_targets_and_says_how_well_it_detects() {
    let outcome = outcome(JobKind::Evaluate, &preset(), vec![]).unwrap();
    let picture = String::from_utf8(file(&outcome, "record.svg")).unwrap();
    let circles = picture.matches("<circle").count();
    assert_eq!(
        circles as f64,
        outcome.result["detection"]["detections"].as_f64().unwrap() + 1.0,
        "each detection, and one in the legend"
    );
    let detection = &outcome.result["detection"];
    let number = |name: &str| {
        detection[name]
            .as_f64()
            .unwrap_or_else(|| panic!("no {name}"))
    };
    assert_eq!(
        (number("scans"), number("gate_deg"), number("cells")),
        (120.0, 2.0, 432_000.0)
    );
    assert!((0.85..1.0).contains(&number("p_d")), "{detection}");
    assert!(
        (0.5..3.5).contains(&number("false_alarms_per_scan")),
        "{detection}"
    );
    assert!(
        (0.05..0.6).contains(&number("bearing_rmse_deg")),
        "{detection}"
    );
    let error_deg = outcome.result["metrics"]["track_keeping"]["quantities"]["mean_absolute_error"]
        ["value"]
        .as_f64()
        .unwrap();
    assert!(error_deg < 1.0, "{error_deg}");
    // The noise that is estimated is that of the detections, within a third.
    let sigma_deg = outcome.result["association"]["sensors"][0]["sigma_bearing_deg"]
        .as_f64()
        .unwrap();
    assert!(
        (0.75..1.33).contains(&(sigma_deg / number("bearing_rmse_deg"))),
        "{sigma_deg}"
    );
    let kept = &outcome.result["metrics"]["track_keeping"]["quantities"]["targets_identity"];
    assert!(kept["value"].as_f64().is_some(), "{kept}");
    assert!(
        outcome
            .warnings
            .iter()
            .any(|warning| warning.contains("the noise of its bearings is not known")),
        "{:?}",
        outcome.warnings
    );
}

#[test]
fn a_record_from_a_file_gives_what_the_simulated_one_gives() {
    let body = short();
    let scenario = &body["input"]["scenario"];
    let simulated = outcome(JobKind::Simulate, &json!({"scenario": scenario}), vec![]).unwrap();
    assert_eq!(
        simulated.result["counts"],
        json!({"sensors": 1, "scans": 300, "targets": 2, "detections": 0, "clutter": 0, "cells": 108_000})
    );
    let bytes = file(&simulated, "bearing_time.csv");
    let read = |bytes: &[u8], format: &str| {
        let read = format_named(format).unwrap().read;
        let mut bytes = bytes;
        let dataset = read(&mut bytes, &ReadOptions::default()).unwrap().dataset;
        Some(Input {
            dataset,
            sensors: vec![],
            sha256: String::new(),
        })
    };
    let direct = outcome(JobKind::Evaluate, &body, vec![]).unwrap();
    let mut from_file = json!({
        "input": {"source": "dataset", "dataset_id": "record"}, "truth": {"source": "dataset", "dataset_id": "truth"},
        "detector": {}, "sensors": [{"sensor_id": "sonar", "p_d": 0.95}],
    });
    for name in ["seed", "associator", "filter", "tracker"] {
        from_file[name] = body[name].clone();
    }
    let inputs = vec![
        read(&bytes, "csv"),
        read(&file(&simulated, "truth.csv"), "csv"),
    ];
    let again = outcome(JobKind::Evaluate, &from_file, inputs.clone()).unwrap();
    assert_eq!(again.result["detection"], direct.result["detection"]);
    assert_eq!(
        file(&again, "detections.csv"),
        file(&direct, "detections.csv")
    );
    assert_eq!(file(&again, "tracks.csv"), file(&direct, "tracks.csv"));

    from_file.as_object_mut().unwrap().remove("detector");
    assert_eq!(
        found(outcome(JobKind::Evaluate, &from_file, inputs)),
        [("/input".to_owned(), "wrong_type".to_owned())]
    );
}

#[test]
fn a_detector_stands_where_there_is_a_record() {
    let pair = |pointer: &str, code: &str| (pointer.to_owned(), code.to_owned());
    let mut body = short();
    body["detector"] = json!({"threshold": {"kind": "cell_averaging", "training_cells": 0}, "every_s": 0, "wings": 2});
    assert_eq!(
        found(outcome(JobKind::Evaluate, &body, vec![])),
        [
            pair("/detector/threshold/training_cells", "out_of_range"),
            pair("/detector/every_s", "out_of_range"),
            pair("/detector/wings", "unknown_field")
        ]
    );
    let mut body = short();
    body["detector"] = json!({"threshold": {"kind": "cell_averaging", "training_cells": 300}});
    assert_eq!(
        found(outcome(JobKind::Evaluate, &body, vec![])),
        [pair("/detector/threshold/training_cells", "out_of_range")]
    );
    let mut body = short();
    body["input"]["scenario"]
        .as_object_mut()
        .unwrap()
        .remove("record");
    body["input"]["scenario"]["sensors"][0]["sigma_bearing_deg"] = json!(1.0);
    assert_eq!(
        found(outcome(JobKind::Evaluate, &body, vec![])),
        [pair("/detector", "conflict")]
    );
    let tracks = json!({"tracks": {"source": "job", "job_id": "x"}, "detector": {}});
    assert_eq!(
        found(outcome(JobKind::Evaluate, &tracks, vec![])),
        [pair("/detector", "conflict")]
    );
}
