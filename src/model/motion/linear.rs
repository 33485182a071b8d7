//! One step of a linear motion: x̂ ← F x̂, P ← F P Fᵀ + Q.

use crate::model::state::{GaussianState, mirror};
use nalgebra::SMatrix;

/// F and Q.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Linear<const N: usize> {
    pub transition: SMatrix<f64, N, N>,
    pub noise: SMatrix<f64, N, N>,
}

impl<const N: usize> Linear<N> {
    /// The same F and Q on each axis, of `D` variables an axis: coordinate, rate and what the model adds.
    pub fn of_axes<const D: usize>(change: &[[f64; D]; D], of_axis: &[[f64; D]; D]) -> Self {
        let axes = N / D;
        let (mut transition, mut noise) = (SMatrix::zeros(), SMatrix::zeros());
        for row in 0..N {
            for column in (row % axes..N).step_by(axes) {
                transition[(row, column)] = change[row / axes][column / axes];
                noise[(row, column)] = of_axis[row / axes][column / axes];
            }
        }
        Linear { transition, noise }
    }

    #[inline]
    pub fn predict(&self, belief: &mut GaussianState<N>) {
        belief.mean = self.transition * belief.mean;
        belief.covariance =
            self.transition * belief.covariance * self.transition.transpose() + self.noise;
        mirror(&mut belief.covariance);
    }

    /// Variance of a rate at the end of the step around the mean rate of that time, var(v − p/T), of the step's noise and of an
    /// unknown third variable of each of the `axes`, which has so large a standard deviation.
    pub fn rate_variance(&self, axes: usize, dt_s: f64, initial_sigma: f64) -> f64 {
        if dt_s <= 0.0 {
            return 0.0;
        }
        let (q, f) = (&self.noise, &self.transition);
        let noise = q[(axes, axes)] + q[(0, 0)] / dt_s.powi(2) - 2.0 * q[(0, axes)] / dt_s;
        let unknown = if N > 2 * axes {
            f[(axes, 2 * axes)] - f[(0, 2 * axes)] / dt_s
        } else {
            0.0
        };
        noise.max(0.0) + (initial_sigma * unknown).powi(2)
    }
}
