//! From what went wrong behind HTTP to a problem answer. This is the one place that pairs refusals with status codes;
//! the body itself is written by the outermost layer, which knows the path and the request id.

use crate::model::fault::Fault;
use crate::service::error::ServiceError;
use crate::service::types::Problem;
use axum::http::{HeaderName, HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};

/// Seconds after which a client may ask again when the queue is full or the service stops.
const RETRY_BUSY_S: u16 = 5;
/// Seconds after which a session has taken what waited.
const RETRY_SESSION_S: u16 = 1;
/// Seconds after which there may be room on the disk again: somebody has to look after it.
const RETRY_ROOM_S: u16 = 30;
/// Seconds after which a result that is not ready is worth another look.
const RETRY_RESULT_S: u16 = 1;

pub type ApiResult<T = Response> = Result<T, ApiError>;

/// A refusal on its way out.
#[derive(Debug)]
pub struct ApiError {
    problem: Box<Problem>,
    header: Option<(HeaderName, HeaderValue)>,
}

impl ApiError {
    pub fn new(code: &str, detail: impl Into<String>) -> Self {
        ApiError {
            problem: Box::new(Problem::new(code, detail)),
            header: None,
        }
    }

    pub fn not_found(what: &str) -> Self {
        ApiError::new("not_found", format!("there is no such {what}"))
    }

    pub fn validation(faults: Vec<Fault>) -> Self {
        ApiError {
            problem: Box::new(Problem::validation(faults)),
            header: None,
        }
    }

    /// An error that is ours: told to the log, not to the client.
    pub fn internal(error: impl std::fmt::Display) -> Self {
        tracing::error!(%error, "request failed");
        ApiError::new("internal", "the service could not do it; its log says why")
    }

    /// A file could not be written.
    pub fn writing(error: std::io::Error) -> Self {
        ServiceError::from(anyhow::Error::from(error)).into()
    }

    #[must_use]
    pub fn with_header(mut self, name: HeaderName, value: impl Into<HeaderValue>) -> Self {
        self.header = Some((name, value.into()));
        self
    }

    /// A refusal of what may be possible soon.
    pub fn busy(code: &str, detail: impl Into<String>) -> Self {
        ApiError::new(code, detail).retry_after(RETRY_BUSY_S)
    }

    fn retry_after(self, seconds: u16) -> Self {
        self.with_header(header::RETRY_AFTER, seconds)
    }
}

impl IntoResponse for ApiError {
    fn into_response(self) -> Response {
        let mut response = StatusCode::from_u16(self.problem.status)
            .unwrap_or(StatusCode::INTERNAL_SERVER_ERROR)
            .into_response();
        if let Some((name, value)) = self.header {
            response.headers_mut().insert(name, value);
        }
        response.extensions_mut().insert(*self.problem);
        response
    }
}

impl From<ServiceError> for ApiError {
    fn from(error: ServiceError) -> Self {
        let detail = error.to_string();
        match error {
            ServiceError::NotFound(_) | ServiceError::NotThere(_) => {
                ApiError::new("not_found", detail)
            }
            ServiceError::Gone(_) => ApiError::new("gone", detail),
            ServiceError::Conflict {
                code: code @ "result_not_ready",
                ..
            } => ApiError::new(code, detail).retry_after(RETRY_RESULT_S),
            ServiceError::Conflict { code, .. } => ApiError::new(code, detail),
            ServiceError::Invalid(faults) => ApiError::validation(faults),
            ServiceError::InvalidCursor => ApiError::new("invalid_cursor", detail),
            ServiceError::IdempotencyMismatch => ApiError::new("idempotency_mismatch", detail),
            ServiceError::QueueFull => ApiError::busy("queue_full", detail),
            ServiceError::SessionFull => {
                ApiError::new("session_full", detail).retry_after(RETRY_SESSION_S)
            }
            ServiceError::Unavailable => ApiError::busy("unavailable", detail),
            ServiceError::ShuttingDown => ApiError::busy("shutting_down", detail),
            ServiceError::MemoryLimit(_) => ApiError::new("memory_limit", detail),
            ServiceError::Crashed(_) => ApiError::new("crashed", detail),
            ServiceError::NoRoom(_) => {
                ApiError::new("insufficient_storage", detail).retry_after(RETRY_ROOM_S)
            }
            ServiceError::Damaged(_) => ApiError::new("damaged", detail),
            ServiceError::Internal(error) => ApiError::internal(format!("{error:#}")),
        }
    }
}

/// The problem of an answer that came from the framework with nothing but a status.
pub fn problem_of_status(status: StatusCode, path: &str) -> Problem {
    match status {
        StatusCode::NOT_FOUND => Problem::new("not_found", format!("there is nothing at {path}")),
        StatusCode::METHOD_NOT_ALLOWED => Problem::new(
            "method_not_allowed",
            "the header Allow names the methods that are",
        ),
        StatusCode::PAYLOAD_TOO_LARGE => Problem::new(
            "payload_too_large",
            "the body is larger than this route takes",
        ),
        StatusCode::UNSUPPORTED_MEDIA_TYPE => Problem::new(
            "unsupported_media_type",
            "the body has a type that this route does not take",
        ),
        status if status.is_client_error() => Problem::validation(vec![Fault::new(
            "",
            "malformed",
            "the request could not be read",
        )]),
        _ => Problem::new("internal", "the service could not do it; its log says why"),
    }
}
