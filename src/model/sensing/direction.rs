//! Bearings of targets of which only the direction is known: the state is a bearing and its rate, and h(x) = β.

use super::{Bearing, Sensing};
use crate::model::angle::wrap;
use crate::model::own::Own;
use crate::model::scan::Measurement;
use crate::model::state::GaussianState;
use nalgebra::{Matrix1, Matrix1x2, Matrix2, Vector1, Vector2};

/// The reports of a sensor of bearings, as directions. Ranges that come with them say nothing of directions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Direction(pub Bearing);

impl Direction {
    fn variance(&self, bearing_rad: f64) -> f64 {
        self.0.widened(bearing_rad).powi(2)
    }
}

impl Sensing<2, 1> for Direction {
    const ANGLE: Option<usize> = Some(0);
    const IS_DIRECT: bool = true;

    fn read(&self, report: &Measurement, _own: &Own) -> Option<Vector1<f64>> {
        match *report {
            Measurement::Bearing { bearing_rad }
            | Measurement::RangeBearing { bearing_rad, .. }
            | Measurement::BearingElevation { bearing_rad, .. }
            | Measurement::RangeBearingElevation { bearing_rad, .. } => {
                Some(Vector1::new(wrap(bearing_rad)))
            }
            Measurement::Position { .. } | Measurement::Position3 { .. } => None,
        }
    }

    fn project(&self, mean: &Vector2<f64>) -> Vector1<f64> {
        Vector1::new(wrap(mean[0]))
    }

    fn jacobian(&self, _belief: &GaussianState<2>) -> Matrix1x2<f64> {
        Matrix1x2::new(1.0, 0.0)
    }

    fn noise(&self, belief: &GaussianState<2>) -> Matrix1<f64> {
        Matrix1::new(self.variance(belief.mean[0]))
    }

    fn with_own(&self, own: &Own) -> Self {
        Direction(self.0.with_noise(&own.noise))
    }

    fn locate(&self, report: &Vector1<f64>, rate_sigma: f64) -> Option<GaussianState<2>> {
        Some(GaussianState {
            mean: Vector2::new(report[0], 0.0),
            covariance: Matrix2::new(self.variance(report[0]), 0.0, 0.0, rate_sigma.powi(2)),
        })
    }
}
