//! Where two bearings cross.
//!
//! # Symbols
//! d from the first place to the second; u, t unit vectors along a bearing and clockwise across it; r ranges; × the cross product of
//! the plane.
//!
//! # Method
//! r₁ = (d × u₂) / (u₁ × u₂) and r₂ = (d × u₁) / (u₁ × u₂), both above 0. With H of the rows tᵢ / rᵢ and R of the variances of both
//! bearings, the covariance is H⁻¹ R H⁻ᵀ. The errors of a place turn its bearing by t·e / r.

use super::polar::View;
use crate::model::state::{Position, PositionCovariance};
use nalgebra::{Matrix2, RowVector2};

/// Bearings that differ by less than so many standard deviations may be parallel: they do not cross.
const LEAST_SIGMAS: f64 = 3.0;

/// A bearing from a place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LineOfSight {
    pub place_m: Position,
    pub bearing_rad: f64,
    pub variance_rad2: f64,
    /// Of the place itself, and of what its target may have moved since.
    pub spread_m2: PositionCovariance,
}

/// Where two bearings cross, and how well that is known to first order. `None` where they do not, or may be parallel.
pub fn cross(first: &LineOfSight, second: &LineOfSight) -> Option<(Position, PositionCovariance)> {
    let along = [first, second].map(|sight| {
        let (sine, cosine) = sight.bearing_rad.sin_cos();
        Position::new(sine, cosine)
    });
    let apart_m = second.place_m - first.place_m;
    let sine = along[0].perp(&along[1]);
    let least = LEAST_SIGMAS * (first.variance_rad2 + second.variance_rad2).sqrt();
    if sine.abs() <= least {
        return None;
    }
    let ranges_m = [
        apart_m.perp(&along[1]) / sine,
        apart_m.perp(&along[0]) / sine,
    ];
    if ranges_m.iter().any(|range_m| *range_m <= 0.0) {
        return None;
    }
    let position_m = first.place_m + along[0] * ranges_m[0];
    let mut slopes = Matrix2::zeros();
    let mut noise = Matrix2::zeros();
    for (row, sight) in [first, second].into_iter().enumerate() {
        let across = View::of(position_m - sight.place_m).across;
        let slope = across / ranges_m[row];
        slopes.set_row(row, &RowVector2::new(slope[0], slope[1]));
        noise[(row, row)] = sight.variance_rad2 + slope.dot(&(sight.spread_m2 * slope));
    }
    let inverse = slopes.try_inverse()?;
    Some((position_m, inverse * noise * inverse.transpose()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rng::{Purpose, Seed};
    use rand_distr::{Distribution, StandardNormal};

    const TARGET_M: Position = Position::new(3000.0, 5000.0);
    const SIGMA_RAD: f64 = 0.005;

    fn sight(place_m: Position, error_rad: f64) -> LineOfSight {
        let offset_m = TARGET_M - place_m;
        LineOfSight {
            place_m,
            bearing_rad: offset_m.x.atan2(offset_m.y) + error_rad,
            variance_rad2: SIGMA_RAD.powi(2),
            spread_m2: PositionCovariance::zeros(),
        }
    }

    #[test]
    fn crossings_scatter_as_is_stated() {
        let places = [Position::new(0.0, 0.0), Position::new(4000.0, -1000.0)];
        let (position_m, stated) = cross(&sight(places[0], 0.0), &sight(places[1], 0.0)).unwrap();
        assert!((position_m - TARGET_M).norm() < 1e-9);
        let mut draw = Seed { seed: 9, run: 0 }.stream(Purpose::Detection, 0, 0);
        let count = 40_000;
        let (mut mean, mut square, mut nees) =
            (Position::zeros(), PositionCovariance::zeros(), 0.0);
        for _ in 0..count {
            let errors: [f64; 2] = std::array::from_fn(|_| StandardNormal.sample(&mut draw));
            let [first, second] =
                [0, 1].map(|index| sight(places[index], SIGMA_RAD * errors[index]));
            let (found_m, covariance) = cross(&first, &second).unwrap();
            let error_m = found_m - TARGET_M;
            mean += error_m / f64::from(count);
            square += error_m * error_m.transpose() / f64::from(count);
            nees += error_m.dot(&(covariance.try_inverse().unwrap() * error_m)) / f64::from(count);
        }
        // Of 40 000 draws the variances are known to 0.7 %, the mean NEES of 2 to 0.01; the second order adds a little.
        assert!(mean.norm() < 2.0, "{mean}");
        for axis in 0..2 {
            let ratio = square[(axis, axis)] / stated[(axis, axis)];
            assert!((ratio - 1.0).abs() < 0.03, "{ratio}: {square} {stated}");
        }
        assert!((square[(0, 1)] / stated[(0, 1)] - 1.0).abs() < 0.03);
        assert!((nees - 2.0).abs() < 0.05, "{nees}");
    }

    #[test]
    fn a_place_that_is_uncertain_turns_its_bearing() {
        // A sensor due south, unsure of its east by 30 m, sees as one whose bearings are off by 30 m over the range.
        let south = Position::new(3000.0, 1000.0);
        let mut unsure = sight(south, 0.0);
        unsure.spread_m2[(0, 0)] = 900.0;
        let other = sight(Position::new(-2000.0, 5000.0), 0.0);
        let (_, certain) = cross(&sight(south, 0.0), &other).unwrap();
        let (_, found) = cross(&unsure, &other).unwrap();
        assert!((found[(0, 0)] - certain[(0, 0)] - 900.0).abs() < 1e-6);
        assert!((found[(1, 1)] - certain[(1, 1)]).abs() < 1e-6);
    }

    #[test]
    fn rays_that_part_or_are_parallel_do_not_cross() {
        let west = sight(Position::new(0.0, 0.0), 0.0);
        let away = LineOfSight {
            bearing_rad: west.bearing_rad + std::f64::consts::PI,
            ..west
        };
        let east = sight(Position::new(4000.0, 0.0), 0.0);
        assert!(cross(&west, &east).is_some());
        assert_eq!(cross(&away, &east), None);
        let parallel = LineOfSight {
            bearing_rad: west.bearing_rad - 2.0 * SIGMA_RAD,
            ..east
        };
        assert_eq!(cross(&west, &parallel), None);
    }
}
