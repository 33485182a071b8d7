//! Datasets on the wire.

pub use crate::model::dataset::DatasetKind;
use crate::model::facts::SensorFacts;
pub use crate::model::sensor::SensorSettings;
use crate::model::space::Frame;
use crate::model::time::TimeBase;
use crate::model::units::Units;
use jiff::Timestamp;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use utoipa::ToSchema;
use uuid::Uuid;

/// What a sensor of a recording reported.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct SensorReports {
    pub sensor_id: String,
    pub scans: u64,
    pub detections: u64,
    /// Detections with a position.
    pub positions: u64,
    /// Detections with a range and a bearing.
    pub ranges: u64,
    /// Detections with a bearing alone.
    pub bearings: u64,
    /// Detections that have a range rate, too.
    pub range_rates: u64,
    /// Detections that have an amplitude, too.
    pub amplitudes: u64,
}

impl From<&SensorFacts> for SensorReports {
    fn from(facts: &SensorFacts) -> Self {
        SensorReports {
            sensor_id: facts.settings.sensor_id.clone(),
            scans: facts.scans,
            detections: facts.detections,
            positions: facts.positions,
            ranges: facts.ranges,
            bearings: facts.bearings,
            range_rates: facts.range_rates,
            amplitudes: facts.amplitudes,
        }
    }
}

/// Where a dataset came from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(untagged)]
pub enum DatasetOrigin {
    Upload(UploadOrigin),
    Job(JobOrigin),
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum UploadOriginKind {
    Upload,
}

/// Someone uploaded it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct UploadOrigin {
    pub kind: UploadOriginKind,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub file_name: Option<String>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum JobOriginKind {
    Job,
}

/// A job made it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct JobOrigin {
    pub kind: JobOriginKind,
    pub job_id: Uuid,
}

/// A dataset; its content never changes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct DatasetInfo {
    pub id: Uuid,
    pub name: String,
    pub kind: DatasetKind,
    pub format: String,
    pub bytes: u64,
    pub sha256: String,
    pub sensor_ids: Vec<String>,
    /// Scans of a recording, times of a bearing-time record; 0 for truth and tracks.
    pub scans: u64,
    /// Detections, truth points, track points or cells.
    pub rows: u64,
    /// Targets or tracks.
    pub objects: u64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub start_s: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub end_s: Option<f64>,
    /// Centre of the first cell of a bearing-time record, and of the last.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub first_bearing_deg: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub last_bearing_deg: Option<f64>,
    /// What each sensor of detections reported; empty for other kinds, and for what an earlier version kept until a job uses it.
    #[serde(default)]
    pub reports: Vec<SensorReports>,
    /// Of detections: whether each says which target it came from.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub has_truth_id: Option<bool>,
    /// Where on the Earth its origin is.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub frame: Option<Frame>,
    /// What its times count from.
    #[serde(default)]
    pub time_base: TimeBase,
    /// How the units of the uploaded file fared; absent of what a job made.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub units: Option<Units>,
    /// How the uploaded file was read: what another upload says in `meta` to be read likewise.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, value_type = Option<Object>)]
    pub reading: Option<Map<String, Value>>,
    pub origin: DatasetOrigin,
    pub warnings: Vec<String>,
    #[schema(value_type = String, format = DateTime)]
    pub created_at: Timestamp,
    pub sensors: Vec<SensorSettings>,
    pub links: DatasetLinks,
}

/// Paths of what belongs to a dataset.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct DatasetLinks {
    #[serde(rename = "self")]
    pub self_path: String,
    pub preview: String,
    pub content: String,
}

impl DatasetLinks {
    pub fn of(id: Uuid) -> Self {
        let base = format!("/v1/datasets/{id}");
        DatasetLinks {
            preview: format!("{base}/preview"),
            content: format!("{base}/content"),
            self_path: base,
        }
    }
}

/// One page of datasets.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct DatasetPage {
    pub items: Vec<DatasetInfo>,
    /// Give it back as `cursor` to get the next page; absent on the last one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub next_cursor: Option<String>,
    /// How many datasets match; only when asked for with `count=true`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub total: Option<u64>,
}
