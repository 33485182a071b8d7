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

use super::gaussian::GaussianFilter;
use super::{AnyFilter, FilterMethod, Reports, Way};
use crate::model::motion::constant_velocity::ConstantVelocity;
use crate::registry::{Object, above, default, number};
use serde::Deserialize;

pub const METHOD: FilterMethod = FilterMethod {
    name: "bearing_only",
    parameters: &PARAMETERS,
    build: |spec| Wire::deserialize(spec).map(|wire| AnyFilter::Bearing(wire.in_radians())),
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

/// The filter of directions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BearingOnly {
    /// Spectral density q of the white noise that changes the rate.
    pub process_noise_rad2ps3: f64,
    /// Standard deviation of the rate of a new track.
    pub initial_rate_sigma_radps: f64,
}

impl BearingOnly {
    pub fn build(&self) -> GaussianFilter<ConstantVelocity, 2, 2> {
        let motion = ConstantVelocity {
            spectral_density: self.process_noise_rad2ps3,
        };
        GaussianFilter {
            rate_sigma: Some(self.initial_rate_sigma_radps),
            ..GaussianFilter::new(motion, Way::Line, Reports::All)
        }
    }
}
