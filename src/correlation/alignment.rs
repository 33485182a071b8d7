//! Brings the tracks of several sensors to common times: each is predicted with nearly constant velocity from its last point
//! before a time to that time.
//!
//! # Reference
//! Y. Bar-Shalom, X. R. Li, T. Kirubarajan, Estimation with Applications to Tracking and Navigation, Wiley 2001, section 6.2.
//!
//! # Symbols
//! x̂, P state and covariance of a track; F(Δ), Q(Δ) transition and process noise of a time step Δ.
//!
//! # Method
//! 1. Common times are those of one set of tracks, or equally far apart.
//! 2. A track says x̂ ← F x̂, P ← F P Fᵀ + Q at every common time that is not before its first point and at most a given gap
//!    after its last point before that time.
//! 3. Tracks without velocities are not predicted: they count at the times of their own points.
//! 4. Times at which fewer than two sensors have a track are dropped.

use super::estimates::Estimates;
use crate::model::motion::constant_velocity::ConstantVelocity;
use crate::model::state::{Covariance, GaussianState};
use crate::model::track::{Kinematics, Track, TrackPoint, TrackSet};

/// Times that differ by less are the same: files round them.
const SAME_TIME_S: f64 = 1e-6;

/// The tracks of one sensor.
#[derive(Debug, Clone)]
pub struct Node {
    pub sensor_id: String,
    pub tracks: TrackSet,
}

/// What is assumed where tracks carry no covariance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Assumed {
    pub sigma_m: f64,
    /// Where it is absent velocities without covariance are not used.
    pub sigma_mps: Option<f64>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Alignment {
    pub process_noise_m2ps3: f64,
    pub max_gap_s: f64,
    pub assumed: Option<Assumed>,
}

/// The tracks at the given times, and how many estimates had to be left out since their covariance has no inverse.
pub fn align(nodes: &[Node], times_s: &[f64], alignment: &Alignment) -> (Estimates, usize) {
    let has_velocity = nodes
        .iter()
        .all(|node| has_velocity(&node.tracks, alignment.assumed));
    let times_s = shared_times(nodes, times_s, alignment.max_gap_s, has_velocity);
    let names = |node: &Node| {
        (
            node.sensor_id.clone(),
            node.tracks
                .tracks
                .iter()
                .map(|track| track.track_id.clone())
                .collect(),
        )
    };
    let mut estimates = Estimates::new(nodes.iter().map(names).collect(), times_s, has_velocity);
    let motion = ConstantVelocity {
        spectral_density: alignment.process_noise_m2ps3,
    };
    let tracks: Vec<&Track> = nodes.iter().flat_map(|node| &node.tracks.tracks).collect();
    let mut left_out = 0;
    for (index, track) in tracks.into_iter().enumerate() {
        for time in 0..estimates.times() {
            let time_s = estimates.times_s[time];
            let Some(point) = last_point(track, time_s, gap_s(alignment.max_gap_s, has_velocity))
            else {
                continue;
            };
            let Some(mut state) = state_of(&point.estimate, alignment.assumed) else {
                continue;
            };
            predict(&mut state, motion, (time_s - point.time_s).max(0.0));
            left_out += usize::from(!estimates.set(index, time, &state));
        }
    }
    (estimates, left_out)
}

/// Whether every point of the tracks has a velocity that can be compared.
pub fn has_velocity(tracks: &TrackSet, assumed: Option<Assumed>) -> bool {
    let mut points = tracks.tracks.iter().flat_map(|track| &track.points);
    let is_assumed = assumed.is_some_and(|assumed| assumed.sigma_mps.is_some());
    points.all(|TrackPoint { estimate, .. }| {
        estimate.velocity.is_some() && (estimate.covariance.is_some() || is_assumed)
    })
}

/// The times of all points, each once.
pub fn times_of(tracks: &TrackSet) -> Vec<f64> {
    let mut times_s: Vec<f64> = tracks
        .tracks
        .iter()
        .flat_map(|track| track.points.iter().map(|point| point.time_s))
        .collect();
    times_s.sort_by(f64::total_cmp);
    times_s.dedup_by(|later, earlier| *later - *earlier < SAME_TIME_S);
    times_s
}

fn gap_s(max_gap_s: f64, has_velocity: bool) -> f64 {
    if has_velocity {
        max_gap_s.max(SAME_TIME_S)
    } else {
        SAME_TIME_S
    }
}

/// The times at which two sensors or more have a track.
fn shared_times(nodes: &[Node], times_s: &[f64], max_gap_s: f64, has_velocity: bool) -> Vec<f64> {
    let gap_s = gap_s(max_gap_s, has_velocity);
    let is_there = |node: &&Node, time_s: f64| {
        let mut tracks = node.tracks.tracks.iter();
        tracks.any(|track| last_point(track, time_s, gap_s).is_some())
    };
    let mut shared = Vec::new();
    for &time_s in times_s {
        let present = nodes.iter().filter(|node| is_there(node, time_s));
        if present.take(2).count() == 2 {
            shared.push(time_s);
        }
    }
    shared
}

/// The last point of a track at or before a time, unless it is older than the gap.
fn last_point(track: &Track, time_s: f64, max_gap_s: f64) -> Option<&TrackPoint> {
    let after = track
        .points
        .partition_point(|point| point.time_s <= time_s + SAME_TIME_S);
    track.points[..after]
        .last()
        .filter(|point| time_s - point.time_s <= max_gap_s)
}

/// The state with its covariance, or with the one that is assumed.
fn state_of(estimate: &Kinematics, assumed: Option<Assumed>) -> Option<GaussianState> {
    let covariance = estimate.covariance().or_else(|| {
        let assumed = assumed?;
        let (position, velocity) = (
            assumed.sigma_m.powi(2),
            assumed.sigma_mps.unwrap_or(1.0).powi(2),
        );
        Some(Covariance::from_diagonal(&nalgebra::Vector4::new(
            position, position, velocity, velocity,
        )))
    })?;
    Some(GaussianState {
        mean: estimate.state(),
        covariance,
    })
}

/// x̂ ← F x̂, P ← F P Fᵀ + Q.
pub(super) fn predict(state: &mut GaussianState, motion: ConstantVelocity, dt_s: f64) {
    if dt_s > 0.0 {
        let transition = transition(dt_s);
        state.mean = transition * state.mean;
        state.covariance = transition * state.covariance * transition.transpose()
            + motion.process_noise::<4>(dt_s);
    }
}

/// F(Δ).
pub(super) fn transition(dt_s: f64) -> Covariance {
    let mut transition = Covariance::identity();
    transition[(0, 2)] = dt_s;
    transition[(1, 3)] = dt_s;
    transition
}
