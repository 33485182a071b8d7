//! What a campaign has found so far, on the wire.

use crate::experiment::CampaignResult;
use serde::Serialize;
use utoipa::ToSchema;

/// What a campaign has found so far.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct CampaignSoFar {
    /// Whether this is the result of the report.
    pub is_final: bool,
    /// Runs that are told of: as many of each cell as all cells have.
    pub runs: u64,
    pub result: CampaignResult,
}
