//! The report of a job: the same head for every kind, then the result as it was serialised once.

use crate::experiment::job_shape::with_kind;
use crate::experiment::{CellTime, Input, InputRequest, JobKind, Outcome, Plan, Source};
use crate::model::dataset::DatasetKind;
use serde::Serialize;
use serde_json::Value;
use serde_json::value::RawValue;
use uuid::Uuid;

/// Seconds that each step computed; not part of the result, since they differ from run to run.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct Timing {
    pub load_s: f64,
    pub simulate_s: f64,
    pub detect_s: f64,
    pub associate_s: f64,
    pub correlate_s: f64,
    pub evaluate_s: f64,
    pub total_s: f64,
}

#[derive(Serialize)]
struct WholeTiming<'a> {
    #[serde(flatten)]
    steps: Timing,
    #[serde(skip_serializing_if = "<[CellTime]>::is_empty")]
    cells: &'a [CellTime],
}

#[derive(Serialize)]
struct Report<'a> {
    kind: JobKind,
    job_id: Uuid,
    /// With its `kind`, so that it is a job that can be run again.
    spec: Value,
    seed: u32,
    engine_version: &'a str,
    inputs: &'a [ReportInput],
    warnings: &'a [String],
    timing: WholeTiming<'a>,
    result: &'a RawValue,
}

/// What the job read.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ReportInput {
    role: DatasetKind,
    source: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    dataset_id: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    job_id: Option<String>,
    sha256: String,
}

impl ReportInput {
    pub fn new(request: &InputRequest, input: &Input) -> Self {
        let (source, dataset_id, job_id) = match &request.source {
            Source::Dataset { dataset_id, .. } => ("dataset", Some(dataset_id.clone()), None),
            Source::Job { job_id, .. } => ("job", None, Some(job_id.clone())),
        };
        ReportInput {
            role: request.role,
            source,
            dataset_id,
            job_id,
            sha256: input.sha256.clone(),
        }
    }
}

/// The bytes of `report.json`.
pub fn build(
    job_id: Uuid,
    plan: &Plan,
    inputs: &[ReportInput],
    outcome: &Outcome,
    timing: Timing,
) -> serde_json::Result<Vec<u8>> {
    let result = serde_json::value::to_raw_value(&outcome.result)?;
    serde_json::to_vec(&Report {
        kind: plan.kind,
        job_id,
        spec: with_kind(plan.kind, &plan.spec),
        seed: plan.seed,
        engine_version: ENGINE_VERSION,
        inputs,
        warnings: &outcome.warnings,
        timing: WholeTiming {
            steps: timing,
            cells: &outcome.cell_times,
        },
        result: &result,
    })
}

/// Version of the program that makes the results.
pub const ENGINE_VERSION: &str = crate::service::build_info::VERSION;
