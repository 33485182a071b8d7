//! Asking for jobs, and asking whether one could be asked for.

use super::super::body::JsonBody;
use super::super::conditional::created;
use super::super::headers::{idempotency_key, note_replay, note_wait, patience, preferred_wait};
use super::super::query::NoParams;
use super::super::state::AppState;
use crate::experiment::Cost;
use crate::experiment::job_shape::take_kind;
use crate::model::fault::Fault;
use crate::registry::placed;
use crate::service::http::error::{ApiError, ApiResult};
use crate::service::types::{FaultItem, Job, JobKind};
use axum::Json;
use axum::extract::State;
use axum::http::{HeaderMap, StatusCode};
use axum::response::{IntoResponse, Response};
use serde::Serialize;
use serde_json::{Map, Value};
use utoipa::ToSchema;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

pub fn routes() -> OpenApiRouter<AppState> {
    OpenApiRouter::new()
        .routes(routes!(create_job))
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
        async fn $name(State(app): State<AppState>, _: NoParams, headers: HeaderMap, JsonBody(mut body): JsonBody) -> ApiResult {
            let kind = kind_of(&mut body, $kind).map_err(ApiError::validation)?;
            create(app, kind, &headers, body).await
        }
    };
}

create!(
    /// Ask for a job
    ///
    /// Queues the job that the body describes: a request with its `kind`, as `trackloom run` reads it from a file.
    create_job, "/v1/jobs", "createJob", None
);
create!(
    /// Simulate a scenario
    ///
    /// Queues a job that plays the scenario: detections with known origins, and the truth.
    create_simulate_job, "/v1/jobs/simulate", "createSimulateJob", Some(JobKind::Simulate)
);
create!(
    /// Track the targets of a recording
    ///
    /// Queues a job that runs an associator over detections: tracks with their candidates and probabilities.
    create_associate_job, "/v1/jobs/associate", "createAssociateJob", Some(JobKind::Associate)
);
create!(
    /// Judge tracks against the truth
    ///
    /// Queues a job that judges tracks, or makes them of `input` first. A job named as a source is waited for.
    create_evaluate_job, "/v1/jobs/evaluate", "createEvaluateJob", Some(JobKind::Evaluate)
);
create!(
    /// Put together reports of several sensors
    ///
    /// Queues a job that groups what several sensors reported of one target at one instant.
    create_group_job, "/v1/jobs/group", "createGroupJob", Some(JobKind::Group)
);
create!(
    /// Put together tracks of several sensors
    ///
    /// Queues a job that finds which tracks of several sensors are of one target, and fuses them to system tracks.
    create_correlate_job, "/v1/jobs/correlate", "createCorrelateJob", Some(JobKind::Correlate)
);

create!(
    /// Run a job many times over a grid
    ///
    /// Queues a job that runs another job's body many times over a grid of its parameters: means, intervals and paired
    /// differences, cell by cell.
    create_campaign_job, "/v1/jobs/campaign", "createCampaignJob", Some(JobKind::Campaign)
);

/// The kind of a job, taken out of its body. A job that is asked for by the path of a kind may name it as well.
fn kind_of(body: &mut Value, asked: Option<JobKind>) -> Result<JobKind, Vec<Fault>> {
    if let Some(kind) = asked.filter(|_| body.get("kind").is_none()) {
        return Ok(kind);
    }
    if !body.is_object() {
        return Err(vec![
            Fault::new("", "wrong_type", "expected an object").allowing("an object"),
        ]);
    }
    let named = take_kind(body)?;
    match asked.filter(|kind| *kind != named) {
        None => Ok(named),
        Some(kind) => {
            let detail = format!(
                "the job is of the kind '{}', not '{}'",
                named.name(),
                kind.name()
            );
            Err(vec![
                Fault::new("/kind", "conflict", detail).allowing(kind.name()),
            ])
        }
    }
}

async fn create(app: AppState, kind: JobKind, headers: &HeaderMap, body: Value) -> ApiResult {
    let wait_s = preferred_wait(headers)?;
    let submitted = app
        .jobs
        .submit(kind, body, idempotency_key(headers)?)
        .await?;
    let mut response = answer(&app, submitted.job, wait_s).await?;
    if submitted.replayed {
        note_replay(&mut response);
    }
    Ok(response)
}

/// 202 with the job, or 200 where it ended within the wait.
pub(super) async fn answer(app: &AppState, job: Job, wait_s: Option<u64>) -> ApiResult {
    let job = if wait_s.is_some() {
        app.jobs.wait(job.id, patience(wait_s)).await?
    } else {
        job
    };
    let status = if job.state.is_terminal() && wait_s.is_some() {
        StatusCode::OK
    } else {
        StatusCode::ACCEPTED
    };
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
    estimate: Option<Cost>,
}

/// Check a job without queueing it
///
/// The same checks as for a job, and what the job would roughly cost. Faults are an answer here, not a refusal. The body is
/// the job; `{"kind": …, "spec": …}` with the body of a request of that kind as `spec` is understood as well.
#[utoipa::path(post, path = "/v1/validate", operation_id = "validateJob", tag = "jobs",
    responses((status = 200, description = "What was found.", body = ValidationResult)))]
async fn validate_job(
    State(app): State<AppState>,
    _: NoParams,
    JsonBody(body): JsonBody,
) -> ApiResult {
    let (kind, body) = read_job(body)?;
    let found = app.jobs.validate(kind, body).await?;
    let errors: Vec<FaultItem> = found.faults.into_iter().map(FaultItem::from).collect();
    let result = ValidationResult {
        valid: errors.is_empty(),
        errors,
        warnings: found.warnings,
        estimate: found.estimate,
    };
    Ok::<Response, ApiError>(Json(result).into_response())
}

/// The kind and the body of a job, which may be wrapped.
fn read_job(mut job: Value) -> Result<(JobKind, Value), ApiError> {
    let Some(mut spec) = job
        .as_object_mut()
        .and_then(|members| members.shift_remove("spec"))
    else {
        let kind = kind_of(&mut job, None).map_err(ApiError::validation)?;
        return Ok((kind, job));
    };
    let mut faults = Vec::new();
    let kind = kind_of(&mut job, None)
        .map_err(|found| faults.extend(found))
        .ok();
    for name in job.as_object().into_iter().flat_map(Map::keys) {
        faults.push(
            Fault::new(
                format!("/{name}"),
                "unknown_field",
                format!("unknown field '{name}'"),
            )
            .allowing("kind, spec"),
        );
    }
    let Some(kind) = kind.filter(|_| faults.is_empty()) else {
        return Err(ApiError::validation(faults));
    };
    kind_of(&mut spec, Some(kind)).map_err(|found| ApiError::validation(placed("/spec", found)))?;
    Ok((kind, spec))
}
