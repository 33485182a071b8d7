//! Steps that the tracks choose: on request only, for a tracker that is silent misses nothing at such steps.
//!
//! The times of truth and tracks in order are cut into groups no longer than τ. A group is at the first track time in it, so
//! that truth is aligned to the track.

use super::{StepRule, Steps, Window, sort_times};
use crate::evaluation::paths::Paths;
use crate::model::time::rounding_s;
use crate::model::track::TrackSet;

/// Times that are one step.
struct Group {
    from_s: f64,
    to_s: f64,
    /// The first time of a truth, and of a track.
    truth_s: Option<f64>,
    track_s: Option<f64>,
}

impl Steps {
    pub(super) fn take_groups(&mut self, paths: &Paths, tracks: &TrackSet, rule: StepRule) {
        let of_tracks = tracks.tracks.iter().flat_map(|track| &track.points);
        let of_truth = paths.targets().iter().flat_map(|target| &target.points);
        let groups = self.groups(
            &sort_times(of_truth.map(|point| point.time_s)),
            &sort_times(of_tracks.map(|point| point.time_s)),
        );
        let takes_all = rule == StepRule::Union;
        self.made_of = if takes_all {
            "the times of truth and tracks"
        } else {
            "the times of the tracks"
        };
        let taken = groups
            .iter()
            .filter(|group| takes_all || group.track_s.is_some());
        self.windows = taken.map(Group::window).collect();
        self.warnings.push(format!(
            "the steps are {}, as asked for: what is due depends on the tracks, which flatters those that say little",
            self.made_of
        ));
    }

    fn groups(&mut self, truth_times_s: &[f64], track_times_s: &[f64]) -> Vec<Group> {
        let mut times: Vec<(f64, bool)> = Vec::new();
        times.extend(truth_times_s.iter().map(|&time_s| (time_s, false)));
        times.extend(track_times_s.iter().map(|&time_s| (time_s, true)));
        times.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut groups: Vec<Group> = Vec::new();
        for (time_s, is_of_track) in times {
            match groups
                .last_mut()
                .filter(|group| time_s - group.from_s <= self.tolerance_s + rounding_s(time_s))
            {
                Some(group) => group.add(time_s, is_of_track),
                None => groups.push(Group::new(time_s, is_of_track)),
            }
        }
        let joined = groups.iter().filter(|group| group.joins()).count();
        if joined > 0 {
            let lengths_s = groups.iter().filter(|group| group.joins());
            let most_s = lengths_s.fold(0.0, |most_s: f64, group| {
                most_s.max(group.to_s - group.from_s)
            });
            self.tell_moved(joined, groups.len(), most_s, "truth and tracks");
        }
        groups
    }
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

    /// Whether times of truth and tracks that differ are one.
    fn joins(&self) -> bool {
        self.track_s.is_some() && self.truth_s.is_some() && self.to_s > self.from_s
    }

    fn window(&self) -> Window {
        Window {
            time_s: self.track_s.unwrap_or(self.from_s),
            from_s: self.from_s,
            to_s: self.to_s,
        }
    }
}
