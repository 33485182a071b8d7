//! What can go wrong behind the HTTP layer; no status codes here.

use crate::model::fault::Fault;

#[derive(Debug, thiserror::Error)]
pub enum JobsError {
    #[error("there is no such {0}")]
    NotFound(&'static str),
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
    #[error(transparent)]
    Internal(#[from] anyhow::Error),
}

impl JobsError {
    pub(super) fn conflict(code: &'static str, detail: impl Into<String>) -> Self {
        JobsError::Conflict { code, detail: detail.into() }
    }
}
