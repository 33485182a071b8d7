//! A serpentine: constant speed, and a heading that swings around a course as a sine of time.
//!
//! # Reference
//! M. Abramowitz, I. A. Stegun, Handbook of Mathematical Functions, 1964, 9.1.42–9.1.45 (the expansion of C. G. J. Jacobi and
//! C. T. Anger) and 9.1.21 (Bessel functions as integrals).
//!
//! # Symbols
//! A amplitude of the heading (rad), T period, φ phase, θ = 2πt/T + φ; v speed; Jₙ Bessel functions of the first kind.
//!
//! # Method
//! Along the course the velocity is v cos(A sin θ) = v (J₀(A) + 2 Σ J₂ₖ(A) cos 2kθ), across it
//! v sin(A sin θ) = 2v Σ J₂ₖ₊₁(A) sin (2k+1)θ. Integrated term by term these are the places, exact at any time: for A ≤ π the
//! terms that are left out are below 1e-15 of the first.

use crate::model::state::Position;
use std::f64::consts::TAU;

/// J₀ … J₂₃.
const TERMS: usize = 24;

#[derive(Debug, Clone, PartialEq)]
pub(super) struct Weave {
    amplitude_rad: f64,
    period_s: f64,
    phase_rad: f64,
    bessel: [f64; TERMS],
}

impl Weave {
    pub fn new(amplitude_rad: f64, period_s: f64, phase_rad: f64) -> Self {
        Weave {
            amplitude_rad,
            period_s,
            phase_rad,
            bessel: std::array::from_fn(|order| bessel(order as f64, amplitude_rad)),
        }
    }

    /// Displacement since time 0, along and to the right of the course, per unit of speed (s).
    pub fn displacement_s(&self, time_s: f64) -> Position {
        let angle = |time_s: f64| TAU * time_s / self.period_s + self.phase_rad;
        let (from, to) = (angle(0.0), angle(time_s));
        let mut sum = Position::new(self.bessel[0] * (to - from), 0.0);
        for (order, factor) in self.bessel.iter().enumerate().skip(1) {
            let n = order as f64;
            if order % 2 == 0 {
                sum[0] += 2.0 * factor * ((n * to).sin() - (n * from).sin()) / n;
            } else {
                sum[1] += 2.0 * factor * ((n * from).cos() - (n * to).cos()) / n;
            }
        }
        sum * (self.period_s / TAU)
    }

    /// The heading relative to the course, clockwise.
    pub fn heading_rad(&self, time_s: f64) -> f64 {
        self.amplitude_rad * (TAU * time_s / self.period_s + self.phase_rad).sin()
    }
}

/// Jₙ(x) = 1/2π ∫ cos(nu − x sin u) du over a turn. For a periodic integrand the rule of equal steps is exact up to the terms
/// that 64 steps alias, J₆₄₋ₙ(x), which vanish for x ≤ π and n < 24.
fn bessel(order: f64, x: f64) -> f64 {
    const STEPS: u32 = 64;
    let value = |step: u32| {
        let u = TAU * f64::from(step) / f64::from(STEPS);
        (order * u - x * u.sin()).cos()
    };
    (0..STEPS).map(value).sum::<f64>() / f64::from(STEPS)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bessel_functions_are_those_of_the_tables() {
        // Abramowitz & Stegun, tables 9.1 and 9.2: J₀(1), J₁(1), J₂(1), J₀(3), J₁(3).
        for (order, x, value) in [
            (0.0, 1.0, 0.765_197_686_6),
            (1.0, 1.0, 0.440_050_585_7),
            (2.0, 1.0, 0.114_903_484_9),
            (0.0, 3.0, -0.260_051_954_9),
            (1.0, 3.0, 0.339_058_958_5),
        ] {
            assert!((bessel(order, x) - value).abs() < 1e-10, "J{order}({x})");
        }
    }

    #[test]
    fn places_are_the_integral_of_the_velocity() {
        for amplitude_rad in [0.5, 3.0] {
            let weave = Weave::new(amplitude_rad, 60.0, 0.7);
            // The midpoint rule with steps of 1 ms.
            let mut sum = Position::zeros();
            for step in 0..25_000 {
                let heading_rad = weave.heading_rad((f64::from(step) + 0.5) * 1e-3);
                sum += Position::new(heading_rad.cos(), heading_rad.sin()) * 1e-3;
            }
            assert!(
                (weave.displacement_s(25.0) - sum).norm() < 1e-7,
                "{amplitude_rad}"
            );
        }
    }
}
