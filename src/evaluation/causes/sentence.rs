//! An episode as a sentence. Times are not in it but as durations: the episode has them.

use super::{Cause, Episode, Part};
use crate::evaluation::comparison::Comparison;
use crate::evaluation::events::EventKind;

impl Episode {
    /// What happened and why.
    pub fn sentence(&self, comparison: &Comparison) -> String {
        let names = Names(comparison);
        let reason = self.reason(&names);
        let (target, track) = (names.target(self.truth), names.track(self.track));
        let steps = steps(self.steps);
        match self.event {
            EventKind::Miss => {
                let part = match self.part {
                    Some(Part::Whole) => "in all its life",
                    Some(Part::Beginning) => "before any track follows it",
                    Some(Part::End) => "until its end",
                    Some(Part::Middle) | None => "between two stretches",
                };
                format!("{target} is missed {part}, for {steps}: {reason}.")
            }
            EventKind::Break => format!("{track} loses {target}: {reason}."),
            EventKind::Switch => {
                let before = names.track(self.other_track);
                format!("{target} goes from {before} to {track}: {reason}.")
            }
            EventKind::Redundant => format!("{track} is beside {target} for {steps}: {reason}."),
            EventKind::Divergence => {
                format!("{track} is away from {target}, which it followed, for {steps}: {reason}.")
            }
            _ => format!("{track} follows no target for {steps}: {reason}."),
        }
    }

    fn reason(&self, names: &Names) -> String {
        let lost = match self.event {
            EventKind::Switch => names.track(self.other_track),
            _ => names.track(self.track),
        };
        match self.cause {
            Cause::OutsideCoverage => "it is outside the field of view of every sensor".to_owned(),
            Cause::NoDetection => self.without_detection(&lost),
            Cause::TookTarget => {
                let other = names.target(self.other_truth);
                if self.taken == 0 {
                    format!("{lost} follows {other}")
                } else {
                    format!("{lost} took {} of {other}", detections(self.taken))
                }
            }
            Cause::TookClutter => {
                format!("{lost} took {} of no target", detections(self.taken))
            }
            Cause::Ended => format!("{lost} ended by the rule of its tracker"),
            Cause::LeftGate => format!("{lost} lives on outside the gate"),
            Cause::Silent => format!("{lost} has no point at this time, and later ones"),
            Cause::NotConfirmed => format!("{lost} is near it and was not known at the time"),
            Cause::NoTrack => match self.seen {
                Some(seen) => format!(
                    "no track is near it, and {} of {} have a detection within the gate",
                    seen.seen,
                    scans(seen.scans)
                ),
                None => "no track is near it".to_owned(),
            },
            Cause::SecondTrack => match self.event {
                EventKind::Switch => format!("{lost} is still within the gate"),
                _ => format!("{} follows it", names.track(self.other_track)),
            },
            Cause::TargetGone => format!(
                "{}, which it followed, is no more",
                names.target(self.truth)
            ),
            Cause::Unknown => "no target is within the gate".to_owned(),
        }
    }

    fn without_detection(&self, lost: &str) -> String {
        match (self.event, self.seen, self.unseen_scans) {
            (EventKind::FalseAlarm | EventKind::Divergence, ..) => {
                format!("it was given no detection in {}", steps(self.taken))
            }
            (EventKind::Miss, Some(seen), None) => {
                format!("no detection is within the gate in {}", scans(seen.scans))
            }
            (_, _, unseen) => format!(
                "{lost} was lost after {} without a detection within the gate",
                scans(unseen.unwrap_or_default())
            ),
        }
    }
}

struct Names<'a>(&'a Comparison);

impl Names<'_> {
    fn target(&self, truth: Option<u32>) -> String {
        let id = truth.and_then(|truth| self.0.truth_ids.get(truth as usize));
        id.map_or_else(|| "a target".to_owned(), |id| format!("target {id}"))
    }

    fn track(&self, track: Option<u32>) -> String {
        let id = track.and_then(|track| self.0.track_ids.get(track as usize));
        id.map_or_else(|| "no track".to_owned(), |id| format!("track {id}"))
    }
}

fn steps(count: u32) -> String {
    counted(count, "step")
}

fn scans(count: u32) -> String {
    counted(count, "scan")
}

fn detections(count: u32) -> String {
    counted(count, "detection")
}

fn counted(count: u32, what: &str) -> String {
    let plural = if count == 1 { "" } else { "s" };
    format!("{count} {what}{plural}")
}
