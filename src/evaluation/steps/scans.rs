//! Steps at the scans of a recording.
//!
//! # Method
//! 1. Scans of different sensors at one time are one step. A step owns half the period of its sensor on either side.
//! 2. A sensor is regular where three quarters of the times between its scans are multiples of their median, within a tenth of it.
//! 3. Where a regular sensor is silent for more than one and a half periods, and no other sensor has a scan within half a period,
//!    the scans that it left out are steps too, evenly between those around them: a recording without detections often
//!    leaves out the scan, and what a tracker misses there it misses all the same.

use super::{MOST_MADE_UP, Steps, Window, gaps_of, sort_times};
use crate::evaluation::paths::{Paths, median};
use crate::model::scan::Recording;
use crate::model::time::rounding_s;
use crate::model::track::{TrackPoint, TrackSet};

/// A sensor with fewer gaps shows no period.
const FEWEST_GAPS: usize = 3;
/// Of the gaps of a regular sensor.
const REGULAR_SHARE: f64 = 0.75;
/// Of its period.
const JITTER: f64 = 0.1;
/// A longer gap is a hole, in periods.
const HOLE: f64 = 1.5;

impl Steps {
    /// Fills holes where the paths have targets; without paths there are the scans alone.
    pub(super) fn take_scans(&mut self, recording: &Recording, filled: Option<&Paths>) {
        self.made_of = "the scans of the recording";
        let times_s = sort_times(recording.scans.iter().map(|scan| scan.time_s));
        let sensors = clocks(recording);
        let mut steps: Vec<(f64, f64)> = Vec::with_capacity(times_s.len());
        for &time_s in &times_s {
            steps.push((time_s, 0.0));
        }
        for clock in &sensors {
            let half_s = 0.5 * clock.period_s.unwrap_or(0.0);
            for time_s in &clock.times_s {
                let place = times_s.partition_point(|other_s| other_s < time_s);
                steps[place].1 = half_s.max(steps[place].1);
            }
        }
        if let Some(paths) = filled {
            self.tell_of_ends(&sensors, &paths.stretches_s());
            let holes = self.holes(&sensors, &times_s, &paths.stretches_s());
            self.filled = holes.len();
            steps.extend(holes);
            steps.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        }
        let periods_s = sensors.iter().filter_map(|clock| clock.period_s);
        self.period_s = periods_s.reduce(f64::min);
        self.take_windows(steps.into_iter());
    }

    /// A recording that begins late or ends early judges nothing there.
    fn tell_of_ends(&mut self, sensors: &[Clock], stretches_s: &[(f64, f64)]) {
        let scans_s = sensors
            .iter()
            .flat_map(|clock| clock.times_s.iter().copied());
        let (mut first_s, mut last_s) = (f64::INFINITY, f64::NEG_INFINITY);
        for time_s in scans_s {
            (first_s, last_s) = (first_s.min(time_s), last_s.max(time_s));
        }
        let periods_s = sensors.iter().filter_map(|clock| clock.period_s);
        let (Some(period_s), Some(from), Some(to)) = (
            periods_s.reduce(f64::max),
            stretches_s.first(),
            stretches_s.last(),
        ) else {
            return;
        };
        for (lacking_s, where_) in [
            (first_s - from.0, "before its first"),
            (to.1 - last_s, "behind its last"),
        ] {
            if lacking_s > HOLE * period_s + rounding_s(last_s) {
                self.warnings.push(format!(
                    "the truth reaches {lacking_s:.1} s {where_} scan of the recording: nothing is judged there"
                ));
            }
        }
    }

    /// Method, 3: the times of the steps in holes, with the half of the period.
    fn holes(
        &mut self,
        sensors: &[Clock],
        times_s: &[f64],
        stretches_s: &[(f64, f64)],
    ) -> Vec<(f64, f64)> {
        let mut candidates = Vec::new();
        for clock in sensors {
            if !clock.add_holes(stretches_s, &mut candidates) {
                self.warnings.push(format!(
                    "the recording leaves out more than {MOST_MADE_UP} scans: no hole is filled"
                ));
                return Vec::new();
            }
        }
        candidates.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
        let mut holes: Vec<(f64, f64)> = Vec::new();
        for (time_s, own_half_s) in candidates {
            let half_s = own_half_s + rounding_s(time_s);
            let after = times_s.partition_point(|other_s| *other_s < time_s - half_s);
            let is_seen = times_s
                .get(after)
                .is_some_and(|other_s| *other_s <= time_s + half_s);
            let is_filled = holes
                .last()
                .is_some_and(|(other_s, _)| time_s - other_s <= half_s);
            if !is_seen && !is_filled {
                holes.push((time_s, own_half_s));
            }
        }
        holes
    }

    /// The scans of a recording, to which only points at exactly their times belong. Where that is all points, it is what
    /// [`of_detections`](Self::of_detections) finds, without a look at them.
    pub fn exactly(recording: &Recording) -> Steps {
        let mut steps = Steps::default();
        let times_s = sort_times(recording.scans.iter().map(|scan| scan.time_s));
        steps.take_tolerant(&times_s, &[]);
        steps
    }

    /// The scans of a recording for whoever compares detections: a point belongs to the nearest scan within τ.
    pub fn of_detections(
        recording: &Recording,
        tracks: &TrackSet,
        tolerance_s: Option<f64>,
    ) -> Steps {
        let times_s = sort_times(recording.scans.iter().map(|scan| scan.time_s));
        let (shortest_s, others_s) = beside_scans(tracks, &times_s);
        let mut steps = Steps::with_tolerance(tolerance_s, shortest_s);
        steps.take_tolerant(&times_s, &sort_times(others_s.into_iter()));
        steps
    }

    /// `others_s` are the times of tracks that are no scan's, rising.
    fn take_tolerant(&mut self, times_s: &[f64], others_s: &[f64]) {
        self.windows.clear();
        for (index, &time_s) in times_s.iter().enumerate() {
            let before_s = index
                .checked_sub(1)
                .map_or(f64::INFINITY, |before| time_s - times_s[before]);
            let after_s = times_s
                .get(index + 1)
                .map_or(f64::INFINITY, |after| after - time_s);
            let rounding_s = rounding_s(time_s);
            self.windows.push(Window {
                time_s,
                from_s: time_s - (self.tolerance_s + rounding_s).min(0.5 * before_s),
                to_s: time_s + (self.tolerance_s + rounding_s).min(0.5 * after_s),
            });
        }
        let moved: Vec<f64> = others_s
            .iter()
            .filter_map(|&time_s| Some((self.time_s(self.at(time_s)?) - time_s).abs()))
            .collect();
        if let Some(most_s) = moved.iter().copied().reduce(f64::max) {
            self.tell_moved(moved.len(), times_s.len(), most_s, "tracks and scans");
        }
    }

    pub(super) fn tell_moved(&mut self, steps: usize, of: usize, most_s: f64, whose: &str) {
        let tolerance_s = self.tolerance_s;
        self.warnings.push(format!(
            "times of {whose} that differ by up to {tolerance_s} s are one step: so at {steps} of {of} steps, by {most_s:.3e} s at most"
        ));
    }
}

/// When a sensor looks.
struct Clock {
    times_s: Vec<f64>,
    /// The median time between two scans.
    period_s: Option<f64>,
    is_regular: bool,
}

fn clocks(recording: &Recording) -> Vec<Clock> {
    let mut times_s: Vec<Vec<f64>> = vec![Vec::new(); recording.sensors.len()];
    for scan in &recording.scans {
        times_s[scan.sensor].push(scan.time_s);
    }
    times_s.into_iter().map(Clock::new).collect()
}

impl Clock {
    fn new(times_s: Vec<f64>) -> Clock {
        let times_s = sort_times(times_s.into_iter());
        let mut gaps_s: Vec<f64> = gaps_of([times_s.iter().copied()].into_iter()).collect();
        gaps_s.sort_unstable_by(f64::total_cmp);
        let period_s = median(&gaps_s);
        let rounding_s = rounding_s(times_s.last().copied().unwrap_or(0.0));
        let is_regular = period_s.is_some_and(|period_s| {
            let is_multiple = |gap_s: &&f64| {
                let periods = *gap_s / period_s;
                periods.round() >= 1.0
                    && (periods - periods.round()).abs() <= JITTER + rounding_s / period_s
            };
            let multiples = gaps_s.iter().filter(is_multiple).count();
            multiples as f64 >= REGULAR_SHARE * gaps_s.len() as f64
        });
        Clock {
            is_regular: is_regular && gaps_s.len() >= FEWEST_GAPS,
            times_s,
            period_s,
        }
    }

    /// Adds the scans that it left out in the stretches; whether they are not too many.
    fn add_holes(&self, stretches_s: &[(f64, f64)], holes: &mut Vec<(f64, f64)>) -> bool {
        let Some(period_s) = self.period_s.filter(|_| self.is_regular) else {
            return true;
        };
        for pair in self.times_s.windows(2) {
            let (before_s, gap_s) = (pair[0], pair[1] - pair[0]);
            if gap_s <= HOLE * period_s + rounding_s(before_s) {
                continue;
            }
            let parts = (gap_s / period_s).round().max(2.0);
            let from = stretches_s.partition_point(|stretch| stretch.1 < before_s);
            for &(from_s, to_s) in &stretches_s[from..] {
                if from_s > pair[1] {
                    break;
                }
                let place_of = |time_s: f64| (time_s - before_s) / gap_s * parts;
                let rounding = rounding_s(before_s) / gap_s * parts;
                let first = (place_of(from_s) - rounding).ceil().max(1.0);
                let last = (place_of(to_s) + rounding).floor().min(parts - 1.0);
                if last - first >= (MOST_MADE_UP - holes.len().min(MOST_MADE_UP)) as f64 {
                    return false;
                }
                let mut place = first;
                while place <= last {
                    holes.push((before_s + gap_s * place / parts, 0.5 * period_s));
                    place += 1.0;
                }
            }
        }
        true
    }
}

/// The shortest gap of the tracks, and all their times that are no scan's; in one pass, for points are many and large.
fn beside_scans(tracks: &TrackSet, times_s: &[f64]) -> (f64, Vec<f64>) {
    let (mut shortest_s, mut others_s) = (f64::INFINITY, Vec::new());
    for track in &tracks.tracks {
        let (mut last_s, mut guess) = (f64::NAN, 0);
        for TrackPoint { time_s, .. } in &track.points {
            let gap_s = time_s - std::mem::replace(&mut last_s, *time_s);
            if gap_s > super::SAME_TIME_S {
                shortest_s = shortest_s.min(gap_s);
            }
            if times_s.get(guess) != Some(time_s) {
                guess = times_s.partition_point(|scan_s| scan_s < time_s);
                if times_s.get(guess) != Some(time_s) {
                    others_s.push(*time_s);
                    continue;
                }
            }
            guess += 1;
        }
    }
    (shortest_s, others_s)
}
