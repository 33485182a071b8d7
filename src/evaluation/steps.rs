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
        let times_s = sorted(recording.scans.iter().map(|scan| scan.time_s));
        let of_truth_s = gaps_of(
            targets
                .iter()
                .map(|target| target.points.iter().map(|point| point.time_s)),
        );
        let (of_tracks_s, others_s) = beside_scans(tracks, &times_s);
        let mut steps = Steps::with_tolerance(tolerance_s, of_truth_s.fold(of_tracks_s, f64::min));
        steps.take_scans(&times_s, &sorted(others_s.into_iter()));
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
        steps.take_scans(&sorted(recording.scans.iter().map(|scan| scan.time_s)), &[]);
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
        let reach = |gap_s: f64| self.tolerance_s.min(0.5 * gap_s);
        let window = |(index, &time_s): (usize, &f64)| {
            let before_s = index
                .checked_sub(1)
                .map_or(f64::INFINITY, |before| time_s - times_s[before]);
            let after_s = times_s
                .get(index + 1)
                .map_or(f64::INFINITY, |after| after - time_s);
            Window {
                time_s,
                from_s: time_s - reach(before_s),
                to_s: time_s + reach(after_s),
            }
        };
        self.windows = times_s.iter().enumerate().map(window).collect();
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
        let tagged = sorted(truth_times_s)
            .into_iter()
            .map(|time_s| (time_s, false));
        let mut times: Vec<(f64, bool)> = tagged
            .chain(
                sorted(track_times_s)
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

fn sorted(times_s: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut times_s = rising(times_s.filter(|time_s| time_s.is_finite()));
    times_s.dedup();
    times_s
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluation::comparison::{Alignment, Comparison, PointSettings};
    use crate::evaluation::events::{EventKind, EventLog};
    use crate::evaluation::tests::{tracks_of, truth_of};
    use crate::evaluation::{
        EvaluationInput, SymbolRule, TfaReport, TfaSettings, evaluate_temporal_automaton,
    };
    use crate::model::state::Position;
    use crate::model::truth::{Target, TruthPoint};

    /// 20 m/s along x, at each of these times.
    fn truth_at(times_s: &[f64]) -> TruthSet {
        let point =
            |&time_s: &f64| TruthPoint::in_plane(time_s, Position::new(20.0 * time_s, 0.0), None);
        TruthSet::new(vec![Target {
            truth_id: "A".to_owned(),
            points: times_s.iter().map(point).collect(),
        }])
        .unwrap()
    }

    /// A perfect track of the same target at other times.
    fn track_at(times_s: &[f64]) -> TrackSet {
        let places: Vec<f64> = times_s.iter().map(|time_s| 20.0 * time_s).collect();
        let mut set = tracks_of(&[("T", &places)]);
        set.tracks[0]
            .points
            .iter_mut()
            .zip(times_s)
            .for_each(|(point, &time_s)| point.time_s = time_s);
        set
    }

    fn compared(
        truth: &TruthSet,
        tracks: &TrackSet,
        time_tolerance_s: Option<f64>,
    ) -> (Comparison, EventLog) {
        let input = EvaluationInput {
            recording: None,
            truth: Some(truth),
            tracks,
        };
        let alignment = Alignment::Interpolate { max_gap_s: 5.0 };
        let settings = PointSettings {
            alignment,
            gate_m: 10.0,
            reach_m: 10.0,
            time_tolerance_s,
        };
        let comparison = Comparison::of_points(&input, truth, &settings);
        let log = EventLog::new(&comparison);
        (comparison, log)
    }

    /// Matches, misses, unmatched track points, breaks.
    fn counts(truth: &[f64], track: &[f64], tolerance_s: Option<f64>) -> [usize; 4] {
        let (_, log) = compared(&truth_at(truth), &track_at(track), tolerance_s);
        let unmatched = [
            EventKind::FalseAlarm,
            EventKind::Redundant,
            EventKind::Divergence,
        ]
        .map(|kind| log.count(kind));
        [
            log.count(EventKind::Match),
            log.count(EventKind::Miss),
            unmatched.iter().sum(),
            log.count(EventKind::Break),
        ]
    }

    fn every(period_s: f64, count: u32) -> Vec<f64> {
        (0..count)
            .map(|index| f64::from(index) * period_s)
            .collect()
    }

    fn judged(truth: &TruthSet, tracks: &TrackSet) -> TfaReport {
        let symbols = SymbolRule::NearestTruth {
            gate_m: 10.0,
            max_gap_s: 5.0,
        };
        let input = EvaluationInput {
            recording: None,
            truth: Some(truth),
            tracks,
        };
        evaluate_temporal_automaton(
            &input,
            &TfaSettings {
                symbols,
                ..TfaSettings::PAPER
            },
        )
        .unwrap()
    }

    #[test]
    fn noise_of_rounding_and_a_millisecond_change_nothing() {
        let truth = every(1.0, 20);
        let noisy: Vec<f64> = truth
            .iter()
            .enumerate()
            .map(|(index, time_s)| time_s + [1e-9, -1e-9, 0.0][index % 3])
            .collect();
        let late: Vec<f64> = truth.iter().map(|time_s| time_s + 1e-3).collect();
        let early: Vec<f64> = truth.iter().map(|time_s| time_s - 1e-3).collect();
        let partly: Vec<f64> = truth
            .iter()
            .enumerate()
            .map(|(index, time_s)| {
                if index % 3 == 0 {
                    *time_s
                } else {
                    time_s + 1e-3
                }
            })
            .collect();
        for track in [&noisy, &late, &early, &partly] {
            assert_eq!(counts(&truth, track, None), [20, 0, 0, 0], "{track:?}");
            assert_eq!(
                judged(&truth_at(&truth), &track_at(track)).counts.correct,
                1,
                "{track:?}"
            );
        }
        let (comparison, _) = compared(&truth_at(&truth), &track_at(&partly), None);
        let told = "times of truth and tracks that differ by up to 0.01 s are one step: so at 13 of 20 steps, by 1.000e-3 s at most";
        assert_eq!(comparison.warnings, [told]);
        // The truth is aligned to the track: the distance is of rounding, not 20 m/s times 1 ms.
        assert!(
            comparison.pairs[..19]
                .iter()
                .all(|pair| pair.distance < 1e-9)
        );
    }

    #[test]
    fn a_tolerance_may_be_stated() {
        let truth = every(1.0, 10);
        let track: Vec<f64> = truth.iter().map(|time_s| time_s + 0.1).collect();
        let (first, _) = compared(&truth_at(&truth), &track_at(&track), None);
        assert!(
            first.warnings[0].starts_with("tracks and truth share 0 of 10 times"),
            "{:?}",
            first.warnings
        );
        // Its last point lies behind the truth's last, so that it follows nobody there.
        assert_eq!(counts(&truth, &track, None), [9, 0, 1, 0]);
        assert_eq!(counts(&truth, &track, Some(0.2)), [10, 0, 0, 0]);
        let (second, _) = compared(&truth_at(&truth), &track_at(&track), Some(1.5));
        assert!(
            second.warnings[0].starts_with("a tolerance of 1.5 s makes one step of points"),
            "{:?}",
            second.warnings
        );
    }

    #[test]
    fn the_tolerance_never_joins_two_points_of_one_path() {
        let steps = |period_s: f64| {
            Steps::new(
                None,
                Some(&truth_at(&every(period_s, 9))),
                &track_at(&every(period_s, 9)),
                None,
            )
        };
        assert_eq!(
            [steps(8.0), steps(0.04), steps(1e-3)].map(|steps| steps.count()),
            [9, 9, 9]
        );
        assert!((steps(0.04).tolerance_s - 0.002).abs() < 1e-12);
        assert_eq!(
            (steps(8.0).tolerance_s, steps(8.0).warnings),
            (0.01, Vec::new())
        );
    }

    #[test]
    fn tracks_of_another_rate_miss_nothing_and_their_silence_counts_at_their_own_rate() {
        let fast = every(0.1, 201);
        let (whole, mut silent) = (every(1.0, 21), every(1.0, 21));
        assert_eq!(counts(&fast, &whole, None), [21, 0, 0, 0]);
        // A rate that shares few times with the truth.
        assert_eq!(counts(&fast, &every(0.73, 28), None), [28, 0, 0, 0]);
        assert_eq!(
            counts(&fast, &every(0.73, 27), None),
            [27, 1, 0, 1],
            "it ends 1.02 s early"
        );
        silent.retain(|time_s| !(6.0..=9.0).contains(time_s));
        assert_eq!(counts(&fast, &silent, None), [17, 4, 0, 1]);
        let late: Vec<f64> = every(1.0, 21).split_off(3);
        assert_eq!(counts(&fast, &late, None), [18, 3, 0, 0]);
    }

    #[test]
    fn sensors_that_take_turns_are_no_silence() {
        let mut track: Vec<f64> = (0..20)
            .flat_map(|turn| [0.0, 0.37].map(|shift| 0.05 + f64::from(turn) + shift))
            .collect();
        assert_eq!(counts(&every(0.1, 201), &track, None), [40, 0, 0, 0]);
        assert_eq!(counts(&every(1.0, 21), &track, None), [40, 0, 0, 0]);
        track.retain(|time_s| !(8.0..11.0).contains(time_s));
        let [matched, missed, unmatched, breaks] = counts(&every(0.1, 201), &track, None);
        assert_eq!((matched, unmatched, breaks), (34, 0, 1));
        assert!(
            (3..=5).contains(&missed),
            "3 s of silence at a usual gap of 0.63 s: {missed}"
        );
    }

    #[test]
    fn what_a_track_lacks_costs_the_automaton_as_much_as_clear() {
        let truth = every(1.0, 12);
        let cut = |lacks: &dyn Fn(f64) -> bool| {
            truth
                .iter()
                .copied()
                .filter(|&time_s| !lacks(time_s))
                .collect::<Vec<f64>>()
        };
        let cases = [
            ("late", cut(&|time_s| time_s < 3.0), 3, 0, "missed"),
            (
                "gap",
                cut(&|time_s| (4.0..6.0).contains(&time_s)),
                2,
                1,
                "false",
            ),
            ("early end", cut(&|time_s| time_s > 7.0), 4, 1, "false"),
            ("whole", truth.clone(), 0, 0, "correct"),
        ];
        for (name, track, missed, breaks, verdict) in cases {
            assert_eq!(
                counts(&truth, &track, None),
                [12 - missed, missed, 0, breaks],
                "{name}"
            );
            let report = judged(&truth_at(&truth), &track_at(&track));
            let target = &report.targets[0];
            assert_eq!(
                serde_json::to_value(target.verdict).unwrap(),
                verdict,
                "{name}"
            );
            assert_eq!(
                target.least_errors,
                Some(missed),
                "{name}: the errors are CLEAR's misses"
            );
            if verdict == "false" {
                assert_eq!(target.errors, missed, "{name}");
            }
        }
    }

    #[test]
    fn points_belong_to_the_nearest_scan_of_a_recording() {
        use crate::model::scan::{RecordingParts, Scan};
        use crate::model::sensor::SensorSettings;
        let scan = |number: u32| Scan {
            number,
            time_s: f64::from(number),
            sensor: 0,
            first: 0,
            count: 0,
        };
        let sensors = vec![SensorSettings::named("radar")];
        let recording = Recording::new(RecordingParts {
            sensors,
            scans: (1..=4).map(scan).collect(),
            ..Default::default()
        })
        .unwrap();
        let tracks = track_at(&[1.0 - 1e-9, 2.0, 3.004, 4.2]);
        let steps = Steps::new(Some(&recording), Some(&truth_of(&[])), &tracks, None);
        assert_eq!(
            [1.0 - 1e-9, 2.0, 3.004, 4.2].map(|time_s| steps.at(time_s)),
            [Some(0), Some(1), Some(2), None]
        );
        let told = "times of tracks and scans that differ by up to 0.01 s are one step: so at 2 of 4 steps, by 4.000e-3 s at most";
        assert_eq!(steps.warnings, [told]);
    }
}
