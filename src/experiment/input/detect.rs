//! From a bearing-time record to detections: the detector of the request, origins where truth is known, and the noise of the
//! bearings where nobody told it.

use crate::detection::{Detector, Found, Quality, Tuning, assign_origins, estimated_sigma_rad};
use crate::experiment::job::RunError;
use crate::experiment::observer::{Observer, Step};
use crate::model::bearing_time::BearingTimeRecord;
use crate::model::fault::Fault;
use crate::model::scan::Recording;
use crate::model::sensor::SensorSettings;
use crate::model::truth::TruthSet;
use serde::Serialize;

/// The sensor of a record that nobody named.
const UNNAMED: &str = "sonar";

/// The part `detection` of a report.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DetectionReport {
    /// Where truth is known.
    #[serde(flatten)]
    quality: Option<Quality>,
    scans: usize,
    detections: usize,
    rows: usize,
    cells: usize,
    #[serde(flatten)]
    tuning: Tuning,
}

/// What the detector finds.
pub fn detect(
    detector: &Detector,
    record: &BearingTimeRecord,
    sensor: &SensorSettings,
    truth: Option<&TruthSet>,
    observer: &mut dyn Observer,
) -> Result<(Recording, DetectionReport), RunError> {
    let mut progress = |done, total| observer.progress(Step::Detect, done, total);
    let Found {
        mut recording,
        tuning,
    } = detector
        .detect(record, sensor, &mut progress)?
        .ok_or(RunError::Stopped)?;
    let mut quality = None;
    if let Some(truth) = truth.filter(|truth| !truth.space().has_places()) {
        let (with_origins, found) = assign_origins(recording, truth, detector.gate_deg)?;
        (recording, quality) = (with_origins, Some(found));
    }
    let (scans, detections) = (recording.scans.len(), recording.detection_count());
    let report = DetectionReport {
        quality,
        scans,
        detections,
        rows: record.times_s.len(),
        cells: record.levels_db.len(),
        tuning,
    };
    Ok((recording, report))
}

/// The sensor of a record that was loaded: the one that the upload or the request tells of, if it is one alone.
pub fn sensor_of(uploaded: &[SensorSettings], requested: &[SensorSettings]) -> SensorSettings {
    let named = [uploaded, requested]
        .into_iter()
        .find(|list| list.len() == 1)
        .map(|list| list[0].sensor_id.clone());
    SensorSettings::named(named.unwrap_or_else(|| UNNAMED.to_owned()))
}

/// Estimates the noise of bearings where nobody told it; what is known of the sensors then stands in the recording too.
pub fn complete(
    sensors: &mut [SensorSettings],
    recording: Recording,
    record: &BearingTimeRecord,
    warnings: &mut Vec<String>,
) -> Result<Recording, Vec<Fault>> {
    for sensor in sensors
        .iter_mut()
        .filter(|sensor| sensor.sigma_bearing_deg.is_none())
    {
        let Some(sigma_rad) = estimated_sigma_rad(&recording, record.cell_rad()) else {
            continue;
        };
        let sigma_deg = sigma_rad.to_degrees();
        warnings.push(format!(
            "sensor '{}': the noise of its bearings is not known; {sigma_deg:.3} degrees is estimated from how they follow each other",
            sensor.sensor_id
        ));
        sensor.sigma_bearing_deg = Some(sigma_deg);
    }
    let mut parts = recording.into_parts();
    parts.sensors = sensors.to_vec();
    Recording::new(parts)
}
