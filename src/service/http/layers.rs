//! What every answer goes through: a request id, problem bodies, content negotiation, security headers, numbers.

use super::hosts::{Hosts, guard};
use super::origins::share;
use crate::service::http::error::{ApiError, problem_of_status};
use crate::service::monitoring;
use crate::service::types::Problem;
use axum::Router;
use axum::extract::{MatchedPath, Request};
use axum::http::{
    Extensions, HeaderMap, HeaderName, HeaderValue, Method, StatusCode, Version, header,
};
use axum::middleware::{Next, from_fn, from_fn_with_state};
use axum::response::{IntoResponse, Response};
use std::any::Any;
use std::time::Instant;
use tower_http::CompressionLevel;
use tower_http::catch_panic::CatchPanicLayer;
use tower_http::compression::CompressionLayer;
use tower_http::request_id::{
    MakeRequestId, PropagateRequestIdLayer, RequestId, SetRequestIdLayer,
};
use tower_http::trace::{DefaultOnResponse, TraceLayer};
use tracing::Level;
use uuid::Uuid;

const REQUEST_ID: HeaderName = HeaderName::from_static("x-request-id");
const PROBLEM_JSON: &str = "application/problem+json";

const SECURITY: [(HeaderName, HeaderValue); 3] = [
    (
        header::CONTENT_SECURITY_POLICY,
        HeaderValue::from_static(
            "default-src 'self'; img-src 'self' data: blob:; style-src 'self' 'unsafe-inline'; frame-ancestors 'none'",
        ),
    ),
    (
        header::X_CONTENT_TYPE_OPTIONS,
        HeaderValue::from_static("nosniff"),
    ),
    (
        header::REFERRER_POLICY,
        HeaderValue::from_static("no-referrer"),
    ),
];

/// Puts the layers around routes; the last one named sees a request first.
pub fn wrap(routes: Router, hosts: Hosts) -> Router {
    routes
        .layer(CatchPanicLayer::custom(answer_panic))
        .layer(from_fn_with_state(hosts.clone(), share))
        .layer(from_fn_with_state(hosts, guard))
        .layer(from_fn(measure))
        // The dashboard's scripts and styles are fetched once and kept.
        .layer(CompressionLayer::new().compress_when(is_script_or_style))
        // Level 1: answers of megabytes would wait longer for a better one than they save on the way.
        .layer(CompressionLayer::new().quality(CompressionLevel::Fastest))
        .layer(from_fn(finish))
        .layer(PropagateRequestIdLayer::new(REQUEST_ID))
        .layer(
            TraceLayer::new_for_http()
                .make_span_with(span)
                .on_response(DefaultOnResponse::new().level(Level::DEBUG)),
        )
        .layer(SetRequestIdLayer::new(REQUEST_ID, NewRequestId))
}

fn is_script_or_style(_: StatusCode, _: Version, headers: &HeaderMap, _: &Extensions) -> bool {
    let media_type = headers
        .get(header::CONTENT_TYPE)
        .and_then(|value| value.to_str().ok())
        .unwrap_or_default();
    media_type.starts_with("text/javascript") || media_type.starts_with("text/css")
}

#[derive(Clone, Copy)]
struct NewRequestId;

impl MakeRequestId for NewRequestId {
    fn make_request_id<B>(&mut self, _: &axum::http::Request<B>) -> Option<RequestId> {
        HeaderValue::from_str(&Uuid::now_v7().to_string())
            .ok()
            .map(RequestId::new)
    }
}

fn span(request: &Request) -> tracing::Span {
    tracing::info_span!("request", method = %request.method(), path = request.uri().path(), id = text(request.headers(), &REQUEST_ID), key = tracing::field::Empty)
}

fn answer_panic(panic: Box<dyn Any + Send + 'static>) -> Response {
    let message = panic
        .downcast_ref::<&str>()
        .map(ToString::to_string)
        .or_else(|| panic.downcast_ref::<String>().cloned());
    ApiError::internal(format!("panic: {}", message.unwrap_or_default())).into_response()
}

/// Counts and times requests by the route they matched, never by the path itself.
async fn measure(request: Request, next: Next) -> Response {
    let route = request
        .extensions()
        .get::<MatchedPath>()
        .map_or("unmatched", MatchedPath::as_str)
        .to_owned();
    let method = known_method(request.method());
    let start = Instant::now();
    let response = next.run(request).await;
    let labels = [
        ("method", method.to_owned()),
        ("route", route),
        ("status", response.status().as_u16().to_string()),
    ];
    metrics::counter!(monitoring::REQUESTS, &labels).increment(1);
    metrics::histogram!(monitoring::REQUEST_SECONDS, &labels).record(start.elapsed().as_secs_f64());
    response
}

/// The name of a method of RFC 9110 or 5789; clients can invent others without end.
fn known_method(method: &Method) -> &'static str {
    const KNOWN: [&str; 9] = [
        "GET", "HEAD", "POST", "PUT", "PATCH", "DELETE", "OPTIONS", "CONNECT", "TRACE",
    ];
    KNOWN
        .into_iter()
        .find(|known| method == *known)
        .unwrap_or("other")
}

/// Refuses what the client cannot read, and writes the body of every refusal.
async fn finish(request: Request, next: Next) -> Response {
    let path = request.uri().path().to_owned();
    let request_id = text(request.headers(), &REQUEST_ID).to_owned();
    let accept = text(request.headers(), &header::ACCEPT).to_owned();
    let is_read = matches!(
        *request.method(),
        Method::GET | Method::HEAD | Method::OPTIONS
    );
    // What changes something is refused before it does; what only reads is compared with what was made.
    let mut response = if !is_read && !accepts(&accept, "application/json") {
        not_acceptable("application/json")
    } else {
        next.run(request).await
    };
    let made = text(response.headers(), &header::CONTENT_TYPE).to_owned();
    // A file is what it is: generated clients ask for JSON wherever a refusal might be JSON.
    let is_file = response.headers().contains_key(header::CONTENT_DISPOSITION);
    if response.status().is_success()
        && !made.is_empty()
        && is_read
        && !is_file
        && !accepts(&accept, &made)
    {
        response = not_acceptable(&made);
    }
    let problem = response.extensions_mut().remove::<Problem>();
    if problem.is_some() || is_bare_error(&response) {
        let problem = problem.unwrap_or_else(|| problem_of_status(response.status(), &path));
        response = with_body(
            response,
            Problem {
                instance: Some(path),
                request_id: Some(request_id),
                ..problem
            },
        );
    }
    for (name, value) in SECURITY {
        // A page for files of its own has a narrower policy.
        response.headers_mut().entry(name).or_insert(value);
    }
    response
}

fn not_acceptable(made: &str) -> Response {
    ApiError::new("not_acceptable", format!("the answer here is {made}")).into_response()
}

/// An error of the framework: none of our handlers makes one without a problem.
fn is_bare_error(response: &Response) -> bool {
    let status = response.status();
    (status.is_client_error() || status.is_server_error())
        && text(response.headers(), &header::CONTENT_TYPE) != PROBLEM_JSON
}

/// The problem as a body, with the headers that belong to the refusal.
fn with_body(refusal: Response, problem: Problem) -> Response {
    let status = StatusCode::from_u16(problem.status).unwrap_or(StatusCode::INTERNAL_SERVER_ERROR);
    let body = serde_json::to_vec(&problem).unwrap_or_default();
    let mut response = (
        status,
        [
            (header::CONTENT_TYPE, PROBLEM_JSON),
            (header::CACHE_CONTROL, "no-store"),
        ],
        body,
    )
        .into_response();
    for name in [
        header::ALLOW,
        header::RETRY_AFTER,
        header::CONTENT_RANGE,
        header::ACCEPT,
        header::ACCEPT_ENCODING,
        header::WWW_AUTHENTICATE,
    ] {
        if let Some(value) = refusal.headers().get(&name) {
            response.headers_mut().insert(name, value.clone());
        }
    }
    response
}

fn text<'a>(headers: &'a HeaderMap, name: &HeaderName) -> &'a str {
    headers
        .get(name)
        .and_then(|value| value.to_str().ok())
        .unwrap_or_default()
}

/// Whether an Accept header admits the media type; an absent one admits everything.
pub fn accepts(accept: &str, made: &str) -> bool {
    let made = made.split(';').next().unwrap_or_default().trim();
    let family = made.split('/').next().unwrap_or_default();
    let admits = |range: &str| {
        let mut parts = range.split(';').map(str::trim);
        let media = parts.next().unwrap_or_default().to_ascii_lowercase();
        let refused = parts.any(|parameter| {
            parameter
                .strip_prefix("q=")
                .and_then(|q| q.parse::<f32>().ok())
                == Some(0.0)
        });
        !refused && (media == "*/*" || media == made || media.strip_suffix("/*") == Some(family))
    };
    accept.trim().is_empty() || accept.split(',').any(admits)
}

#[cfg(test)]
mod tests {
    use super::accepts;

    #[test]
    fn an_accept_header_admits_types_families_and_everything() {
        let json = "application/json; charset=utf-8";
        for (accept, expected) in [
            ("", true),
            ("*/*", true),
            ("application/json", true),
            ("text/html, application/*;q=0.5", true),
            ("Application/JSON", true),
            ("text/csv", false),
            ("application/json;q=0", false),
            ("application/problem+json", false),
        ] {
            assert_eq!(accepts(accept, json), expected, "{accept}");
        }
    }
}
