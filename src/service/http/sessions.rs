//! Live sessions: made, fed, asked, closed.

use super::body::{JSON_LIMIT_BYTES, JsonBody, media_type, parse_json, read_limited};
use super::conditional::created;
use super::datasets::{paging, with_next};
use super::extract::{Id, IdAndName};
use super::headers::{MAX_EVENT, MAX_WAIT_S, last_event_id, patience};
use super::query::{NoParams, Params};
use super::state::AppState;
use super::streams::{self, OpenStream};
use crate::service::connections::Ends;
use crate::service::http::error::{ApiError, ApiResult};
use crate::service::types::{
    DatasetInfo, LiveTracks, Pushed, SessionEvent, SessionEvents, SessionInfo, SessionPage,
    TrackHistory,
};
use axum::extract::{DefaultBodyLimit, Request, State};
use axum::http::{HeaderMap, StatusCode};
use axum::response::{IntoResponse, sse};
use axum::{Extension, Json};
use serde_json::Value;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// Largest push: a batch of scans.
const PUSH_LIMIT_BYTES: u64 = 8 * JSON_LIMIT_BYTES;
/// Scans of a batch.
const BATCH: usize = 1000;

pub fn routes() -> OpenApiRouter<AppState> {
    OpenApiRouter::new()
        .routes(routes!(push_scans))
        .layer(DefaultBodyLimit::disable())
        .routes(routes!(create_session, list_sessions))
        .routes(routes!(get_session, delete_session))
        .routes(routes!(list_session_tracks))
        .routes(routes!(get_session_track))
        .routes(routes!(stream_session_events))
        .routes(routes!(get_session_history))
        .routes(routes!(record_session))
        .routes(routes!(close_session))
}

/// Begin a live session
///
/// A tracker that is fed scan by scan and tells its tracks at once. Settings are those of a job that tracks; what such a job takes
/// from its data is to be given.
#[utoipa::path(post, path = "/v1/sessions", operation_id = "createSession", tag = "sessions",
    responses((status = 201, description = "The session, open.", body = SessionInfo)))]
async fn create_session(
    State(app): State<AppState>,
    _: NoParams,
    JsonBody(body): JsonBody,
) -> ApiResult {
    let session = app.sessions.create(&body).await?;
    let location = format!("/v1/sessions/{}", session.id);
    Ok(created(StatusCode::CREATED, &location, session))
}

/// List sessions
///
/// Newest first; of those that the process which answers has in memory with how they stand.
#[utoipa::path(get, path = "/v1/sessions", operation_id = "listSessions", tag = "sessions",
    params(
        ("sort" = Option<String>, Query, min_length = 1, description = "`-created_at` (newest first) or `created_at`."),
        ("limit" = Option<u32>, Query, minimum = 1, maximum = 200, description = "Sessions of a page; 50 when absent."),
        ("cursor" = Option<String>, Query, min_length = 1, description = "Where the page before ended."),
        ("count" = Option<bool>, Query, description = "Count every match in `total`."),
    ),
    responses((status = 200, description = "One page.", body = SessionPage)))]
async fn list_sessions(State(app): State<AppState>, mut params: Params) -> ApiResult {
    let paging = paging(&mut params);
    let next = params.next_page();
    params.finish()?;
    let page = app.sessions.list(&paging).await?;
    Ok(with_next("/v1/sessions", &next, &page, &page.next_cursor))
}

/// Get a session
///
/// How it stands: what it took, how far it is, how many tracks live.
#[utoipa::path(get, path = "/v1/sessions/{id}", operation_id = "getSession", tag = "sessions",
    params(("id" = uuid::Uuid, Path, description = "Identity of the session.")),
    responses((status = 200, description = "The session.", body = SessionInfo)))]
async fn get_session(State(app): State<AppState>, Id(id): Id, _: NoParams) -> ApiResult {
    Ok(Json(app.sessions.get(id).await?).into_response())
}

/// Delete a session
///
/// With its log. The dataset and the job that were made of it stay.
#[utoipa::path(delete, path = "/v1/sessions/{id}", operation_id = "deleteSession", tag = "sessions",
    params(("id" = uuid::Uuid, Path, description = "Identity of the session.")),
    responses((status = 204, description = "It is deleted.")))]
async fn delete_session(State(app): State<AppState>, Id(id): Id, _: NoParams) -> ApiResult {
    app.sessions.delete(id).await?;
    Ok(StatusCode::NO_CONTENT.into_response())
}

/// Push scans
///
/// One scan as JSON, or up to 1000 as NDJSON (application/x-ndjson), one a line. What is answered is on the disk. A scan that came
/// before, by its sensor and sequence, is taken once; a scan that is too late is told as dropped. Of a batch with a fault nothing
/// is taken.
#[utoipa::path(post, path = "/v1/sessions/{id}/scans", operation_id = "pushScans", tag = "sessions",
    params(("id" = uuid::Uuid, Path, description = "Identity of the session.")),
    responses((status = 200, description = "What became of them.", body = Pushed)))]
async fn push_scans(
    State(app): State<AppState>,
    Id(id): Id,
    _: NoParams,
    request: Request,
) -> ApiResult {
    let (parts, body) = request.into_parts();
    let media_type = media_type(&parts.headers);
    let is_batch = media_type == "application/x-ndjson";
    if !is_batch && media_type != "application/json" {
        let detail = format!(
            "the body must be application/json or application/x-ndjson, not '{media_type}'"
        );
        return Err(ApiError::new("unsupported_media_type", detail));
    }
    let bytes = read_limited(&parts.headers, body, PUSH_LIMIT_BYTES).await?;
    let scans = if is_batch {
        lines_of(&bytes)?
    } else {
        vec![(None, parse_json(&bytes, "")?)]
    };
    Ok(Json(app.sessions.push(id, &scans, bytes.len()).await?).into_response())
}

/// The scans of a batch with their lines; empty lines are passed over.
fn lines_of(bytes: &[u8]) -> Result<Vec<(Option<u64>, Value)>, ApiError> {
    let mut scans = Vec::new();
    for (line, text) in (1..).zip(bytes.split(|&byte| byte == b'\n')) {
        if text.iter().all(u8::is_ascii_whitespace) {
            continue;
        }
        scans.push((Some(line), parse_json(text, "")?));
        if scans.len() > BATCH {
            let detail = format!("more than {BATCH} scans in one batch");
            return Err(ApiError::new("payload_too_large", detail));
        }
    }
    Ok(scans)
}

/// List the tracks of a session
///
/// As they are believed to be at the last scan; with `at_s` predicted to a time ahead.
#[utoipa::path(get, path = "/v1/sessions/{id}/tracks", operation_id = "listSessionTracks", tag = "sessions",
    params(
        ("id" = uuid::Uuid, Path, description = "Identity of the session."),
        ("at_s" = Option<f64>, Query, description = "The time to predict to."),
    ),
    responses((status = 200, description = "The living tracks.", body = LiveTracks)))]
async fn list_session_tracks(
    State(app): State<AppState>,
    Id(id): Id,
    mut params: Params,
) -> ApiResult {
    let finite = |text: &str| text.parse().ok().filter(|value: &f64| value.is_finite());
    let at_s = params.read("at_s", "a number of seconds", finite);
    params.finish()?;
    Ok(Json(app.sessions.tracks(id, at_s).await?).into_response())
}

/// Get a track of a session
///
/// A living track with its latest points, at most 256 and only those since the service started.
#[utoipa::path(get, path = "/v1/sessions/{id}/tracks/{name}", operation_id = "getSessionTrack", tag = "sessions",
    params(
        ("id" = uuid::Uuid, Path, description = "Identity of the session."),
        ("name" = String, Path, description = "The track."),
    ),
    responses((status = 200, description = "The track.", body = TrackHistory)))]
async fn get_session_track(
    State(app): State<AppState>,
    IdAndName(id, name): IdAndName,
    _: NoParams,
) -> ApiResult {
    Ok(Json(app.sessions.history(id, &name).await?).into_response())
}

/// Follow a session
///
/// Server-sent events: `id` counts the events of the session from 1, `event` is their kind, `data` is the event as in the history.
/// `Last-Event-ID` resumes without a gap; a reader who is so slow that events are no longer kept is cut off, and told `gone` when
/// it comes again.
#[utoipa::path(get, path = "/v1/sessions/{id}/events", operation_id = "streamSessionEvents", tag = "sessions",
    params(
        ("id" = uuid::Uuid, Path, description = "Identity of the session."),
        ("after" = Option<u64>, Query, minimum = 0, maximum = 9_223_372_036_854_775_807_i64, description = "Only events after this number."),
        ("Last-Event-ID" = Option<String>, Header, description = "The last event that was seen; goes before `after`."),
    ),
    responses((status = 200, description = "The events.", content_type = "text/event-stream", body = SessionEvent)))]
async fn stream_session_events(
    State(app): State<AppState>,
    ends: Extension<Ends>,
    Id(id): Id,
    mut params: Params,
    headers: HeaderMap,
) -> ApiResult {
    let asked = params.whole_number("after", 0..=MAX_EVENT);
    params.finish()?;
    let after = last_event_id(&headers)?.or(asked).unwrap_or(0);
    let open: OpenStream = app.streams.open(ends.client.ip())?;
    let events = app.sessions.follow(id, after).await?;
    Ok(streams::response(open, events, encode))
}

fn encode(event: SessionEvent) -> sse::Event {
    let kind = serde_json::to_value(event.kind).unwrap_or_default();
    sse::Event::default()
        .id(event.id.to_string())
        .event(kind.as_str().unwrap_or("event"))
        .data(serde_json::to_string(&event).unwrap_or_default())
}

/// Get the events of a session
///
/// The same events as JSON, at most 500. With `wait` and nothing new yet, the answer waits that many seconds for the next event.
#[utoipa::path(get, path = "/v1/sessions/{id}/history", operation_id = "getSessionHistory", tag = "sessions",
    params(
        ("id" = uuid::Uuid, Path, description = "Identity of the session."),
        ("after" = Option<u64>, Query, minimum = 0, maximum = 9_223_372_036_854_775_807_i64, description = "Only events after this number."),
        ("wait" = Option<u32>, Query, minimum = 0, maximum = 30, description = "Seconds to wait for an event."),
    ),
    responses((status = 200, description = "The events.", body = SessionEvents)))]
async fn get_session_history(
    State(app): State<AppState>,
    Id(id): Id,
    mut params: Params,
) -> ApiResult {
    let after = params.whole_number("after", 0..=MAX_EVENT).unwrap_or(0);
    let wait_s = params.whole_number("wait", 0..=MAX_WAIT_S);
    params.finish()?;
    Ok(Json(app.sessions.events(id, after, patience(wait_s)).await?).into_response())
}

/// Record a session
///
/// Makes a dataset of the scans so far, which every job reads: an open session is evaluated up to now. The same scans give the
/// dataset that exists already.
#[utoipa::path(post, path = "/v1/sessions/{id}/recording", operation_id = "recordSession", tag = "sessions",
    params(("id" = uuid::Uuid, Path, description = "Identity of the session.")),
    responses(
        (status = 200, description = "The dataset that exists already.", body = DatasetInfo),
        (status = 201, description = "The dataset.", body = DatasetInfo),
    ))]
async fn record_session(State(app): State<AppState>, Id(id): Id, _: NoParams) -> ApiResult {
    let (dataset, is_new) = app.sessions.record(id).await?;
    let status = if is_new {
        StatusCode::CREATED
    } else {
        StatusCode::OK
    };
    let location = dataset.links.self_path.clone();
    Ok(created(status, &location, dataset))
}

/// Close a session
///
/// It takes no more. Its scans become a dataset, and a job tracks them with the settings of the session: its tracks are those of the
/// session, named from 1 in the order in which they began, unless tracks were ended by hand.
#[utoipa::path(post, path = "/v1/sessions/{id}/close", operation_id = "closeSession", tag = "sessions",
    params(("id" = uuid::Uuid, Path, description = "Identity of the session.")),
    responses((status = 200, description = "The session, closed.", body = SessionInfo)))]
async fn close_session(State(app): State<AppState>, Id(id): Id, _: NoParams) -> ApiResult {
    Ok(Json(app.jobs.close_session(id).await?).into_response())
}
