//! Polar sensors through the front door: simulated, tracked by each filter that can, and judged.

use serde_json::{Value, json};
use trackloom_domain::experiment::observer::Silent;
use trackloom_domain::experiment::{self, JobKind, plan, presets};

const FILTERS: [&str; 3] = ["extended", "unscented", "converted"];

fn result(kind: JobKind, body: &Value) -> Value {
    let plan = plan(kind, body).unwrap_or_else(|faults| panic!("{faults:?}"));
    experiment::run(&plan, vec![], &mut Silent)
        .unwrap_or_else(|_| panic!("the job fails"))
        .result
}

/// One target on a straight line past a radar that always sees it, for 41 scans.
fn passing(start: [f64; 2], velocity: [f64; 2], filter: &str) -> Value {
    json!({
        "input": {"source": "scenario", "scenario": {
            "scans": 41, "scan_period_s": 2.0,
            "sensors": [{"max_range_m": 50_000.0, "p_d": 1.0, "sigma_range_m": 15.0, "sigma_bearing_deg": 0.05}],
            "targets": {"kind": "listed", "targets": [
                {"truth_id": "a", "x_m": start[0], "y_m": start[1], "vx_mps": velocity[0], "vy_mps": velocity[1]}
            ]}
        }},
        "filter": {"method": filter},
        "tracker": {"gate_probability": 0.9999, "initial_speed_sigma_mps": 30.0}
    })
}

#[test]
fn a_target_that_crosses_north_or_south_stays_one_track() {
    // 10 km away at 20 m/s: bearings from 355° over 0° to 5°, and the same in the south, where −180° follows 180°.
    for filter in FILTERS {
        for (start, velocity) in [
            ([-400.0, 10_000.0], [20.0, 0.0]),
            ([400.0, -10_000.0], [-20.0, 0.0]),
            ([-400.0, -10_000.0], [20.0, 0.0]),
        ] {
            let result = result(JobKind::Associate, &passing(start, velocity, filter));
            let association = &result["association"];
            assert_eq!(
                association["counts"]["started_tracks"], 1,
                "{filter} from {start:?}"
            );
            assert_eq!(
                association["counts"]["associated_detections"], 41,
                "{filter} from {start:?}"
            );
            let nis = &association["nis"];
            assert_eq!(
                (&nis["updates"], &nis["dimensions"]),
                (&json!(38), &json!(2)),
                "{filter} from {start:?}"
            );
            let mean = nis["mean"].as_f64().unwrap();
            assert!(
                (0.9..3.4).contains(&mean),
                "{filter} from {start:?}: mean NIS {mean}"
            );
        }
    }
}

#[test]
fn the_polar_scenes_of_the_paper_are_tracked_by_every_filter() {
    for (targets, filter) in [10, 30, 50, 80, 100]
        .iter()
        .flat_map(|targets| FILTERS.map(|filter| (targets, filter)))
    {
        let mut preset = presets::find(&format!("liang2009-polar-{targets}")).unwrap();
        preset.body["filter"]["method"] = json!(filter);
        let result = result(preset.kind, &preset.body);
        let counts = &result["tfa"]["counts"];
        let (correct, all) = (
            counts["correct"].as_u64().unwrap(),
            counts["targets"].as_u64().unwrap(),
        );
        println!(
            "{targets} {filter}: {counts} {}",
            result["association"]["nis"]
        );
        assert!(
            all > targets * 2 / 3 && correct * 4 >= all,
            "{targets} {filter}: {correct} of {all}"
        );
    }
}

/// Correct targets of the scene of 100 over five seeds.
fn correct(preset: &str, filter: &str, initiation: &Value) -> u64 {
    let of_seed = |seed: u32| {
        let mut preset = presets::find(preset).unwrap();
        preset.body["seed"] = json!(seed);
        preset.body["filter"] = json!({"method": filter});
        preset.body["tracker"]["initiation"] = initiation.clone();
        result(preset.kind, &preset.body)["tfa"]["counts"]["correct"]
            .as_u64()
            .unwrap()
    };
    (1..=5).map(of_seed).sum()
}

#[test]
fn two_points_spare_the_filters_the_wide_gate_of_a_track_without_a_speed() {
    let [one, two] = [
        json!({"method": "one_point"}),
        json!({"method": "two_point", "max_speed_mps": 1000.0}),
    ];
    let cartesian = correct("liang2009", "kalman", &two);
    for filter in FILTERS {
        let [rough, fine] =
            [&one, &two].map(|initiation| correct("liang2009-polar", filter, initiation));
        println!(
            "{filter}: one point {rough}, two points {fine}; positions and two points {cartesian}"
        );
        assert!(
            fine > rough && fine * 100 > cartesian * 95,
            "{filter}: {rough} and {fine}, of positions {cartesian}"
        );
    }
    // The line that the extended filter takes is no worse a start than the sigma points, for it knows how the range bends.
    let [line, points] =
        ["extended", "unscented"].map(|filter| correct("liang2009-polar", filter, &one));
    assert!(
        line * 10 > points * 9,
        "extended: {line}, unscented: {points}"
    );
}

#[test]
fn the_oracle_judges_polar_scenes_as_the_truth_does() {
    for filter in FILTERS {
        let mut preset = presets::find("liang2009-polar").unwrap();
        preset.body["filter"] = json!({"method": filter});
        preset.body["associator"] = json!({"method": "oracle"});
        preset.body["tracker"]["initiation"] = json!({"method": "one_point"});
        preset.body["tracker"]["confirm_hits"] = json!(1);
        preset.body["tracker"]["confirm_window"] = json!(1);
        let result = result(preset.kind, &preset.body);
        let counts = &result["tfa"]["counts"];
        assert_eq!(counts["false"], 0, "{filter}: {counts}");
        assert!(
            counts["correct"].as_u64().unwrap() > 60,
            "{filter}: {counts}"
        );
    }
}

#[test]
fn a_scenario_must_say_what_its_sensors_report() {
    let body = |noises: Value| {
        let mut sensor = json!({"max_range_m": 1000.0});
        noises
            .as_object()
            .unwrap()
            .iter()
            .for_each(|(name, value)| sensor[name] = value.clone());
        json!({"scenario": {
            "scans": 2, "scan_period_s": 1.0, "sensors": [sensor],
            "targets": {"kind": "listed", "targets": [{"truth_id": "a", "x_m": 1.0, "y_m": 2.0}]}
        }})
    };
    let fault = |noises: Value| {
        let faults = plan(JobKind::Simulate, &body(noises)).unwrap_err();
        assert_eq!(faults.len(), 1);
        (faults[0].pointer.clone(), faults[0].code.clone())
    };
    let place = || "/scenario/sensors/0".to_owned();
    assert_eq!(fault(json!({})), (place(), "missing".to_owned()));
    assert_eq!(
        fault(json!({"sigma_x_m": 1.0})),
        (place(), "missing".to_owned())
    );
    assert_eq!(
        fault(json!({"sigma_x_m": 1.0, "sigma_y_m": 1.0, "sigma_range_m": 1.0})),
        (place(), "conflict".to_owned())
    );
    assert!(
        plan(
            JobKind::Simulate,
            &body(json!({"sigma_range_m": 1.0, "sigma_bearing_deg": 1.0}))
        )
        .is_ok()
    );
}

#[test]
fn simulated_range_rates_are_used_by_the_filters_that_can_and_sharpen_the_speed() {
    // Straight away from the radar, so that the range rate is the speed.
    let run_with = |filter: &str, sigma_mps: Option<f64>| {
        let mut body = passing([0.0, 2_000.0], [0.0, 20.0], filter);
        if let Some(sigma_mps) = sigma_mps {
            body["input"]["scenario"]["sensors"][0]["sigma_range_rate_mps"] = json!(sigma_mps);
        }
        result(JobKind::Evaluate, &body)
    };
    for filter in ["extended", "unscented"] {
        let (with, without) = (run_with(filter, Some(0.5)), run_with(filter, None));
        let nis = &with["association"]["nis"];
        assert_eq!(nis["dimensions"], 3, "{filter}");
        assert!(
            (1.8..4.6).contains(&nis["mean"].as_f64().unwrap()),
            "{filter}: {nis}"
        );
        let error = |result: &Value| {
            result["metrics"]["kinematics"]["quantities"]["along_rmse"]["value"]
                .as_f64()
                .unwrap()
        };
        let speed = |result: &Value| {
            result["metrics"]["kinematics"]["quantities"]["velocity_rmse"]["value"]
                .as_f64()
                .unwrap()
        };
        assert!(
            speed(&with) < 0.7 * speed(&without),
            "{filter}: {} m/s with, {} m/s without",
            speed(&with),
            speed(&without)
        );
        assert!(
            error(&with) < error(&without),
            "{filter}: {} m with, {} m without",
            error(&with),
            error(&without)
        );
    }
    assert_eq!(
        run_with("converted", Some(0.5))["association"]["nis"]["dimensions"],
        2,
        "it has no use for range rates"
    );
}

#[test]
fn a_range_rate_needs_a_range() {
    let mut body = passing([0.0, 2_000.0], [0.0, 20.0], "extended");
    body["input"]["scenario"]["sensors"][0] = json!({"max_range_m": 5e4, "sigma_x_m": 5.0, "sigma_y_m": 5.0, "sigma_range_rate_mps": 0.5});
    let faults = plan(JobKind::Associate, &body).unwrap_err();
    assert_eq!(
        (faults[0].pointer.as_str(), faults[0].code.as_str()),
        ("/input/scenario/sensors/0", "conflict"),
        "{faults:?}"
    );
}
