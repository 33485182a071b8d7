//! Radar and lidar of a real recording tracked each by itself, put together and fused, and judged against the boats beside the tracks
//! of each sensor alone: the table of `docs/correlation.md`, which this test keeps true.
//!
//! `TRACKLOOM_WRITE_TABLES=1 cargo test --test domain two_sensors` writes the table anew.

use serde_json::{Value, json};
use std::path::Path;
use trackloom_domain::experiment::observer::Silent;
use trackloom_domain::experiment::{self, Input, JobKind, Outcome};
use trackloom_domain::formats::{ReadOptions, format_named};
use trackloom_domain::model::dataset::{Dataset, DatasetKind};

const DOCUMENT: &str = "docs/correlation.md";
const BEGIN: &str = "<!-- the table below is written by tests/two_sensors.rs -->\n";
const END: &str = "<!-- end of the table -->\n";

/// The detections of some sensors.
fn detections(sensor_ids: &[&str]) -> Option<Input> {
    let input = recording("detections.json", DatasetKind::Detections)?;
    let Dataset::Detections(recording) = input.dataset else {
        panic!("detections")
    };
    let sensor_ids: Vec<String> = sensor_ids.iter().map(|name| (*name).to_owned()).collect();
    Some(Input {
        dataset: Dataset::Detections(recording.only_sensors(&sensor_ids).unwrap()),
        sensors: input.sensors,
        sha256: input.sha256,
    })
}

fn truth() -> Option<Input> {
    recording("groundTruth.json", DatasetKind::Truth)
}

fn recording(name: &str, kind: DatasetKind) -> Option<Input> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("..")
        .join("examples/data/autoferry-scenario2")
        .join(name);
    let options = ReadOptions {
        kind: Some(kind),
        ..ReadOptions::default()
    };
    let read = (format_named("autoferry").unwrap().read)(
        &mut std::fs::read(path).unwrap().as_slice(),
        &options,
    )
    .unwrap();
    Some(Input {
        dataset: read.dataset,
        sensors: Vec::new(),
        sha256: String::new(),
    })
}

fn dataset(name: &str) -> Value {
    json!({"source": "dataset", "dataset_id": name})
}

/// What both jobs say of the sensors and their trackers.
fn tracked(sensor_ids: &[&str]) -> Value {
    let mut input = dataset("detections");
    input["sensor_ids"] = json!(sensor_ids);
    let sensor = |name: &str, clutter_per_m2: f64, sigma_m: f64| json!({"sensor_id": name, "p_d": 0.9, "clutter_per_m2": clutter_per_m2, "sigma_x_m": sigma_m, "sigma_y_m": sigma_m});
    let sensors: Vec<Value> = sensor_ids
        .iter()
        .map(|name| {
            if *name == "radar" {
                sensor(name, 1e-5, 4.0)
            } else {
                sensor(name, 1e-5, 2.0)
            }
        })
        .collect();
    json!({
        "input": input,
        "truth": dataset("truth"),
        "sensors": sensors,
        "associator": {"method": "global_nearest_neighbour"},
        "filter": {"method": "kalman", "process_noise_m2ps3": 0.05},
        "tracker": {"gate_probability": 0.99, "confirm_hits": 6, "confirm_window": 8, "max_missed": 5, "initial_speed_sigma_mps": 3.0}
    })
}

fn done(kind: JobKind, body: &Value, inputs: Vec<Option<Input>>) -> Outcome {
    experiment::run(
        &experiment::plan(kind, body).unwrap_or_else(|faults| panic!("{faults:?}")),
        inputs,
        &mut Silent,
    )
    .unwrap()
}

fn judged(mut body: Value, inputs: Vec<Option<Input>>) -> Value {
    body["comparison"] = json!({"gate_m": 30.0, "credit": "afterwards"});
    if body.get("tracks").is_some() {
        // Tracks that were put together are a second apart, the truth a tenth of that.
        body["comparison"]["steps"] = json!("every_s");
        body["comparison"]["every_s"] = json!(1.0);
    }
    body["metrics"] = json!([{"metric": "gospa", "cutoff_m": 30.0}, {"metric": "clear"}, {"metric": "kinematics"}]);
    body["tfa"] = json!({"symbols": {"kind": "nearest_truth", "gate_m": 30.0, "max_gap_s": 5.0}, "max_missed": 5});
    done(JobKind::Evaluate, &body, inputs).result
}

fn line(name: &str, result: &Value) -> String {
    let value = |pointer: &str, digits: usize| match result.pointer(pointer).and_then(Value::as_f64)
    {
        Some(number) => format!("{number:.digits$}"),
        None => "–".to_owned(),
    };
    format!(
        "| {name} | {} | {} | {} | {} | {} | {} |\n",
        value("/tfa/counts/output_tracks", 0),
        value("/metrics/gospa/value", 1),
        value("/metrics/clear/quantities/mota/value", 3),
        value("/metrics/clear/quantities/recall/value", 3),
        value("/metrics/kinematics/quantities/position_rmse/value", 1),
        value("/events/counts/break", 0),
    )
}

/// The system tracks of a job that puts both sensors' tracks together, all or those that both have.
fn fused(fusion: &str, keeps_alone: bool) -> (Option<Input>, Value) {
    let mut body = tracked(&["radar", "lidar"]);
    body["alignment"] = json!({"period_s": 1.0, "max_gap_s": 3.0, "process_noise_m2ps3": 0.05});
    body["statistic"] = json!({"kind": "chain", "k": "latest", "alpha": 1e-4});
    body["correlator"] = json!({"method": "genetic"});
    body["fusion"] = json!({"method": fusion});
    body["keep_unassociated"] = json!(keeps_alone);
    let outcome = done(
        JobKind::Correlate,
        &body,
        vec![detections(&["radar", "lidar"]), truth()],
    );
    let file = outcome
        .artifacts
        .iter()
        .find(|file| file.name == "system_tracks.csv")
        .unwrap();
    let read =
        (format_named("csv").unwrap().read)(&mut file.bytes.as_slice(), &ReadOptions::default())
            .unwrap();
    (
        Some(Input {
            dataset: read.dataset,
            sensors: Vec::new(),
            sha256: String::new(),
        }),
        outcome.result,
    )
}

fn table() -> String {
    let mut table =
        "| tracks of | tracks | mean GOSPA (m) | MOTA | recall | position RMSE (m) | breaks |\n|---|---|---|---|---|---|---|\n".to_owned();
    for sensor in ["radar", "lidar"] {
        table += &line(
            sensor,
            &judged(tracked(&[sensor]), vec![detections(&[sensor]), truth()]),
        );
    }
    for (keeps_alone, which) in [
        (true, "both, with what one alone has"),
        (false, "both, what both have"),
    ] {
        for fusion in ["weighted", "covariance_intersection", "best_sensor"] {
            let body = json!({"truth": dataset("truth"), "tracks": dataset("tracks")});
            table += &line(
                &format!("{which}: `{fusion}`"),
                &judged(body, vec![fused(fusion, keeps_alone).0, truth()]),
            );
        }
    }
    table
}

#[test]
fn the_table_of_two_sensors_is_what_the_jobs_do() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("..")
        .join(DOCUMENT);
    let document = std::fs::read_to_string(&path).unwrap();
    let (head, rest) = document
        .split_once(BEGIN)
        .expect("the document has the line before its table");
    let (written, tail) = rest
        .split_once(END)
        .expect("the document has the line after its table");
    let made = table();
    if std::env::var_os("TRACKLOOM_WRITE_TABLES").is_some() {
        std::fs::write(&path, format!("{head}{BEGIN}\n{made}\n{END}{tail}")).unwrap();
        return;
    }
    assert_eq!(
        written.trim(),
        made.trim(),
        "write it anew with TRACKLOOM_WRITE_TABLES=1 and look at what changed"
    );
}

#[test]
fn nothing_is_put_together_that_is_of_different_boats() {
    let result = fused("weighted", true).1;
    assert_eq!(result["truth"]["pairwise_precision"], 1.0);
    assert_eq!(
        (&result["counts"]["tuples"], &result["gap"]),
        (&json!(2), &json!(0.0))
    );
}
