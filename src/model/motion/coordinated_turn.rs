//! Coordinated turn of a known rate ω > 0 to the left (counter-clockwise), disturbed by white acceleration of spectral density q.
//!
//! # Reference
//! Y. Bar-Shalom, X.-R. Li, T. Kirubarajan, Estimation with Applications to Tracking and Navigation, 2001, section 11.7.
//!
//! # Symbols
//! x̂, P state (x, y, vx, vy) and covariance; F, Q transition and process noise over T; u = ωT.
//!
//! # Method
//! p ← p + T (a v + b v⊥), v ← v turned by u; v⊥ is v turned by 90° to the left, a = sin u / u, b = (1 − cos u) / u.
//! Q is that of a turn, ∫ F(s) diag(0, 0, q, q) F(s)ᵀ ds: 2q (u − sin u)/ω³ of a place, qT of a velocity, q (1 − cos u)/ω²
//! between them along an axis, and ± q (u − sin u)/ω² across. Without noise a turn of 0 is straight.

use super::Motion;
use super::linear::Linear;
use crate::model::state::GaussianState;
use nalgebra::Matrix4;

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CoordinatedTurn {
    /// ω.
    pub turn_rate_radps: f64,
    /// q (m²/s³).
    pub spectral_density: f64,
}

impl Motion<4> for CoordinatedTurn {
    type Step = Linear<4>;

    fn step(&self, dt_s: f64) -> Linear<4> {
        let arc = Arc::new(self.turn_rate_radps * dt_s);
        Linear {
            transition: arc.transition(dt_s),
            noise: arc.noise(self.spectral_density, dt_s),
        }
    }

    #[inline]
    fn predict(step: &Linear<4>, belief: &mut GaussianState<4>) {
        step.predict(belief);
    }

    fn rate_variance(&self, dt_s: f64) -> f64 {
        self.step(dt_s).rate_variance(2, dt_s, 0.0)
    }

    fn bend_mps(&self, speed_mps: f64, dt_s: f64) -> f64 {
        self.turn_rate_radps.abs() * speed_mps * dt_s
    }
}

/// What a turn by u does; all digits for any u, 0 too.
#[derive(Debug, Clone, Copy)]
pub(super) struct Arc {
    u: f64,
    pub sin: f64,
    pub cos: f64,
    /// sin u / u.
    pub along: f64,
    /// (1 − cos u) / u.
    pub across: f64,
    /// (1 − cos u) / u².
    pub half: f64,
    /// (u − sin u) / u³.
    pub sixth: f64,
}

impl Arc {
    #[inline]
    pub fn new(u: f64) -> Self {
        let (half_sin, half_cos) = (u / 2.0).sin_cos();
        let (sin, cos) = (2.0 * half_sin * half_cos, 1.0 - 2.0 * half_sin * half_sin);
        let half_along = if u == 0.0 { 1.0 } else { half_sin / (u / 2.0) };
        let half = half_along * half_along / 2.0;
        Arc {
            u,
            sin,
            cos,
            along: half_along * half_cos,
            across: half_sin * half_along,
            half,
            sixth: sixth(u, sin),
        }
    }

    #[inline]
    pub fn transition(&self, dt_s: f64) -> Matrix4<f64> {
        let (a, b) = (self.along * dt_s, self.across * dt_s);
        Matrix4::new(
            1.0, 0.0, a, -b, //
            0.0, 1.0, b, a, //
            0.0, 0.0, self.cos, -self.sin, //
            0.0, 0.0, self.sin, self.cos,
        )
    }

    /// Of white acceleration of spectral density q.
    #[inline]
    pub fn noise(&self, q: f64, dt_s: f64) -> Matrix4<f64> {
        let place = 2.0 * q * dt_s.powi(3) * self.sixth;
        let along = q * dt_s.powi(2) * self.half;
        let across = q * dt_s.powi(2) * self.u * self.sixth;
        let rate = q * dt_s;
        Matrix4::new(
            place, 0.0, along, across, //
            0.0, place, -across, along, //
            along, -across, rate, 0.0, //
            across, along, 0.0, rate,
        )
    }

    /// ∂a/∂u = (u cos u − sin u) / u².
    #[inline]
    pub fn along_slope(&self) -> f64 {
        self.u * self.sixth - self.across
    }

    /// ∂b/∂u = (u sin u − 1 + cos u) / u².
    #[inline]
    pub fn across_slope(&self) -> f64 {
        self.along - self.half
    }
}

/// (u − sin u)/u³, as a series where the difference cancels: Σ (−u²)ᵏ/(2k + 3)!.
#[inline]
fn sixth(u: f64, sin: f64) -> f64 {
    if u.abs() >= 0.5 {
        return (u - sin) / (u * u * u);
    }
    const INVERSE: [f64; 7] = [
        1.0 / 6.0,
        1.0 / 120.0,
        1.0 / 5_040.0,
        1.0 / 362_880.0,
        1.0 / 39_916_800.0,
        1.0 / 6_227_020_800.0,
        1.0 / 1_307_674_368_000.0,
    ];
    let square = -u * u;
    INVERSE
        .iter()
        .rev()
        .fold(0.0, |sum, inverse| sum * square + inverse)
}
