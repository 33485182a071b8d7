//! One session in the memory of the process that has it.

use super::log::Log;
use crate::experiment::session::{Checked, Entry, EntryFate, Session, SessionEvent};
use crate::model::fault::Fault;
use crate::service::build_info::VERSION;
use crate::service::error::ServiceError;
use crate::service::rate::Rate;
use crate::service::storage::{Checkpoint, LogAppend, SessionEnd, Storage};
use crate::service::types::{Pushed, PushedResult};
use serde_json::json;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};
use tokio::sync::{Semaphore, watch};
use uuid::Uuid;

/// Scans and bytes of a session that may wait to be taken.
const QUEUED_SCANS: usize = 64;
const QUEUED_BYTES: usize = 8 << 20;
/// Scans that did not come in so long may come at once.
const SAVED: Duration = Duration::from_secs(10);
/// A checkpoint is due after so many entries, or so long, since the last.
const CHECKPOINT_ENTRIES: u64 = 512;
const CHECKPOINT_AGE: Duration = Duration::from_secs(5);
/// Events of an answer.
const TOLD_EVENTS: usize = 1000;

/// A session that this process has.
pub(super) struct Live {
    pub id: Uuid,
    pub fence: i64,
    session: Mutex<Session>,
    /// Held by whoever pushes: entries are checked, kept and taken in one order.
    turn: tokio::sync::Mutex<Turn>,
    scans: Arc<Semaphore>,
    bytes: Arc<Semaphore>,
    /// Absent where scans may come as they like.
    rate: Option<Mutex<Rate>>,
    /// Sent to when there are events.
    pub news: watch::Sender<()>,
    /// What is in memory is not what the log says any more.
    is_spoilt: AtomicBool,
}

struct Turn {
    /// Entries of the log.
    entries: u64,
    /// Of the last checkpoint.
    checkpoint_entries: u64,
    checkpointed: Instant,
}

impl Live {
    pub fn new(id: Uuid, fence: i64, session: Session, entries: u64, checkpoint: u64) -> Self {
        let per_s = session.scene().rules().max_scans_per_s;
        let rate = per_s.map(|per_s| Mutex::new(Rate::new(per_s, SAVED, Instant::now())));
        Live {
            id,
            fence,
            session: Mutex::new(session),
            turn: tokio::sync::Mutex::new(Turn {
                entries,
                checkpoint_entries: checkpoint,
                checkpointed: Instant::now(),
            }),
            scans: Arc::new(Semaphore::new(QUEUED_SCANS)),
            bytes: Arc::new(Semaphore::new(QUEUED_BYTES)),
            rate,
            news: watch::Sender::new(()),
            is_spoilt: AtomicBool::new(false),
        }
    }

    /// A panic while it was locked has spoilt it, which is noted elsewhere.
    pub fn session(&self) -> MutexGuard<'_, Session> {
        self.session.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub fn is_spoilt(&self) -> bool {
        self.is_spoilt.load(Ordering::Acquire)
    }

    pub fn spoil(&self) {
        self.is_spoilt.store(true, Ordering::Release);
        self.news.send_replace(());
    }

    /// Takes entries, each with the line that it came in: they are on the disk when this returns. All of them are taken, or none.
    ///
    /// # Errors
    /// Faults of the entries; too much that waits; another process that has the session.
    pub async fn push(
        self: &Arc<Self>,
        entries: Vec<(Option<u64>, Entry)>,
        bytes: usize,
        (log, storage): (&Log, &Storage),
    ) -> Result<Pushed, ServiceError> {
        let many = |count: usize, most: usize| u32::try_from(count.clamp(1, most)).unwrap_or(1);
        let scans = self.scans.clone();
        let room = self.bytes.clone();
        let scans = scans.try_acquire_many_owned(many(entries.len(), QUEUED_SCANS));
        let room = room.try_acquire_many_owned(many(bytes, QUEUED_BYTES));
        let (Ok(scans), Ok(room)) = (scans, room) else {
            return Err(ServiceError::SessionFull);
        };
        if !self.may_take(entries.len()) {
            return Err(ServiceError::SessionFull);
        }
        // Once begun it goes on, also when the client goes away: what is on the disk is taken.
        let (live, log, storage) = (self.clone(), log.clone(), storage.clone());
        let work = async move {
            let _held = (scans, room);
            live.take(entries, &log, &storage).await
        };
        let done = tokio::spawn(work).await;
        done.unwrap_or_else(|error| {
            self.spoil();
            Err(ServiceError::Internal(anyhow::Error::from(error)))
        })
    }

    fn may_take(&self, scans: usize) -> bool {
        let Some(rate) = &self.rate else {
            return true;
        };
        let mut rate = rate.lock().unwrap_or_else(PoisonError::into_inner);
        rate.take(scans, Instant::now())
    }

    async fn take(
        self: &Arc<Self>,
        entries: Vec<(Option<u64>, Entry)>,
        log: &Log,
        storage: &Storage,
    ) -> Result<Pushed, ServiceError> {
        let mut turn = self.turn.lock().await;
        if self.is_spoilt() {
            return Err(ServiceError::Unavailable);
        }
        let (new, mut results) = self.check(entries)?;
        let before = self.session().last_event();
        if !new.is_empty() {
            self.keep(&new, &mut turn, log).await?;
            let fates = self.apply(new, storage).await?;
            let is_new = |result: &&mut PushedResult| result.fate != EntryFate::Duplicate;
            for (result, fate) in results.iter_mut().filter(is_new).zip(fates) {
                result.fate = fate;
            }
            self.news.send_replace(());
            if turn.is_due() {
                self.checkpoint(&mut turn, storage).await;
            }
        }
        let session = self.session();
        let last_event = session.last_event();
        let first = before.max(last_event.saturating_sub(TOLD_EVENTS as u64));
        Ok(Pushed {
            scans: results,
            entries: turn.entries,
            processed_to_s: session.processed_to_s(),
            waiting: session.waiting() as u64,
            last_event,
            events: session.events_after(first, TOLD_EVENTS).unwrap_or_default(),
        })
    }

    /// The entries that are new, and what is known of all.
    fn check(
        &self,
        entries: Vec<(Option<u64>, Entry)>,
    ) -> Result<(Vec<Entry>, Vec<PushedResult>), ServiceError> {
        let session = self.session();
        let mut checking = session.checking();
        let (mut new, mut results, mut faults) = (Vec::new(), Vec::new(), Vec::new());
        let is_scan = |(_, entry): &(Option<u64>, Entry)| matches!(entry, Entry::Scan(_));
        if session.is_paused() && entries.iter().any(is_scan) {
            let detail = "the session is paused, and takes no scans until it is resumed";
            return Err(ServiceError::conflict("session_paused", detail));
        }
        for (line, entry) in entries {
            let (sensor_id, sequence) = match &entry {
                Entry::Scan(scan) => (scan.sensor_id.clone(), scan.sequence),
                _ => (String::new(), None),
            };
            let mut result = PushedResult {
                fate: EntryFate::Taken,
                sensor_id,
                sequence,
            };
            match checking.check(entry) {
                Ok(Checked::New(entry)) => {
                    if let Entry::Scan(scan) = &entry {
                        result.sequence = scan.sequence;
                    }
                    new.push(entry);
                }
                Ok(Checked::Duplicate) => result.fate = EntryFate::Duplicate,
                Err(fault) => faults.push(Fault { line, ..fault }),
            }
            results.push(result);
        }
        if faults.is_empty() {
            Ok((new, results))
        } else {
            Err(ServiceError::Invalid(faults))
        }
    }

    async fn keep(&self, new: &[Entry], turn: &mut Turn, log: &Log) -> Result<(), ServiceError> {
        let text = |entry| serde_json::to_string(entry).map_err(anyhow::Error::from);
        let append = LogAppend {
            session: self.id,
            fence: self.fence,
            after: turn.entries,
            entries: new.iter().map(text).collect::<Result<_, _>>()?,
        };
        let count = append.entries.len() as u64;
        match log.append(append).await {
            Ok(true) => turn.entries += count,
            Ok(false) => {
                self.spoil();
                return Err(ServiceError::Unavailable);
            }
            Err(error) => {
                // Nobody knows whether it is there: the log has to be read again.
                self.spoil();
                return Err(error.into());
            }
        }
        Ok(())
    }

    /// Gives the entries to the tracker, on a thread that may take its time.
    async fn apply(
        self: &Arc<Self>,
        new: Vec<Entry>,
        storage: &Storage,
    ) -> Result<Vec<EntryFate>, ServiceError> {
        let live = self.clone();
        let take_all = move || take_all(&mut live.session(), new);
        match tokio::task::spawn_blocking(take_all).await {
            Ok(Ok(fates)) => Ok(fates),
            Err(error) => {
                self.spoil();
                Err(ServiceError::Internal(error.into()))
            }
            Ok(Err(fault)) => {
                self.spoil();
                let end = SessionEnd {
                    fault: Some(json!(fault)),
                    ..SessionEnd::default()
                };
                storage.end_session(self.id, self.fence, &end).await?;
                Err(ServiceError::Invalid(vec![*fault]))
            }
        }
    }

    /// Writes down what the session knows, beside the work.
    async fn checkpoint(self: &Arc<Self>, turn: &mut Turn, storage: &Storage) {
        turn.checkpoint_entries = turn.entries;
        turn.checkpointed = Instant::now();
        let (live, entries) = (self.clone(), turn.entries);
        let written = tokio::task::spawn_blocking(move || live.write_down(entries)).await;
        let Ok(checkpoint) = written else {
            return tracing::warn!("a checkpoint was not written");
        };
        let (live, storage) = (self.clone(), storage.clone());
        tokio::spawn(async move { live.keep_checkpoint(checkpoint, &storage).await });
    }

    fn write_down(&self, entries: u64) -> Checkpoint {
        Checkpoint {
            bytes: self.session().write_down(),
            entries,
            version: VERSION.to_owned(),
        }
    }

    async fn keep_checkpoint(&self, checkpoint: Checkpoint, storage: &Storage) {
        let kept = storage.keep_checkpoint(self.id, self.fence, checkpoint);
        if let Err(error) = kept.await {
            tracing::warn!(error = format!("{error:#}"), "a checkpoint was not kept");
        }
    }

    /// What is known is written down before the process ends.
    pub async fn rest(&self, storage: &Storage) {
        let mut turn = self.turn.lock().await;
        if !self.is_spoilt() && turn.entries > turn.checkpoint_entries {
            turn.checkpoint_entries = turn.entries;
            let checkpoint = self.write_down(turn.entries);
            self.keep_checkpoint(checkpoint, storage).await;
        }
        self.spoil();
    }

    /// Events after a number; `None` where some of them are no longer kept.
    pub fn events(&self, after: u64, most: usize) -> Option<Vec<SessionEvent>> {
        self.session().events_after(after, most)
    }
}

fn take_all(session: &mut Session, new: Vec<Entry>) -> Result<Vec<EntryFate>, Box<Fault>> {
    new.into_iter().map(|entry| session.take(entry)).collect()
}

impl Turn {
    fn is_due(&self) -> bool {
        let since = self.entries - self.checkpoint_entries;
        since >= CHECKPOINT_ENTRIES || (since > 0 && self.checkpointed.elapsed() > CHECKPOINT_AGE)
    }
}
