//! The queue of many processes: a table of their database. An entry is given to one worker, and to another when that one is dead.

use super::{Entry, PAUSE, place};
use crate::service::storage::Ready;
use crate::service::storage::notices::QUEUE_CHANNEL;
use anyhow::Context;
use sqlx::Row;
use sqlx::postgres::{PgPool, PgPoolOptions};
use std::collections::HashSet;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};
use tokio::sync::Notify;
use tokio_util::sync::CancellationToken;
use uuid::Uuid;

/// A worker says so often that it lives, and is taken for dead when it has missed three of these.
const HEARTBEAT: Duration = Duration::from_secs(5);
const LEASE: Duration = HEARTBEAT.saturating_mul(3);
/// The table is looked at so often although nobody told of an entry, in case a notice was lost.
const LOOK: Duration = Duration::from_secs(1);
/// Entries put in at once.
const BATCH: usize = 1000;
/// The queue waits longer than a request does: nobody waits for its answer.
const PATIENCE: Duration = Duration::from_secs(60);
const CONNECTIONS: u32 = 3;
/// Whoever stops does not wait for a database that is away.
const GOODBYE: Duration = Duration::from_secs(1);

/// This process's end of the queue.
pub(super) struct Shared {
    pool: PgPool,
    /// A name that no other worker ever has.
    worker: String,
    news: Notify,
    known: Mutex<Known>,
}

/// What the table has to agree with.
#[derive(Default)]
struct Known {
    /// Entries that this worker took and has not answered.
    held: HashSet<Uuid>,
    /// Answers that the table may not have yet: an entry, and whether it is done with.
    answers: Vec<(Uuid, bool)>,
    /// An entry may have been given to this worker without its hearing of it.
    may_have_more: bool,
}

impl Shared {
    pub async fn open(url: &str) -> anyhow::Result<Shared> {
        let pool = PgPoolOptions::new()
            .max_connections(CONNECTIONS)
            .acquire_timeout(PATIENCE)
            .connect_lazy(url)?;
        let queue = Shared {
            pool,
            worker: Uuid::now_v7().to_string(),
            news: Notify::new(),
            known: Mutex::default(),
        };
        queue.beat().await.context("cannot use the queue")?;
        Ok(queue)
    }

    pub fn wake(&self) {
        self.news.notify_one();
    }

    pub async fn push(&self, ready: &[Ready]) -> anyhow::Result<()> {
        for ready in ready.chunks(BATCH) {
            let entries: Vec<Entry> = ready.iter().map(Entry::new).collect();
            let mut transaction = self.pool.begin().await?;
            sqlx::query(
                "INSERT INTO queue (id, job_id, chunk, place)
                 SELECT added.* FROM unnest($1::text[], $2::text[], $3::bigint[], $4::bigint[]) AS added (id, job_id, chunk, place)
                 WHERE NOT EXISTS (SELECT 1 FROM queue WHERE queue.job_id = added.job_id AND worker IS NULL
                     AND queue.chunk IS NOT DISTINCT FROM added.chunk)",
            )
            .bind(entries.iter().map(|entry| entry.id.to_string()).collect::<Vec<_>>())
            .bind(entries.iter().map(|entry| entry.job_id.to_string()).collect::<Vec<_>>())
            .bind(entries.iter().map(|entry| entry.chunk.map(i64::from)).collect::<Vec<_>>())
            .bind(ready.iter().map(place).collect::<Vec<_>>())
            .execute(&mut *transaction)
            .await?;
            sqlx::query("SELECT pg_notify($1, '')")
                .bind(QUEUE_CHANNEL)
                .execute(&mut *transaction)
                .await?;
            transaction.commit().await?;
        }
        // Its own notice comes as well, but later.
        self.wake();
        Ok(())
    }

    /// For one caller at a time.
    pub async fn next(&self) -> (Entry, i64) {
        loop {
            match self.take().await {
                Ok(Some(taken)) => return taken,
                Ok(None) => {
                    // The time being up is as good as a notice.
                    let _ = tokio::time::timeout(LOOK, self.news.notified()).await;
                }
                Err(error) => {
                    tracing::warn!(
                        error = format!("{error:#}"),
                        "the queue was not read; trying again"
                    );
                    self.known().may_have_more = true;
                    tokio::time::sleep(PAUSE).await;
                }
            }
        }
    }

    async fn take(&self) -> anyhow::Result<Option<(Entry, i64)>> {
        if self.known().may_have_more {
            self.put_back_unknown().await?;
            self.known().may_have_more = false;
        }
        let row = sqlx::query(
            "UPDATE queue SET worker = $1 WHERE id = (
                 SELECT id FROM queue WHERE worker IS NULL ORDER BY place DESC, id LIMIT 1 FOR UPDATE SKIP LOCKED)
             RETURNING id, job_id, chunk, place",
        )
        .bind(&self.worker)
        .fetch_optional(&self.pool)
        .await?;
        let Some(row) = row else { return Ok(None) };
        let id = |name: &str| anyhow::Ok(Uuid::try_parse(row.try_get(name)?)?);
        let chunk = row
            .try_get::<Option<i64>, _>("chunk")?
            .map(u32::try_from)
            .transpose()?;
        let entry = Entry {
            id: id("id")?,
            job_id: id("job_id")?,
            chunk,
        };
        self.known().held.insert(entry.id);
        Ok(Some((entry, row.try_get("place")?)))
    }

    /// Puts back what the table gave this worker in an answer that was lost.
    async fn put_back_unknown(&self) -> anyhow::Result<()> {
        let held: Vec<String> = self.known().held.iter().map(Uuid::to_string).collect();
        let query =
            sqlx::query("UPDATE queue SET worker = NULL WHERE worker = $1 AND id <> ALL($2)")
                .bind(&self.worker)
                .bind(held);
        query.execute(&self.pool).await?;
        Ok(())
    }

    /// Says that the entry is done with, or that somebody has to look at it again; later if the database does not answer now.
    pub async fn answer(&self, id: Uuid, is_done: bool) {
        self.known().answers.push((id, is_done));
        if let Err(error) = self.send_answers().await {
            tracing::warn!(
                error = format!("{error:#}"),
                "the queue was not answered; trying again with the next heartbeat"
            );
        }
    }

    async fn send_answers(&self) -> anyhow::Result<()> {
        let answers = std::mem::take(&mut self.known().answers);
        let sent = self.send(&answers).await;
        let mut known = self.known();
        match &sent {
            Ok(()) => known
                .held
                .retain(|id| !answers.iter().any(|(answered, _)| answered == id)),
            Err(_) => known.answers.extend(answers),
        }
        sent
    }

    /// Nothing happens to entries that another worker has by now.
    async fn send(&self, answers: &[(Uuid, bool)]) -> anyhow::Result<()> {
        let ids = |done: bool| {
            answers
                .iter()
                .filter(|(_, is_done)| *is_done == done)
                .map(|(id, _)| id.to_string())
                .collect::<Vec<_>>()
        };
        let (done, again) = (ids(true), ids(false));
        if !done.is_empty() {
            sqlx::query("DELETE FROM queue WHERE id = ANY($1) AND worker = $2")
                .bind(done)
                .bind(&self.worker)
                .execute(&self.pool)
                .await?;
        }
        if !again.is_empty() {
            sqlx::query("UPDATE queue SET worker = NULL WHERE id = ANY($1) AND worker = $2")
                .bind(again)
                .bind(&self.worker)
                .execute(&self.pool)
                .await?;
            sqlx::query("SELECT pg_notify($1, '')")
                .bind(QUEUE_CHANNEL)
                .execute(&self.pool)
                .await?;
            self.wake();
        }
        Ok(())
    }

    /// A sign of life.
    async fn beat(&self) -> anyhow::Result<()> {
        sqlx::query("INSERT INTO workers (id, last_seen) VALUES ($1, now()) ON CONFLICT (id) DO UPDATE SET last_seen = now()")
            .bind(&self.worker)
            .execute(&self.pool)
            .await?;
        Ok(())
    }

    /// Puts back what dead workers have, and forgets those that have nothing.
    async fn bury_the_dead(&self) -> anyhow::Result<()> {
        let back = sqlx::query(
            "UPDATE queue SET worker = NULL WHERE worker IS NOT NULL AND NOT EXISTS (
                 SELECT 1 FROM workers WHERE workers.id = queue.worker AND last_seen > now() - make_interval(secs => $1))",
        )
        .bind(LEASE.as_secs_f64())
        .execute(&self.pool)
        .await?
        .rows_affected();
        sqlx::query("DELETE FROM workers WHERE last_seen < now() - interval '1 hour'")
            .execute(&self.pool)
            .await?;
        if back > 0 {
            tracing::warn!(
                entries = back,
                "a worker is dead; what it had is given out again"
            );
            sqlx::query("SELECT pg_notify($1, '')")
                .bind(QUEUE_CHANNEL)
                .execute(&self.pool)
                .await?;
        }
        Ok(())
    }

    /// A worker whose handlers have ended is gone at once; what it still has goes to others without a wait.
    pub async fn close(&self, have_ended: bool) {
        let goodbye = async {
            if have_ended {
                sqlx::query("DELETE FROM workers WHERE id = $1")
                    .bind(&self.worker)
                    .execute(&self.pool)
                    .await?;
            }
            self.pool.close().await;
            anyhow::Ok(())
        };
        match tokio::time::timeout(GOODBYE, goodbye).await {
            Ok(Ok(())) => {}
            Ok(Err(error)) => tracing::warn!(
                error = format!("{error:#}"),
                "the queue was not told of the end of its worker"
            ),
            Err(_) => tracing::warn!("the queue did not answer to the end of its worker"),
        }
    }

    fn known(&self) -> MutexGuard<'_, Known> {
        self.known.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Beats until the stop. Others are called dead only by a worker that has reached the database for as long as they may be silent: after
/// the database was away, everybody has that long to be heard again.
pub(super) async fn stay_alive(queue: Arc<Shared>, stop: CancellationToken) {
    let (mut since, mut last) = (Instant::now(), Instant::now());
    loop {
        tokio::select! {
            () = tokio::time::sleep(HEARTBEAT) => {}
            () = stop.cancelled() => return,
        }
        let beaten = match queue.beat().await {
            Ok(()) => queue.send_answers().await,
            failed => failed,
        };
        if last.elapsed() > 2 * HEARTBEAT {
            since = Instant::now();
        }
        let done = match beaten {
            Ok(()) => {
                last = Instant::now();
                if since.elapsed() >= LEASE {
                    queue.bury_the_dead().await
                } else {
                    Ok(())
                }
            }
            failed => failed,
        };
        if let Err(error) = done {
            tracing::warn!(
                error = format!("{error:#}"),
                "the queue's heartbeat failed; trying again"
            );
        }
    }
}
