//! What callers of the facade ask for, and what they get besides the wire types.

use crate::experiment::plan::Estimate;
use crate::formats::npy::BearingTimeAxes;
use crate::model::dataset::DatasetKind;
use crate::model::fault::Fault;
use crate::model::scan::Recording;
use crate::model::sensor::SensorSettings;
use crate::model::track::TrackSet;
use crate::model::truth::TruthSet;
use crate::service::storage::blobs::Content;
pub use crate::service::storage::blobs::ReceivedFile;
use crate::service::types::Job;
use crate::service::views::metrics::MetricTable;
use serde_json::Value;
use std::collections::BTreeMap;

/// A job that was submitted.
#[derive(Debug, Clone)]
pub struct Submitted {
    pub job: Job,
    /// The idempotency key had been used for the same request before: this is the job of that time.
    pub replayed: bool,
}

/// What a check of a request found.
#[derive(Debug, Clone)]
pub struct Validation {
    pub faults: Vec<Fault>,
    pub warnings: Vec<String>,
    /// Absent when there are faults.
    pub estimate: Option<Estimate>,
}

/// What to change of a job; absent members stay.
#[derive(Debug, Clone, Default)]
pub struct JobPatch {
    /// An empty name removes it.
    pub name: Option<String>,
    /// All labels from now on.
    pub labels: Option<BTreeMap<String, String>>,
}

/// What the uploader said about a file.
#[derive(Debug, Clone, Default)]
pub struct DatasetMeta {
    pub name: Option<String>,
    pub kind: Option<DatasetKind>,
    /// A name of `formats::FORMATS`; absent: told from the file name, else `csv`.
    pub format: Option<String>,
    /// The file's column name → the canonical one.
    pub columns: BTreeMap<String, String>,
    /// The axes of a bearing-time record whose file does not have them.
    pub bearing_time: Option<BearingTimeAxes>,
    pub sensors: Vec<SensorSettings>,
    pub file_name: Option<String>,
}

/// A file to serve; it stays where it is until its owner is deleted.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StoredFile {
    pub content: Content,
    pub media_type: String,
    pub bytes: u64,
    pub sha256: String,
    /// What to call it when it is saved.
    pub file_name: String,
}

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
