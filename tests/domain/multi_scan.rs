//! Tracks that begin over several scans.

use crate::origins::jobs::Texts;
use rand::RngExt;
use rand_distr::{Distribution, StandardNormal};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::fmt::Write;
use trackloom_domain::experiment::observer::Silent;
use trackloom_domain::experiment::{JobKind, Outcome, plan, presets, run};
use trackloom_domain::math::rng::{Purpose, Seed};

/// Scans of one radar: the places in each, a second apart.
fn detections(scans: &[Vec<[f64; 2]>]) -> String {
    let mut text = "time_s,scan,sensor_id,detection_id,x_m,y_m\n".to_owned();
    for (scan, places) in scans.iter().enumerate() {
        if places.is_empty() {
            writeln!(text, "{scan},{},r,,,", scan + 1).unwrap();
        }
        for (nth, [x_m, y_m]) in places.iter().enumerate() {
            writeln!(text, "{scan},{},r,{scan}-{nth},{x_m},{y_m}", scan + 1).unwrap();
        }
    }
    text
}

fn job(scans: &[Vec<[f64; 2]>], initiation: &Value) -> Outcome {
    let mut texts = Texts::of("csv");
    let body = json!({
        "input": texts.dataset(&detections(scans)),
        "sensors": [{"sensor_id": "r", "p_d": 0.9, "clutter_per_m2": 1e-6, "sigma_x_m": 10, "sigma_y_m": 10}],
        "filter": {"method": "kalman", "process_noise_m2ps3": 0.1},
        "associator": {"method": "global_nearest_neighbour"},
        "tracker": {"initiation": initiation, "initial_speed_sigma_mps": 50},
    });
    texts.run(JobKind::Associate, &body).unwrap()
}

/// The rows of a file of the job, without its header; and the header.
fn rows(outcome: &Outcome, name: &str) -> (Vec<String>, Vec<Vec<String>>) {
    let file = outcome.artifacts.iter().find(|file| file.name == name);
    let text = String::from_utf8(file.unwrap().bytes.clone()).unwrap();
    let mut lines = text
        .lines()
        .map(|line| line.split(',').map(str::to_owned).collect());
    (lines.next().unwrap(), lines.collect())
}

/// A target that goes 20 m east a second from x = 0 on, with errors of 10 m.
fn target(scan: usize, draw: &mut impl rand::Rng) -> [f64; 2] {
    let errors: [f64; 2] = std::array::from_fn(|_| StandardNormal.sample(draw));
    [20.0 * scan as f64 + 10.0 * errors[0], 10.0 * errors[1]]
}

#[test]
fn a_track_begins_with_its_first_detection_and_says_when_it_was_known() {
    let draw = &mut Seed { seed: 5, run: 0 }.stream(Purpose::Detection, 0, 0);
    let mut scans: Vec<Vec<[f64; 2]>> = (0..10).map(|scan| vec![target(scan, draw)]).collect();
    scans[2].clear();
    let outcome = job(&scans, &json!({"method": "multi_scan"}));
    let (header, rows) = rows(&outcome, "tracks.csv");
    let column = |name: &str| header.iter().position(|known| known == name).unwrap();
    let at = |row: &Vec<String>, name: &str| row[column(name)].parse::<f64>().ok();
    let times: Vec<f64> = rows.iter().map(|row| at(row, "time_s").unwrap()).collect();
    assert_eq!(times, (0..10).map(f64::from).collect::<Vec<_>>());
    let known: Vec<Option<f64>> = rows.iter().map(|row| at(row, "known_at_s")).collect();
    let wanted = [
        Some(4.0),
        Some(4.0),
        Some(4.0),
        Some(4.0),
        None,
        None,
        None,
        None,
        None,
        None,
    ];
    assert_eq!(known, wanted);
    let detections: Vec<&str> = rows
        .iter()
        .map(|row| row[column("detection_id")].as_str())
        .collect();
    assert_eq!(detections[..4], ["0-0", "1-0", "", "3-0"]);
    // In the light of later scans the first point is known better than by its detection alone, and has a speed.
    assert!(at(&rows[0], "p_xx").unwrap() < 90.0, "{:?}", rows[0]);
    assert!(
        (at(&rows[0], "vx_mps").unwrap() - 20.0).abs() < 8.0,
        "{:?}",
        rows[0]
    );
    assert_eq!(rows[4][column("status")], "confirmed");
}

#[test]
fn detections_are_chosen_together() {
    // Two targets cross the way of a third detection: greedily the first target would take it.
    let draw = &mut Seed { seed: 6, run: 0 }.stream(Purpose::Detection, 0, 0);
    let scans: Vec<Vec<[f64; 2]>> = (0..8)
        .map(|scan| {
            let first = target(scan, draw);
            let [x_m, y_m] = target(scan, draw);
            vec![first, [x_m, 60.0 + y_m]]
        })
        .collect();
    let outcome = job(&scans, &json!({"method": "multi_scan"}));
    let (header, rows) = rows(&outcome, "tracks.csv");
    let column = |name: &str| header.iter().position(|known| known == name).unwrap();
    let mut used: Vec<&String> = rows
        .iter()
        .map(|row| &row[column("detection_id")])
        .collect();
    used.sort();
    let all = used.len();
    used.dedup();
    assert_eq!((used.len(), all), (16, 16), "no detection is in two tracks");
    for row in &rows {
        let is_second = row[column("detection_id")].ends_with("-1");
        assert_eq!(
            row[column("track_id")] == rows[0][column("track_id")],
            is_second == rows[0][column("detection_id")].ends_with("-1")
        );
    }
}

#[test]
fn clutter_begins_hardly_any_track() {
    let draw = &mut Seed { seed: 7, run: 0 }.stream(Purpose::Clutter, 0, 0);
    let scans: Vec<Vec<[f64; 2]>> = (0..60)
        .map(|_| {
            (0..40)
                .map(|_| [6000.0 * draw.random::<f64>(), 6000.0 * draw.random::<f64>()])
                .collect()
        })
        .collect();
    let tracks = |initiation: &Value| {
        let outcome = job(&scans, initiation);
        outcome
            .result
            .pointer("/association/tracks")
            .unwrap()
            .as_array()
            .unwrap()
            .len()
    };
    let over_scans = tracks(&json!({"method": "multi_scan"}));
    let of_one = tracks(&json!({"method": "one_point"}));
    assert!(over_scans <= of_one / 4, "{over_scans} {of_one}");
}

#[test]
fn too_many_ways_are_cut_and_told() {
    let draw = &mut Seed { seed: 8, run: 0 }.stream(Purpose::Clutter, 0, 0);
    let scans: Vec<Vec<[f64; 2]>> = (0..8)
        .map(|_| {
            (0..80)
                .map(|_| [500.0 * draw.random::<f64>(), 500.0 * draw.random::<f64>()])
                .collect()
        })
        .collect();
    let outcome = job(&scans, &json!({"method": "multi_scan", "max_nodes": 100}));
    let told = outcome
        .warnings
        .iter()
        .any(|warning| warning.contains("of the ways from detection to detection were cut"));
    assert!(told, "{:?}", outcome.warnings);
}

/// Of the targets of Liang & Liu whose first three detections one way of the window can follow, nearly all are correct; the line of
/// `docs/beginnings.md`.
#[test]
fn targets_with_three_detections_in_a_window_are_correct() {
    let (mut followed, mut correct) = (0, 0);
    for seed in 1..=20 {
        let mut body = presets::find("liang2009-100").unwrap().body;
        body["seed"] = json!(seed);
        body["tracker"]["initiation"] = json!({"method": "multi_scan"});
        let plan = plan(JobKind::Evaluate, &body).unwrap();
        let outcome = run(&plan, Vec::new(), &mut Silent).unwrap();
        let (header, rows) = rows(&outcome, "detections.csv");
        let column = |name: &str| header.iter().position(|known| known == name).unwrap();
        let mut scans_of: BTreeMap<&str, Vec<u32>> = BTreeMap::new();
        for row in &rows {
            let scan = row[column("scan")].parse().unwrap();
            scans_of
                .entry(row[column("truth_id")].as_str())
                .or_default()
                .push(scan);
        }
        for target in outcome.result["tfa"]["targets"].as_array().unwrap() {
            let scans = scans_of.get(target["truth_id"].as_str().unwrap());
            if scans.is_some_and(|scans| fits_a_window(scans)) {
                followed += 1;
                correct += u32::from(target["verdict"] == "correct");
            }
        }
    }
    assert_eq!((followed, correct), OF_TWENTY_RUNS);
}

/// Targets whose first three detections fit a window, and how many of them are correct.
const OF_TWENTY_RUNS: (u32, u32) = (1486, 1486);

/// Whether the first three detections lie within five scans, at most two missed in a row.
fn fits_a_window(scans: &[u32]) -> bool {
    let [first, second, third, ..] = scans else {
        return false;
    };
    third - first <= 4 && second - first <= 3 && third - second <= 3
}

/// Forty scans with 20 false detections each, and then a target: its first detection is likelier clutter than 99 to 1, and still it
/// is found, by either beginning.
#[test]
fn a_target_is_found_after_clutter_alone() {
    let draw = &mut Seed { seed: 9, run: 0 }.stream(Purpose::Clutter, 0, 0);
    let scans: Vec<Vec<[f64; 2]>> = (0..60)
        .map(|scan| {
            let mut places: Vec<[f64; 2]> = (0..20)
                .map(|_| {
                    let [x, y]: [f64; 2] = [draw.random(), draw.random()];
                    [1e5 * (x - 0.5), 1e5 * (y - 0.5)]
                })
                .collect();
            if scan >= 40 {
                places.push(target(scan, draw));
            }
            places
        })
        .collect();
    for method in ["one_point", "multi_scan"] {
        let mut texts = Texts::of("csv");
        let body = json!({
            "input": texts.dataset(&detections(&scans)),
            "sensors": [{"sensor_id": "r", "p_d": 0.9, "clutter_per_m2": 2e-9, "sigma_x_m": 10, "sigma_y_m": 10}],
            "filter": {"method": "kalman", "process_noise_m2ps3": 0.1},
            "associator": {"method": "global_nearest_neighbour"},
            "tracker": {"initiation": {"method": method}, "confirmation": {"rule": "existence"}, "initial_speed_sigma_mps": 20},
        });
        let outcome = texts.run(JobKind::Associate, &body).unwrap();
        let tracks = outcome.result["association"]["tracks"].as_array().unwrap();
        let spans: Vec<_> = tracks
            .iter()
            .map(|track| (track["start_time_s"].as_f64(), track["end_time_s"].as_f64()))
            .collect();
        assert_eq!(spans, [(Some(40.0), Some(59.0))], "{method}");
    }
}
