//! What has to be put into the queue: noted in the same change that made it ready, so that a process that dies in between loses nothing.

use super::change::{Ready, parse_id};
use super::{Storage, now, to_micros};
use sqlx::Row;
use uuid::Uuid;

impl Storage {
    /// Every queued job and chunk that waits for nothing but a free slot, the most urgent and oldest first. `is_missing`: only those of
    /// which it is not known that they are in the queue.
    pub async fn ready(&self, is_missing: bool) -> anyhow::Result<Vec<Ready>> {
        let rows = sqlx::query(
            "SELECT id AS job_id, NULL AS number, priority, created_at FROM jobs
             WHERE state = 'queued' AND deleted_at IS NULL AND ($1 = 0 OR enqueued_at IS NULL) AND NOT EXISTS (
                 SELECT 1 FROM job_dependencies JOIN jobs AS needed ON needed.id = source_id
                 WHERE source_kind = 'job' AND job_id = jobs.id AND needed.state <> 'succeeded')
             UNION ALL
             SELECT job_id, number, priority, created_at FROM chunks JOIN jobs ON jobs.id = job_id
             WHERE chunks.state = 'queued' AND jobs.state = 'running' AND ($1 = 0 OR chunks.enqueued_at IS NULL)
             ORDER BY priority DESC, created_at, job_id, number",
        )
        .bind(i64::from(is_missing))
        .fetch_all(&self.work)
        .await?;
        let ready = |row: &sqlx::any::AnyRow| {
            let chunk = row
                .try_get::<Option<i64>, _>("number")?
                .map(u32::try_from)
                .transpose()?;
            Ok(Ready {
                job_id: parse_id(row.try_get("job_id")?)?,
                chunk,
                priority: row.try_get("priority")?,
            })
        };
        rows.iter().map(ready).collect()
    }

    /// Whether a job, or a chunk of a campaign, waits to be claimed.
    pub async fn is_unclaimed(&self, job_id: Uuid, chunk: Option<u32>) -> anyhow::Result<bool> {
        let query = match chunk {
            None => sqlx::query_scalar("SELECT count(*) FROM jobs WHERE id = $1 AND state = 'queued'"),
            Some(_) => sqlx::query_scalar(
                "SELECT count(*) FROM chunks JOIN jobs ON jobs.id = job_id
                 WHERE job_id = $1 AND number = $2 AND chunks.state = 'queued' AND jobs.state = 'running'",
            ),
        };
        let query = query.bind(job_id.to_string());
        let query = match chunk {
            None => query,
            Some(number) => query.bind(i64::from(number)),
        };
        let count: i64 = query.fetch_one(&self.work).await?;
        Ok(count > 0)
    }

    /// Notes that these are in the queue, where others would put them in again. A queue of one process is made anew at each start.
    pub async fn note_enqueued(&self, entries: &[Ready]) -> anyhow::Result<()> {
        if !self.is_shared {
            return Ok(());
        }
        let mut transaction = self.begin().await?;
        for run in entries.chunk_by(|one, next| {
            one.job_id == next.job_id
                && one.chunk.is_some()
                && next.chunk == one.chunk.map(|it| it + 1)
        }) {
            let (first, last) = (run[0], run[run.len() - 1]);
            let query = match first.chunk {
                None => sqlx::query("UPDATE jobs SET enqueued_at = $1 WHERE id = $2"),
                Some(_) => sqlx::query(
                    "UPDATE chunks SET enqueued_at = $1 WHERE job_id = $2 AND number BETWEEN $3 AND $4",
                ),
            };
            let query = query.bind(to_micros(now())).bind(first.job_id.to_string());
            let query = match (first.chunk, last.chunk) {
                (Some(first), Some(last)) => query.bind(i64::from(first)).bind(i64::from(last)),
                _ => query,
            };
            query.execute(&mut *transaction).await?;
        }
        transaction.commit().await?;
        Ok(())
    }
}
