//! Two tracks on one target, and two detections of one target in a scan.

use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};
use trackloom_domain::experiment::observer::Silent;
use trackloom_domain::experiment::{self, Input, JobKind, Outcome, plan};
use trackloom_domain::formats::{ReadOptions, format_named};

/// One target at 10 m/s along the x axis for 100 scans, σ 5 m; in the first four a second detection lies 19 to 33 m beside it.
const TWIN: &str = include_str!("twins/twin.csv");
/// One target at 10 m/s for 40 scans, two detections of it in each.
const TWO_PLOTS: &str = include_str!("twins/two_plots.csv");

fn tracked(text: &str, body: &Value) -> Outcome {
    let read = format_named("csv").unwrap().read;
    let read = read(&mut text.as_bytes(), &ReadOptions::default()).unwrap();
    let input = Input {
        dataset: read.dataset,
        sensors: Vec::new(),
        sha256: String::new(),
    };
    let plan = plan(JobKind::Associate, body).unwrap_or_else(|faults| panic!("{faults:?}"));
    experiment::run(&plan, vec![Some(input)], &mut Silent).unwrap()
}

fn of_twin(associator: &str, merging: Option<Value>) -> Outcome {
    let mut tracker = json!({"initial_speed_sigma_mps": 12});
    if let Some(merging) = merging {
        tracker["merging"] = merging;
    }
    let body = json!({
        "input": {"source": "dataset", "dataset_id": "d"},
        "sensors": [{"sensor_id": "r", "p_d": 0.9, "clutter_per_m2": 1e-7, "sigma_x_m": 5, "sigma_y_m": 5}],
        "associator": {"method": associator},
        "filter": {"method": "kalman", "process_noise_m2ps3": 0.3},
        "tracker": tracker
    });
    tracked(TWIN, &body)
}

/// First and last time of each track.
fn spans(outcome: &Outcome) -> Vec<[f64; 2]> {
    let tracks = outcome.result["association"]["tracks"].as_array().unwrap();
    let time = |track: &Value, field: &str| track[field].as_f64().unwrap();
    let span = |track: &Value| [time(track, "start_time_s"), time(track, "end_time_s")];
    tracks.iter().map(span).collect()
}

/// Under PDA both tracks use each detection and live to the end; merged they are one within five scans of the last detection of
/// its own that the second had.
#[test]
fn a_twin_ends_after_the_stated_scans() {
    assert_eq!(spans(&of_twin("pda", None)), [[0.0, 99.0], [0.0, 99.0]]);
    for (scans, end_s) in END_AFTER {
        let outcome = of_twin("pda", Some(json!({"scans": scans})));
        assert_eq!(spans(&outcome), [[0.0, 99.0], [0.0, end_s]], "{scans}");
        let merged = json!([{"track_id": "2", "into_track_id": "1", "time_s": end_s}]);
        assert_eq!(outcome.result["association"]["merged"], merged);
    }
}

const END_AFTER: [(u32, f64); 3] = [(1, 8.0), (3, 10.0), (10, 25.0)];

/// Where nothing is merged the report has no such list.
#[test]
fn nothing_is_told_where_nothing_merges() {
    let outcome = of_twin("pda", None);
    assert!(outcome.result["association"].get("merged").is_none());
    assert!(
        outcome
            .result
            .pointer("/association/counts/merged_detections")
            .is_none()
    );
}

/// Two targets 2 m apart at σ 1 m, side by side: both are detected in each scan, and stay two.
#[test]
fn two_targets_stay_two() {
    let mut text = String::from("time_s,scan,sensor_id,detection_id,x_m,y_m\n");
    for scan in 0..40 {
        for (name, y_m) in [("a", 0.0), ("b", 2.0)] {
            text += &format!("{scan},{scan},r,{name}{scan},{},{y_m}\n", 10 * scan);
        }
    }
    for associator in ["pda", "jpda", "global_nearest_neighbour"] {
        let body = json!({
            "input": {"source": "dataset", "dataset_id": "d"},
            "sensors": [{"sensor_id": "r", "p_d": 0.9, "clutter_per_m2": 1e-7, "sigma_x_m": 1, "sigma_y_m": 1}],
            "associator": {"method": associator},
            "filter": {"method": "kalman", "process_noise_m2ps3": 0.1},
            "tracker": {"initial_speed_sigma_mps": 12, "merging": {"scans": 1}}
        });
        assert_eq!(spans(&tracked(&text, &body)).len(), 2, "{associator}");
    }
}

#[test]
fn two_detections_of_one_target_are_one_track() {
    let of = |merge_within_m: Option<f64>| {
        let mut sensor = json!({"sensor_id": "r", "p_d": 0.9, "clutter_per_m2": 1e-8, "sigma_x_m": 4, "sigma_y_m": 4});
        if let Some(within_m) = merge_within_m {
            sensor["merge_within_m"] = json!(within_m);
        }
        let body = json!({
            "input": {"source": "dataset", "dataset_id": "d"},
            "sensors": [sensor],
            "associator": {"method": "jpda"},
            "filter": {"method": "kalman", "process_noise_m2ps3": 0.1}
        });
        tracked(TWO_PLOTS, &body)
    };
    assert_eq!(spans(&of(None)), [[0.0, 39.0], [0.0, 39.0]]);
    let merged = of(Some(30.0));
    assert_eq!(spans(&merged), [[0.0, 39.0]]);
    let counts = &merged.result["association"]["counts"];
    assert_eq!(
        (&counts["detections"], &counts["merged_detections"]),
        (&json!(40), &json!(40))
    );
}

#[test]
fn a_distance_that_is_none_is_refused() {
    let body = json!({
        "input": {"source": "dataset", "dataset_id": "d"},
        "sensors": [{"sensor_id": "r", "merge_within_m": 0}],
        "associator": {"method": "pda"},
        "filter": {"method": "kalman", "process_noise_m2ps3": 0.1},
        "tracker": {"merging": {"scans": 0, "probability": 1}}
    });
    let faults = plan(JobKind::Associate, &body).unwrap_err();
    let pointers: Vec<&str> = faults.iter().map(|fault| fault.pointer.as_str()).collect();
    assert_eq!(
        pointers,
        [
            "/sensors/0/merge_within_m",
            "/tracker/merging/probability",
            "/tracker/merging/scans"
        ]
    );
}

/// A file of the job by its columns.
fn columns<const N: usize>(outcome: &Outcome, file: &str, names: [&str; N]) -> Vec<[String; N]> {
    let found = outcome.artifacts.iter().find(|found| found.name == file);
    let text = String::from_utf8(found.unwrap().bytes.clone()).unwrap();
    let mut lines = text.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let header = lines.next().unwrap();
    let places = names.map(|name| header.iter().position(|known| *known == name).unwrap());
    lines
        .map(|cells| places.map(|place| cells[place].to_owned()))
        .collect()
}

fn number(text: &str) -> f64 {
    text.parse().unwrap()
}

/// For how many scans in a row at most the same two confirmed tracks are within 50 m of the aircraft.
fn longest_twin(outcome: &Outcome) -> u32 {
    let truth = columns(outcome, "truth.csv", ["time_s", "x_m", "y_m"]);
    let place_at: BTreeMap<String, [f64; 2]> = truth
        .into_iter()
        .map(|[time, x_m, y_m]| (time, [number(&x_m), number(&y_m)]))
        .collect();
    let mut near: BTreeMap<i64, BTreeSet<String>> = BTreeMap::new();
    for [time, track, x_m, y_m, status] in columns(
        outcome,
        "tracks.csv",
        ["time_s", "track_id", "x_m", "y_m", "status"],
    ) {
        let tracks = near.entry(number(&time) as i64).or_default();
        if let Some(place) = place_at.get(&time)
            && status != "tentative"
            && (number(&x_m) - place[0]).hypot(number(&y_m) - place[1]) <= 50.0
        {
            tracks.insert(track);
        }
    }
    let (mut lasting, mut longest) = (BTreeMap::new(), 0);
    for tracks in near.values() {
        let mut now = BTreeMap::new();
        for one in tracks {
            for other in tracks.iter().filter(|other| *other > one) {
                let pair = (one.clone(), other.clone());
                let scans = lasting.get(&pair).map_or(1, |before: &u32| before + 1);
                longest = longest.max(scans);
                now.insert(pair, scans);
            }
        }
        lasting = now;
    }
    longest
}

/// An aircraft on the ground of Zurich, whose recorded places jump: a second track that begins after a jump lives on under PDA.
#[test]
fn an_aircraft_on_the_ground_has_no_twin_for_long() {
    let Some(read) = crate::real_files::read("adsb-traffic/zurich_airport.json.gz", &[]) else {
        return;
    };
    let longest = |merging: Option<Value>| {
        let mut body = json!({
            "seed": 0,
            "truth": {"source": "dataset", "dataset_id": "truth"},
            "input": {"source": "scenario", "scenario": {
                "scans": 2290, "scan_period_s": 1,
                "sensors": [{
                    "sensor_id": "radar", "lat_deg": 47.4582, "lon_deg": 8.548, "max_range_m": 5000, "p_d": 0.95, "sigma_range_m": 5,
                    "sigma_bearing_deg": 0.1, "clutter_per_scan": 10
                }],
                "targets": {"kind": "recorded", "max_gap_s": 60, "start_s": 1_570_302_532.0}
            }},
            "associator": {"method": "pda"},
            "filter": {"method": "unscented", "process_noise_m2ps3": 1},
            "tracker": {"initial_speed_sigma_mps": 15},
            "comparison": {"gate_m": 50, "credit": "afterwards"},
            "metrics": [{"metric": "clear"}]
        });
        if let Some(merging) = merging {
            body["tracker"]["merging"] = merging;
        }
        let plan = plan(JobKind::Evaluate, &body).unwrap_or_else(|faults| panic!("{faults:?}"));
        let truth = Input {
            dataset: read.dataset.clone(),
            sensors: Vec::new(),
            sha256: String::new(),
        };
        let outcome = experiment::run(&plan, vec![Some(truth)], &mut Silent).unwrap();
        longest_twin(&outcome)
    };
    assert_eq!(longest(None), 394);
    assert_eq!(longest(Some(json!({"probability": 0.9999, "scans": 2}))), 4);
}
