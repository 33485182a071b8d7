//! Entity tags, answers that have not changed, and ranges of files.

use super::query::encoded;
use crate::service::datasets::{StoredFile, WrittenFile};
use crate::service::http::error::{ApiError, ApiResult};
use crate::service::storage::blobs::{Content, sha256_hex};
use axum::Json;
use axum::body::{Body, Bytes};
use axum::http::{HeaderMap, HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};
use serde::Serialize;
use std::io::{ErrorKind, SeekFrom};
use std::path::Path;
use tokio::io::{AsyncReadExt, AsyncSeekExt};
use tokio_util::io::ReaderStream;

/// JSON with a weak tag of its content; 304 where the client has it.
pub fn weakly_tagged(request: &HeaderMap, value: &impl Serialize) -> ApiResult {
    let bytes = serde_json::to_vec(value).map_err(ApiError::internal)?;
    let tag = format!("W/\"{}\"", &sha256_hex(&bytes)[..32]);
    let mut response = if matches(request, &tag) {
        StatusCode::NOT_MODIFIED.into_response()
    } else {
        ([(header::CONTENT_TYPE, "application/json")], bytes).into_response()
    };
    set(&mut response, header::ETAG, &tag);
    set(&mut response, header::CACHE_CONTROL, "private, no-cache");
    Ok(response)
}

/// Bytes that are part of the program, with a strong tag.
pub fn fixed(request: &HeaderMap, media_type: &str, bytes: Bytes, sha256: &str) -> Response {
    let tag = format!("\"{sha256}\"");
    let mut response = if matches(request, &tag) {
        StatusCode::NOT_MODIFIED.into_response()
    } else {
        bytes.into_response()
    };
    set(&mut response, header::CONTENT_TYPE, media_type);
    set(&mut response, header::ETAG, &tag);
    set(&mut response, header::CACHE_CONTROL, "no-cache");
    response
}

/// JSON that stays the same while the program runs: rendered once.
pub struct Constant {
    bytes: Bytes,
    sha256: String,
}

impl Constant {
    pub fn new(value: &impl Serialize) -> Self {
        let bytes = Bytes::from(
            serde_json::to_vec(value).expect("what the program says of itself is JSON"),
        );
        Constant {
            sha256: sha256_hex(&bytes),
            bytes,
        }
    }

    pub fn answer(&self, request: &HeaderMap) -> Response {
        fixed(
            request,
            "application/json",
            self.bytes.clone(),
            &self.sha256,
        )
    }
}

/// A stored file: whole, a range of it, or 304. Its content never changes.
pub async fn stored(request: &HeaderMap, file: StoredFile, as_attachment: bool) -> ApiResult {
    let tag = format!("\"{}\"", file.sha256);
    let mut response = if matches(request, &tag) {
        StatusCode::NOT_MODIFIED.into_response()
    } else {
        send(request, &file, &tag).await?
    };
    set(&mut response, header::ETAG, &tag);
    set(
        &mut response,
        header::CACHE_CONTROL,
        "private, max-age=31536000, immutable",
    );
    if as_attachment {
        set(
            &mut response,
            header::CONTENT_DISPOSITION,
            &disposition(&file.file_name),
        );
    }
    Ok(response)
}

/// A file that was written for this answer: whole, and not kept.
pub async fn written(written: WrittenFile) -> ApiResult {
    let file = tokio::fs::File::from_std(written.file);
    let bytes = file.metadata().await.map_err(ApiError::internal)?.len();
    let mut response = Body::from_stream(ReaderStream::new(file)).into_response();
    set(&mut response, header::CONTENT_TYPE, written.media_type);
    set(&mut response, header::CACHE_CONTROL, "private, no-cache");
    let name = disposition(&written.file_name);
    set(&mut response, header::CONTENT_DISPOSITION, &name);
    response
        .headers_mut()
        .insert(header::CONTENT_LENGTH, bytes.into());
    Ok(response)
}

async fn send(request: &HeaderMap, file: &StoredFile, tag: &str) -> ApiResult {
    let wanted = wanted_range(request, tag, file.bytes)?;
    let (first, length) = wanted.unwrap_or((0, file.bytes));
    let body = match &file.content {
        // The range lies within the file, hence within memory.
        Content::Bytes(bytes) => {
            let first = usize::try_from(first).map_err(ApiError::internal)?;
            let length = usize::try_from(length).map_err(ApiError::internal)?;
            Body::from(Bytes::from_owner(bytes.clone()).slice(first..first + length))
        }
        Content::File(path) => stream(path, first, length).await?,
    };
    let mut response = body.into_response();
    set(&mut response, header::CONTENT_TYPE, &file.media_type);
    set(&mut response, header::ACCEPT_RANGES, "bytes");
    response
        .headers_mut()
        .insert(header::CONTENT_LENGTH, length.into());
    if wanted.is_some() {
        *response.status_mut() = StatusCode::PARTIAL_CONTENT;
        set(
            &mut response,
            header::CONTENT_RANGE,
            &format!("bytes {first}-{}/{}", first + length - 1, file.bytes),
        );
    }
    Ok(response)
}

async fn stream(path: &Path, first: u64, length: u64) -> Result<Body, ApiError> {
    let mut source = tokio::fs::File::open(path)
        .await
        .map_err(|error| match error.kind() {
            ErrorKind::NotFound => ApiError::new("gone", "the file has been deleted"),
            _ => ApiError::internal(error),
        })?;
    source
        .seek(SeekFrom::Start(first))
        .await
        .map_err(ApiError::internal)?;
    Ok(Body::from_stream(ReaderStream::new(source.take(length))))
}

/// First byte and length of the range that is asked for. Several ranges, other units and a stale `If-Range` mean the
/// whole file, as RFC 9110 allows.
fn wanted_range(
    request: &HeaderMap,
    tag: &str,
    bytes: u64,
) -> Result<Option<(u64, u64)>, ApiError> {
    let text = |name| {
        request
            .get(name)
            .and_then(|value: &HeaderValue| value.to_str().ok())
    };
    if text(header::IF_RANGE).is_some_and(|given| given != tag) {
        return Ok(None);
    }
    let Some(spec) = text(header::RANGE).and_then(|range| range.strip_prefix("bytes=")) else {
        return Ok(None);
    };
    let Some((from, to)) = spec.split_once('-').filter(|_| !spec.contains(',')) else {
        return Ok(None);
    };
    let (first, end) = match (from.trim().parse::<u64>(), to.trim().parse::<u64>()) {
        (Ok(first), Ok(last)) if first <= last => (first, last.saturating_add(1).min(bytes)),
        (Ok(first), Err(_)) if to.trim().is_empty() => (first, bytes),
        (Err(_), Ok(last)) if from.trim().is_empty() => (bytes.saturating_sub(last), bytes),
        _ => return Ok(None),
    };
    if first >= end {
        let size =
            HeaderValue::from_str(&format!("bytes */{bytes}")).map_err(ApiError::internal)?;
        return Err(ApiError::new(
            "range_not_satisfiable",
            format!("the file has {bytes} bytes"),
        )
        .with_header(header::CONTENT_RANGE, size));
    }
    Ok(Some((first, end - first)))
}

/// Whether `If-None-Match` names the tag; weak comparison.
fn matches(request: &HeaderMap, tag: &str) -> bool {
    let opaque = |tag: &str| tag.trim().trim_start_matches("W/").to_owned();
    let mut given = request
        .get_all(header::IF_NONE_MATCH)
        .iter()
        .filter_map(|value| value.to_str().ok());
    given.any(|list| {
        list.split(',')
            .any(|entry| entry.trim() == "*" || opaque(entry) == opaque(tag))
    })
}

/// `attachment` with the file's name, in ASCII and in full (RFC 6266).
fn disposition(file_name: &str) -> String {
    let plain: String = file_name
        .chars()
        .map(|c| {
            if c.is_ascii_alphanumeric() || "-_. ".contains(c) {
                c
            } else {
                '_'
            }
        })
        .collect();
    format!(
        "attachment; filename=\"{plain}\"; filename*=UTF-8''{}",
        encoded(file_name)
    )
}

/// Sets a header whose value we wrote; a value that is no header text is left out.
pub fn set(response: &mut Response, name: header::HeaderName, value: &str) {
    if let Ok(value) = HeaderValue::from_str(value) {
        response.headers_mut().insert(name, value);
    }
}

/// 201 or 202 with the place of what was made.
pub fn created(status: StatusCode, location: &str, value: impl Serialize) -> Response {
    let mut response = (status, Json(value)).into_response();
    set(&mut response, header::LOCATION, location);
    response
}

#[cfg(test)]
mod tests {
    use super::*;

    fn range(text: &'static str) -> Result<Option<(u64, u64)>, ApiError> {
        let headers = HeaderMap::from_iter([(header::RANGE, HeaderValue::from_static(text))]);
        wanted_range(&headers, "\"a\"", 100)
    }

    #[test]
    fn ranges_are_read_as_first_byte_and_length() {
        for (text, expected) in [
            ("bytes=0-9", Some((0, 10))),
            ("bytes=90-", Some((90, 10))),
            ("bytes=-7", Some((93, 7))),
            ("bytes=-700", Some((0, 100))),
            ("bytes=50-1000", Some((50, 50))),
            ("bytes=9-0", None),
            ("bytes=0-1,5-6", None),
            ("lines=1-2", None),
        ] {
            assert_eq!(range(text).unwrap(), expected, "{text}");
        }
        assert!(range("bytes=100-").is_err());
        assert!(range("bytes=-0").is_err());
    }

    #[test]
    fn file_names_cannot_leave_their_quotes() {
        assert_eq!(
            disposition("a\"b\r\nü.csv"),
            "attachment; filename=\"a_b___.csv\"; filename*=UTF-8''a%22b%0D%0A%C3%BC.csv"
        );
    }
}
