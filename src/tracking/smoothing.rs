//! Smoothing: what is believed of a track at each scan in the light of the scans after it, of all or of those within a lag.
//!
//! # Method
//! From the last scan back, each belief takes what the next one learned ([`Filter::smooth`]). With a lag each scan has its own way
//! back, from the last scan within the lag.
//!
//! A point says then what was not known at its time. Which detections a track took stays as it was decided, and so does its life.

use crate::filtering::{AnyFilter, Filter, WithFilter};
use crate::registry::{Object, Union, above, default, variant};
use serde::Deserialize;

/// How far ahead each estimate looks.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(tag = "method", rename_all = "snake_case")]
pub enum Smoothing {
    /// To the end of the track.
    FixedInterval,
    FixedLag {
        lag_s: f64,
    },
}

static FIXED_INTERVAL: Object = Object {
    name: "FixedIntervalSmoothing",
    summary: "Each estimate takes in all scans of the recording: for what is looked at afterwards.",
    fields: &[],
};

static FIXED_LAG: Object = Object {
    name: "FixedLagSmoothing",
    summary: "Each estimate takes in the scans up to lag_s later: for a display that may be late.",
    fields: &[default(
        "lag_s",
        "How much later a scan may be to matter.",
        above(0.0, 1e5, "s"),
        "30.0",
    )],
};

pub static SMOOTHING: Union = Union {
    name: "Smoothing",
    summary: "How far ahead each estimate looks.",
    tag: "method",
    variants: || {
        vec![
            variant("fixed_interval", &FIXED_INTERVAL),
            variant("fixed_lag", &FIXED_LAG),
        ]
    },
};

/// The beliefs of a track as [`Filter::pack`] wrote them, in order of time.
#[derive(Debug, Default)]
pub(super) struct PackedBeliefs<'a> {
    pub times_s: Vec<f64>,
    pub beliefs: Vec<&'a [f64]>,
}

/// What is believed of a track in the light of what came after: values of all its points, one after the other.
#[derive(Debug, Default)]
pub(super) struct Smoothed {
    /// Packed kinematics.
    pub kinematics: Vec<f64>,
    /// Probabilities of the motion models.
    pub modes: Vec<f64>,
}

/// Smooths each track.
pub(super) fn smooth(
    filter: &AnyFilter,
    smoothing: Smoothing,
    tracks: &[PackedBeliefs],
) -> Vec<Smoothed> {
    filter.with(Work { smoothing, tracks })
}

struct Work<'a> {
    smoothing: Smoothing,
    tracks: &'a [PackedBeliefs<'a>],
}

impl WithFilter for Work<'_> {
    type Output = Vec<Smoothed>;

    fn in_plane<F: Filter<4>>(self, filter: F) -> Vec<Smoothed> {
        self.run(&filter)
    }

    fn in_volume<F: Filter<6>>(self, filter: F) -> Vec<Smoothed> {
        self.run(&filter)
    }

    fn of_bearings<F: Filter<2>>(self, filter: F) -> Vec<Smoothed> {
        self.run(&filter)
    }
}

impl Work<'_> {
    fn run<F: Filter<K>, const K: usize>(&self, filter: &F) -> Vec<Smoothed> {
        let mut smoothed = Vec::with_capacity(self.tracks.len());
        for track in self.tracks {
            let beliefs: Vec<F::Belief> = track
                .beliefs
                .iter()
                .filter_map(|packed| F::unpack(packed))
                .collect();
            debug_assert_eq!(
                beliefs.len(),
                track.beliefs.len(),
                "beliefs are of the filter"
            );
            smoothed.push(match self.smoothing {
                Smoothing::FixedInterval => fixed_interval(filter, &track.times_s, beliefs),
                Smoothing::FixedLag { lag_s } => fixed_lag(filter, &track.times_s, &beliefs, lag_s),
            });
        }
        smoothed
    }
}

fn fixed_interval<F: Filter<K>, const K: usize>(
    filter: &F,
    times_s: &[f64],
    mut beliefs: Vec<F::Belief>,
) -> Smoothed {
    for index in (1..beliefs.len()).rev() {
        let step = filter.step(times_s[index] - times_s[index - 1]);
        beliefs[index - 1] = F::smooth(&step, &beliefs[index - 1], &beliefs[index]);
    }
    let mut smoothed = Smoothed::default();
    for belief in &beliefs {
        smoothed.push::<F, K>(belief);
    }
    smoothed
}

fn fixed_lag<F: Filter<K>, const K: usize>(
    filter: &F,
    times_s: &[f64],
    beliefs: &[F::Belief],
    lag_s: f64,
) -> Smoothed {
    let mut steps = Vec::with_capacity(times_s.len());
    for pair in times_s.windows(2) {
        steps.push(filter.step(pair[1] - pair[0]));
    }
    let mut smoothed = Smoothed::default();
    let mut last = 0;
    for index in 0..beliefs.len() {
        while last + 1 < times_s.len() && times_s[last + 1] <= times_s[index] + lag_s {
            last += 1;
        }
        let mut belief = beliefs[last];
        for before in (index..last).rev() {
            belief = F::smooth(&steps[before], &beliefs[before], &belief);
        }
        smoothed.push::<F, K>(&belief);
    }
    smoothed
}

impl Smoothed {
    fn push<F: Filter<K>, const K: usize>(&mut self, belief: &F::Belief) {
        F::kinematics(belief).pack_into(&mut self.kinematics);
        self.modes.extend_from_slice(F::mode_probabilities(belief));
    }
}
