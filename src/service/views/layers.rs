//! What all pictures of a job are made from.

use super::metrics::MetricTable;
use crate::model::scan::Recording;
use crate::model::sensor::SensorSettings;
use crate::model::track::TrackSet;
use crate::model::truth::TruthSet;
use serde_json::Value;

/// The data behind the pictures of a job: what it made, else what it was made from.
#[derive(Debug, Clone, Default)]
pub struct JobLayers {
    pub detections: Option<Recording>,
    pub truth: Option<TruthSet>,
    pub tracks: Option<TrackSet>,
    /// Metrics over time; empty where none were computed.
    pub metrics: MetricTable,
    /// What is known of the sensors behind them.
    pub sensors: Vec<SensorSettings>,
    /// The request of the job.
    pub spec: Value,
}
