//! The report of a job: the same head for every kind, then the result as it was serialised once.

use crate::experiment::job_shape::with_kind;
use crate::experiment::{JobKind, Outcome, Plan};
use crate::service::types::{ReportInput, Timing};
use serde::Serialize;
use serde_json::Value;
use serde_json::value::RawValue;
use uuid::Uuid;

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
    /// Not part of the result, since it differs from run to run.
    timing: Timing,
    result: &'a RawValue,
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
        timing: Timing {
            cells: outcome.cell_times.clone(),
            ..timing
        },
        result: &result,
    })
}

/// Version of the program that makes the results.
pub const ENGINE_VERSION: &str = crate::service::build_info::VERSION;
