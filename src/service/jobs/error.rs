//! What can go wrong behind the HTTP layer; no status codes here.

use crate::model::fault::Fault;

#[derive(Debug, thiserror::Error)]
pub enum JobsError {
    #[error("there is no such {0}")]
    NotFound(&'static str),
    /// What is named is not among what there is; the text says what is.
    #[error("{0}")]
    NotThere(String),
    #[error("the {0} has been deleted")]
    Gone(&'static str),
    /// The state forbids it; `code` is one of `job_terminal`, `job_active`, `in_use`, `result_not_ready`, `job_failed`.
    #[error("{detail}")]
    Conflict { code: &'static str, detail: String },
    #[error("{} fault(s) in the request", .0.len())]
    Invalid(Vec<Fault>),
    #[error("the cursor is not one of ours")]
    InvalidCursor,
    #[error("the idempotency key belongs to another request")]
    IdempotencyMismatch,
    #[error("the queue is full")]
    QueueFull,
    #[error("the service is shutting down")]
    ShuttingDown,
    #[error("the database does not answer")]
    Unavailable,
    /// It needs more memory than it may have.
    #[error("{0}")]
    MemoryLimit(String),
    /// Its process died, and when it was done again died again.
    #[error("{0}")]
    Crashed(String),
    #[error(transparent)]
    Internal(anyhow::Error),
}

impl JobsError {
    pub(super) fn conflict(code: &'static str, detail: impl Into<String>) -> Self {
        JobsError::Conflict { code, detail: detail.into() }
    }
}

/// Whether the database was not there: the same may succeed later.
pub(super) fn is_unavailable(error: &anyhow::Error) -> bool {
    use sqlx::Error::{Io, PoolClosed, PoolTimedOut, Protocol, WorkerCrashed};
    error.chain().filter_map(|cause| cause.downcast_ref::<sqlx::Error>()).any(|error| match error {
        Io(_) | PoolClosed | PoolTimedOut | Protocol(_) | WorkerCrashed => true,
        // Classes 08 and 57P: the connection was lost; the server stops or starts.
        sqlx::Error::Database(error) => error.code().is_some_and(|code| code.starts_with("08") || code.starts_with("57P")),
        _ => false,
    })
}

impl From<anyhow::Error> for JobsError {
    fn from(error: anyhow::Error) -> Self {
        if is_unavailable(&error) {
            tracing::warn!(error = format!("{error:#}"), "the database does not answer");
            return JobsError::Unavailable;
        }
        JobsError::Internal(error)
    }
}
