//! Bearings of targets in the plane, from a place that is known: h(x) = atan2(Δx, Δy), clockwise from north.
//!
//! # Symbols
//! Δ from the sensor to the target; r = |Δ|; u, t unit vectors along Δ and clockwise across it.
//!
//! # Method
//! ∂β/∂p = t / r and ∂²β/∂u∂t = −1/r²; of a second derivative F, the mean gains ½ tr(F P) and the variance ½ tr(F P F P).

use super::Sensing;
use super::crossing::LineOfSight;
use super::platform::Platform;
use super::polar::View;
use super::position::at_rest;
use super::range_prior::{RangePrior, UncertainRange};
use crate::model::angle::wrap;
use crate::model::own::{Own, OwnNoise};
use crate::model::scan::Measurement;
use crate::model::state::{GaussianState, Position, PositionCovariance, State};
use nalgebra::{Matrix1, SMatrix, Vector1};

/// A sensor of bearings, and where it stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bearing {
    pub place_m: Position,
    pub sigma_bearing_rad: f64,
    pub platform: Platform,
    /// With it a bearing starts a track.
    pub range_prior: Option<RangePrior>,
}

impl Sensing<4, 1> for Bearing {
    const ANGLE: Option<usize> = Some(0);

    fn read(&self, report: &Measurement, _own: &Own) -> Option<Vector1<f64>> {
        match report.flat() {
            Measurement::Bearing { bearing_rad } => Some(Vector1::new(wrap(bearing_rad))),
            _ => None,
        }
    }

    fn project(&self, mean: &State) -> Vector1<f64> {
        Vector1::new(View::from(self.place_m, mean).bearing_rad)
    }

    fn jacobian(&self, belief: &GaussianState) -> SMatrix<f64, 1, 4> {
        let view = View::from(self.place_m, &belief.mean);
        let slope = view.across / view.least_range(belief);
        SMatrix::<f64, 1, 4>::new(slope[0], slope[1], 0.0, 0.0)
    }

    fn curvature(&self, belief: &GaussianState) -> (Vector1<f64>, Matrix1<f64>) {
        let view = View::from(self.place_m, &belief.mean);
        let covariance = belief.covariance.fixed_view::<2, 2>(0, 0);
        let (along, across) = (view.along, view.across);
        let cross = along.dot(&(covariance * across));
        let (of_along, of_across) = (
            along.dot(&(covariance * along)),
            across.dot(&(covariance * across)),
        );
        let second = -1.0 / view.least_range(belief).powi(2);
        // tr(F P) = 2 f c and tr(F P F P) = 2 f² (c² + a b), with f the second derivative along u and t.
        (
            Vector1::new(second * cross),
            Matrix1::new(second * second * (cross * cross + of_along * of_across)),
        )
    }

    fn noise(&self, belief: &GaussianState) -> Matrix1<f64> {
        let noise = Matrix1::new(self.sigma_bearing_rad.powi(2));
        match &self.platform.errors {
            None => noise,
            Some(errors) => {
                let bearing_rad = View::from(self.place_m, &belief.mean).bearing_rad;
                noise + errors.noise(&self.jacobian(belief), 0, bearing_rad)
            }
        }
    }

    fn with_own(&self, own: &Own) -> Self {
        self.with_noise(&own.noise)
    }

    /// The moments of all ranges that it may be at.
    fn locate(&self, report: &Vector1<f64>, rate_sigma: f64) -> Option<GaussianState> {
        let whole = self.range_prior?.whole();
        Some(self.at_range(report[0], whole, rate_sigma))
    }

    fn parts(&self, report: &Vector1<f64>, rate_sigma: f64) -> Vec<GaussianState> {
        let parts = self.range_prior.iter().flat_map(RangePrior::parts);
        parts
            .map(|range| self.at_range(report[0], range, rate_sigma))
            .collect()
    }
}

impl Bearing {
    /// A report as a ray.
    pub fn sight(&self, bearing_rad: f64) -> LineOfSight {
        let errors = self.platform.errors.as_ref();
        LineOfSight {
            place_m: self.place_m,
            bearing_rad,
            variance_rad2: self.widened(bearing_rad).powi(2),
            spread_m2: errors.map_or_else(PositionCovariance::zeros, |errors| errors.of_place()),
        }
    }

    pub(super) fn with_noise(&self, own: &OwnNoise) -> Bearing {
        Bearing {
            sigma_bearing_rad: own.sigma_bearing_rad.unwrap_or(self.sigma_bearing_rad),
            ..*self
        }
    }

    /// Its noise, with that of the attitude.
    pub(super) fn widened(&self, bearing_rad: f64) -> f64 {
        let errors = self.platform.errors.as_ref();
        errors.map_or(self.sigma_bearing_rad, |errors| {
            errors.widened(self.sigma_bearing_rad, bearing_rad)
        })
    }

    /// At rest ± `rate_sigma`.
    fn at_range(&self, bearing_rad: f64, range: UncertainRange, rate_sigma: f64) -> GaussianState {
        let along = Position::new(bearing_rad.sin(), bearing_rad.cos());
        let across = Position::new(along[1], -along[0]);
        let sigma_rad = self.widened(bearing_rad);
        let square_m2 = range.mean_m.powi(2) + range.sigma_m.powi(2);
        let mut noise = along * along.transpose() * range.sigma_m.powi(2)
            + across * across.transpose() * (square_m2 * sigma_rad.powi(2));
        if let Some(errors) = &self.platform.errors {
            noise += errors.of_place();
        }
        at_rest(&(self.place_m + along * range.mean_m), &noise, rate_sigma)
    }
}

#[cfg(test)]
mod tests {
    use super::super::polar::Polar;
    use super::*;

    const BEARING: Bearing = Bearing {
        place_m: Position::new(10.0, -20.0),
        sigma_bearing_rad: 0.01,
        platform: Platform::STANDING,
        range_prior: None,
    };

    fn belief() -> GaussianState {
        let root = SMatrix::<f64, 4, 4>::from_fn(|row, column| ((row + 2 * column) % 5) as f64);
        GaussianState {
            mean: State::new(310.0, -420.0, 10.0, -5.0),
            covariance: root * root.transpose() + SMatrix::identity(),
        }
    }

    #[test]
    fn the_jacobian_is_the_slope_of_the_projection() {
        let matrix = BEARING.jacobian(&belief());
        for variable in 0..4 {
            let step = State::ith(variable, 1e-3);
            let (after, before) = (belief().mean + step, belief().mean - step);
            let slope = (BEARING.project(&after) - BEARING.project(&before)) / 2e-3;
            assert!((slope[0] - matrix[variable]).abs() < 1e-10, "{variable}");
        }
    }

    #[test]
    fn it_is_the_second_value_of_a_polar_report() {
        let polar = Polar {
            place_m: BEARING.place_m,
            sigma_range_m: 3.0,
            sigma_bearing_rad: BEARING.sigma_bearing_rad,
            range_rate: None,
            platform: Platform::STANDING,
        };
        let (belief, wanted) = (belief(), BEARING.curvature(&belief()));
        let (shift, spread) = Sensing::<4, 2>::curvature(&polar, &belief);
        assert!((shift[1] - wanted.0[0]).abs() < 1e-15);
        assert!((spread[(1, 1)] - wanted.1[0]).abs() < 1e-15);
        let projected = Sensing::<4, 2>::project(&polar, &belief.mean);
        assert_eq!(projected[1], BEARING.project(&belief.mean)[0]);
    }

    #[test]
    fn a_bearing_alone_is_no_place() {
        assert_eq!(BEARING.locate(&Vector1::new(1.0), 10.0), None);
    }
}
