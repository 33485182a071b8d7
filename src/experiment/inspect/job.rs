//! A job to start from.

use crate::model::dataset::Dataset;
use crate::model::truth::TruthSet;
use serde_json::{Map, Value, json};

/// A job file for this dataset: detections are tracked, truth is seen by a simulated radar, tracks are judged.
pub fn start_from(dataset: &Dataset, format: &str, path: &str) -> Value {
    let file = json!({"source": "file", "path": path, "format": format});
    match dataset {
        Dataset::Detections(_) => json!({
            "kind": "associate", "input": file, "associator": {"method": "jpda"},
        }),
        Dataset::Truth(truth) => seen_by_radar(truth, &file),
        Dataset::Tracks(_) => json!({
            "kind": "evaluate", "tracks": file,
            "truth": {"source": "file", "path": "the truth to judge by"},
        }),
        Dataset::TruthBoxes(_) => json!({
            "kind": "evaluate", "truth": file,
            "tracks": {"source": "file", "path": "the tracks to judge"},
        }),
        Dataset::TrackBoxes(_) => json!({
            "kind": "evaluate", "tracks": file,
            "truth": {"source": "file", "path": "the truth to judge by"},
        }),
        Dataset::BearingTime(_) => json!({
            "kind": "associate", "input": file, "detector": {},
            "associator": {"method": "fuzzy_c_means"},
        }),
    }
}

/// Truth as a radar in its middle sees it.
fn seen_by_radar(truth: &TruthSet, file: &Value) -> Value {
    let mut sensor = Map::from_iter([
        ("sensor_id".to_owned(), json!("radar")),
        ("max_range_m".to_owned(), json!(100_000.0)),
        ("p_d".to_owned(), json!(0.9)),
        ("sigma_range_m".to_owned(), json!(50.0)),
        ("sigma_bearing_deg".to_owned(), json!(0.1)),
        ("clutter_per_scan".to_owned(), json!(5.0)),
    ]);
    if let Some(frame) = &truth.frame {
        sensor.insert("lat_deg".to_owned(), json!(frame.latitude_deg()));
        sensor.insert("lon_deg".to_owned(), json!(frame.longitude_deg()));
    }
    json!({
        "kind": "evaluate", "truth": file,
        "input": {"source": "scenario", "scenario": {
            "scans": 100, "scan_period_s": 4.0, "sensors": [sensor],
            "targets": {"kind": "recorded", "max_gap_s": 60.0},
        }},
        "associator": {"method": "global_nearest_neighbour"},
    })
}
