//! Asking a running job to stop, and when to kill one that does not listen.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;
use tokio::sync::watch;
use uuid::Uuid;

/// A job that was asked to stop has this long to notice; then its process is killed.
const GRACE: Duration = Duration::from_secs(2);
/// The same when the whole service stops.
const CLOSING_GRACE: Duration = Duration::from_secs(1);

/// Why a job is to stop.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Stop {
    Canceled,
    ShuttingDown,
    TimeLimit,
}

/// One running job's stop sign. The first reason stays.
pub(super) struct Control(watch::Sender<Option<Stop>>);

impl Control {
    pub(super) fn stop(&self, reason: Stop) {
        self.0
            .send_if_modified(|current| current.is_none() && current.replace(reason).is_none());
    }

    pub(super) fn reason(&self) -> Option<Stop> {
        *self.0.borrow()
    }

    /// Ends when the job was asked to stop.
    pub(super) async fn asked(&self) {
        // The sender is part of `self` and outlives this wait.
        let _ = self.0.subscribe().wait_for(Option::is_some).await;
    }

    /// Ends when the job was asked to stop and has let its time pass.
    pub(super) async fn grace_over(&self) {
        self.asked().await;
        tokio::time::sleep(if self.reason() == Some(Stop::ShuttingDown) {
            CLOSING_GRACE
        } else {
            GRACE
        })
        .await;
    }
}

/// A job, or a chunk of one.
pub(super) type Work = (Uuid, Option<u32>);

/// Everything that runs in this process.
#[derive(Default)]
pub(super) struct Running(Mutex<HashMap<Work, Arc<Control>>>);

impl Running {
    pub(super) fn register(&self, work: Work) -> Arc<Control> {
        let control = Arc::new(Control(watch::Sender::new(None)));
        self.lock().insert(work, control.clone());
        control
    }

    pub(super) fn unregister(&self, work: Work) {
        self.lock().remove(&work);
    }

    pub(super) fn has(&self, work: Work) -> bool {
        self.lock().contains_key(&work)
    }

    /// The jobs of which something runs.
    pub(super) fn jobs(&self) -> Vec<Uuid> {
        let mut jobs: Vec<Uuid> = self.lock().keys().map(|&(job_id, _)| job_id).collect();
        jobs.sort_unstable();
        jobs.dedup();
        jobs
    }

    /// Stops a job and every chunk of it.
    pub(super) fn stop(&self, id: Uuid, reason: Stop) {
        self.lock()
            .iter()
            .filter(|((job_id, _), _)| *job_id == id)
            .for_each(|(_, control)| control.stop(reason));
    }

    pub(super) fn stop_all(&self, reason: Stop) {
        self.lock()
            .values()
            .for_each(|control| control.stop(reason));
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, HashMap<Work, Arc<Control>>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
