//! The update that all filters share: the moment-matched mixture over a track's weighted detections and "none". One
//! certain detection is the special case of hard association. Filters differ only in what they expect.
//!
//! # Reference
//! Y. Bar-Shalom, T. E. Fortmann, Tracking and Data Association, 1988, section 6.3.
//!
//! # Symbols
//! x̂, P state and covariance; ẑ, S expected measurement and innovation covariance; C = cov(x, z); K gain; ν innovation;
//! βⱼ weight of detection j, β₀ of none.
//!
//! # Method
//! 1. K = C S⁻¹.
//! 2. K ν = Σ βⱼ K νⱼ, x̂ ← x̂ + K ν.
//! 3. P ← P − (1 − β₀) K S Kᵀ + Σ βⱼ K νⱼ (K νⱼ)ᵀ − K ν (K ν)ᵀ.
//!
//! K νⱼ and K S Kᵀ = C S⁻¹ Cᵀ have the size of the state, whatever the sensor measures.

use crate::math::gaussian::Gaussian;
use crate::model::state::GaussianState;
use nalgebra::{SMatrix, SVector};

/// What a track with `N` state variables expects of a measurement of `D` values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Expected<const N: usize, const D: usize> {
    /// ẑ.
    pub measurement: SVector<f64, D>,
    /// S.
    pub covariance: SMatrix<f64, D, D>,
    /// S⁻¹ and ln of the density at ẑ.
    pub gaussian: Gaussian<D>,
    /// C.
    pub cross: SMatrix<f64, N, D>,
}

/// What the update needs of an expectation: a scan keeps one for each track, so it is small.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Correction<const N: usize, const D: usize> {
    /// S⁻¹.
    inverse: SMatrix<f64, D, D>,
    /// C.
    cross: SMatrix<f64, N, D>,
}

/// A gated detection of a track: its innovation ν and weight β.
#[derive(Debug, Clone, Copy)]
pub struct WeightedInnovation<const D: usize> {
    pub innovation: SVector<f64, D>,
    pub weight: f64,
}

impl<const N: usize, const D: usize> Expected<N, D> {
    /// `None` when S is not positive definite.
    #[inline(always)]
    pub fn new(
        measurement: SVector<f64, D>,
        covariance: SMatrix<f64, D, D>,
        cross: SMatrix<f64, N, D>,
    ) -> Option<Self> {
        let gaussian = Gaussian::new(&covariance)?;
        Some(Expected {
            measurement,
            covariance,
            gaussian,
            cross,
        })
    }

    #[inline(always)]
    pub fn correction(&self) -> Correction<N, D> {
        Correction {
            inverse: *self.gaussian.inverse(),
            cross: self.cross,
        }
    }

    /// Of a measurement that is linear in the state: S = H P Hᵀ + R, C = P Hᵀ.
    pub fn linear(
        measurement: SVector<f64, D>,
        matrix: &SMatrix<f64, D, N>,
        noise: &SMatrix<f64, D, D>,
        state: &GaussianState<N>,
    ) -> Option<Self> {
        let cross = state.covariance * matrix.transpose();
        Expected::new(measurement, matrix * cross + noise, cross)
    }
}

/// Steps 1 to 3. The weights of `detections` and β₀ sum to 1.
#[inline]
pub fn update<const N: usize, const D: usize>(
    state: &mut GaussianState<N>,
    correction: &Correction<N, D>,
    detections: &[WeightedInnovation<D>],
) {
    if detections.is_empty() {
        return;
    }
    let gain = correction.cross * correction.inverse;
    let mut shift = SVector::<f64, N>::zeros();
    let mut detected = 0.0;
    for detection in detections {
        shift += gain * detection.innovation * detection.weight;
        detected += detection.weight;
    }
    state.mean += shift;
    state.covariance -= gain * correction.cross.transpose() * detected;
    if detected < 1.0 || detections.len() > 1 {
        state.covariance += spread(&gain, detections, &shift);
    }
    mirror(&mut state.covariance);
}

/// Σ βⱼ (K νⱼ)(K νⱼ)ᵀ − K ν (K ν)ᵀ: what is not known because it is not known which detection was the right one.
fn spread<const N: usize, const D: usize>(
    gain: &SMatrix<f64, N, D>,
    detections: &[WeightedInnovation<D>],
    shift: &SVector<f64, N>,
) -> SMatrix<f64, N, N> {
    let mut second_moment = -(shift * shift.transpose());
    for detection in detections {
        let change = gain * detection.innovation;
        second_moment += change * change.transpose() * detection.weight;
    }
    second_moment
}

/// Copies the upper triangle below the diagonal, so that rounding never makes P unsymmetric.
#[inline]
pub(super) fn mirror<const N: usize>(covariance: &mut SMatrix<f64, N, N>) {
    for row in 1..N {
        for column in 0..row {
            covariance[(row, column)] = covariance[(column, row)];
        }
    }
}
