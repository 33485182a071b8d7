//! The parts that every change of a job is made of: an event, an end, and what an end means for the jobs that wait.

use super::to_micros;
use crate::service::types::{EventData, JobEnd, JobState, LogLine, Problem, StateChange};
use jiff::Timestamp;
use sqlx::{AnyConnection, Row};
use uuid::Uuid;

/// What the rest of the service has to know of a committed change.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Changed {
    /// Jobs that have new events.
    pub touched: Vec<Uuid>,
    /// What can be done now.
    pub ready: Vec<Ready>,
}

/// A job, or a chunk of a campaign, that can be done now.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Ready {
    pub job_id: Uuid,
    pub chunk: Option<u32>,
    /// Greater goes first.
    pub priority: i64,
}

impl Changed {
    pub(super) fn new(id: Uuid, ready: Vec<Ready>) -> Self {
        Changed {
            touched: vec![id],
            ready,
        }
    }

    /// A change of the job that makes nothing ready.
    pub fn touch(id: Uuid) -> Self {
        Changed::new(id, Vec::new())
    }
}

pub(super) async fn append_event(
    connection: &mut AnyConnection,
    id: Uuid,
    at: Timestamp,
    data: &EventData,
) -> anyhow::Result<()> {
    let seq: i64 = sqlx::query_scalar(
        "UPDATE jobs SET last_seq = last_seq + 1 WHERE id = $1 RETURNING last_seq",
    )
    .bind(id.to_string())
    .fetch_one(&mut *connection)
    .await?;
    sqlx::query("INSERT INTO job_events (job_id, seq, type, at, data) VALUES ($1, $2, $3, $4, $5)")
        .bind(id.to_string())
        .bind(seq)
        .bind(data.type_name())
        .bind(to_micros(at))
        .bind(serde_json::to_string(data)?)
        .execute(connection)
        .await?;
    Ok(())
}

pub(super) async fn append_log(
    connection: &mut AnyConnection,
    id: Uuid,
    at: Timestamp,
    message: &str,
) -> anyhow::Result<()> {
    let message = message.to_owned();
    append_event(connection, id, at, &EventData::Log(LogLine { message })).await
}

/// Tells the job's present state as an event.
pub(super) async fn append_state(
    connection: &mut AnyConnection,
    id: Uuid,
    at: Timestamp,
    state: JobState,
) -> anyhow::Result<()> {
    let attempt: i64 = sqlx::query_scalar("SELECT attempt FROM jobs WHERE id = $1")
        .bind(id.to_string())
        .fetch_one(&mut *connection)
        .await?;
    let attempt = u32::try_from(attempt)?;
    let data = EventData::State(StateChange { state, attempt });
    append_event(connection, id, at, &data).await
}

/// Ends a job that ended the process that ran it, too often.
pub(super) async fn end_crashed(
    connection: &mut AnyConnection,
    id: Uuid,
    at: Timestamp,
    detail: String,
) -> anyhow::Result<Changed> {
    let problem = Problem::new("crashed", detail);
    end_job(connection, id, at, JobState::Failed, Some(problem)).await
}

/// Ends a job, and with it every job that needed its result and now cannot have it.
pub(super) async fn end_job(
    connection: &mut AnyConnection,
    id: Uuid,
    at: Timestamp,
    state: JobState,
    error: Option<Problem>,
) -> anyhow::Result<Changed> {
    let mut changed = Changed::default();
    let mut ended = vec![(id, state, error)];
    while let Some((id, state, error)) = ended.pop() {
        write_end(connection, id, at, state, error).await?;
        changed.touched.push(id);
        if state == JobState::Succeeded {
            changed
                .ready
                .extend(ready_dependents(connection, id).await?);
            continue;
        }
        for waiting in queued_dependents(connection, id).await? {
            let problem = dependency_failed(id, state);
            ended.push((waiting, JobState::Failed, Some(problem)));
        }
    }
    Ok(changed)
}

pub(super) fn dependency_failed(id: Uuid, state: JobState) -> Problem {
    let how = if state == JobState::Canceled {
        "was canceled"
    } else {
        "failed"
    };
    Problem::new(
        "dependency_failed",
        format!("job {id}, whose result this job needs, {how}"),
    )
}

async fn write_end(
    connection: &mut AnyConnection,
    id: Uuid,
    at: Timestamp,
    state: JobState,
    error: Option<Problem>,
) -> anyhow::Result<()> {
    let json = error.as_ref().map(serde_json::to_string).transpose()?;
    sqlx::query("UPDATE jobs SET state = $1, finished_at = $2, error = $3 WHERE id = $4")
        .bind(state.name())
        .bind(to_micros(at))
        .bind(json)
        .bind(id.to_string())
        .execute(&mut *connection)
        .await?;
    // What is left of a campaign: nobody makes it any more, and the runs of one that succeeded are in its files.
    let kept = if state == JobState::Succeeded {
        ""
    } else {
        "done"
    };
    sqlx::query("DELETE FROM chunks WHERE job_id = $1 AND state <> $2")
        .bind(id.to_string())
        .bind(kept)
        .execute(&mut *connection)
        .await?;
    append_state(connection, id, at, state).await?;
    let data = EventData::Done(JobEnd { state, error });
    append_event(connection, id, at, &data).await
}

async fn queued_dependents(connection: &mut AnyConnection, id: Uuid) -> anyhow::Result<Vec<Uuid>> {
    let rows = sqlx::query(
        "SELECT jobs.id FROM job_dependencies JOIN jobs ON jobs.id = job_id
         WHERE source_kind = 'job' AND source_id = $1 AND state = 'queued' ORDER BY created_at, jobs.id",
    )
    .bind(id.to_string())
    .fetch_all(connection)
    .await?;
    rows.iter().map(|row| parse_id(row.try_get(0)?)).collect()
}

/// The queued jobs that needed this one and now miss nothing.
async fn ready_dependents(connection: &mut AnyConnection, id: Uuid) -> anyhow::Result<Vec<Ready>> {
    let mut ready = Vec::new();
    for waiting in queued_dependents(connection, id).await? {
        if unfinished_dependencies(connection, waiting).await? == 0 {
            ready.push(ready_job(connection, waiting).await?);
        }
    }
    Ok(ready)
}

/// The job as something to be done.
pub(super) async fn ready_job(
    connection: &mut AnyConnection,
    job_id: Uuid,
) -> anyhow::Result<Ready> {
    Ok(Ready {
        job_id,
        chunk: None,
        priority: priority_of(connection, job_id).await?,
    })
}

pub(super) async fn priority_of(connection: &mut AnyConnection, id: Uuid) -> anyhow::Result<i64> {
    Ok(
        sqlx::query_scalar("SELECT priority FROM jobs WHERE id = $1")
            .bind(id.to_string())
            .fetch_one(connection)
            .await?,
    )
}

pub(super) async fn unfinished_dependencies(
    connection: &mut AnyConnection,
    id: Uuid,
) -> anyhow::Result<i64> {
    let count = sqlx::query_scalar(
        "SELECT count(*) FROM job_dependencies JOIN jobs ON jobs.id = source_id
         WHERE source_kind = 'job' AND job_id = $1 AND state <> 'succeeded'",
    )
    .bind(id.to_string())
    .fetch_one(connection)
    .await?;
    Ok(count)
}

pub(super) fn parse_id(text: &str) -> anyhow::Result<Uuid> {
    Ok(Uuid::try_parse(text)?)
}
