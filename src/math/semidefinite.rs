//! Covariances that may be singular, as of a state that a motion without noise leads to: solved as far as they say anything.

use nalgebra::{SMatrix, SVector};

/// A pivot below this share of its diagonal element is rounding.
const LEAST_PIVOT: f64 = 1e-13;

/// L of A = L Lᵀ, by Cholesky's decomposition. Where a pivot is 0 the variable is certain given those before it, and its column
/// stays 0: of a positive semidefinite matrix the whole rest of that column is 0, too.
#[derive(Debug, Clone, Copy)]
pub struct Factor<const N: usize> {
    lower: SMatrix<f64, N, N>,
}

impl<const N: usize> Factor<N> {
    pub fn new(matrix: &SMatrix<f64, N, N>) -> Self {
        let mut lower = SMatrix::<f64, N, N>::zeros();
        for column in 0..N {
            let mut pivot = matrix[(column, column)];
            for before in 0..column {
                pivot -= lower[(column, before)].powi(2);
            }
            if pivot.is_nan() || pivot <= LEAST_PIVOT * matrix[(column, column)] {
                continue;
            }
            let root = pivot.sqrt();
            lower[(column, column)] = root;
            for row in column + 1..N {
                let mut rest = matrix[(row, column)];
                for before in 0..column {
                    rest -= lower[(row, before)] * lower[(column, before)];
                }
                lower[(row, column)] = rest / root;
            }
        }
        Factor { lower }
    }

    /// An x with A x = b, where there is one: of variables that are certain it is 0.
    pub fn solve(&self, right: &SVector<f64, N>) -> SVector<f64, N> {
        let mut solution = self.forward(right);
        for row in (0..N).rev() {
            let pivot = self.lower[(row, row)];
            for below in row + 1..N {
                solution[row] -= self.lower[(below, row)] * solution[below];
            }
            solution[row] = if pivot > 0.0 {
                solution[row] / pivot
            } else {
                0.0
            };
        }
        solution
    }

    /// L⁻¹ b.
    fn forward(&self, right: &SVector<f64, N>) -> SVector<f64, N> {
        let mut solution = *right;
        for row in 0..N {
            let pivot = self.lower[(row, row)];
            for before in 0..row {
                solution[row] -= self.lower[(row, before)] * solution[before];
            }
            solution[row] = if pivot > 0.0 {
                solution[row] / pivot
            } else {
                0.0
            };
        }
        solution
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Matrix2, Matrix3, Vector2, Vector3};

    #[test]
    fn a_regular_matrix_is_solved() {
        let matrix = Matrix3::new(4.0, 2.0, -1.0, 2.0, 5.0, 0.5, -1.0, 0.5, 3.0);
        let (factor, right) = (Factor::new(&matrix), Vector3::new(1.0, -2.0, 0.5));
        let residual = matrix * factor.solve(&right) - right;
        assert!(residual.abs().max() < 1e-14);
    }

    /// The second variable is twice the first.
    #[test]
    fn what_is_certain_given_the_rest_is_left_out() {
        let factor = Factor::new(&Matrix2::new(9.0, 18.0, 18.0, 36.0));
        let solution = factor.solve(&Vector2::new(9.0, 18.0));
        assert!((solution - Vector2::new(1.0, 0.0)).abs().max() < 1e-15);
        let nothing = Factor::new(&Matrix2::zeros());
        assert_eq!(nothing.solve(&Vector2::zeros()), Vector2::zeros());
    }
}
