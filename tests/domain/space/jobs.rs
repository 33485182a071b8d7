//! Jobs with targets in space: from the file or the scene to what is told of the tracks.

use crate::origins::jobs::Texts;
use serde_json::{Value, json};
use std::fmt::Write;
use trackloom_domain::experiment::observer::Silent;
use trackloom_domain::experiment::{JobKind, Outcome, plan, presets, run};

fn value(outcome: &Outcome, metric: &str, quantity: &str) -> f64 {
    let found = &outcome.result["metrics"][metric]["quantities"][quantity]["value"];
    found.as_f64().unwrap_or(f64::NAN)
}

fn preset(change: impl FnOnce(&mut Value)) -> Outcome {
    let mut body = presets::find("two-radars").unwrap().body;
    change(&mut body);
    run(
        &plan(JobKind::Evaluate, &body).unwrap(),
        Vec::new(),
        &mut Silent,
    )
    .unwrap()
}

/// An aeroplane at 10 km that flies towards a radar, with slant ranges; truth is of the plane.
const SLANT: &str = "time_s,scan,sensor_id,detection_id,range_m,bearing_deg,elevation_deg
0,0,r,a0,22360.7,45,26.565
4,1,r,a1,21648.1,45,27.512
8,2,r,a2,20941.8,45,28.523
12,3,r,a3,20242.5,45,29.604
16,4,r,a4,19551.0,45,30.763
20,5,r,a5,18868.0,45,32.005
24,6,r,a6,18194.5,45,33.341
28,7,r,a7,17531.7,45,34.778
32,8,r,a8,16880.8,45,36.327
36,9,r,a9,16243.2,45,37.999
";

fn slant_job(change: impl FnOnce(&mut Value)) -> Outcome {
    let mut texts = Texts::of("csv");
    let mut truth = "time_s,truth_id,x_m,y_m\n".to_owned();
    for row in 0..10 {
        let place_m = 14_142.0 - 565.67 * f64::from(row);
        writeln!(truth, "{},A,{place_m},{place_m}", 4 * row).unwrap();
    }
    let mut body = json!({
        "input": texts.dataset(SLANT),
        "truth": texts.dataset(&truth),
        "sensors": [{
            "sensor_id": "r", "p_d": 0.9, "clutter_per_m2": 1e-8, "sigma_range_m": 30, "sigma_bearing_deg": 0.2, "x_m": 0, "y_m": 0
        }],
        "filter": {"method": "extended", "process_noise_m2ps3": 5},
        "tracker": {"initial_speed_sigma_mps": 250},
        "metrics": [{"metric": "clear"}, {"metric": "kinematics"}],
        "comparison": {"gate_m": 6000, "credit": "afterwards"}
    });
    change(&mut body);
    texts.run(JobKind::Evaluate, &body).unwrap()
}

#[test]
fn a_slant_range_with_its_elevation_is_tens_of_metres_off_in_space_and_in_the_plane() {
    let outcome = slant_job(|_| {});
    let error_m = value(&outcome, "kinematics", "position_rmse");
    assert!(error_m < 30.0, "{error_m}");
    assert_eq!(value(&outcome, "clear", "tp"), 10.0);
    let estimated = "sensor 'r': sigma_elevation_deg 0.236";
    let told = |outcome: &Outcome, words: &str| {
        outcome
            .warnings
            .iter()
            .any(|warning| warning.contains(words))
    };
    assert!(told(&outcome, estimated), "{:?}", outcome.warnings);
    let flat = slant_job(|body| body["tracker"]["space"] = json!("plane"));
    let error_m = value(&flat, "kinematics", "position_rmse");
    assert!(
        error_m < 30.0 && !told(&flat, "elevation"),
        "{error_m} {:?}",
        flat.warnings
    );
    for filter in ["unscented", "converted"] {
        let outcome = slant_job(|body| body["filter"]["method"] = json!(filter));
        let error_m = value(&outcome, "kinematics", "position_rmse");
        assert!(error_m < 60.0, "{filter}: {error_m}");
    }
}

/// Of a density that is given nothing is estimated; one per square metre is told where nothing is.
#[test]
fn a_density_per_cubic_metre_is_given_as_one_of_the_ground_is() {
    let mut rows = SLANT.to_owned();
    for scan in 0..10 {
        for nth in 1..4 {
            let (range_m, bearing_deg) =
                (9000 + 1711 * nth + 97 * scan * nth, 90 * nth + 31 * scan);
            let elevation_deg = 3 * nth + scan;
            writeln!(
                rows,
                "{},{scan},r,c{nth},{range_m},{bearing_deg},{elevation_deg}",
                4 * scan
            )
            .unwrap();
        }
    }
    let estimated = |settings: Value| {
        let mut texts = Texts::of("csv");
        let input = texts.dataset(&rows);
        let outcome = slant_job_of(&mut texts, input, &settings);
        outcome.result["association"]["estimates"]
            .to_string()
            .contains("clutter_per_m2")
    };
    let nothing = Value::Null;
    assert!(!estimated(
        json!({"clutter_per_m2": nothing, "clutter_per_m3": 1e-12})
    ));
    assert!(!estimated(json!({})));
    assert!(estimated(json!({"clutter_per_m2": nothing})));
}

#[test]
fn without_elevations_an_assumed_altitude_brings_slant_ranges_to_the_ground() {
    let rows: Vec<String> = SLANT
        .lines()
        .map(|line| line.rsplit_once(',').unwrap().0.to_owned())
        .collect();
    let run = |rows: &[String], settings: &Value| {
        let mut texts = Texts::of("csv");
        let text = rows.join("\n") + "\n";
        let input = texts.dataset(&text);
        let outcome = slant_job_of(&mut texts, input, settings);
        value(&outcome, "kinematics", "position_rmse")
    };
    assert!(run(&rows, &json!({})) > 2500.0, "slant ranges are too long");
    let assumed_m = run(&rows, &json!({"assumed_altitude_m": 10_000, "height_m": 0}));
    assert!(assumed_m < 30.0, "{assumed_m}");
    // A detection that tells its own height is not asked for the assumed one.
    let told: Vec<String> = rows
        .iter()
        .enumerate()
        .map(|(row, line)| format!("{line},{}", if row == 0 { "height_m" } else { "10000" }))
        .collect();
    let told_m = run(&told, &json!({"assumed_altitude_m": 0, "height_m": 0}));
    assert!((told_m - assumed_m).abs() < 1e-6, "{told_m}");
    // Without the option nothing is turned.
    assert!(run(&told, &json!({})) > 2500.0);
}

fn slant_job_of(texts: &mut Texts, input: Value, settings: &Value) -> Outcome {
    let mut truth = "time_s,truth_id,x_m,y_m\n".to_owned();
    for row in 0..10 {
        let place_m = 14_142.0 - 565.67 * f64::from(row);
        writeln!(truth, "{},A,{place_m},{place_m}", 4 * row).unwrap();
    }
    let mut sensor = json!({
        "sensor_id": "r", "p_d": 0.9, "clutter_per_m2": 1e-8, "sigma_range_m": 30, "sigma_bearing_deg": 0.2, "x_m": 0, "y_m": 0
    });
    for (name, setting) in settings.as_object().unwrap() {
        sensor[name] = setting.clone();
    }
    let known = sensor.as_object_mut().unwrap();
    known.retain(|_, setting| !setting.is_null());
    let body = json!({
        "input": input,
        "truth": texts.dataset(&truth),
        "sensors": [sensor],
        "filter": {"method": "extended", "process_noise_m2ps3": 5},
        "tracker": {"initial_speed_sigma_mps": 250},
        "metrics": [{"metric": "kinematics"}],
        "comparison": {"gate_m": 6000}
    });
    texts.run(JobKind::Evaluate, &body).unwrap()
}

/// A millimetre of range and 10⁻⁵ degrees of bearing at 8 km: the curvature is larger than the noise.
#[test]
fn a_very_precise_sensor_keeps_one_track() {
    let (mut seen, mut truth) = (
        "time_s,scan,sensor_id,detection_id,range_m,bearing_deg\n".to_owned(),
        "time_s,truth_id,x_m,y_m\n".to_owned(),
    );
    for scan in 0..30 {
        let (x_m, y_m) = (-1500.0 + 60.0 * f64::from(scan), 8000.0_f64);
        let bearing_deg = x_m.atan2(y_m).to_degrees().rem_euclid(360.0);
        writeln!(
            seen,
            "{scan},{scan},r,a{scan},{:.4},{bearing_deg:.7}",
            x_m.hypot(y_m)
        )
        .unwrap();
        writeln!(truth, "{scan},A,{x_m},{y_m}").unwrap();
    }
    for filter in ["extended", "unscented", "converted"] {
        let mut texts = Texts::of("csv");
        let body = json!({
            "input": texts.dataset(&seen),
            "truth": texts.dataset(&truth),
            "sensors": [{
                "sensor_id": "r", "p_d": 0.9, "clutter_per_m2": 1e-8, "sigma_range_m": 0.001, "sigma_bearing_deg": 1e-5,
                "x_m": 0, "y_m": 0
            }],
            "associator": {"method": "global_nearest_neighbour"},
            "filter": {"method": filter, "process_noise_m2ps3": 0},
            "tracker": {"initial_speed_sigma_mps": 60},
            "metrics": [{"metric": "clear"}],
            "comparison": {"gate_m": 1, "credit": "afterwards"}
        });
        let outcome = texts.run(JobKind::Evaluate, &body).unwrap();
        let counts = ["tp", "fn", "fp"].map(|count| value(&outcome, "clear", count));
        assert_eq!(counts, [30.0, 0.0, 0.0], "{filter}");
    }
}

#[test]
fn two_radars_on_a_curved_earth_agree_on_a_target_309_km_away() {
    let sharp = preset(|body| {
        for sensor in body["input"]["scenario"]["sensors"].as_array_mut().unwrap() {
            sensor["sigma_range_m"] = json!(0.01);
            sensor["sigma_bearing_deg"] = json!(1e-6);
            sensor["sigma_elevation_deg"] = json!(1e-6);
            sensor["p_d"] = json!(1.0);
            sensor.as_object_mut().unwrap().remove("clutter_per_scan");
        }
    });
    let error_m = value(&sharp, "kinematics", "position_rmse");
    assert!(error_m < 1.0, "{error_m}");
    assert!(value(&sharp, "kinematics", "z_rmse") < 1.0);
    let noisy = preset(|_| {});
    let error_m = value(&noisy, "kinematics", "position_rmse");
    assert!(error_m < 150.0, "{error_m}");
    // The second radar's axes taken as parallel to the first's: what it sees is 5.3 km away, a track of its own.
    let flat = preset(|body| {
        body["sensors"] =
            json!([{"sensor_id": "Cologne", "x_m": -125_350.7, "y_m": 89_273.7, "z_m": -1_816.8}]);
    });
    let [right, wrong] = [&noisy, &flat].map(|outcome| value(outcome, "clear", "fp"));
    assert!(right < 10.0 && wrong > 80.0, "{right} {wrong}");
    // Three numbers a report.
    let nis = noisy.result["association"]["nis"]["mean"].as_f64().unwrap();
    let updates = noisy.result["association"]["nis"]["updates"]
        .as_f64()
        .unwrap();
    assert!(
        (nis - 3.0).abs() < 4.0 * (6.0 / updates).sqrt(),
        "{nis} {updates}"
    );
    let nees = value(&noisy, "kinematics", "nees_state");
    assert!((3.0..9.0).contains(&nees), "{nees}");
}

/// A radar of the plane and a camera beside a radar of space.
#[test]
fn sensors_of_the_plane_update_tracks_in_space_and_start_none() {
    let scenario = json!({
        "scans": 40, "scan_period_s": 2.0,
        "sensors": [
            {"sensor_id": "three", "x_m": 0.0, "y_m": 0.0, "z_m": 100.0, "max_range_m": 60000.0, "p_d": 0.9,
             "sigma_range_m": 20.0, "sigma_bearing_deg": 0.1, "sigma_elevation_deg": 0.1, "sigma_range_rate_mps": 1.0, "clutter_per_scan": 3.0},
            {"sensor_id": "two", "x_m": 5000.0, "y_m": 0.0, "z_m": 0.0, "max_range_m": 60000.0, "p_d": 0.9,
             "sigma_range_m": 20.0, "sigma_bearing_deg": 0.1, "clutter_per_scan": 3.0},
            {"sensor_id": "camera", "x_m": 0.0, "y_m": 8000.0, "max_range_m": 60000.0, "p_d": 0.9, "sigma_bearing_deg": 0.05,
             "sigma_elevation_deg": 0.05},
            {"sensor_id": "beacon", "x_m": 0.0, "y_m": 0.0, "max_range_m": 60000.0, "p_d": 0.9, "sigma_x_m": 15.0, "sigma_y_m": 15.0}
        ],
        "targets": {"kind": "listed", "targets": [
            {"truth_id": "1", "x_m": 12000.0, "y_m": 6000.0, "z_m": 3000.0, "vx_mps": -90.0, "vy_mps": 40.0, "vz_mps": 5.0},
            {"truth_id": "2", "x_m": -9000.0, "y_m": 15000.0, "z_m": 7000.0, "vx_mps": 100.0, "vy_mps": -100.0}
        ]}
    });
    for (filter, initiation) in [
        ("extended", json!({"method": "one_point"})),
        (
            "unscented",
            json!({"method": "two_point", "max_speed_mps": 300.0}),
        ),
        ("converted", json!({"method": "truth"})),
        ("imm", json!({"method": "one_point"})),
    ] {
        for associator in ["global_nearest_neighbour", "jpda"] {
            let body = json!({
                "seed": 3,
                "input": {"source": "scenario", "scenario": scenario},
                "associator": {"method": associator},
                "filter": {"method": filter},
                "tracker": {"initiation": initiation, "gate_probability": 0.9999},
                "metrics": [{"metric": "clear"}, {"metric": "kinematics"}],
                "comparison": {"gate_m": 500.0}
            });
            let outcome = run(
                &plan(JobKind::Evaluate, &body).unwrap(),
                Vec::new(),
                &mut Silent,
            )
            .unwrap();
            let [position_m, height_m, tracks] = [
                ("kinematics", "position_rmse"),
                ("kinematics", "z_rmse"),
                ("clear", "mota"),
            ]
            .map(|(metric, quantity)| value(&outcome, metric, quantity));
            assert!(
                position_m < 80.0 && height_m < 60.0 && tracks > 0.9,
                "{filter} {associator}: {position_m} {height_m} {tracks}"
            );
        }
    }
}

/// Every motion tracks a climbing target with a radar of space.
#[test]
fn every_motion_follows_a_climber() {
    for motion in [
        json!({"model": "constant_velocity"}),
        json!({"model": "constant_acceleration"}),
        json!({"model": "coordinated_turn", "turn_rate_degps": 0.1}),
        json!({"model": "unknown_turn", "turn_noise_deg2ps3": 0.001}),
        json!({"model": "singer"}),
        json!({"model": "ornstein_uhlenbeck", "damping_per_s": 0.0001}),
    ] {
        let body = json!({
            "seed": 5,
            "input": {"source": "scenario", "scenario": {
                "scans": 40, "scan_period_s": 4.0,
                "sensors": [{"sensor_id": "radar", "max_range_m": 90000.0, "p_d": 0.95,
                             "sigma_x_m": 30.0, "sigma_y_m": 30.0, "sigma_z_m": 60.0, "clutter_per_scan": 1.0}],
                "targets": {"kind": "listed", "targets": [
                    {"truth_id": "1", "x_m": 20000.0, "y_m": -8000.0, "z_m": 1000.0, "vx_mps": -150.0, "vy_mps": 90.0, "vz_mps": 12.0}
                ]}
            }},
            "filter": {"method": "kalman", "motion": motion},
            "tracker": {"gate_probability": 0.999},
            "metrics": [{"metric": "clear"}, {"metric": "kinematics"}],
            "comparison": {"gate_m": 500.0}
        });
        let outcome = run(
            &plan(JobKind::Evaluate, &body).unwrap(),
            Vec::new(),
            &mut Silent,
        )
        .unwrap();
        let error_m = value(&outcome, "kinematics", "z_rmse");
        assert!(
            error_m < 60.0 && value(&outcome, "clear", "fn") < 5.0,
            "{motion}: {error_m} {}",
            outcome.result["metrics"]["clear"]
        );
        let climb_mps = value(&outcome, "kinematics", "velocity_rmse");
        assert!(climb_mps < 40.0, "{motion}: {climb_mps}");
    }
}
