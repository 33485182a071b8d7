//! The service about itself: health, numbers, version, documents, and what is not the API.

use super::dashboard;
use super::query::NoParams;
use super::state::AppState;
use crate::service::build_info;
use crate::service::http::error::{ApiError, ApiResult};
use crate::service::monitoring;
use crate::service::types::{JobState, Usage};
use axum::extract::{Request, State};
use axum::http::{HeaderMap, Method, header};
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use axum::{Json, Router};
use serde::Serialize;
use utoipa::ToSchema;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;
use utoipa_swagger_ui::SwaggerUi;

pub fn routes() -> OpenApiRouter<AppState> {
    OpenApiRouter::new()
        .routes(routes!(get_health))
        .routes(routes!(get_readiness))
        .routes(routes!(get_metrics))
        .routes(routes!(get_usage))
        .routes(routes!(get_version))
}

#[derive(Serialize, ToSchema)]
struct Health {
    /// `ok`.
    status: &'static str,
}

#[derive(Serialize, ToSchema)]
struct Version {
    name: &'static str,
    /// With the revision it was built from, where that is known: `0.1.0+46dc801a2b3c`.
    version: &'static str,
    /// Optional features it was built with.
    features: Vec<&'static str>,
}

/// Is the process alive?
///
/// Always 200 while it answers at all.
#[utoipa::path(get, path = "/healthz", operation_id = "getHealth", tag = "system",
    responses((status = 200, description = "It is.", body = Health)))]
async fn get_health(_: NoParams) -> Json<Health> {
    Json(Health { status: "ok" })
}

/// Does the service take work?
///
/// Refused with `shutting_down` while it stops, with `unavailable` while the database does not answer, and with `disk` while the data
/// directory is gone, cannot be written, or has too little room.
#[utoipa::path(get, path = "/readyz", operation_id = "getReadiness", tag = "system",
    responses((status = 200, description = "It does.", body = Health)))]
async fn get_readiness(State(app): State<AppState>, _: NoParams) -> ApiResult<Json<Health>> {
    if app.jobs.is_shutting_down() {
        return Err(ApiError::busy(
            "shutting_down",
            "the service is shutting down",
        ));
    }
    app.jobs.check().await?;
    app.jobs
        .check_room(0)
        .map_err(|reason| ApiError::new("disk", reason.to_string()))?;
    Ok(Json(Health { status: "ok" }))
}

/// Numbers for monitoring
///
/// In the text format of Prometheus, each with its words: requests by route, jobs by state, live sessions, the disk.
#[utoipa::path(get, path = "/metrics", operation_id = "getMetrics", tag = "system",
    responses((status = 200, description = "The numbers.", content_type = "text/plain", body = String)))]
async fn get_metrics(State(app): State<AppState>, _: NoParams) -> ApiResult {
    let counts = app.jobs.counts().await?;
    for state in JobState::ALL {
        let count = counts.get(&state).copied().unwrap_or(0);
        metrics::gauge!(monitoring::JOBS, "state" => state.name()).set(count as f64);
    }
    app.sessions.count();
    if let Some(bytes) = app.jobs.disk_free_bytes() {
        metrics::gauge!(monitoring::DISK_FREE).set(bytes as f64);
    }
    app.metrics.run_upkeep();
    Ok((
        [(
            header::CONTENT_TYPE,
            "text/plain; version=0.0.4; charset=utf-8",
        )],
        app.metrics.render(),
    )
        .into_response())
}

/// How much is kept?
///
/// Bytes of files and tables, jobs that may go and jobs that stay, and the limits of both.
#[utoipa::path(get, path = "/v1/usage", operation_id = "getUsage", tag = "system",
    responses((status = 200, description = "What is kept.", body = Usage)))]
async fn get_usage(State(app): State<AppState>, _: NoParams) -> ApiResult {
    Ok(Json(app.jobs.usage().await?).into_response())
}

/// Which program is this?
///
/// Its name, version, and optional features; reports name the version too.
#[utoipa::path(get, path = "/v1/version", operation_id = "getVersion", tag = "system",
    responses((status = 200, description = "Name and version.", body = Version)))]
async fn get_version(_: NoParams) -> Json<Version> {
    Json(Version {
        name: env!("CARGO_PKG_NAME"),
        version: build_info::VERSION,
        features: build_info::features(),
    })
}

/// The API documents.
pub fn documents() -> Router<AppState> {
    Router::new()
        .route("/openapi.json", get(document))
        .route("/openapi-3.0.json", get(document_3_0))
}

async fn document(State(app): State<AppState>, headers: HeaderMap) -> Response {
    app.documents.v3_1.answer(&headers)
}

async fn document_3_0(State(app): State<AppState>, headers: HeaderMap) -> Response {
    app.documents.v3_0.answer(&headers)
}

/// The document made readable; its scripts are part of the program.
pub fn docs_page() -> Router {
    SwaggerUi::new("/docs")
        .config(utoipa_swagger_ui::Config::from("/openapi.json"))
        .into()
}

/// A path that is no route belongs to the dashboard, or to nobody.
pub async fn dashboard_or_nothing(request: Request) -> ApiResult {
    let path = request.uri().path();
    let nothing = || ApiError::new("not_found", format!("there is nothing at {path}"));
    if !matches!(*request.method(), Method::GET | Method::HEAD) {
        return Err(nothing());
    }
    dashboard::answer(path, request.headers()).ok_or_else(nothing)
}
