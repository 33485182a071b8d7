//! Singer's model: the acceleration of each coordinate is a noise that forgets itself in the manoeuvre time τ, with standard
//! deviation σ. Nearly constant acceleration while T ≪ τ, nearly constant velocity when T ≫ τ.
//!
//! # Reference
//! R. A. Singer, Estimating optimal tracking filter performance for manned maneuvering targets, IEEE Transactions on Aerospace
//! and Electronic Systems 6(4), 1970.
//!
//! # Symbols
//! x̂, P state and covariance; F, Q transition and process noise over T; α = 1/τ, x = αT, e = exp(−x).
//!
//! # Method
//! Of one coordinate with its rate and acceleration F = \[1 T (x−1+e)/α²; 0 1 (1−e)/α; 0 0 e\] and
//! Q = σ² \[f₁₁/α⁴ (x−1+e)²/α³ f₁₃/α²; · f₂₂/α² (1−e)²/α; · · 1−e²\] with f₁₁ = 1−e²+2x+2x³/3−2x²−4xe, f₁₃ = 1−e²−2xe,
//! f₂₂ = 4e−3−e²+2x. The numerators cancel for small x, where they are series ([`super::decay`]).

use super::linear::Linear;
use super::{Motion, decay};
use crate::model::state::GaussianState;

/// Of each coordinate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Singer {
    /// σ (m/s²), also that of the acceleration of a new track.
    pub maneuver_sigma_mps2: f64,
    /// τ.
    pub maneuver_time_s: f64,
}

impl<const N: usize> Motion<N> for Singer {
    type Step = Linear<N>;

    fn step(&self, dt_s: f64) -> Linear<N> {
        let (tau, variance) = (self.maneuver_time_s, self.maneuver_sigma_mps2.powi(2));
        let x = dt_s / tau;
        let (lag, lost) = (decay::lag(x), decay::lost(x));
        let change = [
            [1.0, dt_s, lag * tau.powi(2)],
            [0.0, 1.0, lost * tau],
            [0.0, 0.0, (-x).exp()],
        ];
        let q11 = decay::fifth_power(x) * tau.powi(4);
        let q12 = lag.powi(2) * tau.powi(3);
        let q13 = decay::third_power(x) * tau.powi(2);
        let q22 = decay::lag_of_squares(x) * tau.powi(2);
        let q23 = lost.powi(2) * tau;
        let q33 = decay::lost(2.0 * x);
        let noise = [[q11, q12, q13], [q12, q22, q23], [q13, q23, q33]];
        Linear::of_axes(&change, &noise.map(|row| row.map(|q| variance * q)))
    }

    #[inline]
    fn predict(step: &Linear<N>, belief: &mut GaussianState<N>) {
        step.predict(belief);
    }

    fn initial_sigma(&self) -> f64 {
        self.maneuver_sigma_mps2
    }

    fn rate_variance(&self, dt_s: f64) -> f64 {
        Motion::<N>::step(self, dt_s).rate_variance(N / 3, dt_s, self.maneuver_sigma_mps2)
    }
}
