//! What carries a sensor of space: how it moves, and what its errors add to a report.
//!
//! # Symbols
//! As of [`super::site`]; ψ, θ heading and pitch; f level and forward, s level and to starboard; ω axis of a small turn of the body.
//!
//! # Method
//! 1. R grows by H P Hᵀ, as in the plane ([`super::platform`]), with H the slopes of a report with place and velocity, P their covariance.
//! 2. A small turn moves a direction u by ω × u: a bearing by (ω × u)·t / cos ε, an elevation by (ω × u)·e. ω is −z for the heading, s for
//!    the pitch, f cos θ + z sin θ for the roll.

use super::platform::Platform;
use super::site::Sight;
use crate::model::pose::Pose;
use crate::model::space::Place;
use nalgebra::{Matrix3, SMatrix, SVector};

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Carrier {
    /// On the axes of the data.
    pub velocity_mps: Place,
    /// Where its pose is uncertain.
    pub errors: Option<Pose>,
}

impl Carrier {
    pub const STANDING: Carrier = Carrier {
        velocity_mps: Place::new(0.0, 0.0, 0.0),
        errors: None,
    };

    pub fn of(pose: &Pose) -> Self {
        Carrier {
            velocity_mps: pose.velocity,
            errors: pose.is_uncertain().then_some(*pose),
        }
    }

    /// What the attitude adds to the variances of a bearing and of an elevation.
    pub(super) fn angle_variances(&self, sight: &Sight) -> [f64; 2] {
        let mut variances = [0.0; 2];
        for turn in self.errors.iter().flat_map(|pose| turns_rad(pose, sight)) {
            variances = [0, 1].map(|angle| variances[angle] + turn[angle] * turn[angle]);
        }
        variances
    }

    /// Of its place, on the axes of the data.
    pub(super) fn place_covariance(&self) -> Matrix3<f64> {
        let sigmas_m = self
            .errors
            .map_or_else(Place::zeros, |pose| pose.sigmas.place);
        Matrix3::from_diagonal(&sigmas_m.map(|sigma_m| sigma_m * sigma_m))
    }
}

impl From<Platform> for Carrier {
    fn from(platform: Platform) -> Self {
        Carrier {
            velocity_mps: platform.velocity_mps.push(0.0),
            errors: platform.errors.map(|errors| errors.pose),
        }
    }
}

/// Variances of place and velocity.
pub(super) fn kinematic_variances(pose: &Pose) -> SMatrix<f64, 6, 6> {
    let (place, velocity) = (pose.sigmas.place, pose.sigmas.velocity);
    let sigmas = [
        place.x, place.y, place.z, velocity.x, velocity.y, velocity.z,
    ];
    SMatrix::from_diagonal(&SVector::from(sigmas.map(|sigma| sigma * sigma)))
}

/// How a bearing and an elevation change with an error of heading, pitch and roll: times its standard deviation.
pub(super) fn turns_rad(pose: &Pose, sight: &Sight) -> [[f64; 2]; 3] {
    let attitude = pose.attitude.unwrap_or_default();
    let (sin, cos) = attitude.heading_rad.sin_cos();
    let (rise, level) = attitude.pitch_rad.sin_cos();
    let sigmas = &pose.sigmas;
    let (along, across, up) = (sight.axes.row(0), sight.axes.row(1), sight.axes.row(2));
    let least_level = sight.elevation_rad.cos().max(LEAST_COSINE);
    let of_turn = |axis: Place, sigma_rad: f64| {
        let moved = axis.cross(&along.transpose()) * sigma_rad;
        [
            across.transpose().dot(&moved) / least_level,
            up.transpose().dot(&moved),
        ]
    };
    [
        of_turn(Place::new(0.0, 0.0, -1.0), sigmas.heading_rad),
        of_turn(Place::new(cos, -sin, 0.0), sigmas.pitch_rad),
        of_turn(Place::new(sin * level, cos * level, rise), sigmas.roll_rad),
    ]
}

/// Right above a sensor a bearing changes with any error; not more than here.
const LEAST_COSINE: f64 = 1e-3;
