//! The files that a job leaves behind.

use super::tables::{number, quoted};
use crate::association::Trace;
use crate::experiment::job::Artifact;
use crate::formats;
use crate::model::dataset::Dataset;
use crate::model::scan::Recording;
use crate::model::sensor::SensorSettings;
use crate::tracking::ScanOutcome;
use std::io::{Error, Write};

/// A dataset as canonical CSV: `detections.csv`, `truth.csv`, `tracks.csv` or `bearing_time.csv`.
pub fn dataset(dataset: &Dataset, sensors: &[SensorSettings]) -> Result<Artifact, Error> {
    let mut bytes = Vec::new();
    formats::write_csv(dataset, &mut bytes)?;
    let name = match dataset {
        Dataset::Detections(_) => "detections.csv",
        Dataset::Truth(_) | Dataset::TruthBoxes(_) => "truth.csv",
        Dataset::Tracks(_) | Dataset::TrackBoxes(_) => "tracks.csv",
        Dataset::BearingTime(_) => "bearing_time.csv",
    };
    Ok(Artifact {
        name,
        media_type: "text/csv",
        bytes,
        dataset: Some(dataset.summary()),
        sensors: sensors.to_vec(),
    })
}

/// What the associator wrote down, as `association_trace.csv`.
pub fn trace(trace: &Trace) -> Artifact {
    let bytes = trace.text().as_bytes().to_vec();
    Artifact::file("association_trace.csv", "text/csv", bytes)
}

/// What happened scan by scan, as `scans.csv`.
pub fn scans(recording: &Recording, outcomes: &[ScanOutcome]) -> Result<Artifact, Error> {
    let mut bytes =
        b"time_s,scan,sensor_id,detections,tracks,confirmed,unused_detections\n".to_vec();
    for (scan, outcome) in recording.scans.iter().zip(outcomes) {
        let sensor_id = &recording.sensors[scan.sensor].sensor_id;
        let ScanOutcome {
            tracks,
            confirmed,
            unused,
            ..
        } = outcome;
        writeln!(
            bytes,
            "{},{},{},{},{tracks},{confirmed},{unused}",
            number(scan.time_s),
            scan.number,
            quoted(sensor_id),
            scan.detections.len()
        )?;
    }
    Ok(Artifact::file("scans.csv", "text/csv", bytes))
}
