//! Sensors of scenarios that differ: in when they look, where they see, and what they tell besides places.

use serde_json::{Value, json};
use std::ops::ControlFlow;
use trackloom_domain::experiment::observer::Silent;
use trackloom_domain::experiment::{self, JobKind, plan};
use trackloom_domain::math::rng::Seed;
use trackloom_domain::model::scan::{Measurement, Recording};
use trackloom_domain::model::scenario::Scenario;
use trackloom_domain::simulation::{self, Simulated};

fn scenario(sensors: Value, targets: Value) -> Scenario {
    let scenario =
        json!({"scans": 10, "scan_period_s": 1.0, "sensors": sensors, "targets": targets});
    serde_json::from_value(scenario).unwrap()
}

fn sensor(more: Value) -> Value {
    let mut sensor = json!({
        "sensor_id": "radar", "x_m": 0.0, "y_m": 0.0, "max_range_m": 10_000.0, "p_d": 1.0,
        "sigma_x_m": 1e-6, "sigma_y_m": 1e-6
    });
    let fields = more.as_object().unwrap().clone();
    sensor.as_object_mut().unwrap().extend(fields);
    sensor
}

/// One target at (0, 1 000), east at 100 m/s.
fn eastbound() -> Value {
    json!({"kind": "listed", "targets": [{"truth_id": "1", "x_m": 0.0, "y_m": 1000.0, "vx_mps": 100.0, "vy_mps": 0.0}]})
}

fn played(scenario: &Scenario) -> Simulated {
    let seed = Seed { seed: 5, run: 0 };
    let go_on = &mut |_| ControlFlow::Continue(());
    simulation::simulate(scenario, seed, go_on)
        .unwrap()
        .unwrap()
}

fn places_m(recording: &Recording) -> Vec<(f64, [f64; 2])> {
    let mut places = Vec::new();
    for scan in &recording.scans {
        for detection in &scan.detections {
            if let Measurement::Position { x_m, y_m } = detection.measurement {
                places.push((scan.time_s, [x_m, y_m]));
            }
        }
    }
    places
}

#[test]
fn each_sensor_looks_at_its_own_times_and_as_long_as_the_others() {
    let sensors = json!([
        sensor(json!({})),
        sensor(json!({"sensor_id": "slow", "scan_period_s": 2.5, "first_scan_s": 0.5})),
        sensor(json!({"sensor_id": "tenth", "scan_period_s": 0.1, "first_scan_s": 9.5}))
    ]);
    let mut scenario = scenario(sensors, eastbound());
    let recording = played(&scenario).recording;
    let times_of = |sensor: usize| -> Vec<f64> {
        let scans = recording.scans.iter().filter(|scan| scan.sensor == sensor);
        scans.map(|scan| scan.time_s).collect()
    };
    assert_eq!(times_of(0).len(), 10);
    assert_eq!(times_of(1), [0.5, 3.0, 5.5, 8.0]);
    let tenths = times_of(2);
    assert_eq!(tenths.len(), 5, "{tenths:?}");
    assert!(recording.scans.is_sorted_by(|a, b| a.time_s <= b.time_s));
    // Where the target is at each of these times.
    for (time_s, place_m) in places_m(&recording) {
        assert!(
            (place_m[0] - 100.0 * time_s).abs() < 1e-4,
            "{time_s}: {place_m:?}"
        );
    }
    // At 3 s and 8 s two of them look.
    assert_eq!(simulation::step_count(&scenario), 10 + 4 - 2 + 5);
    scenario.sensors[1].timing.first_scan_s = Some(10.0);
    let faults = simulation::check(&scenario).unwrap_err();
    assert_eq!(
        (faults[0].pointer.as_str(), faults.len()),
        ("/sensors/1", 1)
    );
    scenario.sensors[1].timing.first_scan_s = None;
    scenario.sensors[1].timing.scan_period_s = Some(1e-5);
    assert_eq!(simulation::check(&scenario).unwrap_err().len(), 1);
}

#[test]
fn a_scan_with_latency_shows_what_was_there_before_its_stamp() {
    let sensors = json!([sensor(json!({"latency_s": 2.0}))]);
    let simulated = played(&scenario(sensors, eastbound()));
    let places = places_m(&simulated.recording);
    assert_eq!(places.len(), 10);
    for (time_s, place_m) in places {
        assert!((place_m[0] - 100.0 * (time_s - 2.0)).abs() < 1e-4);
    }
    // The truth is where the target really is.
    let points = &simulated.truth.targets()[0].points;
    let off_m = |time_s: f64, x_m: f64| (x_m - 100.0 * time_s).abs();
    assert!(
        points
            .iter()
            .all(|point| off_m(point.time_s, point.position.x) < 1e-9)
    );
}

/// Share, and standard error, of those that hold.
fn share(count: usize, all: f64, expected: f64) -> bool {
    (count as f64 - all * expected).abs() <= 4.0 * (all * expected * (1.0 - expected)).sqrt()
}

#[test]
fn targets_and_clutter_lie_in_the_field_of_view_as_its_sectors_say() {
    // An arc of 120° over north from 1 to 10 km, and in it 20° with P_D 0.3 and clutter of 2e-6 per m²; a mast of 10° on top.
    let sight = json!({
        "p_d": 0.9, "clutter_per_scan": 50.0,
        "field_of_view": {"bearing_from_deg": 300, "bearing_to_deg": 60, "range_from_m": 1000},
        "sectors": [
            {"bearing_from_deg": 40, "bearing_to_deg": 50, "p_d": 0},
            {"bearing_from_deg": 10, "bearing_to_deg": 30, "p_d": 0.3, "clutter_per_m2": 2e-6}
        ]
    });
    let at = |name: &str, bearing_deg: f64, range_m: f64| {
        let (sin, cos) = bearing_deg.to_radians().sin_cos();
        json!({"truth_id": name, "x_m": range_m * sin, "y_m": range_m * cos, "vx_mps": 0.0, "vy_mps": 0.0})
    };
    let targets = [
        at("seen", 330.0, 5000.0),
        at("dim", 20.0, 5000.0),
        at("behind the mast", 45.0, 5000.0),
        at("near", 0.0, 900.0),
        at("south", 180.0, 5000.0),
    ];
    let mut scenario = scenario(
        json!([sensor(sight)]),
        json!({"kind": "listed", "targets": targets}),
    );
    scenario.scans = 2000;
    let Simulated {
        recording, truth, ..
    } = played(&scenario);
    let names: Vec<&str> = truth
        .targets()
        .iter()
        .map(|target| target.truth_id.as_str())
        .collect();
    assert_eq!(names, ["seen", "dim"]);
    let of_target = |target: u32| {
        let detections = recording.detections();
        detections
            .filter(|detection| detection.origin == Some(target))
            .count()
    };
    assert!(share(of_target(0), 2000.0, 0.9), "{}", of_target(0));
    assert!(share(of_target(1), 2000.0, 0.3), "{}", of_target(1));

    let (mut in_dim, mut behind_mast, mut elsewhere) = (0.0, 0.0, 0.0);
    for detection in recording
        .detections()
        .filter(|detection| detection.origin.is_none())
    {
        let Measurement::Position { x_m, y_m } = detection.measurement else {
            unreachable!("positions are reported")
        };
        let (bearing_deg, range_m) = (x_m.atan2(y_m).to_degrees(), x_m.hypot(y_m));
        assert!(bearing_deg.abs() <= 60.0 && (1000.0..=10_000.0).contains(&range_m));
        match bearing_deg {
            10.0..=30.0 => in_dim += 1.0,
            40.0..=50.0 => behind_mast += 1.0,
            _ => elsewhere += 1.0,
        }
    }
    // π (10² − 1²) km² are 311 km²: of 20° 17.28 km². The other 100° share 50 a scan of 120°.
    let ring_m2 = std::f64::consts::PI * 99e6;
    for (found, per_scan) in [
        (in_dim, 2e-6 * ring_m2 / 18.0),
        (behind_mast, 50.0 / 12.0),
        (elsewhere, 50.0 * 9.0 / 12.0),
    ] {
        let mean: f64 = 2000.0 * per_scan;
        assert!((found - mean).abs() < 4.0 * mean.sqrt(), "{found} {mean}");
    }
    // What a tracker is told is the density of the rest.
    let told = &recording.sensors[0];
    let per_m2 = told.clutter_per_m2.unwrap();
    assert!((per_m2 / (50.0 / (ring_m2 / 3.0)) - 1.0).abs() < 1e-12);
    assert_eq!(told.sectors.as_ref().unwrap().len(), 2);
}

#[test]
fn velocities_are_told_with_the_noise_along_and_across_them() {
    let told = json!({"sigma_x_m": 10.0, "sigma_y_m": 10.0, "sigma_speed_mps": 2.0, "sigma_course_deg": 3.0});
    let mut scenario = scenario(json!([sensor(told)]), eastbound());
    (scenario.scans, scenario.scan_period_s) = (4000, 0.01);
    let recording = played(&scenario).recording;
    let (mut along, mut across) = (0.0, 0.0);
    for scan in &recording.scans {
        let [vx_mps, vy_mps] = scan.own[0].velocity_mps.unwrap();
        along += (vx_mps - 100.0).powi(2);
        across += vy_mps.powi(2);
    }
    // A variance of n normal errors has the relative standard error √(2/n). Across: 100 · 3° = 5.236 m/s.
    for (sum, sigma_mps) in [(along, 2.0_f64), (across, 100.0 * 3.0_f64.to_radians())] {
        let ratio = sum / 4000.0 / sigma_mps.powi(2);
        assert!(
            (ratio - 1.0).abs() < 4.0 * (2.0_f64 / 4000.0).sqrt(),
            "{ratio}"
        );
    }
}

#[test]
fn a_tracker_that_believes_told_velocities_is_consistent() {
    let body = json!({
        "input": {"source": "scenario", "scenario": {
            "scans": 400, "scan_period_s": 2.0,
            "sensors": [sensor(json!({"max_range_m": 200_000.0, "sigma_x_m": 50.0, "sigma_y_m": 50.0, "sigma_speed_mps": 2.0, "sigma_course_deg": 2.0}))],
            "targets": eastbound()
        }},
        "seed": 1,
        "associator": {"method": "global_nearest_neighbour"},
        "filter": {"method": "kalman", "process_noise_m2ps3": 1e-3}
    });
    let plan = plan(JobKind::Associate, &body).unwrap_or_else(|faults| panic!("{faults:?}"));
    let outcome = experiment::run(&plan, vec![], &mut Silent).unwrap();
    let nis = outcome.result.pointer("/association/nis/mean").unwrap();
    // Four values a report: 400 updates have a mean of 4 with a standard error of √(8/400) = 0.141.
    let nis = nis.as_f64().unwrap();
    assert!((nis - 4.0).abs() < 4.0 * 0.141, "{nis}");
}

#[test]
fn what_does_not_fit_is_told_at_its_field() {
    let faults_of = |more: Value, targets: Value| -> Vec<(String, String)> {
        let faults = simulation::check(&scenario(json!([sensor(more)]), targets)).unwrap_err();
        faults
            .into_iter()
            .map(|fault| (fault.pointer, fault.code.to_string()))
            .collect()
    };
    let of = |pointer: &str, code: &str| vec![(pointer.to_owned(), code.to_owned())];
    let half = json!({"field_of_view": {"bearing_from_deg": 10}});
    assert_eq!(
        faults_of(half, eastbound()),
        of("/sensors/0/field_of_view", "conflict")
    );
    let wrong = json!({"sectors": [{"clutter_per_deg": 1.0}]});
    assert_eq!(
        faults_of(wrong, eastbound()),
        of("/sensors/0/sectors/0", "unsupported")
    );
    let lonely = json!({"sigma_course_deg": 1.0});
    assert_eq!(
        faults_of(lonely, eastbound()),
        of("/sensors/0/sigma_course_deg", "missing")
    );
    let of_ranges = json!({"sigma_x_m": null, "sigma_y_m": null, "sigma_range_m": 1.0, "sigma_bearing_deg": 1.0, "sigma_speed_mps": 1.0});
    assert_eq!(
        faults_of(of_ranges, eastbound()),
        of("/sensors/0/sigma_speed_mps", "conflict")
    );
    let climbing = json!({"course": {"vx_mps": 1.0, "vy_mps": 0.0, "segments": [{"move": "climb", "duration_s": 1.0, "rate_mps": 1.0}]}});
    assert_eq!(
        faults_of(climbing, eastbound()),
        of("/sensors/0/course/segments", "conflict")
    );
}

#[test]
fn an_airliner_that_climbs_is_tracked_in_space() {
    let body = json!({
        "input": {"source": "scenario", "scenario": {
            "scans": 60, "scan_period_s": 4.0,
            "sensors": [sensor(json!({"max_range_m": 200_000.0, "sigma_x_m": 30.0, "sigma_y_m": 30.0, "sigma_z_m": 30.0}))],
            "targets": {"kind": "maneuvering", "targets": [{
                "truth_id": "up", "x_m": 0.0, "y_m": 0.0, "vx_mps": 0.0, "vy_mps": 150.0, "z_m": 1000.0,
                "segments": [{"move": "straight", "duration_s": 60.0}, {"move": "climb", "duration_s": 100.0, "rate_mps": 10.0}]
            }]}
        }},
        "seed": 1,
        "associator": {"method": "global_nearest_neighbour"},
        "filter": {"method": "kalman", "process_noise_m2ps3": 1.0, "vertical_process_noise_m2ps3": 1.0},
        "metrics": [{"metric": "kinematics"}]
    });
    let plan = plan(JobKind::Evaluate, &body).unwrap_or_else(|faults| panic!("{faults:?}"));
    let outcome = experiment::run(&plan, vec![], &mut Silent).unwrap();
    let tracks = outcome.result.pointer("/association/tracks").unwrap();
    assert_eq!(tracks.as_array().unwrap().len(), 1);
    let rmse_m = outcome
        .result
        .pointer("/metrics/kinematics/value")
        .and_then(Value::as_f64);
    // A fix errs by 30 √3 = 52 m.
    let rmse_m = rmse_m.unwrap();
    assert!(rmse_m > 10.0 && rmse_m < 52.0, "{rmse_m}");
}
