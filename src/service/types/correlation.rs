//! The result of a job that puts tracks together, on the wire.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// Which tracks are of one target. The fused tracks are in the file `system_tracks.csv`, all tuples in `tuples.csv`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct CorrelateResult {
    pub correlator: String,
    /// `chain`, `all_pairs`, `fused` or `likelihood_ratio`.
    pub statistic: String,
    /// In this order tracks stand in a tuple.
    pub sensors: Vec<CorrelatedSensor>,
    pub counts: CorrelationCounts,
    /// J of the last decision.
    pub cost: f64,
    /// No way to put the tracks together costs less; null where the correlator does not know.
    pub dual_bound: Option<f64>,
    /// How far J may be above the least cost there is, as a share of the bound; null without one.
    pub gap: Option<f64>,
    /// Absent where the correlator does not search.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub search: Option<CorrelationSearch>,
    pub confirm: CorrelationConfirmation,
    /// Tuples of two tracks or more; the first thousand.
    pub tuples: Vec<CorrelationTuple>,
    pub tuples_left_out: u64,
    /// Tracks that are alone; the first thousand.
    pub unassociated: Vec<UnassociatedTrack>,
    pub unassociated_left_out: u64,
    /// Null where nobody knows what the tracks are of.
    pub truth: Option<CorrelationTruth>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct CorrelatedSensor {
    pub sensor_id: String,
    pub tracks: u64,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub struct CorrelationCounts {
    pub sensors: u64,
    pub tracks: u64,
    pub common_times: u64,
    /// Numbers of a state that are compared.
    pub dimensions: u64,
    /// Pairs that may be of one target.
    pub links: u64,
    pub tuples: u64,
    pub unassociated: u64,
    pub system_tracks: u64,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct CorrelationSearch {
    /// The cost of the best solution of each generation or iteration.
    pub best: Vec<f64>,
    /// The mean cost of each.
    pub mean: Vec<f64>,
    pub generations: u64,
    /// Solutions whose cost was computed.
    pub evaluations: u64,
    /// Why it ended.
    pub stop: String,
}

/// A tuple stands when it was found in so many of so many decisions at successive times.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub struct CorrelationConfirmation {
    pub found: u64,
    pub of: u64,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct CorrelationTuple {
    /// The system track made of it.
    pub system_track_id: String,
    /// The track of each sensor; null where the sensor has none.
    pub tracks: Vec<Option<String>>,
    /// Null for a tuple that could not be made at the last time.
    pub cost: Option<f64>,
    /// The sum of squared distances over neighbouring sensors; null where two of them have no common time.
    pub b: Option<f64>,
    /// Squared distances from the information-weighted mean.
    pub statistic: f64,
    pub degrees_of_freedom: u64,
    /// Probability that tracks of one target are at least so far apart; null without common times.
    pub p_value: Option<f64>,
    /// Decisions that found it.
    pub found: u64,
    /// The target of most of its tracks.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub truth_id: Option<String>,
    /// Whether its tracks are all the tracks of one target and nothing else; absent where nobody knows.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub right: Option<bool>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct UnassociatedTrack {
    pub sensor_id: String,
    pub track_id: String,
}

/// Against what the tracks are really of.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct CorrelationTruth {
    /// Targets of which two sensors or more have tracks.
    pub tuples: u64,
    /// Those whose tracks, all of them and nothing else, are one tuple.
    pub tuples_right: u64,
    pub share_right: Option<f64>,
    pub pairwise_precision: Option<f64>,
    pub pairwise_recall: Option<f64>,
    /// Tracks of no target.
    pub false_tracks: u64,
}
