//! Tracks of several sensors without the sensors: the truth with the errors that their covariances tell. Cheap, and exact in what
//! is true, which is what comparing correlators needs.
//!
//! # Symbols
//! P = diag(σ², σ², σ_v², σ_v²) covariance of every estimate; ρ correlation of a track's errors from one time to the next; γ
//! correlation of the errors of two sensors' tracks of one target.
//!
//! # Method
//! 1. Targets stand row by row in a square, each displaced at random, and move on one course that is drawn.
//! 2. Each sensor has a track of each target with probability P_D; its errors are e ← ρ e + √(1 − ρ²) w with w from N(0, P), white in
//!    time for ρ = 0, and all its tracks are displaced by its bias, in a direction of its own. w = √γ c + √(1 − γ) v with c drawn
//!    once for all sensors: P_ij = γ P, as filters have it that meet one manoeuvre.
//! 3. A Poisson number of false tracks a sensor lies anywhere in the square, on the same course.
//! 4. The tracks of a sensor are in a random order.

use crate::math::rng::{Purpose, Seed};
use crate::model::space::Space;
use crate::model::state::{Covariance, Position, State};
use crate::model::track::{Kinematics, Track, TrackPoint, TrackSet};
use crate::model::truth::{Target, TruthPoint, TruthSet};
use crate::registry::{Bound, Kind, Object, above, default, number, whole};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Poisson, StandardNormal};
use serde::Deserialize;
use std::f64::consts::TAU;

const LENGTH: Kind = above(0.0, 1e9, "m");
const SHARE: Kind = Kind::Number {
    min: Bound::Including(0.0),
    max: Bound::Excluding(1.0),
    unit: "",
};

pub static LOCAL_TRACKS: Object = Object {
    name: "LocalTracks",
    summary: "Tracks of several sensors, drawn: the truth with errors of known covariance, without detections and trackers.",
    fields: &[
        default("sensors", "Sensors.", whole(1, 64, ""), "3"),
        default("targets", "Targets.", whole(1, 100_000, ""), "10"),
        default(
            "spacing_m",
            "Distance between neighbouring targets of the square in which they move.",
            LENGTH,
            "500.0",
        ),
        default(
            "jitter",
            "Largest displacement of a target from its place along each axis, in spacings.",
            SHARE,
            "0.3",
        ),
        default(
            "speed_mps",
            "Speed of all targets, on one course.",
            number(0.0, 1e5, "m/s"),
            "200.0",
        ),
        default(
            "sigma_m",
            "Standard deviation of x and of y.",
            LENGTH,
            "100.0",
        ),
        default(
            "sigma_mps",
            "Standard deviation of each component of the velocity.",
            above(0.0, 1e5, "m/s"),
            "10.0",
        ),
        default(
            "p_d",
            "Probability that a sensor has a track of a target.",
            above(0.0, 1.0, ""),
            "1.0",
        ),
        default(
            "false_tracks",
            "Mean number of tracks of a sensor that are of no target.",
            number(0.0, 1e5, ""),
            "0.0",
        ),
        default(
            "bias_m",
            "Displacement of all tracks of a sensor, in a direction of its own.",
            number(0.0, 1e9, "m"),
            "0.0",
        ),
        default(
            "correlation",
            "Correlation of a track's errors from one time to the next; 0 is white.",
            SHARE,
            "0.0",
        ),
        default(
            "cross_correlation",
            "Correlation of the errors of two sensors' tracks of one target.",
            SHARE,
            "0.0",
        ),
        default(
            "times",
            "Times at which every track says something.",
            whole(1, 10_000, ""),
            "4",
        ),
        default(
            "period_s",
            "Time between them.",
            above(0.0, 1e6, "s"),
            "2.0",
        ),
    ],
};

/// A checked [`LOCAL_TRACKS`].
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct LocalTracks {
    pub sensors: u32,
    pub targets: u32,
    pub spacing_m: f64,
    pub jitter: f64,
    pub speed_mps: f64,
    pub sigma_m: f64,
    pub sigma_mps: f64,
    pub p_d: f64,
    pub false_tracks: f64,
    pub bias_m: f64,
    pub correlation: f64,
    pub cross_correlation: f64,
    pub times: u32,
    pub period_s: f64,
}

/// The tracks of one sensor.
#[derive(Debug, Clone, PartialEq)]
pub struct SensorTracks {
    pub sensor_id: String,
    pub tracks: TrackSet,
    /// For each track the target that it is of, by its place in the truth.
    pub origins: Vec<Option<u32>>,
}

impl LocalTracks {
    /// Points of tracks to expect.
    pub fn points(&self) -> f64 {
        f64::from(self.sensors)
            * (f64::from(self.targets) * self.p_d + self.false_tracks)
            * f64::from(self.times)
    }

    fn side(&self) -> u32 {
        f64::from(self.targets).sqrt().ceil() as u32
    }

    fn covariance(&self) -> Covariance {
        let (position, velocity) = (self.sigma_m.powi(2), self.sigma_mps.powi(2));
        Covariance::from_diagonal(&State::new(position, position, velocity, velocity))
    }
}

/// Draws the tracks of all sensors, and the truth behind them.
///
/// # Errors
/// Those of [`TruthSet::new`]: times or places that are not finite.
pub fn simulate_local_tracks(
    plan: &LocalTracks,
    seed: Seed,
) -> Result<(Vec<SensorTracks>, TruthSet), Vec<crate::model::fault::Fault>> {
    let heading_rad = TAU * seed.stream(Purpose::LocalTracks, 0, 0).random::<f64>();
    let course_mps = Position::new(heading_rad.sin(), heading_rad.cos()) * plan.speed_mps;
    let starts_m: Vec<Position> = (0..plan.targets)
        .map(|target| place(plan, target, seed))
        .collect();
    let sensors = (0..plan.sensors)
        .map(|sensor| tracks_of(plan, sensor, &starts_m, course_mps, seed))
        .collect();
    let mut targets = Vec::new();
    for (index, start_m) in starts_m.iter().enumerate() {
        let point = |time: u32| {
            let time_s = f64::from(time) * plan.period_s;
            TruthPoint::in_plane(time_s, start_m + course_mps * time_s, Some(course_mps))
        };
        targets.push(Target {
            truth_id: (index + 1).to_string(),
            points: (0..plan.times).map(point).collect(),
        });
    }
    Ok((sensors, TruthSet::new(Space::Plane, targets)?))
}

/// Where a target begins; the stream of entity k draws the k-th.
fn place(plan: &LocalTracks, target: u32, seed: Seed) -> Position {
    let mut draw = seed.stream(Purpose::LocalTracks, u64::from(target) + 1, 0);
    let side = plan.side();
    let mut along = |number: u32| {
        plan.spacing_m * (f64::from(number) + plan.jitter * (2.0 * draw.random::<f64>() - 1.0))
    };
    Position::new(along(target % side), along(target / side))
}

fn tracks_of(
    plan: &LocalTracks,
    sensor: u32,
    starts_m: &[Position],
    course_mps: Position,
    seed: Seed,
) -> SensorTracks {
    let entity = u64::from(sensor + 1) << 32;
    let mut draw = seed.stream(Purpose::LocalTracks, entity, 0);
    let bias_rad = TAU * draw.random::<f64>();
    let bias_m = Position::new(bias_rad.sin(), bias_rad.cos()) * plan.bias_m;
    let false_tracks =
        Poisson::new(plan.false_tracks).map_or(0.0, |count| count.sample(&mut draw)) as u64;
    let mut found: Vec<(u64, Option<u32>, Track)> = Vec::new();
    for (target, start_m) in starts_m.iter().enumerate() {
        let mut draw = seed.stream(Purpose::LocalTracks, entity + target as u64 + 1, 0);
        if draw.random::<f64>() < plan.p_d {
            let order = draw.random();
            let mut common = seed.stream(Purpose::LocalTracks, target as u64 + 1, 1);
            found.push((
                order,
                Some(target as u32),
                track(plan, start_m + bias_m, course_mps, &mut draw, &mut common),
            ));
        }
    }
    for number in 0..false_tracks {
        let mut draw = seed.stream(Purpose::LocalTracks, entity + number + 1, 1);
        let mut anywhere =
            || plan.spacing_m * (f64::from(plan.side()) * draw.random::<f64>() - 0.5);
        let start_m = Position::new(anywhere(), anywhere());
        let order = draw.random();
        let mut common = seed.stream(Purpose::LocalTracks, entity + number + 1, 2);
        found.push((
            order,
            None,
            track(plan, start_m + bias_m, course_mps, &mut draw, &mut common),
        ));
    }
    found.sort_by_key(|(order, ..)| *order);
    let origins = found.iter().map(|(_, origin, _)| *origin).collect();
    let mut tracks: Vec<Track> = found.into_iter().map(|(.., track)| track).collect();
    for (index, track) in tracks.iter_mut().enumerate() {
        track.track_id = (index + 1).to_string();
    }
    let sensor_id = (sensor + 1).to_string();
    let tracks = TrackSet {
        tracks,
        sensor_ids: vec![sensor_id.clone()],
        ..TrackSet::default()
    };
    SensorTracks {
        sensor_id,
        tracks,
        origins,
    }
}

/// `draw` is the track's own stream, `common` that of all tracks of its target.
fn track(
    plan: &LocalTracks,
    start_m: Position,
    course_mps: Position,
    draw: &mut ChaCha8Rng,
    common: &mut ChaCha8Rng,
) -> Track {
    let covariance = plan.covariance();
    let mut error = draw_error(plan, draw, common);
    let mut points = Vec::with_capacity(plan.times as usize);
    for time in 0..plan.times {
        if time > 0 {
            let fresh = draw_error(plan, draw, common) * (1.0 - plan.correlation.powi(2)).sqrt();
            error = error * plan.correlation + fresh;
        }
        let time_s = f64::from(time) * plan.period_s;
        let position_m = start_m + course_mps * time_s;
        let state = State::new(position_m[0], position_m[1], course_mps[0], course_mps[1]) + error;
        points.push(TrackPoint {
            height_m: None,
            time_s,
            sensor: Some(0),
            estimate: Kinematics::of_plane(&state, true, Some(&covariance)),
            status: None,
            nis: None,
            known_at_s: None,
            existence: None,
            mode_row: None,
            first_candidate: 0,
            candidates: 0,
        });
    }
    Track {
        track_id: String::new(),
        points,
    }
}

/// One error of the plan's covariance; what all tracks of a target share of it comes from `common`.
fn draw_error(plan: &LocalTracks, draw: &mut ChaCha8Rng, common: &mut ChaCha8Rng) -> State {
    let shared = if plan.cross_correlation > 0.0 {
        draw_normal(common) * plan.cross_correlation.sqrt()
    } else {
        State::zeros()
    };
    let mixed = shared + draw_normal(draw) * (1.0 - plan.cross_correlation).sqrt();
    mixed.component_mul(&plan.covariance().map_diagonal(f64::sqrt))
}

fn draw_normal(stream: &mut ChaCha8Rng) -> State {
    State::from_fn(|_, _| StandardNormal.sample(stream))
}
