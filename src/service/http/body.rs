//! Reading bodies within their limits. A body that is too long is refused by its Content-Length where it has one,
//! else where the limit is passed; a bounded rest is read away first, so that clients see the answer and not a reset.

use super::hosts::compressed;
use crate::model::fault::Fault;
use crate::registry::{self, Object, placed};
use crate::service::connections::TooSlow;
use crate::service::http::error::ApiError;
use axum::body::{Body, Bytes};
use axum::extract::{FromRequest, Request};
use axum::http::{HeaderMap, header};
use futures::{Stream, StreamExt};
use serde::de::DeserializeOwned;
use serde_json::Value;
use std::error::Error;
use std::pin::pin;
use std::time::Duration;
use tokio::time::timeout;

/// Largest JSON body.
pub const JSON_LIMIT_BYTES: u64 = 1 << 20;
/// How much of a refused body is read away, and for how long.
const DRAIN_BYTES: u64 = 64 << 20;
const DRAIN_TIME: Duration = Duration::from_secs(2);

/// A body of type application/json.
#[derive(Debug)]
pub struct JsonBody(pub Value);

impl<S: Sync> FromRequest<S> for JsonBody {
    type Rejection = ApiError;

    async fn from_request(request: Request, _: &S) -> Result<Self, ApiError> {
        let (parts, body) = request.into_parts();
        let media_type = media_type(&parts.headers);
        if media_type != "application/json" {
            drain(&parts.headers, body).await;
            let detail = format!("the body must be application/json, not '{media_type}'");
            return Err(ApiError::new("unsupported_media_type", detail).with_header(
                header::ACCEPT,
                header::HeaderValue::from_static("application/json"),
            ));
        }
        let bytes = read_limited(&parts.headers, body, JSON_LIMIT_BYTES).await?;
        parse_json(&bytes, "").map(JsonBody)
    }
}

/// The JSON of a body, or of a part of one at `pointer`.
///
/// # Errors
/// `malformed_json` with line and column; members that are given twice; `unsupported_media_type` of bytes that are compressed.
pub fn parse_json(bytes: &[u8], pointer: &str) -> Result<Value, ApiError> {
    if let Some(name) = compression_of(bytes) {
        return Err(compressed(&format!(
            "the body is compressed ({name}); send it as it is"
        )));
    }
    let malformed =
        |error| ApiError::new("malformed_json", format!("the body is not JSON: {error}"));
    let (value, faults) = registry::parse(bytes).map_err(malformed)?;
    if faults.is_empty() {
        Ok(value)
    } else {
        Err(ApiError::validation(placed(pointer, faults)))
    }
}

/// The name of a compression by the first bytes that it makes.
pub fn compression_of(bytes: &[u8]) -> Option<&'static str> {
    const MAGIC: [(&[u8], &str); 5] = [
        (b"\x1f\x8b", "gzip"),
        (b"\x28\xb5\x2f\xfd", "zstd"),
        (b"\xfd7zXZ\x00", "xz"),
        (b"BZh", "bzip2"),
        (b"PK\x03\x04", "zip"),
    ];
    MAGIC
        .iter()
        .find(|(magic, _)| bytes.starts_with(magic))
        .map(|(_, name)| *name)
}

/// The value checked against its description, as a type.
///
/// # Errors
/// Every fault, with `prefix` before its pointer.
pub fn checked<T: DeserializeOwned>(
    value: &Value,
    object: &'static Object,
    prefix: &str,
) -> Result<T, ApiError> {
    let value = registry::check(value, object)
        .map_err(|faults| ApiError::validation(placed(prefix, faults)))?;
    serde_json::from_value(value).map_err(ApiError::internal)
}

/// The media type of the body, without parameters, in lower case.
pub fn media_type(headers: &HeaderMap) -> String {
    let value = headers
        .get(header::CONTENT_TYPE)
        .and_then(|value| value.to_str().ok())
        .unwrap_or_default();
    value
        .split(';')
        .next()
        .unwrap_or_default()
        .trim()
        .to_ascii_lowercase()
}

pub fn too_large(limit_bytes: u64) -> ApiError {
    ApiError::new(
        "payload_too_large",
        format!("the body is larger than {limit_bytes} bytes"),
    )
}

/// The length that the client announced.
pub fn content_length(headers: &HeaderMap) -> Option<u64> {
    headers
        .get(header::CONTENT_LENGTH)?
        .to_str()
        .ok()?
        .parse()
        .ok()
}

pub async fn read_limited(
    headers: &HeaderMap,
    body: Body,
    limit_bytes: u64,
) -> Result<Bytes, ApiError> {
    if content_length(headers).is_some_and(|length| length > limit_bytes) {
        drain(headers, body).await;
        return Err(too_large(limit_bytes));
    }
    let mut stream = body.into_data_stream();
    let mut bytes = Vec::new();
    while let Some(chunk) = stream.next().await {
        bytes.extend_from_slice(&chunk.map_err(|error| broken_off(&error))?);
        if bytes.len() as u64 > limit_bytes {
            drain(headers, Body::from_stream(stream)).await;
            return Err(too_large(limit_bytes));
        }
    }
    Ok(bytes.into())
}

/// The refusal of a body that ended before its end.
pub fn broken_off(error: &(dyn Error + 'static)) -> ApiError {
    let mut cause = Some(error);
    while let Some(error) = cause {
        if error.is::<TooSlow>() {
            return ApiError::new(
                "request_timeout",
                "the body comes too slowly, so it is not waited for any longer",
            );
        }
        cause = error.source();
    }
    ApiError::validation(vec![Fault::new("", "malformed", "the body broke off")])
}

/// Reads a bounded rest of a refused body. A client that waits for "100 Continue" has not begun to send.
pub async fn drain(headers: &HeaderMap, body: Body) {
    if headers.contains_key(header::EXPECT) {
        return;
    }
    read_away(
        body.into_data_stream()
            .map(|chunk| chunk.map(|bytes| bytes.len()).ok()),
    )
    .await;
}

/// Reads lengths of chunks until there is none, an error, or enough.
pub async fn read_away(lengths: impl Stream<Item = Option<usize>>) {
    let mut lengths = pin!(lengths);
    let read = async {
        let mut drained = 0;
        while let Some(Some(length)) = lengths.next().await {
            drained += length as u64;
            if drained > DRAIN_BYTES {
                break;
            }
        }
    };
    // Running out of patience is as good as the end of the body.
    let _ = timeout(DRAIN_TIME, read).await;
}
