//! Means of places, each counted by how well it is known.
//!
//! # Method
//! (Σ R⁻¹)⁻¹ Σ R⁻¹ z: the mean of least variance, which is also the point with the least sum of squared Mahalanobis
//! distances from the places.

use super::Place;
use crate::math::gaussian::Gaussian;
use crate::model::state::{Position, PositionCovariance};

/// Places that are known well enough to be divided by: a covariance that is not positive definite knows nothing.
#[derive(Debug, Clone, Copy)]
pub(super) struct Information {
    matrix: PositionCovariance,
    vector: Position,
}

impl Information {
    pub fn none() -> Self {
        Information {
            matrix: PositionCovariance::zeros(),
            vector: Position::zeros(),
        }
    }

    pub fn from_place(place: &Place) -> Self {
        let mut information = Information::none();
        information.add(place);
        information
    }

    pub fn add(&mut self, place: &Place) {
        if let Some(gaussian) = Gaussian::new(&place.covariance) {
            self.matrix += gaussian.inverse();
            self.vector += gaussian.inverse() * place.position_m;
        }
    }

    /// The mean and its covariance; `None` of nothing.
    pub fn mean(&self) -> Option<Place> {
        let covariance = *Gaussian::new(&self.matrix)?.inverse();
        Some(Place {
            position_m: covariance * self.vector,
            covariance,
        })
    }
}

/// d² = νᵀ (R₁ + R₂)⁻¹ ν; infinite where the sum has no inverse.
pub(super) fn squared_distance(left: &Place, right: &Place) -> f64 {
    let gaussian = Gaussian::new(&(left.covariance + right.covariance));
    gaussian.map_or(f64::INFINITY, |gaussian| {
        gaussian.squared_distance(&(left.position_m - right.position_m))
    })
}
