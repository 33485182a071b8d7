//! One step back in time: what is believed of a target at a scan, in the light of the scans after it.
//!
//! # Reference
//! H. E. Rauch, F. Tung, C. T. Striebel, Maximum likelihood estimates of linear dynamic systems, AIAA Journal 3(8), 1965.
//!
//! # Symbols
//! x̂, P what was believed at the scan; x̂⁻, P⁻ the same predicted to the next one; x̂⁺, P⁺ what is believed there in the light of all
//! scans; C = P Fᵀ covariance of the state now and then.
//!
//! # Method
//! G = C (P⁻)⁻¹; x̂ ← x̂ + G (x̂⁺ − x̂⁻), P ← P + G (P⁺ − P⁻) Gᵀ. P⁻ may be singular, where a motion without noise starts from what is
//! certain: then what is certain moves nothing. After a soft association x̂ and P are the moments of a mixture, and the step is
//! as good as they stand for it.

use crate::math::semidefinite::Factor;
use crate::model::state::{GaussianState, mirror};
use nalgebra::{SMatrix, SVector};

/// From a state to the one at the next scan.
pub struct Passage<const N: usize> {
    predicted: GaussianState<N>,
    /// G.
    gain: SMatrix<f64, N, N>,
}

impl<const N: usize> Passage<N> {
    /// With x̂⁻, P⁻ and C.
    pub fn new(predicted: &GaussianState<N>, cross: &SMatrix<f64, N, N>) -> Self {
        let factor = Factor::new(&predicted.covariance);
        let mut gain = SMatrix::<f64, N, N>::zeros();
        for row in 0..N {
            let solved: SVector<f64, N> = factor.solve(&cross.row(row).transpose());
            gain.set_row(row, &solved.transpose());
        }
        Passage {
            predicted: *predicted,
            gain,
        }
    }

    pub fn back(&self, belief: &GaussianState<N>, next: &GaussianState<N>) -> GaussianState<N> {
        let lost = next.covariance - self.predicted.covariance;
        let mut covariance = belief.covariance + self.gain * lost * self.gain.transpose();
        mirror(&mut covariance);
        GaussianState {
            mean: belief.mean + self.gain * (next.mean - self.predicted.mean),
            covariance,
        }
    }
}
