//! Letting a job in: its sources exist, its idempotency key is free, the queue has room; then row, key, dependencies and
//! first event in one transaction.

use super::change::{
    Changed, append_state, dependency_failed, end_job, parse_id, ready_job, unfinished_dependencies,
};
use super::jobs::{parse_state, write_labels};
use super::{Storage, now, to_micros};
use crate::model::dataset::DatasetKind;
use crate::model::fault::Fault;
use crate::service::types::{JobKind, JobState};
use sqlx::{AnyConnection, Row};
use std::collections::BTreeMap;
use std::time::Duration;
use uuid::Uuid;

/// Something that a job reads.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SourceRef {
    /// Where the request names it: `/input`, …
    pub pointer: String,
    pub role: DatasetKind,
    pub id: SourceId,
}

/// The id as the request gives it; it need not be one.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum SourceId {
    Dataset(String),
    Job(String),
}

/// The key under which a request is remembered, and what it was.
#[derive(Debug, Clone)]
pub struct IdempotencyKey {
    pub key: String,
    pub request_sha256: String,
}

/// A job about to be queued.
#[derive(Debug, Clone)]
pub struct NewJob {
    pub kind: JobKind,
    pub name: Option<String>,
    pub labels: BTreeMap<String, String>,
    pub spec: String,
    pub spec_sha256: String,
    pub seed: u32,
    /// Greater goes first.
    pub priority: i64,
    pub engine_version: &'static str,
    pub sources: Vec<SourceRef>,
    pub rerun_of: Option<Uuid>,
    pub idempotency: Option<IdempotencyKey>,
}

/// Whether the job was let in.
#[derive(Debug)]
pub enum Admission {
    Admitted(Uuid, Changed),
    /// The key was used for the same request; this is its job.
    Replayed(Uuid),
    /// The key was used for another request.
    Mismatch,
    QueueFull,
    Missing(Vec<Fault>),
}

impl Storage {
    pub async fn admit(&self, new: &NewJob, queue_limit: u64) -> anyhow::Result<Admission> {
        let mut transaction = self.begin().await?;
        if let Some(key) = &new.idempotency
            && let Some(admission) = remembered(&mut transaction, key).await?
        {
            return Ok(admission);
        }
        let faults = missing_sources(&mut transaction, &new.sources).await?;
        if !faults.is_empty() {
            return Ok(Admission::Missing(faults));
        }
        let queued: i64 = sqlx::query_scalar(
            "SELECT count(*) FROM jobs WHERE state = 'queued' AND deleted_at IS NULL",
        )
        .fetch_one(&mut *transaction)
        .await?;
        if queued.cast_unsigned() >= queue_limit {
            return Ok(Admission::QueueFull);
        }
        let id = insert(&mut transaction, new).await?;
        let changed = start(&mut transaction, id).await?;
        transaction.commit().await?;
        Ok(Admission::Admitted(id, changed))
    }

    /// What the key is remembered for, before anything else of the request is looked at.
    pub async fn remembered(&self, key: &IdempotencyKey) -> anyhow::Result<Option<Admission>> {
        remembered(&mut *self.read.acquire().await?, key).await
    }

    /// The same check of sources as in [`Self::admit`].
    pub async fn missing_sources(&self, sources: &[SourceRef]) -> anyhow::Result<Vec<Fault>> {
        missing_sources(&mut *self.read.acquire().await?, sources).await
    }

    pub async fn forget_keys(&self, older_than: Duration) -> anyhow::Result<()> {
        let age_micros = i64::try_from(older_than.as_micros())?;
        let mut change = self.begin().await?;
        sqlx::query("DELETE FROM idempotency_keys WHERE created_at < $1")
            .bind(to_micros(now()) - age_micros)
            .execute(&mut *change)
            .await?;
        Ok(change.commit().await?)
    }
}

async fn remembered(
    connection: &mut AnyConnection,
    key: &IdempotencyKey,
) -> anyhow::Result<Option<Admission>> {
    let row = sqlx::query("SELECT request_sha256, job_id FROM idempotency_keys WHERE key = $1")
        .bind(&key.key)
        .fetch_optional(connection)
        .await?;
    let Some(row) = row else { return Ok(None) };
    if row.try_get::<&str, _>("request_sha256")? != key.request_sha256 {
        return Ok(Some(Admission::Mismatch));
    }
    Ok(Some(Admission::Replayed(parse_id(row.try_get("job_id")?)?)))
}

async fn missing_sources(
    connection: &mut AnyConnection,
    sources: &[SourceRef],
) -> anyhow::Result<Vec<Fault>> {
    let mut faults: Vec<Fault> = Vec::new();
    for source in sources {
        let fault = match &source.id {
            SourceId::Dataset(id) => dataset_fault(connection, source, id).await?,
            SourceId::Job(id) => job_fault(connection, source, id).await?,
        };
        faults.extend(fault.filter(|fault| !faults.contains(fault)));
    }
    Ok(faults)
}

async fn dataset_fault(
    connection: &mut AnyConnection,
    source: &SourceRef,
    id: &str,
) -> anyhow::Result<Option<Fault>> {
    let pointer = format!("{}/dataset_id", source.pointer);
    let kind: Option<String> =
        sqlx::query_scalar("SELECT kind FROM datasets WHERE id = $1 AND deleted_at IS NULL")
            .bind(id.to_lowercase())
            .fetch_optional(connection)
            .await?;
    let needed = source.role.name();
    Ok(match kind {
        None => Some(Fault::new(
            pointer,
            "not_found",
            format!("there is no dataset '{id}'"),
        )),
        Some(kind) if kind != needed => Some(
            Fault::new(
                pointer,
                "conflict",
                format!("dataset '{id}' holds {kind}, not {needed}"),
            )
            .allowing(needed),
        ),
        Some(_) => None,
    })
}

async fn job_fault(
    connection: &mut AnyConnection,
    source: &SourceRef,
    id: &str,
) -> anyhow::Result<Option<Fault>> {
    let known: i64 =
        sqlx::query_scalar("SELECT count(*) FROM jobs WHERE id = $1 AND deleted_at IS NULL")
            .bind(id.to_lowercase())
            .fetch_one(connection)
            .await?;
    let fault = || {
        Fault::new(
            format!("{}/job_id", source.pointer),
            "not_found",
            format!("there is no job '{id}'"),
        )
    };
    Ok((known == 0).then(fault))
}

async fn insert(connection: &mut AnyConnection, new: &NewJob) -> anyhow::Result<Uuid> {
    let (id, at) = (Uuid::now_v7(), to_micros(now()));
    sqlx::query(
        "INSERT INTO jobs (id, kind, state, name, spec, spec_sha256, seed, engine_version, created_at, queued_at, rerun_of, priority, duplicate_of)
         VALUES ($1, $2, 'queued', $3, $4, $5, $6, $7, $8, $8, $9, $10,
             (SELECT id FROM jobs WHERE spec_sha256 = $5 AND kind = $2 AND state = 'succeeded' AND deleted_at IS NULL
              ORDER BY created_at LIMIT 1))",
    )
    .bind(id.to_string())
    .bind(new.kind.name())
    .bind(&new.name)
    .bind(&new.spec)
    .bind(&new.spec_sha256)
    .bind(i64::from(new.seed))
    .bind(new.engine_version)
    .bind(at)
    .bind(new.rerun_of.map(|id| id.to_string()))
    .bind(new.priority)
    .execute(&mut *connection)
    .await?;
    write_labels(connection, id, &new.labels).await?;
    for source in &new.sources {
        let (kind, source_id) = match &source.id {
            SourceId::Dataset(id) => ("dataset", id),
            SourceId::Job(id) => ("job", id),
        };
        sqlx::query("INSERT INTO job_dependencies (job_id, source_kind, source_id) VALUES ($1, $2, $3) ON CONFLICT DO NOTHING")
            .bind(id.to_string())
            .bind(kind)
            .bind(source_id.to_lowercase())
            .execute(&mut *connection)
            .await?;
    }
    if let Some(IdempotencyKey {
        key,
        request_sha256,
    }) = &new.idempotency
    {
        sqlx::query("INSERT INTO idempotency_keys (key, request_sha256, job_id, created_at) VALUES ($1, $2, $3, $4)")
            .bind(key)
            .bind(request_sha256)
            .bind(id.to_string())
            .bind(at)
            .execute(connection)
            .await?;
    }
    Ok(id)
}

/// The first event; a job that needs one that has already failed fails at once.
async fn start(connection: &mut AnyConnection, id: Uuid) -> anyhow::Result<Changed> {
    let at = now();
    append_state(connection, id, at, JobState::Queued).await?;
    let failed = sqlx::query(
        "SELECT jobs.id, state FROM job_dependencies JOIN jobs ON jobs.id = source_id
         WHERE source_kind = 'job' AND job_id = $1 AND state IN ('failed', 'canceled') ORDER BY jobs.id LIMIT 1",
    )
    .bind(id.to_string())
    .fetch_optional(&mut *connection)
    .await?;
    if let Some(row) = failed {
        let state = parse_state(row.try_get("state")?)?;
        let problem = dependency_failed(parse_id(row.try_get("id")?)?, state);
        return end_job(connection, id, at, JobState::Failed, Some(problem)).await;
    }
    let ready = if unfinished_dependencies(connection, id).await? == 0 {
        vec![ready_job(connection, id).await?]
    } else {
        Vec::new()
    };
    Ok(Changed::new(id, ready))
}
