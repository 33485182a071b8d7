//! Scans of files that do not number them.

use super::{of_kind, read_with, recording};
use trackloom_domain::model::dataset::DatasetKind;

/// How many detections each scan of a CSV file has.
fn scans(columns: &str, rows: impl Iterator<Item = String>) -> Vec<usize> {
    let rows: Vec<String> = rows.collect();
    let text = format!("time_s,{columns}\n{}\n", rows.join("\n"));
    let options = of_kind(DatasetKind::Detections);
    let outcome = read_with("csv", text, &options).expect("the file is sound");
    let recording = recording(outcome);
    let counts = recording.scans.iter().map(|scan| scan.detections.len());
    counts.collect()
}

#[test]
fn positions_of_one_time_are_a_scan() {
    for columns in ["x_m,y_m", "lat_deg,lon_deg"] {
        let rows = (0..12).map(|at| format!("{},{},{}", at / 3, 40 + at, 7 - at));
        assert_eq!(scans(columns, rows), [3; 4], "{columns}");
        let single = (0..12).map(|at| format!("{at},{},{}", 40 + at, 7 - at));
        assert_eq!(scans(columns, single), [1; 12], "{columns}");
    }
}

#[test]
fn one_target_that_goes_round_is_seen_once_a_scan() {
    let clockwise = |at: u32| (300 + 3 * at) % 360;
    let polar = (0..90).map(|at| format!("{},5000,{}", 4 * at, clockwise(at)));
    assert_eq!(scans("range_m,bearing_deg", polar), [1; 90]);
    let bare = (0..90).map(|at| format!("{},{}", 4 * at, clockwise(90 - at)));
    assert_eq!(scans("bearing_deg", bare), [1; 90]);
}

#[test]
fn plots_of_a_turn_are_a_scan_also_of_a_sector() {
    for bearings_deg in [[10.0, 95.0, 200.0, 300.0], [10.0, 30.0, 50.0, 80.0]] {
        let turns = (0..20).flat_map(|turn| bearings_deg.map(|bearing_deg| (turn, bearing_deg)));
        let rows = turns.map(|(turn, bearing_deg)| {
            let time_s = 4.0 * (f64::from(turn) + bearing_deg / 360.0);
            format!("{time_s},5000,{bearing_deg}")
        });
        let found = scans("range_m,bearing_deg", rows);
        assert_eq!(found, [4; 20], "{bearings_deg:?}");
    }
}
