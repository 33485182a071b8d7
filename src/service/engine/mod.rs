//! The queue: it says "look at this now", at least once, to as many handlers as there are slots.
//!
//! Nothing of value is in it: the tables of `storage` know every job and chunk. One process alone has its queue in memory, filled anew at
//! each start; many processes share a table of their PostgreSQL database, where the entries of one that died are given to another.
//! Whoever waits for an entry is woken by what is put in, here by a sign in memory and elsewhere by a notice of the database.

mod local;
mod shared;
#[cfg(test)]
mod tests;

use crate::service::storage::{Database, Ready};
use futures::future::BoxFuture;
use local::Local;
use shared::Shared;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;
use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use tokio::task::JoinHandle;
use tokio_util::sync::CancellationToken;
use tokio_util::task::TaskTracker;
use uuid::Uuid;

/// Looks at one entry. An error puts it into the queue again.
#[derive(Clone)]
pub struct Handler(Arc<dyn Fn(Entry) -> BoxFuture<'static, anyhow::Result<()>> + Send + Sync>);

impl Handler {
    pub fn new(
        look: impl Fn(Entry) -> BoxFuture<'static, anyhow::Result<()>> + Send + Sync + 'static,
    ) -> Self {
        Handler(Arc::new(look))
    }

    fn look(&self, entry: Entry) -> BoxFuture<'static, anyhow::Result<()>> {
        (self.0)(entry)
    }
}

/// An entry whose handler failed, or a queue that does not answer, is tried again after this.
const PAUSE: Duration = Duration::from_secs(1);
/// A stop may not take longer than it takes for a worker to be called dead.
const STOP_LIMIT: Duration = Duration::from_secs(10);

/// One entry of the queue: a job, or a chunk of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Entry {
    /// Of this entry alone: one that comes again comes because its worker is dead.
    pub id: Uuid,
    pub job_id: Uuid,
    pub chunk: Option<u32>,
}

impl Entry {
    fn new(ready: &Ready) -> Entry {
        Entry {
            id: Uuid::now_v7(),
            job_id: ready.job_id,
            chunk: ready.chunk,
        }
    }
}

#[derive(Clone)]
enum Queue {
    Local(Local),
    Shared(Arc<Shared>),
}

impl Queue {
    async fn push(&self, ready: &[Ready]) -> anyhow::Result<()> {
        match self {
            Queue::Local(queue) => {
                queue.push(ready);
                Ok(())
            }
            Queue::Shared(queue) => queue.push(ready).await,
        }
    }

    /// The next entry, as soon as there is one.
    async fn next(&self) -> (Entry, i64) {
        match self {
            Queue::Local(queue) => queue.next().await,
            Queue::Shared(queue) => queue.next().await,
        }
    }

    /// The entry is done with.
    async fn finish(&self, entry: Entry) {
        if let Queue::Shared(queue) = self {
            queue.answer(entry.id, true).await;
        }
    }

    async fn give_back(&self, entry: Entry, place: i64) {
        match self {
            Queue::Local(queue) => queue.give_back(entry, place),
            Queue::Shared(queue) => queue.answer(entry.id, false).await,
        }
    }
}

/// The queue and its worker.
pub struct Engine {
    queue: Queue,
    slots: usize,
    stop: CancellationToken,
    tasks: TaskTracker,
    worker: Mutex<Option<JoinHandle<()>>>,
}

impl Engine {
    /// Opens the queue of these tables. That of one process starts empty.
    ///
    /// # Errors
    /// When the database does not answer.
    pub async fn open(database: &Database, slots: usize) -> anyhow::Result<Engine> {
        let queue = match database {
            Database::Sqlite(tables) => {
                local::remove_former_file(tables);
                Queue::Local(Local::default())
            }
            Database::Postgres(url) => Queue::Shared(Arc::new(Shared::open(url).await?)),
        };
        Ok(Engine {
            queue,
            slots,
            stop: CancellationToken::new(),
            tasks: TaskTracker::new(),
            worker: Mutex::new(None),
        })
    }

    /// Puts entries in, but for those that wait there already.
    pub async fn enqueue(&self, ready: &[Ready]) -> anyhow::Result<()> {
        self.queue.push(ready).await
    }

    /// Something was put in by another process, or may have been.
    pub fn wake(&self) {
        if let Queue::Shared(queue) = &self.queue {
            queue.wake();
        }
    }

    /// Starts to call the handler.
    pub fn run(&self, handler: Handler) {
        if let Queue::Shared(queue) = &self.queue {
            tokio::spawn(shared::stay_alive(queue.clone(), self.stop.clone()));
        }
        let working = Working {
            queue: self.queue.clone(),
            handler,
            stop: self.stop.clone(),
            tasks: self.tasks.clone(),
        };
        let worker = tokio::spawn(working.keep_working(self.slots));
        *self.worker.lock().unwrap_or_else(PoisonError::into_inner) = Some(worker);
    }

    /// Takes no more entries and waits for the handlers that run, which must not take long.
    pub async fn stop(&self) {
        self.stop.cancel();
        let worker = self
            .worker
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .take();
        self.tasks.close();
        let ended = async {
            if let Some(worker) = worker {
                // It has seen the stop, or died of a panic that its task has told of.
                let _ = worker.await;
            }
            self.tasks.wait().await;
        };
        let have_ended = tokio::time::timeout(STOP_LIMIT, ended).await.is_ok();
        if !have_ended {
            tracing::warn!("the queue's handlers did not stop in time");
        }
        if let Queue::Shared(queue) = &self.queue {
            queue.close(have_ended).await;
        }
    }
}

/// What takes entries and calls the handler.
struct Working {
    queue: Queue,
    handler: Handler,
    stop: CancellationToken,
    tasks: TaskTracker,
}

impl Working {
    /// An entry is taken when a slot is free for it, so that none waits here which another process could take.
    async fn keep_working(self, slots: usize) {
        let free = Arc::new(Semaphore::new(slots));
        loop {
            let next = async {
                let permit = free.clone().acquire_owned().await.ok()?;
                Some((permit, self.queue.next().await))
            };
            let next = tokio::select! {
                () = self.stop.cancelled() => return,
                next = next => next,
            };
            let Some((permit, (entry, place))) = next else {
                return;
            };
            let work = work(
                self.queue.clone(),
                self.handler.clone(),
                self.stop.clone(),
                entry,
                place,
                permit,
            );
            self.tasks.spawn(work);
        }
    }
}

/// Calls the handler; a panic of it is an error like any other.
async fn work(
    queue: Queue,
    handler: Handler,
    stop: CancellationToken,
    entry: Entry,
    place: i64,
    permit: OwnedSemaphorePermit,
) {
    let error = match tokio::spawn(handler.look(entry)).await {
        Ok(Ok(())) => None,
        Ok(Err(error)) => Some(error),
        Err(panicked) => Some(panicked.into()),
    };
    match error {
        None => queue.finish(entry).await,
        Some(error) => {
            if !stop.is_cancelled() {
                tracing::warn!(job_id = %entry.job_id, error = format!("{error:#}"), "work was not done; trying again");
            }
            // The slot stays taken meanwhile: where everything fails, nothing is tried in a rush.
            tokio::select! {
                () = tokio::time::sleep(PAUSE) => {}
                () = stop.cancelled() => {}
            }
            queue.give_back(entry, place).await;
        }
    }
    drop(permit);
}

/// More than a campaign has chunks.
const CHUNKS: i64 = 1_000_000;

/// Where an entry stands; greater goes first, and of two the older. Of a campaign's chunks the first has to go first: what its runs say
/// so far is told of those without a gap.
fn place(ready: &Ready) -> i64 {
    ready.priority * CHUNKS + (CHUNKS - 1 - i64::from(ready.chunk.unwrap_or(0))).max(0)
}
