//! The queue: it says "look at this job now", at least once, to as many handlers as there are slots.
//!
//! Nothing else knows apalis. The queue has a file of its own, and nothing of value is in it: the tables of `storage`
//! know every job, so the file is made anew at each start and the jobs that can run are put in again.

use anyhow::Context;
use apalis::prelude::*;
use apalis_sqlite::queries::push_tasks;
use apalis_sqlite::{Config, SqliteStorage};
use futures::future::BoxFuture;
use serde::{Deserialize, Serialize};
use sqlx::SqlitePool;
use sqlx::sqlite::{SqliteConnectOptions, SqliteJournalMode, SqlitePoolOptions, SqliteSynchronous};
use std::io::ErrorKind;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;
use tokio::task::JoinHandle;
use tokio_util::sync::CancellationToken;
use uuid::Uuid;

/// Looks at one job. An error puts the job into the queue again.
#[derive(Clone)]
pub struct Handler(Arc<dyn Fn(Uuid) -> BoxFuture<'static, anyhow::Result<()>> + Send + Sync>);

impl Handler {
    pub fn new(look: impl Fn(Uuid) -> BoxFuture<'static, anyhow::Result<()>> + Send + Sync + 'static) -> Self {
        Handler(Arc::new(look))
    }

    fn look(&self, job_id: Uuid) -> BoxFuture<'static, anyhow::Result<()>> {
        (self.0)(job_id)
    }
}

const QUEUE: &str = "jobs";
/// A worker whose heartbeat fails this often is taken for dead, and its entries are given to another.
const HEARTBEAT: Duration = Duration::from_secs(5);
const MISSED_HEARTBEATS: usize = 3;
/// Without it an empty queue is only looked at with each heartbeat.
const POLL: Duration = Duration::from_millis(50);
/// A stop may not take longer than it takes for a worker to be called dead.
const STOP_LIMIT: Duration = Duration::from_secs(10);

/// One entry of the queue.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct Entry {
    job_id: Uuid,
}

/// The queue and its worker.
pub struct Engine {
    pool: SqlitePool,
    slots: usize,
    stop: CancellationToken,
    worker: Mutex<Option<JoinHandle<()>>>,
}

impl Engine {
    /// Starts with an empty queue.
    pub async fn open(path: &Path, slots: usize) -> anyhow::Result<Engine> {
        for suffix in ["", "-wal", "-shm"] {
            let file = format!("{}{suffix}", path.display());
            match std::fs::remove_file(&file) {
                Err(error) if error.kind() != ErrorKind::NotFound => return Err(error).with_context(|| format!("cannot remove {file}")),
                _ => {}
            }
        }
        let options = SqliteConnectOptions::new()
            .filename(path)
            .create_if_missing(true)
            .journal_mode(SqliteJournalMode::Wal)
            .synchronous(SqliteSynchronous::Off)
            .busy_timeout(Duration::from_secs(30));
        let pool = SqlitePoolOptions::new().max_connections(4).connect_with(options).await?;
        SqliteStorage::setup(&pool).await.context("cannot set the queue up")?;
        Ok(Engine { pool, slots, stop: CancellationToken::new(), worker: Mutex::new(None) })
    }

    pub async fn enqueue(&self, jobs: &[Uuid]) -> anyhow::Result<()> {
        let tasks = jobs
            .iter()
            .map(|&job_id| Ok(TaskBuilder::new(serde_json::to_vec(&Entry { job_id })?).build()))
            .collect::<anyhow::Result<Vec<_>>>()?;
        let mut transaction = self.pool.begin().await?;
        push_tasks(&mut *transaction, QUEUE, &tasks).await?;
        transaction.commit().await?;
        Ok(())
    }

    /// Starts to call the handler.
    pub fn run(&self, handler: Handler) {
        let worker = tokio::spawn(keep_working(self.pool.clone(), self.slots, handler, self.stop.clone()));
        *self.worker.lock().unwrap_or_else(PoisonError::into_inner) = Some(worker);
    }

    /// Forgets the entries that are done with.
    pub async fn sweep(&self) -> anyhow::Result<()> {
        sqlx::query("DELETE FROM Jobs WHERE status IN ('Done', 'Killed')").execute(&self.pool).await?;
        Ok(())
    }

    /// Takes no more entries and waits for the handlers that run, which must not take long.
    pub async fn stop(&self) {
        self.stop.cancel();
        let worker = self.worker.lock().unwrap_or_else(PoisonError::into_inner).take();
        if let Some(worker) = worker {
            let abort = worker.abort_handle();
            if tokio::time::timeout(STOP_LIMIT, worker).await.is_err() {
                tracing::warn!("the queue's worker did not stop in time");
                abort.abort();
            }
        }
        self.pool.close().await;
    }
}

/// A worker that lost its heartbeat is dead for good; another takes its place under a new name.
async fn keep_working(pool: SqlitePool, slots: usize, handler: Handler, stop: CancellationToken) {
    while !stop.is_cancelled() {
        let config = Config::default().queue(QUEUE).batch_size(slots).heartbeat_interval(HEARTBEAT).missed_heartbeats(MISSED_HEARTBEATS);
        let backend = SqliteStorage::<Entry>::new(&pool).with_config(config).poll_with_interval(POLL);
        let worker = WorkerBuilder::new(Uuid::now_v7().to_string()).backend(backend).data(handler.clone()).concurrency(slots).build(look);
        let stopped = stop.clone();
        let signal = async move {
            stopped.cancelled().await;
            Ok::<(), std::io::Error>(())
        };
        if let Err(error) = worker.run_until(signal).await {
            tracing::error!(%error, "the queue's worker ended; starting another");
            tokio::time::sleep(Duration::from_secs(1)).await;
        }
    }
}

/// The handler runs in a task of its own, so that it lives on when its worker dies.
async fn look(entry: Entry, handler: Data<Handler>) -> Result<(), BoxDynError> {
    tokio::spawn(handler.look(entry.job_id)).await??;
    Ok(())
}
