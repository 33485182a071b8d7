//! A small recording for tests.

use crate::model::scan::{Detection, Measurement, Recording, RecordingParts, Scan};
use crate::model::sensor::SensorSettings;

/// One scan of a sensor.
pub fn one_scan(sensor: SensorSettings, measurements: &[Measurement]) -> Recording {
    let detection = |&measurement| Detection {
        measurement,
        origin: None,
        amplitude: None,
    };
    let count = measurements.len();
    let parts = RecordingParts {
        sensors: vec![sensor],
        scans: vec![Scan {
            number: 1,
            time_s: 0.0,
            sensor: 0,
            pose: None,
            own: Vec::new(),
            detections: measurements.iter().map(detection).collect(),
        }],
        detection_ids: (0..count).map(|index| index.to_string()).collect(),
        ..Default::default()
    };
    Recording::new(parts).unwrap()
}
