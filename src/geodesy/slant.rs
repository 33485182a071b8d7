//! What a radar's slant range and bearing say of the place, with the height that another source gives.

use super::Geodetic;
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
    let Some(height_m) = height_m.filter(|_| range_m > 0.0) else {
        return seen(site, range_m, bearing_rad, 0.0);
    };
    let (target_m, site_m) = (MEAN_RADIUS_M + height_m, MEAN_RADIUS_M + site.height_m);
    let cosines = (target_m.powi(2) - site_m.powi(2) - range_m.powi(2)) / (2.0 * site_m * range_m);
    let mut sin_elevation = cosines.clamp(-1.0, 1.0);
    // The height grows with the sine times the range, but for the curvature: each round leaves less than a tenth of the error.
    for _ in 0..12 {
        let found = seen(site, range_m, bearing_rad, sin_elevation);
        let wrong = (height_m - found.height_m) / range_m;
        sin_elevation = (sin_elevation + wrong).clamp(-1.0, 1.0);
        if wrong.abs() < 1e-14 {
            break;
        }
    }
    Geodetic {
        height_m,
        ..seen(site, range_m, bearing_rad, sin_elevation)
    }
}

fn seen(site: &Geodetic, range_m: f64, bearing_rad: f64, sin_elevation: f64) -> Geodetic {
    let along_m = range_m * (1.0 - sin_elevation * sin_elevation).sqrt();
    let (sin, cos) = bearing_rad.sin_cos();
    site.at_enu(&Place::new(
        along_m * sin,
        along_m * cos,
        range_m * sin_elevation,
    ))
}
