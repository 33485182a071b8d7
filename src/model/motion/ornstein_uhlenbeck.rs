//! Integrated Ornstein–Uhlenbeck motion: each velocity is pulled back to a mean m with the rate θ, while white noise of spectral
//! density q disturbs it. Its speed has a stationary standard deviation √(q/2θ), so that over a long time the place is unsure
//! as √T, where that of nearly constant velocity is as T^1.5.
//!
//! # Reference
//! L. M. Millefiori, P. Braca, K. Bryan, P. Willett, Modeling vessel kinematics using a stochastic mean-reverting process for
//! long-term prediction, IEEE Transactions on Aerospace and Electronic Systems 52(5), 2016.
//!
//! # Symbols
//! x̂, P state and covariance; F, Q transition and process noise over T; x = θT, e = exp(−x).
//!
//! # Method
//! p ← p + m T + (v − m)(1−e)/θ, v ← m + (v − m) e; Q = q \[(x − 2(1−e) + (1−e²)/2)/θ³ (1−e)²/2θ²; · (1−e²)/2θ\], with
//! series for small x ([`super::decay`]).

use super::linear::Linear;
use super::{Motion, decay};
use crate::model::state::GaussianState;
use nalgebra::SVector;

/// The same θ and q for each of two coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OrnsteinUhlenbeck {
    /// θ.
    pub damping_per_s: f64,
    /// q (m²/s³).
    pub spectral_density: f64,
    /// m, east and north.
    pub mean_velocity_mps: [f64; 2],
}

/// F, Q, and what the mean velocity adds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    pub linear: Linear<4>,
    pub drift: SVector<f64, 4>,
}

impl Motion<4> for OrnsteinUhlenbeck {
    type Step = Step;

    fn step(&self, dt_s: f64) -> Step {
        let (theta, q) = (self.damping_per_s, self.spectral_density);
        let x = theta * dt_s;
        let (lost, reach_s) = (decay::lost(x), decay::lost(x) / theta);
        let q11 = q * decay::lag_of_squares(x) / (2.0 * theta.powi(3));
        let q12 = q * reach_s.powi(2) / 2.0;
        let q22 = q * decay::lost(2.0 * x) / (2.0 * theta);
        let drift_s = decay::lag(x) / theta;
        let [east, north] = self.mean_velocity_mps;
        Step {
            linear: Linear::of_axes(
                &[[1.0, reach_s], [0.0, (-x).exp()]],
                &[[q11, q12], [q12, q22]],
            ),
            drift: SVector::from([east * drift_s, north * drift_s, east * lost, north * lost]),
        }
    }

    #[inline]
    fn predict(step: &Step, belief: &mut GaussianState<4>) {
        step.linear.predict(belief);
        belief.mean += step.drift;
    }

    fn rate_variance(&self, dt_s: f64) -> f64 {
        self.step(dt_s).linear.rate_variance(2, dt_s, 0.0)
    }

    fn bend_mps(&self, speed_mps: f64, dt_s: f64) -> f64 {
        let [east, north] = self.mean_velocity_mps;
        self.damping_per_s * dt_s * (speed_mps + east.hypot(north))
    }
}
