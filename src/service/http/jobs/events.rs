//! What happens to a job, live and afterwards.

use super::super::extract::Id;
use super::super::headers::{MAX_EVENT, MAX_WAIT_S, last_event_id, patience};
use super::super::query::Params;
use super::super::state::AppState;
use super::super::streams;
use crate::service::connections::Ends;
use crate::service::http::error::ApiResult;
use crate::service::types::{Event, EventPage};
use axum::extract::State;
use axum::http::HeaderMap;
use axum::response::IntoResponse;
use axum::response::sse;
use axum::{Extension, Json};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

pub fn routes() -> OpenApiRouter<AppState> {
    OpenApiRouter::new()
        .routes(routes!(stream_job_events))
        .routes(routes!(get_job_history))
}

/// Follow a job
///
/// Server-sent events: `id` counts the events of the job from 1, `event` is their type (`state`, `progress`, `log`,
/// `done`), `data` is the event as in the history. The stream ends after `done`; `Last-Event-ID` resumes without a gap.
/// Refused with `too_many_streams` while too many are open.
#[utoipa::path(get, path = "/v1/jobs/{id}/events", operation_id = "streamJobEvents", tag = "jobs",
    params(
        ("id" = uuid::Uuid, Path, description = "Identity of the job."),
        ("after" = Option<u64>, Query, minimum = 0, maximum = 9_223_372_036_854_775_807_i64, description = "Only events after this number."),
        ("Last-Event-ID" = Option<String>, Header, description = "The last event that was seen; goes before `after`."),
    ),
    responses((status = 200, description = "The events.", content_type = "text/event-stream", body = Event)))]
async fn stream_job_events(
    State(app): State<AppState>,
    ends: Extension<Ends>,
    Id(id): Id,
    mut params: Params,
    headers: HeaderMap,
) -> ApiResult {
    let asked = params.whole_number("after", 0..=MAX_EVENT);
    params.finish()?;
    let after = last_event_id(&headers)?.or(asked).unwrap_or(0);
    let open = app.streams.open(ends.client.ip())?;
    let events = app.jobs.events(id, after).await?;
    Ok(streams::response(open, events, encode))
}

fn encode(event: Event) -> sse::Event {
    let data = serde_json::to_string(&event).unwrap_or_default();
    sse::Event::default()
        .id(event.seq().to_string())
        .event(event.type_name())
        .data(data)
}

/// Get the events of a job
///
/// The same events as JSON. With `wait` and nothing new yet, the answer waits that many seconds for the next event.
#[utoipa::path(get, path = "/v1/jobs/{id}/history", operation_id = "getJobHistory", tag = "jobs",
    params(
        ("id" = uuid::Uuid, Path, description = "Identity of the job."),
        ("after" = Option<u64>, Query, minimum = 0, maximum = 9_223_372_036_854_775_807_i64, description = "Only events after this number."),
        ("wait" = Option<u32>, Query, minimum = 0, maximum = 30, description = "Seconds to wait for an event."),
    ),
    responses((status = 200, description = "The events.", body = EventPage)))]
async fn get_job_history(State(app): State<AppState>, Id(id): Id, mut params: Params) -> ApiResult {
    let after = params.whole_number("after", 0..=MAX_EVENT).unwrap_or(0);
    let wait_s = params.whole_number("wait", 0..=MAX_WAIT_S);
    params.finish()?;
    Ok(Json(app.jobs.history(id, after, patience(wait_s)).await?).into_response())
}
