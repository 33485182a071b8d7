//! Work in children: given, watched over, stopped when it is not wanted any more, and done again, alone, when a child died of it.

use super::control::{Control, Stop};
use super::failure::Failure;
use super::{Inner, JobsError};
use crate::service::child::{Death, Heard, Made, Order, size_text};
use crate::service::types::Progress;
use anyhow::{Context, anyhow};
use futures::future::BoxFuture;
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use uuid::Uuid;

/// Files that are checked at the same time, and looks at data that are taken at the same time.
pub(super) const UPLOADS: usize = 2;
pub(super) const LOOKS: usize = 2;

/// Work that is over sooner says nothing of its progress: writing that down would take as long as the work.
const SOON: Duration = Duration::from_millis(50);

impl Inner {
    /// Does a piece of a job in a child, and `tell`s how far it is. The slot is free when the child has answered or is dead.
    pub(super) async fn in_child<'a>(
        &self,
        job_id: Uuid,
        order: Order,
        control: &Control,
        permit: OwnedSemaphorePermit,
        tell: impl Fn(Progress) -> BoxFuture<'a, ()> + Send + Sync,
    ) -> Result<Made, Failure> {
        let first = self
            .try_in_child(job_id, order.clone(), control, &tell)
            .await;
        let Err(Failure::Died(how)) = first else {
            return first;
        };
        tracing::warn!(%job_id, error = format!("{how:#}"), "a child died; its work is done again, alone");
        // All slots are waited for; this one is among them.
        drop(permit);
        let _alone = tokio::select! {
            alone = all_of(&self.slots, self.config.slots) => alone?,
            () = control.asked() => return Err(Failure::Stopped),
        };
        self.try_in_child(job_id, order, control, &tell).await
    }

    async fn try_in_child<'a>(
        &self,
        job_id: Uuid,
        order: Order,
        control: &Control,
        tell: &(impl Fn(Progress) -> BoxFuture<'a, ()> + Send + Sync),
    ) -> Result<Made, Failure> {
        let (limit, grace_over) = (
            tokio::time::sleep(self.config.job_time_limit),
            control.grace_over(),
        );
        tokio::pin!(limit, grace_over);
        let mut child = tokio::select! {
            biased;
            () = control.asked() => return Err(Failure::Stopped),
            child = self.children.take(order.campaign()) => child?,
        };
        child.order(order)?;
        let mut is_told = false;
        let soon = tokio::time::sleep(SOON);
        tokio::pin!(soon);
        let (mut is_early, mut unsaid) = (true, None);
        loop {
            tokio::select! {
                heard = child.hear() => match heard {
                    Heard::Progress(progress) if is_early => unsaid = Some(progress),
                    Heard::Progress(progress) => tell(progress).await,
                    Heard::Done(made) => {
                        child.give_back();
                        return result_of(made);
                    }
                    Heard::Died(_) if control.reason().is_some() => return Err(Failure::Stopped),
                    Heard::Died(death) => return Err(failure_of(death)),
                },
                () = control.asked(), if !is_told => {
                    is_told = true;
                    child.stop();
                }
                () = &mut soon, if is_early => {
                    is_early = false;
                    if let Some(progress) = unsaid.take() {
                        tell(progress).await;
                    }
                }
                () = &mut grace_over => {
                    tracing::info!(%job_id, "work did not stop when asked; its process is killed");
                    return Err(Failure::Stopped);
                }
                () = &mut limit, if control.reason().is_none() => control.stop(Stop::TimeLimit),
            }
        }
    }

    /// Does what somebody waits for in a child; `desk` says how much of the kind is done at the same time, and `what` it is.
    pub(super) async fn ask(
        &self,
        order: Order,
        (desk, places): (&Arc<Semaphore>, usize),
        what: &str,
    ) -> Result<Made, JobsError> {
        let asked = async {
            let permit = desk
                .clone()
                .acquire_owned()
                .await
                .context("nobody is asked any more")?;
            let first = self.ask_once(order.clone()).await;
            let Err(Failure::Died(how)) = first else {
                return first;
            };
            tracing::warn!(
                error = format!("{how:#}"),
                "a child died; its work is done again, alone"
            );
            drop(permit);
            let _alone = all_of(desk, places).await?;
            self.ask_once(order).await
        };
        let made = tokio::select! {
            made = asked => made,
            () = self.closing.cancelled() => Err(Failure::Stopped),
        };
        made.map_err(|failure| match failure {
            Failure::Stopped => JobsError::ShuttingDown,
            Failure::Faults(faults) => JobsError::Invalid(faults),
            Failure::Memory => JobsError::MemoryLimit(self.memory_text(what)),
            Failure::Died(how) => JobsError::Crashed(crash_text(what, &how)),
            Failure::Internal(error) => error.into(),
        })
    }

    async fn ask_once(&self, order: Order) -> Result<Made, Failure> {
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

    /// Says that something needs too much memory.
    pub(super) fn memory_text(&self, what: &str) -> String {
        match self.config.job_memory_bytes {
            Some(bytes) => format!(
                "{what} needs more memory than the {} that --job-memory allows",
                size_text(bytes)
            ),
            None => format!("{what} needs more memory than there is"),
        }
    }
}

/// Says that something killed its process again.
pub(super) fn crash_text(what: &str, how: &anyhow::Error) -> String {
    format!("the process of {what} died twice, the second time while nothing else ran ({how})")
}

async fn all_of(
    semaphore: &Arc<Semaphore>,
    permits: usize,
) -> anyhow::Result<OwnedSemaphorePermit> {
    Ok(semaphore
        .clone()
        .acquire_many_owned(u32::try_from(permits)?)
        .await?)
}

fn failure_of(death: Death) -> Failure {
    match death {
        Death::Memory => Failure::Memory,
        Death::Other(how) => Failure::Died(anyhow!("{how}")),
    }
}

fn result_of(made: Made) -> Result<Made, Failure> {
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
pub(super) fn unexpected(made: &Made) -> anyhow::Error {
    anyhow!("a child made something else: {made:?}")
}
