//! What happened to targets and tracks, as the report of an evaluation counts it.

pub use crate::evaluation::causes::{Cause as EventCause, Fate as BreakCause};
pub use crate::experiment::{Break as TrackBreak, CauseCount};
use serde::Serialize;
use utoipa::ToSchema;

/// How often each kind of event occurred; the events themselves are in the file `events.csv`.
#[derive(Debug, Serialize, ToSchema)]
pub struct EventCounts {
    pub counts: EventKindCounts,
    /// How often what happened for which reason; each time is a line of `causes.csv`, in words.
    #[schema(required = false)]
    pub causes: Vec<CauseCount>,
    /// Why tracks broke; the first thousand.
    pub breaks: Vec<TrackBreak>,
    /// Times at which truth and tracks were compared.
    pub steps: u64,
    pub truth_points: u64,
    pub track_points: u64,
}

#[derive(Debug, Serialize, ToSchema)]
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
