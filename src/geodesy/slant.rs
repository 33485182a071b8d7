//! What a radar's slant range and bearing say of the place, with the height that another source gives.

use super::{E2, E2_SECOND, FLATTENING, Geodetic, SEMI_MAJOR_M, SEMI_MINOR_M, normal_m};
use crate::model::space::Place;

/// Radius of the sphere that the first guess of an elevation takes for the Earth (m).
const MEAN_RADIUS_M: f64 = 6_371_000.0;

/// The place at a slant range (m) and a bearing clockwise from true north (rad) from `site`, at `height_m`. Without a height the
/// elevation is taken as 0. Where the range is shorter than the difference of heights, the place right above or below.
pub fn at_slant_range(
    site: &Geodetic,
    range_m: f64,
    bearing_rad: f64,
    height_m: Option<f64>,
) -> Geodetic {
    let beam = Beam::of(site, range_m, bearing_rad);
    let Some(height_m) = height_m.filter(|_| range_m > 0.0) else {
        return Geodetic::from_ecef(&beam.at(0.0));
    };
    let (target_m, site_m) = (MEAN_RADIUS_M + height_m, MEAN_RADIUS_M + site.height_m);
    let cosines = (target_m.powi(2) - site_m.powi(2) - range_m.powi(2)) / (2.0 * site_m * range_m);
    let mut sin_elevation = cosines.clamp(-1.0, 1.0);
    // Newton's method with the slope of the sphere: each round leaves less than a hundredth of the error.
    let slope = (target_m / site_m).clamp(0.5, 2.0);
    for _ in 0..12 {
        let wrong = (height_m - height_of(&beam.at(sin_elevation))) / range_m;
        let before = sin_elevation;
        sin_elevation = (sin_elevation + wrong * slope).clamp(-1.0, 1.0);
        if wrong.abs() < 1e-14 || sin_elevation == before {
            break;
        }
    }
    Geodetic {
        height_m,
        ..Geodetic::from_ecef(&beam.at(sin_elevation))
    }
}

/// What a range and a bearing leave open: how high.
struct Beam {
    range_m: f64,
    /// Geocentric place of the site (m), and directions along its horizon and up.
    site_m: Place,
    along: Place,
    up: Place,
}

impl Beam {
    fn of(site: &Geodetic, range_m: f64, bearing_rad: f64) -> Self {
        let [east, north, up] = site.axes();
        let (sin, cos) = bearing_rad.sin_cos();
        Beam {
            range_m,
            site_m: site.to_ecef(),
            along: east * sin + north * cos,
            up,
        }
    }

    /// Geocentric coordinates (m) of its end.
    fn at(&self, sin_elevation: f64) -> Place {
        let along_m = self.range_m * (1.0 - sin_elevation * sin_elevation).sqrt();
        self.site_m + self.along * along_m + self.up * (self.range_m * sin_elevation)
    }
}

/// The height of [`Geodetic::from_ecef`] (m), with sines and cosines by roots alone. A wrong latitude changes it by its square:
/// two rounds leave nothing.
fn height_of(ecef_m: &Place) -> f64 {
    let from_axis_m = ecef_m.x.hypot(ecef_m.y);
    let (mut up, mut out) = (SEMI_MAJOR_M * ecef_m.z, SEMI_MINOR_M * from_axis_m);
    let mut flattened = 1.0;
    for _ in 0..2 {
        let (sin, cos) = direction(flattened * up, out);
        up = ecef_m.z + E2_SECOND * SEMI_MINOR_M * sin.powi(3);
        out = from_axis_m - E2 * SEMI_MAJOR_M * cos.powi(3);
        flattened = 1.0 - FLATTENING;
    }
    let (sin, cos) = direction(up, out);
    from_axis_m * cos + ecef_m.z * sin - SEMI_MAJOR_M.powi(2) / normal_m(sin)
}

/// Sine and cosine of the angle whose tangent is `up` over `out`.
fn direction(up: f64, out: f64) -> (f64, f64) {
    let length = (up * up + out * out).sqrt();
    (up / length, out / length)
}
