//! Problems (RFC 9457): one shape for every refusal, and for the reason why a job failed.

use crate::model::fault::Fault;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// Every problem: its code (the last part of its type URI), HTTP status and title.
pub const PROBLEMS: &[(&str, u16, &str)] = &[
    ("malformed_request", 400, "The request is malformed"),
    ("malformed_json", 400, "The body is not JSON"),
    ("invalid_cursor", 400, "The cursor is not one of ours"),
    (
        "unauthenticated",
        401,
        "A key is needed, and none that opens was given",
    ),
    ("forbidden", 403, "The key does not allow it"),
    ("foreign_host", 403, "The host is not one of this service"),
    ("cross_site", 403, "The request comes from another site"),
    ("not_found", 404, "There is no such thing"),
    ("method_not_allowed", 405, "The method is not allowed here"),
    ("not_acceptable", 406, "No representation is acceptable"),
    ("request_timeout", 408, "The body comes too slowly"),
    ("job_terminal", 409, "The job has already ended"),
    ("job_active", 409, "The job has not ended yet"),
    ("in_use", 409, "Something still needs it"),
    ("result_not_ready", 409, "The job has no result yet"),
    ("job_failed", 409, "The job ended without a result"),
    (
        "dependency_failed",
        409,
        "A job that this job needs did not succeed",
    ),
    ("session_closed", 409, "The session takes no more"),
    (
        "session_paused",
        409,
        "The session takes no scans for the time being",
    ),
    ("session_elsewhere", 409, "Another process has the session"),
    ("gone", 410, "It has been deleted"),
    ("payload_too_large", 413, "The body is too large"),
    ("memory_limit", 413, "It needs more memory than it may have"),
    (
        "unsupported_media_type",
        415,
        "The media type is not supported",
    ),
    (
        "range_not_satisfiable",
        416,
        "The range is outside the file",
    ),
    ("validation", 422, "The request is not valid"),
    (
        "idempotency_mismatch",
        422,
        "The idempotency key belongs to another request",
    ),
    (
        "session_full",
        429,
        "As much waits for the session as it takes",
    ),
    ("too_many_requests", 429, "The key asks too often"),
    ("internal", 500, "An error inside the service"),
    ("damaged", 500, "A stored file is damaged"),
    (
        "crashed",
        500,
        "The job ended the process that ran it, too often",
    ),
    ("queue_full", 503, "The queue is full"),
    ("too_many_connections", 503, "Too many connections are open"),
    ("too_many_streams", 503, "Too many event streams are open"),
    ("shutting_down", 503, "The service is shutting down"),
    ("unavailable", 503, "The database does not answer"),
    ("disk", 503, "The data directory takes no more"),
    ("time_limit", 503, "The job ran longer than it may"),
    ("insufficient_storage", 507, "There is no room to keep it"),
];

/// An RFC 9457 problem.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Problem {
    /// `/problems/<code>`.
    #[serde(rename = "type")]
    pub type_uri: String,
    pub title: String,
    /// The HTTP status code.
    pub status: u16,
    pub detail: String,
    /// The path that was asked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub instance: Option<String>,
    /// Machine-readable name of the problem.
    pub code: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub request_id: Option<String>,
    /// Every fault that was found; empty where the problem is not about the content of a request.
    #[serde(default)]
    pub errors: Vec<FaultItem>,
}

impl Problem {
    /// The problem named `code`; a code that is not in [`PROBLEMS`] becomes `internal`.
    pub fn new(code: &str, detail: impl Into<String>) -> Self {
        let &(code, status, title) = PROBLEMS
            .iter()
            .find(|(name, ..)| *name == code)
            .unwrap_or(&("internal", 500, "An error inside the service"));
        Problem {
            type_uri: format!("/problems/{code}"),
            title: title.to_owned(),
            status,
            detail: clipped(detail.into()),
            instance: None,
            code: code.to_owned(),
            request_id: None,
            errors: Vec::new(),
        }
    }

    /// `validation` with all its faults.
    pub fn validation(faults: Vec<Fault>) -> Self {
        let detail = match faults.as_slice() {
            [fault] => fault.detail.clone(),
            _ => format!("{} faults", faults.len()),
        };
        let more = faults.len().saturating_sub(MAX_FAULTS);
        let mut errors: Vec<FaultItem> = faults
            .into_iter()
            .take(MAX_FAULTS)
            .map(FaultItem::from)
            .collect();
        if more > 0 {
            errors.push(
                Fault::new("", "too_many", format!("{more} more faults are not listed")).into(),
            );
        }
        Problem {
            errors,
            ..Problem::new("validation", detail)
        }
    }
}

/// Of more faults the first are told.
const MAX_FAULTS: usize = 100;
/// A longer text repeats a request at length, and is cut.
const MAX_TEXT: usize = 1000;

fn clipped(text: String) -> String {
    match text.char_indices().nth(MAX_TEXT) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text,
    }
}

/// One fault of a request or of a file.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub struct FaultItem {
    /// JSON pointer into the request; empty for the whole body.
    pub pointer: String,
    /// Machine-readable: `missing`, `unknown_field`, `wrong_type`, `out_of_range`, `unknown_value`, …
    pub code: String,
    pub detail: String,
    /// What would be accepted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub allowed: Option<String>,
    /// Line of an uploaded file, from 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub line: Option<u64>,
    /// Column of an uploaded file, by name.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub column: Option<String>,
}

impl From<Fault> for FaultItem {
    fn from(fault: Fault) -> Self {
        let Fault {
            pointer,
            code,
            detail,
            allowed,
            line,
            column,
        } = fault;
        FaultItem {
            pointer: clipped(pointer),
            code,
            detail: clipped(detail),
            allowed: allowed.map(String::from).map(clipped),
            line,
            column: column.map(String::from).map(clipped),
        }
    }
}
