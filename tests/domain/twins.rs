//! Two tracks on one target, and two detections of one target in a scan.

use serde_json::{Value, json};
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
