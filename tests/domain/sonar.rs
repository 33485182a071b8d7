//! Scenes of bearings that follow a law, tracks that begin at the truth, and whether they are kept.

use serde_json::{Value, json};
use trackloom_domain::experiment::observer::Silent;
use trackloom_domain::experiment::{self, JobKind, plan};

/// Two targets that cross at `centre_deg` after 65 scans of a second.
fn crossing(centre_deg: f64, seed: u32, method: &str) -> Value {
    json!({
        "seed": seed,
        "input": {"source": "scenario", "scenario": {
            "scans": 131, "scan_period_s": 1.0,
            "sensors": [{"sensor_id": "sonar", "p_d": 0.95, "sigma_bearing_deg": 0.3, "clutter_per_deg": 0.1}],
            "targets": {"kind": "bearings", "crossings": [
                {"centre_deg": centre_deg, "half_width_deg": 15.0, "crossing_time_s": 65.0, "power": 1.6}
            ]}
        }},
        "associator": {"method": method},
        "filter": {"method": "bearing_only", "process_noise_deg2ps3": 0.000225},
        "tracker": {"gate_probability": 0.999_999_426_696_856, "initiation": {"method": "truth", "rate_sigma_degps": 0.1}}
    })
}

fn outcome(kind: JobKind, body: &Value) -> experiment::Outcome {
    let plan = plan(kind, body).unwrap_or_else(|faults| panic!("{faults:?}"));
    experiment::run(&plan, vec![], &mut Silent).unwrap_or_else(|error| panic!("{error:?}"))
}

fn rows(outcome: &experiment::Outcome, name: &str) -> Vec<Vec<String>> {
    let file = outcome
        .artifacts
        .iter()
        .find(|artifact| artifact.name == name)
        .unwrap();
    let text = std::str::from_utf8(&file.bytes).unwrap();
    text.lines()
        .skip(1)
        .map(|line| line.split(',').map(str::to_owned).collect())
        .collect()
}

fn faults(kind: JobKind, body: &Value) -> Vec<(String, String)> {
    plan(kind, body)
        .unwrap_err()
        .into_iter()
        .map(|fault| (fault.pointer, fault.code))
        .collect()
}

#[test]
fn tracks_that_begin_at_the_truth_carry_its_names_and_stay_with_it_under_jpda() {
    for centre_deg in [265.0, 0.0] {
        let kept = (1..=10).map(|seed| {
            let found = outcome(JobKind::Evaluate, &crossing(centre_deg, seed, "jpda"));
            let metric = &found.result["metrics"]["track_keeping"];
            let error_deg = metric["quantities"]["mean_absolute_error"]["value"]
                .as_f64()
                .unwrap();
            assert!(
                (0.1..0.25).contains(&error_deg),
                "centre {centre_deg}, seed {seed}: {error_deg}"
            );
            assert_eq!(
                (
                    &metric["parameters"]["unit"],
                    &metric["parameters"]["sigma"]
                ),
                (&json!("deg"), &json!(0.3))
            );
            let counts = &found.result["association"]["counts"];
            let numbers = ["started_tracks", "tracks", "track_points"]
                .map(|name| counts[name].as_u64().unwrap());
            assert_eq!(numbers, [2, 2, 2 * 131], "no track ends, none is added");
            metric["value"].as_f64().unwrap()
        });
        assert!(kept.sum::<f64>() >= 9.0, "centre {centre_deg}");
    }
}

#[test]
fn the_truth_follows_the_law_of_a_crossing_and_of_a_line() {
    let mut body = json!({"scenario": crossing(2.0, 1, "jpda")["input"]["scenario"]});
    body["scenario"]["targets"]["lines"] =
        json!([{"truth_id": "x", "bearing_deg": 359.0, "rate_degps": 0.5}]);
    let truth = rows(&outcome(JobKind::Simulate, &body), "truth.csv");
    let at = |id: &str, time: &str| -> f64 {
        truth
            .iter()
            .find(|row| row[0] == time && row[1] == id)
            .unwrap()[2]
            .parse()
            .unwrap()
    };
    // |1 − 26/65|^1.6 = 0.6^1.6 = 0.44161; times 15 is 6.6242 on either side of 2.
    for (id, time, bearing_deg) in [
        ("1", "0", 347.0),
        ("2", "0", 17.0),
        ("1", "26", 355.3758),
        ("2", "26", 8.6242),
        ("1", "65", 2.0),
        ("1", "130", 17.0),
        ("x", "4", 1.0),
    ] {
        assert!(
            (at(id, time) - bearing_deg).abs() < 1e-3,
            "{id} at {time}: {}",
            at(id, time)
        );
    }
}

#[test]
fn clutter_near_targets_is_that_of_the_whole_circle_without_the_rest() {
    let mut body = json!({"scenario": crossing(0.0, 3, "jpda")["input"]["scenario"]});
    let everywhere = rows(&outcome(JobKind::Simulate, &body), "detections.csv");
    body["scenario"]["sensors"][0]["clutter_within_deg"] = json!(2.0);
    let near = outcome(JobKind::Simulate, &body);
    assert_eq!(near.result["sensors"][0]["clutter_per_deg"], 0.1);
    let (truth, near) = (rows(&near, "truth.csv"), rows(&near, "detections.csv"));
    let off = |left: &str, right: &str| {
        let degrees =
            (left.parse::<f64>().unwrap() - right.parse::<f64>().unwrap()).rem_euclid(360.0);
        degrees.min(360.0 - degrees)
    };
    let is_near = |row: &&Vec<String>| {
        truth
            .iter()
            .any(|point| point[0] == row[0] && off(&point[2], &row[4]) <= 2.0)
    };
    let bearings = |rows: &[&Vec<String>]| -> Vec<(String, String)> {
        rows.iter()
            .map(|row| (row[0].clone(), row[4].clone()))
            .collect()
    };
    let expected: Vec<&Vec<String>> = everywhere
        .iter()
        .filter(|row| !row[5].is_empty() || is_near(row))
        .collect();
    assert_eq!(
        bearings(&near.iter().collect::<Vec<_>>()),
        bearings(&expected)
    );
    // 131 scans of at most 8 degrees, less where the two are close: about 100 false detections.
    let clutter = near.iter().filter(|row| row[5].is_empty()).count();
    assert!((60..=130).contains(&clutter), "{clutter}");
}

#[test]
fn what_does_not_fit_a_scene_of_bearings_is_refused() {
    let of = |change: &dyn Fn(&mut Value)| {
        let mut body = json!({"scenario": crossing(0.0, 1, "jpda")["input"]["scenario"]});
        change(&mut body["scenario"]);
        faults(JobKind::Simulate, &body)
    };
    let one = |pointer: &str, code: &str| vec![(format!("/scenario{pointer}"), code.to_owned())];
    let plan =
        json!([{"sensor_id": "radar", "sigma_x_m": 1.0, "sigma_y_m": 1.0, "max_range_m": 10.0}]);
    assert_eq!(
        of(&|scene| scene["sensors"] = plan.clone()),
        one("/sensors/0", "conflict")
    );
    assert_eq!(
        of(&|scene| scene["sensors"][0]["clutter_per_scan"] = json!(0.0)),
        one("/sensors/0/clutter_per_deg", "conflict")
    );
    assert_eq!(
        of(&|scene| scene["targets"] = json!({"kind": "bearings"})),
        one("/targets", "missing")
    );
    let line = json!([{"truth_id": "2", "bearing_deg": 1.0}]);
    assert_eq!(
        of(&|scene| scene["targets"]["lines"] = line.clone()),
        one("/targets/lines/0/truth_id", "duplicate")
    );
    let near = json!([{"sigma_bearing_deg": 1.0, "clutter_within_deg": 2.0}]);
    assert_eq!(
        of(&|scene| scene["sensors"] = near.clone()),
        one("/sensors/0/clutter_within_deg", "missing")
    );
    let ship = json!({"kind": "listed", "targets": [{"truth_id": "a", "x_m": 1.0, "y_m": 2.0}]});
    assert_eq!(
        of(&|scene| scene["targets"] = ship.clone()),
        one("/sensors/0/max_range_m", "missing")
    );
    let dataset =
        json!({"source": "dataset", "dataset_id": "0198c0de-0000-7000-8000-000000000000"});
    let body = json!({"input": dataset, "tracker": {"initiation": {"method": "truth"}}});
    assert_eq!(
        faults(JobKind::Associate, &body),
        [("/truth".to_owned(), "missing".to_owned())]
    );
}

#[test]
fn every_filter_of_the_plane_begins_at_the_truth() {
    let noises = [
        json!({"sigma_x_m": 5.0, "sigma_y_m": 5.0}),
        json!({"sigma_range_m": 5.0, "sigma_bearing_deg": 0.1, "sigma_range_rate_mps": 0.5}),
    ];
    for (filter, noise) in [
        ("kalman", 0),
        ("extended", 1),
        ("unscented", 1),
        ("converted", 1),
    ] {
        let mut sensor = json!({"max_range_m": 10_000.0, "p_d": 1.0});
        noises[noise]
            .as_object()
            .unwrap()
            .iter()
            .for_each(|(name, value)| sensor[name] = value.clone());
        let body = json!({
            "input": {"source": "scenario", "scenario": {"scans": 20, "scan_period_s": 1.0, "sensors": [sensor], "targets": {
                "kind": "listed", "targets": [{"truth_id": "ship", "x_m": 1000.0, "y_m": 2000.0, "vx_mps": 10.0, "vy_mps": -5.0}]
            }}},
            "filter": {"method": filter, "process_noise_m2ps3": 0.01},
            "tracker": {"initiation": {"method": "truth"}},
            "metrics": [{"metric": "track_keeping", "sigma": 5.0}]
        });
        let found = outcome(JobKind::Evaluate, &body);
        let metric = &found.result["metrics"]["track_keeping"];
        let error_m = metric["quantities"]["mean_absolute_error"]["value"]
            .as_f64()
            .unwrap();
        assert!(
            metric["value"] == 1.0 && (0.5..5.0).contains(&error_m),
            "{filter}: {metric}"
        );
        assert_eq!(metric["findings"]["targets"][0]["truth_id"], "ship");
    }
}
