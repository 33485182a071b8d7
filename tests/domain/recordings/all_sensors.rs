//! Radar, lidar and both cameras of the ferry in one tracker: the third table.

use super::{files_of, load};
use serde_json::{Value, json};
use std::path::Path;
use trackloom_domain::experiment::observer::Silent;
use trackloom_domain::experiment::{self, Input, JobKind, Outcome};
use trackloom_domain::formats::{ReadOptions, format_named};
use trackloom_domain::model::dataset::{Dataset, DatasetKind};

/// The sensors whose reports start tracks, and at whose scans tracks are judged.
const STARTING: [&str; 2] = ["lidar", "radar"];

/// Who is tracked with: the cameras too or not, and how long the errors of their bearings last.
const WHO: [(&str, bool, Option<f64>); 3] = [
    ("radar, lidar", false, None),
    ("and cameras, errors independent", true, None),
    ("and cameras, errors of 4 s", true, Some(4.0)),
];

/// As in the document.
fn request(has_cameras: bool, error_correlation_s: Option<f64>) -> Value {
    let of_places = |name: &str, sigma_m: f64| json!({"sensor_id": name, "p_d": 0.9, "clutter_per_m2": 1e-4, "sigma_x_m": sigma_m, "sigma_y_m": sigma_m});
    let camera = |name: &str, p_d: f64| {
        let mut camera = json!({"sensor_id": name, "p_d": p_d, "clutter_per_deg": 0.01, "sigma_bearing_deg": 2.5, "may_start": false});
        if let Some(correlation_s) = error_correlation_s {
            camera["error_correlation_s"] = json!(correlation_s);
        }
        camera
    };
    let mut sensors = vec![of_places("radar", 4.0), of_places("lidar", 2.0)];
    let mut sensor_ids = STARTING.to_vec();
    if has_cameras {
        sensors.extend([camera("daylight", 0.7), camera("infrared", 0.4)]);
        sensor_ids.extend(["daylight", "infrared"]);
    }
    json!({
        "input": {"source": "dataset", "dataset_id": "detections", "sensor_ids": sensor_ids},
        "sensors": sensors,
        "associator": {"method": "global_nearest_neighbour"},
        "filter": {"method": "extended", "process_noise_m2ps3": 0.05},
        "tracker": {
            "gate_probability": 0.99, "max_missed": 1000, "initial_speed_sigma_mps": 3.0,
            "confirmation": {"rule": "score", "false_track_probability": 1e-9, "max_score_drop": 5.0}
        }
    })
}

/// All cases are judged at the scans of the radar and the lidar.
fn judgement() -> Value {
    json!({
        "tracks": {"source": "dataset", "dataset_id": "tracks", "sensor_ids": STARTING},
        "truth": {"source": "dataset", "dataset_id": "truth"},
        "detections": {"source": "dataset", "dataset_id": "detections", "sensor_ids": STARTING},
        "comparison": {"gate_m": 30.0, "credit": "afterwards"},
        "metrics": [{"metric": "gospa", "cutoff_m": 30.0}, {"metric": "clear"}, {"metric": "kinematics"}]
    })
}

fn done(kind: JobKind, request: &Value, datasets: &[&Dataset]) -> Outcome {
    let plan = experiment::plan(kind, request).unwrap_or_else(|faults| panic!("{faults:?}"));
    let inputs = plan.inputs.iter().map(|input| {
        let wanted = |dataset: &&&Dataset| dataset.kind() == input.role;
        let dataset = (**datasets.iter().find(wanted)?).clone();
        Some(Input {
            dataset,
            sensors: Vec::new(),
            sha256: String::new(),
        })
    });
    experiment::run(&plan, inputs.collect(), &mut Silent).unwrap()
}

/// Only what is of these sensors: of an input that a job finds itself its `sensor_ids` would say it.
fn only(dataset: &Dataset, sensor_ids: &[&str]) -> Dataset {
    let sensor_ids: Vec<String> = sensor_ids.iter().map(|name| (*name).to_owned()).collect();
    match dataset.clone() {
        Dataset::Detections(recording) => {
            Dataset::Detections(recording.only_sensors(&sensor_ids).unwrap())
        }
        Dataset::Tracks(tracks) => Dataset::Tracks(tracks.only_sensors(&sensor_ids).unwrap()),
        other => panic!("{}", other.kind().name()),
    }
}

fn tracked(detections: &Dataset, request: &Value) -> (Dataset, u64) {
    let sensor_ids = request["input"]["sensor_ids"].as_array().unwrap();
    let sensor_ids: Vec<&str> = sensor_ids.iter().filter_map(Value::as_str).collect();
    let outcome = done(
        JobKind::Associate,
        request,
        &[&only(detections, &sensor_ids)],
    );
    let is_tracks = |file: &&experiment::Artifact| file.name == "tracks.csv";
    let file = outcome.artifacts.iter().find(is_tracks).unwrap();
    let read = format_named("csv").unwrap().read;
    let read = read(&mut file.bytes.as_slice(), &ReadOptions::default()).unwrap();
    let count = outcome.result["association"]["counts"]["tracks"].as_u64();
    (read.dataset, count.unwrap())
}

pub fn table(folder: &Path, scenarios: &[u32]) -> String {
    let mut text = String::from(
        "\n| scenario | sensors | tracks | mean GOSPA (m) | MOTA | recall | position RMSE (m) | breaks |\n|---|---|---|---|---|---|---|---|\n",
    );
    for &scenario in scenarios {
        let [detections, truth] = files_of(scenario);
        let detections = load(folder, &detections, DatasetKind::Detections);
        let truth = load(folder, &truth, DatasetKind::Truth);
        for (who, has_cameras, correlation_s) in WHO {
            let (tracks, count) = tracked(&detections, &request(has_cameras, correlation_s));
            let judged = [
                &only(&tracks, &STARTING),
                &only(&detections, &STARTING),
                &truth,
            ];
            let result = done(JobKind::Evaluate, &judgement(), &judged).result;
            let value = |pointer: &str, digits: usize| {
                let value = result.pointer(pointer).and_then(Value::as_f64);
                value.map_or("–".to_owned(), |number| format!("{number:.digits$}"))
            };
            text += &format!(
                "| {scenario} | {who} | {count} | {} | {} | {} | {} | {} |\n",
                value("/metrics/gospa/value", 1),
                value("/metrics/clear/quantities/mota/value", 3),
                value("/metrics/clear/quantities/recall/value", 3),
                value("/metrics/kinematics/quantities/position_rmse/value", 1),
                value("/events/counts/break", 0),
            );
        }
    }
    text
}
