//! What the extended and the unscented filter have in common: sensors that report places in the plane, either as positions
//! (`D` = 2) or as polar values (`D` = 2, or 3 with range rates).

use super::mixture::Expected;
use super::{kalman, polar};
use crate::model::scan::Measurement;
use crate::model::sensor::{MeasurementModel, Sensor};
use crate::model::state::{GaussianState, Position};
use nalgebra::{SMatrix, SVector};

pub fn to_measurement_space<const D: usize>(
    sensor: &Sensor,
    measurement: &Measurement,
) -> Option<SVector<f64, D>> {
    match sensor.report {
        MeasurementModel::Polar(_) => polar::to_measurement_space(measurement),
        MeasurementModel::Position { .. } if D == 2 => measurement
            .position()
            .map(|at| SVector::from_column_slice(at.as_slice())),
        _ => None,
    }
}

pub fn angle(sensor: &Sensor) -> Option<usize> {
    matches!(sensor.report, MeasurementModel::Polar(_)).then_some(1)
}

/// Of a position report, which is linear.
pub fn expect_position<const D: usize>(
    state: &GaussianState,
    sensor: &Sensor,
) -> Option<Expected<4, D>> {
    let noise = kalman::noise_of(&sensor.report).filter(|_| D == 2)?;
    let noise = SMatrix::<f64, D, D>::from_column_slice(noise.as_slice());
    let position = SVector::from_column_slice(&state.mean.as_slice()[..2]);
    Expected::linear(position, &SMatrix::identity(), &noise, state)
}

pub fn log_clutter_scale<const D: usize>(sensor: &Sensor, expected: &Expected<4, D>) -> f64 {
    match &sensor.report {
        MeasurementModel::Polar(polar) => polar::log_clutter_scale(polar, &expected.measurement),
        _ => 0.0,
    }
}

pub fn initiate<const D: usize>(
    measurement: &SVector<f64, D>,
    sensor: &Sensor,
    speed_sigma_mps: f64,
) -> Option<GaussianState> {
    if let MeasurementModel::Polar(polar) = &sensor.report {
        return Some(polar::initiate(polar, measurement, speed_sigma_mps));
    }
    let noise = kalman::noise_of(&sensor.report)?;
    Some(kalman::at_rest(
        &Position::new(measurement[0], measurement[1]),
        &noise,
        speed_sigma_mps,
    ))
}
