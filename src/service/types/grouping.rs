//! The result of a job that groups reports, on the wire.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct GroupResult {
    pub grouping: GroupingSummary,
}

/// What was put together, and how right it is where the detections say which target they came from. The groups themselves
/// are in the file `groups.csv`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct GroupingSummary {
    /// The grouper.
    pub method: String,
    pub counts: GroupingCounts,
    /// Share of the targets reported by two sensors or more whose reports were put together exactly, averaged over the instants
    /// that have such targets; null where origins are not known.
    pub accuracy: Option<f64>,
    /// Share of the pairs of reports in one group that are of one target.
    pub precision: Option<f64>,
    /// Share of the pairs of reports of one target that are in one group.
    pub recall: Option<f64>,
    /// Absent where the grouper does not search.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub search: Option<GroupingSearch>,
    /// The first thousand.
    pub instants: Vec<GroupingInstant>,
    pub instants_left_out: u64,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct GroupingCounts {
    pub sensors: u64,
    pub instants: u64,
    pub reports: u64,
    pub groups: u64,
    /// Targets reported by two sensors or more, at each instant.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub duplicates: Option<u64>,
    /// Those whose reports were put together exactly.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub exact: Option<u64>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct GroupingSearch {
    pub mean_iterations: f64,
    pub max_iterations: u64,
    /// Mean over the instants of what is made small; null for a grouper that does not say.
    pub mean_cost: Option<f64>,
    /// Instants whose search did not come to rest.
    pub unconverged: u64,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct GroupingInstant {
    pub time_s: f64,
    pub reports: u64,
    pub groups: u64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub duplicates: Option<u64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub exact: Option<u64>,
}
