//! What a job found: its report and its files.

use super::super::conditional;
use super::super::dashboard;
use super::super::datasets;
use super::super::extract::{Id, IdAndName, Question};
use super::super::query::{NoParams, Params};
use super::super::state::{AppState, FileContent};
use crate::service::http::error::{ApiError, ApiResult};
use crate::service::types::{ArtifactList, CampaignSoFar, Report};
use axum::Json;
use axum::extract::State;
use axum::http::{HeaderMap, header};
use axum::response::{Html, IntoResponse};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

pub fn routes() -> OpenApiRouter<AppState> {
    OpenApiRouter::new()
        .routes(routes!(get_job_report))
        .routes(routes!(get_job_report_page))
        .routes(routes!(list_job_artifacts))
        .routes(routes!(download_job_artifact))
        .routes(routes!(get_campaign_cells))
}

/// Get the report of a job
///
/// Refused with `result_not_ready` until the job has ended, and with `job_failed` where it ended without a result.
/// A report never changes.
#[utoipa::path(get, path = "/v1/jobs/{id}/report", operation_id = "getJobReport", tag = "results",
    params(("id" = uuid::Uuid, Path, description = "Identity of the job.")),
    responses((status = 200, description = "The report.", body = Report)))]
async fn get_job_report(asked: Question) -> ApiResult {
    let (State(app), Id(id), _, headers) = asked;
    conditional::stored(&headers, app.jobs.report(id).await?, false).await
}

/// Get the report of a job as one page
///
/// One HTML file that needs no service and no network: verdicts, limits, metrics, plan, track probabilities and the sentence of each
/// event. Its size is bounded, and the page says what was left out. Refused as the report is.
#[utoipa::path(get, path = "/v1/jobs/{id}/report.html", operation_id = "getJobReportPage", tag = "results",
    params(("id" = uuid::Uuid, Path, description = "Identity of the job.")),
    responses((status = 200, description = "The page.", content_type = "text/html", body = String)))]
async fn get_job_report_page(State(app): State<AppState>, Id(id): Id, _: NoParams) -> ApiResult {
    let template = dashboard::report_template().ok_or_else(|| {
        let detail = "this program was built without its dashboard, which the page is made of";
        ApiError::new("not_found", detail)
    })?;
    let page = app.jobs.report_page(id, template).await?;
    let mut response = Html(page).into_response();
    conditional::set(&mut response, header::CONTENT_SECURITY_POLICY, PAGE_POLICY);
    Ok(response)
}

/// The page carries its script and its style, and reaches nothing.
const PAGE_POLICY: &str = "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; \
     img-src data: blob:; sandbox allow-scripts allow-downloads allow-modals; frame-ancestors 'none'";

/// Get the cells of a campaign
///
/// Cell statistics of the runs completed so far, also after a campaign failed or was canceled: of as many
/// runs of each cell as all cells have. Refused with `result_not_ready` until there is a run. Another kind of job has none.
#[utoipa::path(get, path = "/v1/jobs/{id}/cells", operation_id = "getCampaignCells", tag = "results",
    params(("id" = uuid::Uuid, Path, description = "Identity of the job.")),
    responses((status = 200, description = "The cells.", body = CampaignSoFar)))]
async fn get_campaign_cells(asked: Question) -> ApiResult {
    let (State(app), Id(id), _, headers) = asked;
    conditional::weakly_tagged(&headers, &app.jobs.cells(id).await?)
}

/// List the files of a job
///
/// Tables and the report. A file that is a dataset can be the source of other jobs.
#[utoipa::path(get, path = "/v1/jobs/{id}/artifacts", operation_id = "listJobArtifacts", tag = "results",
    params(("id" = uuid::Uuid, Path, description = "Identity of the job.")),
    responses((status = 200, description = "The files.", body = ArtifactList)))]
async fn list_job_artifacts(State(app): State<AppState>, Id(id): Id, _: NoParams) -> ApiResult {
    Ok(Json(app.jobs.artifacts(id).await?).into_response())
}

/// Download a file of a job
///
/// The bytes, in the media type that the list of files names. Ranges are served. With `format` a file that is a dataset is written anew
/// in that format; one that cannot hold it is refused, and the refusal names those that can.
#[utoipa::path(get, path = "/v1/jobs/{id}/artifacts/{name}", operation_id = "downloadJobArtifact", tag = "results",
    params(
        ("id" = uuid::Uuid, Path, description = "Identity of the job."),
        ("name" = String, Path, description = "Name of the file, such as `tracks.csv`."),
        ("format" = Option<String>, Query, min_length = 1, description = "A format of the content of a dataset, such as geojson."),
    ),
    responses((status = 200, description = "The file.", content_type = "application/octet-stream", body = FileContent)))]
async fn download_job_artifact(
    State(app): State<AppState>,
    IdAndName(id, name): IdAndName,
    mut params: Params,
    headers: HeaderMap,
) -> ApiResult {
    let writer = datasets::asked_writer(&mut params);
    params.finish()?;
    if let Some(writer) = writer {
        let dataset = app.jobs.dataset_of_artifact(id, &name).await?;
        return datasets::written(&app, dataset, writer).await;
    }
    conditional::stored(&headers, app.jobs.artifact(id, &name).await?, true).await
}
