//! The chunks of a campaign: runs, and between them looks at what there is and what comes next.
//!
//! A chunk is claimed by one caller, and its result is written once, together with the progress of the campaign; a second copy of the
//! same work finds that and changes nothing. When no chunk is left, the same change puts a look into the queue.

use super::change::{Changed, Ready, append_event, append_state, end_job, parse_id, priority_of};
use super::life::{ClaimedJob, Ending, end_with};
use super::{Storage, from_micros, now, to_micros};
use crate::service::types::{EventData, JobKind, JobState, LogLine, Problem, Progress, ProgressStep};
use anyhow::Context;
use jiff::Timestamp;
use serde_json::Value;
use sqlx::{AnyConnection, Row};
use std::ops::Range;
use std::time::Duration;
use uuid::Uuid;

/// Progress becomes an event at most this often, and ever less often in long campaigns.
const PAUSE: Duration = Duration::from_millis(250);
const LONGEST_PAUSE: Duration = Duration::from_secs(5);
const SHARE_OF_ELAPSED: u32 = 100;
/// No estimate of the rest before this much is known.
const ETA_AFTER: (f64, f64) = (0.5, 0.02);

/// What a chunk does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ChunkKind {
    /// The first runs, as many as a short time allows: they tell how long runs take and what numbers they have.
    Pilot,
    Runs,
    /// Looks at all pieces, and cuts further runs or makes the result.
    Look,
}

impl ChunkKind {
    const ALL: [ChunkKind; 3] = [ChunkKind::Pilot, ChunkKind::Runs, ChunkKind::Look];

    fn name(self) -> &'static str {
        match self {
            ChunkKind::Pilot => "pilot",
            ChunkKind::Runs => "runs",
            ChunkKind::Look => "look",
        }
    }
}

/// A chunk that this caller, and nobody else, now works on.
#[derive(Debug, Clone)]
pub struct ClaimedChunk {
    pub job_id: Uuid,
    pub number: u32,
    pub kind: ChunkKind,
    pub items: Vec<Range<u64>>,
    pub attempt: u32,
    /// What is kept of each run, as JSON, once that is known.
    pub outcomes: Option<String>,
    pub runs_done: u64,
    pub runs_total: u64,
}

/// What came of asking for a chunk.
#[derive(Debug)]
pub enum Chunk {
    Run(ClaimedChunk),
    /// It had been running too often when the process died; it has failed.
    Refused(Changed),
    /// It is not queued, or its campaign has ended.
    NotNow,
}

/// A chunk to add.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NewChunk(pub Vec<Range<u64>>);

/// What a chunk gave.
#[derive(Debug)]
pub enum ChunkResult {
    /// Runs; `piece` and `outcomes` are JSON.
    Piece { piece: String, runs: u64, outcomes: String },
    /// Further runs; `runs_total` is how many the campaign now has.
    More { chunks: Vec<NewChunk>, runs_total: u64 },
    /// The campaign ends.
    Ended(Ending),
}

impl Storage {
    /// Makes a claimed job a campaign with its first chunk; what an earlier attempt of the same spec by the same version has made is taken
    /// over. `None` when the attempt is no longer running.
    pub async fn start_campaign(&self, job: &ClaimedJob, runs_total: u64) -> anyhow::Result<Option<Changed>> {
        let mut transaction = self.begin().await?;
        let id = job.id.to_string();
        let is_running: i64 = sqlx::query_scalar("SELECT count(*) FROM jobs WHERE id = $1 AND attempt = $2 AND state = 'running'")
            .bind(&id)
            .bind(i64::from(job.attempt))
            .fetch_one(&mut *transaction)
            .await?;
        if is_running == 0 {
            return Ok(None);
        }
        sqlx::query("INSERT INTO campaigns (job_id, runs_total) VALUES ($1, $2) ON CONFLICT DO NOTHING")
            .bind(&id)
            .bind(i64::try_from(runs_total)?)
            .execute(&mut *transaction)
            .await?;
        let taken = take_over(&mut transaction, job.id).await?;
        let kind = if taken == 0 { ChunkKind::Pilot } else { ChunkKind::Look };
        let items = if taken == 0 { vec![0..runs_total] } else { Vec::new() };
        let number = add_chunk(&mut transaction, job.id, kind, &items).await?;
        let ready = vec![ready_chunk(&mut transaction, job.id, number).await?];
        transaction.commit().await?;
        Ok(Some(Changed { touched: vec![job.id], ready }))
    }

    /// Takes a queued chunk, unless `crash_limit` processes have already died of it. `entry` is as in [`Storage::claim`].
    pub async fn claim_chunk(&self, job_id: Uuid, number: u32, entry: Uuid, crash_limit: u32) -> anyhow::Result<Chunk> {
        let mut transaction = self.begin().await?;
        let row = sqlx::query(
            "SELECT chunks.kind, items, chunks.state, chunks.attempt, chunks.crashes, outcomes, runs_done, runs_total
             FROM chunks JOIN jobs ON jobs.id = chunks.job_id JOIN campaigns ON campaigns.job_id = chunks.job_id
             WHERE chunks.job_id = $1 AND number = $2 AND jobs.state = 'running'
                 AND (chunks.state = 'queued' OR chunks.state = 'running' AND chunks.entry = $3)",
        )
        .bind(job_id.to_string())
        .bind(i64::from(number))
        .bind(entry.to_string())
        .fetch_optional(&mut *transaction)
        .await?;
        let Some(row) = row else { return Ok(Chunk::NotNow) };
        let crashes = row.try_get::<i64, _>("crashes")? + i64::from(row.try_get::<&str, _>("state")? == "running");
        let attempt = row.try_get::<i64, _>("attempt")? + 1;
        let is_refused = crashes >= i64::from(crash_limit);
        sqlx::query("UPDATE chunks SET state = $1, attempt = $2, crashes = $3, entry = $4 WHERE job_id = $5 AND number = $6")
            .bind(if is_refused { "failed" } else { "running" })
            .bind(attempt)
            .bind(crashes)
            .bind(entry.to_string())
            .bind(job_id.to_string())
            .bind(i64::from(number))
            .execute(&mut *transaction)
            .await?;
        let kind: &str = row.try_get("kind")?;
        let kind = ChunkKind::ALL.into_iter().find(|known| known.name() == kind).context("a stored chunk has an unknown kind")?;
        if is_refused {
            let changed = give_up(&mut transaction, job_id, kind, crash_limit).await?;
            transaction.commit().await?;
            return Ok(Chunk::Refused(changed));
        }
        transaction.commit().await?;
        Ok(Chunk::Run(ClaimedChunk {
            job_id,
            number,
            kind,
            items: serde_json::from_str(row.try_get("items")?)?,
            attempt: u32::try_from(attempt)?,
            outcomes: row.try_get("outcomes")?,
            runs_done: row.try_get::<i64, _>("runs_done")?.cast_unsigned(),
            runs_total: row.try_get::<i64, _>("runs_total")?.cast_unsigned(),
        }))
    }

    /// How often a process died while it worked on the chunk.
    pub async fn chunk_crashes(&self, job_id: Uuid, number: u32) -> anyhow::Result<i64> {
        let crashes: Option<i64> = sqlx::query_scalar("SELECT crashes FROM chunks WHERE job_id = $1 AND number = $2")
            .bind(job_id.to_string())
            .bind(i64::from(number))
            .fetch_optional(&self.read)
            .await?;
        Ok(crashes.unwrap_or(0))
    }

    /// Writes what the claimed attempt gave. `None`: that attempt is no longer wanted, and nothing was written.
    pub async fn finish_chunk(&self, chunk: &ClaimedChunk, result: &ChunkResult) -> anyhow::Result<Option<Changed>> {
        let mut transaction = self.begin().await?;
        if !is_wanted(&mut transaction, chunk).await? {
            return Ok(None);
        }
        let (job_id, mut ready) = (chunk.job_id, Vec::new());
        match result {
            ChunkResult::Piece { piece, runs, outcomes } => {
                end_chunk(&mut transaction, chunk, Some(piece)).await?;
                count_runs(&mut transaction, job_id, *runs, outcomes).await?;
                ready.extend(look_if_all_done(&mut transaction, job_id).await?);
            }
            ChunkResult::More { chunks, runs_total } => {
                end_chunk(&mut transaction, chunk, None).await?;
                sqlx::query("UPDATE campaigns SET runs_total = $1 WHERE job_id = $2")
                    .bind(i64::try_from(*runs_total)?)
                    .bind(job_id.to_string())
                    .execute(&mut *transaction)
                    .await?;
                let priority = priority_of(&mut transaction, job_id).await?;
                for NewChunk(items) in chunks {
                    let number = add_chunk(&mut transaction, job_id, ChunkKind::Runs, items).await?;
                    ready.push(Ready { job_id, chunk: Some(number), priority });
                }
            }
            ChunkResult::Ended(ending) => {
                let job = campaign_of(&mut transaction, job_id).await?;
                let changed = end_with(&mut transaction, &job, ending).await?;
                transaction.commit().await?;
                return Ok(Some(changed));
            }
        }
        transaction.commit().await?;
        Ok(Some(Changed { touched: vec![job_id], ready }))
    }

    /// Hands the claimed attempt back to the queue, because the service stops.
    pub async fn release_chunk(&self, chunk: &ClaimedChunk) -> anyhow::Result<Option<Changed>> {
        let mut transaction = self.begin().await?;
        if !is_wanted(&mut transaction, chunk).await? {
            return Ok(None);
        }
        sqlx::query("UPDATE chunks SET state = 'queued', enqueued_at = NULL WHERE job_id = $1 AND number = $2")
            .bind(chunk.job_id.to_string())
            .bind(i64::from(chunk.number))
            .execute(&mut *transaction)
            .await?;
        let ready = vec![ready_chunk(&mut transaction, chunk.job_id, chunk.number).await?];
        transaction.commit().await?;
        Ok(Some(Changed { touched: Vec::new(), ready }))
    }

    /// What the chunks of a campaign have given so far, as JSON.
    pub async fn pieces(&self, job_id: Uuid) -> anyhow::Result<Vec<String>> {
        let pieces = sqlx::query_scalar("SELECT piece FROM chunks WHERE job_id = $1 AND piece IS NOT NULL ORDER BY number");
        Ok(pieces.bind(job_id.to_string()).fetch_all(&self.read).await?)
    }

    /// What is kept of each run, as JSON, once that is known.
    pub async fn outcomes(&self, job_id: Uuid) -> anyhow::Result<Option<String>> {
        let outcomes: Option<Option<String>> = sqlx::query_scalar("SELECT outcomes FROM campaigns WHERE job_id = $1")
            .bind(job_id.to_string())
            .fetch_optional(&self.read)
            .await?;
        Ok(outcomes.flatten())
    }

    /// The items of each chunk that is given up.
    pub async fn failed_chunks(&self, job_id: Uuid) -> anyhow::Result<Vec<Vec<Range<u64>>>> {
        let rows: Vec<String> = sqlx::query_scalar("SELECT items FROM chunks WHERE job_id = $1 AND state = 'failed' ORDER BY number")
            .bind(job_id.to_string())
            .fetch_all(&self.read)
            .await?;
        rows.iter().map(|json| Ok(serde_json::from_str(json)?)).collect()
    }
}

/// Takes the pieces of the job that this one runs again; gives how many.
async fn take_over(connection: &mut AnyConnection, id: Uuid) -> anyhow::Result<u64> {
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
        append_event(connection, id, now(), &EventData::Log(LogLine { message })).await?;
    }
    Ok(taken)
}

async fn add_chunk(connection: &mut AnyConnection, job_id: Uuid, kind: ChunkKind, items: &[Range<u64>]) -> anyhow::Result<u32> {
    let number: i64 = sqlx::query_scalar(
        "INSERT INTO chunks (job_id, number, kind, items, state)
         SELECT $1, coalesce(max(number) + 1, 0), $2, $3, 'queued' FROM chunks WHERE job_id = $1 RETURNING number",
    )
    .bind(job_id.to_string())
    .bind(kind.name())
    .bind(serde_json::to_string(items)?)
    .fetch_one(connection)
    .await?;
    Ok(u32::try_from(number)?)
}

async fn ready_chunk(connection: &mut AnyConnection, job_id: Uuid, number: u32) -> anyhow::Result<Ready> {
    Ok(Ready { job_id, chunk: Some(number), priority: priority_of(connection, job_id).await? })
}

/// A look at the campaign when nothing is being made.
async fn look_if_all_done(connection: &mut AnyConnection, job_id: Uuid) -> anyhow::Result<Vec<Ready>> {
    let left: i64 = sqlx::query_scalar("SELECT count(*) FROM chunks WHERE job_id = $1 AND state IN ('queued', 'running')")
        .bind(job_id.to_string())
        .fetch_one(&mut *connection)
        .await?;
    if left > 0 {
        return Ok(Vec::new());
    }
    let number = add_chunk(connection, job_id, ChunkKind::Look, &[]).await?;
    Ok(vec![ready_chunk(connection, job_id, number).await?])
}

/// A chunk of runs that failed is told of when the others are done; without a look there is no result.
async fn give_up(connection: &mut AnyConnection, job_id: Uuid, kind: ChunkKind, crash_limit: u32) -> anyhow::Result<Changed> {
    if kind == ChunkKind::Look {
        let detail = format!("the process ended {crash_limit} times while it put the runs of the campaign together");
        return end_job(connection, job_id, now(), JobState::Failed, Some(Problem::new("crashed", detail))).await;
    }
    Ok(Changed { touched: vec![job_id], ready: look_if_all_done(connection, job_id).await? })
}

/// Whether the attempt is still running, and its campaign too.
async fn is_wanted(connection: &mut AnyConnection, chunk: &ClaimedChunk) -> anyhow::Result<bool> {
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

async fn end_chunk(connection: &mut AnyConnection, chunk: &ClaimedChunk, piece: Option<&String>) -> anyhow::Result<()> {
    sqlx::query("UPDATE chunks SET state = 'done', piece = $1 WHERE job_id = $2 AND number = $3")
        .bind(piece)
        .bind(chunk.job_id.to_string())
        .bind(i64::from(chunk.number))
        .execute(connection)
        .await?;
    Ok(())
}

/// Counts runs as done, and tells how far the campaign is.
async fn count_runs(connection: &mut AnyConnection, job_id: Uuid, runs: u64, outcomes: &str) -> anyhow::Result<()> {
    let row = sqlx::query(
        "UPDATE campaigns SET runs_done = runs_done + $1, outcomes = coalesce(outcomes, $2) WHERE job_id = $3
         RETURNING runs_done, runs_total, told_at, (SELECT started_at FROM jobs WHERE id = job_id) AS started_at",
    )
    .bind(i64::try_from(runs)?)
    .bind(outcomes)
    .bind(job_id.to_string())
    .fetch_one(&mut *connection)
    .await?;
    let (done, total) = (row.try_get::<i64, _>("runs_done")?.cast_unsigned(), row.try_get::<i64, _>("runs_total")?.cast_unsigned());
    let (at, started_at) = (now(), from_micros(row.try_get("started_at")?)?);
    let elapsed = Duration::from_micros(u64::try_from(to_micros(at) - to_micros(started_at)).unwrap_or(0));
    let progress = progress_of(done, total, elapsed.as_secs_f64());
    sqlx::query("UPDATE jobs SET progress = $1 WHERE id = $2")
        .bind(serde_json::to_string(&progress)?)
        .bind(job_id.to_string())
        .execute(&mut *connection)
        .await?;
    let pause = (elapsed / SHARE_OF_ELAPSED).clamp(PAUSE, LONGEST_PAUSE);
    if done == total || to_micros(at) - row.try_get::<i64, _>("told_at")? >= i64::try_from(pause.as_micros())? {
        tell(connection, job_id, at, progress).await?;
    }
    Ok(())
}

fn progress_of(done: u64, total: u64, elapsed_s: f64) -> Progress {
    let fraction = if total == 0 { 0.0 } else { (done as f64 / total as f64).min(1.0) };
    let is_known = elapsed_s > ETA_AFTER.0 && fraction > ETA_AFTER.1;
    let eta_s = is_known.then(|| elapsed_s * (1.0 - fraction) / fraction);
    Progress { step: ProgressStep::Run, done, total, fraction, eta_s }
}

async fn tell(connection: &mut AnyConnection, job_id: Uuid, at: Timestamp, progress: Progress) -> anyhow::Result<()> {
    sqlx::query("UPDATE campaigns SET told_at = $1 WHERE job_id = $2")
        .bind(to_micros(at))
        .bind(job_id.to_string())
        .execute(&mut *connection)
        .await?;
    append_event(connection, job_id, at, &EventData::Progress(progress)).await
}

/// The running campaign as the job that it is.
async fn campaign_of(connection: &mut AnyConnection, id: Uuid) -> anyhow::Result<ClaimedJob> {
    let row = sqlx::query("SELECT name, attempt FROM jobs WHERE id = $1").bind(id.to_string()).fetch_one(connection).await?;
    let attempt = u32::try_from(row.try_get::<i64, _>("attempt")?)?;
    Ok(ClaimedJob { id, kind: JobKind::Campaign.into(), name: row.try_get("name")?, spec: Value::Null, attempt })
}

/// Puts chunks that an earlier process left running back into the queue.
pub(super) async fn recover_chunks(connection: &mut AnyConnection) -> anyhow::Result<()> {
    let rows =
        sqlx::query("SELECT DISTINCT job_id FROM chunks WHERE state = 'running' ORDER BY job_id").fetch_all(&mut *connection).await?;
    sqlx::query("UPDATE chunks SET state = 'queued', crashes = crashes + 1 WHERE state = 'running'").execute(&mut *connection).await?;
    for row in rows {
        let id = parse_id(row.try_get("job_id")?)?;
        append_state(connection, id, now(), JobState::Running).await?;
        let message = "the process ended while it ran the campaign; its unfinished runs are queued again".to_owned();
        append_event(connection, id, now(), &EventData::Log(LogLine { message })).await?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::service::storage::{Admission, Cancellation, Claim, Database, NewJob};

    async fn storage() -> (Storage, tempfile::TempDir) {
        let directory = tempfile::tempdir().unwrap();
        (Storage::open(&Database::Sqlite(directory.path().join("app.db"))).await.unwrap(), directory)
    }

    async fn admitted(storage: &Storage, rerun_of: Option<Uuid>) -> Uuid {
        let new = NewJob {
            kind: JobKind::Campaign,
            name: None,
            labels: Default::default(),
            spec: "{}".into(),
            spec_sha256: "x".into(),
            seed: 1,
            priority: 40,
            engine_version: "0",
            sources: Vec::new(),
            rerun_of,
            idempotency: None,
        };
        let Admission::Admitted(id, _) = storage.admit(&new, 100).await.unwrap() else { panic!("it is not admitted") };
        id
    }

    /// A campaign of ten runs, started; and what is ready then.
    async fn started(storage: &Storage, rerun_of: Option<Uuid>) -> (Uuid, Vec<Ready>) {
        let id = admitted(storage, rerun_of).await;
        let Claim::Run(job) = storage.claim(id, Uuid::now_v7(), 3).await.unwrap() else { panic!("it is not claimed") };
        let changed = storage.start_campaign(&job, 10).await.unwrap().unwrap();
        (id, changed.ready)
    }

    async fn claimed(storage: &Storage, id: Uuid, number: u32, entry: Uuid) -> Option<ClaimedChunk> {
        match storage.claim_chunk(id, number, entry, 3).await.unwrap() {
            Chunk::Run(chunk) => Some(chunk),
            _ => None,
        }
    }

    fn piece(runs: u64) -> ChunkResult {
        ChunkResult::Piece { piece: format!("piece of {runs}"), runs, outcomes: "[]".into() }
    }

    fn ready(id: Uuid, numbers: &[u32]) -> Vec<Ready> {
        numbers.iter().map(|&number| Ready { job_id: id, chunk: Some(number), priority: 40 }).collect()
    }

    /// Works chunk 0 off and cuts two more of four and three runs.
    async fn cut(storage: &Storage, id: Uuid) {
        let entry = Uuid::now_v7();
        let pilot = claimed(storage, id, 0, entry).await.unwrap();
        assert_eq!((pilot.kind, pilot.outcomes.as_deref(), &pilot.items), (ChunkKind::Pilot, None, &vec![0..10]));
        assert_eq!(storage.finish_chunk(&pilot, &piece(3)).await.unwrap().unwrap().ready, ready(id, &[1]));
        let look = claimed(storage, id, 1, entry).await.unwrap();
        assert_eq!((look.kind, look.outcomes.as_deref(), look.runs_done), (ChunkKind::Look, Some("[]"), 3));
        let more = ChunkResult::More { chunks: vec![NewChunk(vec![3..7]), NewChunk(vec![7..10])], runs_total: 10 };
        assert_eq!(storage.finish_chunk(&look, &more).await.unwrap().unwrap().ready, ready(id, &[2, 3]));
    }

    #[tokio::test]
    async fn a_campaign_goes_from_its_pilot_over_looks_to_its_end() {
        let (storage, _directory) = storage().await;
        let (id, first) = started(&storage, None).await;
        assert_eq!(first, ready(id, &[0]));
        cut(&storage, id).await;
        let two = claimed(&storage, id, 2, Uuid::now_v7()).await.unwrap();
        let three = claimed(&storage, id, 3, Uuid::now_v7()).await.unwrap();
        assert_eq!((&two.items, &three.items), (&vec![3..7], &vec![7..10]));
        assert_eq!(storage.finish_chunk(&three, &piece(3)).await.unwrap().unwrap().ready, []);
        let progress = storage.job(id).await.unwrap().unwrap().job.progress.unwrap();
        assert_eq!((progress.done, progress.total, progress.fraction), (6, 10, 0.6));
        assert_eq!(storage.finish_chunk(&two, &piece(4)).await.unwrap().unwrap().ready, ready(id, &[4]), "the last one calls for a look");
        assert_eq!(storage.pieces(id).await.unwrap(), ["piece of 3", "piece of 4", "piece of 3"]);
        let look = claimed(&storage, id, 4, Uuid::now_v7()).await.unwrap();
        let ending = Ending::Succeeded { artifacts: Vec::new(), warnings: Vec::new() };
        storage.finish_chunk(&look, &ChunkResult::Ended(ending)).await.unwrap().unwrap();
        assert_eq!(storage.job(id).await.unwrap().unwrap().job.state, JobState::Succeeded);
        assert!(storage.pieces(id).await.unwrap().is_empty(), "its runs are in its files");
        assert!(storage.ready(false).await.unwrap().is_empty());
    }

    #[tokio::test]
    async fn of_many_who_claim_a_chunk_one_gets_it_and_only_its_result_counts() {
        let (storage, _directory) = storage().await;
        let (id, _) = started(&storage, None).await;
        let claims = futures::future::join_all((0..10).map(|_| claimed(&storage, id, 0, Uuid::now_v7()))).await;
        assert_eq!(claims.iter().flatten().map(|chunk| chunk.attempt).collect::<Vec<_>>(), [1]);
        let first = claims.into_iter().flatten().next().unwrap();
        // The queue gives the same entry out again when the first to have it is taken for dead.
        let entry: String = sqlx::query_scalar("SELECT entry FROM chunks").fetch_one(&storage.read).await.unwrap();
        let second = claimed(&storage, id, 0, parse_id(&entry).unwrap()).await.unwrap();
        assert_eq!((second.attempt, storage.chunk_crashes(id, 0).await.unwrap()), (2, 1));
        assert_eq!(storage.finish_chunk(&first, &piece(5)).await.unwrap(), None, "the first was given up");
        assert!(storage.finish_chunk(&second, &piece(5)).await.unwrap().is_some());
        assert_eq!(storage.finish_chunk(&second, &piece(5)).await.unwrap(), None, "it has ended");
        assert_eq!(storage.release_chunk(&second).await.unwrap(), None);
        assert_eq!(storage.job(id).await.unwrap().unwrap().job.progress.unwrap().done, 5);
    }

    #[tokio::test]
    async fn a_chunk_that_was_running_at_three_deaths_is_given_up_after_the_others() {
        let (storage, _directory) = storage().await;
        let (id, _) = started(&storage, None).await;
        cut(&storage, id).await;
        for _ in 0..3 {
            assert!(claimed(&storage, id, 2, Uuid::now_v7()).await.is_some());
            storage.recover().await.unwrap();
        }
        let refused = storage.claim_chunk(id, 2, Uuid::now_v7(), 3).await.unwrap();
        let Chunk::Refused(changed) = refused else { panic!("{refused:?}") };
        assert_eq!(changed.ready, [], "another chunk is still to be done");
        let three = claimed(&storage, id, 3, Uuid::now_v7()).await.unwrap();
        assert_eq!(storage.finish_chunk(&three, &piece(3)).await.unwrap().unwrap().ready, ready(id, &[4]));
        assert_eq!(storage.failed_chunks(id).await.unwrap(), [vec![3..7]]);
    }

    #[tokio::test]
    async fn a_look_that_kills_ends_the_campaign() {
        let (storage, _directory) = storage().await;
        let (id, _) = started(&storage, None).await;
        let pilot = claimed(&storage, id, 0, Uuid::now_v7()).await.unwrap();
        storage.finish_chunk(&pilot, &piece(10)).await.unwrap();
        for _ in 0..3 {
            assert!(claimed(&storage, id, 1, Uuid::now_v7()).await.is_some());
            storage.recover().await.unwrap();
        }
        assert!(matches!(storage.claim_chunk(id, 1, Uuid::now_v7(), 3).await.unwrap(), Chunk::Refused(_)));
        let job = storage.job(id).await.unwrap().unwrap().job;
        assert_eq!((job.state, job.error.unwrap().code.as_str()), (JobState::Failed, "crashed"));
    }

    #[tokio::test]
    async fn a_canceled_campaign_leaves_its_runs_to_the_one_that_runs_it_again() {
        let (storage, _directory) = storage().await;
        let (id, _) = started(&storage, None).await;
        cut(&storage, id).await;
        let two = claimed(&storage, id, 2, Uuid::now_v7()).await.unwrap();
        assert!(matches!(storage.cancel(id).await.unwrap(), Cancellation::Canceled(_)));
        assert_eq!(storage.finish_chunk(&two, &piece(4)).await.unwrap(), None);
        assert!(claimed(&storage, id, 3, Uuid::now_v7()).await.is_none());
        assert!(storage.ready(false).await.unwrap().is_empty());
        let (again, first) = started(&storage, Some(id)).await;
        assert_eq!(first, ready(again, &[1]), "no pilot, but a look at what is there");
        assert_eq!(storage.pieces(again).await.unwrap(), ["piece of 3"]);
        let look = claimed(&storage, again, 1, Uuid::now_v7()).await.unwrap();
        assert_eq!((look.kind, look.runs_done, look.outcomes.as_deref()), (ChunkKind::Look, 3, Some("[]")));
    }
}
