//! Places with velocities over the ground, as ships and aircraft report them of themselves: h(x) = (p, v) of the horizontal, and in
//! space the height.
//!
//! # Symbols
//! v velocity, v its size; σs, σc standard deviations of speed and course.
//!
//! # Method
//! The noise of the velocity is σs along it and v σc across it, both at least 0.1 m/s, with v² around the prediction, so that it does
//! not depend on the error of the very report. Below 0.5 m/s a course says nothing: the noise is that of a velocity of this size in
//! any direction, σs² + 0.5²/2 on each axis. Without σc it is σs on each axis.

use super::{Sensing, in_space, position};
use crate::model::own::Own;
use crate::model::scan::Measurement;
use crate::model::space::Place;
use crate::model::state::{GaussianState, Position, PositionCovariance};
use nalgebra::{Matrix3, SMatrix, SVector};

const LEAST_SIGMA_MPS: f64 = 0.1;
/// Below it a course says nothing.
const LEAST_SPEED_MPS: f64 = 0.5;
/// Of a velocity that is not told: no velocity of a target is known worse.
const UNTOLD_SIGMA_MPS: f64 = 1e5;

/// A sensor of places and velocities.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moving {
    pub sigmas_m: [f64; 3],
    pub correlation_xy: f64,
    /// Whether it tells heights, too.
    pub is_in_volume: bool,
    /// As of [`super::Spherical::clutter_span`].
    pub clutter_span: Option<f64>,
    pub velocity: VelocityNoise,
    /// Whether this report tells one.
    pub tells_velocity: bool,
}

/// How well a velocity is measured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VelocityNoise {
    /// σs.
    pub sigma_speed_mps: f64,
    /// σc.
    pub sigma_course_rad: Option<f64>,
    /// False detections have velocities uniform over so much (m²/s²).
    pub area_m2ps2: f64,
}

impl VelocityNoise {
    /// Around a velocity with this covariance.
    fn covariance(
        &self,
        velocity_mps: &Position,
        spread: &PositionCovariance,
    ) -> PositionCovariance {
        let square = velocity_mps.norm_squared() + spread.trace().max(0.0);
        let along = self.sigma_speed_mps.max(LEAST_SIGMA_MPS).powi(2);
        let Some(sigma_rad) = self.sigma_course_rad else {
            return PositionCovariance::from_diagonal_element(along);
        };
        if square < LEAST_SPEED_MPS.powi(2) || velocity_mps.norm() == 0.0 {
            let anywhere = square.max(LEAST_SPEED_MPS.powi(2)) / 2.0;
            return PositionCovariance::from_diagonal_element(along + anywhere);
        }
        let across = (square * sigma_rad.powi(2)).max(LEAST_SIGMA_MPS.powi(2));
        let unit = velocity_mps.normalize();
        let normal = Position::new(unit.y, -unit.x);
        unit * unit.transpose() * along + normal * normal.transpose() * across
    }
}

impl Moving {
    fn velocity_covariance(
        &self,
        velocity_mps: &Position,
        spread: &PositionCovariance,
    ) -> PositionCovariance {
        if self.tells_velocity {
            self.velocity.covariance(velocity_mps, spread)
        } else {
            PositionCovariance::from_diagonal_element(UNTOLD_SIGMA_MPS.powi(2))
        }
    }

    fn place_covariance(&self) -> Matrix3<f64> {
        in_space::measured_noise(&self.sigmas_m, self.correlation_xy)
    }

    /// Gives a state at rest the velocity that a report tells.
    fn set_velocity<const K: usize>(&self, state: &mut GaussianState<K>, velocity_mps: Position) {
        if !self.tells_velocity {
            return;
        }
        let spread = self.velocity_covariance(&velocity_mps, &PositionCovariance::zeros());
        for row in 0..2 {
            state.mean[K / 2 + row] = velocity_mps[row];
            for column in 0..2 {
                state.covariance[(K / 2 + row, K / 2 + column)] = spread[(row, column)];
            }
        }
    }

    fn with(&self, own: &Own) -> Self {
        let noise = &own.noise;
        Moving {
            sigmas_m: noise.sigmas_m(self.sigmas_m),
            correlation_xy: noise.correlation_xy.unwrap_or(self.correlation_xy),
            velocity: VelocityNoise {
                sigma_speed_mps: noise
                    .sigma_speed_mps
                    .unwrap_or(self.velocity.sigma_speed_mps),
                sigma_course_rad: noise.sigma_course_rad.or(self.velocity.sigma_course_rad),
                ..self.velocity
            },
            tells_velocity: own.velocity_mps.is_some(),
            ..*self
        }
    }

    /// ln of what a unit of the velocity covers of the false ones. Of one that is not told the density of reports is that of its
    /// noise, which says nothing.
    fn log_velocity_scale(&self) -> f64 {
        if self.tells_velocity {
            -self.velocity.area_m2ps2.ln()
        } else {
            -(std::f64::consts::TAU * UNTOLD_SIGMA_MPS.powi(2)).ln()
        }
    }
}

impl Sensing<4, 4> for Moving {
    const IS_DIRECT: bool = true;

    fn read(&self, report: &Measurement, own: &Own) -> Option<SVector<f64, 4>> {
        let place_m = report.position()?;
        let [east, north] = own.velocity_mps.unwrap_or_default();
        Some(SVector::from([place_m.x, place_m.y, east, north]))
    }

    fn project(&self, mean: &SVector<f64, 4>) -> SVector<f64, 4> {
        *mean
    }

    fn jacobian(&self, _belief: &GaussianState) -> SMatrix<f64, 4, 4> {
        SMatrix::identity()
    }

    fn noise(&self, belief: &GaussianState) -> SMatrix<f64, 4, 4> {
        let velocity_mps = Position::new(belief.mean[2], belief.mean[3]);
        let spread = belief.covariance.fixed_view::<2, 2>(2, 2).into_owned();
        let mut noise = SMatrix::<f64, 4, 4>::zeros();
        noise
            .fixed_view_mut::<2, 2>(0, 0)
            .copy_from(&self.place_covariance().fixed_view::<2, 2>(0, 0));
        noise
            .fixed_view_mut::<2, 2>(2, 2)
            .copy_from(&self.velocity_covariance(&velocity_mps, &spread));
        noise
    }

    fn with_own(&self, own: &Own) -> Self {
        self.with(own)
    }

    fn log_clutter_scale(&self, _expected: &SVector<f64, 4>) -> f64 {
        self.log_velocity_scale()
    }

    fn locate(&self, report: &SVector<f64, 4>, rate_sigma: f64) -> Option<GaussianState> {
        let place_m = report.fixed_rows::<2>(0).into_owned();
        let noise = self
            .place_covariance()
            .fixed_view::<2, 2>(0, 0)
            .into_owned();
        let mut state = position::at_rest(&place_m, &noise, rate_sigma);
        self.set_velocity(&mut state, Position::new(report[2], report[3]));
        Some(state)
    }
}

/// With `D` = 4 (x, y, vx, vy), with 5 (x, y, z, vx, vy).
impl<const D: usize> Sensing<6, D> for Moving {
    fn read(&self, report: &Measurement, own: &Own) -> Option<SVector<f64, D>> {
        let place_m = report.position()?;
        let [east, north] = own.velocity_mps.unwrap_or_default();
        let mut read = SVector::zeros();
        (read[0], read[1]) = (place_m.x, place_m.y);
        if D > 4 {
            read[2] = report.z_m()?;
        }
        (read[D - 2], read[D - 1]) = (east, north);
        Some(read)
    }

    fn project(&self, mean: &SVector<f64, 6>) -> SVector<f64, D> {
        let mut seen = SVector::zeros();
        for row in 0..D - 2 {
            seen[row] = mean[row];
        }
        (seen[D - 2], seen[D - 1]) = (mean[3], mean[4]);
        seen
    }

    fn jacobian(&self, _belief: &GaussianState<6>) -> SMatrix<f64, D, 6> {
        let mut slopes = SMatrix::zeros();
        for row in 0..D - 2 {
            slopes[(row, row)] = 1.0;
        }
        (slopes[(D - 2, 3)], slopes[(D - 1, 4)]) = (1.0, 1.0);
        slopes
    }

    fn noise(&self, belief: &GaussianState<6>) -> SMatrix<f64, D, D> {
        let velocity_mps = Position::new(belief.mean[3], belief.mean[4]);
        let spread = belief.covariance.fixed_view::<2, 2>(3, 3).into_owned();
        let of_place = self.place_covariance();
        let mut noise = SMatrix::<f64, D, D>::zeros();
        for row in 0..D - 2 {
            for column in 0..D - 2 {
                noise[(row, column)] = of_place[(row, column)];
            }
        }
        noise
            .fixed_view_mut::<2, 2>(D - 2, D - 2)
            .copy_from(&self.velocity_covariance(&velocity_mps, &spread));
        noise
    }

    fn with_own(&self, own: &Own) -> Self {
        self.with(own)
    }

    fn log_clutter_scale(&self, _expected: &SVector<f64, D>) -> f64 {
        let span_m = self.clutter_span.filter(|_| D > 4).unwrap_or(1.0);
        self.log_velocity_scale() - span_m.ln()
    }

    /// A place of two coordinates does not say how high its target is.
    fn locate(&self, report: &SVector<f64, D>, rate_sigma: f64) -> Option<GaussianState<6>> {
        if D < 5 {
            return None;
        }
        let place_m = Place::new(report[0], report[1], report[2]);
        let mut state = in_space::at_rest(&place_m, &self.place_covariance(), rate_sigma);
        self.set_velocity(&mut state, Position::new(report[D - 2], report[D - 1]));
        Some(state)
    }
}
