//! The data behind the pictures of a job.

use super::super::extract::{Id, IdAndName};
use super::super::query::{Params, names};
use super::super::state::AppState;
use crate::service::http::error::{ApiError, ApiResult};
use crate::service::views::{DEFAULT_MAX_POINTS, Window, plan, series};
use axum::Json;
use axum::extract::State;
use axum::http::{HeaderValue, header};
use axum::response::{IntoResponse, Response};
use serde::Serialize;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

const MAX_POINTS: std::ops::RangeInclusive<u64> = 2..=1_000_000;

pub fn routes() -> OpenApiRouter<AppState> {
    OpenApiRouter::new()
        .routes(routes!(get_job_series))
        .routes(routes!(get_job_plan))
}

/// Get a series of a job
///
/// `track_probability`: one row for each candidate of each track at each scan. `association_map`: one row for each track,
/// with how its probability was shared at each scan. `mode_probability`: one row for
/// each motion model of each track at each scan, where the filter has several. `scan_counts`: one row for each scan.
/// `bearing_time`: one row for each bearing of truth, detections and tracks.
/// `gates`: one row for each track and scan, with what was expected and its covariance.
/// `metrics`: one row for each time at which truth and tracks were compared.
/// Above `max_points` rows the answer is reduced, and `method` says how.
#[utoipa::path(get, path = "/v1/jobs/{id}/series/{name}", operation_id = "getJobSeries", tag = "results",
    params(
        ("id" = uuid::Uuid, Path, description = "Identity of the job."),
        ("name" = String, Path, description = "`track_probability`, `association_map`, `mode_probability`, `scan_counts`, `bearing_time`, `gates` or `metrics`."),
        ("from" = Option<f64>, Query, description = "First time (s)."),
        ("to" = Option<f64>, Query, description = "Last time (s)."),
        ("track" = Option<String>, Query, description = "Only this track."),
        ("max_points" = Option<u32>, Query, minimum = 2, maximum = 1_000_000, description = "Rows at most; 50000 when absent."),
    ),
    responses((status = 200, description = "The series.", body = series::Series)))]
async fn get_job_series(
    State(app): State<AppState>,
    IdAndName(id, name): IdAndName,
    params: Params,
) -> ApiResult {
    let window = window(params)?;
    let series = series::named(&name).ok_or_else(|| {
        ApiError::new(
            "not_found",
            format!(
                "there is no series '{name}'; there are {}",
                names(series::SERIES.map(|entry| entry.0))
            ),
        )
    })?;
    let layers = app.jobs.load_job_layers(id).await?;
    compute(move || series(&layers, &window))
        .await
        .map(immutable)
}

/// Get the plan view of a job
///
/// Truth, detections and tracks in the plane, with the scans to step through. A layer of more than `max_points` points
/// is reduced, and its `method` says how; `density` then counts all detections over the plane.
#[utoipa::path(get, path = "/v1/jobs/{id}/plan", operation_id = "getJobPlan", tag = "results",
    params(
        ("id" = uuid::Uuid, Path, description = "Identity of the job."),
        ("from" = Option<f64>, Query, description = "First time (s)."),
        ("to" = Option<f64>, Query, description = "Last time (s)."),
        ("track" = Option<String>, Query, description = "Only this track, in the layer of tracks."),
        ("max_points" = Option<u32>, Query, minimum = 2, maximum = 1_000_000, description = "Points of a layer at most; 50000 when absent."),
    ),
    responses((status = 200, description = "The layers.", body = plan::Plan)))]
async fn get_job_plan(State(app): State<AppState>, Id(id): Id, params: Params) -> ApiResult {
    let window = window(params)?;
    let layers = app.jobs.load_job_layers(id).await?;
    compute(move || plan::of(&layers, &window))
        .await
        .map(immutable)
}

fn window(mut params: Params) -> Result<Window, ApiError> {
    let window = Window {
        from_s: params.number("from"),
        to_s: params.number("to"),
        track_id: params.text("track"),
        max_points: params
            .whole_number("max_points", MAX_POINTS)
            .map_or(DEFAULT_MAX_POINTS, |points| points as usize),
    };
    if let (Some(from_s), Some(to_s)) = (window.from_s, window.to_s)
        && from_s > to_s
    {
        params.fault(
            "to",
            "out_of_range",
            "the window ends before it begins",
            &format!(">= {from_s}"),
        );
    }
    params.finish().map(|()| window)
}

/// Columns of a large job are work for a thread that may block.
async fn compute<T: Send + 'static>(
    work: impl FnOnce() -> T + Send + 'static,
) -> Result<T, ApiError> {
    tokio::task::spawn_blocking(work)
        .await
        .map_err(ApiError::internal)
}

/// The data of a job that has ended do not change.
fn immutable(value: impl Serialize) -> Response {
    let mut response = Json(value).into_response();
    response.headers_mut().insert(
        header::CACHE_CONTROL,
        HeaderValue::from_static("private, max-age=3600"),
    );
    response
}
