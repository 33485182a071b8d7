//! What a Gaussian belief expects of a report, and the two ways to find it: along a line, and by points.

use super::unscented::Unscented;
use crate::math::gaussian::Gaussian;
use crate::model::sensing::Sensing;
use crate::model::state::GaussianState;
use nalgebra::{SMatrix, SVector};

/// Where a report of `D` values is expected.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Expected<const D: usize> {
    /// ẑ.
    pub measurement: SVector<f64, D>,
    /// S.
    pub covariance: SMatrix<f64, D, D>,
    /// S⁻¹ and ln of the density at ẑ.
    pub gaussian: Gaussian<D>,
}

impl<const D: usize> Expected<D> {
    /// As a gate knows it: ẑ, S and what is made of S.
    pub fn as_region(&self) -> (&SVector<f64, D>, &SMatrix<f64, D, D>, &Gaussian<D>) {
        (&self.measurement, &self.covariance, &self.gaussian)
    }
}

/// What makes a change of `N` state variables of an innovation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gain<const N: usize, const D: usize> {
    /// K.
    gain: SMatrix<f64, N, D>,
    /// C.
    cross: SMatrix<f64, N, D>,
}

impl<const N: usize, const D: usize> Gain<N, D> {
    /// K ν.
    #[inline(always)]
    pub fn change(&self, innovation: &SVector<f64, D>) -> SVector<f64, N> {
        self.gain * innovation
    }

    /// That of the state after `dt_s`, or before where that is below 0, in which the first `M` variables, coordinates and their
    /// rates, go on as they are.
    #[inline(always)]
    pub fn coasted<const M: usize>(mut self, dt_s: f64) -> Self {
        for axis in 0..M / 2 {
            for column in 0..D {
                self.gain[(axis, column)] += dt_s * self.gain[(axis + M / 2, column)];
                self.cross[(axis, column)] += dt_s * self.cross[(axis + M / 2, column)];
            }
        }
        self
    }

    /// The same for a state of more variables, which the others do not touch.
    #[inline(always)]
    pub fn widened<const M: usize>(&self) -> Gain<M, D> {
        let mut wide = Gain {
            gain: SMatrix::zeros(),
            cross: SMatrix::zeros(),
        };
        for column in 0..D {
            for row in 0..N {
                wide.gain[(row, column)] = self.gain[(row, column)];
                wide.cross[(row, column)] = self.cross[(row, column)];
            }
        }
        wide
    }

    /// K S Kᵀ.
    #[inline(always)]
    pub fn loss(&self) -> SMatrix<f64, N, N> {
        self.gain * self.cross.transpose()
    }
}

/// ẑ, S and C as what is expected; `None` when S is not positive definite.
#[inline(always)]
pub fn expected<const N: usize, const D: usize>(
    measurement: SVector<f64, D>,
    covariance: SMatrix<f64, D, D>,
    cross: SMatrix<f64, N, D>,
) -> Option<(Expected<D>, Gain<N, D>)> {
    let gaussian = Gaussian::new(&covariance)?;
    let gain = Gain {
        gain: cross * gaussian.inverse(),
        cross,
    };
    let expected = Expected {
        measurement,
        covariance,
        gaussian,
    };
    Some((expected, gain))
}

/// A way of a belief through a sensing model. Of `N` state variables the first `K` are the kinematics that are sensed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Way {
    /// Along the tangent at x̂; exact where the report is linear in the state.
    Line,
    Points(Unscented),
}

impl Way {
    #[inline(always)]
    pub fn expect<S: Sensing<K, D>, const N: usize, const K: usize, const D: usize>(
        &self,
        belief: &GaussianState<N>,
        sensing: &S,
    ) -> Option<(Expected<D>, Gain<N, D>)> {
        if S::IS_DIRECT {
            return direct(belief, sensing);
        }
        match self {
            Way::Line => super::extended::expect(belief, sensing),
            Way::Points(unscented) => unscented.expect(belief, sensing),
        }
    }
}

/// Of a report of the first `D` variables: S = P + R and C = P, cut to those.
#[inline(always)]
fn direct<S: Sensing<K, D>, const N: usize, const K: usize, const D: usize>(
    belief: &GaussianState<N>,
    sensing: &S,
) -> Option<(Expected<D>, Gain<N, D>)> {
    let kinematics = belief.leading::<K>();
    expected(
        sensing.project(&kinematics.mean),
        belief.covariance.fixed_view::<D, D>(0, 0) + sensing.noise(&kinematics),
        belief.covariance.fixed_columns::<D>(0).into_owned(),
    )
}
