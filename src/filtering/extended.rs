//! The extended Kalman filter for ranges and bearings, with range rates where the sensor measures them: the report is
//! linearised at the predicted state, and what a line cannot say of it counts as more noise. Without that a track of a sensor
//! so precise that it sees the curvature would be certain of what is wrong. Position reports are linear already.
//!
//! # Reference
//! Y. Bar-Shalom, X.-R. Li, T. Kirubarajan, Estimation with Applications to Tracking and Navigation, 2001, section 10.3, with the
//! second-order terms of section 10.3.2.
//!
//! # Symbols
//! x̂, P state and covariance; h report of a state; H = ∂h/∂x at x̂; Fᵢ = ∂²hᵢ/∂x² at x̂; R, S noise and innovation covariance;
//! C = cov(x, z).
//!
//! # Method
//! ẑᵢ = hᵢ(x̂) + ½ tr(Fᵢ P), Sᵢⱼ = (H P Hᵀ + R)ᵢⱼ + ½ tr(Fᵢ P Fⱼ P), C = P Hᵀ. Differences of bearings take the shorter way
//! round.

use super::mixture::Expected;
use super::plane::PolarFilter;
use super::{AnyFilter, FilterMethod, PROCESS_NOISE, polar};
use crate::model::sensor::Polar;
use crate::model::state::GaussianState;
use crate::registry::Object;
use serde::Deserialize;

pub const METHOD: FilterMethod = FilterMethod {
    name: "extended",
    parameters: &PARAMETERS,
    build: |spec| Extended::deserialize(spec).map(AnyFilter::Extended),
};

static PARAMETERS: Object = Object {
    name: "ExtendedFilter",
    summary: "Extended Kalman filter for ranges and bearings, with or without range rates, and for positions; nearly constant velocity.",
    fields: &[PROCESS_NOISE],
};

/// The filter of one tracker; `D` is 3 when every detection has a range rate.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct Extended {
    pub process_noise_m2ps3: f64,
}

impl PolarFilter for Extended {
    fn spectral_density(&self) -> f64 {
        self.process_noise_m2ps3
    }

    fn expect_polar<const D: usize>(
        &self,
        state: &GaussianState,
        polar: &Polar,
    ) -> Option<Expected<4, D>> {
        let (shift, spread) = polar::curvature(polar, state);
        let measurement = polar::project(polar, &state.mean) + shift;
        Expected::linear(
            measurement,
            &polar::jacobian(polar, state),
            &(polar::noise(polar)? + spread),
            state,
        )
    }
}
