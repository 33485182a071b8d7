//! The Gaussian in one to three dimensions: squared distance, log-density, and the chi-square quantile of a gate.

use nalgebra::{Cholesky, SMatrix, SVector};
use statrs::distribution::{ChiSquared, ContinuousCDF, Normal};

/// A covariance prepared for many distances: its inverse, and the constant of its log-density.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gaussian<const D: usize> {
    /// S⁻¹.
    inverse: SMatrix<f64, D, D>,
    /// −½ ln((2π)ᴰ det S).
    log_peak: f64,
}

impl<const D: usize> Gaussian<D> {
    /// `None` when the covariance is not positive definite.
    #[inline(always)]
    pub fn new(covariance: &SMatrix<f64, D, D>) -> Option<Self> {
        let (inverse, determinant) = if D == 2 {
            inverse_of_two(covariance)
        } else {
            inverse_of_any(covariance)
        }?;
        Some(Gaussian {
            inverse,
            log_peak: -0.5 * D as f64 * std::f64::consts::TAU.ln() - 0.5 * determinant.ln(),
        })
    }

    /// d² = νᵀ S⁻¹ ν.
    #[inline]
    pub fn squared_distance(&self, difference: &SVector<f64, D>) -> f64 {
        let mut sum = 0.0;
        for row in 0..D {
            sum += self.inverse[(row, row)] * difference[row] * difference[row];
            for column in row + 1..D {
                sum += 2.0 * self.inverse[(row, column)] * difference[row] * difference[column];
            }
        }
        sum
    }

    /// ln N(ν; 0, S) for a difference with squared distance d².
    #[inline]
    pub fn log_density(&self, squared_distance: f64) -> f64 {
        self.log_peak - 0.5 * squared_distance
    }

    /// S⁻¹.
    #[inline]
    pub fn inverse(&self) -> &SMatrix<f64, D, D> {
        &self.inverse
    }
}

/// Inverse and determinant of a 2 × 2 covariance, the case that every radar scan needs thousands of times.
#[inline(always)]
fn inverse_of_two<const D: usize>(
    covariance: &SMatrix<f64, D, D>,
) -> Option<(SMatrix<f64, D, D>, f64)> {
    let (xx, xy, yy) = (covariance[(0, 0)], covariance[(0, 1)], covariance[(1, 1)]);
    let determinant = xx * yy - xy * xy;
    let mut inverse = SMatrix::zeros();
    inverse[(0, 0)] = yy / determinant;
    inverse[(0, 1)] = -xy / determinant;
    inverse[(1, 0)] = -xy / determinant;
    inverse[(1, 1)] = xx / determinant;
    (xx > 0.0 && determinant > 0.0 && determinant.is_finite()).then_some((inverse, determinant))
}

/// The same for any size, by Cholesky's decomposition.
fn inverse_of_any<const D: usize>(
    covariance: &SMatrix<f64, D, D>,
) -> Option<(SMatrix<f64, D, D>, f64)> {
    let decomposed = Cholesky::new(*covariance)?;
    let determinant = decomposed.determinant();
    (determinant > 0.0 && determinant.is_finite()).then(|| (decomposed.inverse(), determinant))
}

/// ln of the volume of the unit ball in `D` dimensions: π^(D/2) / Γ(D/2 + 1).
pub fn log_unit_ball(dimensions: u32) -> f64 {
    let half = f64::from(dimensions) / 2.0;
    half * std::f64::consts::PI.ln() - statrs::function::gamma::ln_gamma(half + 1.0)
}

/// The d² below which a true detection falls with the given probability, for a measurement of `dimensions` numbers.
/// `probability` in (0, 1], infinite for 1; `dimensions` at least 1.
pub fn gate_threshold(probability: f64, dimensions: u32) -> f64 {
    if probability >= 1.0 {
        return f64::INFINITY;
    }
    chi_square_quantile(probability, f64::from(dimensions))
}

/// The value below which a chi-square variable falls with the given probability in (0, 1). Beyond 1000 degrees of freedom,
/// where search is slow, by E. B. Wilson and M. M. Hilferty's cube (1931), whose error there is below 1e-6 of the value.
pub fn chi_square_quantile(probability: f64, degrees_of_freedom: f64) -> f64 {
    if degrees_of_freedom > 1000.0 {
        let ninth = 2.0 / (9.0 * degrees_of_freedom);
        let normal = Normal::standard().inverse_cdf(probability);
        return degrees_of_freedom * (1.0 - ninth + normal * ninth.sqrt()).powi(3);
    }
    let chi_square = ChiSquared::new(degrees_of_freedom)
        .expect("a positive number of degrees of freedom is valid");
    chi_square.inverse_cdf(probability)
}

/// The probability that a chi-square variable is above a value: the p-value of a sum of squared distances.
pub fn chi_square_tail(value: f64, degrees_of_freedom: f64) -> f64 {
    ChiSquared::new(degrees_of_freedom)
        .expect("a positive number of degrees of freedom is valid")
        .sf(value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::state::{Position, PositionCovariance};
    use nalgebra::{Matrix1, Matrix3, Vector1, Vector3};

    fn close(left: f64, right: f64) -> bool {
        (left - right).abs() <= 1e-9 * right.abs().max(1.0)
    }

    #[test]
    fn distance_and_density_of_a_correlated_gaussian() {
        // S = [[4, 1], [1, 2]], det 7, S⁻¹ = [[2, -1], [-1, 4]] / 7; ν = (1, 2): d² = (2 - 4 + 16) / 7 = 2.
        let gaussian = Gaussian::new(&PositionCovariance::new(4.0, 1.0, 1.0, 2.0)).unwrap();
        let squared = gaussian.squared_distance(&Position::new(1.0, 2.0));
        assert!(close(squared, 2.0));
        let expected = (-1.0f64).exp() / (std::f64::consts::TAU * 7f64.sqrt());
        assert!(close(gaussian.log_density(squared).exp(), expected));
    }

    #[test]
    fn a_singular_covariance_has_no_distance() {
        assert_eq!(
            Gaussian::new(&PositionCovariance::new(1.0, 1.0, 1.0, 1.0)),
            None
        );
        assert_eq!(
            Gaussian::new(&PositionCovariance::new(0.0, 0.0, 0.0, 1.0)),
            None
        );
    }

    #[test]
    fn one_and_three_dimensions_agree_with_the_textbook() {
        // σ = 3, ν = 6: d² = 4; density exp(−2) / (3 √(2π)).
        let line = Gaussian::new(&Matrix1::new(9.0)).unwrap();
        assert!(close(line.squared_distance(&Vector1::new(6.0)), 4.0));
        assert!(close(
            line.log_density(4.0).exp(),
            (-2.0f64).exp() / (3.0 * std::f64::consts::TAU.sqrt())
        ));
        // The correlated block above beside an independent σ² = 5, ν₃ = 5: d² = 2 + 5, det = 35.
        let space =
            Gaussian::new(&Matrix3::new(4.0, 1.0, 0.0, 1.0, 2.0, 0.0, 0.0, 0.0, 5.0)).unwrap();
        let squared = space.squared_distance(&Vector3::new(1.0, 2.0, 5.0));
        assert!(close(squared, 7.0));
        assert!(close(
            space.log_density(squared),
            -3.5 - 1.5 * std::f64::consts::TAU.ln() - 0.5 * 35f64.ln()
        ));
    }

    #[test]
    fn unit_balls_are_a_segment_a_disc_and_a_ball() {
        let pi = std::f64::consts::PI;
        for (dimensions, volume) in [(1, 2.0), (2, pi), (3, 4.0 * pi / 3.0)] {
            assert!(
                close(log_unit_ball(dimensions).exp(), volume),
                "{dimensions}"
            );
        }
    }

    #[test]
    fn gate_thresholds_of_two_dimensions_are_minus_two_ln_of_the_rest() {
        for probability in [0.5f64, 0.9, 0.99, 0.9999] {
            assert!(
                close(
                    gate_threshold(probability, 2),
                    -2.0 * (1.0 - probability).ln()
                ),
                "{probability}"
            );
        }
        assert_eq!(
            [1, 2, 3].map(|dimensions| gate_threshold(1.0, dimensions)),
            [f64::INFINITY; 3]
        );
    }

    #[test]
    fn the_tail_is_what_lies_beyond_a_quantile() {
        for (probability, degrees) in [(0.99, 2.0), (0.5, 4.0), (0.999, 80.0)] {
            assert!(close(
                chi_square_tail(chi_square_quantile(probability, degrees), degrees),
                1.0 - probability
            ));
        }
        // Two degrees of freedom: exp(−d²/2).
        assert!(close(chi_square_tail(3.0, 2.0), (-1.5f64).exp()));
    }

    #[test]
    fn quantiles_beyond_the_search_continue_those_within_it() {
        // Tables: χ²(100, 0.975) = 129.5612, χ²(1000, 0.025) = 914.257, χ²(1000, 0.975) = 1089.531.
        for (probability, degrees, value) in [
            (0.975, 100.0, 129.5612),
            (0.025, 1000.0, 914.2572),
            (0.975, 1000.0, 1089.5309),
        ] {
            assert!(
                (chi_square_quantile(probability, degrees) - value).abs() < 1e-3,
                "{probability} {degrees}"
            );
            let step = chi_square_quantile(probability, degrees * 1.000001)
                - chi_square_quantile(probability, degrees);
            assert!(step.abs() < 3e-3, "{probability} {degrees}: {step}");
        }
    }
}
