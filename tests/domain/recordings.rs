//! Real recordings under every associator: the tables of `docs/recordings.md`, which this test keeps true.
//!
//! `TRACKLOOM_WRITE_RECORDINGS=1 TRACKLOOM_DATA=<folder> cargo test --test domain recordings` writes the file anew.

mod all_sensors;

use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use trackloom_domain::association::ASSOCIATORS;
use trackloom_domain::detection::{Quality, assign_origins};
use trackloom_domain::experiment::observer::Silent;
use trackloom_domain::experiment::{self, Input, JobKind};
use trackloom_domain::formats::{ReadOptions, format_named};
use trackloom_domain::model::dataset::{Dataset, DatasetKind};
use trackloom_domain::model::space::Space;
use trackloom_domain::model::state::Position;
use trackloom_domain::model::truth::{Target, TruthPoint, TruthSet};

const SCENARIOS: [u32; 6] = [2, 3, 4, 5, 6, 17];
pub(crate) const DOCUMENT: &str = "docs/recordings.md";
const BEGIN: &str = "<!-- the tables below are written by tests/recordings.rs -->\n";

/// The settings of every run, as in the document.
pub(crate) fn request(associator: &str) -> Value {
    json!({
        "input": {"source": "dataset", "dataset_id": "detections", "sensor_ids": ["radar"]},
        "truth": {"source": "dataset", "dataset_id": "truth"},
        "sensors": [{"sensor_id": "radar", "p_d": 0.9, "clutter_per_m2": 1e-5, "sigma_x_m": 4.0, "sigma_y_m": 4.0}],
        "associator": {"method": associator},
        "filter": {"method": "kalman", "process_noise_m2ps3": 0.05},
        "tracker": {"gate_probability": 0.99, "confirm_hits": 6, "confirm_window": 8, "max_missed": 5, "initial_speed_sigma_mps": 3.0},
        "comparison": {"gate_m": 30.0, "credit": "afterwards"},
        "metrics": [{"metric": "gospa", "cutoff_m": 30.0}, {"metric": "clear"}, {"metric": "kinematics"}],
        "tfa": {"symbols": {"kind": "nearest_truth", "gate_m": 30.0, "max_gap_s": 5.0}, "max_missed": 5}
    })
}

/// JPDA with tracks that begin over several scans and exist with a probability, and the density of clutter of the document.
fn with_existence() -> Value {
    let mut request = request("jpda");
    request["sensors"][0]["clutter_per_m2"] = json!(8e-4);
    request["tracker"]["initiation"] = json!({"method": "multi_scan"});
    request["tracker"]["confirmation"] = json!({"rule": "existence", "confirm_existence": 0.999});
    request
}

pub(crate) fn load(folder: &Path, name: &str, kind: DatasetKind) -> Dataset {
    let format = format_named("autoferry").expect("the format is in the table");
    let options = ReadOptions {
        kind: Some(kind),
        ..ReadOptions::default()
    };
    let read = (format.read)(&mut bytes_of(folder, name).as_slice(), &options)
        .unwrap_or_else(|faults| panic!("{name}: {faults:?}"));
    read.dataset
}

fn bytes_of(folder: &Path, name: &str) -> Vec<u8> {
    std::fs::read(folder.join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// Detections of one sensor, and truth.
pub(crate) fn inputs(detections: &Dataset, sensor_id: &str, truth: &Dataset) -> [Option<Input>; 2] {
    let Dataset::Detections(recording) = detections else {
        panic!("detections")
    };
    let of_sensor = Dataset::Detections(recording.only_sensors(&[sensor_id.to_owned()]).unwrap());
    [of_sensor, truth.clone()].map(|dataset| {
        Some(Input {
            dataset,
            sensors: Vec::new(),
            sha256: String::new(),
        })
    })
}

/// One line of the table.
fn line(scenario: u32, name: &str, request: &Value, inputs: &[Option<Input>]) -> String {
    let plan = experiment::plan(JobKind::Evaluate, request).unwrap();
    let outcome = experiment::run(&plan, inputs.to_vec(), &mut Silent).unwrap();
    let value = |pointer: &str| {
        outcome
            .result
            .pointer(pointer)
            .cloned()
            .unwrap_or(Value::Null)
    };
    let whole = |pointer: &str| {
        value(pointer)
            .as_u64()
            .map_or("–".to_owned(), |count| count.to_string())
    };
    let decimal = |pointer: &str, digits: usize| {
        value(pointer)
            .as_f64()
            .map_or("–".to_owned(), |number| format!("{number:.digits$}"))
    };
    let causes = |cause: &str| {
        let breaks = value("/events/breaks");
        breaks
            .as_array()
            .unwrap()
            .iter()
            .filter(|found| found["cause"] == cause)
            .count()
    };
    format!(
        "| {scenario} | {name} | {} | {} / {} / {} | {} | {} | {} | {} | {} ({} / {} / {}) |\n",
        whole("/association/counts/tracks"),
        whole("/tfa/counts/correct"),
        whole("/tfa/counts/missed"),
        whole("/tfa/counts/false"),
        decimal("/metrics/gospa/value", 1),
        decimal("/metrics/clear/quantities/mota/value", 3),
        decimal("/metrics/kinematics/quantities/position_rmse/value", 1),
        whole("/events/counts/switch"),
        whole("/events/counts/break"),
        causes("ended"),
        causes("took_other_target"),
        causes("left_gate"),
    )
}

pub(crate) fn files_of(scenario: u32) -> [String; 2] {
    ["detections", "groundTruth"].map(|what| format!("scenario{scenario}_{what}.json"))
}

/// The scenarios whose files are all there; says of the others what they lack.
pub(crate) fn present(folder: &Path) -> Vec<u32> {
    let lacks = |scenario: u32| {
        files_of(scenario)
            .into_iter()
            .find(|name| !folder.join(name).exists())
    };
    let is_present = |scenario: &u32| match lacks(*scenario) {
        Some(name) => {
            println!(
                "skipped: scenario {scenario}, for {name} is not in {}",
                folder.display()
            );
            false
        }
        None => true,
    };
    SCENARIOS.into_iter().filter(is_present).collect()
}

/// The lines of a table that are not of scenarios left out.
pub(crate) fn lines_of(table: &str, scenarios: &[u32]) -> String {
    let is_left_out = |line: &&str| {
        let first = line
            .trim_start_matches('|')
            .split('|')
            .next()
            .and_then(|cell| cell.trim().parse::<u32>().ok());
        first.is_some_and(|scenario| !scenarios.contains(&scenario))
    };
    table
        .trim()
        .lines()
        .filter(|line| !is_left_out(line))
        .collect::<Vec<_>>()
        .join("\n")
}

fn table(folder: &Path, scenarios: &[u32]) -> String {
    let mut text = String::from(
        "| scenario | associator | tracks | correct / missed / false | mean GOSPA (m) | MOTA | position RMSE (m) | switches | breaks (ended / took other / left gate) |\n\
         |---|---|---|---|---|---|---|---|---|\n",
    );
    for &scenario in scenarios {
        let [detections, truth] = files_of(scenario);
        let [detections, truth] = [
            load(folder, &detections, DatasetKind::Detections),
            load(folder, &truth, DatasetKind::Truth),
        ];
        let inputs = inputs(&detections, "radar", &truth);
        for method in ASSOCIATORS
            .iter()
            .filter(|method| !["oracle", "strongest_neighbour"].contains(&method.name))
        {
            let request = request(method.name);
            text.push_str(&line(scenario, method.name, &request, &inputs));
        }
        let request = with_existence();
        text.push_str(&line(scenario, "jpda, existence", &request, &inputs));
    }
    text
}

/// A bearing this near to the true one is of that boat.
const CAMERA_GATE_DEG: f64 = 5.0;

/// The settings of every run on a camera, as in the document.
fn camera_request(camera: &str, associator: &str) -> Value {
    json!({
        "input": {"source": "dataset", "dataset_id": "detections", "sensor_ids": [camera]},
        "truth": {"source": "dataset", "dataset_id": "truth"},
        "sensors": [{"sensor_id": camera, "p_d": 0.7, "clutter_per_deg": 0.01, "sigma_bearing_deg": 2.0}],
        "associator": {"method": associator},
        "filter": {"method": "bearing_only", "process_noise_deg2ps3": 0.05, "initial_rate_sigma_degps": 1.5},
        "tracker": {"gate_probability": 0.99, "confirm_hits": 6, "confirm_window": 8, "max_missed": 15},
        "comparison": {"gate_deg": CAMERA_GATE_DEG, "credit": "afterwards"},
        "metrics": [{"metric": "track_keeping"}]
    })
}

/// Truth as directions from where the ferry is at that time.
fn seen_from_the_ferry(truth: &Dataset, detections: &[u8]) -> Dataset {
    let Dataset::Truth(truth) = truth else {
        panic!("truth")
    };
    let scans: Vec<Value> = serde_json::from_slice(detections).unwrap();
    let number = |value: &Value| value.as_f64().unwrap();
    let place = |scan: &Value| {
        Position::new(
            number(&scan["ownshipPosition"][1]),
            number(&scan["ownshipPosition"][0]),
        )
    };
    let mut places: Vec<(f64, Position)> = scans
        .iter()
        .map(|scan| (number(&scan["time"]), place(scan)))
        .collect();
    places.sort_by(|left, right| left.0.total_cmp(&right.0));
    let ferry_at = |time_s: f64| {
        places[places
            .partition_point(|place| place.0 < time_s)
            .min(places.len() - 1)]
        .1
    };
    let direction = |point: &TruthPoint| {
        let away_m = point.position.xy() - ferry_at(point.time_s);
        TruthPoint::at_bearing(
            point.time_s,
            away_m.x.atan2(away_m.y).rem_euclid(std::f64::consts::TAU),
        )
    };
    let target = |target: &Target| Target {
        truth_id: target.truth_id.clone(),
        points: target.points.iter().map(direction).collect(),
    };
    let targets = truth.targets().iter().map(target).collect();
    Dataset::Truth(TruthSet::new(Space::Bearing, targets).unwrap())
}

/// The inputs of a camera, each detection with the boat that it is of, and what that says of the camera.
fn camera_inputs(
    detections: &Dataset,
    camera: &str,
    truth: &Dataset,
) -> ([Option<Input>; 2], Quality) {
    let mut inputs = inputs(detections, camera, truth);
    let (
        Some(Input {
            dataset: Dataset::Detections(recording),
            ..
        }),
        Dataset::Truth(truth),
    ) = (&mut inputs[0], truth)
    else {
        panic!("detections and truth")
    };
    let (with_origins, quality) =
        assign_origins(std::mem::take(recording), truth, CAMERA_GATE_DEG).unwrap();
    *recording = with_origins;
    (inputs, quality)
}

/// One line of the table of cameras.
fn camera_line(
    (scenario, camera): (u32, &str),
    quality: &Quality,
    associator: &str,
    inputs: &[Option<Input>],
) -> String {
    let plan = experiment::plan(JobKind::Evaluate, &camera_request(camera, associator)).unwrap();
    let outcome = experiment::run(&plan, inputs.to_vec(), &mut Silent).unwrap();
    let count = |name: &str| outcome.result["events"]["counts"][name].as_u64().unwrap();
    let (matches, misses) = (count("match"), count("miss"));
    let idle = count("false_alarm") + count("divergence") + count("redundant");
    let tracks = outcome.result["association"]["counts"]["tracks"]
        .as_u64()
        .unwrap();
    let shares = [
        matches as f64 / (matches + misses) as f64,
        idle as f64 / (matches + idle) as f64,
    ];
    let [followed, other] = shares.map(|share| format!("{:.0} %", 100.0 * share));
    let (switches, breaks) = (count("switch"), count("break"));
    let [p_d, clutter, error_deg] = [
        quality.p_d,
        quality.false_alarms_per_scan,
        quality.bearing_rmse_deg,
    ]
    .map(Option::unwrap);
    let of_camera = format!("{p_d:.2} | {clutter:.1} | {error_deg:.1}");
    format!(
        "| {scenario} | {camera} | {of_camera} | {associator} | {tracks} | {followed} | {other} | {switches} | {breaks} |\n"
    )
}

fn camera_table(folder: &Path, scenarios: &[u32]) -> String {
    let mut text = String::from(
        "\n| scenario | camera | P_D | false a scan | bearing error (deg) | associator | tracks | boats followed | tracks elsewhere | switches | breaks |\n\
         |---|---|---|---|---|---|---|---|---|---|---|\n",
    );
    for &scenario in scenarios {
        let [detections, truth] = files_of(scenario);
        let bytes = bytes_of(folder, &detections);
        let truth = seen_from_the_ferry(&load(folder, &truth, DatasetKind::Truth), &bytes);
        let detections = load(folder, &detections, DatasetKind::Detections);
        for camera in ["daylight", "infrared"] {
            let (inputs, quality) = camera_inputs(&detections, camera, &truth);
            for associator in [
                "nearest_neighbour",
                "global_nearest_neighbour",
                "pda",
                "jpda",
            ] {
                text.push_str(&camera_line(
                    (scenario, camera),
                    &quality,
                    associator,
                    &inputs,
                ));
            }
        }
    }
    text
}

#[test]
fn the_table_of_recordings_is_what_the_tracker_does() {
    let folder =
        std::env::var_os("TRACKLOOM_DATA").map(|folder| PathBuf::from(folder).join("autoferry"));
    let Some(folder) = folder else {
        println!("skipped: TRACKLOOM_DATA names no folder with autoferry recordings");
        return;
    };
    let scenarios = present(&folder);
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("..")
        .join(DOCUMENT);
    let document = std::fs::read_to_string(&path).unwrap();
    let (head, written) = document
        .split_once(BEGIN)
        .expect("the document has the line before its table");
    let made = table(&folder, &scenarios)
        + &camera_table(&folder, &scenarios)
        + &all_sensors::table(&folder, &scenarios);
    if std::env::var_os("TRACKLOOM_WRITE_RECORDINGS").is_some() {
        assert_eq!(
            scenarios, SCENARIOS,
            "the table is written of all scenarios or not at all"
        );
        std::fs::write(&path, format!("{head}{BEGIN}\n{made}")).unwrap();
        return;
    }
    assert_eq!(
        lines_of(written, &scenarios),
        made.trim(),
        "write it anew with TRACKLOOM_WRITE_RECORDINGS=1 and look at what changed"
    );
}

#[test]
fn a_scenario_that_lacks_a_file_is_left_out_of_both_tables() {
    let folder = tempfile::tempdir().unwrap();
    for scenario in [3, 17] {
        files_of(scenario)
            .iter()
            .for_each(|name| std::fs::write(folder.path().join(name), "[]").unwrap());
    }
    std::fs::write(folder.path().join(&files_of(4)[0]), "[]").unwrap();
    assert_eq!(present(folder.path()), [3, 17]);
    assert_eq!(
        lines_of(
            "| scenario | x |\n|---|---|\n| 3 | a |\n| 4 | b |\n| 17 | c |\n",
            &[3, 17]
        ),
        "| scenario | x |\n|---|---|\n| 3 | a |\n| 17 | c |"
    );
}
