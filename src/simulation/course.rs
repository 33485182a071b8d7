//! The course of a target that manoeuvres, or of a sensor: legs one after another, each exact. Straight, on a circle at a constant rate,
//! with a constant acceleration along its heading, or straight with a rate of climb; after the last one it goes on straight and level.

use crate::model::scenario::{ManeuveringTarget, Segment};
use crate::model::space::Space;
use crate::model::state::Position;
use crate::model::truth::TruthPoint;

#[derive(Debug, Clone, PartialEq)]
pub(super) struct Course {
    from_s: f64,
    until_s: f64,
    space: Space,
    /// In order of time; the last one has no end.
    legs: Vec<Leg>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Leg {
    from_s: f64,
    position_m: Position,
    velocity_mps: Position,
    /// To the left.
    turn_rate_radps: f64,
    acceleration_mps2: Position,
    height_m: f64,
    climb_mps: f64,
}

impl Leg {
    fn at(&self, time_s: f64) -> (Position, Position) {
        let t = time_s - self.from_s;
        let angle = self.turn_rate_radps * t;
        if angle == 0.0 {
            let position_m =
                self.position_m + self.velocity_mps * t + self.acceleration_mps2 * (t * t / 2.0);
            return (position_m, self.velocity_mps + self.acceleration_mps2 * t);
        }
        // A chord of length v·t·sinc(angle / 2), half the turn to the left of the velocity.
        let half = angle / 2.0;
        let chord_m = turned(self.velocity_mps, half) * (t * half.sin() / half);
        (self.position_m + chord_m, turned(self.velocity_mps, angle))
    }

    fn height_at(&self, time_s: f64) -> f64 {
        self.height_m + self.climb_mps * (time_s - self.from_s)
    }

    /// The same, straight on and level.
    fn steady(self) -> Self {
        Leg {
            turn_rate_radps: 0.0,
            acceleration_mps2: Position::zeros(),
            climb_mps: 0.0,
            ..self
        }
    }
}

/// To the left.
fn turned(vector: Position, angle_rad: f64) -> Position {
    let (sin, cos) = angle_rad.sin_cos();
    Position::new(
        cos * vector[0] - sin * vector[1],
        sin * vector[0] + cos * vector[1],
    )
}

impl Course {
    pub fn of(target: &ManeuveringTarget, space: Space) -> Self {
        let start = (
            Position::new(target.x_m, target.y_m),
            Position::new(target.vx_mps, target.vy_mps),
        );
        let height_m = target.z_m.unwrap_or(0.0);
        Course {
            until_s: target.end_s.unwrap_or(f64::INFINITY),
            space,
            legs: legs((target.start_s, start, height_m), &target.segments),
            from_s: target.start_s,
        }
    }

    /// In the plane from time 0, without end.
    pub fn of_sensor(start: (Position, Position), segments: &[Segment]) -> Self {
        Course {
            from_s: 0.0,
            until_s: f64::INFINITY,
            space: Space::Plane,
            legs: legs((0.0, start, 0.0), segments),
        }
    }

    pub fn exists_at(&self, time_s: f64) -> bool {
        (self.from_s..=self.until_s).contains(&time_s)
    }

    /// Before the start as if it had been straight.
    pub fn point_at(&self, time_s: f64) -> TruthPoint {
        let after = self.legs.partition_point(|leg| leg.from_s <= time_s);
        let leg = &self.legs[after.saturating_sub(1)];
        let (position_m, velocity_mps) = leg.at(time_s);
        if self.space == Space::Volume {
            let place_m = position_m.push(leg.height_at(time_s));
            return TruthPoint::in_space(time_s, place_m, velocity_mps.push(leg.climb_mps));
        }
        TruthPoint::in_plane(time_s, position_m, Some(velocity_mps))
    }

    /// At the beginning or the end of a leg.
    pub fn fastest_mps(&self) -> f64 {
        let speed_mps = |leg: &Leg| leg.velocity_mps.norm().hypot(leg.climb_mps);
        self.legs.iter().map(speed_mps).fold(0.0, f64::max)
    }
}

/// From a time, a place with a velocity there, and a height.
fn legs(
    (from_s, (position_m, velocity_mps), height_m): (f64, (Position, Position), f64),
    segments: &[Segment],
) -> Vec<Leg> {
    let mut legs = Vec::with_capacity(segments.len() + 1);
    let mut leg = Leg {
        from_s,
        position_m,
        velocity_mps,
        turn_rate_radps: 0.0,
        acceleration_mps2: Position::zeros(),
        height_m,
        climb_mps: 0.0,
    };
    for segment in segments {
        leg = leg.steady();
        match *segment {
            Segment::Straight { .. } => {}
            Segment::Turn { rate_degps, .. } => leg.turn_rate_radps = rate_degps.to_radians(),
            Segment::Accelerate {
                acceleration_mps2, ..
            } => {
                let heading = leg.velocity_mps.try_normalize(0.0);
                let heading = heading.unwrap_or_else(Position::zeros);
                leg.acceleration_mps2 = heading * acceleration_mps2;
            }
            Segment::Climb { rate_mps, .. } => leg.climb_mps = rate_mps,
        }
        legs.push(leg);
        let end_s = leg.from_s + segment.duration_s();
        leg.height_m = leg.height_at(end_s);
        (leg.position_m, leg.velocity_mps) = leg.at(end_s);
        leg.from_s = end_s;
    }
    legs.push(leg.steady());
    legs
}

#[cfg(test)]
mod tests {
    use super::*;

    fn course(start: [f64; 4], segments: &[Segment]) -> Course {
        let [x_m, y_m, vx_mps, vy_mps] = start;
        let target = ManeuveringTarget {
            truth_id: "1".into(),
            x_m,
            y_m,
            z_m: None,
            vx_mps,
            vy_mps,
            start_s: 0.0,
            end_s: None,
            segments: segments.to_vec(),
        };
        Course::of(&target, Space::Plane)
    }

    fn straight(duration_s: f64) -> Segment {
        Segment::Straight { duration_s }
    }

    fn turn(duration_s: f64, rate_degps: f64) -> Segment {
        Segment::Turn {
            duration_s,
            rate_degps,
        }
    }

    fn assert_at(course: &Course, time_s: f64, expected: [f64; 4]) {
        let point = course.point_at(time_s);
        let velocity = point.velocity.unwrap();
        let found = [point.position.x, point.position.y, velocity.x, velocity.y];
        for (found, expected) in found.iter().zip(expected) {
            assert!(
                (found - expected).abs() < 1e-7,
                "{time_s}: {found} {expected}"
            );
        }
    }

    #[test]
    fn a_quarter_circle_ends_where_its_radius_says() {
        // 120 m/s at 1°/s: a radius of 120 · 180/π = 6875.493541569879 m. West, then a quarter to the left: south.
        let radius_m = 120.0 * 180.0 / std::f64::consts::PI;
        let segments = [
            straight(125.0),
            turn(90.0, 1.0),
            straight(125.0),
            turn(30.0, -3.0),
        ];
        let course = course([25_000.0, 10_000.0, -120.0, 0.0], &segments);
        assert_at(&course, 125.0, [10_000.0, 10_000.0, -120.0, 0.0]);
        let south = [10_000.0 - radius_m, 10_000.0 - radius_m, 0.0, -120.0];
        assert_at(&course, 215.0, south);
        // A third of the radius to the right: west again, and straight on at the end.
        let last = [
            south[0] - radius_m / 3.0,
            south[1] - 15_000.0 - radius_m / 3.0,
            -120.0,
            0.0,
        ];
        assert_at(&course, 370.0, last);
        assert_at(&course, 470.0, [last[0] - 12_000.0, last[1], -120.0, 0.0]);
    }

    #[test]
    fn an_acceleration_is_along_the_heading() {
        let faster = Segment::Accelerate {
            duration_s: 10.0,
            acceleration_mps2: 5.0,
        };
        let course = course([0.0, 0.0, 30.0, -40.0], &[straight(1.0), faster]);
        // 50 m/s for a second, then 50 · 10 + 250 m along (0.6, −0.8).
        assert_at(&course, 11.0, [480.0, -640.0, 60.0, -80.0]);
        assert!((course.fastest_mps() - 100.0).abs() < 1e-12);
    }

    #[test]
    fn a_climb_is_straight_over_the_ground_and_level_after_it() {
        let climb = |rate_mps| Segment::Climb {
            duration_s: 60.0,
            rate_mps,
        };
        let target = ManeuveringTarget {
            truth_id: "1".into(),
            x_m: 0.0,
            y_m: 0.0,
            z_m: Some(3000.0),
            vx_mps: 0.0,
            vy_mps: 100.0,
            start_s: 10.0,
            end_s: None,
            segments: vec![straight(20.0), climb(8.0), turn(9.0, -10.0), climb(-5.0)],
        };
        let course = Course::of(&target, Space::Volume);
        // Level for 20 s, up 480 m in 60 s, a quarter of a circle of 572.958 m to the right, down 300 m, and level again.
        let radius_m = 100.0 * 18.0 / std::f64::consts::PI;
        let expected = [
            (10.0, [0.0, 0.0, 3000.0], [0.0, 100.0, 0.0]),
            (60.0, [0.0, 5000.0, 3240.0], [0.0, 100.0, 8.0]),
            (
                99.0,
                [radius_m, 8000.0 + radius_m, 3480.0],
                [100.0, 0.0, -5.0],
            ),
            (
                109.0,
                [radius_m + 1000.0, 8000.0 + radius_m, 3430.0],
                [100.0, 0.0, -5.0],
            ),
            (
                169.0,
                [radius_m + 7000.0, 8000.0 + radius_m, 3180.0],
                [100.0, 0.0, 0.0],
            ),
        ];
        for (time_s, place_m, velocity_mps) in expected {
            let point = course.point_at(time_s);
            let off_m = (point.position - crate::model::space::Place::from(place_m)).norm();
            let velocity = point.velocity.unwrap();
            let off_mps = (velocity - crate::model::space::Place::from(velocity_mps)).norm();
            assert!(off_m < 1e-8 && off_mps < 1e-8, "{time_s}: {point:?}");
        }
        assert!((course.fastest_mps() - 100.0_f64.hypot(8.0)).abs() < 1e-12);
    }

    #[test]
    fn a_target_is_there_from_its_start_to_its_end() {
        let mut course = course([0.0, 0.0, 1.0, 0.0], &[]);
        (course.from_s, course.until_s) = (10.0, 20.0);
        let there = [9.9, 10.0, 20.0, 20.1].map(|time_s| course.exists_at(time_s));
        assert_eq!(there, [false, true, true, false]);
    }
}
