//! Where the sensors of a scenario are: those that move go on a course of legs, as targets do, with the bow along their velocity.

use super::course::Course;
use crate::model::pose::{Attitude, Pose};
use crate::model::scenario::{Scenario, ScenarioSensor};
use crate::model::state::Position;

/// Of each sensor, in their order.
pub(super) struct Carriers(Vec<Carrier>);

enum Carrier {
    Standing(Position),
    Moving(Course),
}

impl Carriers {
    pub fn new(scenario: &Scenario) -> Self {
        Carriers(scenario.sensors.iter().map(Carrier::of).collect())
    }

    pub fn place_m(&self, sensor: usize, time_s: f64) -> Position {
        match &self.0[sensor] {
            Carrier::Standing(place_m) => *place_m,
            Carrier::Moving(course) => course.point_at(time_s).position.xy(),
        }
    }

    /// Of a sensor that moves.
    pub fn pose(&self, sensor: usize, time_s: f64) -> Option<Pose> {
        match &self.0[sensor] {
            Carrier::Standing(_) => None,
            Carrier::Moving(course) => Some(pose_at(course, time_s)),
        }
    }
}

impl Carrier {
    fn of(sensor: &ScenarioSensor) -> Self {
        let place_m = Position::new(sensor.x_m, sensor.y_m);
        match &sensor.course {
            None => Carrier::Standing(place_m),
            Some(course) => {
                let velocity_mps = Position::new(course.vx_mps, course.vy_mps);
                Carrier::Moving(Course::of_sensor((place_m, velocity_mps), &course.segments))
            }
        }
    }
}

fn pose_at(course: &Course, time_s: f64) -> Pose {
    let point = course.point_at(time_s);
    let velocity = point.velocity.unwrap_or_default();
    Pose {
        velocity,
        attitude: Some(Attitude {
            heading_rad: velocity.x.atan2(velocity.y),
            ..Attitude::default()
        }),
        ..Pose::at(point.position)
    }
}

/// Where a sensor that moves is at time 0.
pub fn first_pose(sensor: &ScenarioSensor) -> Option<Pose> {
    match Carrier::of(sensor) {
        Carrier::Standing(_) => None,
        Carrier::Moving(course) => Some(pose_at(&course, 0.0)),
    }
}
