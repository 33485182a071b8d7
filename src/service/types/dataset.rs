//! Datasets on the wire.

use crate::model;
use jiff::Timestamp;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;
use uuid::Uuid;

/// What a dataset holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum DatasetKind {
    Detections,
    Truth,
    Tracks,
    BearingTime,
}

impl From<model::dataset::DatasetKind> for DatasetKind {
    fn from(kind: model::dataset::DatasetKind) -> Self {
        match kind {
            model::dataset::DatasetKind::Detections => DatasetKind::Detections,
            model::dataset::DatasetKind::Truth => DatasetKind::Truth,
            model::dataset::DatasetKind::Tracks => DatasetKind::Tracks,
            model::dataset::DatasetKind::BearingTime => DatasetKind::BearingTime,
        }
    }
}

impl From<DatasetKind> for model::dataset::DatasetKind {
    fn from(kind: DatasetKind) -> Self {
        match kind {
            DatasetKind::Detections => model::dataset::DatasetKind::Detections,
            DatasetKind::Truth => model::dataset::DatasetKind::Truth,
            DatasetKind::Tracks => model::dataset::DatasetKind::Tracks,
            DatasetKind::BearingTime => model::dataset::DatasetKind::BearingTime,
        }
    }
}

/// What is known of a sensor; what is absent comes from the data or from the request that uses it.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct SensorSettings {
    pub sensor_id: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub x_m: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub y_m: Option<f64>,
    /// Radius of the field of view around the sensor's position.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub max_range_m: Option<f64>,
    /// Probability that a target inside the field of view is detected in a scan.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub p_d: Option<f64>,
    /// Expected false detections per square metre and scan.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub clutter_per_m2: Option<f64>,
    /// Expected false detections per degree and scan, of a sensor whose bearings alone are used.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub clutter_per_deg: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub sigma_x_m: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub sigma_y_m: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub sigma_range_m: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub sigma_bearing_deg: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub sigma_range_rate_mps: Option<f64>,
}

impl From<model::sensor::SensorSettings> for SensorSettings {
    fn from(settings: model::sensor::SensorSettings) -> Self {
        let model::sensor::SensorSettings {
            sensor_id,
            x_m,
            y_m,
            max_range_m,
            p_d,
            clutter_per_m2,
            clutter_per_deg,
            sigma_x_m,
            sigma_y_m,
            sigma_range_m,
            sigma_bearing_deg,
            sigma_range_rate_mps,
        } = settings;
        SensorSettings {
            sensor_id,
            x_m,
            y_m,
            max_range_m,
            p_d,
            clutter_per_m2,
            clutter_per_deg,
            sigma_x_m,
            sigma_y_m,
            sigma_range_m,
            sigma_bearing_deg,
            sigma_range_rate_mps,
        }
    }
}

impl From<SensorSettings> for model::sensor::SensorSettings {
    fn from(settings: SensorSettings) -> Self {
        let SensorSettings {
            sensor_id,
            x_m,
            y_m,
            max_range_m,
            p_d,
            clutter_per_m2,
            clutter_per_deg,
            sigma_x_m,
            sigma_y_m,
            sigma_range_m,
            sigma_bearing_deg,
            sigma_range_rate_mps,
        } = settings;
        model::sensor::SensorSettings {
            sensor_id,
            x_m,
            y_m,
            max_range_m,
            p_d,
            clutter_per_m2,
            clutter_per_deg,
            sigma_x_m,
            sigma_y_m,
            sigma_range_m,
            sigma_bearing_deg,
            sigma_range_rate_mps,
        }
    }
}

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

impl From<&model::facts::SensorFacts> for SensorReports {
    fn from(facts: &model::facts::SensorFacts) -> Self {
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
