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
            mean: SVector::from_fn(|row, _| self.mean[row]),
            covariance: SMatrix::from_fn(|row, column| self.covariance[(row, column)]),
        }
    }

    /// As it is after `dt_s`, or before where that is below 0, in which the first `K` variables, coordinates and their rates, go on
    /// as they are.
    #[inline(always)]
    #[must_use]
    pub fn coasted<const K: usize>(&self, dt_s: f64) -> Self {
        let mut coasted = *self;
        for axis in 0..K / 2 {
            coasted.mean[axis] += dt_s * coasted.mean[axis + K / 2];
            for column in 0..N {
                let rate = coasted.covariance[(axis + K / 2, column)];
                coasted.covariance[(axis, column)] += dt_s * rate;
            }
        }
        for axis in 0..K / 2 {
            for row in 0..N {
                let rate = coasted.covariance[(row, axis + K / 2)];
                coasted.covariance[(row, axis)] += dt_s * rate;
            }
        }
        coasted
    }

    /// What [`GaussianState::pack_into`] wrote; `None` for another number of values.
    pub fn unpacked(packed: &[f64]) -> Option<Self> {
        (packed.len() == packed_len(N)).then(|| GaussianState {
            mean: SVector::from_column_slice(&packed[..N]),
            covariance: from_upper_triangle(&packed[N..]),
        })
    }

    /// Appends the mean, then the upper triangle of the covariance: [`packed_len`] numbers.
    #[inline]
    pub fn pack_into(&self, packed: &mut Vec<f64>) {
        packed.extend_from_slice(self.mean.as_slice());
        push_upper_triangle(&self.covariance, packed);
    }
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

/// How many numbers a state of so many variables is packed into.
pub const fn packed_len(variables: usize) -> usize {
    variables + variables * (variables + 1) / 2
}

#[inline]
fn push_upper_triangle<const N: usize>(matrix: &SMatrix<f64, N, N>, elements: &mut Vec<f64>) {
    for row in 0..N {
        for column in row..N {
            elements.push(matrix[(row, column)]);
        }
    }
}

/// The upper triangle of a covariance, row by row: tracks are long, and the rest says nothing new. Small ones lie in place,
/// for memory asked for by each point of a track costs more than it holds.
#[derive(Debug, Clone, PartialEq)]
pub enum Packed {
    Three([f64; 3]),
    Ten([f64; 10]),
    Many(Box<[f64]>),
}

impl From<&[f64]> for Packed {
    fn from(elements: &[f64]) -> Self {
        if let Ok(three) = elements.try_into() {
            Packed::Three(three)
        } else if let Ok(ten) = elements.try_into() {
            Packed::Ten(ten)
        } else {
            Packed::Many(elements.into())
        }
    }
}

impl std::ops::Deref for Packed {
    type Target = [f64];
    fn deref(&self) -> &[f64] {
        match self {
            Packed::Three(elements) => elements,
            Packed::Ten(elements) => elements,
            Packed::Many(elements) => elements,
        }
    }
}

/// The upper triangle of a symmetric matrix.
pub fn upper_triangle<const N: usize>(matrix: &SMatrix<f64, N, N>) -> Packed {
    let mut elements = Vec::with_capacity(packed_len(N) - N);
    push_upper_triangle(matrix, &mut elements);
    elements.as_slice().into()
}

/// The symmetric matrix with this upper triangle of N(N + 1)/2 elements.
pub fn from_upper_triangle<const N: usize>(elements: &[f64]) -> SMatrix<f64, N, N> {
    let mut matrix = SMatrix::zeros();
    let mut rest = elements.iter();
    for row in 0..N {
        for (column, &element) in (row..N).zip(rest.by_ref()) {
            matrix[(row, column)] = element;
            matrix[(column, row)] = element;
        }
    }
    matrix
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_state_of_any_size_is_packed_into_its_mean_and_upper_triangle() {
        let bearing = GaussianState {
            mean: SVector::<f64, 2>::new(1.0, 2.0),
            covariance: SMatrix::<f64, 2, 2>::new(3.0, 4.0, 4.0, 5.0),
        };
        let mut packed = vec![0.0];
        bearing.pack_into(&mut packed);
        assert_eq!(packed, [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
        assert_eq!(GaussianState::unpacked(&packed[1..]), Some(bearing));
        assert_eq!(GaussianState::<4>::unpacked(&packed[1..]), None);
        let volume = GaussianState::<6> {
            mean: SVector::zeros(),
            covariance: SMatrix::identity(),
        };
        volume.pack_into(&mut packed);
        assert_eq!(packed.len(), 1 + packed_len(2) + packed_len(6));
    }

    #[test]
    fn a_covariance_comes_back_from_its_upper_triangle() {
        let elements = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0];
        let covariance: Covariance = from_upper_triangle(&elements);
        assert_eq!(covariance, covariance.transpose());
        assert_eq!(covariance[(1, 3)], 7.0);
        assert_eq!(*upper_triangle(&covariance), elements);
    }
}
