//! What can go wrong behind the HTTP layer; no status codes here.

use crate::model::fault::Fault;
use crate::service::storage::blobs::Damaged;
use crate::service::storage::room::NoRoom;
use std::io::ErrorKind;

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
    NoRoom(#[from] NoRoom),
    #[error(transparent)]
    Damaged(Damaged),
    #[error(transparent)]
    Internal(anyhow::Error),
}

impl JobsError {
    pub(super) fn conflict(code: &'static str, detail: impl Into<String>) -> Self {
        JobsError::Conflict {
            code,
            detail: detail.into(),
        }
    }
}

/// Whether the same may succeed later, with nothing changed but the database or the disk.
pub(super) fn may_pass(error: &anyhow::Error) -> bool {
    is_unavailable(error) || is_full(error)
}

/// Whether the database was not there, or too busy.
pub(super) fn is_unavailable(error: &anyhow::Error) -> bool {
    use sqlx::Error::{Io, PoolClosed, PoolTimedOut, Protocol, WorkerCrashed};
    error
        .chain()
        .filter_map(|cause| cause.downcast_ref::<sqlx::Error>())
        .any(|error| match error {
            Io(error) => !is_full_io(error),
            PoolClosed | PoolTimedOut | Protocol(_) | WorkerCrashed => true,
            sqlx::Error::Database(error) => {
                error.code().is_some_and(|code| match sqlite_code(&code) {
                    // Somebody else holds the file: BUSY, LOCKED.
                    Some(code) => matches!(code, 5 | 6),
                    // Classes 08 and 57P: the connection was lost; the server stops or starts. Statements and changes that took too long.
                    None => {
                        code.starts_with("08")
                            || code.starts_with("57P")
                            || matches!(code.as_ref(), "57014" | "25P03")
                    }
                })
            }
            _ => false,
        })
}

/// Whether the disk took no more: it is full, or cannot be written or read.
fn is_full(error: &anyhow::Error) -> bool {
    error.chain().any(|cause| {
        let of_tables = cause
            .downcast_ref::<sqlx::Error>()
            .is_some_and(|error| match error {
                sqlx::Error::Io(error) => is_full_io(error),
                sqlx::Error::Database(error) => {
                    error.code().is_some_and(|code| match sqlite_code(&code) {
                        // READONLY, IOERR, FULL, CANTOPEN.
                        Some(code) => matches!(code, 8 | 10 | 13 | 14),
                        None => matches!(code.as_ref(), "53100" | "58030"),
                    })
                }
                _ => false,
            });
        of_tables
            || cause.downcast_ref::<NoRoom>().is_some()
            || cause
                .downcast_ref::<std::io::Error>()
                .is_some_and(is_full_io)
    })
}

fn is_full_io(error: &std::io::Error) -> bool {
    matches!(
        error.kind(),
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded | ErrorKind::ReadOnlyFilesystem
    )
}

/// The kind of a SQLite error, without what extends it; those of PostgreSQL have five letters.
fn sqlite_code(code: &str) -> Option<u32> {
    (code.len() < 5)
        .then(|| code.parse::<u32>().ok())
        .flatten()
        .map(|code| code & 0xff)
}

impl From<anyhow::Error> for JobsError {
    fn from(error: anyhow::Error) -> Self {
        if is_unavailable(&error) {
            tracing::warn!(error = format!("{error:#}"), "the database does not answer");
            return JobsError::Unavailable;
        }
        if is_full(&error) {
            tracing::warn!(error = format!("{error:#}"), "the disk takes no more");
            return JobsError::NoRoom(NoRoom::Full);
        }
        match error.downcast_ref::<Damaged>() {
            Some(&damaged) => JobsError::Damaged(damaged),
            None => JobsError::Internal(error),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Error;

    #[test]
    fn a_full_disk_is_told_from_other_faults() {
        let full =
            anyhow::Error::from(Error::from(ErrorKind::StorageFull)).context("cannot write a blob");
        assert!(is_full(&full) && may_pass(&full) && !is_unavailable(&full));
        let lost = anyhow::Error::from(sqlx::Error::Io(Error::from(ErrorKind::ConnectionReset)));
        assert!(!is_full(&lost) && is_unavailable(&lost));
        let other = anyhow::Error::from(Error::from(ErrorKind::NotFound));
        assert!(!may_pass(&other) && matches!(JobsError::from(other), JobsError::Internal(_)));
        assert_eq!(
            ["13", "778", "5", "53100"].map(sqlite_code),
            [Some(13), Some(10), Some(5), None]
        );
    }
}
