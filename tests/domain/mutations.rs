//! Files and requests broken at random: nothing panics, what is read writes and reads back, what is planned runs to sound
//! numbers. `TRACKLOOM_MUTATIONS` says how many of each are tried; the default takes a second.

use crate::formats::{of_kind, read_with};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde_json::{Map, Value, json};
use std::ops::ControlFlow;
use trackloom_domain::experiment::observer::{Observer, Step};
use trackloom_domain::experiment::{JobKind, plan, presets, run};
use trackloom_domain::formats::{ReadOptions, format_named, write_csv, write_json, write_mot};
use trackloom_domain::model::dataset::{Dataset, DatasetKind};

fn mutations() -> usize {
    std::env::var("TRACKLOOM_MUTATIONS")
        .ok()
        .and_then(|text| text.parse().ok())
        .unwrap_or(500)
}

/// Sound files of each format, to be broken.
fn seeds() -> Vec<(&'static str, Option<DatasetKind>, Vec<u8>)> {
    let text = |format, kind, text: &str| (format, kind, text.as_bytes().to_vec());
    let npy_header = format!(
        "{:<117}\n",
        "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 3), }"
    );
    let npy = [
        b"\x93NUMPY\x01\0",
        &118u16.to_le_bytes()[..],
        npy_header.as_bytes(),
        &[0, 0, 128, 63].repeat(6),
    ]
    .concat();
    vec![
        text(
            "csv",
            None,
            "time_s,scan,sensor_id,detection_id,x_m,y_m,truth_id\n0,1,r,a,1,2,A\n0,1,r,b,-3.5,4e2,\n1,2,r,,,,\n",
        ),
        text(
            "csv",
            None,
            "time_s,scan,sensor_id,detection_id,range_m,bearing_deg,range_rate_mps\n0,1,r,a,10,350,1\n1,2,r,a,11,10,\n",
        ),
        text(
            "csv",
            None,
            "time_s,truth_id,x_m,y_m,vx_mps,vy_mps\n0,A,1,2,3,4\n1,A,4,6,3,4\n0,\"B,1\",0,0,,\n",
        ),
        text(
            "csv",
            None,
            "time_s,track_id,x_m,y_m,detection_id,probability,status,nis\n0,1,1,2,a,0.5,tentative,1\n0,1,1,2,,0.5,,\n",
        ),
        text(
            "csv",
            None,
            "time_s,track_id,x_m,y_m,z_m,vx_mps,vy_mps,vz_mps\n0,1,1,2,3,4,5,6\n1,1,5,7,9,,,\n0,2,1,2,3,4,5,6\n",
        ),
        text(
            "csv",
            None,
            "time_s,scan,sensor_id,detection_id,x_m,y_m,z_m\n0,1,r,a,1,2,3\n0,1,r,b,-3.5,4e2,\n1,2,r,,,,\n",
        ),
        text("csv", None, "time_s,0,10,20\n0,1,2,3\n1,4,5,6\n"),
        text(
            "json",
            None,
            r#"{"kind": "truth", "columns": {"time_s": [0, 1], "truth_id": ["A", 7], "x_m": [1, -2.5e3], "y_m": [3, 4]}}"#,
        ),
        text(
            "json",
            None,
            r#"{"columns": {"time_s": [0], "scan": [1], "sensor_id": ["r"], "detection_id": ["a"], "x_m": [1], "y_m": [2]}, "sensors": [{"sensor_id": "r", "p_d": 0.9}]}"#,
        ),
        text(
            "autoferry",
            None,
            r#"[{"sensorID": 2, "ownshipPosition": [1, 2], "time": 1, "measurement": [[1, 2], [3, 4]]}, {"sensorID": 3, "ownshipPosition": [0, 0], "time": 2, "measurement": 0.5}]"#,
        ),
        text(
            "autoferry",
            None,
            r#"[[{"targetID": 3, "position": [5, 1, 0], "time": 1}], [], [{"targetID": 4, "position": [5, 1], "time": 2}]]"#,
        ),
        text(
            "mot",
            Some(DatasetKind::Truth),
            "1,1,0,0,10,20,1,1,0.8\n2,1,0.5,0,10,20,1,8,0.8\n",
        ),
        text(
            "mot",
            Some(DatasetKind::Tracks),
            "1 1 0 0 10 20 0.5\n2\t1\t0\t0\t10\t20\n",
        ),
        ("npy", Some(DatasetKind::BearingTime), npy),
    ]
}

/// Pieces that mean something to some reader.
const PIECES: [&str; 32] = [
    ",",
    "\n",
    "\r\n",
    "\"",
    "\"\"",
    "[",
    "]",
    "{",
    "}",
    ":",
    "null",
    "true",
    "-",
    "+",
    "=",
    "@",
    "1e308",
    "1e309",
    "-0",
    "nan",
    "inf",
    "99999999999999999999",
    "0.1",
    "\u{feff}",
    "\u{e9}",
    "time_s",
    "truth_id",
    "track_id",
    "x_m",
    "(2, 3)",
    "sensorID",
    "\t",
];

fn broken(mut bytes: Vec<u8>, rng: &mut ChaCha8Rng) -> Vec<u8> {
    for _ in 0..rng.random_range(1..5) {
        let at = rng.random_range(0..=bytes.len());
        let to = rng.random_range(at..=bytes.len().min(at + 24));
        match rng.random_range(0..6) {
            0 if at < bytes.len() => bytes[at] = rng.random(),
            1 => drop(bytes.drain(at..to)),
            2 => {
                let part = bytes[at..to].repeat(rng.random_range(1..4));
                bytes.splice(at..at, part);
            }
            3 => bytes.truncate(at),
            _ => {
                let piece = PIECES[rng.random_range(0..PIECES.len())];
                bytes.splice(at..to.min(at + rng.random_range(0..3)), piece.bytes());
            }
        }
    }
    bytes
}

/// Writes a dataset as the formats do that can hold it, and reads each again.
fn reads_back(dataset: &Dataset) -> Vec<Dataset> {
    let mut found = Vec::new();
    let kind = of_kind(dataset.kind());
    let mut add = |format: &str, bytes: Vec<u8>| {
        let read = read_with(format, &bytes, &kind)
            .unwrap_or_else(|faults| panic!("{faults:#?}\n{}", String::from_utf8_lossy(&bytes)));
        found.push(read.dataset);
    };
    let mut bytes = Vec::new();
    if let Dataset::TruthBoxes(set) | Dataset::TrackBoxes(set) = dataset {
        write_mot(set, &mut bytes).unwrap();
        add("mot", bytes);
        return found;
    }
    write_csv(dataset, &mut bytes).unwrap();
    add("csv", bytes);
    if dataset.kind() != DatasetKind::BearingTime {
        let mut bytes = Vec::new();
        write_json(dataset, &mut bytes).unwrap();
        add("json", bytes);
    }
    found
}

#[test]
fn broken_files_are_refused_or_read_back_as_they_were_read() {
    let axes = json!({"first_time_s": 0.0, "time_step_s": 1.0, "first_bearing_deg": 0.0, "bearing_step_deg": 1.0});
    let options = [("bearing_time".to_owned(), axes)];
    for (number, (format, kind, sound)) in seeds().into_iter().enumerate() {
        let options = ReadOptions {
            kind,
            options: options
                .iter()
                .filter(|_| format == "npy")
                .cloned()
                .collect(),
            ..ReadOptions::default()
        };
        assert!(
            read_with(format, &sound, &options).is_ok(),
            "seed {number} is sound"
        );
        let mut rng = ChaCha8Rng::seed_from_u64(number as u64);
        let mut accepted = 0;
        for _ in 0..mutations() {
            let bytes = broken(sound.clone(), &mut rng);
            let Ok(outcome) = (format_named(format).unwrap().read)(&mut bytes.as_slice(), &options)
            else {
                continue;
            };
            accepted += 1;
            for again in reads_back(&outcome.dataset) {
                // Bearings are written in degrees, which may round what was never written before, but only once.
                let is_same = again == outcome.dataset || reads_back(&again).contains(&again);
                assert!(
                    is_same,
                    "seed {number}: {}",
                    String::from_utf8_lossy(&bytes)
                );
            }
        }
        assert!(
            accepted > 0,
            "seed {number}: none of {} is read",
            mutations()
        );
    }
}

/// Stops a job after so many pieces.
struct Brief(u32);

impl Observer for Brief {
    fn progress(&mut self, _: Step, _: u64, _: u64) -> ControlFlow<()> {
        self.0 = self.0.saturating_sub(1);
        if self.0 == 0 {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    }
}

fn changed(value: &mut Value, rng: &mut ChaCha8Rng) {
    match value {
        Value::Object(fields) if !fields.is_empty() && rng.random_bool(0.9) => {
            let name = fields
                .keys()
                .nth(rng.random_range(0..fields.len()))
                .unwrap()
                .clone();
            if rng.random_bool(0.1) {
                fields.shift_remove(&name);
            } else {
                changed(&mut fields[&name], rng);
            }
        }
        Value::Array(items) if !items.is_empty() && rng.random_bool(0.9) => {
            let place = rng.random_range(0..items.len());
            if rng.random_bool(0.1) {
                items.push(items[place].clone())
            } else {
                changed(&mut items[place], rng)
            }
        }
        other => *other = strange(other, rng),
    }
}

fn strange(value: &Value, rng: &mut ChaCha8Rng) -> Value {
    let number = value.as_f64().unwrap_or(1.0);
    let numbers = [
        0.0,
        -1.0,
        1.0,
        0.5 * number,
        2.0 * number,
        -number,
        1e-300,
        1e300,
        1e-9,
        1.0 - 1e-16,
        4294967296.0,
        0.1,
    ];
    match rng.random_range(0..8) {
        0 => Value::Null,
        1 => json!([]),
        2 => Value::Object(Map::new()),
        3 => json!(["", "kalman", "pda", "=1", "\u{0}", "truth"][rng.random_range(0..6)]),
        4 => json!((number as i64).saturating_add(rng.random_range(-2..3))),
        _ => json!(numbers[rng.random_range(0..numbers.len())]),
    }
}

#[test]
fn changed_requests_are_refused_or_planned_and_run_to_sound_numbers() {
    let presets = presets::all();
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    let (mut planned, mut finished) = (0, 0);
    for case in 0..mutations() {
        let preset = &presets[case % presets.len()];
        let mut body = preset.body.clone();
        for _ in 0..rng.random_range(1..4) {
            changed(&mut body, &mut rng);
        }
        let Ok(plan) = plan(preset.kind, &body) else {
            continue;
        };
        planned += 1;
        if plan.kind == JobKind::Campaign || plan.cost.cost_s > 0.02 || !plan.inputs.is_empty() {
            continue;
        }
        let Ok(outcome) = run(&plan, Vec::new(), &mut Brief(300)) else {
            continue;
        };
        finished += 1;
        for file in outcome
            .artifacts
            .iter()
            .filter(|file| file.media_type.starts_with("text/csv"))
        {
            let text = String::from_utf8_lossy(&file.bytes);
            let is_strange =
                |cell: &str| cell.parse::<f64>().is_ok_and(|number| !number.is_finite());
            assert!(
                !text.split([',', '\n']).any(is_strange),
                "{} of {body}",
                file.name
            );
        }
    }
    assert!(
        planned * 20 > mutations() && finished > 0,
        "{planned} planned, {finished} finished of {}",
        mutations()
    );
}
