//! The chunks of a campaign: runs, and between them looks at what there is and what comes next.
//!
//! A chunk is claimed by one caller, and its result is written once, together with the progress of the campaign; a second copy of the
//! same work finds that and changes nothing. When no chunk is left, the same change puts a look into the queue.

mod rows;
#[cfg(test)]
mod tests;

pub(super) use rows::recover_chunks;

use super::Storage;
use super::change::{Changed, Ready, priority_of};
use super::database::Durability;
use super::life::{ClaimedJob, Ending, end_with, is_running};
use anyhow::Context;
use futures::stream::BoxStream;
use futures::{StreamExt, TryStreamExt};
use rows::{
    add_chunk, campaign_of, count_runs, end_chunk, fail_chunk, give_up, insert_chunks, is_to_end,
    is_wanted, look_if_all_done, next_number, ready_chunk, take_over,
};
use sqlx::Row;
use std::ops::Range;
use uuid::Uuid;

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
    Piece {
        piece: String,
        runs: u64,
        outcomes: String,
    },
    /// Further runs; `runs_total` is how many the campaign now has.
    More {
        chunks: Vec<NewChunk>,
        runs_total: u64,
    },
    /// Nobody can work it off; the campaign fails when the others are done.
    GivenUp,
    /// The campaign ends.
    Ended(Ending),
}

impl Storage {
    /// Makes a claimed job a campaign with its first chunk; what an earlier attempt of the same spec by the same version has made is taken
    /// over. `None` when the attempt is no longer running.
    pub async fn start_campaign(
        &self,
        job: &ClaimedJob,
        runs_total: u64,
    ) -> anyhow::Result<Option<Changed>> {
        let mut transaction = self.begin().await?;
        let id = job.id.to_string();
        if !is_running(&mut transaction, job).await? {
            return Ok(None);
        }
        if is_to_end(&mut transaction, job.id).await? {
            let changed = end_with(&mut transaction, &self.owner, job, &Ending::Canceled).await?;
            transaction.commit().await?;
            return Ok(Some(changed));
        }
        sqlx::query(
            "INSERT INTO campaigns (job_id, runs_total) VALUES ($1, $2) ON CONFLICT DO NOTHING",
        )
        .bind(&id)
        .bind(i64::try_from(runs_total)?)
        .execute(&mut *transaction)
        .await?;
        let taken = take_over(&mut transaction, job.id).await?;
        let kind = if taken == 0 {
            ChunkKind::Pilot
        } else {
            ChunkKind::Look
        };
        // A look needs none.
        let items: Vec<Range<u64>> = (taken == 0).then_some(0..runs_total).into_iter().collect();
        let ready = vec![add_chunk(&mut transaction, job.id, kind, &items).await?];
        transaction.commit().await?;
        Ok(Some(Changed::new(job.id, ready)))
    }

    /// Takes a queued chunk, unless `crash_limit` processes have already died of it. `entry` is as in [`Storage::claim`].
    pub async fn claim_chunk(
        &self,
        job_id: Uuid,
        number: u32,
        entry: Uuid,
        crash_limit: u32,
    ) -> anyhow::Result<Chunk> {
        let mut transaction = self.begin_with(Durability::Passing).await?;
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
        let Some(row) = row else {
            return Ok(Chunk::NotNow);
        };
        let crashes = row.try_get::<i64, _>("crashes")?
            + i64::from(row.try_get::<&str, _>("state")? == "running");
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
        let kind = ChunkKind::ALL
            .into_iter()
            .find(|known| known.name() == kind)
            .context("a stored chunk has an unknown kind")?;
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

    /// How often a process died while it worked on the chunk, with the death that brings this entry again.
    pub async fn chunk_crashes(
        &self,
        job_id: Uuid,
        number: u32,
        entry: Uuid,
    ) -> anyhow::Result<i64> {
        let crashes: Option<i64> = sqlx::query_scalar(
            "SELECT crashes + CASE WHEN state = 'running' AND entry = $3 THEN 1 ELSE 0 END FROM chunks WHERE job_id = $1 AND number = $2",
        )
        .bind(job_id.to_string())
        .bind(i64::from(number))
        .bind(entry.to_string())
        .fetch_optional(&self.work)
        .await?;
        Ok(crashes.unwrap_or(0))
    }

    /// Writes what the claimed attempt gave. `None`: that attempt is no longer wanted, and nothing was written.
    pub async fn finish_chunk(
        &self,
        chunk: &ClaimedChunk,
        result: &ChunkResult,
    ) -> anyhow::Result<Option<Changed>> {
        let mut transaction = self.begin().await?;
        if !is_wanted(&mut transaction, chunk).await? {
            return Ok(None);
        }
        let (job_id, mut ready) = (chunk.job_id, Vec::new());
        match result {
            ChunkResult::Piece {
                piece,
                runs,
                outcomes,
            } => {
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
                let first = next_number(&mut transaction, job_id).await?;
                insert_chunks(&mut transaction, job_id, first, ChunkKind::Runs, chunks).await?;
                ready.extend((first..).zip(chunks).map(|(number, _)| Ready {
                    job_id,
                    chunk: Some(number),
                    priority,
                }));
            }
            ChunkResult::GivenUp => {
                fail_chunk(&mut transaction, chunk).await?;
                ready.extend(look_if_all_done(&mut transaction, job_id).await?);
            }
            ChunkResult::Ended(ending) => {
                let job = campaign_of(&mut transaction, job_id).await?;
                let changed = end_with(&mut transaction, &self.owner, &job, ending).await?;
                transaction.commit().await?;
                return Ok(Some(changed));
            }
        }
        transaction.commit().await?;
        Ok(Some(Changed::new(job_id, ready)))
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
        Ok(Some(Changed {
            touched: Vec::new(),
            ready,
        }))
    }

    /// What the chunks of a campaign have given so far, each as JSON, one after the other.
    pub fn pieces(&self, job_id: Uuid) -> BoxStream<'_, anyhow::Result<String>> {
        let pieces = sqlx::query_scalar(
            "SELECT piece FROM chunks WHERE job_id = $1 AND piece IS NOT NULL ORDER BY number",
        );
        pieces
            .bind(job_id.to_string())
            .fetch(&self.work)
            .map_err(anyhow::Error::from)
            .boxed()
    }

    /// What is kept of each run, as JSON, once that is known.
    pub async fn outcomes(&self, job_id: Uuid) -> anyhow::Result<Option<String>> {
        let outcomes: Option<Option<String>> =
            sqlx::query_scalar("SELECT outcomes FROM campaigns WHERE job_id = $1")
                .bind(job_id.to_string())
                .fetch_optional(&self.work)
                .await?;
        Ok(outcomes.flatten())
    }

    /// The items of each chunk that is given up.
    pub async fn failed_chunks(&self, job_id: Uuid) -> anyhow::Result<Vec<Vec<Range<u64>>>> {
        let rows: Vec<String> = sqlx::query_scalar(
            "SELECT items FROM chunks WHERE job_id = $1 AND state = 'failed' ORDER BY number",
        )
        .bind(job_id.to_string())
        .fetch_all(&self.work)
        .await?;
        rows.iter()
            .map(|json| Ok(serde_json::from_str(json)?))
            .collect()
    }
}
