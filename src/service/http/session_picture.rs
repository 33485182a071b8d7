//! The picture of a live session, for pages that draw it.

use super::extract::Id;
use super::headers::{MAX_EVENT, MAX_WAIT_S, patience};
use super::query::Params;
use super::state::AppState;
use crate::service::http::error::ApiResult;
use crate::service::types::SessionPicture;
use axum::Json;
use axum::extract::State;
use axum::response::IntoResponse;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

pub fn routes() -> OpenApiRouter<AppState> {
    OpenApiRouter::new().routes(routes!(get_session_picture))
}

/// Get the picture of a session
///
/// The living tracks, and the scans that the tracker took after the number `after_scan`, with their detections as places in the
/// plane, of bearings as directions from the sensor. The latest 64 scans and 20 000 detections are kept since the service started.
/// Without `after_scan` the ways of the tracks, at most their latest 64 points, come too. With `wait` and no newer scan yet, the
/// answer waits that many seconds for news. Ask again with the `last_scan` of the answer: whoever draws slowly gets fewer pictures,
/// and holds up nothing.
#[utoipa::path(get, path = "/v1/sessions/{id}/picture", operation_id = "getSessionPicture", tag = "sessions",
    params(
        ("id" = uuid::Uuid, Path, description = "Identity of the session."),
        ("after_scan" = Option<u64>, Query, minimum = 0, maximum = 9_223_372_036_854_775_807_i64, description = "Only scans after this number."),
        ("wait" = Option<u32>, Query, minimum = 0, maximum = 30, description = "Seconds to wait for news."),
    ),
    responses((status = 200, description = "The picture.", body = SessionPicture)))]
async fn get_session_picture(
    State(app): State<AppState>,
    Id(id): Id,
    mut params: Params,
) -> ApiResult {
    let after_scan = params.whole_number("after_scan", 0..=MAX_EVENT);
    let wait_s = params.whole_number("wait", 0..=MAX_WAIT_S);
    params.finish()?;
    let picture = app.sessions.picture(id, after_scan, patience(wait_s));
    Ok(Json(picture.await?).into_response())
}
