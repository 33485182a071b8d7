//! Why a piece of work made nothing, in a child and outside it.

use crate::experiment::RunError;
use crate::model::fault::Fault;
use crate::service::error::ServiceError;
use anyhow::anyhow;

#[derive(Debug)]
pub(in crate::service) enum Failure {
    Stopped,
    Faults(Vec<Fault>),
    /// It needs more memory than it may have.
    Memory,
    /// The process that did it died of something else, of which this tells.
    Died(anyhow::Error),
    Internal(anyhow::Error),
}

impl From<ServiceError> for Failure {
    fn from(error: ServiceError) -> Self {
        match error {
            ServiceError::Invalid(faults) => Failure::Faults(faults),
            ServiceError::Internal(error) => Failure::Internal(error),
            // Which of its errors it was is in the log.
            ServiceError::Unavailable => Failure::Internal(sqlx::Error::PoolTimedOut.into()),
            ServiceError::NoRoom(reason) => Failure::Internal(reason.into()),
            ServiceError::Damaged(damaged) => Failure::Internal(damaged.into()),
            other => Failure::Internal(anyhow!(other)),
        }
    }
}

impl From<RunError> for Failure {
    fn from(error: RunError) -> Self {
        match error {
            RunError::Stopped => Failure::Stopped,
            RunError::Faults(faults) => Failure::Faults(faults),
        }
    }
}

impl From<anyhow::Error> for Failure {
    fn from(error: anyhow::Error) -> Self {
        Failure::Internal(error)
    }
}
