//! Live sessions: made, fed, asked, closed. A session lives in one process at a time; its log in the tables is the truth.

mod ending;
mod hand;
mod live;
mod log;
mod picture;
mod recording;
mod table;
mod told;

use super::datasets::Datasets;
use super::error::{ServiceError, cursor_of};
use super::storage::{Lease, NewSession, Page, Paging, Storage, StoredSession};
use super::types::{
    LiveTracks, Pushed, SessionEvents, SessionInfo, SessionPage, SessionState, TrackHistory,
};
use crate::experiment::session::{Entry, Scene, Session, SessionEvent, is_over, read_scan};
use crate::model::fault::Fault;
use crate::service::build_info::VERSION;
use crate::service::monitoring;
use anyhow::Context;
use ending::Ending;
use futures::{Stream, stream};
use jiff::Timestamp;
use live::Live;
use log::Log;
use serde_json::Value;
use std::collections::HashMap;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::time::Duration;
use tokio_util::sync::CancellationToken;
use told::{info, told_of};
use uuid::Uuid;

/// Sessions that one process has open.
const MOST_OPEN: usize = 256;
/// How often a process says that it still has its sessions.
const RENEWAL: Duration = Duration::from_secs(3);
/// Events that are sent at once.
const EVENTS_AT_ONCE: usize = 500;

/// The sessions of one process.
pub struct Sessions {
    storage: Storage,
    datasets: Arc<Datasets>,
    log: Log,
    /// Where others reach this process, once it listens.
    address: OnceLock<String>,
    live: Mutex<HashMap<Uuid, Arc<Live>>>,
    /// Held while a session is read from its log.
    opening: tokio::sync::Mutex<()>,
    ending: Ending,
    closing: CancellationToken,
}

impl Sessions {
    pub fn new(storage: Storage, datasets: Arc<Datasets>, closing: CancellationToken) -> Arc<Self> {
        let sessions = Arc::new(Sessions {
            log: Log::start(storage.clone()),
            storage,
            datasets,
            address: OnceLock::new(),
            live: Mutex::default(),
            opening: tokio::sync::Mutex::default(),
            ending: Ending::default(),
            closing,
        });
        let (weak, closing) = (Arc::downgrade(&sessions), sessions.closing.clone());
        tokio::spawn(async move {
            loop {
                tokio::select! {
                    () = tokio::time::sleep(RENEWAL) => {}
                    () = closing.cancelled() => return,
                }
                let Some(sessions) = weak.upgrade() else {
                    return;
                };
                sessions.renew().await;
            }
        });
        sessions
    }

    /// Says where others reach this process, which does not change.
    pub fn are_reached_at(&self, url: String) {
        self.address.get_or_init(|| url);
    }

    async fn renew(&self) {
        let is_idle = self.all_live().is_empty();
        if is_idle || !self.storage.is_shared() {
            return;
        }
        if let Err(error) = self.storage.renew_sessions().await {
            tracing::warn!(
                error = format!("{error:#}"),
                "sessions were not kept for this process"
            );
        }
    }

    fn all_live(&self) -> Vec<Arc<Live>> {
        let live = self.live.lock().unwrap_or_else(PoisonError::into_inner);
        live.values().cloned().collect()
    }

    /// Tells the monitoring how the sessions of this process stand.
    pub fn count(&self) {
        let (mut waiting, mut lag_s, mut tracks) = (0, 0.0_f64, 0);
        let all = self.all_live();
        for live in &all {
            let session = live.session();
            waiting += session.waiting();
            lag_s = lag_s.max(session.lag_s().unwrap_or_default());
            tracks += session.count_tracks().0;
        }
        metrics::gauge!(monitoring::SESSIONS).set(all.len() as f64);
        metrics::gauge!(monitoring::SESSION_TRACKS).set(tracks as f64);
        metrics::gauge!(monitoring::SESSION_WAITING).set(waiting as f64);
        metrics::gauge!(monitoring::SESSION_LAG).set(lag_s);
    }

    /// Writes down what is open, and gives it back.
    pub async fn shutdown(&self) {
        let all = self.all_live();
        for live in &all {
            live.rest(&self.storage).await;
        }
        // What one process has for itself need not be given back.
        if all.is_empty() || !self.storage.is_shared() {
            return;
        }
        if let Err(error) = self.storage.release_sessions().await {
            tracing::warn!(error = format!("{error:#}"), "sessions were not given back");
        }
    }

    /// Makes a session.
    pub async fn create(&self, body: &Value) -> Result<SessionInfo, ServiceError> {
        if self.closing.is_cancelled() {
            return Err(ServiceError::ShuttingDown);
        }
        let scene = Scene::plan(body).map_err(ServiceError::Invalid)?;
        let mut spec = scene.spec;
        let mut taken = |name: &str| {
            spec.as_object_mut()
                .and_then(|spec| spec.shift_remove(name))
        };
        let name = taken("name").and_then(|name| name.as_str().map(str::to_owned));
        let labels = taken("labels").and_then(|labels| serde_json::from_value(labels).ok());
        let new = NewSession {
            name,
            labels: labels.unwrap_or_default(),
            spec,
        };
        let id = self.storage.add_session(&new).await?;
        self.get(id).await
    }

    pub async fn get(&self, id: Uuid) -> Result<SessionInfo, ServiceError> {
        let stored = self.stored(id).await?;
        let is_open = stored.state == SessionState::Open && !self.is_ending(id);
        let live = if is_open {
            Some(self.open(&stored).await?)
        } else {
            None
        };
        Ok(SessionInfo {
            live: live.map(|live| told_of(&live.session())),
            ..info(stored)
        })
    }

    pub async fn list(&self, paging: &Paging) -> Result<SessionPage, ServiceError> {
        let after = cursor_of(paging)?;
        let Page {
            items,
            next_cursor,
            total,
        } = self.storage.sessions(paging, after).await?;
        Ok(SessionPage {
            items: items
                .into_iter()
                .map(|stored| self.listed(stored))
                .collect(),
            next_cursor,
            total,
        })
    }

    /// With how it stands, where this process has it in memory.
    fn listed(&self, stored: StoredSession) -> SessionInfo {
        let live = self.in_memory(stored.id);
        SessionInfo {
            live: live.map(|live| told_of(&live.session())),
            ..info(stored)
        }
    }

    async fn stored(&self, id: Uuid) -> Result<StoredSession, ServiceError> {
        let stored = self.storage.session(id).await?;
        let stored = stored.ok_or(ServiceError::NotFound("session"))?;
        if stored.deleted {
            return Err(ServiceError::Gone("session"));
        }
        Ok(stored)
    }

    /// Those that have reached the age or the size at which they are to be closed.
    pub async fn over(&self) -> anyhow::Result<Vec<Uuid>> {
        let mut over = self.storage.open_sessions().await?;
        let now = Timestamp::now();
        over.retain(|stored| {
            let age_s = now.duration_since(stored.created_at).as_secs_f64();
            is_over(&stored.spec, age_s, stored.log_bytes)
        });
        Ok(over.into_iter().map(|stored| stored.id).collect())
    }

    /// The session in the memory of this process, where it is, or from its log.
    async fn live(&self, id: Uuid) -> Result<Arc<Live>, ServiceError> {
        if let Some(live) = self.in_memory(id) {
            return Ok(live);
        }
        let stored = self.stored(id).await?;
        if stored.state != SessionState::Open {
            let detail = format!("the session is {}", stored.state.name());
            return Err(ServiceError::conflict("session_closed", detail));
        }
        self.open(&stored).await
    }

    fn in_memory(&self, id: Uuid) -> Option<Arc<Live>> {
        let mut all = self.live.lock().unwrap_or_else(PoisonError::into_inner);
        let live = all.get(&id).cloned()?;
        if live.is_spoilt() {
            all.remove(&id);
            return None;
        }
        Some(live)
    }

    async fn open(&self, stored: &StoredSession) -> Result<Arc<Live>, ServiceError> {
        if let Some(live) = self.in_memory(stored.id) {
            return Ok(live);
        }
        let _one_at_a_time = self.opening.lock().await;
        if let Some(live) = self.in_memory(stored.id) {
            return Ok(live);
        }
        if self.closing.is_cancelled() {
            return Err(ServiceError::ShuttingDown);
        }
        if self.is_ending(stored.id) {
            let detail = "the session is being closed";
            return Err(ServiceError::conflict("session_closed", detail));
        }
        if self.all_live().len() >= MOST_OPEN {
            return Err(ServiceError::SessionFull);
        }
        let fence = match self.lease(stored.id).await? {
            Lease::Ours { fence } => fence,
            Lease::Theirs { address } => {
                let there = address.unwrap_or_else(|| "another process".to_owned());
                let detail = format!("the session is served by {there}; ask there");
                return Err(ServiceError::conflict("session_elsewhere", detail));
            }
        };
        let live = Arc::new(self.read_back(stored, fence).await?);
        let mut all = self.live.lock().unwrap_or_else(PoisonError::into_inner);
        all.insert(stored.id, live.clone());
        Ok(live)
    }

    async fn lease(&self, id: Uuid) -> anyhow::Result<Lease> {
        let address = self.address.get().map_or("", String::as_str);
        self.storage.lease_session(id, address).await
    }

    /// From the checkpoint and the entries since; from all entries where another version wrote the checkpoint.
    async fn read_back(&self, stored: &StoredSession, fence: i64) -> Result<Live, ServiceError> {
        let scene = Arc::new(Scene::plan(&stored.spec).map_err(ServiceError::Invalid)?);
        let checkpoint = self.storage.checkpoint(stored.id).await?;
        let (mut session, mut from) = (Session::new(scene.clone()), 0);
        if let Some(checkpoint) = checkpoint {
            let read = Session::read_back(scene, &checkpoint.bytes);
            match read.ok().filter(|_| checkpoint.version == VERSION) {
                Some(read) => (session, from) = (read, checkpoint.entries),
                None => tracing::warn!(
                    session = %stored.id,
                    version = checkpoint.version,
                    "the checkpoint is of another version: the whole log is read"
                ),
            }
        }
        let read = self.read_log(stored.id, from, session, take_into);
        let (session, entries) = read.await?;
        tracing::info!(session = %stored.id, from, entries, "a session was read from its log");
        Ok(Live::new(stored.id, fence, session, entries, from))
    }

    /// Gives each entry of a log after a position to `take`, on threads that may take their time; tells how many entries there are.
    async fn read_log<T: Send + 'static>(
        &self,
        id: Uuid,
        after: u64,
        mut reader: T,
        take: fn(&mut T, Entry) -> Result<(), ServiceError>,
    ) -> Result<(T, u64), ServiceError> {
        let mut entries = after;
        loop {
            let page = self.storage.log_page(id, entries).await?;
            if page.is_empty() {
                return Ok((reader, entries));
            }
            entries += page.len() as u64;
            let work = move || take_page(reader, &page, take);
            let taken = tokio::task::spawn_blocking(work).await;
            reader = taken.context("reading a log panicked")??;
        }
    }

    /// Takes scans: one, or those of several lines.
    pub async fn push(
        &self,
        id: Uuid,
        scans: &[(Option<u64>, Value)],
        bytes: usize,
    ) -> Result<Pushed, ServiceError> {
        let live = self.live(id).await?;
        let scene = live.session().scene().clone();
        let (mut entries, mut faults) = (Vec::with_capacity(scans.len()), Vec::new());
        for (line, value) in scans {
            match read_scan(value, &scene) {
                Ok(scan) => entries.push((*line, Entry::Scan(scan))),
                Err(found) => faults.extend(found.into_iter().map(|fault| Fault {
                    line: *line,
                    ..fault
                })),
            }
        }
        if !faults.is_empty() {
            return Err(ServiceError::Invalid(faults));
        }
        live.push(entries, bytes, (&self.log, &self.storage)).await
    }

    pub async fn tracks(&self, id: Uuid, at_s: Option<f64>) -> Result<LiveTracks, ServiceError> {
        let live = self.live(id).await?;
        let session = live.session();
        Ok(LiveTracks {
            processed_to_s: session.processed_to_s(),
            last_event: session.last_event(),
            tracks: session.tracks(at_s),
        })
    }

    pub async fn history(&self, id: Uuid, track_id: &str) -> Result<TrackHistory, ServiceError> {
        let live = self.live(id).await?;
        let history = live.session().history(track_id);
        history.ok_or(ServiceError::NotFound("living track"))
    }

    /// Events after a number; with none yet it waits for some.
    pub async fn events(
        &self,
        id: Uuid,
        after: u64,
        patience: Duration,
    ) -> Result<SessionEvents, ServiceError> {
        let live = self.live(id).await?;
        let mut news = live.news.subscribe();
        let mut items = events_after(&live, after)?;
        if items.is_empty() && !patience.is_zero() {
            // Whether there was news or not, what there is is told.
            let _ = tokio::time::timeout(patience, news.changed()).await;
            items = events_after(&live, after)?;
        }
        let last_event = live.session().last_event();
        Ok(SessionEvents { items, last_event })
    }

    /// Events after a number as they come. It ends with the session, and where its reader is so slow that events are no longer kept.
    pub async fn follow(
        &self,
        id: Uuid,
        after: u64,
    ) -> Result<impl Stream<Item = SessionEvent> + Send + use<>, ServiceError> {
        let live = self.live(id).await?;
        let news = live.news.subscribe();
        events_after(&live, after)?;
        let from = (
            live,
            news,
            after,
            Vec::new().into_iter(),
            self.closing.clone(),
        );
        Ok(stream::unfold(
            from,
            |(live, mut news, after, mut ready, closing)| async move {
                loop {
                    let next: Option<SessionEvent> = ready.next();
                    if let Some(event) = next {
                        let id = event.id;
                        return Some((event, (live, news, id, ready, closing)));
                    }
                    news.borrow_and_update();
                    ready = live.events(after, EVENTS_AT_ONCE)?.into_iter();
                    if ready.len() > 0 {
                        continue;
                    }
                    if live.is_spoilt() {
                        return None;
                    }
                    tokio::select! {
                        changed = news.changed() => changed.ok()?,
                        () = closing.cancelled() => return None,
                    }
                }
            },
        ))
    }

    /// Deletes a session with its log; what was made of it stays.
    pub async fn delete(&self, id: Uuid) -> Result<(), ServiceError> {
        let stored = self.stored(id).await?;
        if stored.state == SessionState::Open {
            self.open(&stored).await?.spoil();
        }
        Ok(self.storage.delete_session(id).await?)
    }
}

fn take_page<T>(
    mut reader: T,
    page: &[String],
    take: fn(&mut T, Entry) -> Result<(), ServiceError>,
) -> Result<T, ServiceError> {
    for text in page {
        let entry = serde_json::from_str(text).context("an entry of a log")?;
        take(&mut reader, entry)?;
    }
    Ok(reader)
}

fn take_into(session: &mut Session, entry: Entry) -> Result<(), ServiceError> {
    let taken = session.take(entry);
    taken.map_err(|fault| ServiceError::Invalid(vec![*fault]))?;
    Ok(())
}

fn events_after(live: &Live, after: u64) -> Result<Vec<SessionEvent>, ServiceError> {
    let events = live.events(after, EVENTS_AT_ONCE);
    events.ok_or(ServiceError::Gone("event, or one after it,"))
}
