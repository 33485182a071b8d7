//! Changing what has been asked for: name and labels, cancel, rerun, delete.

use super::super::body::{JsonBody, checked};
use super::super::extract::{Id, Question};
use super::super::headers::preferred_wait;
use super::super::query::NoParams;
use super::super::state::AppState;
use super::create::answer;
use crate::service::http::error::ApiResult;
use crate::service::jobs::{JOB_PATCH, JobPatch};
use crate::service::types::Job;
use axum::Json;
use axum::extract::State;
use axum::http::StatusCode;
use axum::response::IntoResponse;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

pub fn routes() -> OpenApiRouter<AppState> {
    OpenApiRouter::new()
        .routes(routes!(update_job, delete_job))
        .routes(routes!(cancel_job))
        .routes(routes!(rerun_job))
}

/// Rename or label a job
///
/// Name and labels are for people; they change nothing of the job's work.
#[utoipa::path(patch, path = "/v1/jobs/{id}", operation_id = "updateJob", tag = "jobs",
    params(("id" = uuid::Uuid, Path, description = "Identity of the job.")),
    responses((status = 200, description = "The job as it is now.", body = Job)))]
async fn update_job(
    State(app): State<AppState>,
    Id(id): Id,
    _: NoParams,
    JsonBody(body): JsonBody,
) -> ApiResult {
    let patch: JobPatch = checked(&body, &JOB_PATCH, "")?;
    Ok(Json(app.jobs.patch(id, patch).await?).into_response())
}

/// Delete a job
///
/// Refused with `job_active` until it has ended. Its report and files go; datasets that it made stay.
#[utoipa::path(delete, path = "/v1/jobs/{id}", operation_id = "deleteJob", tag = "jobs",
    params(("id" = uuid::Uuid, Path, description = "Identity of the job.")),
    responses((status = 204, description = "It is deleted.")))]
async fn delete_job(State(app): State<AppState>, Id(id): Id, _: NoParams) -> ApiResult {
    app.jobs.delete(id).await?;
    Ok(StatusCode::NO_CONTENT.into_response())
}

/// Cancel a job
///
/// A queued job is canceled at once, a running one as soon as it notices. Refused with `job_terminal` where it has ended.
#[utoipa::path(post, path = "/v1/jobs/{id}/cancel", operation_id = "cancelJob", tag = "jobs",
    params(("id" = uuid::Uuid, Path, description = "Identity of the job.")),
    responses((status = 202, description = "The job, asked to stop.", body = Job)))]
async fn cancel_job(State(app): State<AppState>, Id(id): Id, _: NoParams) -> ApiResult {
    Ok((StatusCode::ACCEPTED, Json(app.jobs.cancel(id).await?)).into_response())
}

/// Run a job again
///
/// Queues a new job with the same request. Its report has the same `result`, byte for byte.
#[utoipa::path(post, path = "/v1/jobs/{id}/rerun", operation_id = "rerunJob", tag = "jobs",
    params(
        ("id" = uuid::Uuid, Path, description = "Identity of the job."),
        ("Prefer" = Option<String>, Header, description = "`wait=n` waits up to n seconds (at most 30) for the end of the job."),
    ),
    responses(
        (status = 200, description = "The new job, ended within the wait that was asked for.", body = Job),
        (status = 202, description = "The new job, queued.", body = Job),
    ))]
async fn rerun_job(asked: Question) -> ApiResult {
    let (State(app), Id(id), _, headers) = asked;
    let wait_s = preferred_wait(&headers)?;
    let job = app.jobs.rerun(id).await?;
    answer(&app, job, wait_s).await
}
