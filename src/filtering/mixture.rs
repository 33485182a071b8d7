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

use super::Weighted;
use crate::model::state::{GaussianState, mirror};
use nalgebra::{SMatrix, SVector};

/// Steps 2 and 3, with K S Kᵀ and the K νⱼ. The weights of `detections` and β₀ sum to 1.
#[inline]
pub fn update<const N: usize>(
    state: &mut GaussianState<N>,
    loss: &SMatrix<f64, N, N>,
    detections: impl ExactSizeIterator<Item = Weighted<SVector<f64, N>>> + Clone,
) {
    if detections.len() == 0 {
        return;
    }
    let mut shift = SVector::<f64, N>::zeros();
    let mut detected = 0.0;
    for detection in detections.clone() {
        shift += detection.change * detection.weight;
        detected += detection.weight;
    }
    state.mean += shift;
    state.covariance -= loss * detected;
    if detected < 1.0 || detections.len() > 1 {
        state.covariance += spread(detections, &shift);
    }
    mirror(&mut state.covariance);
}

/// Σ βⱼ Kⱼ Sⱼ Kⱼᵀ / Σ βⱼ, of detections that have noises of their own: in step 3 it is K S Kᵀ.
pub fn mean_loss<'l, const N: usize>(
    losses: impl Iterator<Item = (&'l SMatrix<f64, N, N>, f64)>,
) -> SMatrix<f64, N, N> {
    let (mut sum, mut total) = (SMatrix::<f64, N, N>::zeros(), 0.0);
    for (loss, weight) in losses {
        sum += loss * weight;
        total += weight;
    }
    if total > 0.0 { sum / total } else { sum }
}

/// Σ βⱼ K νⱼ (K νⱼ)ᵀ − K ν (K ν)ᵀ: what is not known because it is not known which detection was the right one.
fn spread<const N: usize>(
    detections: impl Iterator<Item = Weighted<SVector<f64, N>>>,
    shift: &SVector<f64, N>,
) -> SMatrix<f64, N, N> {
    let mut second_moment = -(shift * shift.transpose());
    for detection in detections {
        second_moment += detection.change * detection.change.transpose() * detection.weight;
    }
    second_moment
}
