//! A job to start from.

use crate::model::dataset::Dataset;
use serde_json::{Value, json};

/// A job file for this dataset: detections are tracked, truth is seen by a simulated radar, tracks are judged.
pub fn start_from(dataset: &Dataset, format: &str, path: &str) -> Value {
    let file = json!({"source": "file", "path": path, "format": format});
    match dataset {
        Dataset::Detections(_) => json!({
            "kind": "associate", "input": file, "associator": {"method": "jpda"},
        }),
        Dataset::Truth(_) => json!({
            "kind": "evaluate", "truth": file,
            "tracks": {"source": "file", "path": "the tracks to judge"},
        }),
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
