//! Unbiased converted measurements: ranges and bearings become positions before the linear filter sees them. The
//! conversion is the multiplicative one, and its covariance is taken at the prediction, so that it does not depend on the
//! error of the very report (decorrelated).
//!
//! # Reference
//! Mo Longbin, Song Xiaoquan, Zhou Yiyu, Sun Zhong Kang, Y. Bar-Shalom, Unbiased converted measurements for tracking,
//! IEEE Transactions on Aerospace and Electronic Systems 34(3), 1998 (the conversion); S. V. Bordonaro, P. Willett,
//! Y. Bar-Shalom, Decorrelated unbiased converted measurement Kalman filter, the same Transactions 50(2), 2014 (R).
//!
//! # Symbols
//! z converted position; R its covariance; σβ standard deviation of the bearing.
//!
//! # Method
//! z = e^(σβ²/2) r (sin β, cos β); R from the predicted place and its covariance; then the filter of positions.

use super::mixture::Expected;
use super::{AnyFilter, Filter, FilterMethod, PROCESS_NOISE, kalman, polar};
use crate::model::motion::ConstantVelocity;
use crate::model::scan::Measurement;
use crate::model::sensor::{MeasurementModel, Sensor};
use crate::model::state::{GaussianState, Position, PositionCovariance};
use crate::registry::Object;
use serde::Deserialize;

pub const METHOD: FilterMethod = FilterMethod {
    name: "converted",
    parameters: &PARAMETERS,
    build: |spec| Converted::deserialize(spec).map(AnyFilter::Converted),
};

static PARAMETERS: Object = Object {
    name: "ConvertedMeasurementFilter",
    summary: "Kalman filter on unbiased converted measurements: ranges and bearings turned into positions; nearly constant velocity.",
    fields: &[PROCESS_NOISE],
};

/// The filter of one tracker.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct Converted {
    pub process_noise_m2ps3: f64,
}

impl Filter<4, 2> for Converted {
    fn motion(&self) -> ConstantVelocity {
        ConstantVelocity {
            spectral_density: self.process_noise_m2ps3,
        }
    }

    fn to_measurement_space(&self, sensor: &Sensor, measurement: &Measurement) -> Option<Position> {
        match (&sensor.report, measurement) {
            (
                MeasurementModel::Polar(polar),
                Measurement::RangeBearing {
                    range_m,
                    bearing_rad,
                    ..
                },
            ) => Some(polar::unbiased_position(polar, *range_m, *bearing_rad)),
            _ => measurement.position(),
        }
    }

    fn expect(&self, state: &GaussianState, sensor: &Sensor) -> Option<Expected<4, 2>> {
        let spread = state.covariance.fixed_view::<2, 2>(0, 0).into_owned();
        kalman::expect_position(
            state,
            &noise(sensor, state.mean.fixed_rows::<2>(0).into_owned(), &spread)?,
        )
    }

    fn initiate(
        &self,
        measurement: &Position,
        sensor: &Sensor,
        speed_sigma_mps: f64,
    ) -> Option<GaussianState> {
        Some(kalman::at_rest(
            measurement,
            &noise(sensor, *measurement, &PositionCovariance::zeros())?,
            speed_sigma_mps,
        ))
    }
}

/// R of a report of a target around a place with a covariance.
fn noise(
    sensor: &Sensor,
    position_m: Position,
    spread: &PositionCovariance,
) -> Option<PositionCovariance> {
    match &sensor.report {
        MeasurementModel::Polar(polar) => {
            Some(polar::unbiased_covariance(polar, position_m, spread))
        }
        report => kalman::noise_of(report),
    }
}
