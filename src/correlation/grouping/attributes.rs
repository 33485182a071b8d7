//! What reports say besides places: any of several attributes, compared together.
//!
//! # Symbols
//! x_k attributes of report k with covariance R_k; p_i, P_i those that prediction i expects; ν difference, angles the shorter way
//! round; d² = νᵀ (R_k + P_i)⁻¹ ν. So each attribute counts in units of its own σ.

use crate::model::angle::wrap;
use nalgebra::DMatrix;

/// Attributes of one report, and how well they are known.
#[derive(Debug, Clone, PartialEq)]
pub struct Attributes {
    /// m values.
    pub values: Vec<f64>,
    /// m × m, positive definite.
    pub covariance: DMatrix<f64>,
}

/// The attributes of all reports of an instant and of all predictions, m each.
#[derive(Debug, Clone, Copy)]
pub struct Described<'a> {
    /// Which of the m go round at 2π (rad).
    pub angles: &'a [bool],
    pub reports: &'a [Attributes],
    /// Empty for groupers that use none.
    pub predictions: &'a [Attributes],
}

impl Described<'_> {
    /// d²; infinite where R + P is not positive definite.
    pub(super) fn squared_distance(&self, report: usize, prediction: usize) -> f64 {
        let (report, prediction) = (&self.reports[report], &self.predictions[prediction]);
        let mut factor = &report.covariance + &prediction.covariance;
        let mut sum = 0.0;
        let mut scaled = [0.0; super::MAX_ATTRIBUTES];
        // Cholesky's factor row by row, and the solution of L y = ν with it: d² = yᵀ y.
        for row in 0..self.angles.len() {
            let difference = report.values[row] - prediction.values[row];
            let mut rest = if self.angles[row] {
                wrap(difference)
            } else {
                difference
            };
            for column in 0..row {
                let inner: f64 = (0..column)
                    .map(|inner| factor[(row, inner)] * factor[(column, inner)])
                    .sum();
                factor[(row, column)] = (factor[(row, column)] - inner) / factor[(column, column)];
                rest -= factor[(row, column)] * scaled[column];
            }
            let known: f64 = (0..row).map(|inner| factor[(row, inner)].powi(2)).sum();
            let pivot = factor[(row, row)] - known;
            if pivot.is_nan() || pivot <= 0.0 {
                return f64::INFINITY;
            }
            factor[(row, row)] = pivot.sqrt();
            scaled[row] = rest / factor[(row, row)];
            sum += scaled[row] * scaled[row];
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_of_tied_attributes_and_of_angles_by_hand() {
        // R + P = ((4, 2), (2, 5)), ν = (2, 3): inverse ((5, −2), (−2, 4)) / 16, d² = (20 − 24 + 36) / 16 = 2. The angle is
        // 0.1 + 0.1 across north with σ² = ½ + ½: 0.04 more.
        let of = |values: [f64; 3], covariance: [f64; 9]| Attributes {
            values: values.to_vec(),
            covariance: DMatrix::from_row_slice(3, 3, &covariance),
        };
        let report = of(
            [7.0, 5.0, 0.1],
            [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.5],
        );
        let north = std::f64::consts::TAU - 0.1;
        let prediction = of(
            [5.0, 2.0, north],
            [3.0, 2.0, 0.0, 2.0, 4.0, 0.0, 0.0, 0.0, 0.5],
        );
        let described = Described {
            angles: &[false, false, true],
            reports: &[report],
            predictions: &[prediction],
        };
        assert!((described.squared_distance(0, 0) - 2.04).abs() < 1e-12);
    }
}
