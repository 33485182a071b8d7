//! Pages of other sites that may use the service from a browser (CORS, <https://fetch.spec.whatwg.org/#http-cors-protocol>), by list. They send a
//! key of their own: cookies of this service are not for them.

use super::hosts::Hosts;
use axum::extract::{Request, State};
use axum::http::{HeaderValue, Method, StatusCode, header};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};

const METHODS: HeaderValue = HeaderValue::from_static("GET, HEAD, POST, PATCH, DELETE");
const HEADERS: HeaderValue = HeaderValue::from_static(
    "accept, authorization, content-type, idempotency-key, if-none-match, last-event-id, prefer, range",
);
const EXPOSED: HeaderValue = HeaderValue::from_static(
    "content-disposition, etag, location, preference-applied, retry-after, x-request-id",
);
/// For how long a browser need not ask again (s).
const MAX_AGE: HeaderValue = HeaderValue::from_static("600");

/// Answers what browsers ask before they send, and tells them which pages may read an answer.
pub async fn share(State(hosts): State<Hosts>, request: Request, next: Next) -> Response {
    if !hosts.has_origins() {
        return next.run(request).await;
    }
    let origin = request.headers().get(header::ORIGIN).cloned();
    let origin = origin.filter(|origin| hosts.allows_origin(origin));
    let is_asked_before = *request.method() == Method::OPTIONS
        && request
            .headers()
            .contains_key(header::ACCESS_CONTROL_REQUEST_METHOD);
    let mut response = match &origin {
        Some(_) if is_asked_before => answer_before(),
        _ => next.run(request).await,
    };
    let headers = response.headers_mut();
    headers.append(header::VARY, HeaderValue::from_static("origin"));
    if let Some(origin) = origin {
        headers.insert(header::ACCESS_CONTROL_ALLOW_ORIGIN, origin);
        headers.insert(header::ACCESS_CONTROL_EXPOSE_HEADERS, EXPOSED);
    }
    response
}

fn answer_before() -> Response {
    let headers = [
        (header::ACCESS_CONTROL_ALLOW_METHODS, METHODS),
        (header::ACCESS_CONTROL_ALLOW_HEADERS, HEADERS),
        (header::ACCESS_CONTROL_MAX_AGE, MAX_AGE),
    ];
    (StatusCode::NO_CONTENT, headers).into_response()
}
