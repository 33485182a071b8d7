//! The Jacobian of each sensing model is its slope: central differences at random states.

use nalgebra::{SMatrix, SVector, Vector2, Vector4};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use std::f64::consts::{PI, TAU};
use trackloom_domain::math::rng::{Purpose, Seed};
use trackloom_domain::model::angle::difference;
use trackloom_domain::model::sensing::{
    Bearing, Converted, Direction, Platform, Polar, Positions, RangeRate, Sensing,
};
use trackloom_domain::model::state::{GaussianState, Position};

const STATES: usize = 200;
/// Of the largest slope of the same value along coordinates, or along rates.
const TOLERANCE: f64 = 1e-7;
const PLACE_M: Position = Position::new(1200.0, -700.0);

fn draw() -> ChaCha8Rng {
    Seed { seed: 18, run: 0 }.stream(Purpose::Detection, 0, 0)
}

/// A state whose covariance is so small that nothing is bounded.
fn certain<const K: usize>(mean: SVector<f64, K>) -> GaussianState<K> {
    GaussianState {
        mean,
        covariance: SMatrix::identity() * 1e-9,
    }
}

/// The slope is taken over `2 · steps[variable]` along each variable.
fn assert_slope<S: Sensing<K, D>, const K: usize, const D: usize>(
    name: &str,
    sensing: &S,
    mean: SVector<f64, K>,
    steps: SVector<f64, K>,
) {
    let jacobian = sensing.jacobian(&certain(mean));
    for variable in 0..K {
        let mut step = SVector::<f64, K>::zeros();
        step[variable] = steps[variable];
        let (after, before) = (
            sensing.project(&(mean + step)),
            sensing.project(&(mean - step)),
        );
        let slope = difference(&after, &before, S::ANGLE) / (2.0 * steps[variable]);
        let alike = if variable < K / 2 { 0..K / 2 } else { K / 2..K };
        for value in 0..D {
            let largest = alike.clone().map(|other| jacobian[(value, other)].abs());
            let scale = largest.fold(0.0, f64::max);
            let error = (slope[value] - jacobian[(value, variable)]).abs();
            assert!(
                error <= TOLERANCE * scale,
                "{name} {value} {variable} at {mean}: {error:e}"
            );
        }
    }
}

/// 100 m to 50 km around the place, at up to 300 m/s on each axis, with steps of the differences.
fn state_of_plane(draw: &mut ChaCha8Rng) -> (Vector4<f64>, Vector4<f64>) {
    let range_m = 100.0 * 500f64.powf(draw.random::<f64>());
    let towards: f64 = draw.random_range(-PI..PI);
    let (vx, vy) = (
        draw.random_range(-300.0..300.0),
        draw.random_range(-300.0..300.0),
    );
    let place_m = PLACE_M + Position::new(towards.sin(), towards.cos()) * range_m;
    let step_m = 1e-5 * range_m;
    let mean = Vector4::new(place_m[0], place_m[1], vx, vy);
    (mean, Vector4::new(step_m, step_m, 1e-2, 1e-2))
}

#[test]
fn the_jacobians_in_the_plane_are_central_differences() {
    let mut draw = draw();
    let rate = RangeRate {
        sigma_mps: 0.5,
        span_mps: 600.0,
    };
    let polar = Polar {
        place_m: PLACE_M,
        sigma_range_m: 10.0,
        sigma_bearing_rad: 0.01,
        range_rate: None,
        platform: Platform::STANDING,
    };
    let doppler = Polar {
        range_rate: Some(rate),
        ..polar
    };
    let bearing = Bearing {
        place_m: PLACE_M,
        sigma_bearing_rad: 0.01,
        platform: Platform::STANDING,
        range_prior: None,
    };
    for _ in 0..STATES {
        let (mean, steps) = state_of_plane(&mut draw);
        assert_slope("position", &Positions::new(1.0, 2.0), mean, steps);
        assert_slope::<_, 4, 2>("polar", &polar, mean, steps);
        assert_slope::<_, 4, 3>("polar with rates", &doppler, mean, steps);
        assert_slope("converted", &Converted(polar), mean, steps);
        assert_slope("bearing", &bearing, mean, steps);
    }
}

#[test]
fn the_jacobian_of_a_direction_is_a_central_difference() {
    let mut draw = draw();
    let direction = Direction(Bearing {
        place_m: PLACE_M,
        sigma_bearing_rad: 0.01,
        platform: Platform::STANDING,
        range_prior: None,
    });
    for _ in 0..STATES {
        let mean = Vector2::new(draw.random_range(-TAU..TAU), draw.random_range(-0.1..0.1));
        assert_slope("direction", &direction, mean, Vector2::new(1e-3, 1e-3));
    }
}
