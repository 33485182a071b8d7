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

#[cfg(test)]
mod tests {
    use super::*;
    use futures::FutureExt;
    use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
    use std::time::Instant;
    use tokio::sync::mpsc;

    fn telling(sender: mpsc::UnboundedSender<Uuid>) -> Handler {
        Handler::new(move |id| {
            let told = sender.send(id).map_err(anyhow::Error::from);
            async move { told }.boxed()
        })
    }

    #[tokio::test(flavor = "multi_thread")]
    async fn an_idle_queue_notices_a_new_entry_at_once_and_stops_quickly() {
        let directory = tempfile::tempdir().unwrap();
        let engine = Engine::open(&directory.path().join("queue.db"), 2).await.unwrap();
        let (sender, mut told) = mpsc::unbounded_channel();
        engine.run(telling(sender));
        let mut quickest = Duration::MAX;
        for _ in 0..5 {
            tokio::time::sleep(Duration::from_millis(120)).await;
            let (id, since) = (Uuid::now_v7(), Instant::now());
            engine.enqueue(&[id]).await.unwrap();
            assert_eq!(told.recv().await, Some(id));
            quickest = quickest.min(since.elapsed());
        }
        assert!(quickest < 2 * POLL, "{quickest:?}");
        engine.sweep().await.unwrap();
        let since = Instant::now();
        engine.stop().await;
        assert!(since.elapsed() < Duration::from_secs(1), "{:?}", since.elapsed());
    }

    #[tokio::test(flavor = "multi_thread")]
    async fn a_worker_that_lost_its_heartbeat_is_replaced() {
        let directory = tempfile::tempdir().unwrap();
        let engine = Engine::open(&directory.path().join("queue.db"), 1).await.unwrap();
        let (sender, mut told) = mpsc::unbounded_channel();
        engine.run(telling(sender));
        tokio::time::sleep(Duration::from_millis(500)).await;
        assert_eq!(sqlx::query("DELETE FROM Workers").execute(&engine.pool).await.unwrap().rows_affected(), 1);
        tokio::time::sleep(HEARTBEAT + Duration::from_secs(2)).await;
        let names: Vec<String> = sqlx::query_scalar("SELECT id FROM Workers").fetch_all(&engine.pool).await.unwrap();
        assert_eq!(names.len(), 1, "another worker has taken over");
        let id = Uuid::now_v7();
        engine.enqueue(&[id]).await.unwrap();
        assert_eq!(tokio::time::timeout(Duration::from_secs(5), told.recv()).await.unwrap(), Some(id));
        engine.stop().await;
    }

    #[tokio::test(flavor = "multi_thread")]
    async fn no_more_handlers_run_than_there_are_slots_and_a_failed_one_is_called_again() {
        let directory = tempfile::tempdir().unwrap();
        let engine = Engine::open(&directory.path().join("queue.db"), 2).await.unwrap();
        let (sender, mut told) = mpsc::unbounded_channel();
        let running = Arc::new(AtomicUsize::new(0));
        let failed = Arc::new(AtomicBool::new(false));
        engine.run(Handler::new(move |id| {
            let (sender, running, failed) = (sender.clone(), running.clone(), failed.clone());
            async move {
                let at_once = running.fetch_add(1, Ordering::SeqCst) + 1;
                tokio::time::sleep(Duration::from_millis(30)).await;
                running.fetch_sub(1, Ordering::SeqCst);
                anyhow::ensure!(failed.swap(true, Ordering::SeqCst), "the first call fails");
                Ok(sender.send((id, at_once))?)
            }
            .boxed()
        }));
        let ids: Vec<Uuid> = (0..10).map(|_| Uuid::now_v7()).collect();
        engine.enqueue(&ids).await.unwrap();
        let (mut seen, mut most) = (Vec::new(), 0);
        while seen.len() < ids.len() {
            let (id, at_once) = told.recv().await.unwrap();
            seen.push(id);
            most = most.max(at_once);
        }
        seen.sort();
        assert_eq!((seen, most), (ids, 2));
        engine.stop().await;
    }
}
