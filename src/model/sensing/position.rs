//! Positions in the plane: h(x) = (x, y).

use super::Sensing;
use crate::model::own::Own;
use crate::model::scan::Measurement;
use crate::model::state::{Covariance, GaussianState, Position, PositionCovariance, State};
use nalgebra::{SMatrix, SVector};

/// Reports of positions, with the covariance of their noise (m²).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Positions {
    noise: PositionCovariance,
}

impl Positions {
    pub fn new(sigma_x_m: f64, sigma_y_m: f64) -> Self {
        Positions {
            noise: PositionCovariance::new(sigma_x_m * sigma_x_m, 0.0, 0.0, sigma_y_m * sigma_y_m),
        }
    }
}

impl Sensing<4, 2> for Positions {
    const IS_DIRECT: bool = true;

    fn read(&self, report: &Measurement, _own: &Own) -> Option<Position> {
        report.position()
    }

    #[inline(always)]
    fn project(&self, mean: &State) -> Position {
        Position::new(mean[0], mean[1])
    }

    fn jacobian(&self, _belief: &GaussianState) -> SMatrix<f64, 2, 4> {
        SMatrix::identity()
    }

    #[inline(always)]
    fn noise(&self, _belief: &GaussianState) -> PositionCovariance {
        self.noise
    }

    fn with_own(&self, own: &Own) -> Self {
        let sigma = |axis: usize, own: Option<f64>| own.unwrap_or(self.noise[(axis, axis)].sqrt());
        let mut noisy =
            Positions::new(sigma(0, own.noise.sigma_x_m), sigma(1, own.noise.sigma_y_m));
        let correlation = own.noise.correlation_xy.unwrap_or(0.0);
        let mixed = correlation * (noisy.noise[(0, 0)] * noisy.noise[(1, 1)]).sqrt();
        (noisy.noise[(0, 1)], noisy.noise[(1, 0)]) = (mixed, mixed);
        noisy
    }

    fn locate(&self, report: &SVector<f64, 2>, rate_sigma: f64) -> Option<GaussianState> {
        Some(at_rest(report, &self.noise, rate_sigma))
    }
}

/// At a position, with velocity 0 ± `speed_sigma_mps` on each axis.
pub(super) fn at_rest(
    position_m: &Position,
    noise: &PositionCovariance,
    speed_sigma_mps: f64,
) -> GaussianState {
    let mut covariance = Covariance::zeros();
    covariance.fixed_view_mut::<2, 2>(0, 0).copy_from(noise);
    covariance[(2, 2)] = speed_sigma_mps * speed_sigma_mps;
    covariance[(3, 3)] = speed_sigma_mps * speed_sigma_mps;
    GaussianState {
        mean: State::new(position_m[0], position_m[1], 0.0, 0.0),
        covariance,
    }
}
