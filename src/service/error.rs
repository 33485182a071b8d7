//! What can go wrong behind the HTTP layer; no status codes here.

use crate::model::fault::Fault;
use crate::service::storage::blobs::Damaged;
use crate::service::storage::room::NoRoom;
use crate::service::storage::{Cursor, Paging};
use std::io::ErrorKind;
use uuid::Uuid;

#[derive(Debug, thiserror::Error)]
pub enum ServiceError {
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
    #[error("as much waits for the session as it takes; push again soon")]
    SessionFull,
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

impl ServiceError {
    pub(in crate::service) fn conflict(code: &'static str, detail: impl Into<String>) -> Self {
        ServiceError::Conflict {
            code,
            detail: detail.into(),
        }
    }

    /// These jobs still read what was to go; `what` is told with its verb.
    pub(in crate::service) fn in_use(what: &str, users: &[Uuid]) -> Self {
        ServiceError::conflict("in_use", format!("{what} needed by {}", list_jobs(users)))
    }
}

/// Ids for a sentence, not too many.
fn list_jobs(jobs: &[Uuid]) -> String {
    const MOST: usize = 5;
    let named: Vec<String> = jobs
        .iter()
        .take(MOST)
        .map(|id| format!("job {id}"))
        .collect();
    let named = named.join(", ");
    if jobs.len() > MOST {
        format!("{named} and {} more", jobs.len() - MOST)
    } else {
        named
    }
}

/// # Errors
/// When there is a fault.
pub(in crate::service) fn refuse_any(faults: Vec<Fault>) -> Result<(), ServiceError> {
    if faults.is_empty() {
        Ok(())
    } else {
        Err(ServiceError::Invalid(faults))
    }
}

/// Where a page begins, if its cursor is one of ours and of this order.
pub(in crate::service) fn cursor_of(paging: &Paging) -> Result<Option<Cursor>, ServiceError> {
    let decode = |text| Cursor::decode(text, paging.sort).ok_or(ServiceError::InvalidCursor);
    paging.cursor.as_deref().map(decode).transpose()
}

/// Whether the same may succeed later, with nothing changed but the database or the disk.
pub(in crate::service) fn may_pass(error: &anyhow::Error) -> bool {
    is_unavailable(error) || is_full(error)
}

/// Whether the database was not there, or too busy.
pub(in crate::service) fn is_unavailable(error: &anyhow::Error) -> bool {
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

impl From<anyhow::Error> for ServiceError {
    fn from(error: anyhow::Error) -> Self {
        if is_unavailable(&error) {
            tracing::warn!(error = format!("{error:#}"), "the database does not answer");
            return ServiceError::Unavailable;
        }
        if is_full(&error) {
            tracing::warn!(error = format!("{error:#}"), "the disk takes no more");
            return ServiceError::NoRoom(NoRoom::Full);
        }
        match error.downcast_ref::<Damaged>() {
            Some(&damaged) => ServiceError::Damaged(damaged),
            None => ServiceError::Internal(error),
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
        assert!(
            !may_pass(&other) && matches!(ServiceError::from(other), ServiceError::Internal(_))
        );
        assert_eq!(
            ["13", "778", "5", "53100"].map(sqlite_code),
            [Some(13), Some(10), Some(5), None]
        );
    }
}
