//! What the extended and the unscented filter have in common: sensors that report places in the plane, either as positions
//! (`D` = 2) or as polar values (`D` = 2, or 3 with range rates). They differ in what they expect of polar values alone.

use super::mixture::Expected;
use super::{Filter, kalman, polar};
use crate::model::motion::ConstantVelocity;
use crate::model::scan::Measurement;
use crate::model::sensor::{MeasurementModel, Polar, Sensor};
use crate::model::state::{GaussianState, Position};
use nalgebra::{SMatrix, SVector};

/// A filter of places by polar values, with a way of its own through the bend of polar coordinates.
pub trait PolarFilter {
    /// q of the motion's noise.
    fn spectral_density(&self) -> f64;

    /// The polar values expected of a target in this state. `None` when S is not positive definite.
    fn expect_polar<const D: usize>(
        &self,
        state: &GaussianState,
        polar: &Polar,
    ) -> Option<Expected<4, D>>;
}

impl<F: PolarFilter, const D: usize> Filter<4, D> for F {
    fn motion(&self) -> ConstantVelocity {
        ConstantVelocity {
            spectral_density: self.spectral_density(),
        }
    }

    fn to_measurement_space(
        &self,
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

    fn angle(&self, sensor: &Sensor) -> Option<usize> {
        matches!(sensor.report, MeasurementModel::Polar(_)).then_some(1)
    }

    fn expect(&self, state: &GaussianState, sensor: &Sensor) -> Option<Expected<4, D>> {
        match &sensor.report {
            MeasurementModel::Polar(polar) => self.expect_polar(state, polar),
            _ => expect_position(state, sensor),
        }
    }

    fn log_clutter_scale(&self, sensor: &Sensor, expected: &Expected<4, D>) -> f64 {
        match &sensor.report {
            MeasurementModel::Polar(polar) => {
                polar::log_clutter_scale(polar, &expected.measurement)
            }
            _ => 0.0,
        }
    }

    fn initiate(
        &self,
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
}

/// Of a position report, which is linear.
fn expect_position<const D: usize>(
    state: &GaussianState,
    sensor: &Sensor,
) -> Option<Expected<4, D>> {
    let noise = kalman::noise_of(&sensor.report).filter(|_| D == 2)?;
    let noise = SMatrix::<f64, D, D>::from_column_slice(noise.as_slice());
    let position = SVector::from_column_slice(&state.mean.as_slice()[..2]);
    Expected::linear(position, &SMatrix::identity(), &noise, state)
}
