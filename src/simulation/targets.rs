//! The paths of a scenario's targets: in the plane with constant velocity from time 0, listed, drawn at random or in formation,
//! where they may weave; or bearings that follow a law.

use super::course::Course;
use super::meeting;
use super::spline::Spline;
use super::weaving::Weave;
use crate::math::rng::{Purpose, Seed};
use crate::model::scenario::{
    BearingTargets, CrossingPair, FormationMotion, FormationTargets, ListedTarget,
    ManeuveringTarget, RandomTargets, Scenario, TargetPlan,
};
use crate::model::space::{Place, Space};
use crate::model::state::Position;
use crate::model::truth::{Target, TruthPoint};
use rand::RngExt;
use std::f64::consts::TAU;

/// A target and how it moves.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Path {
    pub truth_id: String,
    law: Law,
}

#[derive(Debug, Clone, PartialEq)]
enum Law {
    Straight {
        start_m: Position,
        velocity_mps: Position,
    },
    /// Straight on in space.
    Climbing {
        start_m: Place,
        velocity_mps: Place,
    },
    Weaving {
        start_m: Position,
        /// Its speed along its course.
        course_mps: Position,
        weave: Box<Weave>,
    },
    /// One of a pair: the half width is negative for the target that starts on the other side.
    Crossing(CrossingPair),
    Turning {
        bearing_deg: f64,
        rate_degps: f64,
    },
    Recorded(Box<Spline>),
    Maneuvering(Box<Course>),
}

impl Path {
    pub fn point_at(&self, time_s: f64) -> TruthPoint {
        match self.law {
            Law::Straight {
                start_m,
                velocity_mps,
            } => TruthPoint::in_plane(time_s, start_m + velocity_mps * time_s, Some(velocity_mps)),
            Law::Climbing {
                start_m,
                velocity_mps,
            } => TruthPoint::in_space(time_s, start_m + velocity_mps * time_s, velocity_mps),
            Law::Weaving {
                start_m,
                course_mps,
                ref weave,
            } => weaving_at(start_m, course_mps, weave, time_s),
            Law::Crossing(pair) => at_bearing(time_s, pair.bearing_deg(time_s)),
            Law::Turning {
                bearing_deg,
                rate_degps,
            } => at_bearing(time_s, bearing_deg + rate_degps * time_s),
            Law::Recorded(ref spline) => spline.point_at(time_s),
            Law::Maneuvering(ref course) => course.point_at(time_s),
        }
    }

    /// A target that goes along a curve: one that was recorded, or that meets others.
    pub fn recorded(truth_id: String, spline: Spline) -> Self {
        Path {
            truth_id,
            law: Law::Recorded(Box::new(spline)),
        }
    }

    /// Whether there is a target at a time: one that was recorded, or has a course of its own, comes and goes.
    pub fn exists_at(&self, time_s: f64) -> bool {
        match &self.law {
            Law::Recorded(spline) => spline.exists_at(time_s),
            Law::Maneuvering(course) => course.exists_at(time_s),
            _ => true,
        }
    }

    /// The target at these times.
    pub fn truth_at(&self, times_s: &[f64]) -> Target {
        Target {
            truth_id: self.truth_id.clone(),
            points: times_s
                .iter()
                .map(|&time_s| self.point_at(time_s))
                .collect(),
        }
    }

    /// 0 where only the direction is known.
    pub fn speed_mps(&self) -> f64 {
        match &self.law {
            Law::Straight { velocity_mps, .. } => velocity_mps.norm(),
            Law::Climbing { velocity_mps, .. } => velocity_mps.norm(),
            Law::Weaving { course_mps, .. } => course_mps.norm(),
            Law::Crossing(_) | Law::Turning { .. } => 0.0,
            Law::Recorded(spline) => spline.fastest_mps(),
            Law::Maneuvering(course) => course.fastest_mps(),
        }
    }
}

fn at_bearing(time_s: f64, bearing_deg: f64) -> TruthPoint {
    TruthPoint::at_bearing(time_s, bearing_deg.to_radians().rem_euclid(TAU))
}

fn weaving_at(start_m: Position, course_mps: Position, weave: &Weave, time_s: f64) -> TruthPoint {
    let right_mps = Position::new(course_mps[1], -course_mps[0]);
    let moved_s = weave.displacement_s(time_s);
    let (across, along) = weave.heading_rad(time_s).sin_cos();
    TruthPoint::in_plane(
        time_s,
        start_m + course_mps * moved_s[0] + right_mps * moved_s[1],
        Some(course_mps * along + right_mps * across),
    )
}

impl CrossingPair {
    /// c − h sgn(u) |u|ᵖ with u = 1 − t/t×.
    fn bearing_deg(&self, time_s: f64) -> f64 {
        let to_go = 1.0 - time_s / self.crossing_time_s;
        self.centre_deg - self.half_width_deg * to_go.signum() * to_go.abs().powf(self.power)
    }
}

/// The paths of all targets, in the order of the scenario.
pub(super) fn paths(scenario: &Scenario, seed: Seed) -> Vec<Path> {
    match &scenario.targets {
        TargetPlan::Random(plan) => (0..plan.count)
            .map(|index| random_path(plan, index, seed))
            .collect(),
        TargetPlan::Listed { targets } => {
            let is_in_volume = scenario.targets.space() == Space::Volume;
            let path = |target| listed_path(target, is_in_volume);
            targets.iter().map(path).collect()
        }
        TargetPlan::Maneuvering { targets } => {
            let space = scenario.targets.space();
            targets
                .iter()
                .map(|target| maneuvering_path(target, space))
                .collect()
        }
        TargetPlan::Bearings(plan) => bearing_paths(plan),
        TargetPlan::Formation(plan) => formation(plan, seed),
        TargetPlan::Meeting(plan) => {
            let curves = meeting::curves(plan, scenario, seed)
                .into_iter()
                .enumerate();
            curves
                .map(|(index, curve)| Path::recorded((index + 1).to_string(), curve))
                .collect()
        }
        // Those come from the recording.
        TargetPlan::Recorded(_) => Vec::new(),
    }
}

/// The names of the targets of bearings, in the order of their paths, with the place in the scenario of those that it tells.
pub(super) fn bearing_names(
    plan: &BearingTargets,
) -> impl Iterator<Item = (String, Option<usize>)> {
    let crossing = (1..=2 * plan.crossings.len()).map(|number| (number.to_string(), None));
    crossing.chain(
        plan.lines
            .iter()
            .enumerate()
            .map(|(index, line)| (line.truth_id.clone(), Some(index))),
    )
}

fn bearing_paths(plan: &BearingTargets) -> Vec<Path> {
    let mut laws = Vec::new();
    for pair in &plan.crossings {
        for side in [1.0, -1.0] {
            laws.push(Law::Crossing(CrossingPair {
                half_width_deg: side * pair.half_width_deg,
                ..*pair
            }));
        }
    }
    for line in &plan.lines {
        laws.push(Law::Turning {
            bearing_deg: line.bearing_deg,
            rate_degps: line.rate_degps,
        });
    }
    bearing_names(plan)
        .zip(laws)
        .map(|((truth_id, _), law)| Path { truth_id, law })
        .collect()
}

fn listed_path(target: &ListedTarget, is_in_volume: bool) -> Path {
    let start_m = Position::new(target.x_m, target.y_m);
    let velocity_mps = Position::new(target.vx_mps, target.vy_mps);
    let law = if is_in_volume {
        Law::Climbing {
            start_m: start_m.push(target.z_m.unwrap_or(0.0)),
            velocity_mps: velocity_mps.push(target.vz_mps.unwrap_or(0.0)),
        }
    } else {
        Law::Straight {
            start_m,
            velocity_mps,
        }
    };
    Path {
        truth_id: target.truth_id.clone(),
        law,
    }
}

fn maneuvering_path(target: &ManeuveringTarget, space: Space) -> Path {
    Path {
        truth_id: target.truth_id.clone(),
        law: Law::Maneuvering(Box::new(Course::of(target, space))),
    }
}

/// The speed of the fastest leg of a target's course.
pub fn fastest_mps(target: &ManeuveringTarget) -> f64 {
    Course::of(target, Space::Volume).fastest_mps()
}

fn random_path(plan: &RandomTargets, index: u32, seed: Seed) -> Path {
    let mut draw = seed.stream(Purpose::TargetStart, u64::from(index), 0);
    let half_m = plan.area_side_m / 2.0;
    let mut between = |low: f64, high: f64| low + (high - low) * draw.random::<f64>();
    let start_m = Position::new(between(-half_m, half_m), between(-half_m, half_m));
    let heading_rad = between(0.0, TAU);
    let speed_mps = between(plan.speed_min_mps, plan.speed_max_mps);
    let velocity_mps = Position::new(heading_rad.sin(), heading_rad.cos()) * speed_mps;
    Path {
        truth_id: (index + 1).to_string(),
        law: Law::Straight {
            start_m,
            velocity_mps,
        },
    }
}

/// Row by row from the south-west. The stream of entity 0 draws the course, that of entity k the k-th target.
fn formation(plan: &FormationTargets, seed: Seed) -> Vec<Path> {
    let heading_rad = TAU * seed.stream(Purpose::Formation, 0, 0).random::<f64>();
    let course_mps = Position::new(heading_rad.sin(), heading_rad.cos()) * plan.speed_mps;
    let places = (0..plan.rows).flat_map(|row| (0..plan.columns).map(move |column| (column, row)));
    let mut paths = Vec::new();
    for (index, (column, row)) in places.enumerate() {
        let mut draw = seed.stream(Purpose::Formation, index as u64 + 1, 0);
        let mut place_m = |number: u32, count: u32| {
            let displacement = plan.displacement * (2.0 * draw.random::<f64>() - 1.0);
            plan.spacing_m * (f64::from(number) - f64::from(count - 1) / 2.0 + displacement)
        };
        let start_m = Position::new(place_m(column, plan.columns), place_m(row, plan.rows));
        let law = match plan.motion {
            FormationMotion::ConstantVelocity => Law::Straight {
                start_m,
                velocity_mps: course_mps,
            },
            FormationMotion::Weaving {
                heading_amplitude_deg,
                period_s,
            } => {
                let weave = Box::new(Weave::new(
                    heading_amplitude_deg.to_radians(),
                    period_s,
                    TAU * draw.random::<f64>(),
                ));
                Law::Weaving {
                    start_m,
                    course_mps,
                    weave,
                }
            }
        };
        paths.push(Path {
            truth_id: (index + 1).to_string(),
            law,
        });
    }
    paths
}
