//! The paths of a scenario's targets: constant velocity from time 0, listed or drawn at random.

use crate::math::rng::{Purpose, Seed};
use crate::model::scenario::{ListedTarget, RandomTargets, Scenario, TargetPlan};
use crate::model::state::Position;
use rand::RngExt;

/// A target that moves with constant velocity.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Path {
    pub truth_id: String,
    pub start_m: Position,
    pub velocity_mps: Position,
}

impl Path {
    pub fn position_at(&self, time_s: f64) -> Position {
        self.start_m + self.velocity_mps * time_s
    }
}

/// The paths of all targets, in the order of the scenario.
pub(super) fn paths(scenario: &Scenario, seed: Seed) -> Vec<Path> {
    match &scenario.targets {
        TargetPlan::Random(plan) => (0..plan.count).map(|index| random_path(plan, index, seed)).collect(),
        TargetPlan::Listed { targets } => targets.iter().map(listed_path).collect(),
    }
}

fn listed_path(target: &ListedTarget) -> Path {
    Path {
        truth_id: target.truth_id.clone(),
        start_m: Position::new(target.x_m, target.y_m),
        velocity_mps: Position::new(target.vx_mps, target.vy_mps),
    }
}

fn random_path(plan: &RandomTargets, index: u32, seed: Seed) -> Path {
    let mut draw = seed.stream(Purpose::TargetStart, u64::from(index), 0);
    let half_m = plan.area_side_m / 2.0;
    let mut between = |low: f64, high: f64| low + (high - low) * draw.random::<f64>();
    let start_m = Position::new(between(-half_m, half_m), between(-half_m, half_m));
    let heading_rad = between(0.0, std::f64::consts::TAU);
    let speed_mps = between(plan.speed_min_mps, plan.speed_max_mps);
    Path { truth_id: (index + 1).to_string(), start_m, velocity_mps: Position::new(heading_rad.sin(), heading_rad.cos()) * speed_mps }
}
