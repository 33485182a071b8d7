//! What is kept, how much room it takes, and which jobs go first.

use super::change::parse_id;
use super::{Storage, now, to_micros};
use sqlx::Row;
use std::time::Duration;
use uuid::Uuid;

/// What is kept, in bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Kept {
    /// Files of datasets and jobs, each content once.
    pub files_bytes: u64,
    /// Tables, with the logs of live sessions, without what is free in them.
    pub tables_bytes: u64,
}

impl Kept {
    pub fn bytes(self) -> u64 {
        self.files_bytes + self.tables_bytes
    }
}

/// When a job ended (microseconds), and which: the order in which jobs go.
pub type EndOfJob = (i64, Uuid);

/// A job that has ended, is not pinned, and has nothing that a pinned job was made from.
const MAY_GO: &str = "deleted_at IS NULL AND pinned = 0 AND finished_at IS NOT NULL AND NOT EXISTS (
    SELECT 1 FROM job_dependencies JOIN jobs AS user_of ON user_of.id = job_dependencies.job_id
    WHERE source_kind = 'job' AND source_id = jobs.id AND user_of.pinned = 1 AND user_of.deleted_at IS NULL)";

impl Storage {
    pub async fn kept(&self) -> anyhow::Result<Kept> {
        let files: i64 = sqlx::query_scalar(
            "SELECT CAST(COALESCE(SUM(bytes), 0) AS BIGINT) FROM (
                 SELECT sha256, MAX(bytes) AS bytes FROM (
                     SELECT sha256, bytes FROM artifacts
                     UNION ALL SELECT sha256, bytes FROM datasets WHERE deleted_at IS NULL) AS each_one
                 GROUP BY sha256) AS once",
        )
        .fetch_one(&self.work)
        .await?;
        let tables = if self.is_shared {
            "SELECT pg_database_size(current_database())"
        } else {
            "SELECT (page_count - freelist_count) * page_size FROM pragma_page_count(), pragma_freelist_count(), pragma_page_size()"
        };
        let tables: i64 = sqlx::query_scalar(tables).fetch_one(&self.work).await?;
        // Copies of files until these are synced, within seconds: they are counted as files.
        let copies: i64 = sqlx::query_scalar(
            "SELECT CAST(COALESCE(SUM(LENGTH(content)), 0) AS BIGINT) FROM unsynced_blobs",
        )
        .fetch_one(&self.work)
        .await?;
        Ok(Kept {
            files_bytes: files.cast_unsigned(),
            tables_bytes: tables.saturating_sub(copies).max(0).cast_unsigned(),
        })
    }

    /// Jobs that have ended and may go, and those that are pinned.
    pub async fn ended_and_pinned(&self) -> anyhow::Result<(u64, u64)> {
        let count = async |condition: &str| -> anyhow::Result<u64> {
            let query = format!("SELECT count(*) FROM jobs WHERE {condition}");
            let count: i64 = sqlx::query_scalar(sqlx::AssertSqlSafe(query))
                .fetch_one(&self.work)
                .await?;
            Ok(count.cast_unsigned())
        };
        Ok((
            count(MAY_GO).await?,
            count("deleted_at IS NULL AND pinned = 1").await?,
        ))
    }

    /// The next jobs that may go, those first that ended first.
    pub async fn oldest_ended(&self, after: EndOfJob, most: u64) -> anyhow::Result<Vec<EndOfJob>> {
        let query = format!(
            "SELECT finished_at, id FROM jobs WHERE {MAY_GO} AND (finished_at > $1 OR finished_at = $1 AND id > $2)
             ORDER BY finished_at, id LIMIT $3"
        );
        let rows = sqlx::query(sqlx::AssertSqlSafe(query))
            .bind(after.0)
            .bind(after.1.to_string())
            .bind(most.cast_signed())
            .fetch_all(&self.work)
            .await?;
        let end = |row: &sqlx::any::AnyRow| {
            anyhow::Ok((row.try_get("finished_at")?, parse_id(row.try_get("id")?)?))
        };
        rows.iter().map(end).collect()
    }

    /// Datasets that a job made, with their contents, but for those that a pinned job has read.
    pub async fn datasets_made_by(&self, job: Uuid) -> anyhow::Result<Vec<(Uuid, String)>> {
        let rows = sqlx::query(
            "SELECT id, sha256 FROM datasets WHERE origin_job_id = $1 AND deleted_at IS NULL AND NOT EXISTS (
                 SELECT 1 FROM job_dependencies JOIN jobs ON jobs.id = job_dependencies.job_id
                 WHERE source_kind = 'dataset' AND source_id = datasets.id AND jobs.pinned = 1 AND jobs.deleted_at IS NULL)",
        )
        .bind(job.to_string())
        .fetch_all(&self.work)
        .await?;
        let made = |row: &sqlx::any::AnyRow| {
            anyhow::Ok((parse_id(row.try_get("id")?)?, row.try_get("sha256")?))
        };
        rows.iter().map(made).collect()
    }

    /// Forgets deleted jobs and datasets that nobody asks for any more: until then asking for one says "gone".
    pub async fn forget_deleted(&self, older_than: Duration) -> anyhow::Result<()> {
        let before = to_micros(now()) - i64::try_from(older_than.as_micros())?;
        let mut change = self.begin().await?;
        for statement in [
            "DELETE FROM job_dependencies WHERE job_id IN (SELECT id FROM jobs WHERE deleted_at < $1)",
            "DELETE FROM jobs WHERE deleted_at < $1 AND id NOT IN (SELECT job_id FROM idempotency_keys)",
            "DELETE FROM datasets WHERE deleted_at < $1",
        ] {
            sqlx::query(statement)
                .bind(before)
                .execute(&mut *change)
                .await?;
        }
        Ok(change.commit().await?)
    }
}
