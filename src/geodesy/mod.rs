//! Where things are on the Earth (WGS 84): geodetic and geocentric coordinates, the axes east, north and up of a place, the
//! oblique stereographic plane, and the slant ranges of radars.

mod slant;
mod stereographic;
#[cfg(test)]
mod tests;

pub use slant::at_slant_range;
pub use stereographic::{Stereographic, turned};

use crate::model::space::{Frame, Place};
use nalgebra::Matrix3;

/// Semi-major axis (m) and flattening of the ellipsoid (NGA.STND.0036, table 3.1).
pub const SEMI_MAJOR_M: f64 = 6_378_137.0;
pub const FLATTENING: f64 = 1.0 / 298.257_223_563;
const SEMI_MINOR_M: f64 = SEMI_MAJOR_M * (1.0 - FLATTENING);
/// First eccentricity squared, and the second one.
const E2: f64 = FLATTENING * (2.0 - FLATTENING);
const E2_SECOND: f64 = E2 / (1.0 - E2);

/// A place on or above the ellipsoid; its height is above it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Geodetic {
    pub lat_deg: f64,
    pub lon_deg: f64,
    pub height_m: f64,
}

impl From<&Frame> for Geodetic {
    fn from(frame: &Frame) -> Self {
        Geodetic {
            lat_deg: frame.latitude_deg(),
            lon_deg: frame.longitude_deg(),
            height_m: frame.height_m(),
        }
    }
}

impl Geodetic {
    /// Whether it is a latitude and a longitude, and all of it finite.
    pub fn is_sound(&self) -> bool {
        is_on_earth(self.lat_deg, self.lon_deg) && self.height_m.is_finite()
    }

    /// Geocentric coordinates (m): Earth-centred, Earth-fixed.
    pub fn to_ecef(self) -> Place {
        let (sin_lat, cos_lat) = self.lat_deg.to_radians().sin_cos();
        let (sin_lon, cos_lon) = self.lon_deg.to_radians().sin_cos();
        let normal_m = normal_m(sin_lat);
        let from_axis_m = (normal_m + self.height_m) * cos_lat;
        Place::new(
            from_axis_m * cos_lon,
            from_axis_m * sin_lon,
            (normal_m * (1.0 - E2) + self.height_m) * sin_lat,
        )
    }

    /// From geocentric coordinates (m), by Bowring's iteration: four rounds leave less than 1e-11 degrees from the deepest
    /// trench to the geostationary orbit. The centre of the Earth has no answer that means anything.
    pub fn from_ecef(ecef_m: &Place) -> Self {
        let from_axis_m = ecef_m.x.hypot(ecef_m.y);
        let mut reduced = (SEMI_MAJOR_M * ecef_m.z).atan2(SEMI_MINOR_M * from_axis_m);
        let mut lat = 0.0_f64;
        for _ in 0..4 {
            let (sin, cos) = reduced.sin_cos();
            lat = (ecef_m.z + E2_SECOND * SEMI_MINOR_M * sin.powi(3))
                .atan2(from_axis_m - E2 * SEMI_MAJOR_M * cos.powi(3));
            reduced = ((1.0 - FLATTENING) * lat.sin()).atan2(lat.cos());
        }
        let (sin, cos) = lat.sin_cos();
        // Without a division by the cosine, which is 0 at the poles.
        let height_m = from_axis_m * cos + ecef_m.z * sin - SEMI_MAJOR_M.powi(2) / normal_m(sin);
        Geodetic {
            lat_deg: lat.to_degrees(),
            lon_deg: ecef_m.y.atan2(ecef_m.x).to_degrees(),
            height_m,
        }
    }

    /// East, north, up (m) of `point`, seen from here.
    pub fn enu_of(&self, point: &Geodetic) -> Place {
        let [east, north, up] = self.axes();
        let away = point.to_ecef() - self.to_ecef();
        Place::new(east.dot(&away), north.dot(&away), up.dot(&away))
    }

    /// The place that is east, north and up (m) from here.
    pub fn at_enu(&self, enu_m: &Place) -> Geodetic {
        let [east, north, up] = self.axes();
        let away = east * enu_m.x + north * enu_m.y + up * enu_m.z;
        Geodetic::from_ecef(&(self.to_ecef() + away))
    }

    /// From the axes east, north and up here to those of another place.
    pub fn turn_to(&self, other: &Geodetic) -> Matrix3<f64> {
        let (from, to) = (self.axes(), other.axes());
        Matrix3::from_fn(|row, column| to[row].dot(&from[column]))
    }

    /// The directions east, north and up here, in geocentric coordinates.
    fn axes(&self) -> [Place; 3] {
        let (sin_lat, cos_lat) = self.lat_deg.to_radians().sin_cos();
        let (sin_lon, cos_lon) = self.lon_deg.to_radians().sin_cos();
        [
            Place::new(-sin_lon, cos_lon, 0.0),
            Place::new(-sin_lat * cos_lon, -sin_lat * sin_lon, cos_lat),
            Place::new(cos_lat * cos_lon, cos_lat * sin_lon, sin_lat),
        ]
    }
}

/// Whether there is such a latitude and longitude.
pub fn is_on_earth(lat_deg: f64, lon_deg: f64) -> bool {
    lat_deg.abs() <= 90.0 && lon_deg.abs() <= 180.0
}

/// The same longitude from −180 up to, but not, 180 degrees.
pub fn wrap_longitude_deg(lon_deg: f64) -> f64 {
    (lon_deg + 180.0).rem_euclid(360.0) - 180.0
}

/// Radius of curvature in the prime vertical (m).
fn normal_m(sin_lat: f64) -> f64 {
    SEMI_MAJOR_M / (1.0 - E2 * sin_lat * sin_lat).sqrt()
}
