//! What carries a sensor in the plane: how it moves, and what its errors add to a report.
//!
//! # Symbols
//! H slopes of a report with the target's position and velocity; those with the sensor's own are −H. P covariance of the pose.
//!
//! # Method
//! R grows by H P Hᵀ, and by what the attitude adds to a bearing. The errors of a pose are common to all reports of a scan; they
//! are taken to be independent from scan to scan, as those of the reports are.

use crate::model::pose::Pose;
use crate::model::state::{Position, PositionCovariance};
use nalgebra::{SMatrix, SVector};

/// What carries a sensor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Platform {
    pub velocity_mps: Position,
    /// Where its pose is uncertain.
    pub errors: Option<PoseErrors>,
}

/// The errors of a pose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PoseErrors {
    /// Variances of east, north and their rates.
    variances: SVector<f64, 4>,
    /// For what the attitude adds, which depends on the bearing.
    pub(super) pose: Pose,
}

impl Platform {
    pub const STANDING: Platform = Platform {
        velocity_mps: Position::new(0.0, 0.0),
        errors: None,
    };

    pub fn of(pose: &Pose) -> Self {
        let sigmas = &pose.sigmas;
        let (place, velocity) = (sigmas.place, sigmas.velocity);
        let kinematics = SVector::from([place.x, place.y, velocity.x, velocity.y]);
        let angles = [sigmas.heading_rad, sigmas.pitch_rad, sigmas.roll_rad];
        let is_certain = kinematics.iter().chain(&angles).all(|sigma| *sigma == 0.0);
        Platform {
            velocity_mps: pose.velocity.xy(),
            errors: (!is_certain).then(|| PoseErrors {
                variances: kinematics.map(|sigma| sigma * sigma),
                pose: *pose,
            }),
        }
    }
}

impl PoseErrors {
    /// What they add to R, of a report whose value `angle` is a bearing.
    pub fn noise<const D: usize>(
        &self,
        slopes: &SMatrix<f64, D, 4>,
        angle: usize,
        bearing_rad: f64,
    ) -> SMatrix<f64, D, D> {
        let covariance = SMatrix::from_diagonal(&self.variances);
        let mut noise = slopes * covariance * slopes.transpose();
        noise[(angle, angle)] += self.pose.bearing_variance(bearing_rad);
        noise
    }

    /// The variances of the sensor's place.
    pub fn of_place(&self) -> PositionCovariance {
        PositionCovariance::from_diagonal(&self.variances.fixed_rows::<2>(0).into_owned())
    }

    /// The standard deviation of a bearing that has this one beside them.
    pub fn widened(&self, sigma_rad: f64, bearing_rad: f64) -> f64 {
        self.pose
            .bearing_variance(bearing_rad)
            .sqrt()
            .hypot(sigma_rad)
    }
}
