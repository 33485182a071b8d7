//! Keys: making, listing and revoking them, and a page's way in and out.

use super::body::JsonBody;
use super::conditional::created;
use super::door::{COOKIE, refusal_of};
use super::extract::Id;
use super::query::NoParams;
use super::state::AppState;
use crate::registry::{self, Kind, Object, required};
use crate::service::http::error::{ApiError, ApiResult};
use crate::service::keys::{Holder, Refusal};
use crate::service::types::{Access, KeyList, MadeKey};
use axum::extract::{Request, State};
use axum::http::{HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};
use axum::{Extension, Json};
use jiff::Timestamp;
use serde::Deserialize;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

pub fn routes() -> OpenApiRouter<AppState> {
    OpenApiRouter::new()
        .routes(routes!(create_key))
        .routes(routes!(list_keys))
        .routes(routes!(revoke_key))
        .routes(routes!(get_access))
        .routes(routes!(login))
        .routes(routes!(logout))
}

pub static LOGIN: Object = Object {
    name: "LoginRequest",
    summary: "Keep a key in a cookie.",
    fields: &[required(
        "key",
        "A key, or the master key.",
        Kind::Text { max_length: 1000 },
    )],
};

#[derive(Deserialize)]
struct Login {
    key: String,
}

/// Make a key
///
/// For a program or a person. It is told in this answer and never again. What it may allow is what the key allows that makes it, and it
/// ends no later.
#[utoipa::path(post, path = "/v1/keys", operation_id = "createKey", tag = "keys",
    responses((status = 201, description = "The key.", body = MadeKey)))]
async fn create_key(
    State(app): State<AppState>,
    Extension(holder): Extension<Holder>,
    _: NoParams,
    JsonBody(body): JsonBody,
) -> ApiResult {
    let made = app.keys.add(&body, &holder).await?;
    Ok(created(StatusCode::CREATED, "/v1/keys", made))
}

/// List keys
///
/// Newest first, at most 1000; those that are revoked are not among them.
#[utoipa::path(get, path = "/v1/keys", operation_id = "listKeys", tag = "keys",
    responses((status = 200, description = "The keys.", body = KeyList)))]
async fn list_keys(State(app): State<AppState>, _: NoParams) -> ApiResult {
    Ok(Json(app.keys.list().await?).into_response())
}

/// Revoke a key
///
/// From the next request on it opens nothing.
#[utoipa::path(delete, path = "/v1/keys/{id}", operation_id = "revokeKey", tag = "keys",
    params(("id" = uuid::Uuid, Path, description = "Identity of the key.")),
    responses((status = 204, description = "It is revoked.")))]
async fn revoke_key(State(app): State<AppState>, Id(id): Id, _: NoParams) -> ApiResult {
    app.keys.revoke(id).await?;
    Ok(StatusCode::NO_CONTENT.into_response())
}

/// Who asks?
///
/// Whether the service asks for keys, and what the key of the request allows. Answers everybody.
#[utoipa::path(get, path = "/v1/access", operation_id = "getAccess", tag = "keys",
    responses((status = 200, description = "What is allowed.", body = Access)))]
async fn get_access(State(app): State<AppState>, _: NoParams, request: Request) -> ApiResult {
    let holder = request.extensions().get::<Holder>();
    let actions = holder.map_or(&[][..], |holder| &holder.actions);
    Ok(Json(Access {
        is_needed: app.keys.are_needed(),
        is_given: holder.is_some(),
        actions: actions
            .iter()
            .map(|action| action.name().to_owned())
            .collect(),
        key_id: holder.and_then(|holder| holder.id),
        name: holder.and_then(|holder| holder.name.clone()),
        expires_at: holder.and_then(|holder| holder.expires_at),
    })
    .into_response())
}

/// Sign in
///
/// A page gives its key and keeps it in a cookie that no script reads and no other site sends.
#[utoipa::path(post, path = "/v1/login", operation_id = "login", tag = "keys",
    responses((status = 204, description = "The cookie is set.")))]
async fn login(State(app): State<AppState>, _: NoParams, JsonBody(body): JsonBody) -> ApiResult {
    let checked = registry::check(&body, &LOGIN).map_err(ApiError::validation)?;
    let Login { key } = Login::deserialize(&checked).map_err(ApiError::internal)?;
    let key = key.trim();
    let holder = app.keys.holder(Some(key)).await;
    let holder = holder.map_err(|refusal| refusal_of(refusal, true))?;
    let value = if app.keys.are_needed() { key } else { "" };
    let left_s = holder.expires_at.map(left_s);
    set_cookie(value, left_s, app.has_tls)
}

/// Sign out
///
/// The cookie is taken away.
#[utoipa::path(post, path = "/v1/logout", operation_id = "logout", tag = "keys",
    responses((status = 204, description = "It is gone.")))]
async fn logout(State(app): State<AppState>, _: NoParams) -> ApiResult {
    set_cookie("", Some(0), app.has_tls)
}

fn left_s(end: Timestamp) -> i64 {
    end.duration_since(Timestamp::now()).as_secs().max(0)
}

/// Without an age it goes with the browser.
fn set_cookie(value: &str, age_s: Option<i64>, is_secure: bool) -> ApiResult {
    let mut text = format!("{COOKIE}={value}; Path=/; HttpOnly; SameSite=Strict");
    if let Some(age_s) = age_s {
        text.push_str(&format!("; Max-Age={age_s}"));
    }
    if is_secure {
        text.push_str("; Secure");
    }
    // What no header can carry is no key.
    let value = HeaderValue::from_str(&text).map_err(|_| refusal_of(Refusal::Unknown, true))?;
    let mut response: Response = StatusCode::NO_CONTENT.into_response();
    response.headers_mut().insert(header::SET_COOKIE, value);
    Ok(response)
}
