//! The recordings of `docs/recordings.md` with nothing said of the radar, beside the settings that were found by hand: the table
//! under "Nothing said", which this test keeps true.
//!
//! `TRACKLOOM_WRITE_TABLES=1 TRACKLOOM_DATA=<folder> cargo test --test domain recordings_undescribed` writes the table anew.

use crate::recordings::{DOCUMENT, files_of, inputs, lines_of, load, present, request};
use serde_json::Value;
use std::path::{Path, PathBuf};
use trackloom_domain::experiment::observer::Silent;
use trackloom_domain::experiment::{self, Input, JobKind};
use trackloom_domain::model::dataset::DatasetKind;

const BEGIN: &str = "<!-- the table below is written by tests/recordings_undescribed.rs -->\n";
const END: &str = "<!-- end of the table -->\n";

fn run(body: &Value, inputs: &[Option<Input>]) -> Value {
    let plan = experiment::plan(JobKind::Evaluate, body).unwrap();
    experiment::run(&plan, inputs.to_vec(), &mut Silent)
        .unwrap_or_else(|error| panic!("{error:?}"))
        .result
}

/// By hand; with nothing said of the radar and its targets; with nothing said at all.
fn requests() -> [Value; 3] {
    let by_hand = request("global_nearest_neighbour");
    let mut undescribed = by_hand.clone();
    undescribed.as_object_mut().unwrap().remove("sensors");
    let tracker = undescribed["tracker"].as_object_mut().unwrap();
    tracker.remove("initial_speed_sigma_mps");
    let mut silent = undescribed.clone();
    for field in ["filter", "tracker"] {
        silent.as_object_mut().unwrap().remove(field);
    }
    [by_hand, undescribed, silent]
}

/// Mean GOSPA of the three.
fn gospa(results: &[Value; 3]) -> [f64; 3] {
    [0, 1, 2].map(|index| {
        let value: &Value = results[index].pointer("/metrics/gospa/value").unwrap();
        value.as_f64().unwrap()
    })
}

fn line(scenario: u32, results: &[Value; 3]) -> String {
    let estimates = results[1]["association"]["estimates"].as_array().unwrap();
    let told = |setting: &str| {
        let is_it = |estimate: &&Value| estimate["setting"] == setting;
        estimates
            .iter()
            .find(is_it)
            .map_or("–".to_owned(), |found| {
                let [value, error] =
                    ["value", "standard_error"].map(|name| found[name].as_f64().unwrap());
                if value < 1e-3 {
                    format!("{value:.1e} ± {error:.0e}")
                } else {
                    format!("{value:.2} ± {error:.2}")
                }
            })
    };
    let speed = results[1]
        .pointer("/association/taken/initial_speed_sigma_mps")
        .unwrap();
    let [by_hand, undescribed, silent] = gospa(results);
    format!(
        "| {scenario} | {} | {} | {} | {} | {speed} | {by_hand:.1} | {undescribed:.1} | {silent:.1} |\n",
        told("sigma_x_m"),
        told("sigma_y_m"),
        told("p_d"),
        told("clutter_per_m2"),
    )
}

#[test]
fn a_recording_of_which_nothing_is_said_is_tracked_about_as_well() {
    let folder =
        std::env::var_os("TRACKLOOM_DATA").map(|folder| PathBuf::from(folder).join("autoferry"));
    let Some(folder) = folder else {
        println!("skipped: TRACKLOOM_DATA names no folder with autoferry recordings");
        return;
    };
    let scenarios = present(&folder);
    let mut made = String::from(
        "| scenario | σ of x (m) | σ of y (m) | P_D | clutter per m² | initial speed σ (m/s) | by hand | nothing of the radar | nothing at all |\n\
         |---|---|---|---|---|---|---|---|---|\n",
    );
    let mut sums = [0.0; 3];
    for &scenario in &scenarios {
        let [detections, truth] = files_of(scenario);
        let [detections, truth] = [
            load(&folder, &detections, DatasetKind::Detections),
            load(&folder, &truth, DatasetKind::Truth),
        ];
        let inputs = inputs(&detections, "radar", &truth);
        let results = requests().map(|body| run(&body, &inputs));
        sums.iter_mut()
            .zip(gospa(&results))
            .for_each(|(sum, value)| *sum += value);
        made += &line(scenario, &results);
    }
    println!("{made}{sums:?}");
    assert!(
        sums[1] <= 1.05 * sums[0] && sums[2] <= 1.05 * sums[0],
        "{sums:?}"
    );
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("..")
        .join(DOCUMENT);
    let document = std::fs::read_to_string(&path).unwrap();
    let (head, rest) = document
        .split_once(BEGIN)
        .expect("the line before the table");
    let (written, tail) = rest.split_once(END).expect("the line after the table");
    if std::env::var_os("TRACKLOOM_WRITE_TABLES").is_some() {
        std::fs::write(&path, format!("{head}{BEGIN}\n{made}\n{END}{tail}")).unwrap();
        return;
    }
    assert_eq!(
        lines_of(written, &scenarios),
        made.trim(),
        "write it anew with TRACKLOOM_WRITE_TABLES=1 and look at what changed"
    );
}
