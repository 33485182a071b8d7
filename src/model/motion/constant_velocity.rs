//! Nearly constant velocity: the acceleration of each coordinate is white noise of spectral density q.
//!
//! # Reference
//! Y. Bar-Shalom, X.-R. Li, T. Kirubarajan, Estimation with Applications to Tracking and Navigation, 2001, section 6.2.2.
//!
//! # Symbols
//! x̂, P state and covariance; F, Q transition and process noise over dt.
//!
//! # Method
//! x̂ ← F x̂, P ← F P Fᵀ + Q, written out in blocks of coordinates and rates.

use super::Motion;
use crate::model::state::{GaussianState, mirror};
use nalgebra::SMatrix;

/// `spectral_density` is q, the same for every coordinate: m²/s³ in the plane, rad²/s³ for a bearing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ConstantVelocity {
    pub spectral_density: f64,
}

impl ConstantVelocity {
    /// Q(dt): q·dt³/3 on a coordinate, q·dt²/2 between it and its rate, q·dt on the rate.
    pub fn process_noise<const N: usize>(&self, dt_s: f64) -> SMatrix<f64, N, N> {
        let q = self.spectral_density;
        let (position, cross, velocity) =
            (q * dt_s.powi(3) / 3.0, q * dt_s.powi(2) / 2.0, q * dt_s);
        let mut noise = SMatrix::zeros();
        for (axis, rate) in (0..N / 2).map(|axis| (axis, axis + N / 2)) {
            noise[(axis, axis)] = position;
            noise[(axis, rate)] = cross;
            noise[(rate, axis)] = cross;
            noise[(rate, rate)] = velocity;
        }
        noise
    }
}

/// F and Q.
#[derive(Debug, Clone, Copy)]
pub struct Step<const N: usize> {
    dt_s: f64,
    noise: SMatrix<f64, N, N>,
}

impl<const N: usize> Step<N> {
    /// Over a time in which coordinates and rates gain this noise.
    pub(super) fn new(dt_s: f64, noise: SMatrix<f64, N, N>) -> Self {
        Step { dt_s, noise }
    }
}

impl<const N: usize> Motion<N> for ConstantVelocity {
    type Step = Step<N>;

    fn step(&self, dt_s: f64) -> Step<N> {
        Step {
            dt_s,
            noise: self.process_noise(dt_s),
        }
    }

    #[inline]
    fn predict(step: &Step<N>, state: &mut GaussianState<N>) {
        let (dt, axes) = (step.dt_s, N / 2);
        for axis in 0..axes {
            state.mean[axis] += state.mean[axis + axes] * dt;
        }
        let p = &mut state.covariance;
        // P in blocks [A B; Bᵀ C]: A ← A + dt (B + Bᵀ) + dt² C, B ← B + dt C, then + Q.
        for row in 0..axes {
            for column in row..axes {
                p[(row, column)] += dt * (p[(row, column + axes)] + p[(column, row + axes)])
                    + dt * dt * p[(row + axes, column + axes)];
            }
        }
        for row in 0..axes {
            for column in 0..axes {
                p[(row, column + axes)] += dt * p[(row + axes, column + axes)];
            }
        }
        *p += step.noise;
        mirror(p);
    }

    fn white_acceleration(&self) -> Option<f64> {
        Some(self.spectral_density)
    }

    /// q·T/3.
    fn rate_variance(&self, dt_s: f64) -> f64 {
        self.spectral_density * dt_s / 3.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Matrix2, Matrix4, Vector2, Vector4};

    #[test]
    fn the_block_prediction_equals_f_p_ft_plus_q() {
        let motion = ConstantVelocity {
            spectral_density: 0.5,
        };
        let dt = 2.0;
        let mut state = GaussianState {
            mean: Vector4::new(1.0, 2.0, 3.0, -1.0),
            covariance: Matrix4::from_diagonal(&Vector4::new(4.0, 9.0, 100.0, 100.0)),
        };
        let mut f = Matrix4::identity();
        f[(0, 2)] = dt;
        f[(1, 3)] = dt;
        for _ in 0..3 {
            let expected = f * state.covariance * f.transpose() + motion.process_noise(dt);
            let expected_mean = f * state.mean;
            ConstantVelocity::predict(&motion.step(dt), &mut state);
            assert!((state.covariance - expected).abs().max() < 1e-9);
            assert!((state.mean - expected_mean).abs().max() < 1e-12);
        }
    }

    #[test]
    fn a_bearing_and_its_rate_move_alike() {
        // P = diag(1, 4), dt = 3, q = 2: A = 1 + 9·4 + 2·27/3 = 55, B = 3·4 + 2·9/2 = 21, C = 4 + 6 = 10.
        let mut state = GaussianState {
            mean: Vector2::new(0.5, 0.1),
            covariance: Matrix2::new(1.0, 0.0, 0.0, 4.0),
        };
        let motion = ConstantVelocity {
            spectral_density: 2.0,
        };
        ConstantVelocity::predict(&motion.step(3.0), &mut state);
        assert!((state.mean - Vector2::new(0.8, 0.1)).abs().max() < 1e-12);
        assert!(
            (state.covariance - Matrix2::new(55.0, 21.0, 21.0, 10.0))
                .abs()
                .max()
                < 1e-12
        );
    }
}
