//! Angles that go round: bearings are clockwise from north, from −π to π.

use nalgebra::SVector;
use std::f64::consts::{PI, TAU};

/// The same direction as an angle in [−π, π).
#[inline]
pub fn wrap(angle_rad: f64) -> f64 {
    if (-PI..PI).contains(&angle_rad) {
        return angle_rad;
    }
    let rest = (angle_rad + PI).rem_euclid(TAU) - PI;
    // Rounding may lift a tiny negative angle to the end that is left out.
    if rest < PI { rest } else { -PI }
}

/// `left − right`, where the coordinate `angle`, if there is one, takes the shorter way round.
#[inline]
pub fn difference<const D: usize>(
    left: &SVector<f64, D>,
    right: &SVector<f64, D>,
    angle: Option<usize>,
) -> SVector<f64, D> {
    let mut difference = left - right;
    if let Some(axis) = angle {
        difference[axis] = wrap(difference[axis]);
    }
    difference
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector2;

    #[test]
    fn angles_are_brought_into_one_turn() {
        for (angle, expected) in [
            (0.5, 0.5),
            (PI, -PI),
            (-PI, -PI),
            (3.5 * PI, -0.5 * PI),
            (-3.5 * PI, 0.5 * PI),
        ] {
            assert!(
                (wrap(angle) - expected).abs() < 1e-12,
                "{angle}: {}",
                wrap(angle)
            );
        }
        assert!(
            (-PI..PI).contains(&wrap(-PI - 1e-17))
                && (-PI..PI).contains(&wrap(-PI - f64::EPSILON * 4.0))
        );
    }

    #[test]
    fn a_difference_across_south_takes_the_shorter_way() {
        let (left, right) = (Vector2::new(5.0, 3.1), Vector2::new(2.0, -3.1));
        assert!((difference(&left, &right, Some(1)) - Vector2::new(3.0, 6.2 - TAU)).norm() < 1e-12);
        assert_eq!(difference(&left, &right, None), Vector2::new(3.0, 6.2));
    }
}
