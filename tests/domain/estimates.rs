//! Recordings of which nobody says anything but what is in them: noise, P_D, clutter and speeds are estimated, and told.

use serde_json::{Value, json};
use trackloom_domain::experiment::observer::Silent;
use trackloom_domain::experiment::{self, Input, JobKind, Outcome, plan};
use trackloom_domain::formats::{ReadOptions, format_named};
use trackloom_domain::model::dataset::DatasetKind;

fn done(kind: JobKind, body: &Value, inputs: Vec<Option<Input>>) -> Outcome {
    let plan = plan(kind, body).unwrap_or_else(|faults| panic!("{faults:?}"));
    experiment::run(&plan, inputs, &mut Silent).unwrap_or_else(|error| panic!("{error:?}"))
}

/// A file as nobody describes it.
fn input(bytes: &[u8], kind: DatasetKind) -> Option<Input> {
    let options = ReadOptions {
        kind: Some(kind),
        ..ReadOptions::default()
    };
    let read = (format_named("csv").unwrap().read)(&mut &*bytes, &options).unwrap();
    Some(Input {
        dataset: read.dataset,
        sensors: Vec::new(),
        sha256: String::new(),
    })
}

/// A scenario simulated, and tracked as a recording of which nothing is known, judged with truth.
fn tracked(scenario: &Value, sensors: &Value) -> Outcome {
    let simulated = done(
        JobKind::Simulate,
        &json!({"scenario": scenario}),
        Vec::new(),
    );
    let file = |kind: DatasetKind| {
        let name = format!("{}.csv", kind.name());
        let file = simulated.artifacts.iter().find(|file| file.name == name);
        input(&file.unwrap().bytes, kind)
    };
    let mut body = json!({
        "input": {"source": "dataset", "dataset_id": "detections"}, "truth": {"source": "dataset", "dataset_id": "truth"},
        "associator": {"method": "global_nearest_neighbour"},
        "comparison": {"gate_m": 200.0, "credit": "afterwards"}, "metrics": [{"metric": "gospa", "cutoff_m": 200.0}]
    });
    if sensors.is_array() {
        body["sensors"] = sensors.clone();
    }
    done(
        JobKind::Evaluate,
        &body,
        vec![file(DatasetKind::Detections), file(DatasetKind::Truth)],
    )
}

fn scenario(sensor: Value) -> Value {
    json!({"scans": 120, "scan_period_s": 2.0, "sensors": [sensor],
        "targets": {"kind": "random", "count": 12, "area_side_m": 8000.0, "speed_min_mps": 10.0, "speed_max_mps": 30.0}})
}

/// Value and standard error.
fn estimate(outcome: &Outcome, setting: &str) -> (f64, f64) {
    let estimates = outcome.result["association"]["estimates"]
        .as_array()
        .unwrap();
    let found = estimates
        .iter()
        .find(|estimate| estimate["setting"] == setting);
    let found = found.unwrap_or_else(|| panic!("{setting} of {estimates:?}"));
    (
        found["value"].as_f64().unwrap(),
        found["standard_error"].as_f64().unwrap(),
    )
}

fn is_near(outcome: &Outcome, setting: &str, wanted: f64, share: f64) {
    let (value, error) = estimate(outcome, setting);
    println!("{setting} {value} ± {error} for {wanted}");
    assert!(
        (value / wanted - 1.0).abs() < share,
        "{setting} {value} for {wanted}"
    );
    assert!(error > 0.0 && error < share * wanted, "{setting} ± {error}");
}

#[test]
fn positions_tell_noise_detection_and_clutter() {
    let scene = scenario(
        json!({"sensor_id": "radar", "max_range_m": 8000.0, "p_d": 0.8, "sigma_x_m": 20.0, "sigma_y_m": 8.0, "clutter_per_scan": 10.0}),
    );
    let outcome = tracked(&scene, &Value::Null);
    is_near(&outcome, "sigma_x_m", 20.0, 0.2);
    is_near(&outcome, "sigma_y_m", 8.0, 0.2);
    is_near(&outcome, "p_d", 0.8, 0.07);
    // The rectangle that holds all detections is 4 / π of the disc: 10 / 16 000².
    is_near(&outcome, "clutter_per_m2", 10.0 / 16_000.0f64.powi(2), 0.25);
    let told = |word: &str| {
        outcome
            .warnings
            .iter()
            .any(|warning| warning.contains(word))
    };
    assert!(
        told("sensor 'radar': sigma_x_m") && told("give it in /sensors to fix it"),
        "{:?}",
        outcome.warnings
    );
    let given = json!([{"sensor_id": "radar", "p_d": 0.8, "sigma_x_m": 20.0, "sigma_y_m": 8.0, "clutter_per_m2": 10.0 / 16_000.0f64.powi(2)}]);
    let best = tracked(&scene, &given);
    let number = |outcome: &Outcome, pointer: &str| {
        outcome.result.pointer(pointer).unwrap().as_f64().unwrap()
    };
    for quantity in ["localisation_sum", "missed_sum"] {
        let pointer = format!("/metrics/gospa/quantities/{quantity}/value");
        let [open, known] = [&outcome, &best].map(|outcome| number(outcome, &pointer));
        assert!(open < 1.05 * known, "{quantity} {open} for {known}");
    }
    let [open, known] =
        [&outcome, &best].map(|outcome| number(outcome, "/association/counts/tracks"));
    assert!((open - known).abs() <= 2.0, "{open} tracks for {known}");
    assert!(best.result["association"].get("estimates").is_none());
}

#[test]
fn ranges_and_bearings_tell_theirs() {
    let scene = scenario(
        json!({"sensor_id": "radar", "max_range_m": 8000.0, "p_d": 0.9, "sigma_range_m": 15.0, "sigma_bearing_deg": 0.4, "clutter_per_scan": 5.0}),
    );
    let outcome = tracked(&scene, &Value::Null);
    is_near(&outcome, "sigma_range_m", 15.0, 0.2);
    is_near(&outcome, "sigma_bearing_deg", 0.4, 0.2);
    is_near(&outcome, "p_d", 0.9, 0.07);
}

#[test]
fn what_is_given_stays() {
    let scene = scenario(
        json!({"sensor_id": "radar", "max_range_m": 8000.0, "p_d": 0.8, "sigma_x_m": 20.0, "sigma_y_m": 20.0, "clutter_per_scan": 10.0}),
    );
    let given = json!([{"sensor_id": "radar", "sigma_x_m": 22.0, "sigma_y_m": 18.0, "clutter_per_m2": 1e-7}]);
    let outcome = tracked(&scene, &given);
    let estimates = outcome.result["association"]["estimates"]
        .as_array()
        .unwrap();
    assert_eq!(estimates.len(), 1, "{estimates:?}");
    is_near(&outcome, "p_d", 0.8, 0.07);
    let wanted = json!([{"sensor_id": "radar", "p_d": 0.8, "sigma_x_m": 20.0, "sigma_y_m": 20.0, "clutter_per_m2": 3e-6, "clutter": {"method": "estimated"}}]);
    let outcome = tracked(&scene, &wanted);
    is_near(&outcome, "clutter_per_m2", 10.0 / 16_000.0f64.powi(2), 0.25);
}

#[test]
fn a_fast_target_in_few_scans_is_tracked_or_told() {
    let mut text = String::from("time_s,scan,sensor_id,detection_id,x_m,y_m\n");
    for (scan, error) in [0.4, -1.1, 0.8, 0.1, -0.5, 1.3, -0.2, 0.6, -0.9, 0.3]
        .into_iter()
        .enumerate()
    {
        let (x_m, y_m) = (250.0 * scan as f64 + error, 3.0 * error);
        text += &format!("{scan},{},radar,{scan},{x_m},{y_m}\n", scan + 1);
    }
    for sensors in [
        json!([{"sensor_id": "radar", "sigma_x_m": 1.0, "sigma_y_m": 1.0}]),
        Value::Null,
    ] {
        let mut body = json!({"input": {"source": "dataset", "dataset_id": "detections"}});
        if sensors.is_array() {
            body["sensors"] = sensors;
        }
        let outcome = done(
            JobKind::Associate,
            &body,
            vec![input(text.as_bytes(), DatasetKind::Detections)],
        );
        let tracks = outcome.result["association"]["counts"]["tracks"]
            .as_u64()
            .unwrap();
        let is_told = outcome
            .warnings
            .iter()
            .any(|warning| warning.contains("no track was confirmed"));
        assert!(tracks == 1 || is_told, "{:?}", outcome.warnings);
        println!("{tracks} {:?}", outcome.warnings);
    }
}
