//! Work in children: given, watched over, stopped when it is not wanted any more, and done again, alone, when a child died of it.

use super::Jobs;
use super::control::{Control, Stop};
use crate::service::child::{
    Failure, Heard, Made, Order, all_of, failure_of, memory_text, result_of,
};
use crate::service::types::Progress;
use futures::future::BoxFuture;
use std::time::Duration;
use tokio::sync::OwnedSemaphorePermit;
use uuid::Uuid;

/// Work that is over sooner says nothing of its progress: writing that down would take as long as the work.
const SOON: Duration = Duration::from_millis(50);

impl Jobs {
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

    /// Says that something needs too much memory.
    pub(super) fn memory_text(&self, what: &str) -> String {
        memory_text(what, self.config.job_memory_bytes)
    }
}
