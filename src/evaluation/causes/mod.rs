//! Why targets are missed and tracks break, go to another target or follow nobody: every such event of the log belongs to one
//! episode, and every episode has a cause and a sentence that says it.
//!
//! # Method
//! 1. Misses of one target in a row are one episode; so are false alarms, redundancies with one target and divergences of one
//!    track. A break and a switch are an episode each. So the steps of the episodes add up to the events of the log.
//! 2. A detection within the gate of the target's true place counts as seen, whoever made it; in a volume one without a height
//!    is at that of the target. A scan belongs to the step that is nearest to it.
//! 3. A track that is lost was drawn away by what it took since it last took a detection of its target: a detection of
//!    another target, else one of no target. Where a recording does not know origins, a detection is of the nearest target
//!    within the gate.
//! 4. A track that took nothing lost a target that no scan saw; else it ended by the rule of its tracker, or lives on outside
//!    the gate.
//! 5. Before its first track a target is unseen, or a track is near it that was not confirmed, or nobody began one.

mod around;
mod loss;
mod sentence;
mod taken;
mod walk;

pub use walk::explain;

use super::events::EventKind;
use serde::{Deserialize, Serialize};

/// Why something happened.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema), schema(as = EventCause))]
#[serde(rename_all = "snake_case")]
pub enum Cause {
    /// The target is outside the field of view of every sensor.
    OutsideCoverage,
    /// No scan has a detection within the gate of the target; of a track without target: it was given none.
    NoDetection,
    /// The track took detections of another target.
    TookTarget,
    /// The track took detections of no target.
    TookClutter,
    /// The tracker ended the track.
    Ended,
    /// The track lives on outside the gate.
    LeftGate,
    /// The track has no point at this step.
    Silent,
    /// A track is near the target, and was not known at the time.
    NotConfirmed,
    /// The target was detected, and no track is near it.
    NoTrack,
    /// A second track of the target is near, too.
    SecondTrack,
    /// The target that the track followed is no more.
    TargetGone,
    /// Nothing is known of what the track took.
    Unknown,
}

impl Cause {
    pub const ALL: [(Cause, &'static str); 12] = [
        (Cause::OutsideCoverage, "outside_coverage"),
        (Cause::NoDetection, "no_detection"),
        (Cause::TookTarget, "took_target"),
        (Cause::TookClutter, "took_clutter"),
        (Cause::Ended, "ended"),
        (Cause::LeftGate, "left_gate"),
        (Cause::Silent, "silent"),
        (Cause::NotConfirmed, "not_confirmed"),
        (Cause::NoTrack, "no_track"),
        (Cause::SecondTrack, "second_track"),
        (Cause::TargetGone, "target_gone"),
        (Cause::Unknown, "unknown"),
    ];

    pub fn name(self) -> &'static str {
        Self::ALL[self as usize].1
    }
}

/// What became of the track that had followed a target.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema), schema(as = BreakCause))]
#[serde(rename_all = "snake_case")]
pub enum Fate {
    /// It was given up.
    Ended,
    /// It followed another target from then on.
    TookOtherTarget,
    /// It lived on outside the gate.
    LeftGate,
}

/// Where in the life of a target it is missed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    Whole,
    Beginning,
    Middle,
    End,
}

/// Events of one kind in a row, and why. Targets and tracks are indices into the ids of the comparison.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Episode {
    pub event: EventKind,
    pub cause: Cause,
    pub from_step: u32,
    pub to_step: u32,
    /// How many events of the log it holds.
    pub steps: u32,
    pub truth: Option<u32>,
    /// The track that had followed the target, is near it, or is without one.
    pub track: Option<u32>,
    /// The target that the track took.
    pub other_truth: Option<u32>,
    /// Of a switch, the track before; of a second track, the one that is matched.
    pub other_track: Option<u32>,
    /// Of a miss, in which part of the target's life.
    pub part: Option<Part>,
    /// Of a break, what became of the track.
    pub fate: Option<Fate>,
    /// Of a miss: how many of its steps have scans, and in how many the target was seen. `None` without detections.
    pub seen: Option<Seen>,
    /// Of a break: how many steps up to it, in a row, did not see the target.
    pub unseen_scans: Option<u32>,
    /// How many detections of the other target, or of none, the track took.
    pub taken: u32,
    /// When the track was last given a detection; `None` where tracks do not say.
    pub last_detection_time_s: Option<f64>,
}

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Seen {
    /// Steps that have scans.
    pub scans: u32,
    /// Those with a detection within the gate.
    pub seen: u32,
    /// Those in which some sensor could see the target.
    pub covered: u32,
}

impl Episode {
    fn new(event: EventKind, cause: Cause, step: u32) -> Episode {
        Episode {
            event,
            cause,
            from_step: step,
            to_step: step,
            steps: 1,
            truth: None,
            track: None,
            other_truth: None,
            other_track: None,
            part: None,
            fate: None,
            seen: None,
            unseen_scans: None,
            taken: 0,
            last_detection_time_s: None,
        }
    }
}

/// The target that a detection is of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Of {
    Target(u32),
    Nobody,
}
