//! Rows of jobs: read, listed, renamed, canceled, deleted.

use super::change::{Changed, append_log, end_job, parse_id};
use super::datasets::active_users;
use super::filter::JobFilter;
use super::page::{Cursor, Page, push_search};
use super::statement::Statement;
use super::{Storage, from_micros, now, to_micros};
use crate::service::types::{Job, JobKind, JobLinks, JobState};
use anyhow::Context;
use sqlx::any::AnyRow;
use sqlx::{AnyConnection, Row};
use std::collections::BTreeMap;
use uuid::Uuid;

const COLUMNS: &str = "SELECT id, kind, state, attempt, name, labels, created_at, queued_at, started_at, finished_at, cancel_requested_at,
    CASE WHEN deleted_at IS NULL THEN 0 ELSE 1 END AS deleted, progress, error, warnings, seed, engine_version, spec_sha256, duplicate_of, rerun_of, pinned,
    (SELECT string_agg(source_id, ',' ORDER BY source_id) FROM job_dependencies WHERE job_id = jobs.id AND source_kind = 'job') AS depends_on
    FROM jobs WHERE ";

/// A job, and whether it has been deleted.
#[derive(Debug, Clone)]
pub struct StoredJob {
    pub job: Job,
    pub deleted: bool,
}

/// What came of asking a job to stop.
#[derive(Debug, Clone, PartialEq)]
pub enum Cancellation {
    /// It is canceled. Whoever makes a part of it has to be told.
    Canceled(Changed),
    /// It runs; whoever runs it has to be told.
    Requested(Changed),
    AlreadyEnded(JobState),
}

/// What came of deleting a job.
#[derive(Debug, Clone, PartialEq)]
pub enum Deletion {
    /// Deleted; these contents may now be unused.
    Deleted(Vec<String>),
    StillActive(JobState),
    /// These jobs read its results.
    NeededBy(Vec<Uuid>),
}

/// A file of a job.
#[derive(Debug, Clone)]
pub struct StoredArtifact {
    pub name: String,
    pub media_type: String,
    pub bytes: u64,
    pub sha256: String,
    pub dataset_id: Option<Uuid>,
}

impl Storage {
    pub async fn job(&self, id: Uuid) -> anyhow::Result<Option<StoredJob>> {
        let Some(recall) = &self.recall else {
            return self.read_job(id).await;
        };
        if let Some(known) = recall.job(id) {
            return Ok(Some(known));
        }
        let at = recall.now();
        let job = self.read_job(id).await?;
        if let Some(job) = &job {
            recall.keep_job(at, id, job);
        }
        Ok(job)
    }

    async fn read_job(&self, id: Uuid) -> anyhow::Result<Option<StoredJob>> {
        let mut query = Statement::new(COLUMNS);
        query.push("id = ").bind(id.to_string());
        let row = query.query().fetch_optional(&self.read).await?;
        row.as_ref().map(stored).transpose()
    }

    /// The job's request as normalised.
    pub async fn spec(&self, id: Uuid) -> anyhow::Result<serde_json::Value> {
        let json: String = sqlx::query_scalar("SELECT spec FROM jobs WHERE id = $1")
            .bind(id.to_string())
            .fetch_one(&self.read)
            .await?;
        serde_json::from_str(&json).context("a stored spec is not JSON")
    }

    pub async fn jobs(
        &self,
        filter: &JobFilter,
        after: Option<Cursor>,
    ) -> anyhow::Result<Page<Job>> {
        let count = "SELECT count(*) FROM jobs WHERE ";
        let read = |row: &AnyRow| Ok(stored(row)?.job);
        let paging = (&filter.paging, after);
        self.page((COLUMNS, count), condition(filter), paging, read)
            .await
    }

    pub async fn job_counts(&self) -> anyhow::Result<BTreeMap<JobState, u64>> {
        let rows =
            sqlx::query("SELECT state, count(*) FROM jobs WHERE deleted_at IS NULL GROUP BY state")
                .fetch_all(&self.read)
                .await?;
        let mut counts: BTreeMap<JobState, u64> =
            JobState::ALL.into_iter().map(|state| (state, 0)).collect();
        for row in rows {
            let state = parse_state(row.try_get(0)?)?;
            counts.insert(state, row.try_get::<i64, _>(1)?.cast_unsigned());
        }
        Ok(counts)
    }

    /// Pins a job, or lets it go with others of its age.
    pub async fn pin_job(&self, id: Uuid, is_pinned: bool) -> anyhow::Result<()> {
        let mut transaction = self.begin().await?;
        sqlx::query("UPDATE jobs SET pinned = $1 WHERE id = $2")
            .bind(i64::from(is_pinned))
            .bind(id.to_string())
            .execute(&mut *transaction)
            .await?;
        Ok(transaction.commit().await?)
    }

    /// Renames; an empty name removes the name, and labels replace all labels.
    pub async fn patch_job(
        &self,
        id: Uuid,
        name: Option<&str>,
        labels: Option<&BTreeMap<String, String>>,
    ) -> anyhow::Result<()> {
        let mut transaction = self.begin().await?;
        if let Some(name) = name {
            sqlx::query("UPDATE jobs SET name = nullif($1, '') WHERE id = $2")
                .bind(name)
                .bind(id.to_string())
                .execute(&mut *transaction)
                .await?;
        }
        if let Some(labels) = labels {
            write_labels(&mut transaction, id, labels).await?;
        }
        transaction.commit().await?;
        Ok(())
    }

    /// Cancels a queued job or a campaign at once; notes the wish on another that runs.
    pub async fn cancel(&self, id: Uuid) -> anyhow::Result<Cancellation> {
        let mut transaction = self.begin().await?;
        let at = now();
        let state = state_of(&mut transaction, id).await?;
        if state.is_terminal() {
            return Ok(Cancellation::AlreadyEnded(state));
        }
        let asked = sqlx::query("UPDATE jobs SET cancel_requested_at = $1 WHERE id = $2 AND cancel_requested_at IS NULL")
            .bind(to_micros(at))
            .bind(id.to_string())
            .execute(&mut *transaction)
            .await?;
        let is_campaign: i64 =
            sqlx::query_scalar("SELECT count(*) FROM campaigns WHERE job_id = $1")
                .bind(id.to_string())
                .fetch_one(&mut *transaction)
                .await?;
        // A running campaign is in nobody's hands as a whole; who makes a chunk of it finds that it has ended.
        let outcome = if state == JobState::Queued || is_campaign > 0 {
            Cancellation::Canceled(
                end_job(&mut transaction, id, at, JobState::Canceled, None).await?,
            )
        } else {
            if asked.rows_affected() == 1 {
                append_log(&mut transaction, id, at, "cancel requested").await?;
            }
            Cancellation::Requested(Changed::touch(id))
        };
        transaction.commit().await?;
        Ok(outcome)
    }

    /// Deletes a job that has ended; its row stays as a sign that it was here.
    pub async fn delete_job(&self, id: Uuid) -> anyhow::Result<Deletion> {
        let mut transaction = self.begin().await?;
        let key = id.to_string();
        let state = state_of(&mut transaction, id).await?;
        if !state.is_terminal() {
            return Ok(Deletion::StillActive(state));
        }
        let users = active_users(&mut transaction, "job", id).await?;
        if !users.is_empty() {
            return Ok(Deletion::NeededBy(users));
        }
        let contents = sqlx::query_scalar("SELECT sha256 FROM artifacts WHERE job_id = $1")
            .bind(&key)
            .fetch_all(&mut *transaction)
            .await?;
        // The row stays, so that asking for the job says "gone"; what is long in it goes.
        sqlx::query("UPDATE jobs SET deleted_at = $1, spec = '{}', warnings = '[]', error = NULL, progress = NULL WHERE id = $2")
            .bind(to_micros(now()))
            .bind(&key)
            .execute(&mut *transaction)
            .await?;
        for statement in [
            "DELETE FROM artifacts WHERE job_id = $1",
            "DELETE FROM job_events WHERE job_id = $1",
            "DELETE FROM job_labels WHERE job_id = $1",
            "DELETE FROM chunks WHERE job_id = $1",
            "DELETE FROM campaigns WHERE job_id = $1",
        ] {
            sqlx::query(statement)
                .bind(&key)
                .execute(&mut *transaction)
                .await?;
        }
        transaction.commit().await?;
        Ok(Deletion::Deleted(contents))
    }

    /// The files of a job, in the order in which it made them.
    pub async fn artifacts(&self, id: Uuid) -> anyhow::Result<Vec<StoredArtifact>> {
        let Some(recall) = &self.recall else {
            return self.read_artifacts(id).await;
        };
        if let Some(known) = recall.artifacts(id) {
            return Ok(known);
        }
        let at = recall.now();
        let artifacts = self.read_artifacts(id).await?;
        recall.keep_artifacts(at, id, &artifacts);
        Ok(artifacts)
    }

    async fn read_artifacts(&self, id: Uuid) -> anyhow::Result<Vec<StoredArtifact>> {
        let rows = sqlx::query("SELECT name, media_type, bytes, sha256, dataset_id FROM artifacts WHERE job_id = $1 ORDER BY position")
            .bind(id.to_string())
            .fetch_all(&self.read)
            .await?;
        rows.iter().map(artifact).collect()
    }
}

async fn state_of(connection: &mut AnyConnection, id: Uuid) -> anyhow::Result<JobState> {
    let state: String = sqlx::query_scalar("SELECT state FROM jobs WHERE id = $1")
        .bind(id.to_string())
        .fetch_one(connection)
        .await?;
    parse_state(&state)
}

pub(super) fn parse_state(name: &str) -> anyhow::Result<JobState> {
    JobState::from_name(name).context("a stored job has an unknown state")
}

fn artifact(row: &AnyRow) -> anyhow::Result<StoredArtifact> {
    Ok(StoredArtifact {
        name: row.try_get("name")?,
        media_type: row.try_get("media_type")?,
        bytes: row.try_get::<i64, _>("bytes")?.cast_unsigned(),
        sha256: row.try_get("sha256")?,
        dataset_id: row
            .try_get::<Option<&str>, _>("dataset_id")?
            .map(parse_id)
            .transpose()?,
    })
}

/// Writes the labels twice: on the row to be read, and by value to be searched.
pub(super) async fn write_labels(
    connection: &mut AnyConnection,
    id: Uuid,
    labels: &BTreeMap<String, String>,
) -> anyhow::Result<()> {
    let key = id.to_string();
    sqlx::query("UPDATE jobs SET labels = $1 WHERE id = $2")
        .bind(serde_json::to_string(labels)?)
        .bind(&key)
        .execute(&mut *connection)
        .await?;
    sqlx::query("DELETE FROM job_labels WHERE job_id = $1")
        .bind(&key)
        .execute(&mut *connection)
        .await?;
    for (label, value) in labels {
        sqlx::query("INSERT INTO job_labels (job_id, key, value) VALUES ($1, $2, $3)")
            .bind(&key)
            .bind(label)
            .bind(value)
            .execute(&mut *connection)
            .await?;
    }
    Ok(())
}

fn condition(filter: &JobFilter) -> Statement {
    let mut query = Statement::new("deleted_at IS NULL");
    push_names(
        &mut query,
        "state",
        filter.states.iter().map(|state| state.name()),
    );
    push_names(
        &mut query,
        "kind",
        filter.kinds.iter().map(|kind| kind.name()),
    );
    for (key, value) in &filter.labels {
        query
            .push(" AND id IN (SELECT job_id FROM job_labels WHERE key = ")
            .bind(key.clone());
        query.push(" AND value = ").bind(value.clone()).push(")");
    }
    if let Some(after) = filter.created_after {
        query.push(" AND created_at > ").bind(to_micros(after));
    }
    if let Some(before) = filter.created_before {
        query.push(" AND created_at < ").bind(to_micros(before));
    }
    if let Some(q) = &filter.q {
        push_search(&mut query, q);
    }
    query
}

fn push_names(
    query: &mut Statement,
    column: &'static str,
    names: impl ExactSizeIterator<Item = &'static str>,
) {
    if names.len() == 0 {
        return;
    }
    query
        .push(" AND ")
        .push(column)
        .push(" IN ")
        .bind_list(names.map(str::to_owned));
}

fn stored(row: &AnyRow) -> anyhow::Result<StoredJob> {
    let id = parse_id(row.try_get("id")?)?;
    let state = parse_state(row.try_get("state")?)?;
    let time = |column: &str| {
        row.try_get::<Option<i64>, _>(column)
            .map_err(anyhow::Error::from)?
            .map(from_micros)
            .transpose()
    };
    let optional_id = |column: &str| {
        row.try_get::<Option<&str>, _>(column)
            .map_err(anyhow::Error::from)?
            .map(parse_id)
            .transpose()
    };
    let cancel_requested_at = time("cancel_requested_at")?;
    let job = Job {
        id,
        kind: JobKind::from_name(row.try_get("kind")?)
            .context("a stored job has an unknown kind")?,
        state,
        attempt: u32::try_from(row.try_get::<i64, _>("attempt")?)?,
        name: row.try_get("name")?,
        labels: serde_json::from_str(row.try_get("labels")?)?,
        created_at: from_micros(row.try_get("created_at")?)?,
        queued_at: from_micros(row.try_get("queued_at")?)?,
        started_at: time("started_at")?,
        finished_at: time("finished_at")?,
        cancel_requested_at,
        can_cancel: !state.is_terminal() && cancel_requested_at.is_none(),
        progress: row
            .try_get::<Option<&str>, _>("progress")?
            .map(serde_json::from_str)
            .transpose()?,
        error: row
            .try_get::<Option<&str>, _>("error")?
            .map(serde_json::from_str)
            .transpose()?,
        warnings: serde_json::from_str(row.try_get("warnings")?)?,
        depends_on: row
            .try_get::<Option<&str>, _>("depends_on")?
            .into_iter()
            .flat_map(|ids| ids.split(','))
            .map(parse_id)
            .collect::<anyhow::Result<_>>()?,
        seed: u32::try_from(row.try_get::<i64, _>("seed")?)?,
        engine_version: row.try_get("engine_version")?,
        spec_sha256: row.try_get("spec_sha256")?,
        duplicate_of: optional_id("duplicate_of")?,
        rerun_of: optional_id("rerun_of")?,
        pinned: row.try_get::<i64, _>("pinned")? != 0,
        links: JobLinks::of(id),
    };
    Ok(StoredJob {
        job,
        deleted: row.try_get::<i64, _>("deleted")? != 0,
    })
}
