//! Real recordings under every associator: the table of `docs/recordings.md`, which this test keeps true.
//!
//! `TRACKLOOM_WRITE_RECORDINGS=1 TRACKLOOM_DATA=<folder> cargo test --test recordings` writes the file anew.

use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use trackloom::association::ASSOCIATORS;
use trackloom::experiment::observer::Silent;
use trackloom::experiment::plan::{self, JobKind};
use trackloom::experiment::run::{self, Input};
use trackloom::formats::{ReadOptions, format_named};
use trackloom::model::dataset::{Dataset, DatasetKind};

const SCENARIOS: [u32; 6] = [2, 3, 4, 5, 6, 17];
const DOCUMENT: &str = "docs/recordings.md";
const BEGIN: &str = "<!-- the table below is written by tests/recordings.rs -->\n";

/// The settings of every run, as in the document.
fn request(associator: &str) -> Value {
    json!({
        "input": {"source": "dataset", "dataset_id": "detections", "sensor_ids": ["radar"]},
        "truth": {"source": "dataset", "dataset_id": "truth"},
        "sensors": [{"sensor_id": "radar", "p_d": 0.9, "clutter_per_m2": 1e-5, "sigma_x_m": 4.0, "sigma_y_m": 4.0}],
        "associator": {"method": associator},
        "filter": {"method": "kalman", "process_noise_m2ps3": 0.05},
        "tracker": {"gate_probability": 0.99, "confirm_hits": 6, "confirm_window": 8, "max_missed": 5, "initial_speed_sigma_mps": 3.0},
        "comparison": {"gate_m": 30.0},
        "metrics": [{"metric": "gospa", "cutoff_m": 30.0}, {"metric": "clear"}, {"metric": "kinematics"}],
        "tfa": {"symbols": {"kind": "nearest_truth", "gate_m": 30.0, "max_gap_s": 5.0}, "max_missed": 5}
    })
}

fn load(folder: &Path, name: &str, kind: DatasetKind) -> Input {
    let format = format_named("autoferry").expect("the format is in the table");
    let bytes = std::fs::read(folder.join(name)).unwrap_or_else(|error| panic!("{name}: {error}"));
    let options = ReadOptions { kind: Some(kind), ..ReadOptions::default() };
    let read = (format.read)(&mut bytes.as_slice(), &options).unwrap_or_else(|faults| panic!("{name}: {faults:?}"));
    let dataset = match read.dataset {
        Dataset::Detections(recording) => Dataset::Detections(recording.only_sensors(&["radar".to_owned()]).unwrap()),
        other => other,
    };
    Input { dataset, sensors: Vec::new(), sha256: String::new() }
}

/// One line of the table.
fn line(scenario: u32, associator: &str, inputs: &[Option<Input>]) -> String {
    let plan = plan::plan(JobKind::Evaluate, &request(associator)).unwrap();
    let outcome = run::run(&plan, inputs.to_vec(), &mut Silent).unwrap();
    let value = |pointer: &str| outcome.result.pointer(pointer).cloned().unwrap_or(Value::Null);
    let whole = |pointer: &str| value(pointer).as_u64().map_or("–".to_owned(), |count| count.to_string());
    let decimal = |pointer: &str, digits: usize| value(pointer).as_f64().map_or("–".to_owned(), |number| format!("{number:.digits$}"));
    let causes = |cause: &str| {
        let breaks = value("/events/breaks");
        breaks.as_array().unwrap().iter().filter(|found| found["cause"] == cause).count()
    };
    format!(
        "| {scenario} | {associator} | {} | {} / {} / {} | {} | {} | {} | {} | {} ({} / {} / {}) |\n",
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

fn files_of(scenario: u32) -> [String; 2] {
    ["detections", "groundTruth"].map(|what| format!("scenario{scenario}_{what}.json"))
}

/// The scenarios whose files are all there; says of the others what they lack.
fn present(folder: &Path) -> Vec<u32> {
    let lacks = |scenario: u32| files_of(scenario).into_iter().find(|name| !folder.join(name).exists());
    let is_present = |scenario: &u32| match lacks(*scenario) {
        Some(name) => {
            println!("skipped: scenario {scenario}, for {name} is not in {}", folder.display());
            false
        }
        None => true,
    };
    SCENARIOS.into_iter().filter(is_present).collect()
}

/// The lines of a table that are not of scenarios left out.
fn lines_of(table: &str, scenarios: &[u32]) -> String {
    let is_left_out = |line: &&str| {
        let first = line.trim_start_matches('|').split('|').next().and_then(|cell| cell.trim().parse::<u32>().ok());
        first.is_some_and(|scenario| !scenarios.contains(&scenario))
    };
    table.trim().lines().filter(|line| !is_left_out(line)).collect::<Vec<_>>().join("\n")
}

fn table(folder: &Path, scenarios: &[u32]) -> String {
    let mut text = String::from(
        "| scenario | associator | tracks | correct / missed / false | mean GOSPA (m) | MOTA | position RMSE (m) | switches | breaks (ended / took other / left gate) |\n\
         |---|---|---|---|---|---|---|---|---|\n",
    );
    for &scenario in scenarios {
        let [detections, truth] = files_of(scenario);
        let inputs = [Some(load(folder, &detections, DatasetKind::Detections)), Some(load(folder, &truth, DatasetKind::Truth))];
        for method in ASSOCIATORS.iter().filter(|method| !["oracle", "strongest_neighbour"].contains(&method.name)) {
            text.push_str(&line(scenario, method.name, &inputs));
        }
    }
    text
}

#[test]
fn the_table_of_recordings_is_what_the_tracker_does() {
    let folder = std::env::var_os("TRACKLOOM_DATA").map(|folder| PathBuf::from(folder).join("autoferry"));
    let Some(folder) = folder else {
        println!("skipped: TRACKLOOM_DATA names no folder with autoferry recordings");
        return;
    };
    let scenarios = present(&folder);
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(DOCUMENT);
    let document = std::fs::read_to_string(&path).unwrap();
    let (head, written) = document.split_once(BEGIN).expect("the document has the line before its table");
    let made = table(&folder, &scenarios);
    if std::env::var_os("TRACKLOOM_WRITE_RECORDINGS").is_some() {
        assert_eq!(scenarios, SCENARIOS, "the table is written of all scenarios or not at all");
        std::fs::write(&path, format!("{head}{BEGIN}\n{made}")).unwrap();
        return;
    }
    assert_eq!(lines_of(written, &scenarios), made.trim(), "write it anew with TRACKLOOM_WRITE_RECORDINGS=1 and look at what changed");
}

#[test]
fn a_scenario_that_lacks_a_file_is_left_out_of_both_tables() {
    let folder = tempfile::tempdir().unwrap();
    for scenario in [3, 17] {
        files_of(scenario).iter().for_each(|name| std::fs::write(folder.path().join(name), "[]").unwrap());
    }
    std::fs::write(folder.path().join(&files_of(4)[0]), "[]").unwrap();
    assert_eq!(present(folder.path()), [3, 17]);
    assert_eq!(
        lines_of("| scenario | x |\n|---|---|\n| 3 | a |\n| 4 | b |\n| 17 | c |\n", &[3, 17]),
        "| scenario | x |\n|---|---|\n| 3 | a |\n| 17 | c |"
    );
}
