//! Bearings from the bow, turned into bearings from north by what carries their sensor.

use super::fault::Fault;
use super::pose::Attitude;
use super::scan::{Measurement, Recording, RecordingParts};
use super::sensor::{BearingReference, SensorSettings};

/// Whether a sensor's bearings are counted from the bow.
pub fn are_relative(settings: &SensorSettings) -> bool {
    settings.bearings == Some(BearingReference::Relative)
}

/// A fault where relative bearings of a sensor have scans without a heading.
pub fn unknown_heading(recording: &RecordingParts, settings: &SensorSettings) -> Option<Fault> {
    let id = &settings.sensor_id;
    let sensor = recording
        .sensors
        .iter()
        .position(|sensor| sensor.sensor_id == *id)?;
    if !are_relative(settings) {
        return None;
    }
    let (mut all, mut lacking) = (0, 0);
    for scan in recording.scans.iter().filter(|scan| scan.sensor == sensor) {
        all += 1;
        let attitude = scan.pose.and_then(|pose| pose.attitude);
        lacking += u32::from(attitude.is_none());
    }
    let detail = format!(
        "sensor '{id}' reports relative bearings, and {lacking} of its {all} scans have no heading"
    );
    (lacking > 0).then(|| {
        Fault::new("/sensors", "missing", detail)
            .allowing("columns sensor_x_m, sensor_y_m, sensor_heading_deg")
    })
}

/// The recording with the relative bearings of these sensors turned. Their settings say so no more, and scans without a heading
/// stay as they are.
#[must_use]
pub fn turned(recording: Recording, sensors: &mut [SensorSettings]) -> Recording {
    if !sensors.iter().any(are_relative) {
        return recording;
    }
    let mut parts = recording.into_parts();
    let mut is_relative = vec![false; parts.sensors.len()];
    for settings in sensors.iter_mut().filter(|settings| are_relative(settings)) {
        settings.bearings = None;
        let named = |sensor: &SensorSettings| sensor.sensor_id == settings.sensor_id;
        if let Some(sensor) = parts.sensors.iter().position(named) {
            is_relative[sensor] = true;
            parts.sensors[sensor].bearings = None;
        }
    }
    for scan in &mut parts.scans {
        let attitude = scan.pose.and_then(|pose| pose.attitude);
        let Some(attitude) = attitude.filter(|_| is_relative[scan.sensor]) else {
            continue;
        };
        for detection in &mut scan.detections {
            turn(&mut detection.measurement, &attitude);
        }
    }
    // Turned bearings are finite, and nothing else has changed.
    Recording::new(parts).unwrap_or_default()
}

/// With an elevation above the deck both are turned.
fn turn(measurement: &mut Measurement, attitude: &Attitude) {
    match measurement {
        Measurement::RangeBearing { bearing_rad, .. } | Measurement::Bearing { bearing_rad } => {
            *bearing_rad = attitude.bearing_of(*bearing_rad);
        }
        Measurement::RangeBearingElevation {
            bearing_rad,
            elevation_rad,
            ..
        }
        | Measurement::BearingElevation {
            bearing_rad,
            elevation_rad,
        } => {
            (*bearing_rad, *elevation_rad) = attitude.direction(*bearing_rad, *elevation_rad);
        }
        Measurement::Position { .. } | Measurement::Position3 { .. } => {}
    }
}
