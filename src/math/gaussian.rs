//! The Gaussian in two dimensions: squared distance, log-density, and the chi-square quantile of a gate.

use crate::model::state::{Position, PositionCovariance};
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// A covariance prepared for many distances: its inverse, and the constant of its log-density.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gaussian2 {
    /// S⁻¹ as `[xx, xy, yy]`.
    inverse: [f64; 3],
    /// −½ ln((2π)² det S).
    log_peak: f64,
}

impl Gaussian2 {
    /// `None` when the covariance is not positive definite.
    pub fn new(covariance: &PositionCovariance) -> Option<Self> {
        let (xx, xy, yy) = (covariance[(0, 0)], covariance[(0, 1)], covariance[(1, 1)]);
        let determinant = xx * yy - xy * xy;
        let is_definite = xx > 0.0 && determinant > 0.0 && determinant.is_finite();
        is_definite.then(|| Gaussian2 {
            inverse: [yy / determinant, -xy / determinant, xx / determinant],
            log_peak: -std::f64::consts::TAU.ln() - 0.5 * determinant.ln(),
        })
    }

    /// d² = νᵀ S⁻¹ ν.
    #[inline]
    pub fn squared_distance(&self, difference: &Position) -> f64 {
        let [xx, xy, yy] = self.inverse;
        let (x, y) = (difference[0], difference[1]);
        xx * x * x + 2.0 * xy * x * y + yy * y * y
    }

    /// ln N(ν; 0, S) for a difference with squared distance d².
    #[inline]
    pub fn log_density(&self, squared_distance: f64) -> f64 {
        self.log_peak - 0.5 * squared_distance
    }

    /// S⁻¹.
    pub fn inverse(&self) -> PositionCovariance {
        let [xx, xy, yy] = self.inverse;
        PositionCovariance::new(xx, xy, xy, yy)
    }
}

/// The d² below which a true detection falls with the given probability, for a measurement of `dimensions` numbers.
/// `probability` in (0, 1), `dimensions` at least 1.
pub fn gate_threshold(probability: f64, dimensions: u32) -> f64 {
    let chi_square = ChiSquared::new(f64::from(dimensions)).expect("a positive number of degrees of freedom is valid");
    chi_square.inverse_cdf(probability)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(left: f64, right: f64) -> bool {
        (left - right).abs() <= 1e-9 * right.abs().max(1.0)
    }

    #[test]
    fn distance_and_density_of_a_correlated_gaussian() {
        // S = [[4, 1], [1, 2]], det 7, S⁻¹ = [[2, -1], [-1, 4]] / 7; ν = (1, 2): d² = (2 - 4 + 16) / 7 = 2.
        let gaussian = Gaussian2::new(&PositionCovariance::new(4.0, 1.0, 1.0, 2.0)).unwrap();
        let squared = gaussian.squared_distance(&Position::new(1.0, 2.0));
        assert!(close(squared, 2.0));
        let expected = (-1.0f64).exp() / (std::f64::consts::TAU * 7f64.sqrt());
        assert!(close(gaussian.log_density(squared).exp(), expected));
    }

    #[test]
    fn a_singular_covariance_has_no_distance() {
        assert_eq!(Gaussian2::new(&PositionCovariance::new(1.0, 1.0, 1.0, 1.0)), None);
        assert_eq!(Gaussian2::new(&PositionCovariance::new(0.0, 0.0, 0.0, 1.0)), None);
    }

    #[test]
    fn gate_thresholds_of_two_dimensions_are_minus_two_ln_of_the_rest() {
        for probability in [0.5f64, 0.9, 0.99, 0.9999] {
            assert!(close(gate_threshold(probability, 2), -2.0 * (1.0 - probability).ln()), "{probability}");
        }
    }
}
