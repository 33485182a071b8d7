//! What happened to targets and tracks, as the report of an evaluation counts it.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// How often each kind of event occurred; the events themselves are in the file `events.csv`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct EventCounts {
    pub counts: EventKindCounts,
    /// Why tracks broke; the first thousand.
    pub breaks: Vec<TrackBreak>,
    /// Times at which truth and tracks were compared.
    pub steps: u64,
    pub truth_points: u64,
    pub track_points: u64,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct EventKindCounts {
    #[serde(rename = "match")]
    pub matched: u64,
    pub miss: u64,
    pub false_alarm: u64,
    pub switch: u64,
    #[serde(rename = "break")]
    pub broken: u64,
    pub reacquisition: u64,
    pub redundant: u64,
    pub divergence: u64,
}

/// What became of the track that had followed a target.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum BreakCause {
    /// It was given up.
    Ended,
    /// It followed another target from then on.
    TookOtherTarget,
    /// It lived on outside the gate.
    LeftGate,
}

/// A target that was followed, and at this time is not.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct TrackBreak {
    /// Where several sequences are judged: the one that it happened in.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub sequence: Option<String>,
    pub time_s: f64,
    pub truth_id: String,
    pub track_id: String,
    pub cause: BreakCause,
    /// The target that the track followed from then on.
    pub other_truth_id: Option<String>,
    /// Scans up to this one, in a row, without a detection within the gate of the target; null without detections.
    pub unseen_scans: Option<u64>,
    /// When the track was last given a detection; null where tracks do not say.
    pub last_detection_time_s: Option<f64>,
}
