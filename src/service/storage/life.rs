//! The life of a job: claimed, told about, ended; and taken up again after a crash.
//!
//! Claiming, running and ending are three steps; only the first and the last touch the tables. A claim takes effect for
//! one caller, and an end only for the attempt that was claimed, so a second copy of the same work changes nothing.

use super::change::{
    Changed, append_event, append_log, append_state, end_crashed, end_job, parse_id, ready_job,
    unfinished_dependencies,
};
use super::chunks::recover_chunks;
use super::database::Durability;
use super::datasets::{NewDataset, insert_dataset};
use super::unsynced::note_unsynced;
use super::{Storage, now, to_micros};
use crate::model::dataset::DatasetSummary;
use crate::model::sensor::SensorSettings;
use crate::service::types::{EventData, JobKind, JobState, Problem, Progress, ProgressStep};
use anyhow::Context;
use serde_json::Value;
use sqlx::{AnyConnection, Row};
use uuid::Uuid;

/// A job that this caller, and nobody else, now runs.
#[derive(Debug, Clone)]
pub struct ClaimedJob {
    pub id: Uuid,
    pub kind: JobKind,
    pub name: Option<String>,
    pub spec: Value,
    pub attempt: u32,
}

/// What came of asking for a job.
#[derive(Debug)]
pub enum Claim {
    Run(ClaimedJob),
    /// It had been running too often when the process died; it has failed.
    Refused(Changed),
    /// It is not queued, or waits for other jobs.
    NotNow,
}

/// A file that a job leaves behind; its blob is already in place.
#[derive(Debug, Clone)]
pub struct NewArtifact {
    pub name: String,
    pub media_type: String,
    pub bytes: u64,
    pub sha256: String,
    /// Set when other jobs can use it.
    pub dataset: Option<DatasetSummary>,
    pub sensors: Vec<SensorSettings>,
    /// The content where the blob is not on the disk by itself: this change makes it safe.
    pub unsynced: Option<Vec<u8>>,
}

/// How a running job ended.
#[derive(Debug)]
pub enum Ending {
    Succeeded {
        artifacts: Vec<NewArtifact>,
        warnings: Vec<String>,
    },
    Failed(Problem),
    Canceled,
}

impl Storage {
    /// Takes a queued job to run it, unless `crash_limit` processes have already died of it. `entry` is the queue's entry: one that
    /// comes again while the job runs through it comes because whoever ran the job is dead.
    pub async fn claim(&self, id: Uuid, entry: Uuid, crash_limit: u32) -> anyhow::Result<Claim> {
        let mut transaction = self.begin_with(Durability::Passing).await?;
        let at = now();
        if unfinished_dependencies(&mut transaction, id).await? > 0 {
            return Ok(Claim::NotNow);
        }
        let row = sqlx::query(
            "SELECT kind, name, spec, attempt, state, crashes FROM jobs
             WHERE id = $1 AND (state = 'queued' OR state = 'running' AND entry = $2) AND id NOT IN (SELECT job_id FROM campaigns)",
        )
        .bind(id.to_string())
        .bind(entry.to_string())
        .fetch_optional(&mut *transaction)
        .await?;
        let Some(row) = row else {
            return Ok(Claim::NotNow);
        };
        let crashes = row.try_get::<i64, _>("crashes")?
            + i64::from(row.try_get::<&str, _>("state")? == "running");
        if crashes >= i64::from(crash_limit) {
            let detail = format!("the process ended {crash_limit} times while it ran this job");
            let changed = end_crashed(&mut transaction, id, at, detail).await?;
            transaction.commit().await?;
            return Ok(Claim::Refused(changed));
        }
        let kind =
            JobKind::from_name(row.try_get("kind")?).context("a stored job has an unknown kind")?;
        let attempt = u32::try_from(row.try_get::<i64, _>("attempt")?)? + 1;
        sqlx::query("UPDATE jobs SET state = 'running', attempt = $1, started_at = $2, entry = $3, crashes = $4 WHERE id = $5")
            .bind(i64::from(attempt))
            .bind(to_micros(at))
            .bind(entry.to_string())
            .bind(crashes)
            .bind(id.to_string())
            .execute(&mut *transaction)
            .await?;
        append_state(&mut transaction, id, at, JobState::Running).await?;
        transaction.commit().await?;
        let spec =
            serde_json::from_str(row.try_get("spec")?).context("a stored spec is not JSON")?;
        Ok(Claim::Run(ClaimedJob {
            id,
            kind,
            name: row.try_get("name")?,
            spec,
            attempt,
        }))
    }

    /// How often the process died while it ran the job, with the death that brings this entry again.
    pub async fn crashes(&self, id: Uuid, entry: Uuid) -> anyhow::Result<i64> {
        let crashes: Option<i64> =
            sqlx::query_scalar("SELECT crashes + CASE WHEN state = 'running' AND entry = $2 THEN 1 ELSE 0 END FROM jobs WHERE id = $1")
                .bind(id.to_string())
                .bind(entry.to_string())
                .fetch_optional(&self.work)
                .await?;
        Ok(crashes.unwrap_or(0))
    }

    /// Writes how far the claimed attempt is; `None` when it is no longer running.
    pub async fn progress(
        &self,
        id: Uuid,
        attempt: u32,
        progress: &Progress,
    ) -> anyhow::Result<Option<Changed>> {
        let mut transaction = self.begin_with(Durability::Passing).await?;
        let done = sqlx::query(
            "UPDATE jobs SET progress = $1 WHERE id = $2 AND attempt = $3 AND state = 'running'",
        )
        .bind(serde_json::to_string(progress)?)
        .bind(id.to_string())
        .bind(i64::from(attempt))
        .execute(&mut *transaction)
        .await?;
        if done.rows_affected() == 0 {
            return Ok(None);
        }
        let data = EventData::Progress(progress.clone());
        append_event(&mut transaction, id, now(), &data).await?;
        transaction.commit().await?;
        Ok(Some(Changed::touch(id)))
    }

    /// Ends the claimed attempt, with its results. `None`: that attempt is no longer running, and nothing was written.
    pub async fn finish(
        &self,
        job: &ClaimedJob,
        ending: &Ending,
    ) -> anyhow::Result<Option<Changed>> {
        let mut transaction = self.begin().await?;
        if !is_running(&mut transaction, job).await? {
            return Ok(None);
        }
        let changed = end_with(&mut transaction, &self.owner, job, ending).await?;
        transaction.commit().await?;
        Ok(Some(changed))
    }

    /// Hands the claimed attempt back to the queue, because the service stops.
    pub async fn release(&self, job: &ClaimedJob) -> anyhow::Result<Option<Changed>> {
        let mut transaction = self.begin().await?;
        if !is_running(&mut transaction, job).await? {
            return Ok(None);
        }
        requeue(&mut transaction, job.id, false).await?;
        let ready = vec![ready_job(&mut transaction, job.id).await?];
        transaction.commit().await?;
        Ok(Some(Changed::new(job.id, ready)))
    }

    /// Puts every job and chunk that an earlier process left running back into the queue, or ends the job if it was to be canceled.
    /// Only for a process that has the tables for itself.
    pub async fn recover(&self) -> anyhow::Result<()> {
        let mut transaction = self.begin().await?;
        let rows = sqlx::query(
            "SELECT id, CASE WHEN cancel_requested_at IS NULL THEN 0 ELSE 1 END AS cancel FROM jobs
             WHERE state = 'running' AND id NOT IN (SELECT job_id FROM campaigns) ORDER BY created_at",
        )
        .fetch_all(&mut *transaction)
        .await?;
        for row in rows {
            let id = parse_id(row.try_get("id")?)?;
            if row.try_get::<i64, _>("cancel")? != 0 {
                end_job(&mut transaction, id, now(), JobState::Canceled, None).await?;
            } else {
                requeue(&mut transaction, id, true).await?;
            }
        }
        recover_chunks(&mut transaction).await?;
        transaction.commit().await?;
        Ok(())
    }
}

/// Writes what a job made, and its end.
pub(super) async fn end_with(
    connection: &mut AnyConnection,
    owner: &str,
    job: &ClaimedJob,
    ending: &Ending,
) -> anyhow::Result<Changed> {
    let at = now();
    match ending {
        Ending::Succeeded {
            artifacts,
            warnings,
        } => {
            for (position, artifact) in artifacts.iter().enumerate() {
                insert_artifact(connection, job, position, artifact).await?;
                if let Some(content) = &artifact.unsynced {
                    note_unsynced(connection, owner, &artifact.sha256, content).await?;
                }
            }
            let complete = Progress {
                step: ProgressStep::Write,
                done: 1,
                total: 1,
                fraction: 1.0,
                eta_s: None,
            };
            sqlx::query("UPDATE jobs SET warnings = $1, progress = $2 WHERE id = $3")
                .bind(serde_json::to_string(warnings)?)
                .bind(serde_json::to_string(&complete)?)
                .bind(job.id.to_string())
                .execute(&mut *connection)
                .await?;
            end_job(connection, job.id, at, JobState::Succeeded, None).await
        }
        Ending::Failed(problem) => {
            let problem = Some(problem.clone());
            end_job(connection, job.id, at, JobState::Failed, problem).await
        }
        Ending::Canceled => end_job(connection, job.id, at, JobState::Canceled, None).await,
    }
}

pub(super) async fn is_running(
    connection: &mut AnyConnection,
    job: &ClaimedJob,
) -> anyhow::Result<bool> {
    let running: i64 = sqlx::query_scalar(
        "SELECT count(*) FROM jobs WHERE id = $1 AND attempt = $2 AND state = 'running'",
    )
    .bind(job.id.to_string())
    .bind(i64::from(job.attempt))
    .fetch_one(connection)
    .await?;
    Ok(running == 1)
}

async fn requeue(connection: &mut AnyConnection, id: Uuid, crashed: bool) -> anyhow::Result<()> {
    let at = now();
    sqlx::query(
        "UPDATE jobs SET state = 'queued', queued_at = $1, started_at = NULL, progress = NULL, enqueued_at = NULL, crashes = crashes + $2 WHERE id = $3",
    )
    .bind(to_micros(at))
    .bind(i64::from(crashed))
    .bind(id.to_string())
    .execute(&mut *connection)
    .await?;
    append_state(connection, id, at, JobState::Queued).await?;
    let message = if crashed {
        "the process ended while it ran the job; queued again"
    } else {
        "the service stopped; queued again"
    };
    append_log(connection, id, at, message).await
}

async fn insert_artifact(
    connection: &mut AnyConnection,
    job: &ClaimedJob,
    position: usize,
    artifact: &NewArtifact,
) -> anyhow::Result<()> {
    let dataset_id = match NewDataset::from_job(job, artifact) {
        Some(dataset) => Some(insert_dataset(connection, &dataset).await?),
        None => None,
    };
    sqlx::query(
        "INSERT INTO artifacts (job_id, name, position, media_type, bytes, sha256, dataset_id) VALUES ($1, $2, $3, $4, $5, $6, $7)",
    )
    .bind(job.id.to_string())
    .bind(&artifact.name)
    .bind(i64::try_from(position)?)
    .bind(&artifact.media_type)
    .bind(i64::try_from(artifact.bytes)?)
    .bind(&artifact.sha256)
    .bind(dataset_id.map(|id| id.to_string()))
    .execute(connection)
    .await?;
    Ok(())
}

#[cfg(test)]
mod tests;
