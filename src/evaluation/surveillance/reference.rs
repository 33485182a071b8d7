//! Where a target truly was at the time of an update, how it moved, and what it was doing.

use super::gaps::is_at_most;
use crate::model::space::Place;
use crate::model::space::Space;
use crate::model::truth::{Target, TruthSet};
use serde::Deserialize;
use std::f64::consts::{PI, TAU};

/// A target turns above this rate (rad/s): 1 deg/s.
const TURN_RADPS: f64 = PI / 180.0;
/// A target climbs or descends above this rate (m/s): 300 ft/min.
const CLIMB_MPS: f64 = 300.0 * 0.3048 / 60.0;

/// What a target is doing. It may turn while it climbs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Phase {
    /// Neither of the others.
    Steady,
    /// More than 1 deg/s.
    Turning,
    /// Up or down, more than 300 ft/min.
    Climbing,
}

/// Of a point of the truth.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Doing {
    pub turns: bool,
    pub climbs: bool,
}

impl Phase {
    pub fn name(self) -> &'static str {
        match self {
            Phase::Steady => "steady",
            Phase::Turning => "turning",
            Phase::Climbing => "climbing",
        }
    }

    pub fn holds(self, doing: Doing) -> bool {
        match self {
            Phase::Steady => !doing.turns && !doing.climbs,
            Phase::Turning => doing.turns,
            Phase::Climbing => doing.climbs,
        }
    }
}

/// The truth at a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reference {
    pub place: Place,
    pub height_m: Option<f64>,
    /// Along the ground.
    pub speed_mps: Option<f64>,
    /// Clockwise from north (rad); none of a target that stands.
    pub heading_rad: Option<f64>,
    /// The points beside the time; twice the same where it is that of a point.
    pub beside: [usize; 2],
}

/// The point at a time, else the line between its neighbours, both at most `reach_s` away.
pub fn reference_at(
    truth: &TruthSet,
    target: usize,
    time_s: f64,
    reach_s: f64,
) -> Option<Reference> {
    let (space, target) = (truth.space(), &truth.targets()[target]);
    let after = target.points.partition_point(|point| point.time_s < time_s);
    let next = target.points.get(after)?;
    if next.time_s == time_s {
        let (speed_mps, heading_rad) = motion_of_point(space, target, after);
        return Some(Reference {
            place: next.position,
            height_m: height_at(space, target, after),
            speed_mps,
            heading_rad,
            beside: [after, after],
        });
    }
    let before = after.checked_sub(1)?;
    let last = &target.points[before];
    if !is_at_most(time_s - last.time_s, reach_s) || !is_at_most(next.time_s - time_s, reach_s) {
        return None;
    }
    let share = (time_s - last.time_s) / (next.time_s - last.time_s);
    let heights = (
        height_at(space, target, before),
        height_at(space, target, after),
    );
    let (speed_mps, heading_rad) = motion_between(target, (before, after), share);
    Some(Reference {
        place: last.position + (next.position - last.position) * share,
        height_m: match heights {
            (Some(from_m), Some(to_m)) => Some(from_m + (to_m - from_m) * share),
            (from_m, to_m) => from_m.or(to_m),
        },
        speed_mps,
        heading_rad,
        beside: [before, after],
    })
}

pub fn height_at(space: Space, target: &Target, point: usize) -> Option<f64> {
    let point = &target.points[point];
    let is_high = space == Space::Volume;
    is_high.then_some(point.position.z).or(point.height_m)
}

/// Speed and heading of a velocity.
fn motion(velocity: Place) -> (Option<f64>, Option<f64>) {
    let speed_mps = velocity.xy().norm();
    let heading_rad = velocity.x.atan2(velocity.y);
    (Some(speed_mps), (speed_mps > 0.0).then_some(heading_rad))
}

fn motion_of_point(space: Space, target: &Target, point: usize) -> (Option<f64>, Option<f64>) {
    let time_s = target.points[point].time_s;
    let velocity = target.velocity_at(space, time_s, f64::INFINITY);
    velocity.map_or((None, None), motion)
}

/// The speed on a line, the heading the shorter way round; the slope of the path where velocities are not given.
fn motion_between(
    target: &Target,
    (before, after): (usize, usize),
    share: f64,
) -> (Option<f64>, Option<f64>) {
    let (last, next) = (&target.points[before], &target.points[after]);
    let (Some(from), Some(to)) = (last.velocity, next.velocity) else {
        let slope = (next.position - last.position) / (next.time_s - last.time_s);
        return motion(slope);
    };
    let ((from_mps, from_rad), (to_mps, to_rad)) = (motion(from), motion(to));
    let speed_mps = from_mps
        .zip(to_mps)
        .map(|(from, to)| from + (to - from) * share);
    let heading_rad = match (from_rad, to_rad) {
        (Some(from), Some(to)) => Some(from + shorter_angle(from, to) * share),
        (from, to) => from.or(to),
    };
    (speed_mps, heading_rad)
}

/// From one angle to another the shorter way, −π to π.
pub fn shorter_angle(from_rad: f64, to_rad: f64) -> f64 {
    (to_rad - from_rad + PI).rem_euclid(TAU) - PI
}

/// What a target is doing at each of its points: over the points on both sides.
pub fn doings(space: Space, target: &Target) -> Vec<Doing> {
    let count = target.points.len();
    let motions: Vec<Option<f64>> = (0..count)
        .map(|point| motion_of_point(space, target, point).1)
        .collect();
    let mut doings = Vec::with_capacity(count);
    for point in 0..count {
        let (from, to) = (point.saturating_sub(1), (point + 1).min(count - 1));
        let time_s = target.points[to].time_s - target.points[from].time_s;
        let angles = motions[from].zip(motions[to]);
        let heights = height_at(space, target, from).zip(height_at(space, target, to));
        let turned = angles.map_or(0.0, |(from, to)| shorter_angle(from, to).abs());
        let climbed = heights.map_or(0.0, |(from, to)| (to - from).abs());
        doings.push(Doing {
            turns: turned > TURN_RADPS * time_s,
            climbs: climbed > CLIMB_MPS * time_s,
        });
    }
    doings
}
