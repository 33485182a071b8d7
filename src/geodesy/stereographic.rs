//! The oblique stereographic projection of the ellipsoid over a conformal sphere, the plane of ASTERIX and of every dataset with
//! a frame.
//!
//! # Reference
//! IOGP, Geomatics guidance note 7-2, section 3.3.2 (method 9809, oblique stereographic); the formulas are written here with the
//! isometric latitude instead of powers of tangents, which keeps them finite at the poles.

use super::{E2, SEMI_MAJOR_M, wrap_longitude_deg};
use crate::model::space::{Frame, Place};
use crate::model::state::Position;

/// A plane that touches the Earth at its origin; x is east there, y north. Angles are kept everywhere, lengths at the origin;
/// at a distance d they are longer by d²/(4 R²): 0.14 m a kilometre at 150 km.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stereographic {
    lon_deg: f64,
    /// Radius of the conformal sphere (m).
    radius_m: f64,
    /// How many times faster its longitudes run.
    stretch: f64,
    /// Its isometric latitude is `stretch` times that of the ellipsoid plus this.
    offset: f64,
    sin: f64,
    cos: f64,
}

impl From<Frame> for Stereographic {
    fn from(frame: Frame) -> Self {
        Stereographic::about(frame.latitude_deg(), frame.longitude_deg())
    }
}

/// The vector, whose angle clockwise from one north is known, clockwise from another that is `turn_rad` behind it.
pub fn turned(vector: &Place, turn_rad: f64) -> Place {
    let (sin, cos) = turn_rad.sin_cos();
    let (east, north) = (vector.x, vector.y);
    Place::new(east * cos + north * sin, north * cos - east * sin, vector.z)
}

impl Stereographic {
    /// The plane that touches at a latitude and longitude.
    pub fn about(lat_deg: f64, lon_deg: f64) -> Self {
        let lat = lat_deg.to_radians();
        let (sin_lat, cos_lat) = lat.sin_cos();
        let stretch = (1.0 + E2 * cos_lat.powi(4) / (1.0 - E2)).sqrt();
        let sphere_lat = (sin_lat / stretch).clamp(-1.0, 1.0).asin();
        let (sin, cos) = sphere_lat.sin_cos();
        Stereographic {
            lon_deg,
            radius_m: (1.0 - E2).sqrt() * SEMI_MAJOR_M / (1.0 - E2 * sin_lat * sin_lat),
            stretch,
            offset: sphere_lat.tan().asinh() - stretch * isometric(lat),
            sin,
            cos,
        }
    }

    /// East and north (m) of a place in the plane; the point opposite to the origin has none that is finite.
    pub fn project(&self, lat_deg: f64, lon_deg: f64) -> Position {
        let isometric = self.stretch * isometric(lat_deg.to_radians()) + self.offset;
        let (sin_lat, cos_lat) = (isometric.tanh(), 1.0 / isometric.cosh());
        let lon = self.stretch * wrap_longitude_deg(lon_deg - self.lon_deg).to_radians();
        let (sin_lon, cos_lon) = lon.sin_cos();
        let cos_away = self.sin * sin_lat + self.cos * cos_lat * cos_lon;
        let scale_m = 2.0 * self.radius_m / (1.0 + cos_away);
        Position::new(
            scale_m * cos_lat * sin_lon,
            scale_m * (self.cos * sin_lat - self.sin * cos_lat * cos_lon),
        )
    }

    /// Latitude and longitude (degrees) of a place in the plane.
    pub fn unproject(&self, place_m: &Position) -> (f64, f64) {
        let away_m = place_m.norm();
        let (sin_away, cos_away) = (2.0 * (away_m / (2.0 * self.radius_m)).atan()).sin_cos();
        let direction = if away_m > 0.0 {
            place_m / away_m
        } else {
            Position::zeros()
        };
        // The point on the unit sphere: toward its pole, and away from its axis.
        let up = cos_away * self.sin + direction.y * sin_away * self.cos;
        let east = direction.x * sin_away;
        let out = cos_away * self.cos - direction.y * sin_away * self.sin;
        let isometric = ((up / east.hypot(out)).asinh() - self.offset) / self.stretch;
        let lon_deg = self.lon_deg + (east.atan2(out) / self.stretch).to_degrees();
        (
            from_isometric(isometric).to_degrees(),
            wrap_longitude_deg(lon_deg),
        )
    }

    /// What has to be added to an angle clockwise from true north at a place to have it clockwise from the y axis of the plane
    /// (rad).
    pub fn turn_rad(&self, lat_deg: f64, lon_deg: f64) -> f64 {
        // The projection keeps angles: a short way north is enough to see how north lies.
        const STEP_DEG: f64 = 1e-4;
        let step_deg = if lat_deg > 0.0 { -STEP_DEG } else { STEP_DEG };
        let north = self.project(lat_deg + step_deg, lon_deg) - self.project(lat_deg, lon_deg);
        let north = north * step_deg.signum();
        north.x.atan2(north.y)
    }
}

/// The latitude at which a Mercator map would have it (rad).
fn isometric(lat: f64) -> f64 {
    let e = E2.sqrt();
    lat.tan().asinh() - e * (e * lat.sin()).atanh()
}

/// The latitude of an isometric one. Each round leaves 1/150 of the error before: ten leave none.
fn from_isometric(isometric: f64) -> f64 {
    let e = E2.sqrt();
    let mut conformal = isometric;
    for _ in 0..10 {
        conformal = isometric + e * (e * conformal.tanh()).atanh();
    }
    conformal.sinh().atan()
}
