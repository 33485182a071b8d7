//! Files that cannot be read: the problem names line and column, and nothing is kept.

use crate::helpers::{Api, validation};
use serde_json::{Value, json};

const HEADER: &str = "time_s,scan,sensor_id,detection_id,x_m,y_m\n";

async fn refusal(content: &str) -> Value {
    let api = Api::start().await;
    let answer = api.upload(&json!({"name": "bad"}), content).await;
    let listed = api.get("/v1/datasets?count=true").await.ok(200);
    assert_eq!(
        (&listed["items"], &listed["total"]),
        (&json!([]), &json!(0))
    );
    assert_eq!(
        std::fs::read_dir(api.jobs.datasets().temp_dir())
            .unwrap()
            .count(),
        0
    );
    answer.problem()
}

/// The only fault: code, detail, line, column.
fn one(code: &str, detail: &str, line: u64, column: &str) -> Value {
    validation(
        detail,
        json!([{"pointer": "/file", "code": code, "detail": detail, "line": line, "column": column}]),
    )
}

#[tokio::test(flavor = "multi_thread")]
async fn a_broken_csv_is_refused_with_line_and_column() {
    let found = refusal(&format!("{HEADER}0,1,radar,a,1,2\n0,1,radar,b,oops,2\n")).await;
    assert_eq!(
        found,
        one("malformed", "expected a number, found 'oops'", 3, "x_m")
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn a_row_of_the_wrong_length_is_refused() {
    let found = refusal(&format!("{HEADER}0,1,radar,a,1\n")).await;
    assert_eq!(
        found,
        one(
            "malformed",
            "the row has 5 values, the header names 6 columns",
            2,
            "y_m"
        )
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn a_missing_column_is_named_with_those_that_are_known() {
    let found = refusal("time_s,scan,sensor_id,detection_id,x_m\n0,1,radar,a,1\n").await;
    let detail = "column 'y_m' is missing: x_m, y_m come together";
    let allowed = "time_s, scan, sensor_id, detection_id, x_m, y_m, range_m, bearing_deg, range_rate_mps, amplitude, truth_id, z_m, elevation_deg, vx_mps, vy_mps, sigma_x_m, sigma_y_m, correlation_xy, sigma_z_m, sigma_range_m, sigma_bearing_deg, sigma_elevation_deg, sigma_range_rate_mps, sigma_speed_mps, sigma_course_deg, sensor_x_m, sensor_y_m, sensor_z_m, sensor_vx_mps, sensor_vy_mps, sensor_vz_mps, sensor_heading_deg, sensor_pitch_deg, sensor_roll_deg, sensor_sigma_x_m, sensor_sigma_y_m, sensor_sigma_z_m, sensor_sigma_vx_mps, sensor_sigma_vy_mps, sensor_sigma_vz_mps, sensor_sigma_heading_deg, sensor_sigma_pitch_deg, sensor_sigma_roll_deg, lat_deg, lon_deg, height_m, speed_mps, course_deg, time_base, address, callsign, mode_a, mode_c_ft, position_accuracy_m, mmsi, ship_name, ship_type, track_number, on_ground, report_kind";
    let fault = json!({"pointer": "/file", "code": "missing", "detail": detail, "allowed": allowed, "line": 1, "column": "y_m"});
    assert_eq!(found, validation(detail, json!([fault])));
}

#[tokio::test(flavor = "multi_thread")]
async fn a_duplicate_column_is_refused() {
    let found =
        refusal("time_s,scan,sensor_id,detection_id,x_m,y_m,x_m\n0,1,radar,a,1,2,3\n").await;
    assert_eq!(
        found,
        one(
            "duplicate",
            "column 'x_m' occurs twice: columns 5 and 7",
            1,
            "x_m"
        )
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn a_value_that_is_no_finite_number_is_refused() {
    let found = refusal(&format!("{HEADER}0,1,radar,a,NaN,2\n")).await;
    assert_eq!(
        found,
        one("not_finite", "'NaN' is not a finite number", 2, "x_m")
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn scan_numbers_that_fall_with_time_are_refused() {
    let found = refusal(&format!("{HEADER}0,2,radar,a,1,2\n8,1,radar,b,1,2\n")).await;
    let detail = "sensor 'radar': scan 2 at 0 s is before the end of scan 1 at 8 s; scan numbers rise with time (line 3)";
    assert_eq!(found, one("unsorted", detail, 2, "scan"));
}

#[tokio::test(flavor = "multi_thread")]
async fn a_detection_named_twice_in_a_scan_is_refused() {
    let found = refusal(&format!("{HEADER}0,1,radar,a,1,2\n0,1,radar,a,3,4\n")).await;
    let detail = "detection 'a' occurs twice in scan 1 of sensor 'radar': also on line 2";
    assert_eq!(found, one("duplicate", detail, 3, "detection_id"));
}

#[tokio::test(flavor = "multi_thread")]
async fn two_faults_are_told_at_once() {
    let found = refusal(&format!("{HEADER}0,1,radar,a,NaN,2\n0,1,radar,b,1,x\n")).await;
    let faults = json!([
        {"pointer": "/file", "code": "not_finite", "detail": "'NaN' is not a finite number", "line": 2, "column": "x_m"},
        {"pointer": "/file", "code": "malformed", "detail": "expected a number, found 'x'", "line": 3, "column": "y_m"}
    ]);
    assert_eq!(found, validation("2 faults", faults));
}

#[tokio::test(flavor = "multi_thread")]
async fn an_empty_file_is_refused() {
    let detail = "the file is empty; its first line must name the columns";
    let fault = json!({"pointer": "/file", "code": "empty", "detail": detail, "line": 1});
    assert_eq!(refusal("").await, validation(detail, json!([fault])));
}
