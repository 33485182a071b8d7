//! Runs a plan on its loaded inputs.

use super::observer::Observer;
use super::plan::Plan;
use crate::model::dataset::{Dataset, DatasetSummary};
use crate::model::fault::Fault;
use crate::model::sensor::SensorSettings;
use serde_json::Value;

/// One loaded input.
#[derive(Debug, Clone)]
pub struct Input {
    pub dataset: Dataset,
    /// What is known of the sensors besides the data: from the upload or from the job that made it.
    pub sensors: Vec<SensorSettings>,
    /// SHA-256 of the bytes it was read from, in hex.
    pub sha256: String,
}

/// What was loaded for each [`super::plan::InputRequest`], in the same order; `None` for an optional one that is absent.
pub type Inputs = Vec<Option<Input>>;

/// A file that a job leaves behind.
#[derive(Debug, Clone)]
pub struct Artifact {
    /// `detections.csv`, `truth.csv`, `tracks.csv`, …
    pub name: &'static str,
    pub media_type: &'static str,
    pub bytes: Vec<u8>,
    /// Set when the artefact is a dataset that other jobs can use.
    pub dataset: Option<DatasetSummary>,
    /// What is known of the sensors behind it.
    pub sensors: Vec<SensorSettings>,
}

/// What a job found.
#[derive(Debug, Clone)]
pub struct Outcome {
    /// The report's `result`: the same bytes for the same spec, seed and inputs.
    pub result: Value,
    pub warnings: Vec<String>,
    pub artifacts: Vec<Artifact>,
}

#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RunError {
    /// The observer asked to stop.
    #[error("stopped")]
    Stopped,
    /// The data and the request do not fit together.
    #[error("{} fault(s) in the inputs", .0.len())]
    Faults(Vec<Fault>),
}

/// Does the work of `plan`.
///
/// # Errors
/// [`RunError::Stopped`] as soon as the observer says so; [`RunError::Faults`] when the inputs do not fit.
pub fn run(plan: &Plan, inputs: Inputs, observer: &mut dyn Observer) -> Result<Outcome, RunError> {
    let _ = (plan, inputs, observer);
    unimplemented!("being written")
}
