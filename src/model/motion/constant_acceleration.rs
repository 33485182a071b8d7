//! Nearly constant acceleration: the jerk of each coordinate is white noise of spectral density q.
//!
//! # Reference
//! Y. Bar-Shalom, X.-R. Li, T. Kirubarajan, Estimation with Applications to Tracking and Navigation, 2001, section 6.2.3.
//!
//! # Symbols
//! x̂, P state and covariance; F, Q transition and process noise over T; a axes.
//!
//! # Method
//! x̂ ← F x̂, P ← F P Fᵀ + Q. Of one coordinate with its rate and acceleration
//! F = \[1 T T²/2; 0 1 T; 0 0 1\], Q = q \[T⁵/20 T⁴/8 T³/6; T⁴/8 T³/3 T²/2; T³/6 T²/2 T\].

use super::Motion;
use super::linear::Linear;
use crate::model::state::GaussianState;

/// `spectral_density` is q (m²/s⁵), the same for every coordinate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ConstantAcceleration {
    pub spectral_density: f64,
    /// Of each component of the acceleration of a new track, which starts without one (m/s²).
    pub initial_sigma: f64,
}

impl<const N: usize> Motion<N> for ConstantAcceleration {
    type Step = Linear<N>;

    fn step(&self, dt_s: f64) -> Linear<N> {
        let (q, t) = (self.spectral_density, dt_s);
        let of_axis = [
            [t.powi(5) / 20.0, t.powi(4) / 8.0, t.powi(3) / 6.0],
            [t.powi(4) / 8.0, t.powi(3) / 3.0, t.powi(2) / 2.0],
            [t.powi(3) / 6.0, t.powi(2) / 2.0, t],
        ];
        let change = [[1.0, t, t * t / 2.0], [0.0, 1.0, t], [0.0, 0.0, 1.0]];
        Linear::of_axes(&change, &of_axis.map(|row| row.map(|noise| q * noise)))
    }

    #[inline]
    fn predict(step: &Linear<N>, belief: &mut GaussianState<N>) {
        step.predict(belief);
    }

    fn initial_sigma(&self) -> f64 {
        self.initial_sigma
    }

    /// Half the change of an unknown acceleration, σ² T²/4, and of the jerk q T³ (1/3 − 2/8 + 1/20).
    fn rate_variance(&self, dt_s: f64) -> f64 {
        self.initial_sigma.powi(2) * dt_s.powi(2) / 4.0
            + self.spectral_density * dt_s.powi(3) * 2.0 / 15.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Matrix6, Vector6};

    const MOTION: ConstantAcceleration = ConstantAcceleration {
        spectral_density: 0.6,
        initial_sigma: 2.0,
    };

    fn belief() -> GaussianState<6> {
        let root = Matrix6::from_fn(|row, column| ((3 * row + 5 * column) % 7) as f64 - 2.5);
        GaussianState {
            mean: Vector6::new(1.0, 2.0, 3.0, -1.0, 0.5, -0.25),
            covariance: root * root.transpose() + Matrix6::identity(),
        }
    }

    #[test]
    fn a_step_of_two_seconds_as_worked_by_hand() {
        // x: 1 + 3·2 + 0.5·2 = 8, 3 + 0.5·2 = 4; y: 2 − 2 − 0.25·2 = −0.5, −1 − 0.5 = −1.5. Q, q = 0.6: 0.6·32/20 = 0.96.
        let step = Motion::<6>::step(&MOTION, 2.0);
        let mut state = GaussianState {
            covariance: Matrix6::zeros(),
            ..belief()
        };
        ConstantAcceleration::predict(&step, &mut state);
        let expected = Vector6::new(8.0, -0.5, 4.0, -1.5, 0.5, -0.25);
        assert!((state.mean - expected).norm() < 1e-12, "{}", state.mean);
        let of_x = [
            (0, 0, 0.96),
            (0, 2, 1.2),
            (0, 4, 0.8),
            (2, 2, 1.6),
            (2, 4, 1.2),
            (4, 4, 1.2),
        ];
        for (row, column, expected) in of_x {
            for axis in 0..2 {
                let found = state.covariance[(row + axis, column + axis)];
                assert!((found - expected).abs() < 1e-12, "{row} {column}: {found}");
            }
        }
        assert_eq!(state.covariance[(0, 1)], 0.0, "axes are independent");
    }

    #[test]
    fn two_steps_are_one_over_their_sum() {
        let (mut whole, mut parts) = (belief(), belief());
        ConstantAcceleration::predict(&MOTION.step(5.0), &mut whole);
        for dt_s in [1.5, 0.0, 3.5] {
            ConstantAcceleration::predict(&MOTION.step(dt_s), &mut parts);
        }
        assert!((whole.mean - parts.mean).norm() < 1e-12 * whole.mean.norm());
        let apart = (whole.covariance - parts.covariance).norm();
        assert!(apart < 1e-12 * whole.covariance.norm(), "{apart}");
    }

    #[test]
    fn without_jerk_and_acceleration_it_is_constant_velocity() {
        use super::super::constant_velocity::ConstantVelocity;
        let motion = ConstantAcceleration {
            spectral_density: 0.0,
            initial_sigma: 0.0,
        };
        let mut state = belief();
        state.mean.fixed_rows_mut::<2>(4).fill(0.0);
        state.covariance.fixed_rows_mut::<2>(4).fill(0.0);
        state.covariance.fixed_columns_mut::<2>(4).fill(0.0);
        let mut slow = state.leading::<4>();
        ConstantAcceleration::predict(&motion.step(3.0), &mut state);
        let velocity = ConstantVelocity {
            spectral_density: 0.0,
        };
        ConstantVelocity::predict(&velocity.step(3.0), &mut slow);
        assert!((state.leading::<4>().mean - slow.mean).norm() < 1e-12);
        assert!((state.leading::<4>().covariance - slow.covariance).norm() < 1e-9);
    }
}
