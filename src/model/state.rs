//! The kinematic state of a target: position and velocity in the plane, with its covariance.

use nalgebra::{SMatrix, SVector};

/// `[x_m, y_m, vx_mps, vy_mps]`; x points east, y north.
pub type State = SVector<f64, 4>;
/// Covariance of [`State`], in the same order and the products of its units.
pub type Covariance = SMatrix<f64, 4, 4>;
/// A position `[x_m, y_m]`.
pub type Position = SVector<f64, 2>;
/// Covariance of a [`Position`] (m²).
pub type PositionCovariance = SMatrix<f64, 2, 2>;

/// A Gaussian belief about a target's state: coordinates, then their rates in the same order.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GaussianState<const N: usize = 4> {
    pub mean: SVector<f64, N>,
    pub covariance: SMatrix<f64, N, N>,
}

impl<const N: usize> GaussianState<N> {
    /// Of the first `K` variables alone.
    #[inline(always)]
    pub fn leading<const K: usize>(&self) -> GaussianState<K> {
        GaussianState {
            mean: self.mean.fixed_rows::<K>(0).into_owned(),
            covariance: self.covariance.fixed_view::<K, K>(0, 0).into_owned(),
        }
    }

    /// Appends the mean, then the upper triangle of the covariance: [`packed_len`] numbers.
    #[inline]
    pub fn pack_into(&self, packed: &mut Vec<f64>) {
        packed.extend_from_slice(self.mean.as_slice());
        for row in 0..N {
            for column in row..N {
                packed.push(self.covariance[(row, column)]);
            }
        }
    }

    /// What [`GaussianState::pack_into`] wrote; `None` for another number of values.
    pub fn unpacked(packed: &[f64]) -> Option<Self> {
        if packed.len() != packed_len(N) {
            return None;
        }
        let mut covariance = SMatrix::zeros();
        let mut rest = packed[N..].iter();
        for row in 0..N {
            for (column, &element) in (row..N).zip(rest.by_ref()) {
                covariance[(row, column)] = element;
                covariance[(column, row)] = element;
            }
        }
        Some(GaussianState {
            mean: SVector::from_column_slice(&packed[..N]),
            covariance,
        })
    }
}

/// How many numbers a state of so many variables is packed into.
pub const fn packed_len(variables: usize) -> usize {
    variables + variables * (variables + 1) / 2
}

/// Copies the upper triangle below the diagonal, so that rounding never makes P unsymmetric.
#[inline]
pub fn mirror<const N: usize>(covariance: &mut SMatrix<f64, N, N>) {
    for row in 1..N {
        for column in 0..row {
            covariance[(row, column)] = covariance[(column, row)];
        }
    }
}

/// Row and column of each element of the upper triangle, in the order of the CSV columns
/// `p_xx, p_xy, p_xvx, p_xvy, p_yy, p_yvx, p_yvy, p_vxvx, p_vxvy, p_vyvy`.
pub const UPPER_TRIANGLE: [(usize, usize); 10] = [
    (0, 0),
    (0, 1),
    (0, 2),
    (0, 3),
    (1, 1),
    (1, 2),
    (1, 3),
    (2, 2),
    (2, 3),
    (3, 3),
];

/// The ten elements of the upper triangle of a symmetric covariance.
pub fn upper_triangle(covariance: &Covariance) -> [f64; 10] {
    UPPER_TRIANGLE.map(|(row, column)| covariance[(row, column)])
}

/// The symmetric covariance with this upper triangle.
pub fn from_upper_triangle(elements: &[f64; 10]) -> Covariance {
    let mut covariance = Covariance::zeros();
    for (&(row, column), &element) in UPPER_TRIANGLE.iter().zip(elements) {
        covariance[(row, column)] = element;
        covariance[(column, row)] = element;
    }
    covariance
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_state_of_any_size_comes_back_from_its_packed_form() {
        let bearing = GaussianState {
            mean: SVector::<f64, 2>::new(1.0, 2.0),
            covariance: SMatrix::<f64, 2, 2>::new(3.0, 4.0, 4.0, 5.0),
        };
        let mut packed = Vec::new();
        bearing.pack_into(&mut packed);
        assert_eq!(packed, [1.0, 2.0, 3.0, 4.0, 5.0]);
        assert_eq!(GaussianState::unpacked(&packed), Some(bearing));
        assert_eq!(GaussianState::<4>::unpacked(&packed), None);
    }

    #[test]
    fn a_covariance_comes_back_from_its_upper_triangle() {
        let elements = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0];
        let covariance = from_upper_triangle(&elements);
        assert_eq!(covariance, covariance.transpose());
        assert_eq!(upper_triangle(&covariance), elements);
    }
}
