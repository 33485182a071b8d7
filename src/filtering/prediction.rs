//! The prediction that all filters share: every coordinate moves with nearly constant velocity, which is linear.
//!
//! # Symbols
//! x̂, P state and covariance; F, Q transition and process noise.
//!
//! # Method
//! x̂ ← F x̂, P ← F P Fᵀ + Q, written out in blocks of coordinates and rates.

use super::mixture::mirror;
use crate::model::motion::ConstantVelocity;
use crate::model::state::GaussianState;
use nalgebra::SMatrix;

/// How a track's state changes over one time step; the same for all tracks of a scan.
#[derive(Debug, Clone, Copy)]
pub struct Transition<const N: usize> {
    dt_s: f64,
    noise: SMatrix<f64, N, N>,
}

impl<const N: usize> Transition<N> {
    pub fn new(motion: ConstantVelocity, dt_s: f64) -> Self {
        Transition {
            dt_s,
            noise: motion.process_noise(dt_s),
        }
    }

    #[inline]
    pub fn predict(&self, state: &mut GaussianState<N>) {
        let (dt, axes) = (self.dt_s, N / 2);
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
        *p += self.noise;
        mirror(p);
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
            Transition::new(motion, dt).predict(&mut state);
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
        Transition::new(
            ConstantVelocity {
                spectral_density: 2.0,
            },
            3.0,
        )
        .predict(&mut state);
        assert!((state.mean - Vector2::new(0.8, 0.1)).abs().max() < 1e-12);
        assert!(
            (state.covariance - Matrix2::new(55.0, 21.0, 21.0, 10.0))
                .abs()
                .max()
                < 1e-12
        );
    }
}
