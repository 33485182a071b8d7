//! Targets that meet: close to each other at one time, before and after it each on its own course of nearly constant velocity.
//!
//! # Reference
//! J. L. Williams, Marginal Multi-Bernoulli Filters: RFS Derivation of MHT, JIPDA, and Association-Based MeMBer, IEEE Transactions
//! on Aerospace and Electronic Systems 51(3), 2015 (the scene of its simulations).
//!
//! # Symbols
//! q process noise (m²/s³), T time between scans; a, b standard normal, for each coordinate and scan.
//!
//! # Method
//! 1. At the scan of the meeting each coordinate is normal about the place, each component of the velocity normal about 0.
//! 2. From scan to scan p ← p + T v + w, v ← v + u with w = √(q T³ / 3) a and u = √(q T) (√3 a + b) / 2, which have the covariance of
//!    nearly constant velocity. Before the meeting the same backwards: v ← v − u, p ← p − w − T v.
//!
//! Between scans a target is on the curve through its places at the scans.

use super::spline::Spline;
use crate::math::rng::{Purpose, Seed};
use crate::model::scenario::{MeetingTargets, Scenario};
use crate::model::state::Position;
use crate::model::truth::TruthPoint;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// The curves of the targets. Those that leave do so before the scan of the meeting.
pub(super) fn curves(plan: &MeetingTargets, scenario: &Scenario, seed: Seed) -> Vec<Spline> {
    let mut curves = Vec::new();
    for index in 0..plan.count {
        let mut draw = seed.stream(Purpose::TargetStart, u64::from(index), 0);
        let mut points = walk(plan, scenario, &mut draw);
        if index < plan.leaving {
            points.truncate(meeting_scan(plan, scenario).max(1));
        }
        curves.push(Spline::through(&points, 1.5 * scenario.scan_period_s));
    }
    curves
}

/// Number of the first scan at or after the meeting, from 0 on.
fn meeting_scan(plan: &MeetingTargets, scenario: &Scenario) -> usize {
    let scans = (plan.meeting_s / scenario.scan_period_s).ceil() as usize;
    scans.min(scenario.scans as usize - 1)
}

fn walk(plan: &MeetingTargets, scenario: &Scenario, draw: &mut ChaCha8Rng) -> Vec<TruthPoint> {
    let period_s = scenario.scan_period_s;
    let meeting = meeting_scan(plan, scenario);
    let start_m = Position::new(plan.x_m, plan.y_m) + pair(draw) * plan.sigma_m;
    let start_mps = pair(draw) * plan.speed_sigma_mps;
    let mut places_m = vec![start_m];
    let (mut place_m, mut velocity_mps) = (start_m, start_mps);
    for _ in 0..meeting {
        let (more_m, more_mps) = noise(plan, period_s, draw);
        velocity_mps -= more_mps;
        place_m -= more_m + velocity_mps * period_s;
        places_m.push(place_m);
    }
    places_m.reverse();
    (place_m, velocity_mps) = (start_m, start_mps);
    for _ in meeting + 1..scenario.scans as usize {
        let (more_m, more_mps) = noise(plan, period_s, draw);
        place_m += velocity_mps * period_s + more_m;
        velocity_mps += more_mps;
        places_m.push(place_m);
    }
    let places = places_m.into_iter().enumerate();
    places
        .map(|(scan, place_m)| TruthPoint::in_plane(scan as f64 * period_s, place_m, None))
        .collect()
}

/// What the noise adds between two scans to a place and to a velocity.
fn noise(plan: &MeetingTargets, period_s: f64, draw: &mut ChaCha8Rng) -> (Position, Position) {
    let (a, b) = (pair(draw), pair(draw));
    let q = plan.process_noise_m2ps3;
    let place_m = a * (q * period_s.powi(3) / 3.0).sqrt();
    (
        place_m,
        (a * 3.0f64.sqrt() + b) * (q * period_s).sqrt() / 2.0,
    )
}

fn pair(draw: &mut ChaCha8Rng) -> Position {
    Position::from_fn(|_, _| StandardNormal.sample(draw))
}
