//! What cures a file: a mapping that its faults propose, and a share of rows that may be wrong.

use super::*;
use serde_json::json;
use std::collections::BTreeMap;
use trackloom_domain::formats::FormatOptions;

fn tolerant(share: f64) -> ReadOptions {
    ReadOptions {
        options: FormatOptions::from_iter([("max_rejected".to_owned(), json!(share))]),
        ..ReadOptions::default()
    }
}

#[test]
fn the_mapping_that_a_fault_proposes_cures_it() {
    let text = "Timestamp (ms);ID;Latitude;Longitude;Alt (ft);colour\n1000;a;50;-1;100;red\n2000;a;50.001;-1;110;red\n";
    let faults = read("csv", text).expect_err("no canonical columns");
    let detail = &faults[0].detail;
    let (_, proposed) = detail
        .split_once("columns may be mapped: ")
        .expect("a mapping");
    let columns: BTreeMap<String, String> = serde_json::from_str(proposed).expect("JSON");
    let expected = [
        ("Alt (ft)", "height_m [ft]"),
        ("ID", "truth_id"),
        ("Latitude", "lat_deg"),
        ("Longitude", "lon_deg"),
        ("Timestamp (ms)", "time_s [ms]"),
    ];
    let found: Vec<(&str, &str)> = columns
        .iter()
        .map(|(a, b)| (a.as_str(), b.as_str()))
        .collect();
    assert_eq!(found, expected);
    let options = ReadOptions {
        columns,
        ..ReadOptions::default()
    };
    let truth = truth(read_with("csv", text, &options).expect("the mapping cures it"));
    let points = &truth.targets()[0].points;
    assert_eq!((points[0].time_s, points[1].time_s), (1.0, 2.0));
    // 100 ft.
    assert_eq!(points[0].height_m, Some(30.48));
    // A minute of arc is 1853.2 m there: a thousandth of a degree is 111.2 m.
    let way_m = (points[1].position - points[0].position).norm();
    assert!((way_m - 111.23).abs() < 0.05, "{way_m}");
}

#[test]
fn a_missing_column_proposes_the_one_that_may_be_meant() {
    let faults = read("csv", "time_s,truth_id,Easting,y_m\n0,a,1,2\n").expect_err("no x_m");
    let expected =
        "a file of truth needs a column 'x_m'; columns may be mapped: {\"Easting\":\"x_m\"}";
    assert_eq!((faults.len(), faults[0].detail.as_str()), (1, expected));
}

/// Found by changing files at random.
#[test]
fn one_coordinate_beside_latitudes_is_half_a_place() {
    for kind in [("track_id", "tracks"), ("truth_id", "truth")] {
        let text = format!("time_s,{},x_m,lat_deg,lon_deg\n0,a,1,50,4\n", kind.0);
        let faults = read("csv", text).expect_err("no y_m");
        let expected = format!("a file of {} needs a column 'y_m'", kind.1);
        assert_eq!((faults.len(), &faults[0].detail), (1, &expected));
    }
}

#[test]
fn a_latitude_without_longitude_is_no_place_of_a_direction() {
    let text = "time_s,truth_id,lat_deg,bearing_deg\n0,a,50,90\n";
    let truth = truth(read("csv", text).expect("a direction is enough"));
    assert_eq!(truth.targets()[0].points.len(), 1);
    let text = "time_s,scan,detection_id,lat_deg,bearing_deg\n0,1,a,50,90\n";
    assert_eq!(
        recording(read("csv", text).expect("so is its report"))
            .scans
            .len(),
        1
    );
}

const ROWS: &str =
    "time_s,truth_id,x_m,y_m\n0,a,1,2\n1,a,nan,2\n2,a,2\n3,a,3,2\n4,,4,2\n5,a,x,y\n6,a,5,2\n";

#[test]
fn wrong_rows_are_left_out_up_to_the_share_that_may_be() {
    let outcome = read_with("csv", ROWS, &tolerant(0.6)).expect("4 of 7 may be wrong");
    let units = outcome.units.clone();
    assert_eq!((units.total, units.used, units.rejected_count()), (7, 3, 4));
    let rejected: Vec<(&str, u64, &[u64])> = units
        .rejected
        .iter()
        .map(|(reason, of_it)| (reason.as_str(), of_it.count, of_it.first.as_slice()))
        .collect();
    let expected: [(&str, u64, &[u64]); 3] = [
        ("malformed", 2, &[4, 7]),
        ("missing", 1, &[6]),
        ("not_finite", 1, &[3]),
    ];
    assert_eq!(rejected, expected);
    assert!(
        outcome
            .warnings
            .contains(&"malformed: line 4, 7".to_owned()),
        "{:?}",
        outcome.warnings
    );
    let times_s: Vec<f64> = truth(outcome).targets()[0]
        .points
        .iter()
        .map(|point| point.time_s)
        .collect();
    assert_eq!(times_s, [0.0, 3.0, 6.0]);
}

#[test]
fn too_many_wrong_rows_are_all_told() {
    let faults = read_with("csv", ROWS, &tolerant(0.5)).expect_err("4 of 7 are wrong");
    assert_eq!(faults[0].detail, "4 of 7 lines are wrong");
    let lines: Vec<Option<u64>> = faults.iter().map(|fault| fault.line).collect();
    assert_eq!(lines, [None, Some(3), Some(4), Some(6), Some(7), Some(7)]);
    // Without a word none may be.
    let faults = read("csv", ROWS).expect_err("no row may be wrong");
    assert_eq!(faults.len(), 5);
}

#[test]
fn detections_and_tracks_leave_wrong_rows_out_as_truth_does() {
    let detections = "time_s,scan,detection_id,x_m,y_m\n0,1,a,1,2\n0,1,b,nan,2\n1,2,c,2,2\n";
    let read_detections = read_with("csv", detections, &tolerant(0.4)).expect("1 of 3");
    assert_eq!(
        (
            read_detections.units.used,
            read_detections.units.rejected_count()
        ),
        (2, 1)
    );
    assert_eq!(recording(read_detections).detection_ids, ["a", "c"]);
    let tracks = "time_s,track_id,x_m,y_m,probability,detection_id\n0,a,1,2,0.5,d\n1,a,2,2,7,e\n2,a,3,2,0.5,f\n";
    let read_tracks = read_with("csv", tracks, &tolerant(0.4)).expect("1 of 3");
    assert_eq!(
        (read_tracks.units.used, read_tracks.units.rejected_count()),
        (2, 1)
    );
    assert_eq!(read_tracks.dataset.summary().rows, 2);
}
