//! What a detector reports, on the wire.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// What a detector found in a bearing-time record.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct DetectionResult {
    /// Share of the true bearings at the scans that have a detection; `null` where there are none, absent without truth.
    pub p_d: Option<f64>,
    /// Detections without a target, on average; absent without truth.
    pub false_alarms_per_scan: Option<f64>,
    /// Of detections with a target; absent without truth.
    pub bearing_rmse_deg: Option<f64>,
    /// Largest distance of a detection from the true bearing of its target; absent without truth.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub gate_deg: Option<f64>,
    pub scans: u64,
    pub detections: u64,
    /// Times of the record.
    pub rows: u64,
    pub cells: u64,
    /// Independent values in the power of a cell, given or estimated; `null` of a constant threshold.
    pub noise_averages: Option<f64>,
    /// Threshold over the mean of the training cells, of an interval of full length; `null` of a constant threshold.
    pub threshold_over_mean_db: Option<f64>,
}
