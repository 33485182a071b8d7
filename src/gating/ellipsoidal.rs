//! The ellipsoidal gate: a detection is a track's candidate when its squared distance is at most γ, the chi-square
//! quantile of the gate probability P_G, so that a true detection falls inside with probability P_G.
//!
//! # Reference
//! Y. Bar-Shalom, X.-R. Li, Multitarget-Multisensor Tracking, 1995, section 2.3.2.

use super::grid::Grid;
use crate::math::gaussian::{Gaussian2, gate_threshold};
use crate::model::state::{Position, PositionCovariance};

/// The gate of a tracker, for position reports.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EllipsoidalGate {
    threshold: f64,
    /// ln(γ / 2).
    log_half_threshold: f64,
}

impl EllipsoidalGate {
    /// `probability` P_G in (0, 1).
    pub fn new(probability: f64) -> Self {
        let threshold = gate_threshold(probability, 2);
        EllipsoidalGate { threshold, log_half_threshold: (threshold / 2.0).ln() }
    }

    /// ln V of the gate around a Gaussian with covariance S: V = γ π √det S (m²).
    #[inline]
    pub fn log_volume_m2(&self, gaussian: &Gaussian2) -> f64 {
        // The density at the centre is 1 / (2π √det S).
        self.log_half_threshold - gaussian.log_density(0.0)
    }

    /// Calls `found(detection, d²)` for each position inside the gate around ẑ with innovation covariance S.
    #[inline]
    pub fn candidates(
        &self,
        grid: &Grid,
        positions: &[Position],
        centre_m: &Position,
        covariance: &PositionCovariance,
        gaussian: &Gaussian2,
        mut found: impl FnMut(u32, f64),
    ) {
        // The ellipse's bounding box reaches √(γ Sᵢᵢ) along axis i.
        let half_m = [(self.threshold * covariance[(0, 0)]).sqrt(), (self.threshold * covariance[(1, 1)]).sqrt()];
        grid.near(centre_m, half_m, |detection| {
            let squared = gaussian.squared_distance(&(positions[detection as usize] - centre_m));
            if squared <= self.threshold {
                found(detection, squared);
            }
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn the_volume_of_the_gate_is_that_of_an_ellipse() {
        // S = diag(16, 9) and γ = −2 ln 0.01: half axes 4√γ and 3√γ, V = 12 π γ.
        let gaussian = Gaussian2::new(&PositionCovariance::new(16.0, 0.0, 0.0, 9.0)).unwrap();
        let expected = 12.0 * std::f64::consts::PI * -2.0 * 0.01f64.ln();
        assert!((EllipsoidalGate::new(0.99).log_volume_m2(&gaussian).exp() - expected).abs() < 1e-9);
    }

    proptest! {
        #[test]
        fn the_gated_set_equals_that_of_brute_force(
            places in prop::collection::vec((-30.0..30.0f64, -30.0..30.0f64), 0..80),
            centre in (-40.0..40.0f64, -40.0..40.0f64),
            (xx, yy, correlation) in (0.1..200.0f64, 0.1..200.0f64, -0.95..0.95f64),
        ) {
            let positions: Vec<Position> = places.iter().map(|&(x, y)| Position::new(x, y)).collect();
            let centre = Position::new(centre.0, centre.1);
            let xy = correlation * (xx * yy).sqrt();
            let covariance = PositionCovariance::new(xx, xy, xy, yy);
            let gaussian = Gaussian2::new(&covariance).unwrap();
            let gate = EllipsoidalGate::new(0.99);
            let mut grid = Grid::default();
            grid.rebuild(&positions);
            let mut gated = Vec::new();
            gate.candidates(&grid, &positions, &centre, &covariance, &gaussian, |detection, _| gated.push(detection));
            gated.sort_unstable();
            let inside = |index: &u32| gaussian.squared_distance(&(positions[*index as usize] - centre)) <= -2.0 * 0.01f64.ln() + 1e-12;
            let brute: Vec<u32> = (0..positions.len() as u32).filter(inside).collect();
            prop_assert_eq!(gated, brute);
        }
    }
}
