//! Coordinated turn of a rate that is estimated, too: ω wanders with white noise of spectral density q_ω, and white acceleration of
//! density q disturbs the turn. Positive rates turn left.
//!
//! # Reference
//! Y. Bar-Shalom, X.-R. Li, T. Kirubarajan, Estimation with Applications to Tracking and Navigation, 2001, section 11.7.
//!
//! # Symbols
//! x̂, P state (x, y, vx, vy, ω) and covariance; f motion over T, F = ∂f/∂x at x̂; u = ωT, a and b as of
//! [`super::coordinated_turn`].
//!
//! # Method
//! x̂ ← f(x̂), P ← F P Fᵀ + Q, the prediction of an extended filter. F has the column ∂f/∂ω, T² (a′ v + b′ v⊥) of the place and
//! T times the turned v⊥ of the velocity. Q is that of the turn with the rate ω̂, and q_ω T on ω: what a change of ω within the
//! step does to the rest is left out.

use super::Motion;
use super::coordinated_turn::Arc;
use super::linear::Linear;
use crate::model::state::{GaussianState, mirror};
use nalgebra::{Matrix5, SMatrix, SVector};

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UnknownTurn {
    /// q (m²/s³).
    pub spectral_density: f64,
    /// q_ω (rad²/s³).
    pub turn_density: f64,
    /// Of the turn rate of a new track, which starts straight (rad/s).
    pub initial_sigma: f64,
}

/// What is the same for all states.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    pub dt_s: f64,
    /// q.
    pub spectral_density: f64,
    /// What is added to Q whatever the rate.
    pub noise: Matrix5<f64>,
}

impl Motion<5> for UnknownTurn {
    type Step = Step;

    fn step(&self, dt_s: f64) -> Step {
        let mut noise = Matrix5::zeros();
        noise[(4, 4)] = self.turn_density * dt_s;
        Step {
            dt_s,
            spectral_density: self.spectral_density,
            noise,
        }
    }

    #[inline]
    fn predict(step: &Step, belief: &mut GaussianState<5>) {
        let arc = Arc::new(belief.mean[4] * step.dt_s);
        let slope = step.jacobian(&arc, &belief.mean);
        // f is the slope without its last column, which is the place of ω itself.
        let moved = slope.fixed_view::<4, 4>(0, 0) * belief.mean.fixed_rows::<4>(0);
        belief.mean.fixed_rows_mut::<4>(0).copy_from(&moved);
        belief.covariance = slope * belief.covariance * slope.transpose() + step.noise;
        let mut noise = belief.covariance.fixed_view_mut::<4, 4>(0, 0);
        noise += arc.noise(step.spectral_density, step.dt_s);
        mirror(&mut belief.covariance);
    }

    fn transition(step: &Step, mean: &SVector<f64, 5>) -> SMatrix<f64, 5, 5> {
        step.jacobian(&Arc::new(mean[4] * step.dt_s), mean)
    }

    fn initial_sigma(&self) -> f64 {
        self.initial_sigma
    }

    /// q T/3, as far as the acceleration goes: what a turn does depends on the speed.
    fn rate_variance(&self, dt_s: f64) -> f64 {
        self.spectral_density * dt_s / 3.0
    }

    fn bend_mps(&self, speed_mps: f64, dt_s: f64) -> f64 {
        self.initial_sigma * speed_mps * dt_s
    }
}

impl Step {
    /// F and Q around a belief. f is F without its last column, which is the place of ω itself.
    #[inline]
    pub fn around(&self, belief: &GaussianState<5>) -> Linear<5> {
        let arc = Arc::new(belief.mean[4] * self.dt_s);
        let mut noise = self.noise;
        let mut of_turn = noise.fixed_view_mut::<4, 4>(0, 0);
        of_turn += arc.noise(self.spectral_density, self.dt_s);
        Linear {
            transition: self.jacobian(&arc, &belief.mean),
            noise,
        }
    }

    #[inline]
    fn jacobian(&self, arc: &Arc, mean: &SVector<f64, 5>) -> SMatrix<f64, 5, 5> {
        let (vx, vy) = (mean[2], mean[3]);
        let (dt_s, square) = (self.dt_s, self.dt_s * self.dt_s);
        let (a, b) = (arc.along_slope() * square, arc.across_slope() * square);
        let mut slope = Matrix5::identity();
        slope
            .fixed_view_mut::<4, 4>(0, 0)
            .copy_from(&arc.transition(dt_s));
        slope[(0, 4)] = a * vx - b * vy;
        slope[(1, 4)] = b * vx + a * vy;
        slope[(2, 4)] = -dt_s * (arc.sin * vx + arc.cos * vy);
        slope[(3, 4)] = dt_s * (arc.cos * vx - arc.sin * vy);
        slope
    }
}
