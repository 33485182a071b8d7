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

/// A [`GaussianState`] of up to four variables: its mean, then the upper triangle of its covariance row by row. A history
/// is long, and the rest of a covariance says nothing new.
pub type PackedState = [f64; 14];

impl<const N: usize> GaussianState<N> {
    #[inline]
    pub fn pack(&self) -> PackedState {
        const { assert!(N <= 4, "a packed state has room for four variables") };
        let mut packed = [0.0; 14];
        packed[..N].copy_from_slice(self.mean.as_slice());
        for (place, (row, column)) in upper_triangle_places(N).enumerate() {
            packed[N + place] = self.covariance[(row, column)];
        }
        packed
    }

    pub fn unpack(packed: &PackedState) -> Self {
        let mut covariance = SMatrix::zeros();
        for (place, (row, column)) in upper_triangle_places(N).enumerate() {
            covariance[(row, column)] = packed[N + place];
            covariance[(column, row)] = packed[N + place];
        }
        GaussianState {
            mean: SVector::from_column_slice(&packed[..N]),
            covariance,
        }
    }
}

/// Row and column of each element of the upper triangle of an `order` × `order` matrix, row by row.
fn upper_triangle_places(order: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..order).flat_map(move |row| (row..order).map(move |column| (row, column)))
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
        assert_eq!(bearing.pack()[..6], [1.0, 2.0, 3.0, 4.0, 5.0, 0.0]);
        assert_eq!(GaussianState::unpack(&bearing.pack()), bearing);
        let elements = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0];
        let plane = GaussianState {
            mean: State::new(-1.0, -2.0, -3.0, -4.0),
            covariance: from_upper_triangle(&elements),
        };
        assert_eq!(plane.pack()[4..], elements);
        assert_eq!(GaussianState::unpack(&plane.pack()), plane);
    }

    #[test]
    fn a_covariance_comes_back_from_its_upper_triangle() {
        let elements = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0];
        let covariance = from_upper_triangle(&elements);
        assert_eq!(covariance, covariance.transpose());
        assert_eq!(upper_triangle(&covariance), elements);
    }
}
