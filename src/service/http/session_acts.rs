//! What people do to a live session by hand.

use super::body::JsonBody;
use super::conditional::created;
use super::extract::{Id, IdAndName};
use super::query::NoParams;
use super::state::AppState;
use crate::service::http::error::ApiResult;
use crate::service::types::{LiveTrack, SessionInfo};
use axum::Json;
use axum::extract::State;
use axum::http::StatusCode;
use axum::response::IntoResponse;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

pub fn routes() -> OpenApiRouter<AppState> {
    OpenApiRouter::new()
        .routes(routes!(begin_session_track))
        .routes(routes!(end_session_track))
        .routes(routes!(pause_session))
        .routes(routes!(resume_session))
}

/// Begin a track of a session
///
/// By hand: a confirmed track at the time of the last scan. Late scans are not put before it. The job on the recording does not know
/// of it.
#[utoipa::path(post, path = "/v1/sessions/{id}/tracks", operation_id = "beginSessionTrack", tag = "sessions",
    params(("id" = uuid::Uuid, Path, description = "Identity of the session.")),
    responses((status = 201, description = "The track.", body = LiveTrack)))]
async fn begin_session_track(
    State(app): State<AppState>,
    Id(id): Id,
    _: NoParams,
    JsonBody(body): JsonBody,
) -> ApiResult {
    let track = app.sessions.begin_track(id, &body).await?;
    let location = format!("/v1/sessions/{id}/tracks/{}", track.track_id);
    Ok(created(StatusCode::CREATED, &location, track))
}

/// End a track of a session
///
/// By hand: no more of it is told. The job on the recording does not know of it.
#[utoipa::path(delete, path = "/v1/sessions/{id}/tracks/{name}", operation_id = "endSessionTrack", tag = "sessions",
    params(
        ("id" = uuid::Uuid, Path, description = "Identity of the session."),
        ("name" = String, Path, description = "The track."),
    ),
    responses((status = 204, description = "It has ended.")))]
async fn end_session_track(
    State(app): State<AppState>,
    IdAndName(id, name): IdAndName,
    _: NoParams,
) -> ApiResult {
    app.sessions.end_track(id, &name).await?;
    Ok(StatusCode::NO_CONTENT.into_response())
}

/// Pause a session
///
/// It takes no scans until it is resumed; its tracks stay as they are.
#[utoipa::path(post, path = "/v1/sessions/{id}/pause", operation_id = "pauseSession", tag = "sessions",
    params(("id" = uuid::Uuid, Path, description = "Identity of the session.")),
    responses((status = 200, description = "The session, paused.", body = SessionInfo)))]
async fn pause_session(State(app): State<AppState>, Id(id): Id, _: NoParams) -> ApiResult {
    Ok(Json(app.sessions.pause(id, true).await?).into_response())
}

/// Resume a session
///
/// It takes scans again.
#[utoipa::path(post, path = "/v1/sessions/{id}/resume", operation_id = "resumeSession", tag = "sessions",
    params(("id" = uuid::Uuid, Path, description = "Identity of the session.")),
    responses((status = 200, description = "The session.", body = SessionInfo)))]
async fn resume_session(State(app): State<AppState>, Id(id): Id, _: NoParams) -> ApiResult {
    Ok(Json(app.sessions.pause(id, false).await?).into_response())
}
