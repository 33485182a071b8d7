//! The velocities that are reported with places (AIS, ADS-B), and how well they are known.

use crate::experiment::input::extent::{length, scans_of};
use crate::model::scan::Recording;
use crate::model::sensing::{MeasurementModel, Moving, VelocityNoise};
use crate::model::sensor::SensorSettings;

/// Assumed when nobody says how well velocities are measured.
const ASSUMED_SIGMA_MPS: f64 = 1.0;

/// What a sensor of positions reports, with velocities where its detections have any.
pub fn with_velocities(
    report: MeasurementModel,
    (recording, sensor): (&Recording, usize),
    settings: &SensorSettings,
    warnings: &mut Vec<String>,
) -> MeasurementModel {
    let (sigmas_m, is_in_volume, clutter_span) = match report {
        MeasurementModel::Position {
            sigma_x_m,
            sigma_y_m,
        } => ([sigma_x_m, sigma_y_m, 1.0], false, None),
        MeasurementModel::Position3 {
            sigmas_m,
            clutter_span,
        } => (sigmas_m, true, clutter_span),
        other => return other,
    };
    let velocities: Vec<[f64; 2]> = reported(recording, sensor).collect();
    let stated_mps = settings.velocity_span_mps;
    if velocities.is_empty() && stated_mps.is_none() {
        return report;
    }
    let span_mps = |axis| stated_mps.unwrap_or_else(|| span(&velocities, axis));
    let sigma_speed_mps = settings.sigma_speed_mps.unwrap_or_else(|| {
        warnings.push(format!(
            "sensor '{}': the noise of its velocities is not known; {ASSUMED_SIGMA_MPS} m/s is assumed: 'sigma_speed_mps' says it",
            settings.sensor_id
        ));
        ASSUMED_SIGMA_MPS
    });
    MeasurementModel::Moving(Moving {
        sigmas_m,
        correlation_xy: 0.0,
        is_in_volume,
        clutter_span,
        velocity: VelocityNoise {
            sigma_speed_mps,
            sigma_course_rad: settings.sigma_course_deg.map(f64::to_radians),
            area_m2ps2: span_mps(0) * span_mps(1),
        },
        tells_velocity: true,
    })
}

fn reported(recording: &Recording, sensor: usize) -> impl Iterator<Item = [f64; 2]> {
    scans_of(recording, sensor).flat_map(|scan| scan.own.iter().filter_map(|own| own.velocity_mps))
}

/// The interval over which velocities reach on one axis; at least 1 m/s, so that a density over it exists.
fn span(velocities: &[[f64; 2]], axis: usize) -> f64 {
    length(velocities.iter().map(|velocity_mps| velocity_mps[axis])).max(1.0)
}
