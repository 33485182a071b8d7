//! The queue of a process that has its tables for itself: in memory, for the tables know what has to be in it.

use super::{Entry, place};
use crate::service::storage::Ready;
use std::cmp::Reverse;
use std::collections::{BTreeMap, HashSet};
use std::path::Path;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use tokio::sync::Notify;
use uuid::Uuid;

/// Clones share everything.
#[derive(Clone, Default)]
pub(super) struct Local {
    waiting: Arc<Mutex<Waiting>>,
    news: Arc<Notify>,
}

/// Entries by their place and, of one place, by age: ids grow with time.
#[derive(Default)]
struct Waiting {
    entries: BTreeMap<(Reverse<i64>, Uuid), Entry>,
    work: HashSet<(Uuid, Option<u32>)>,
}

impl Waiting {
    /// What waits already needs no second entry.
    fn insert(&mut self, entry: Entry, place: i64) {
        if self.work.insert((entry.job_id, entry.chunk)) {
            self.entries.insert((Reverse(place), entry.id), entry);
        }
    }
}

impl Local {
    pub fn push(&self, ready: &[Ready]) {
        let mut waiting = self.lock();
        for ready in ready {
            waiting.insert(Entry::new(ready), place(ready));
        }
        // One sign is kept for whoever does not wait yet, so that none is lost.
        self.news.notify_one();
    }

    pub fn give_back(&self, entry: Entry, place: i64) {
        self.lock().insert(entry, place);
        self.news.notify_one();
    }

    /// For one caller at a time.
    pub async fn next(&self) -> (Entry, i64) {
        loop {
            if let Some(taken) = self.take() {
                return taken;
            }
            self.news.notified().await;
        }
    }

    fn take(&self) -> Option<(Entry, i64)> {
        let mut waiting = self.lock();
        let ((Reverse(place), _), entry) = waiting.entries.pop_first()?;
        waiting.work.remove(&(entry.job_id, entry.chunk));
        Some((entry, place))
    }

    fn lock(&self) -> MutexGuard<'_, Waiting> {
        self.waiting.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Earlier versions kept the queue in a file, which nobody reads any more.
pub(super) fn remove_former_file(tables: &Path) {
    for suffix in ["", "-wal", "-shm"] {
        // It is not there in most directories, and in the way in none.
        let _ = std::fs::remove_file(tables.with_file_name(format!("queue.db{suffix}")));
    }
}
