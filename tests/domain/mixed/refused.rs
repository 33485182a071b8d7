//! Mixtures that cannot work: each is told by one fault, before the job runs as well as in it.

use super::{Values, camera_first, recording, run, tracks_of};
use serde_json::{Value, json};
use trackloom_domain::experiment::{self, JobKind, Known, RunError};
use trackloom_domain::model::dataset::Dataset;
use trackloom_domain::model::fault::Fault;
use trackloom_domain::model::sensor::SensorSettings;

/// What is known of the four sensors when a job of this kind is posted.
fn told_at_once(
    kind: JobKind,
    request: &Value,
    csv: &str,
    uploaded: &[SensorSettings],
) -> Vec<Fault> {
    let plan = experiment::plan(kind, request).unwrap_or_else(|faults| panic!("{faults:?}"));
    let known = Known::from_dataset(&Dataset::Detections(recording(csv)), uploaded);
    let wanted = plan.inputs.iter();
    let known: Vec<_> = wanted
        .map(|input| known.clone().filter(|_| input.pointer == "/input"))
        .collect();
    plan.job.check_known(&plan.inputs, &known).faults
}

/// The one fault of a job, the same when it is posted and when it runs.
fn the_fault(request: &Value, csv: &str) -> Fault {
    let at_once = told_at_once(JobKind::Associate, request, csv, &[]);
    let Err(RunError::Faults(faults)) = run(request, csv) else {
        panic!("not refused")
    };
    assert_eq!(at_once, faults);
    assert_eq!(faults.len(), 1, "{faults:?}");
    faults.into_iter().next().unwrap()
}

/// The rows of some sensors, and what the request says of them.
fn of_sensors(values: &Values, sensor_ids: &[&str]) -> (Value, String) {
    let mut request = values.request("unscented");
    let sensors = request["sensors"].as_array_mut().unwrap();
    sensors.retain(|sensor| sensor_ids.contains(&sensor["sensor_id"].as_str().unwrap()));
    let csv = values.csv(true);
    let is_wanted = |row: &&str| {
        row.starts_with("time_s") || sensor_ids.contains(&row.split(',').nth(2).unwrap())
    };
    let rows: Vec<&str> = csv.lines().filter(is_wanted).collect();
    (request, rows.join("\n") + "\n")
}

fn camera(request: &mut Value) -> &mut Value {
    let sensors = request["sensors"].as_array_mut().unwrap();
    sensors
        .iter_mut()
        .find(|sensor| sensor["sensor_id"] == "camera")
        .unwrap()
}

#[test]
fn a_camera_whose_place_is_unknown_is_refused() {
    let values = Values::read();
    let mut request = values.request("unscented");
    camera(&mut request).as_object_mut().unwrap().remove("y_m");
    let fault = the_fault(&request, &values.csv(true));
    assert_eq!(
        (fault.pointer.as_str(), fault.code.as_str()),
        ("/sensors", "missing")
    );
    for word in ["'camera'", "'x_m'", "'y_m'"] {
        assert!(fault.detail.contains(word), "{fault:?}");
    }
}

#[test]
fn a_camera_that_should_start_tracks_is_refused() {
    let values = Values::read();
    let mut request = values.request("unscented");
    camera(&mut request)["may_start"] = json!(true);
    let fault = the_fault(&request, &values.csv(true));
    assert_eq!(
        (fault.pointer.as_str(), fault.code.as_str()),
        ("/sensors", "unsupported")
    );
    assert!(fault.detail.contains("'camera'"), "{fault:?}");
    assert_eq!(fault.allowed.as_deref(), Some("may_start false"));
}

#[test]
fn a_camera_that_says_nothing_of_it_does_not_start_tracks() {
    let values = Values::read();
    let mut request = values.request("unscented");
    camera(&mut request)
        .as_object_mut()
        .unwrap()
        .remove("may_start");
    assert_eq!(
        told_at_once(JobKind::Associate, &request, &values.csv(true), &[]),
        []
    );
    let said = run(&values.request("unscented"), &values.csv(true)).unwrap();
    let unsaid = run(&request, &values.csv(true)).unwrap();
    assert_eq!(tracks_of(&unsaid), tracks_of(&said));
}

#[test]
fn an_upload_may_say_what_starts_tracks() {
    let values = Values::read();
    let uploaded = |may_start| SensorSettings {
        may_start: Some(may_start),
        ..SensorSettings::named("camera")
    };
    let mut request = values.request("unscented");
    camera(&mut request)
        .as_object_mut()
        .unwrap()
        .remove("may_start");
    let faults = |upload| told_at_once(JobKind::Associate, &request, &values.csv(true), &[upload]);
    assert_eq!(faults(uploaded(false)), []);
    assert_eq!(
        faults(uploaded(true))[0].allowed.as_deref(),
        Some("may_start false")
    );
}

#[test]
fn the_kalman_filter_refuses_a_camera_by_name() {
    let values = Values::read();
    let (mut request, csv) = of_sensors(&values, &["positions", "camera"]);
    request["filter"] = json!({"method": "kalman"});
    let fault = the_fault(&request, &csv);
    assert_eq!(
        (fault.pointer.as_str(), fault.code.as_str()),
        ("/filter/method", "unsupported")
    );
    assert_eq!(
        fault.detail,
        "sensor 'camera' reports bearings without ranges, which the filter 'kalman' cannot use; 'sensor_ids' of the input can leave it out"
    );
    assert_eq!(fault.allowed.as_deref(), Some("positions (x_m, y_m)"));
}

#[test]
fn cameras_alone_are_refused_together() {
    let values = Values::read();
    let (mut request, csv) = of_sensors(&values, &["camera"]);
    let mut second = request["sensors"][0].clone();
    second["sensor_id"] = json!("infrared");
    request["sensors"].as_array_mut().unwrap().push(second);
    // Every other scan is of the other camera.
    let mut rows: Vec<String> = csv.lines().map(str::to_owned).collect();
    for row in &mut rows {
        if row.starts_with("3.5,") {
            *row = row.replace("camera", "infrared");
        }
    }
    let fault = the_fault(&request, &(rows.join("\n") + "\n"));
    assert_eq!(
        (fault.pointer.as_str(), fault.code.as_str()),
        ("/filter/method", "unsupported")
    );
    assert_eq!(
        fault.detail,
        "sensors 'camera', 'infrared' report bearings without ranges, which the filter 'unscented' cannot use"
    );
}

#[test]
fn a_recording_in_which_nothing_may_start_a_track_is_refused() {
    let values = Values::read();
    let mut request = values.request("unscented");
    for sensor in request["sensors"].as_array_mut().unwrap() {
        sensor["may_start"] = json!(false);
    }
    let fault = the_fault(&request, &values.csv(true));
    assert_eq!(
        (fault.pointer.as_str(), fault.code.as_str()),
        ("/sensors", "conflict")
    );
    assert_eq!(
        fault.allowed.as_deref(),
        Some("a sensor with may_start true")
    );
}

#[test]
fn a_density_over_the_plane_is_none_of_a_camera() {
    let values = Values::read();
    let mut request = values.request("unscented");
    let sensor = camera(&mut request).as_object_mut().unwrap();
    sensor.remove("clutter_per_deg");
    sensor.insert("clutter_per_m2".to_owned(), json!(1e-6));
    let fault = the_fault(&request, &values.csv(true));
    assert!(fault.pointer.ends_with("/clutter_per_m2"), "{fault:?}");
    assert_eq!(fault.allowed.as_deref(), Some("clutter_per_deg"));
}

#[test]
fn one_sensor_reports_one_kind_of_thing() {
    let values = Values::read();
    let request = values.request("unscented");
    let csv = values.csv(true).replace(",camera,", ",positions,");
    let mut request = request;
    let sensors = request["sensors"].as_array_mut().unwrap();
    sensors.retain(|sensor| sensor["sensor_id"] != "camera");
    let fault = the_fault(&request, &csv);
    assert!(
        fault
            .detail
            .contains("'positions' reports bearings in some detections and places in others"),
        "{fault:?}"
    );
}

#[test]
fn a_camera_has_no_tracks_of_its_own_to_correlate() {
    let values = Values::read();
    let mut request = values.request("unscented");
    request["correlator"] = json!({"method": "genetic"});
    request["statistic"] = json!({"kind": "all_pairs", "k": "latest"});
    let faults = told_at_once(JobKind::Correlate, &request, &values.csv(true), &[]);
    assert_eq!(faults.len(), 1, "{faults:?}");
    assert!(
        faults[0].pointer == "/filter/method" && faults[0].detail.starts_with("sensor 'camera'"),
        "{faults:?}"
    );
    request["input"]["sensor_ids"] = json!(["positions", "radar", "doppler"]);
    let sensors = request["sensors"].as_array_mut().unwrap();
    sensors.retain(|sensor| sensor["sensor_id"] != "camera");
    assert_eq!(
        told_at_once(JobKind::Correlate, &request, &values.csv(true), &[]),
        []
    );
}

#[test]
fn a_scenario_with_a_camera_is_not_correlated() {
    let mut request = json!({
        "input": camera_first(),
        "correlator": {"method": "genetic"},
        "statistic": {"kind": "all_pairs", "k": "latest"}
    });
    let faults = experiment::plan(JobKind::Correlate, &request).unwrap_err();
    assert_eq!(
        (faults.len(), faults[0].pointer.as_str()),
        (1, "/filter/method")
    );
    let scenario = &mut request["input"]["scenario"];
    scenario["sensors"][0]["sigma_range_m"] = json!(20.0);
    assert!(experiment::plan(JobKind::Correlate, &request).is_ok());
}
