//! The filter of bearings alone: its state is a bearing and its rate, which is nearly constant. It knows nothing of
//! ranges, so it cannot say where a target is, only in which direction.
//!
//! # Reference
//! Y. Bar-Shalom, X.-R. Li, T. Kirubarajan, Estimation with Applications to Tracking and Navigation, 2001, section 5.2 (the
//! linear filter of one coordinate and its rate).
//!
//! # Symbols
//! x̂ = (β, β̇), P state and covariance; σ, S noise and innovation variance; C = cov(x, z).
//!
//! # Method
//! ẑ = β, S = P₁₁ + σ², C = the first column of P. Differences of bearings take the shorter way round, so a track goes on
//! through south, where π is followed by −π.

use super::mixture::Expected;
use super::{AnyFilter, Filter, FilterMethod};
use crate::math::angle::wrap;
use crate::model::motion::ConstantVelocity;
use crate::model::scan::Measurement;
use crate::model::sensor::{MeasurementModel, Sensor};
use crate::model::state::GaussianState;
use crate::registry::{Object, above, default, number};
use nalgebra::{Matrix1, Matrix2, Vector1, Vector2};
use serde::Deserialize;

pub const METHOD: FilterMethod = FilterMethod {
    name: "bearing_only",
    parameters: &PARAMETERS,
    build: |spec| Wire::deserialize(spec).map(|wire| AnyFilter::BearingOnly(wire.in_radians())),
};

static PARAMETERS: Object = Object {
    name: "BearingOnlyFilter",
    summary: "Kalman filter on a bearing and its nearly constant rate, for sensors that report bearings; ranges are not used.",
    fields: &[
        default(
            "process_noise_deg2ps3",
            "Spectral density q of the white noise that changes the rate, which wanders by about sqrt(q·T) in T seconds.",
            number(0.0, 1e6, "deg²/s³"),
            "0.0001",
        ),
        default(
            "initial_rate_sigma_degps",
            "Standard deviation of the bearing rate of a new track, which starts at rest.",
            above(0.0, 360.0, "deg/s"),
            "0.5",
        ),
    ],
};

/// The parameters, in degrees.
#[derive(Deserialize)]
struct Wire {
    process_noise_deg2ps3: f64,
    initial_rate_sigma_degps: f64,
}

impl Wire {
    fn in_radians(&self) -> BearingOnly {
        BearingOnly {
            process_noise_rad2ps3: self.process_noise_deg2ps3 * 1f64.to_radians().powi(2),
            initial_rate_sigma_radps: self.initial_rate_sigma_degps.to_radians(),
        }
    }
}

/// The filter of one tracker.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BearingOnly {
    /// Spectral density q of the white noise that changes the rate.
    pub process_noise_rad2ps3: f64,
    /// Standard deviation of the rate of a new track.
    pub initial_rate_sigma_radps: f64,
}

impl Filter<2, 1> for BearingOnly {
    fn motion(&self) -> ConstantVelocity {
        ConstantVelocity {
            spectral_density: self.process_noise_rad2ps3,
        }
    }

    fn to_measurement_space(
        &self,
        _sensor: &Sensor,
        measurement: &Measurement,
    ) -> Option<Vector1<f64>> {
        match *measurement {
            Measurement::Bearing { bearing_rad }
            | Measurement::RangeBearing { bearing_rad, .. } => {
                Some(Vector1::new(wrap(bearing_rad)))
            }
            Measurement::Position { .. } => None,
        }
    }

    fn angle(&self, _sensor: &Sensor) -> Option<usize> {
        Some(0)
    }

    fn expect(&self, state: &GaussianState<2>, sensor: &Sensor) -> Option<Expected<2, 1>> {
        let variance = Matrix1::new(state.covariance[(0, 0)] + variance_of(&sensor.report)?);
        Expected::new(
            Vector1::new(wrap(state.mean[0])),
            variance,
            state.covariance.column(0).into_owned(),
        )
    }

    fn initiate(
        &self,
        measurement: &Vector1<f64>,
        sensor: &Sensor,
        _speed_sigma_mps: f64,
    ) -> Option<GaussianState<2>> {
        let covariance = Matrix2::new(
            variance_of(&sensor.report)?,
            0.0,
            0.0,
            self.initial_rate_sigma_radps.powi(2),
        );
        Some(GaussianState {
            mean: Vector2::new(measurement[0], 0.0),
            covariance,
        })
    }
}

/// σ².
fn variance_of(report: &MeasurementModel) -> Option<f64> {
    match report {
        MeasurementModel::Bearing { sigma_bearing_rad } => Some(sigma_bearing_rad.powi(2)),
        MeasurementModel::Polar(polar) => Some(polar.sigma_bearing_rad.powi(2)),
        MeasurementModel::Position { .. } => None,
    }
}

#[cfg(test)]
mod tests {
    use super::super::mixture::{WeightedInnovation, update};
    use super::super::prediction::Transition;
    use super::*;
    use crate::math::angle::difference;
    use std::f64::consts::PI;

    #[test]
    fn a_bearing_that_passes_south_goes_on() {
        // 0.01 rad/s for 40 s, from 0.2 rad before π to 0.2 rad behind it.
        let report = MeasurementModel::Bearing {
            sigma_bearing_rad: 0.01,
        };
        let sensor = Sensor {
            sensor_id: "sonar".into(),
            p_d: 0.9,
            clutter_density: 1.0,
            report,
        };
        let filter = BearingOnly {
            process_noise_rad2ps3: 1e-8,
            initial_rate_sigma_radps: 0.05,
        };
        let at = |time_s: f64| {
            filter
                .to_measurement_space(
                    &sensor,
                    &Measurement::Bearing {
                        bearing_rad: PI - 0.2 + 0.01 * time_s,
                    },
                )
                .unwrap()
        };
        let mut state = filter.initiate(&at(0.0), &sensor, 0.05).unwrap();
        for scan in 1..=40 {
            Transition::new(filter.motion(), 1.0).predict(&mut state);
            let expected = filter.expect(&state, &sensor).unwrap();
            let innovation = difference(
                &at(f64::from(scan)),
                &expected.measurement,
                filter.angle(&sensor),
            );
            assert!(innovation[0].abs() < 0.011, "scan {scan}: {innovation}");
            update(
                &mut state,
                &expected.correction(),
                &[WeightedInnovation {
                    innovation,
                    weight: 1.0,
                }],
            );
        }
        assert!(
            (wrap(state.mean[0]) - (-PI + 0.2)).abs() < 1e-3 && (state.mean[1] - 0.01).abs() < 1e-4,
            "{}",
            state.mean
        );
    }
}
