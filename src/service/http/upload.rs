//! Receiving a file: streamed to a temporary file, hashed and counted on the way. Nothing stays of an upload that
//! breaks off, because the temporary file goes with the request.

use super::body::{
    JSON_LIMIT_BYTES, broken_off, checked, compression_of, content_length, drain, media_type,
    parse_json, read_away, too_large,
};
use super::hosts::compressed;
use crate::experiment::catalogue;
use crate::formats::{FORMATS, OPTION_FIELDS};
use crate::model::fault::Fault;
use crate::registry::{
    Field, Kind, Object, control_character_fault, joined, list, optional, text_map,
};
use crate::service::datasets::DatasetMeta;
use crate::service::error::ServiceError;
use crate::service::http::error::ApiError;
use crate::service::storage::blobs::{ReceivedFile, hex};
use axum::body::Bytes;
use axum::extract::multipart::Field as Part;
use axum::extract::{FromRequest, Multipart, Request};
use futures::{Stream, StreamExt, TryStreamExt, stream};
use sha2::{Digest, Sha256};
use std::path::Path;
use tempfile::TempPath;
use tokio::fs::File;
use tokio::io::AsyncWriteExt;

/// What file systems take, too.
const MAX_FILE_NAME_BYTES: usize = 255;
/// So much of the name of an unknown part is repeated.
const MAX_PART_NAME: usize = 100;
/// Enough to tell a compression.
const FIRST_BYTES: usize = 6;

const FORMAT_NAMES: [&str; FORMATS.len()] = {
    let mut names = [""; FORMATS.len()];
    let mut index = 0;
    while index < names.len() {
        names[index] = FORMATS[index].name;
        index += 1;
    }
    names
};

/// The part `meta` of an upload.
pub static META: Object = Object {
    name: "DatasetMeta",
    summary: "What is known of an uploaded file besides its content. Everything may be absent.",
    fields: &META_FIELDS,
};

const META_FIELDS: [Field; 5 + OPTION_FIELDS.len()] = joined(&[&COMMON, &OPTION_FIELDS, &SENSORS]);

const COMMON: [Field; 4] = [
    optional(
        "name",
        "A name for people; the file's name when absent.",
        Kind::Text { max_length: 200 },
    ),
    optional(
        "kind",
        "What the file holds; told from its columns when absent.",
        Kind::Choice(&["detections", "truth", "tracks", "bearing_time"]),
    ),
    optional(
        "format",
        "How the file is written; told from its content when absent.",
        Kind::Choice(&FORMAT_NAMES),
    ),
    optional(
        "columns",
        "The file's column name to the canonical one, where they differ.",
        text_map(64, 100),
    ),
];

const SENSORS: [Field; 1] = [optional(
    "sensors",
    "What is known of the sensors.",
    list(&SENSOR, 1, 64),
)];

static SENSOR: Kind = Kind::Object(catalogue::sensor_settings());

/// A complete upload. The temporary file is removed with it unless the storage has taken it over.
pub struct Upload {
    pub meta: DatasetMeta,
    pub file: ReceivedFile,
    /// Held for its drop.
    pub(super) _temporary: TempPath,
}

/// Receives the parts `meta` (may be absent) and `file`. In this order, faults of `meta` are told before the file is read.
///
/// # Errors
/// Another media type, a body over the limit, faults in `meta`, missing and unknown parts.
pub async fn receive(
    request: Request,
    directory: &Path,
    limit_bytes: u64,
) -> Result<Upload, ApiError> {
    let headers = request.headers().clone();
    if media_type(&headers) != "multipart/form-data" {
        drain(&headers, request.into_body()).await;
        return Err(ApiError::new(
            "unsupported_media_type",
            "the body must be multipart/form-data with the parts 'meta' and 'file'",
        ));
    }
    // The parts around the file are small; what they add is allowed for.
    if content_length(&headers)
        .is_some_and(|length| length > limit_bytes.saturating_add(2 * JSON_LIMIT_BYTES))
    {
        drain(&headers, request.into_body()).await;
        return Err(too_large(limit_bytes));
    }
    let multipart = Multipart::from_request(request, &()).await;
    let mut multipart =
        multipart.map_err(|rejection| part_fault("", "malformed", &rejection.body_text()))?;
    let received = receive_parts(&mut multipart, directory, limit_bytes).await;
    if received.is_err() {
        read_away(rest_of(multipart)).await;
    }
    received
}

async fn receive_parts(
    multipart: &mut Multipart,
    directory: &Path,
    limit_bytes: u64,
) -> Result<Upload, ApiError> {
    let mut meta = None;
    let mut file = None;
    while let Some(part) = multipart
        .next_field()
        .await
        .map_err(|error| broken_off(&error))?
    {
        match part.name().unwrap_or_default() {
            "meta" if meta.is_some() => {
                return Err(part_fault(
                    "/meta",
                    "duplicate",
                    "there are two parts 'meta'",
                ));
            }
            "file" if file.is_some() => {
                return Err(part_fault(
                    "/file",
                    "duplicate",
                    "there are two parts 'file'",
                ));
            }
            "meta" => meta = Some(read_meta(part).await?),
            "file" => file = Some(read_file(part, directory, limit_bytes).await?),
            other => {
                let name: String = other.chars().take(MAX_PART_NAME).collect();
                let fault = Fault::new(
                    format!("/{name}"),
                    "unknown_field",
                    format!("unknown part '{name}'"),
                )
                .allowing("meta, file");
                return Err(ApiError::validation(vec![fault]));
            }
        }
    }
    let Some((file, temporary, file_name)) = file else {
        return Err(part_fault(
            "/file",
            "missing",
            "the part 'file' is required",
        ));
    };
    let meta = DatasetMeta {
        file_name,
        ..meta.unwrap_or_default()
    };
    Ok(Upload {
        meta,
        file,
        _temporary: temporary,
    })
}

/// Lengths of the parts that nobody wants any more.
fn rest_of(multipart: Multipart) -> impl Stream<Item = Option<usize>> {
    stream::unfold(multipart, |mut multipart| async {
        let mut part = multipart.next_field().await.ok()??;
        let mut length = 0;
        while let Ok(Some(chunk)) = part.chunk().await {
            length += chunk.len();
        }
        drop(part);
        Some((Some(length), multipart))
    })
}

async fn read_meta(mut part: Part<'_>) -> Result<DatasetMeta, ApiError> {
    let mut bytes = Vec::new();
    while let Some(chunk) = part.chunk().await.map_err(|error| broken_off(&error))? {
        bytes.extend_from_slice(&chunk);
        if bytes.len() as u64 > JSON_LIMIT_BYTES {
            return Err(too_large(JSON_LIMIT_BYTES));
        }
    }
    checked(&parse_json(&bytes, "/meta")?, &META, "/meta")
}

async fn read_file(
    part: Part<'_>,
    directory: &Path,
    limit_bytes: u64,
) -> Result<(ReceivedFile, TempPath, Option<String>), ApiError> {
    let file_name = file_name(part.file_name().unwrap_or_default())?;
    let mut chunks = part.map_err(|error| broken_off(&error));
    let (file, temporary) = store(&mut chunks, directory, limit_bytes).await?;
    Ok((file, temporary, file_name))
}

/// Writes the chunks of a file to a temporary one.
pub(super) async fn store(
    chunks: &mut (impl Stream<Item = Result<Bytes, ApiError>> + Unpin),
    directory: &Path,
    limit_bytes: u64,
) -> Result<(ReceivedFile, TempPath), ApiError> {
    let (file, path) = tempfile::NamedTempFile::new_in(directory)
        .map_err(ApiError::writing)?
        .into_parts();
    let mut file = File::from_std(file);
    let mut hash = Sha256::new();
    let mut bytes = 0;
    let mut first_bytes = Vec::new();
    while let Some(chunk) = chunks.next().await {
        let chunk = chunk?;
        bytes += chunk.len() as u64;
        if first_bytes.len() < FIRST_BYTES {
            first_bytes.extend(chunk.iter().take(FIRST_BYTES));
            refuse_compressed(&first_bytes)?;
        }
        if bytes > limit_bytes {
            return Err(too_large(limit_bytes));
        }
        hash.update(&chunk);
        file.write_all(&chunk).await.map_err(ApiError::writing)?;
    }
    file.flush().await.map_err(ApiError::writing)?;
    let sha256 = hex(&hash.finalize());
    Ok((
        ReceivedFile {
            path: path.to_path_buf(),
            sha256,
            bytes,
        },
        path,
    ))
}

/// The fault where the request says what it is about: what the checks of the meta and of the file call `/meta` and `/file`.
pub fn repoint(error: ServiceError, meta: &str, file: &str) -> ApiError {
    let ServiceError::Invalid(faults) = error else {
        return error.into();
    };
    let place =
        |pointer: String| match (pointer.strip_prefix("/meta"), pointer.strip_prefix("/file")) {
            (Some(rest), _) => format!("{meta}{rest}"),
            (_, Some(rest)) => format!("{file}{rest}"),
            _ => pointer,
        };
    ApiError::validation(
        faults
            .into_iter()
            .map(|fault| Fault {
                pointer: place(fault.pointer),
                ..fault
            })
            .collect(),
    )
}

/// The name of the file, if it has one.
fn file_name(name: &str) -> Result<Option<String>, ApiError> {
    if name.len() > MAX_FILE_NAME_BYTES {
        let fault = Fault::new(
            "/file",
            "too_large",
            format!("the name of the file has {} bytes", name.len()),
        );
        return Err(ApiError::validation(vec![
            fault.allowing(format!("at most {MAX_FILE_NAME_BYTES} bytes")),
        ]));
    }
    match control_character_fault(name, "/file") {
        Some(fault) => Err(ApiError::validation(vec![fault])),
        None => Ok(Some(name.to_owned()).filter(|name| !name.is_empty())),
    }
}

fn refuse_compressed(first_bytes: &[u8]) -> Result<(), ApiError> {
    // Readers unpack these two.
    let other = compression_of(first_bytes).filter(|name| !["gzip", "zstd"].contains(name));
    match other {
        Some(name) => Err(compressed(&format!(
            "the file is compressed ({name}); upload it unpacked"
        ))),
        None => Ok(()),
    }
}

fn part_fault(pointer: &str, code: &str, detail: &str) -> ApiError {
    ApiError::validation(vec![Fault::new(pointer, code, detail)])
}
