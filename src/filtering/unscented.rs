//! The unscented Kalman filter for ranges and bearings, with range rates where the sensor measures them: the report is
//! averaged over points that stand for the state's distribution. The motion is linear and is predicted exactly.
//!
//! # Reference
//! S. J. Julier, J. K. Uhlmann, Unscented filtering and nonlinear estimation, Proceedings of the IEEE 92(3), 2004;
//! E. A. Wan, R. van der Merwe, The unscented Kalman filter for nonlinear estimation, 2000 (α, β, κ).
//!
//! # Symbols
//! x̂, P state and covariance; n = 4 its size; L Lᵀ = P; h report of a state; R, S noise and innovation covariance;
//! C = cov(x, z); χ points, with weights wᵢ for means and, at the centre, another one w₀ᶜ for covariances.
//!
//! # Method
//! 1. c = α² (n + κ); χ₀ = x̂, χ = x̂ ± √c Lⱼ; w₀ = 1 − n/c, w₀ᶜ = w₀ + 1 − α² + β, the others 1 / 2c.
//! 2. ẑ = Σ wᵢ h(χᵢ), S = Σ wᵢ (h(χᵢ) − ẑ)(h(χᵢ) − ẑ)ᵀ + R, C = Σ wᵢ (χᵢ − x̂)(h(χᵢ) − ẑ)ᵀ.
//!
//! Differences of bearings take the shorter way round, the mean is taken of differences to h(χ₀). With c ≥ n, as by
//! default, no weight is negative and S cannot fail to be positive definite.

use super::mixture::Expected;
use super::plane::PolarFilter;
use super::{AnyFilter, FilterMethod, PROCESS_NOISE, polar};
use crate::math::angle;
use crate::model::sensor::Polar;
use crate::model::state::{GaussianState, State};
use crate::registry::{Object, default, number};
use nalgebra::{Cholesky, SMatrix, SVector};
use serde::Deserialize;

pub const METHOD: FilterMethod = FilterMethod {
    name: "unscented",
    parameters: &PARAMETERS,
    build: |spec| Unscented::deserialize(spec).map(AnyFilter::Unscented),
};

static PARAMETERS: Object = Object {
    name: "UnscentedFilter",
    summary: "Unscented Kalman filter for ranges and bearings, with or without range rates, and for positions; nearly constant velocity.",
    fields: &[
        PROCESS_NOISE,
        default(
            "alpha",
            "Spread of the points around the mean; 1 keeps every weight positive.",
            number(1e-3, 1.0, ""),
            "1.0",
        ),
        default(
            "beta",
            "What is known of the distribution's fourth moment; 2 is right for a Gaussian.",
            number(0.0, 10.0, ""),
            "2.0",
        ),
        default(
            "kappa",
            "Second parameter of the spread.",
            number(0.0, 100.0, ""),
            "0.0",
        ),
    ],
};

/// The filter of one tracker; `D` is 3 when every detection has a range rate.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct Unscented {
    pub process_noise_m2ps3: f64,
    pub alpha: f64,
    pub beta: f64,
    pub kappa: f64,
}

/// n, and the number of points besides the centre.
const SIZE: usize = 4;
const AROUND: usize = 2 * SIZE;

impl PolarFilter for Unscented {
    fn spectral_density(&self) -> f64 {
        self.process_noise_m2ps3
    }

    fn expect_polar<const D: usize>(
        &self,
        state: &GaussianState,
        polar: &Polar,
    ) -> Option<Expected<4, D>> {
        let spread = self.alpha.powi(2) * (SIZE as f64 + self.kappa);
        let weight = 1.0 / (2.0 * spread);
        let centre_weight = 1.0 - SIZE as f64 / spread + 1.0 - self.alpha.powi(2) + self.beta;
        let steps = steps(state, spread)?;
        let centre: SVector<f64, D> = polar::project(polar, &state.mean);
        let shifts = steps.map(|step| {
            angle::difference(
                &polar::project(polar, &(state.mean + step)),
                &centre,
                Some(1),
            )
        });
        let mean_shift = shifts.iter().sum::<SVector<f64, D>>() * weight;
        let mut covariance =
            polar::noise(polar)? + mean_shift * mean_shift.transpose() * centre_weight;
        let mut cross = SMatrix::<f64, 4, D>::zeros();
        for (step, shift) in steps.iter().zip(&shifts) {
            let deviation = shift - mean_shift;
            covariance += deviation * deviation.transpose() * weight;
            cross += step * deviation.transpose() * weight;
        }
        let mut measurement = centre + mean_shift;
        measurement[1] = angle::wrap(measurement[1]);
        Expected::new(measurement, covariance, cross)
    }
}

/// χᵢ − x̂ for the points around the centre; `None` when P is not positive definite.
fn steps(state: &GaussianState, spread: f64) -> Option<[State; AROUND]> {
    let root = Cholesky::new(state.covariance)?.l() * spread.sqrt();
    Some(std::array::from_fn(|index| {
        let step: State = root.column(index / 2).into_owned();
        if index % 2 == 0 { step } else { -step }
    }))
}
