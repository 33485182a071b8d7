//! How long a job took, on the wire.

use super::campaign::CellTime;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// Seconds that each step computed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Timing {
    pub load_s: f64,
    pub simulate_s: f64,
    pub detect_s: f64,
    pub associate_s: f64,
    pub correlate_s: f64,
    pub evaluate_s: f64,
    pub total_s: f64,
    /// Of a campaign.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub cells: Vec<CellTime>,
}
