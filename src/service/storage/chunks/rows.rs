//! The parts that changes of chunks are made of.

use super::{ChunkKind, ClaimedChunk, NewChunk};
use crate::service::storage::change::{
    Changed, Ready, append_event, append_log, append_state, end_crashed, parse_id, priority_of,
};
use crate::service::storage::life::ClaimedJob;
use crate::service::storage::statement::Statement;
use crate::service::storage::{from_micros, now, to_micros};
use crate::service::types::{EventData, JobKind, JobState, Progress, ProgressStep};
use jiff::Timestamp;
use serde_json::Value;
use sqlx::{AnyConnection, Row};
use std::ops::Range;
use std::time::Duration;
use uuid::Uuid;

/// Chunks added with one statement.
const ROWS: usize = 500;

/// Takes the pieces of the job that this one runs again; gives how many.
pub(super) async fn take_over(connection: &mut AnyConnection, id: Uuid) -> anyhow::Result<u64> {
    let earlier: Option<String> = sqlx::query_scalar(
        "SELECT earlier.id FROM jobs JOIN jobs AS earlier ON earlier.id = jobs.rerun_of
         WHERE jobs.id = $1 AND earlier.spec_sha256 = jobs.spec_sha256 AND earlier.engine_version = jobs.engine_version",
    )
    .bind(id.to_string())
    .fetch_optional(&mut *connection)
    .await?;
    let Some(earlier) = earlier else { return Ok(0) };
    let taken = sqlx::query(
        "INSERT INTO chunks (job_id, number, kind, items, state, piece)
         SELECT $1, number, kind, items, 'done', piece FROM chunks WHERE job_id = $2 AND piece IS NOT NULL",
    )
    .bind(id.to_string())
    .bind(&earlier)
    .execute(&mut *connection)
    .await?
    .rows_affected();
    if taken > 0 {
        sqlx::query(
            "UPDATE campaigns SET outcomes = (SELECT outcomes FROM campaigns WHERE job_id = $2),
                 runs_done = (SELECT runs_done FROM campaigns WHERE job_id = $2) WHERE job_id = $1",
        )
        .bind(id.to_string())
        .bind(&earlier)
        .execute(&mut *connection)
        .await?;
        let runs: i64 = sqlx::query_scalar("SELECT runs_done FROM campaigns WHERE job_id = $1")
            .bind(id.to_string())
            .fetch_one(&mut *connection)
            .await?;
        let message = format!("{runs} runs are taken over from job {earlier}");
        append_log(connection, id, now(), &message).await?;
    }
    Ok(taken)
}

pub(super) async fn next_number(
    connection: &mut AnyConnection,
    job_id: Uuid,
) -> anyhow::Result<u32> {
    let last: Option<i64> = sqlx::query_scalar("SELECT max(number) FROM chunks WHERE job_id = $1")
        .bind(job_id.to_string())
        .fetch_one(connection)
        .await?;
    Ok(last
        .map(u32::try_from)
        .transpose()?
        .map_or(0, |last| last + 1))
}

/// Adds chunks, numbered from `first` on; many in one statement, for nobody else writes meanwhile.
pub(super) async fn insert_chunks(
    connection: &mut AnyConnection,
    job_id: Uuid,
    first: u32,
    kind: ChunkKind,
    chunks: &[NewChunk],
) -> anyhow::Result<()> {
    let numbered: Vec<(u32, &NewChunk)> = (first..).zip(chunks).collect();
    for rows in numbered.chunks(ROWS) {
        let mut statement =
            Statement::new("INSERT INTO chunks (job_id, number, kind, items, state) VALUES ");
        for (index, (number, NewChunk(items))) in rows.iter().enumerate() {
            statement
                .push(if index > 0 { ", (" } else { "(" })
                .bind(job_id.to_string())
                .push(", ")
                .bind(i64::from(*number));
            statement
                .push(", ")
                .bind(kind.name().to_owned())
                .push(", ")
                .bind(serde_json::to_string(items)?)
                .push(", 'queued')");
        }
        statement.query().execute(&mut *connection).await?;
    }
    Ok(())
}

/// Whether somebody wants the job to be canceled.
pub(super) async fn is_to_end(connection: &mut AnyConnection, id: Uuid) -> anyhow::Result<bool> {
    let asked: Option<i64> =
        sqlx::query_scalar("SELECT cancel_requested_at FROM jobs WHERE id = $1")
            .bind(id.to_string())
            .fetch_one(connection)
            .await?;
    Ok(asked.is_some())
}

/// One chunk more, ready to be done.
pub(super) async fn add_chunk(
    connection: &mut AnyConnection,
    job_id: Uuid,
    kind: ChunkKind,
    items: &[Range<u64>],
) -> anyhow::Result<Ready> {
    let number = next_number(connection, job_id).await?;
    let chunk = NewChunk(items.to_vec());
    insert_chunks(connection, job_id, number, kind, &[chunk]).await?;
    ready_chunk(connection, job_id, number).await
}

pub(super) async fn ready_chunk(
    connection: &mut AnyConnection,
    job_id: Uuid,
    number: u32,
) -> anyhow::Result<Ready> {
    Ok(Ready {
        job_id,
        chunk: Some(number),
        priority: priority_of(connection, job_id).await?,
    })
}

/// A look at the campaign when nothing is being made.
pub(super) async fn look_if_all_done(
    connection: &mut AnyConnection,
    job_id: Uuid,
) -> anyhow::Result<Vec<Ready>> {
    let left: Option<i64> = sqlx::query_scalar(
        "SELECT number FROM chunks WHERE job_id = $1 AND state IN ('queued', 'running') LIMIT 1",
    )
    .bind(job_id.to_string())
    .fetch_optional(&mut *connection)
    .await?;
    if left.is_some() {
        return Ok(Vec::new());
    }
    Ok(vec![
        add_chunk(connection, job_id, ChunkKind::Look, &[]).await?,
    ])
}

/// A chunk of runs that failed is told of when the others are done; without a look there is no result.
pub(super) async fn give_up(
    connection: &mut AnyConnection,
    job_id: Uuid,
    kind: ChunkKind,
    crash_limit: u32,
) -> anyhow::Result<Changed> {
    if kind == ChunkKind::Look {
        let detail = format!(
            "the process ended {crash_limit} times while it put the runs of the campaign together"
        );
        return end_crashed(connection, job_id, now(), detail).await;
    }
    let ready = look_if_all_done(connection, job_id).await?;
    Ok(Changed::new(job_id, ready))
}

/// Whether the attempt is still running, and its campaign too.
pub(super) async fn is_wanted(
    connection: &mut AnyConnection,
    chunk: &ClaimedChunk,
) -> anyhow::Result<bool> {
    let wanted: i64 = sqlx::query_scalar(
        "SELECT count(*) FROM chunks JOIN jobs ON jobs.id = job_id
         WHERE job_id = $1 AND number = $2 AND chunks.attempt = $3 AND chunks.state = 'running' AND jobs.state = 'running'",
    )
    .bind(chunk.job_id.to_string())
    .bind(i64::from(chunk.number))
    .bind(i64::from(chunk.attempt))
    .fetch_one(connection)
    .await?;
    Ok(wanted == 1)
}

pub(super) async fn end_chunk(
    connection: &mut AnyConnection,
    chunk: &ClaimedChunk,
    piece: Option<&String>,
) -> anyhow::Result<()> {
    sqlx::query("UPDATE chunks SET state = 'done', piece = $1 WHERE job_id = $2 AND number = $3")
        .bind(piece)
        .bind(chunk.job_id.to_string())
        .bind(i64::from(chunk.number))
        .execute(connection)
        .await?;
    Ok(())
}

pub(super) async fn fail_chunk(
    connection: &mut AnyConnection,
    chunk: &ClaimedChunk,
) -> anyhow::Result<()> {
    sqlx::query("UPDATE chunks SET state = 'failed' WHERE job_id = $1 AND number = $2")
        .bind(chunk.job_id.to_string())
        .bind(i64::from(chunk.number))
        .execute(connection)
        .await?;
    Ok(())
}

/// Counts runs as done, and tells how far the campaign is.
pub(super) async fn count_runs(
    connection: &mut AnyConnection,
    job_id: Uuid,
    runs: u64,
    outcomes: &str,
) -> anyhow::Result<()> {
    let row = sqlx::query(
        "UPDATE campaigns SET runs_done = runs_done + $1, outcomes = coalesce(outcomes, $2) WHERE job_id = $3
         RETURNING runs_done, runs_total, told_at, (SELECT started_at FROM jobs WHERE id = job_id) AS started_at",
    )
    .bind(i64::try_from(runs)?)
    .bind(outcomes)
    .bind(job_id.to_string())
    .fetch_one(&mut *connection)
    .await?;
    let (done, total) = (
        row.try_get::<i64, _>("runs_done")?.cast_unsigned(),
        row.try_get::<i64, _>("runs_total")?.cast_unsigned(),
    );
    let (at, started_at) = (now(), from_micros(row.try_get("started_at")?)?);
    let elapsed =
        Duration::from_micros(u64::try_from(to_micros(at) - to_micros(started_at)).unwrap_or(0));
    let fraction = if total == 0 {
        0.0
    } else {
        (done as f64 / total as f64).min(1.0)
    };
    let progress = Progress {
        step: ProgressStep::Run,
        done,
        total,
        fraction,
        eta_s: Progress::left_s(elapsed, fraction),
    };
    sqlx::query("UPDATE jobs SET progress = $1 WHERE id = $2")
        .bind(serde_json::to_string(&progress)?)
        .bind(job_id.to_string())
        .execute(&mut *connection)
        .await?;
    let pause = i64::try_from(Progress::pause_after(elapsed).as_micros())?;
    if done == total || to_micros(at) - row.try_get::<i64, _>("told_at")? >= pause {
        tell(connection, job_id, at, progress).await?;
    }
    Ok(())
}

pub(super) async fn tell(
    connection: &mut AnyConnection,
    job_id: Uuid,
    at: Timestamp,
    progress: Progress,
) -> anyhow::Result<()> {
    sqlx::query("UPDATE campaigns SET told_at = $1 WHERE job_id = $2")
        .bind(to_micros(at))
        .bind(job_id.to_string())
        .execute(&mut *connection)
        .await?;
    append_event(connection, job_id, at, &EventData::Progress(progress)).await
}

/// The running campaign as the job that it is.
pub(super) async fn campaign_of(
    connection: &mut AnyConnection,
    id: Uuid,
) -> anyhow::Result<ClaimedJob> {
    let row = sqlx::query("SELECT name, attempt FROM jobs WHERE id = $1")
        .bind(id.to_string())
        .fetch_one(connection)
        .await?;
    let attempt = u32::try_from(row.try_get::<i64, _>("attempt")?)?;
    Ok(ClaimedJob {
        id,
        kind: JobKind::Campaign,
        name: row.try_get("name")?,
        spec: Value::Null,
        attempt,
    })
}

/// Puts chunks that an earlier process left running back into the queue.
pub(in crate::service::storage) async fn recover_chunks(
    connection: &mut AnyConnection,
) -> anyhow::Result<()> {
    let rows =
        sqlx::query("SELECT DISTINCT job_id FROM chunks WHERE state = 'running' ORDER BY job_id")
            .fetch_all(&mut *connection)
            .await?;
    sqlx::query(
        "UPDATE chunks SET state = 'queued', crashes = crashes + 1 WHERE state = 'running'",
    )
    .execute(&mut *connection)
    .await?;
    for row in rows {
        let id = parse_id(row.try_get("job_id")?)?;
        append_state(connection, id, now(), JobState::Running).await?;
        let message =
            "the process ended while it ran the campaign; its unfinished runs are queued again";
        append_log(connection, id, now(), message).await?;
    }
    Ok(())
}
