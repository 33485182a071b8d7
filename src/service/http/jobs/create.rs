//! Asking for jobs, and asking whether one could be asked for.

use super::super::body::JsonBody;
use super::super::conditional::created;
use super::super::headers::{idempotency_key, note_replay, note_wait, patience, preferred_wait};
use super::super::query::{NoParams, names};
use super::super::state::AppState;
use crate::model::fault::Fault;
use crate::service::error::{ApiError, ApiResult};
use crate::service::types::{FaultItem, Job, JobKind};
use axum::Json;
use axum::extract::State;
use axum::http::{HeaderMap, StatusCode};
use axum::response::{IntoResponse, Response};
use serde::Serialize;
use serde_json::Value;
use utoipa::ToSchema;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

pub fn routes() -> OpenApiRouter<AppState> {
    OpenApiRouter::new()
        .routes(routes!(create_simulate_job))
        .routes(routes!(create_associate_job))
        .routes(routes!(create_evaluate_job))
        .routes(routes!(create_group_job))
        .routes(routes!(create_correlate_job))
        .routes(routes!(create_campaign_job))
        .routes(routes!(validate_job))
}

macro_rules! create {
    ($(#[$doc:meta])* $name:ident, $path:literal, $id:literal, $kind:expr) => {
        $(#[$doc])*
        #[utoipa::path(post, path = $path, operation_id = $id, tag = "jobs",
            params(
                ("Prefer" = Option<String>, Header, description = "`wait=n` waits up to n seconds (at most 30) for the end of the job."),
                ("Idempotency-Key" = Option<String>, Header, description = "The same key with the same body gives the same job again."),
            ),
            responses(
                (status = 200, description = "The job, ended within the wait that was asked for.", body = Job),
                (status = 202, description = "The job, queued.", body = Job),
            ))]
        async fn $name(State(app): State<AppState>, _: NoParams, headers: HeaderMap, JsonBody(body): JsonBody) -> ApiResult {
            create(app, $kind, &headers, body).await
        }
    };
}

create!(
    /// Simulate a scenario
    ///
    /// Queues a job that plays the scenario: detections with known origins, and the truth.
    create_simulate_job, "/v1/jobs/simulate", "createSimulateJob", JobKind::Simulate
);
create!(
    /// Track the targets of a recording
    ///
    /// Queues a job that runs an associator over detections: tracks with their candidates and probabilities.
    create_associate_job, "/v1/jobs/associate", "createAssociateJob", JobKind::Associate
);
create!(
    /// Judge tracks against the truth
    ///
    /// Queues a job that judges tracks, or makes them of `input` first. A job named as a source is waited for.
    create_evaluate_job, "/v1/jobs/evaluate", "createEvaluateJob", JobKind::Evaluate
);
create!(
    /// Put together reports of several sensors
    ///
    /// Queues a job that groups what several sensors reported of one target at one instant.
    create_group_job, "/v1/jobs/group", "createGroupJob", JobKind::Group
);
create!(
    /// Put together tracks of several sensors
    ///
    /// Queues a job that finds which tracks of several sensors are of one target, and fuses them to system tracks.
    create_correlate_job, "/v1/jobs/correlate", "createCorrelateJob", JobKind::Correlate
);

create!(
    /// Run a job many times over a grid
    ///
    /// Queues a job that runs another job's body many times over a grid of its parameters: means, intervals and paired
    /// differences, cell by cell.
    create_campaign_job, "/v1/jobs/campaign", "createCampaignJob", JobKind::Campaign
);

async fn create(app: AppState, kind: JobKind, headers: &HeaderMap, body: Value) -> ApiResult {
    let wait_s = preferred_wait(headers)?;
    let submitted = app.jobs.submit(kind, body, idempotency_key(headers)?).await?;
    let mut response = answer(&app, submitted.job, wait_s).await?;
    if submitted.replayed {
        note_replay(&mut response);
    }
    Ok(response)
}

/// 202 with the job, or 200 where it ended within the wait.
pub(super) async fn answer(app: &AppState, job: Job, wait_s: Option<u64>) -> ApiResult {
    let job = if wait_s.is_some() { app.jobs.wait(job.id, patience(wait_s)).await? } else { job };
    let status = if job.state.is_terminal() && wait_s.is_some() { StatusCode::OK } else { StatusCode::ACCEPTED };
    let location = job.links.self_path.clone();
    let mut response = created(status, &location, job);
    note_wait(&mut response, wait_s);
    Ok(response)
}

/// What a check of a request found.
#[derive(Serialize, ToSchema)]
struct ValidationResult {
    valid: bool,
    errors: Vec<FaultItem>,
    warnings: Vec<String>,
    /// Absent where there are errors.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    estimate: Option<CostEstimate>,
}

/// What a job will roughly cost.
#[derive(Serialize, ToSchema)]
struct CostEstimate {
    /// Detections that a simulation will make, or that are known to be in the data.
    detections: u64,
    cost_s: f64,
    bytes: u64,
}

/// Check a request without queueing it
///
/// The same checks as for a job, and what the job would roughly cost. Faults are an answer here, not a refusal.
#[utoipa::path(post, path = "/v1/validate", operation_id = "validateJob", tag = "jobs",
    responses((status = 200, description = "What was found.", body = ValidationResult)))]
async fn validate_job(State(app): State<AppState>, _: NoParams, JsonBody(body): JsonBody) -> ApiResult {
    let (kind, spec) = read_validate(&body)?;
    let found = app.jobs.validate(kind, spec).await?;
    let estimate =
        found.estimate.map(|estimate| CostEstimate { detections: estimate.detections, cost_s: estimate.cost_s, bytes: estimate.bytes });
    let errors: Vec<FaultItem> = found.faults.into_iter().map(FaultItem::from).collect();
    let result = ValidationResult { valid: errors.is_empty(), errors, warnings: found.warnings, estimate };
    Ok::<Response, ApiError>(Json(result).into_response())
}

fn read_validate(body: &Value) -> Result<(JobKind, Value), ApiError> {
    let Value::Object(members) = body else {
        return Err(ApiError::validation(vec![Fault::new("", "wrong_type", "expected an object").allowing("an object")]));
    };
    let mut faults = Vec::new();
    let kinds = names(JobKind::ALL.map(JobKind::name));
    let kind = members.get("kind").and_then(Value::as_str).and_then(JobKind::from_name);
    if kind.is_none() {
        let code = if members.contains_key("kind") { "unknown_value" } else { "missing" };
        faults.push(Fault::new("/kind", code, "'kind' must name a kind of job").allowing(kinds));
    }
    if !members.contains_key("spec") {
        faults.push(Fault::new("/spec", "missing", "'spec' is required").allowing("the body of a job"));
    }
    for name in members.keys().filter(|name| !matches!(name.as_str(), "kind" | "spec")) {
        faults.push(Fault::new(format!("/{name}"), "unknown_field", format!("unknown field '{name}'")).allowing("kind, spec"));
    }
    match (kind, members.get("spec")) {
        (Some(kind), Some(spec)) if faults.is_empty() => Ok((kind, spec.clone())),
        _ => Err(ApiError::validation(faults)),
    }
}
