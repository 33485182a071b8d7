//! Work that somebody waits for: so much of a kind at the same time, and done again, alone, when a child died of it.

use super::{Children, Death, Failure, Heard, Made, Order, size_text};
use crate::service::error::ServiceError;
use anyhow::{Context, anyhow};
use std::sync::Arc;
use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use tokio_util::sync::CancellationToken;

/// Where such work is asked for; clones share the places.
#[derive(Clone)]
pub struct Desk {
    children: Arc<Children>,
    places: Arc<Semaphore>,
    count: usize,
    job_memory_bytes: Option<u64>,
    closing: CancellationToken,
}

impl Desk {
    /// A desk with so many places; `closing` ends all waiting.
    pub fn new(
        children: Arc<Children>,
        count: usize,
        job_memory_bytes: Option<u64>,
        closing: CancellationToken,
    ) -> Self {
        Desk {
            children,
            places: Arc::new(Semaphore::new(count)),
            count,
            job_memory_bytes,
            closing,
        }
    }

    /// Does the work, which is called `what` where it fails.
    pub async fn ask(&self, order: Order, what: &str) -> Result<Made, ServiceError> {
        let made = tokio::select! {
            made = self.try_twice(order) => made,
            () = self.closing.cancelled() => Err(Failure::Stopped),
        };
        made.map_err(|failure| match failure {
            Failure::Stopped => ServiceError::ShuttingDown,
            Failure::Faults(faults) => ServiceError::Invalid(faults),
            Failure::Memory => ServiceError::MemoryLimit(memory_text(what, self.job_memory_bytes)),
            Failure::Died(how) => ServiceError::Crashed(crash_text(what, &how)),
            Failure::Internal(error) => error.into(),
        })
    }

    async fn try_twice(&self, order: Order) -> Result<Made, Failure> {
        let permit = self
            .places
            .clone()
            .acquire_owned()
            .await
            .context("nobody is asked any more")?;
        let first = self.try_once(order.clone()).await;
        let Err(Failure::Died(how)) = first else {
            return first;
        };
        tracing::warn!(
            error = format!("{how:#}"),
            "a child died; its work is done again, alone"
        );
        drop(permit);
        let _alone = all_of(&self.places, self.count).await?;
        self.try_once(order).await
    }

    async fn try_once(&self, order: Order) -> Result<Made, Failure> {
        let mut child = self.children.take(order.campaign()).await?;
        child.order(order)?;
        loop {
            match child.hear().await {
                Heard::Progress(_) => {}
                Heard::Done(made) => {
                    child.give_back();
                    return result_of(made);
                }
                Heard::Died(death) => return Err(failure_of(death)),
            }
        }
    }
}

/// Says that something needs too much memory.
pub fn memory_text(what: &str, job_memory_bytes: Option<u64>) -> String {
    match job_memory_bytes {
        Some(bytes) => format!(
            "{what} needs more memory than the {} that --job-memory allows",
            size_text(bytes)
        ),
        None => format!("{what} needs more memory than there is"),
    }
}

/// Says that something killed its process again.
pub fn crash_text(what: &str, how: &anyhow::Error) -> String {
    format!("the process of {what} died twice, the second time while nothing else ran ({how})")
}

pub async fn all_of(
    semaphore: &Arc<Semaphore>,
    permits: usize,
) -> anyhow::Result<OwnedSemaphorePermit> {
    let permits = u32::try_from(permits)?;
    Ok(semaphore.clone().acquire_many_owned(permits).await?)
}

/// Why there is nothing when a child died.
pub fn failure_of(death: Death) -> Failure {
    match death {
        Death::Memory => Failure::Memory,
        Death::Other(how) => Failure::Died(anyhow!("{how}")),
    }
}

/// What was made, unless it says why it was not.
pub fn result_of(made: Made) -> Result<Made, Failure> {
    match made {
        Made::Stopped => Err(Failure::Stopped),
        Made::Faults(faults) => Err(Failure::Faults(faults)),
        Made::Memory => Err(Failure::Memory),
        Made::Internal {
            text,
            is_full: true,
        } => Err(Failure::Internal(
            std::io::Error::new(std::io::ErrorKind::StorageFull, text).into(),
        )),
        Made::Internal { text, .. } => Err(Failure::Internal(anyhow!(text))),
        made => Ok(made),
    }
}

/// What another order would have given.
pub fn unexpected(made: &Made) -> anyhow::Error {
    anyhow!("a child made something else: {made:?}")
}
