//! The unscented Kalman filter for ranges and bearings, with range rates where the sensor measures them: the report is
//! averaged over points that stand for the state's distribution. The motion is linear and is predicted exactly.
//!
//! # Reference
//! S. J. Julier, J. K. Uhlmann, Unscented filtering and nonlinear estimation, Proceedings of the IEEE 92(3), 2004;
//! E. A. Wan, R. van der Merwe, The unscented Kalman filter for nonlinear estimation, 2000 (α, β, κ).
//!
//! # Symbols
//! x̂, P state and covariance; n its size; L Lᵀ = P; h report of a state; R, S noise and innovation covariance;
//! C = cov(x, z); χ points, with weights wᵢ for means and, at the centre, another one w₀ᶜ for covariances.
//!
//! # Method
//! 1. c = α² (n + κ); χ₀ = x̂, χ = x̂ ± √c Lⱼ; w₀ = 1 − n/c, w₀ᶜ = w₀ + 1 − α² + β, the others 1 / 2c.
//! 2. ẑ = Σ wᵢ h(χᵢ), S = Σ wᵢ (h(χᵢ) − ẑ)(h(χᵢ) − ẑ)ᵀ + R, C = Σ wᵢ (χᵢ − x̂)(h(χᵢ) − ẑ)ᵀ.
//!
//! Differences of bearings take the shorter way round, the mean is taken of differences to h(χ₀). With c ≥ n, as by
//! default, no weight is negative and S cannot fail to be positive definite.

use super::expected::{Expected, Gain, expected};
use super::{FilterMethod, MOTION, PROCESS_NOISE, Reports, VERTICAL, Way, in_plane};
use crate::model::angle;
use crate::model::sensing::Sensing;
use crate::model::state::GaussianState;
use crate::registry::{Object, default, number};
use nalgebra::{Cholesky, SMatrix, SVector};
use serde::Deserialize;

pub const METHOD: FilterMethod = FilterMethod {
    name: "unscented",
    parameters: &PARAMETERS,
    build: |spec| {
        in_plane(
            spec,
            Way::Points(Unscented::deserialize(spec)?),
            Reports::All,
        )
    },
};

static PARAMETERS: Object = Object {
    name: "UnscentedFilter",
    summary: "Unscented Kalman filter for ranges and bearings, with or without range rates, for positions, and for bearings from a known place.",
    fields: &[
        PROCESS_NOISE,
        MOTION,
        VERTICAL,
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

/// How the points lie.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct Unscented {
    pub alpha: f64,
    pub beta: f64,
    pub kappa: f64,
}

/// Points of equal weight besides the centre; no weight is negative.
impl Default for Unscented {
    fn default() -> Self {
        Unscented {
            alpha: 1.0,
            beta: 2.0,
            kappa: 0.0,
        }
    }
}

impl Unscented {
    pub(super) fn expect<S: Sensing<K, D>, const N: usize, const K: usize, const D: usize>(
        &self,
        belief: &GaussianState<N>,
        sensing: &S,
    ) -> Option<(Expected<D>, Gain<N, D>)> {
        let spread = self.alpha.powi(2) * (N as f64 + self.kappa);
        let weight = 1.0 / (2.0 * spread);
        let centre_weight = 1.0 - N as f64 / spread + 1.0 - self.alpha.powi(2) + self.beta;
        let steps = steps(belief, spread)?;
        let project =
            |mean: SVector<f64, N>| sensing.project(&mean.fixed_rows::<K>(0).into_owned());
        let centre = project(belief.mean);
        let shifts = steps.map(|pair| {
            pair.map(|step| angle::difference(&project(belief.mean + step), &centre, S::ANGLE))
        });
        let (steps, shifts) = (steps.as_flattened(), shifts.as_flattened());
        let mean_shift = shifts.iter().sum::<SVector<f64, D>>() * weight;
        let mut covariance = sensing.noise(&belief.leading::<K>())
            + mean_shift * mean_shift.transpose() * centre_weight;
        let mut cross = SMatrix::<f64, N, D>::zeros();
        for (step, shift) in steps.iter().zip(shifts) {
            let deviation = shift - mean_shift;
            covariance += deviation * deviation.transpose() * weight;
            cross += step * deviation.transpose() * weight;
        }
        let mut measurement = centre + mean_shift;
        if let Some(value) = S::ANGLE {
            measurement[value] = angle::wrap(measurement[value]);
        }
        expected(measurement, covariance, cross)
    }
}

/// χᵢ − x̂ for the points around the centre; `None` when P is not positive definite.
fn steps<const N: usize>(
    belief: &GaussianState<N>,
    spread: f64,
) -> Option<[[SVector<f64, N>; 2]; N]> {
    let root = Cholesky::new(belief.covariance)?.l() * spread.sqrt();
    Some(std::array::from_fn(|index| {
        let step: SVector<f64, N> = root.column(index).into_owned();
        [step, -step]
    }))
}
