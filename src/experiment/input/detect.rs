//! From a bearing-time record to detections: the detector of the request, origins where truth is known, and the noise of the
//! bearings where nobody told it.

use crate::detection::{Detector, Found, Quality, assign_origins, estimated_sigma_rad};
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

/// What a detector found in a bearing-time record.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema))]
pub struct DetectionResult {
    /// Share of the true bearings at the scans that have a detection; `null` where there are none, absent without truth.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(value_type = Option<f64>))]
    p_d: Option<Option<f64>>,
    /// Detections without a target, on average; absent without truth.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(value_type = Option<f64>))]
    false_alarms_per_scan: Option<Option<f64>>,
    /// Of detections with a target; absent without truth.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(value_type = Option<f64>))]
    bearing_rmse_deg: Option<Option<f64>>,
    /// Largest distance of a detection from the true bearing of its target; absent without truth.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    gate_deg: Option<f64>,
    scans: u64,
    detections: u64,
    /// Times of the record.
    rows: u64,
    cells: u64,
    /// Independent values in the power of a cell, given or estimated; `null` of a constant threshold.
    noise_averages: Option<f64>,
    /// Threshold over the mean of the training cells, of an interval of full length; `null` of a constant threshold.
    threshold_over_mean_db: Option<f64>,
}

/// What the detector finds.
pub fn detect(
    detector: &Detector,
    record: &BearingTimeRecord,
    sensor: &SensorSettings,
    truth: Option<&TruthSet>,
    observer: &mut dyn Observer,
) -> Result<(Recording, DetectionResult), RunError> {
    let mut progress = |done, total| observer.progress(Step::Detect, done, total);
    let Found {
        mut recording,
        tuning,
    } = detector
        .detect(record, sensor, &mut progress)?
        .ok_or(RunError::Stopped)?;
    let mut quality: Option<Quality> = None;
    if let Some(truth) = truth.filter(|truth| !truth.space().has_places()) {
        let (with_origins, found) = assign_origins(recording, truth, detector.gate_deg)?;
        (recording, quality) = (with_origins, Some(found));
    }
    let report = DetectionResult {
        p_d: quality.map(|quality| quality.p_d),
        false_alarms_per_scan: quality.map(|quality| quality.false_alarms_per_scan),
        bearing_rmse_deg: quality.map(|quality| quality.bearing_rmse_deg),
        gate_deg: quality.map(|quality| quality.gate_deg),
        scans: recording.scans.len() as u64,
        detections: recording.detection_count() as u64,
        rows: record.times_s.len() as u64,
        cells: record.levels_db.len() as u64,
        noise_averages: tuning.noise_averages,
        threshold_over_mean_db: tuning.threshold_over_mean_db,
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
