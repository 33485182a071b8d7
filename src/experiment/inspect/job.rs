//! A job to start from.

use crate::model::dataset::Dataset;
use crate::model::truth::TruthSet;
use serde_json::{Value, json};

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
    let sensor = match &truth.frame {
        Some(frame) => json!({
            "sensor_id": "radar", "lat_deg": frame.latitude_deg(), "lon_deg": frame.longitude_deg(),
            "max_range_m": 100_000.0, "p_d": 0.9, "sigma_range_m": 50.0, "sigma_bearing_deg": 0.1,
            "clutter_per_scan": 5.0,
        }),
        None => json!({
            "sensor_id": "radar", "max_range_m": 100_000.0, "p_d": 0.9, "sigma_range_m": 50.0,
            "sigma_bearing_deg": 0.1, "clutter_per_scan": 5.0,
        }),
    };
    json!({
        "kind": "evaluate", "truth": file,
        "input": {"source": "scenario", "scenario": {
            "scans": 100, "scan_period_s": 4.0, "sensors": [sensor],
            "targets": {"kind": "recorded", "max_gap_s": 60.0},
        }},
        "associator": {"method": "global_nearest_neighbour"},
    })
}
