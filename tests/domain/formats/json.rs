//! Canonical JSON: the same checks as CSV, with pointers instead of lines.

use super::*;
use trackloom_domain::model::sensor::SensorSettings;

#[test]
fn columns_become_a_recording_with_the_sensors_described() {
    let text = r#"{"kind": "detections", "columns": {"time_s": [0, 0, 1.5], "scan": [1, 1, 2], "sensor_id": ["r", "r", "r"],
        "detection_id": ["a", "b", null], "x_m": [1, 2.5, null], "y_m": [-3, 4e2, null], "truth_id": [7, null, null]},
        "sensors": [{"sensor_id": "r", "p_d": 0.9}, {"sensor_id": "idle", "x_m": 5}]}"#;
    let outcome = read("json", text).expect("the file is sound");
    assert_eq!(outcome.warnings, Vec::<String>::new());
    let recording = recording(outcome);
    let idle = SensorSettings {
        x_m: Some(5.0),
        ..SensorSettings::named("idle")
    };
    assert_eq!(
        recording.sensors,
        [
            idle,
            SensorSettings {
                p_d: Some(0.9),
                ..SensorSettings::named("r")
            }
        ]
    );
    assert_eq!(
        recording
            .scans
            .iter()
            .map(|scan| (scan.number, scan.sensor, scan.detections.len()))
            .collect::<Vec<_>>(),
        [(1, 1, 2), (2, 1, 0)]
    );
    assert_eq!(
        recording.scans[0].detections[1]
            .measurement
            .position()
            .map(|at| (at.x, at.y)),
        Some((2.5, 400.0))
    );
    assert_eq!(
        (
            recording.targets.as_slice(),
            recording.scans[0].detections[0].origin
        ),
        (["7".to_owned()].as_slice(), Some(0))
    );
}

#[test]
fn faults_point_into_the_columns() {
    let text = r#"{"columns": {"time_s": [0, 1, 0.5], "truth_id": ["A", "A", "A"], "x_m": [1, "two", 3], "y_m": [1, null, "inf"]}}"#;
    let faults = read("json", text).expect_err("four faults");
    let at =
        |pointer: &str, code, detail| Fault::new(format!("/file/columns/{pointer}"), code, detail);
    assert_eq!(
        faults,
        [
            at("x_m/1", "malformed", "expected a number, found 'two'"),
            at("y_m/1", "missing", "'y_m' is empty"),
            at("y_m/2", "not_finite", "'inf' is not a finite number"),
        ]
    );
    let missing =
        r#"{"kind": "truth", "columns": {"time_s": [1], "a/b": [1], "x_m": [1], "y_m": [3]}}"#;
    let known = "time_s, truth_id, x_m, y_m, vx_mps, vy_mps, z_m, bearing_deg, lat_deg, lon_deg, height_m, speed_mps, course_deg, time_base, address, callsign, mode_a, mode_c_ft, position_accuracy_m, mmsi, ship_name, ship_type, track_number, on_ground, report_kind";
    assert_eq!(
        fault("json", missing),
        at(
            "truth_id",
            "missing",
            "a file of truth needs a column 'truth_id'"
        )
        .allowing(known)
    );
}

#[test]
fn values_that_no_sensor_has_are_faults() {
    let text = r#"{"columns": {"time_s": [0, 1], "scan": [1, 2], "sensor_id": ["r", "r"], "detection_id": ["a", "b"],
        "range_m": [0, -3], "bearing_deg": [1, 2]}, "sensors": [{"sensor_id": "r"}]}"#;
    let expected = Fault::new(
        "/file/columns/range_m/1",
        "out_of_range",
        "a range of -3 m is below zero",
    )
    .allowing(">= 0 m");
    assert_eq!(fault("json", text), expected);
    let sensors = r#""sensors": [{"sensor_id": "r", "p_d": 1.5, "sigma_range_m": -1, "sigma_x_m": 0, "clutter_per_m2": -1e-9, "x_m": -5}]"#;
    let faults = read(
        "json",
        text.replace("-3", "3")
            .replace(r#""sensors": [{"sensor_id": "r"}]"#, sensors),
    )
    .expect_err("four faults");
    let of = |field: &str, value: &str, allowed: &str| {
        Fault::new(
            format!("/file/sensors/0/{field}"),
            "out_of_range",
            format!("{value} is out of range"),
        )
        .allowing(allowed)
    };
    assert_eq!(
        faults,
        [
            of("p_d", "1.5", "(0, 1]"),
            of("clutter_per_m2", "-0.000000001", "> 0"),
            of("sigma_x_m", "0", "> 0"),
            of("sigma_range_m", "-1", "> 0"),
        ]
    );
}

#[test]
fn faults_of_the_whole_are_collected() {
    let text = r#"{"kind": "truth", "columns": {"time_s": [1, 2], "x/m": [1], "y_m": [1, 2, 3]},
        "sensors": [{"sensor_id": "r"}, {"sensor_id": "r"}, {"sensor_id": ""}]}"#;
    let faults = read_with("json", text, &of_kind(DatasetKind::Tracks)).expect_err("five faults");
    assert_eq!(
        faults,
        [
            Fault::new(
                "/file/kind",
                "conflict",
                "the file says it holds truth, the upload says tracks"
            ),
            Fault::new(
                "/file/columns/x~1m",
                "malformed",
                "the column has 1 values, 'time_s' has 2"
            ),
            Fault::new(
                "/file/columns/y_m",
                "malformed",
                "the column has 3 values, 'time_s' has 2"
            ),
            Fault::new(
                "/file/sensors/1/sensor_id",
                "duplicate",
                "sensor 'r' is described twice"
            ),
            Fault::new(
                "/file/sensors/2/sensor_id",
                "missing",
                "'sensor_id' is empty"
            ),
        ]
    );
}

#[test]
fn a_column_twice_is_a_duplicate() {
    let text =
        r#"{"columns": {"time_s": [1], "truth_id": ["A"], "x_m": [1], "x_m": [2], "y_m": [3]}}"#;
    assert_eq!(
        fault("json", text),
        Fault::new(
            "/file/columns/x_m",
            "duplicate",
            "column 'x_m' occurs twice: columns 3 and 4"
        )
    );
}

#[test]
fn broken_text_has_line_and_character() {
    let broken = |text: &str, line, character: &str, code: &str| {
        let found = fault("json", text);
        assert_eq!(
            (found.pointer.as_str(), found.code.as_str()),
            ("/file", code),
            "{found:?}"
        );
        assert_eq!(
            (found.line, found.column.as_deref()),
            (Some(line), Some(character)),
            "{found:?}"
        );
    };
    broken("{\"columns\":\n {\"x_m\": [1, NaN]}}", 2, "14", "malformed");
    broken("{\"columns\": {\"x_m\": [1, ", 1, "24", "malformed");
    broken("{\"columns\": {\"x_m\": 1}}", 1, "22", "wrong_type");
    broken("{\"columns\": {}, \"kinds\": []}", 1, "28", "wrong_type");
    assert_eq!(
        fault("json", " \n"),
        Fault::new("/file", "empty", "the file is empty")
    );
}
