//! Where a sensor of space stands, and what a target looks like from there.
//!
//! # Symbols
//! d, w place and velocity of a target from the sensor, on the sensor's axes; g = |d_xy|, r = |d|; β = atan2(d_x, d_y), ε = atan2(d_z, g);
//! u along d, t horizontally across it and clockwise, e upwards across it: unit vectors.

use crate::model::space::Place;
use crate::model::state::GaussianState;
use nalgebra::{Matrix3, SMatrix, SVector};

/// A target nearer than this is taken to be this far away: the sensor itself has no direction.
pub(super) const LEAST_RANGE_M: f64 = 1e-3;

/// The place of a sensor, and its axes east, north and up. On a curved Earth they are turned against those of the data.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Site {
    /// On the axes of the data.
    pub place_m: Place,
    /// From the axes of the data to those of the sensor.
    pub turn: Matrix3<f64>,
}

impl Site {
    /// Where all axes are parallel.
    pub fn level(place_m: Place) -> Self {
        Site {
            place_m,
            turn: Matrix3::identity(),
        }
    }
}

/// A target as a sensor of space sees it.
pub(super) struct Sight {
    /// Whether heights are looked at.
    is_flat: bool,
    /// r; of a flat one g.
    pub range_m: f64,
    /// g.
    pub ground_m: f64,
    pub bearing_rad: f64,
    pub elevation_rad: f64,
    /// w.
    pub velocity_mps: Place,
    /// u, t and e as rows.
    pub axes: Matrix3<f64>,
}

impl Sight {
    /// With `is_flat` heights are not looked at: what is measured is measured along the ground.
    pub fn from(site: &Site, mean: &SVector<f64, 6>, is_flat: bool) -> Self {
        let place = mean.fixed_rows::<3>(0) - site.place_m;
        let offset_m = site.turn * place;
        let ground_m = offset_m.x.hypot(offset_m.y);
        let rise_m = if is_flat { 0.0 } else { offset_m.z };
        let bearing_rad = offset_m.x.atan2(offset_m.y);
        let elevation_rad = rise_m.atan2(ground_m);
        Sight {
            is_flat,
            range_m: ground_m.hypot(rise_m).max(LEAST_RANGE_M),
            ground_m: ground_m.max(LEAST_RANGE_M),
            bearing_rad,
            elevation_rad,
            velocity_mps: site.turn * mean.fixed_rows::<3>(3),
            axes: axes(bearing_rad, elevation_rad),
        }
    }

    /// The belief on the axes u, t, e of place and velocity.
    pub fn covariance(&self, site: &Site, belief: &GaussianState<6>) -> SMatrix<f64, 6, 6> {
        let turn = self.axes * site.turn;
        let mut whole = SMatrix::<f64, 6, 6>::zeros();
        whole.fixed_view_mut::<3, 3>(0, 0).copy_from(&turn);
        whole.fixed_view_mut::<3, 3>(3, 3).copy_from(&turn);
        whole * belief.covariance * whole.transpose()
    }

    /// g and r, at least the standard deviation across them: a target that may be anywhere around the sensor, or right above
    /// it, has no direction to linearise.
    pub fn least_ranges(&self, site: &Site, belief: &GaussianState<6>) -> (f64, f64) {
        let places = belief.covariance.fixed_view::<3, 3>(0, 0);
        let turn = self.axes * site.turn;
        let deviation_m = |axis: usize| {
            let towards = turn.row(axis);
            (towards * places * towards.transpose())[0].max(0.0).sqrt()
        };
        let across_m = deviation_m(1);
        let up_m = if self.is_flat { 0.0 } else { deviation_m(2) };
        (
            self.ground_m.max(across_m),
            self.range_m.max(across_m).max(up_m),
        )
    }
}

/// u, t and e as rows.
pub(super) fn axes(bearing_rad: f64, elevation_rad: f64) -> Matrix3<f64> {
    let (sin, cos) = bearing_rad.sin_cos();
    let (rise, level) = elevation_rad.sin_cos();
    Matrix3::new(
        sin * level,
        cos * level,
        rise,
        cos,
        -sin,
        0.0,
        -sin * rise,
        -cos * rise,
        level,
    )
}
