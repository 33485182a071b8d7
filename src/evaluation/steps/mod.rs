//! The times at which truth and tracks are compared, and which points belong to each. Metrics and automaton read the same
//! steps, so a track that begins late, breaks or ends early costs both the same.
//!
//! # Method
//! What is due never depends on the tracks, unless a request asks for it.
//! 1. With a recording the steps are its [`scans`]; a hole of a regular sensor is filled.
//! 2. Else they are the times of the truth, or where targets have clocks of their own a [`grid`].
//! 3. A step owns half a period on either side, and no more than half the way to the next step. A track is in a step by its
//!    point nearest in time; what stands in no window belongs to no step.
//! 4. τ is what the request says, else a twentieth of the shortest time between two points of one path, at most 10 ms: clocks that
//!    round their times differ by less, and two points of one path never fall together. Times of truth nearer than τ are one step.
//! 5. Times that differ by rounding alone are equal, wherever the clock begins: what lies midway between two steps is of the later one.
//! 6. On request the times of the tracks are steps, alone or with those of the truth: then a silent track misses nothing.

mod grid;
mod groups;
mod scans;

use crate::evaluation::paths::{Paths, median};
use crate::model::scan::Recording;
use crate::model::time::rounding_s;
use crate::model::track::{Track, TrackSet};
use serde::Deserialize;

/// The largest tolerance that is taken without being asked for.
const LARGEST_TOLERANCE_S: f64 = 0.01;
/// Of the shortest gap.
const TOLERANCE_SHARE: f64 = 1.0 / 20.0;
/// Times nearer than this are one time, whoever writes them.
const SAME_TIME_S: f64 = 1e-6;
/// Tracks whose points are so many periods of the steps apart have a rate of their own.
const RARER: f64 = 1.5;
/// More steps than this are not made up beside those that a recording or a truth has.
const MOST_MADE_UP: usize = 1_000_000;

/// Whose times are the steps.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum StepRule {
    /// The scans of the recording with the holes of regular sensors filled; without a recording the times of the truth, or a grid
    /// where targets have clocks of their own.
    #[default]
    Auto,
    /// The same without filling holes.
    AsRecorded,
    /// The times of the truth, also where there is a recording.
    Truth,
    /// From the first time of the truth on, a stated time apart.
    EveryS,
    /// The times of the tracks.
    Tracks,
    /// The times of truth and tracks.
    Union,
}

/// How the steps are found.
#[derive(Debug, Clone, Copy, PartialEq, Default, Deserialize)]
#[serde(default)]
pub struct StepSettings {
    #[serde(rename = "steps")]
    pub rule: StepRule,
    /// With [`StepRule::EveryS`].
    pub every_s: Option<f64>,
    /// τ; `None` is what the data allow.
    #[serde(skip)]
    pub time_tolerance_s: Option<f64>,
}

/// One step: its time, and the times that belong to it.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Window {
    time_s: f64,
    from_s: f64,
    to_s: f64,
}

/// Steps in order of time.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Steps {
    windows: Vec<Window>,
    /// τ.
    pub tolerance_s: f64,
    /// In words, what the steps are.
    pub made_of: &'static str,
    /// How many of them fill holes of a recording.
    pub filled: usize,
    /// The usual time between two steps, where there is one.
    pub period_s: Option<f64>,
    /// The median time between two points of a track, where nothing else says how often they could be there.
    usual_gap_of_tracks_s: Option<f64>,
    pub warnings: Vec<String>,
}

impl Steps {
    pub fn new(
        recording: Option<&Recording>,
        paths: &Paths,
        tracks: &TrackSet,
        settings: &StepSettings,
    ) -> Steps {
        let shortest_s = if matches!(settings.rule, StepRule::Tracks | StepRule::Union) {
            shortest_gap_s(paths, Some(tracks))
        } else {
            shortest_gap_s(paths, None)
        };
        let mut steps = Steps::with_tolerance(settings.time_tolerance_s, shortest_s);
        if recording.is_none() {
            steps.usual_gap_of_tracks_s = usual_gap_s(tracks);
        }
        match (settings.rule, recording) {
            (StepRule::Auto, Some(recording)) => steps.take_scans(recording, Some(paths)),
            (StepRule::AsRecorded, Some(recording)) => steps.take_scans(recording, None),
            (StepRule::Auto | StepRule::AsRecorded, None) => steps.take_truth(paths),
            (StepRule::Truth, _) => steps.take_times_of_truth(paths),
            (StepRule::EveryS, _) => {
                steps.take_grid(
                    paths,
                    settings.every_s.unwrap_or(1.0),
                    "a grid as asked for",
                );
            }
            (StepRule::Tracks | StepRule::Union, _) => {
                steps.take_groups(paths, tracks, settings.rule);
            }
        }
        steps.period_s = steps.usual_spacing_s().or(steps.period_s);
        steps.tell_of_rates();
        steps
    }

    /// The median time between two steps.
    fn usual_spacing_s(&self) -> Option<f64> {
        let mut gaps_s: Vec<f64> = gaps_of([self.times_s()].into_iter()).collect();
        gaps_s.sort_unstable_by(f64::total_cmp);
        median(&gaps_s)
    }

    /// Tracks that are rarer than the steps miss some for that alone.
    fn tell_of_rates(&mut self) {
        let Some((own_s, period_s)) = self.usual_gap_of_tracks_s.zip(self.period_s) else {
            return;
        };
        if own_s
            > RARER * period_s + rounding_s(self.windows.first().map_or(0.0, |first| first.time_s))
        {
            self.warnings.push(format!(
                "tracks say something every {own_s:.3} s, and the steps ({}) are {period_s:.3} s apart: what lies between is missed. \
                 'steps': 'every_s' with 'every_s': {own_s:.3} judges at the rate of the tracks",
                self.made_of
            ));
        }
    }

    /// Method, 4; no steps yet.
    fn with_tolerance(tolerance_s: Option<f64>, shortest_s: f64) -> Steps {
        let tolerance_s =
            tolerance_s.unwrap_or((shortest_s * TOLERANCE_SHARE).min(LARGEST_TOLERANCE_S));
        let mut steps = Steps {
            tolerance_s,
            ..Steps::default()
        };
        if tolerance_s >= shortest_s {
            let tell = format!(
                "a tolerance of {tolerance_s} s makes one step of points of one target or track that are {shortest_s} s apart"
            );
            steps.warnings.push(tell);
        }
        steps
    }

    pub fn count(&self) -> usize {
        self.windows.len()
    }

    pub fn times_s(&self) -> impl ExactSizeIterator<Item = f64> {
        self.windows.iter().map(|window| window.time_s)
    }

    pub fn time_s(&self, step: usize) -> f64 {
        self.windows[step].time_s
    }

    /// The times that belong to a step.
    pub fn window_s(&self, step: usize) -> (f64, f64) {
        let Window { from_s, to_s, .. } = self.windows[step];
        (from_s, to_s)
    }

    /// The step that a time belongs to.
    pub fn at(&self, time_s: f64) -> Option<usize> {
        let step = self
            .windows
            .partition_point(|window| window.from_s <= time_s)
            .checked_sub(1)?;
        (time_s <= self.windows[step].to_s).then_some(step)
    }

    /// The same as [`at`](Self::at), quickest where `guess` is the answer.
    #[inline]
    pub fn near(&self, time_s: f64, guess: usize) -> Option<usize> {
        match self.windows.get(guess) {
            Some(window) if window.time_s == time_s => Some(guess),
            _ => self.at(time_s),
        }
    }

    /// The first step at `time_s` or later.
    pub fn first_from(&self, time_s: f64) -> usize {
        self.windows
            .partition_point(|window| window.time_s < time_s)
    }

    /// Windows around rising times; each reaches `half_s` of it, at least τ, to either side, but no nearer to another time than to
    /// its own.
    fn take_windows(&mut self, times_s: impl Iterator<Item = (f64, f64)>) {
        self.windows.clear();
        let mut before: Option<(f64, f64)> = None;
        for (time_s, half_s) in times_s {
            let half_s = half_s.max(self.tolerance_s) + rounding_s(time_s);
            let mut from_s = time_s - half_s;
            if let (Some((before_s, before_half_s)), Some(window)) =
                (before, self.windows.last_mut())
            {
                let middle_s = before_s + 0.5 * (time_s - before_s) - rounding_s(time_s);
                window.to_s = middle_s.min(before_s + before_half_s);
                from_s = from_s.max(middle_s);
            }
            let to_s = time_s + half_s;
            self.windows.push(Window {
                time_s,
                from_s,
                to_s,
            });
            before = Some((time_s, half_s));
        }
    }
}

/// The shortest time between two points of one target, or of one track.
fn shortest_gap_s(paths: &Paths, tracks: Option<&TrackSet>) -> f64 {
    let of_tracks = tracks
        .into_iter()
        .flat_map(|tracks| &tracks.tracks)
        .map(|track| track.points.iter().map(|point| point.time_s));
    let of_truth = paths
        .targets()
        .iter()
        .map(|target| target.points.iter().map(|point| point.time_s));
    gaps_of(of_tracks)
        .chain(gaps_of(of_truth))
        .fold(f64::INFINITY, f64::min)
}

fn usual_gap_s(tracks: &TrackSet) -> Option<f64> {
    let times = |track: &Track| {
        track
            .points
            .iter()
            .map(|point| point.time_s)
            .collect::<Vec<_>>()
    };
    let paths = tracks.tracks.iter().map(|track| times(track).into_iter());
    let mut gaps_s: Vec<f64> = gaps_of(paths).collect();
    if gaps_s.is_empty() {
        return None;
    }
    let middle = gaps_s.len() / 2;
    Some(*gaps_s.select_nth_unstable_by(middle, f64::total_cmp).1)
}

/// The gaps of all paths.
fn gaps_of<P: Iterator<Item = f64>>(paths: impl Iterator<Item = P>) -> impl Iterator<Item = f64> {
    let gaps = |times_s: P| {
        times_s.scan(f64::NAN, |last_s, next_s| {
            Some(next_s - std::mem::replace(last_s, next_s))
        })
    };
    paths
        .flat_map(gaps)
        .filter(|&gap_s| gap_s > SAME_TIME_S && gap_s.is_finite())
}

/// Finite times, rising, each once.
fn sort_times(times_s: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut times_s: Vec<f64> = times_s.filter(|time_s| time_s.is_finite()).collect();
    times_s.sort_unstable_by(f64::total_cmp);
    times_s.dedup();
    times_s
}

#[cfg(test)]
mod tests;
