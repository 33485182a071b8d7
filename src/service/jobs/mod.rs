//! Submitting, running, waiting for and cancelling jobs, and keeping datasets: everything behind HTTP.

mod campaign;
mod change;
mod compare;
mod control;
mod hub;
mod in_child;
mod inputs;
mod open;
mod read;
mod recent;
mod report_page;
mod request;
mod retention;
mod runner;
mod sessions;
mod submit;
mod upkeep;

pub use crate::service::storage::{JobFilter, Paging, Sort};
pub use change::JOB_PATCH;
pub use request::*;

use super::child::{Children, Desk};
use super::config::Config;
use super::datasets::Datasets;
use super::engine::{Engine, Entry, Handler};
use super::error::ServiceError;
use super::keys::Keys;
use super::sessions::Sessions;
use super::storage::blobs::Blobs;
use super::storage::notices::{Notice, Notices};
use super::storage::room::{NoRoom, Room};
use super::storage::{Changed, Storage};
use super::types::JobState;
use anyhow::bail;
use campaign::Campaigns;
use control::{Running, Stop};
use futures::FutureExt;
use hub::Hub;
use recent::Recent;
use std::collections::BTreeMap;
use std::fs::File;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Weak};
use std::time::{Duration, Instant};
use tokio::sync::Semaphore;
use tokio_util::sync::CancellationToken;
use uuid::Uuid;

/// How often the service looks after itself, and how often it sweeps.
const MAINTENANCE_INTERVAL: Duration = Duration::from_secs(5);
const COLLECTION_INTERVAL: Duration = Duration::from_secs(3600);
/// A database that takes longer for nothing is not there.
const ANSWER: Duration = Duration::from_secs(2);
/// An idempotency key is remembered for a day.
const KEY_AGE: Duration = Duration::from_secs(24 * 3600);

/// The jobs and datasets of one data directory, with the workers that run the jobs.
pub struct Jobs {
    config: Config,
    storage: Storage,
    blobs: Blobs,
    engine: Engine,
    hub: Hub,
    recent: Recent,
    running: Running,
    campaigns: Campaigns,
    children: Arc<Children>,
    datasets: Arc<Datasets>,
    sessions: Arc<Sessions>,
    keys: Arc<Keys>,
    /// Jobs that may compute at the same time.
    slots: Arc<Semaphore>,
    /// Where runs are put together for somebody who waits.
    looks: Desk,
    room: Room,
    closing: CancellationToken,
    /// Some ready job may be missing in the queue.
    must_requeue: AtomicBool,
    /// Locked while the directory is in use by one process; the system unlocks it when the process ends.
    lock: Option<File>,
}

impl Jobs {
    /// The datasets of the same directory.
    pub fn datasets(&self) -> &Arc<Datasets> {
        &self.datasets
    }

    /// Who may do what.
    pub fn keys(&self) -> &Arc<Keys> {
        &self.keys
    }

    /// The live sessions of the same tables.
    pub fn sessions(&self) -> &Arc<Sessions> {
        &self.sessions
    }

    /// How many jobs are in each state.
    pub async fn counts(&self) -> Result<BTreeMap<JobState, u64>, ServiceError> {
        Ok(self.storage.job_counts().await?)
    }

    /// Whether the database answers soon.
    pub async fn check(&self) -> Result<(), ServiceError> {
        match tokio::time::timeout(ANSWER, self.storage.check()).await {
            Ok(answered) => Ok(answered?),
            Err(_) => Err(ServiceError::Unavailable),
        }
    }

    /// Whether so many bytes more can be kept.
    pub fn check_room(&self, bytes: u64) -> Result<(), NoRoom> {
        self.room.check(bytes)
    }

    /// What is free on the disk of the data directory; `None` where nobody can tell.
    pub fn disk_free_bytes(&self) -> Option<u64> {
        self.room.free_bytes()
    }

    /// Whether [`Self::shutdown`] has begun.
    pub fn is_shutting_down(&self) -> bool {
        self.closing.is_cancelled()
    }

    /// Takes no more work, hands running jobs back to the queue, and returns when all is written.
    pub async fn shutdown(&self) {
        self.closing.cancel();
        self.running.stop_all(Stop::ShuttingDown);
        self.engine.stop().await;
        self.children.close();
        self.sessions.shutdown().await;
        self.storage.close().await;
        if let Some(Err(error)) = self.lock.as_ref().map(File::unlock) {
            tracing::warn!(%error, "the data directory was not unlocked");
        }
    }

    /// Lets everybody know of a committed change, and queues what can be done now.
    async fn publish(&self, changed: Changed) {
        self.announce(&changed.touched).await;
        if changed.ready.is_empty() {
            return;
        }
        let queued = match self.engine.enqueue(&changed.ready).await {
            Ok(()) => self.storage.note_enqueued(&changed.ready).await,
            Err(error) => Err(error),
        };
        if let Err(error) = queued {
            tracing::error!(
                error = format!("{error:#}"),
                "jobs were not queued; trying again soon"
            );
            self.must_requeue.store(true, Ordering::Release);
        }
    }

    /// Wakes whoever waits for news of these jobs, here and in other processes.
    async fn announce(&self, ids: &[Uuid]) {
        self.hub.wake(ids);
        if let Err(error) = self.storage.notify(ids).await {
            tracing::warn!(
                error = format!("{error:#}"),
                "other processes were not told of a change"
            );
        }
    }

    /// Queues what could be done, in case it is missing: all of it, or what is not known to be in the queue. What is queued twice is
    /// done once.
    async fn enqueue_ready(&self, is_missing: bool) -> anyhow::Result<()> {
        let ready = self.storage.ready(is_missing).await?;
        self.engine.enqueue(&ready).await?;
        self.storage.note_enqueued(&ready).await
    }

    async fn requeue_if_needed(&self) -> anyhow::Result<()> {
        let must = self.must_requeue.swap(false, Ordering::AcqRel);
        if must || self.lock.is_none() {
            let queued = self.enqueue_ready(!must).await;
            self.must_requeue
                .fetch_or(must && queued.is_err(), Ordering::AcqRel);
            queued?;
        }
        Ok(())
    }

    /// Stops what runs here of jobs that have ended, or are to end, elsewhere.
    async fn stop_unwanted(&self, ids: &[Uuid]) -> anyhow::Result<()> {
        for &id in ids {
            let stored = self.storage.job(id).await?;
            if stored.is_none_or(|stored| {
                stored.job.state.is_terminal() || stored.job.cancel_requested_at.is_some()
            }) {
                self.running.stop(id, Stop::Canceled);
            }
        }
        Ok(())
    }

    /// Takes up what an earlier process left; only for one that has the tables for itself.
    async fn take_up(&self) -> anyhow::Result<()> {
        self.restore_blobs(None).await?;
        self.storage.recover().await
    }

    async fn clean_tables(&self) -> anyhow::Result<()> {
        self.storage.forget_keys(KEY_AGE).await?;
        self.storage
            .forget_deleted(retention::TOMBSTONE_AGE)
            .await?;
        // What a bucket that was out of reach still has.
        Ok(self.datasets.collect_garbage(Vec::new()).await?)
    }
}

/// What the queue calls; it does not keep the service alive.
fn handler(jobs: Weak<Jobs>) -> Handler {
    Handler::new(move |entry: Entry| {
        let jobs = jobs.upgrade();
        async move {
            let Some(jobs) = jobs else {
                bail!("the service has stopped")
            };
            let looked = jobs.clone().handle_entry(entry).await;
            if looked.is_err() {
                jobs.must_requeue.store(true, Ordering::Release);
            }
            looked
        }
        .boxed()
    })
}

async fn maintain(jobs: Weak<Jobs>, closing: CancellationToken) {
    let mut collected = Instant::now();
    loop {
        tokio::select! {
            () = tokio::time::sleep(MAINTENANCE_INTERVAL) => {}
            () = closing.cancelled() => return,
        }
        let Some(jobs) = jobs.upgrade() else { return };
        let mut done = jobs.requeue_if_needed().await;
        if done.is_ok() && jobs.lock.is_none() {
            // In case a notice was lost.
            done = jobs.stop_unwanted(&jobs.running.jobs()).await;
        }
        if done.is_ok() && collected.elapsed() > COLLECTION_INTERVAL {
            collected = Instant::now();
            done = jobs.clean_tables().await;
        }
        if done.is_ok() {
            done = jobs.close_sessions_that_are_over().await;
        }
        if done.is_ok() {
            done = jobs.tidy().await;
        }
        if done.is_ok() {
            done = jobs.retain().await;
        }
        if let Err(error) = done {
            tracing::error!(error = format!("{error:#}"), "upkeep failed");
        }
    }
}

/// Listens to the processes that share the database.
async fn listen(mut notices: Notices, jobs: Weak<Jobs>, closing: CancellationToken) {
    loop {
        let heard = tokio::select! {
            heard = notices.next() => heard,
            () = closing.cancelled() => return,
        };
        let Some(jobs) = jobs.upgrade() else { return };
        let concerned = match heard {
            Ok(Notice::Changed(ids)) => {
                jobs.hub.wake(&ids);
                jobs.running
                    .jobs()
                    .into_iter()
                    .filter(|id| ids.contains(id))
                    .collect()
            }
            Ok(Notice::Queued) => {
                jobs.engine.wake();
                Vec::new()
            }
            Ok(Notice::Anything) => {
                jobs.engine.wake();
                jobs.hub.wake_all();
                jobs.running.jobs()
            }
            Err(error) => {
                tracing::warn!(
                    error = format!("{error:#}"),
                    "news of other processes were not heard; trying again"
                );
                tokio::time::sleep(Duration::from_secs(1)).await;
                Vec::new()
            }
        };
        if let Err(error) = jobs.stop_unwanted(&concerned).await {
            tracing::warn!(
                error = format!("{error:#}"),
                "the state of running jobs was not read"
            );
        }
    }
}
