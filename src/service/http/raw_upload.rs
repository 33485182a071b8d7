//! Receiving a file that is the whole body of a request, for clients that know no forms.

use super::body::{broken_off, content_length, drain, media_type, too_large};
use super::query::{Params, names};
use super::upload::{META, Upload, store};
use crate::formats::FORMATS;
use crate::registry::{Kind, check_field, check_into};
use crate::service::datasets::DatasetMeta;
use crate::service::http::error::ApiError;
use axum::body::Body;
use axum::extract::Request;
use axum::http::request::Parts;
use axum::http::{HeaderMap, HeaderValue, header};
use futures::{StreamExt, TryStreamExt};
use serde_json::{Map, Value, json};
use std::collections::BTreeSet;
use std::path::Path;

/// Members of the meta that stand in the query of a raw upload as they are, and those that stand there as JSON.
pub const TEXTS: [&str; 3] = ["name", "kind", "format"];
pub fn json_texts() -> impl Iterator<Item = &'static str> {
    let names = META.fields.iter().map(|field| field.name);
    names.filter(|name| !TEXTS.contains(name))
}
/// Longest name of a file.
pub const MAX_FILE_NAME: usize = 255;
static FILE_NAME: Kind = Kind::Text {
    max_length: MAX_FILE_NAME,
};
const OCTETS: &str = "application/octet-stream";

/// Receives a file that is the whole body. What is known of it besides stands in the query: texts as they are, the other
/// members of the meta as JSON.
///
/// # Errors
/// Another media type, a body over the limit, faults in the query.
pub async fn receive(
    params: Params,
    request: Request,
    directory: &Path,
    limit_bytes: u64,
) -> Result<Upload, ApiError> {
    let (Parts { headers, .. }, body) = request.into_parts();
    let mut stream = body.into_data_stream();
    let received = match check_head(&headers, limit_bytes).and_then(|()| read_query(params)) {
        Ok(meta) => {
            let stored = store(
                &mut stream.by_ref().map_err(|error| broken_off(&error)),
                directory,
                limit_bytes,
            )
            .await;
            stored.map(|(file, temporary)| Upload {
                meta,
                file,
                _temporary: temporary,
            })
        }
        Err(refusal) => Err(refusal),
    };
    if received.is_err() {
        drain(&headers, Body::from_stream(stream)).await;
    }
    received
}

fn read_query(mut params: Params) -> Result<DatasetMeta, ApiError> {
    let mut meta = Map::new();
    for name in TEXTS {
        meta.extend(
            params
                .text(name)
                .map(|text| (name.to_owned(), Value::from(text))),
        );
    }
    for name in json_texts() {
        meta.extend(params.json(name).map(|value| (name.to_owned(), value)));
    }
    let file_name = params.text("file_name").filter(|name| !name.is_empty());
    let mut faults = Vec::new();
    if let Some(name) = &file_name {
        check_field(&json!(name), &FILE_NAME, "/file_name", &mut faults);
    }
    let meta = check_into(&Value::Object(meta), &META, &mut faults);
    params.add_within(faults);
    params.finish()?;
    let meta: DatasetMeta = serde_json::from_value(meta).map_err(ApiError::internal)?;
    Ok(DatasetMeta { file_name, ..meta })
}

/// A form would be kept with its boundaries in it.
fn check_head(headers: &HeaderMap, limit_bytes: u64) -> Result<(), ApiError> {
    let media_type = media_type(headers);
    let is_file = media_type.is_empty()
        || media_type == OCTETS
        || FORMATS.iter().any(|format| format.media_type == media_type);
    if !is_file {
        let allowed = media_types();
        let detail =
            format!("the body must be a file in one of the types {allowed}, not '{media_type}'");
        let accept = HeaderValue::from_str(&allowed).map_err(ApiError::internal)?;
        return Err(
            ApiError::new("unsupported_media_type", detail).with_header(header::ACCEPT, accept)
        );
    }
    if content_length(headers).is_some_and(|length| length > limit_bytes) {
        return Err(too_large(limit_bytes));
    }
    Ok(())
}

/// Every format has its type; the bytes alone are enough.
fn media_types() -> String {
    let types: BTreeSet<&str> = FORMATS
        .iter()
        .map(|format| format.media_type)
        .chain([OCTETS])
        .collect();
    names(types)
}
