//! The queue: it says "look at this now", at least once, to as many handlers as there are slots.
//!
//! Nothing else knows apalis. Nothing of value is in the queue: the tables of `storage` know every job and chunk. One process alone has
//! a file for it, made anew at each start; many processes share a schema of their PostgreSQL database, where the entries of one that
//! died are given to another.

use crate::service::storage::{Database, Ready};
use anyhow::Context;
use apalis::prelude::*;
use apalis_postgres::{PgPool, PostgresStorage};
use apalis_sqlite::SqliteStorage;
use futures::future::BoxFuture;
use serde::{Deserialize, Serialize};
use sqlx::SqlitePool;
use sqlx::postgres::PgPoolOptions;
use sqlx::sqlite::{SqliteConnectOptions, SqliteJournalMode, SqlitePoolOptions, SqliteSynchronous};
use std::io::ErrorKind;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError, Weak};
use std::time::Duration;
use tokio::task::JoinHandle;
use tokio_util::sync::CancellationToken;
use uuid::Uuid;

/// Looks at one entry. An error puts it into the queue again.
#[derive(Clone)]
pub struct Handler(Arc<dyn Fn(Entry) -> BoxFuture<'static, anyhow::Result<()>> + Send + Sync>);

impl Handler {
    pub fn new(look: impl Fn(Entry) -> BoxFuture<'static, anyhow::Result<()>> + Send + Sync + 'static) -> Self {
        Handler(Arc::new(look))
    }

    fn look(&self, entry: Entry) -> BoxFuture<'static, anyhow::Result<()>> {
        (self.0)(entry)
    }
}

const QUEUE: &str = "jobs";
/// A worker whose heartbeat fails this often is taken for dead, and its entries are given to another.
const HEARTBEAT: Duration = Duration::from_secs(5);
const MISSED_HEARTBEATS: usize = 3;
/// Without it an empty queue is only looked at with each heartbeat.
const POLL: Duration = Duration::from_millis(50);
/// The same where many workers ask one database.
const SHARED_POLL: Duration = Duration::from_millis(200);
/// A stop may not take longer than it takes for a worker to be called dead.
const STOP_LIMIT: Duration = Duration::from_secs(10);
/// Entries put in at once.
const BATCH: usize = 1000;

/// One entry of the queue: a job, or a chunk of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Entry {
    /// Of this entry alone: one that comes again comes because its worker is dead.
    pub id: Uuid,
    pub job_id: Uuid,
    pub chunk: Option<u32>,
}

#[derive(Clone)]
enum Queue {
    Sqlite(SqlitePool),
    Postgres(PgPool),
}

impl Queue {
    async fn push(&self, ready: &[Ready]) -> anyhow::Result<()> {
        for ready in ready.chunks(BATCH) {
            let tasks = ready.iter().map(task).collect::<anyhow::Result<Vec<_>>>()?;
            match self {
                Queue::Sqlite(pool) => {
                    let mut transaction = pool.begin().await?;
                    apalis_sqlite::queries::push_tasks(&mut *transaction, QUEUE, &tasks).await?;
                    transaction.commit().await?;
                }
                Queue::Postgres(pool) => apalis_postgres::queries::push_tasks(&mut *pool.acquire().await?, QUEUE, tasks).await?,
            }
        }
        Ok(())
    }
}

/// The queue and its worker.
pub struct Engine {
    queue: Queue,
    slots: usize,
    stop: CancellationToken,
    worker: Mutex<Option<JoinHandle<()>>>,
    former: Former,
}

/// A worker's name, and a sign of life of what it began.
type Worker = (String, Weak<()>);

/// Workers of this process, also those that died of a lost connection while what they had begun lives on.
#[derive(Clone, Default)]
struct Former(Arc<Mutex<Vec<Worker>>>);

impl Former {
    fn remember(&self, name: String, life: Weak<()>) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).push((name, life));
    }

    fn alive(&self) -> Vec<String> {
        let mut former = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        former.retain(|(_, life)| life.strong_count() > 0);
        former.iter().map(|(name, _)| name.clone()).collect()
    }
}

impl Engine {
    /// Opens the queue beside these tables. That of one process starts empty.
    ///
    /// # Errors
    /// When the file cannot be made anew, or the database does not let us make a schema.
    pub async fn open(database: &Database, slots: usize) -> anyhow::Result<Engine> {
        let queue = match database {
            Database::Sqlite(tables) => Queue::Sqlite(open_file(&tables.with_file_name("queue.db")).await?),
            Database::Postgres(url) => Queue::Postgres(open_schema(url).await?),
        };
        Ok(Engine { queue, slots, stop: CancellationToken::new(), worker: Mutex::new(None), former: Former::default() })
    }

    pub async fn enqueue(&self, ready: &[Ready]) -> anyhow::Result<()> {
        self.queue.push(ready).await
    }

    /// Starts to call the handler.
    pub fn run(&self, handler: Handler) {
        let worker = tokio::spawn(keep_working(self.queue.clone(), self.slots, handler, self.stop.clone(), self.former.clone()));
        *self.worker.lock().unwrap_or_else(PoisonError::into_inner) = Some(worker);
    }

    /// Says that work lives on although its worker died, so that it is not given to another process. To be called more often than a worker
    /// is called dead.
    pub async fn keep_alive(&self) -> anyhow::Result<()> {
        let (alive, Queue::Postgres(pool)) = (self.former.alive(), &self.queue) else { return Ok(()) };
        if !alive.is_empty() {
            sqlx::query("UPDATE apalis.workers SET last_seen = now() WHERE id = ANY($1)").bind(alive).execute(pool).await?;
        }
        Ok(())
    }

    /// Forgets the entries that are done with.
    pub async fn sweep(&self) -> anyhow::Result<()> {
        match &self.queue {
            Queue::Sqlite(pool) => {
                sqlx::query("DELETE FROM Jobs WHERE status IN ('Done', 'Killed')").execute(pool).await?;
            }
            Queue::Postgres(pool) => {
                sqlx::query("DELETE FROM apalis.jobs WHERE status IN ('Done', 'Killed')").execute(pool).await?;
                sqlx::query("DELETE FROM apalis.workers WHERE last_seen < now() - interval '1 day' AND id NOT IN (SELECT lock_by FROM apalis.jobs WHERE lock_by IS NOT NULL)")
                    .execute(pool)
                    .await?;
            }
        }
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
        match &self.queue {
            Queue::Sqlite(pool) => pool.close().await,
            Queue::Postgres(pool) => pool.close().await,
        }
    }
}

async fn open_file(path: &Path) -> anyhow::Result<SqlitePool> {
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
    Ok(pool)
}

async fn open_schema(url: &str) -> anyhow::Result<PgPool> {
    let pool = PgPoolOptions::new().max_connections(3).acquire_timeout(Duration::from_secs(60)).connect(url).await?;
    PostgresStorage::setup(&pool).await.context(
        "cannot set the queue up: the database's user must be allowed to make a schema and the extension hstore, which is in the \
         package of PostgreSQL's contributed modules",
    )?;
    Ok(pool)
}

/// An entry for no job.
const NOTHING: Ready = Ready { job_id: Uuid::nil(), chunk: None, priority: 0 };

/// More than a campaign has chunks.
const CHUNKS: i64 = 1_000_000;

/// Between entries of one priority and one second the queue knows no order. Of a campaign's chunks the first has to go first: what its
/// runs say so far is told of those without a gap.
fn place(ready: &Ready) -> i64 {
    ready.priority * CHUNKS + (CHUNKS - 1 - i64::from(ready.chunk.unwrap_or(0))).max(0)
}

fn task(ready: &Ready) -> anyhow::Result<Task<Vec<u8>>> {
    let entry = Entry { id: Uuid::now_v7(), job_id: ready.job_id, chunk: ready.chunk };
    Ok(TaskBuilder::new(serde_json::to_vec(&entry)?).priority(usize::try_from(place(ready))?).build())
}

/// A worker that lost its heartbeat is dead for good; another takes its place under a new name, which no other has, so that none is taken
/// for one that died.
async fn keep_working(queue: Queue, slots: usize, handler: Handler, stop: CancellationToken, former: Former) {
    while !stop.is_cancelled() {
        // An empty queue is not looked at a second time before the first heartbeat; after one entry it is.
        if let Err(error) = queue.push(&[NOTHING]).await {
            tracing::warn!(error = format!("{error:#}"), "the queue's worker begins with a wait");
        }
        let (name, life) = (Uuid::now_v7().to_string(), Arc::new(()));
        former.remember(name.clone(), Arc::downgrade(&life));
        let ended = match &queue {
            Queue::Sqlite(pool) => {
                let config = apalis_sqlite::Config::default()
                    .queue(QUEUE)
                    .batch_size(slots)
                    .heartbeat_interval(HEARTBEAT)
                    .missed_heartbeats(MISSED_HEARTBEATS);
                let backend = SqliteStorage::<Entry>::new(pool).with_config(config).poll_with_interval(POLL);
                let worker =
                    WorkerBuilder::new(name).backend(backend).data(handler.clone()).data(Life(life)).concurrency(slots).build(look);
                worker.run_until(stopped(stop.clone())).await
            }
            Queue::Postgres(pool) => {
                let config = apalis_postgres::Config::default()
                    .queue(QUEUE)
                    .batch_size(slots)
                    .heartbeat_interval(HEARTBEAT)
                    .missed_heartbeats(MISSED_HEARTBEATS);
                let backend = PostgresStorage::<Entry>::new(pool).with_config(config).poll_with_interval(SHARED_POLL);
                let worker =
                    WorkerBuilder::new(name).backend(backend).data(handler.clone()).data(Life(life)).concurrency(slots).build(look);
                worker.run_until(stopped(stop.clone())).await
            }
        };
        if let Err(error) = ended {
            tracing::error!(%error, "the queue's worker ended; starting another");
            tokio::time::sleep(Duration::from_secs(1)).await;
        }
    }
}

/// What each handler that a worker began holds.
#[derive(Clone)]
struct Life(#[expect(dead_code, reason = "held, not read")] Arc<()>);

async fn stopped(stop: CancellationToken) -> std::io::Result<()> {
    stop.cancelled().await;
    Ok(())
}

/// The handler runs in a task of its own, so that it lives on when its worker dies.
async fn look(entry: Entry, handler: Data<Handler>, life: Data<Life>) -> Result<(), BoxDynError> {
    if entry.job_id != NOTHING.job_id {
        let looking = handler.look(entry);
        let held = (*life).clone();
        tokio::spawn(async move {
            let _held = held;
            looking.await
        })
        .await??;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use futures::FutureExt;
    use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
    use std::time::Instant;
    use tokio::sync::mpsc;

    fn database(directory: &tempfile::TempDir) -> Database {
        Database::Sqlite(directory.path().join("app.db"))
    }

    fn job(job_id: Uuid) -> Ready {
        Ready { job_id, chunk: None, priority: 0 }
    }

    fn file(engine: &Engine) -> &SqlitePool {
        match &engine.queue {
            Queue::Sqlite(pool) => pool,
            Queue::Postgres(_) => panic!("it is a file"),
        }
    }

    /// Entries that are left; what is done with is acknowledged a moment later.
    async fn swept(engine: &Engine) -> i64 {
        let mut left = i64::MAX;
        for _ in 0..100 {
            engine.sweep().await.unwrap();
            left = sqlx::query_scalar("SELECT count(*) FROM Jobs").fetch_one(file(engine)).await.unwrap();
            if left == 0 {
                break;
            }
            tokio::time::sleep(Duration::from_millis(20)).await;
        }
        left
    }

    fn telling(sender: mpsc::UnboundedSender<Uuid>) -> Handler {
        Handler::new(move |Entry { job_id: id, .. }| {
            let told = sender.send(id).map_err(anyhow::Error::from);
            async move { told }.boxed()
        })
    }

    #[tokio::test(flavor = "multi_thread")]
    async fn an_idle_queue_notices_a_new_entry_at_once_and_stops_quickly() {
        let directory = tempfile::tempdir().unwrap();
        let engine = Engine::open(&database(&directory), 2).await.unwrap();
        let (sender, mut told) = mpsc::unbounded_channel();
        engine.run(telling(sender));
        let (mut quickest, mut slowest) = (Duration::MAX, Duration::ZERO);
        for _ in 0..5 {
            tokio::time::sleep(Duration::from_millis(120)).await;
            let (id, since) = (Uuid::now_v7(), Instant::now());
            engine.enqueue(&[job(id)]).await.unwrap();
            assert_eq!(told.recv().await, Some(id));
            let took = since.elapsed();
            (quickest, slowest) = (quickest.min(took), slowest.max(took));
        }
        assert!(quickest < 2 * POLL, "{quickest:?}");
        assert!(slowest < HEARTBEAT / 2, "the first does not wait for a heartbeat: {slowest:?}");
        assert_eq!(swept(&engine).await, 0, "entries that are done with are forgotten");
        let since = Instant::now();
        engine.stop().await;
        assert!(since.elapsed() < Duration::from_secs(1), "{:?}", since.elapsed());
    }

    #[tokio::test(flavor = "multi_thread")]
    async fn a_worker_that_lost_its_heartbeat_is_replaced() {
        let directory = tempfile::tempdir().unwrap();
        let engine = Engine::open(&database(&directory), 1).await.unwrap();
        let (sender, mut told) = mpsc::unbounded_channel();
        engine.run(telling(sender));
        tokio::time::sleep(Duration::from_millis(500)).await;
        // Its entries name the worker.
        assert_eq!(swept(&engine).await, 0);
        assert_eq!(sqlx::query("DELETE FROM Workers").execute(file(&engine)).await.unwrap().rows_affected(), 1);
        tokio::time::sleep(HEARTBEAT + Duration::from_secs(2)).await;
        let names: Vec<String> = sqlx::query_scalar("SELECT id FROM Workers").fetch_all(file(&engine)).await.unwrap();
        assert_eq!(names.len(), 1, "another worker has taken over");
        let id = Uuid::now_v7();
        engine.enqueue(&[job(id)]).await.unwrap();
        assert_eq!(tokio::time::timeout(Duration::from_secs(5), told.recv()).await.unwrap(), Some(id));
        engine.stop().await;
    }

    #[tokio::test(flavor = "multi_thread")]
    async fn no_more_handlers_run_than_there_are_slots_and_a_failed_one_is_called_again() {
        let directory = tempfile::tempdir().unwrap();
        let engine = Engine::open(&database(&directory), 2).await.unwrap();
        let (sender, mut told) = mpsc::unbounded_channel();
        let running = Arc::new(AtomicUsize::new(0));
        let failed = Arc::new(AtomicBool::new(false));
        engine.run(Handler::new(move |Entry { job_id: id, .. }| {
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
        engine.enqueue(&ids.iter().copied().map(job).collect::<Vec<_>>()).await.unwrap();
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

    #[test]
    fn the_first_chunk_goes_first_and_what_is_more_urgent_before_it() {
        let chunk = |priority, number| Ready { chunk: Some(number), priority, ..job(Uuid::nil()) };
        let ready =
            [Ready { priority: 100, ..job(Uuid::nil()) }, chunk(90, 0), chunk(90, 1), chunk(90, 9_999), chunk(80, 0), chunk(0, u32::MAX)];
        let places: Vec<i64> = ready.iter().map(place).collect();
        assert!(places.is_sorted_by(|before, after| before > after), "{places:?}");
        assert!(places.iter().all(|place| i32::try_from(*place).is_ok()), "the queue keeps 32 bits: {places:?}");
    }

    #[tokio::test(flavor = "multi_thread")]
    async fn the_urgent_goes_first() {
        let directory = tempfile::tempdir().unwrap();
        let engine = Engine::open(&database(&directory), 1).await.unwrap();
        let ids: Vec<Uuid> = (0..5).map(|_| Uuid::now_v7()).collect();
        let ready: Vec<Ready> = ids.iter().zip([3, 50, 4, 100, 0]).map(|(&id, priority)| Ready { priority, ..job(id) }).collect();
        engine.enqueue(&ready).await.unwrap();
        let (sender, mut told) = mpsc::unbounded_channel();
        engine.run(telling(sender));
        let mut seen = Vec::new();
        while seen.len() < ids.len() {
            seen.push(told.recv().await.unwrap());
        }
        assert_eq!(seen, [ids[3], ids[1], ids[2], ids[0], ids[4]]);
        engine.stop().await;
    }
}
