//! The paths of a scenario's targets: listed, drawn at random, or in formation.

use super::weaving::Weave;
use crate::math::rng::{Purpose, Seed};
use crate::model::scenario::{FormationMotion, FormationTargets, ListedTarget, RandomTargets, Scenario, TargetPlan};
use crate::model::state::Position;
use rand::RngExt;
use std::f64::consts::TAU;

/// A target that moves with constant speed from time 0.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Path {
    pub truth_id: String,
    pub start_m: Position,
    /// The velocity; of a target that weaves, its speed along its course.
    pub course_mps: Position,
    /// `None` for a straight path.
    pub weave: Option<Weave>,
}

impl Path {
    pub fn position_at(&self, time_s: f64) -> Position {
        match &self.weave {
            None => self.start_m + self.course_mps * time_s,
            Some(weave) => {
                let moved_s = weave.displacement_s(time_s);
                self.start_m + self.course_mps * moved_s[0] + right_of(&self.course_mps) * moved_s[1]
            }
        }
    }

    pub fn velocity_at(&self, time_s: f64) -> Position {
        let Some(weave) = &self.weave else { return self.course_mps };
        let (across, along) = weave.heading_rad(time_s).sin_cos();
        self.course_mps * along + right_of(&self.course_mps) * across
    }

    pub fn speed_mps(&self) -> f64 {
        self.course_mps.norm()
    }
}

/// Turned by 90° clockwise.
fn right_of(direction: &Position) -> Position {
    Position::new(direction[1], -direction[0])
}

/// The paths of all targets, in the order of the scenario.
pub(super) fn paths(scenario: &Scenario, seed: Seed) -> Vec<Path> {
    match &scenario.targets {
        TargetPlan::Random(plan) => (0..plan.count).map(|index| random_path(plan, index, seed)).collect(),
        TargetPlan::Listed { targets } => targets.iter().map(listed_path).collect(),
        TargetPlan::Formation(plan) => formation(plan, seed),
    }
}

fn listed_path(target: &ListedTarget) -> Path {
    Path {
        truth_id: target.truth_id.clone(),
        start_m: Position::new(target.x_m, target.y_m),
        course_mps: Position::new(target.vx_mps, target.vy_mps),
        weave: None,
    }
}

fn random_path(plan: &RandomTargets, index: u32, seed: Seed) -> Path {
    let mut draw = seed.stream(Purpose::TargetStart, u64::from(index), 0);
    let half_m = plan.area_side_m / 2.0;
    let mut between = |low: f64, high: f64| low + (high - low) * draw.random::<f64>();
    let start_m = Position::new(between(-half_m, half_m), between(-half_m, half_m));
    let heading_rad = between(0.0, TAU);
    let speed_mps = between(plan.speed_min_mps, plan.speed_max_mps);
    let course_mps = Position::new(heading_rad.sin(), heading_rad.cos()) * speed_mps;
    Path { truth_id: (index + 1).to_string(), start_m, course_mps, weave: None }
}

/// Row by row from the south-west. The stream of entity 0 draws the course, that of entity k the k-th target.
fn formation(plan: &FormationTargets, seed: Seed) -> Vec<Path> {
    let heading_rad = TAU * seed.stream(Purpose::Formation, 0, 0).random::<f64>();
    let course_mps = Position::new(heading_rad.sin(), heading_rad.cos()) * plan.speed_mps;
    let places = (0..plan.rows).flat_map(|row| (0..plan.columns).map(move |column| (column, row)));
    let path = |(index, (column, row)): (usize, (u32, u32))| {
        let mut draw = seed.stream(Purpose::Formation, index as u64 + 1, 0);
        let mut place_m = |number: u32, count: u32| {
            let displacement = plan.displacement * (2.0 * draw.random::<f64>() - 1.0);
            plan.spacing_m * (f64::from(number) - f64::from(count - 1) / 2.0 + displacement)
        };
        let start_m = Position::new(place_m(column, plan.columns), place_m(row, plan.rows));
        let weave = match plan.motion {
            FormationMotion::ConstantVelocity => None,
            FormationMotion::Weaving { heading_amplitude_deg, period_s } => {
                Some(Weave::new(heading_amplitude_deg.to_radians(), period_s, TAU * draw.random::<f64>()))
            }
        };
        Path { truth_id: (index + 1).to_string(), start_m, course_mps, weave }
    };
    places.enumerate().map(path).collect()
}
