//! The times at which truth and tracks are compared, and which points belong to each. Metrics and automaton read the same
//! steps, so a track that begins late, breaks or ends early costs both the same.
//!
//! # Symbols
//! τ tolerance; a *gap* is the time between two points of one target or of one track that follow each other.
//!
//! # Method
//! 1. τ is what the request says, else a twentieth of the shortest gap, at most 10 ms: clocks that round their times differ
//!    by less, and two points of one track never fall together.
//! 2. With a recording the steps are its scans; a point belongs to the nearest scan within τ.
//! 3. Without one, the times of truth and tracks in order are cut into groups no longer than τ. A group is at the first
//!    track time in it, so that truth is aligned to the track and not the track moved.
//! 4. When every group with a track has truth too and the tracks are as frequent as the truth, all groups are steps.
//! 5. Else truth and tracks have clocks of their own: the groups with tracks are steps, and where no track says anything
//!    for more than one and a half usual gaps of tracks, also groups of truth alone, a usual gap apart. So a perfect tracker
//!    misses nothing, and a silent one misses what it should have said. The usual gap is the 75 % quantile, so that
//!    sensors which take turns are not taken for silence; that of truth where tracks have fewer than four gaps.

use crate::model::scan::Recording;
use crate::model::track::{TrackPoint, TrackSet};
use crate::model::truth::{Target, TruthSet};

/// The largest tolerance that is taken without being asked for.
const LARGEST_TOLERANCE_S: f64 = 0.01;
/// Of the shortest gap.
const TOLERANCE_SHARE: f64 = 1.0 / 20.0;
/// Times nearer than this are one time, whoever writes them.
const SAME_TIME_S: f64 = 1e-6;
/// A stretch without tracks longer than so many usual gaps is silence; tracks so much rarer than truth have their own rate.
const SILENCE: f64 = 1.5;
const FEWEST_GAPS: usize = 4;
/// Fewer gaps than this do not show that tracks have a rate of their own.
const FEWEST_GAPS_OF_A_RATE: usize = 10;

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
    pub warnings: Vec<String>,
}

impl Steps {
    /// `truth` may be absent with a recording.
    pub fn new(
        recording: Option<&Recording>,
        truth: Option<&TruthSet>,
        tracks: &TrackSet,
        tolerance_s: Option<f64>,
    ) -> Steps {
        let targets = truth.map_or(&[][..], TruthSet::targets);
        match recording {
            Some(recording) => Steps::of_scans(recording, targets, tracks, tolerance_s),
            None => Steps::of_points(targets, tracks, tolerance_s),
        }
    }

    fn of_scans(
        recording: &Recording,
        targets: &[Target],
        tracks: &TrackSet,
        tolerance_s: Option<f64>,
    ) -> Steps {
        let times_s = sort_times(recording.scans.iter().map(|scan| scan.time_s));
        let of_truth_s = gaps_of(
            targets
                .iter()
                .map(|target| target.points.iter().map(|point| point.time_s)),
        );
        let (of_tracks_s, others_s) = beside_scans(tracks, &times_s);
        let mut steps = Steps::with_tolerance(tolerance_s, of_truth_s.fold(of_tracks_s, f64::min));
        steps.take_scans(&times_s, &sort_times(others_s.into_iter()));
        steps
    }

    fn of_points(targets: &[Target], tracks: &TrackSet, tolerance_s: Option<f64>) -> Steps {
        let of_truth = rising(gaps_of(
            targets
                .iter()
                .map(|target| target.points.iter().map(|point| point.time_s)),
        ));
        let of_tracks = rising(gaps_of(
            tracks
                .tracks
                .iter()
                .map(|track| track.points.iter().map(|point| point.time_s)),
        ));
        let shortest_s = of_tracks
            .iter()
            .chain(&of_truth)
            .copied()
            .fold(f64::INFINITY, f64::min);
        let mut steps = Steps::with_tolerance(tolerance_s, shortest_s);
        let truth_times_s = targets
            .iter()
            .flat_map(|target| &target.points)
            .map(|point| point.time_s);
        let track_times_s = tracks
            .tracks
            .iter()
            .flat_map(|track| &track.points)
            .map(|point| point.time_s);
        let groups = steps.groups(truth_times_s, track_times_s);
        steps.take_groups(&groups, &of_truth, &of_tracks);
        steps
    }

    /// The scans of a recording, to which only points at exactly their times belong. Where that is all points, it is what
    /// [`new`](Self::new) finds, without a look at them.
    pub fn exactly(recording: &Recording) -> Steps {
        let mut steps = Steps::default();
        steps.take_scans(
            &sort_times(recording.scans.iter().map(|scan| scan.time_s)),
            &[],
        );
        steps
    }

    /// Method, 1; no steps yet.
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

    /// Method, 2. `others_s` are the times of tracks that are no scan's, rising.
    fn take_scans(&mut self, times_s: &[f64], others_s: &[f64]) {
        self.windows.clear();
        for (index, &time_s) in times_s.iter().enumerate() {
            let before_s = index
                .checked_sub(1)
                .map_or(f64::INFINITY, |before| time_s - times_s[before]);
            let after_s = times_s
                .get(index + 1)
                .map_or(f64::INFINITY, |after| after - time_s);
            self.windows.push(Window {
                time_s,
                from_s: time_s - self.tolerance_s.min(0.5 * before_s),
                to_s: time_s + self.tolerance_s.min(0.5 * after_s),
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

    fn tell_moved(&mut self, steps: usize, of: usize, most_s: f64, whose: &str) {
        let tolerance_s = self.tolerance_s;
        self.warnings.push(format!(
            "times of {whose} that differ by up to {tolerance_s} s are one step: so at {steps} of {of} steps, by {most_s:.3e} s at most"
        ));
    }

    /// Method, 3.
    fn groups(
        &mut self,
        truth_times_s: impl Iterator<Item = f64>,
        track_times_s: impl Iterator<Item = f64>,
    ) -> Vec<Group> {
        let tagged = sort_times(truth_times_s)
            .into_iter()
            .map(|time_s| (time_s, false));
        let mut times: Vec<(f64, bool)> = tagged
            .chain(
                sort_times(track_times_s)
                    .into_iter()
                    .map(|time_s| (time_s, true)),
            )
            .collect();
        times.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut groups: Vec<Group> = Vec::new();
        for (time_s, is_of_track) in times {
            match groups
                .last_mut()
                .filter(|group| time_s - group.from_s <= self.tolerance_s)
            {
                Some(group) => group.add(time_s, is_of_track),
                None => groups.push(Group::new(time_s, is_of_track)),
            }
        }
        let apart = |group: &Group| {
            group.track_s.is_some() && group.truth_s.is_some() && group.to_s > group.from_s
        };
        let joined = groups.iter().filter(|group| apart(group)).count();
        if joined > 0 {
            let most_s = groups
                .iter()
                .filter(|group| apart(group))
                .map(|group| group.to_s - group.from_s)
                .fold(0.0, f64::max);
            self.tell_moved(joined, groups.len(), most_s, "truth and tracks");
        }
        groups
    }

    /// Method, 4 and 5.
    fn take_groups(&mut self, groups: &[Group], of_truth: &[f64], of_tracks: &[f64]) {
        let of = groups
            .iter()
            .filter(|group| group.track_s.is_some())
            .count();
        let shared = groups
            .iter()
            .filter(|group| group.track_s.is_some() && group.truth_s.is_some())
            .count();
        let truth_gap_s = quantile(of_truth, 0.5);
        let is_rarer = of_tracks.len() >= FEWEST_GAPS_OF_A_RATE
            && quantile(of_tracks, 0.1)
                .zip(truth_gap_s)
                .is_some_and(|(tracks_s, truth_s)| tracks_s > SILENCE * truth_s);
        if shared == of && !is_rarer {
            self.windows = groups.iter().map(|group| self.window(group)).collect();
            return;
        }
        let own_gap_s = quantile(of_tracks, 0.75).filter(|_| of_tracks.len() >= FEWEST_GAPS);
        let usual_s = own_gap_s.or(truth_gap_s).unwrap_or(f64::INFINITY);
        let mut kept = Vec::with_capacity(of);
        for stretch in groups.chunk_by(|a, b| a.track_s.is_some() == b.track_s.is_some()) {
            if stretch[0].track_s.is_some() {
                kept.extend(stretch.iter().map(|group| self.window(group)));
            } else {
                let behind =
                    groups.partition_point(|group| group.from_s <= stretch[stretch.len() - 1].to_s);
                self.fill(
                    stretch,
                    usual_s,
                    groups.get(behind).map(|group| group.from_s),
                    &mut kept,
                );
            }
        }
        let filled = kept.len() - of;
        self.windows = kept;
        self.warnings.push(format!(
            "tracks and truth share {shared} of {of} times of tracks: compared at the times of the tracks, truth aligned to them, and at \
             {filled} times of truth where no track says anything for more than {} s",
            SILENCE * usual_s
        ));
    }

    /// Truth alone, between the tracks before and behind.
    fn fill(&self, stretch: &[Group], usual_s: f64, behind_s: Option<f64>, kept: &mut Vec<Window>) {
        let before_s = kept.last().map(|window| window.time_s);
        if let (Some(before_s), Some(behind_s)) = (before_s, behind_s)
            && behind_s - before_s <= SILENCE * usual_s
        {
            return;
        }
        for group in stretch {
            let is_apart = kept
                .last()
                .is_none_or(|last| group.from_s - last.time_s >= usual_s - self.tolerance_s);
            let is_before = behind_s
                .is_none_or(|behind_s| behind_s - group.from_s >= usual_s - self.tolerance_s);
            if is_apart && is_before {
                kept.push(self.window(group));
            }
        }
    }

    fn window(&self, group: &Group) -> Window {
        Window {
            time_s: group.track_s.unwrap_or(group.from_s),
            from_s: group.from_s,
            to_s: group.to_s,
        }
    }
}

/// Times that are one step.
struct Group {
    from_s: f64,
    to_s: f64,
    /// The first time of a truth, and of a track.
    truth_s: Option<f64>,
    track_s: Option<f64>,
}

impl Group {
    fn new(time_s: f64, is_of_track: bool) -> Group {
        let mut group = Group {
            from_s: time_s,
            to_s: time_s,
            truth_s: None,
            track_s: None,
        };
        group.add(time_s, is_of_track);
        group
    }

    fn add(&mut self, time_s: f64, is_of_track: bool) {
        self.to_s = time_s;
        let first = if is_of_track {
            &mut self.track_s
        } else {
            &mut self.truth_s
        };
        first.get_or_insert(time_s);
    }
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

fn rising(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_unstable_by(f64::total_cmp);
    values
}

/// The shortest gap of the tracks, and all their times that are no scan's; in one pass, for points are many and large.
fn beside_scans(tracks: &TrackSet, times_s: &[f64]) -> (f64, Vec<f64>) {
    let (mut shortest_s, mut others_s) = (f64::INFINITY, Vec::new());
    for track in &tracks.tracks {
        let (mut last_s, mut guess) = (f64::NAN, 0);
        for TrackPoint { time_s, .. } in &track.points {
            let gap_s = time_s - std::mem::replace(&mut last_s, *time_s);
            if gap_s > SAME_TIME_S {
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

/// The smallest gap that at least this share of all do not exceed.
fn quantile(gaps_s: &[f64], share: f64) -> Option<f64> {
    let rank = ((gaps_s.len() as f64 * share).ceil() as usize).max(1);
    gaps_s.get(rank - 1).copied()
}

fn sort_times(times_s: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut times_s = rising(times_s.filter(|time_s| time_s.is_finite()));
    times_s.dedup();
    times_s
}

#[cfg(test)]
mod tests;
