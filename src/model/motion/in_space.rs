//! Motion in space: what a model of the plane does in the horizontal, and beside it the vertical.
//!
//! # Symbols
//! State (x, y, z, vx, vy, vz) and what the model adds; F, Q transition and process noise over T; q_z density of the vertical.
//!
//! # Method
//! F and Q of the plane stand in the rows and columns of its variables, those of nearly constant velocity with q_z in those of z
//! and vz. Between the two there is nothing, so that steps compose where those of the plane do. Constant acceleration and
//! Singer's model need none of this: they are the same on three axes ([`Linear::of_axes`]), for what accelerates for long also
//! climbs so.

use super::Motion;
use super::constant_velocity::{ConstantVelocity, Step};
use super::linear::Linear;
use crate::model::state::GaussianState;
use nalgebra::{SMatrix, SVector};

/// x, y, vx, vy and a turn rate among the variables of space.
const HORIZONTAL: [usize; 5] = [0, 1, 3, 4, 6];
/// z and vz.
const VERTICAL: [usize; 2] = [2, 5];

/// Nearly constant velocity with one density in the horizontal and another in the vertical.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClimbingVelocity {
    pub horizontal: ConstantVelocity,
    pub vertical: ConstantVelocity,
}

impl Motion<6> for ClimbingVelocity {
    type Step = Step<6>;

    fn step(&self, dt_s: f64) -> Step<6> {
        let mut noise = self.horizontal.process_noise::<6>(dt_s);
        put(
            &mut noise,
            &VERTICAL,
            &self.vertical.process_noise::<2>(dt_s),
        );
        Step::new(dt_s, noise)
    }

    #[inline]
    fn predict(step: &Step<6>, belief: &mut GaussianState<6>) {
        ConstantVelocity::predict(step, belief);
    }

    /// Of the axis where it is larger.
    fn rate_variance(&self, dt_s: f64) -> f64 {
        let [horizontal, vertical] = [self.horizontal, self.vertical];
        Motion::<6>::rate_variance(&horizontal, dt_s)
            .max(Motion::<6>::rate_variance(&vertical, dt_s))
    }
}

/// F and Q of z and vz.
pub fn vertical_step(vertical: &ConstantVelocity, dt_s: f64) -> Linear<2> {
    Linear {
        transition: SMatrix::<f64, 2, 2>::new(1.0, dt_s, 0.0, 1.0),
        noise: vertical.process_noise(dt_s),
    }
}

/// F and Q of `H` variables of the plane beside those of the vertical, `N` = `H` + 2.
pub fn beside_vertical<const H: usize, const N: usize>(
    horizontal: &Linear<H>,
    vertical: &Linear<2>,
) -> Linear<N> {
    let mut whole = Linear {
        transition: SMatrix::zeros(),
        noise: SMatrix::zeros(),
    };
    put(&mut whole.transition, &HORIZONTAL, &horizontal.transition);
    put(&mut whole.noise, &HORIZONTAL, &horizontal.noise);
    put(&mut whole.transition, &VERTICAL, &vertical.transition);
    put(&mut whole.noise, &VERTICAL, &vertical.noise);
    whole
}

/// The `H` variables of the plane of a state in space.
pub fn horizontal_of<const H: usize, const N: usize>(
    belief: &GaussianState<N>,
) -> GaussianState<H> {
    let place = |variable: usize| HORIZONTAL[variable];
    GaussianState {
        mean: SVector::from_fn(|row, _| belief.mean[place(row)]),
        covariance: SMatrix::from_fn(|row, column| belief.covariance[(place(row), place(column))]),
    }
}

/// Variables of the plane where a state in space has them; the others are 0.
pub fn in_horizontal<const H: usize, const N: usize>(values: &SVector<f64, H>) -> SVector<f64, N> {
    let mut whole = SVector::zeros();
    for (row, value) in values.iter().enumerate() {
        whole[HORIZONTAL[row]] = *value;
    }
    whole
}

/// Writes `part` into the rows and columns at `places`.
fn put<const P: usize, const N: usize>(
    whole: &mut SMatrix<f64, N, N>,
    places: &[usize],
    part: &SMatrix<f64, P, P>,
) {
    for row in 0..P {
        for column in 0..P {
            whole[(places[row], places[column])] = part[(row, column)];
        }
    }
}
