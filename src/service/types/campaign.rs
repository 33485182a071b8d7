//! The result of a campaign, on the wire.

pub use crate::experiment::CellTime;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use utoipa::ToSchema;

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct CampaignResult {
    /// Names of the outcomes, in their order.
    pub outcomes: Vec<String>,
    /// Of the intervals.
    pub confidence: f64,
    pub cells: Vec<CampaignCell>,
}

/// What a campaign has found so far.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct CampaignSoFar {
    /// Whether this is the result of the report.
    pub is_final: bool,
    /// Runs that are told of: as many of each cell as all cells have.
    pub runs: u64,
    pub result: CampaignResult,
}

/// What the runs of one cell gave. Each run by itself is in the file `runs.csv`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct CampaignCell {
    pub name: String,
    /// Its point on each axis.
    pub parameters: BTreeMap<String, String>,
    pub runs: u64,
    /// Why it has no more: `runs` (all are done) or `half_width` (of `stop_at`, reached); `not_yet` while the campaign is running.
    pub ended: String,
    pub outcomes: BTreeMap<String, OutcomeSummary>,
    /// Run by run to the cell it is compared with.
    pub differences: BTreeMap<String, OutcomeDifference>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub compared_with: Option<String>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct OutcomeSummary {
    /// Runs that have the number.
    pub count: u64,
    /// Runs that do not.
    pub missing: u64,
    pub mean: Option<f64>,
    pub interval: Option<Interval>,
    /// `t`, `wilson` or `bootstrap`.
    pub method: String,
    pub standard_deviation: Option<f64>,
    pub min: Option<f64>,
    pub median: Option<f64>,
    pub max: Option<f64>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct OutcomeDifference {
    /// Runs in which both cells have the number.
    pub pairs: u64,
    pub mean: Option<f64>,
    /// Student's t.
    pub interval: Option<Interval>,
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Interval {
    pub low: f64,
    pub high: f64,
}
