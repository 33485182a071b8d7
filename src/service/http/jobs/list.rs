//! Finding jobs.

use super::super::conditional;
use super::super::datasets::{paging, with_next};
use super::super::extract::{Id, Question};
use super::super::query::{Params, names};
use super::super::state::AppState;
use crate::service::http::error::ApiResult;
use crate::service::jobs::JobFilter;
use crate::service::types::{Job, JobKind, JobPage, JobSpec, JobState};
use axum::extract::State;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

pub fn routes() -> OpenApiRouter<AppState> {
    OpenApiRouter::new()
        .routes(routes!(list_jobs))
        .routes(routes!(get_job))
        .routes(routes!(get_job_spec))
}

/// List jobs
///
/// Newest first. Several filters must all match; a comma list matches any of its entries.
#[utoipa::path(get, path = "/v1/jobs", operation_id = "listJobs", tag = "jobs",
    params(
        ("state" = Option<String>, Query, description = "States, separated by commas: queued, running, succeeded, failed, canceled."),
        ("kind" = Option<String>, Query, description = "Kinds, separated by commas: simulate, associate, evaluate, group, correlate, campaign."),
        ("label" = Option<Vec<String>>, Query, max_items = 16, description = "`key:value`; repeated, all must match."),
        ("created_after" = Option<String>, Query, description = "RFC 3339 time."),
        ("created_before" = Option<String>, Query, description = "RFC 3339 time."),
        ("q" = Option<String>, Query, max_length = 200, description = "Part of the name, or the start of the id."),
        ("sort" = Option<String>, Query, min_length = 1, description = "`-created_at` (newest first) or `created_at`."),
        ("limit" = Option<u32>, Query, minimum = 1, maximum = 200, description = "Jobs of a page; 50 when absent."),
        ("cursor" = Option<String>, Query, min_length = 1, description = "Where the page before ended."),
        ("count" = Option<bool>, Query, description = "Count every match in `total`."),
    ),
    responses((status = 200, description = "One page.", body = JobPage)))]
async fn list_jobs(State(app): State<AppState>, mut params: Params) -> ApiResult {
    let filter = JobFilter {
        states: params.list(
            "state",
            &names(JobState::ALL.map(JobState::name)),
            JobState::from_name,
        ),
        kinds: params.list(
            "kind",
            &names(JobKind::ALL.map(JobKind::name)),
            JobKind::from_name,
        ),
        labels: params.labels("label"),
        created_after: params.timestamp("created_after"),
        created_before: params.timestamp("created_before"),
        q: params.text("q"),
        paging: paging(&mut params),
    };
    params.add(filter.faults());
    let next = params.next_page();
    params.finish()?;
    let page = app.jobs.list(filter).await?;
    Ok(with_next("/v1/jobs", &next, &page, &page.next_cursor))
}

/// Get a job
///
/// Its state and how far it is. `If-None-Match` with the last tag makes asking again cheap.
#[utoipa::path(get, path = "/v1/jobs/{id}", operation_id = "getJob", tag = "jobs",
    params(("id" = uuid::Uuid, Path, description = "Identity of the job.")),
    responses((status = 200, description = "The job.", body = Job)))]
async fn get_job(asked: Question) -> ApiResult {
    let (State(app), Id(id), _, headers) = asked;
    conditional::weakly_tagged(&headers, &app.jobs.get(id).await?)
}

/// Get the request of a job
///
/// As normalised: defaults filled in, presets written out. Posted again it is the same job.
#[utoipa::path(get, path = "/v1/jobs/{id}/spec", operation_id = "getJobSpec", tag = "jobs",
    params(("id" = uuid::Uuid, Path, description = "Identity of the job.")),
    responses((status = 200, description = "The request.", body = JobSpec)))]
async fn get_job_spec(asked: Question) -> ApiResult {
    let (State(app), Id(id), _, headers) = asked;
    conditional::weakly_tagged(&headers, &app.jobs.spec(id).await?)
}
