//! What happens to a chunk of a campaign: claimed, worked off by a child, and its result written once.

use super::Jobs;
use super::control::{Control, Stop};
use super::runner::Product;
use super::submit::planned;
use crate::experiment::campaign::{Campaign, Items};
use crate::experiment::{CampaignResult, JobKind};
use crate::service::child::Failure;
use crate::service::child::{self, CampaignOrder, Looked, Order, Runs, unexpected};
use crate::service::datasets::{Located, local_files};
use crate::service::engine::Entry;
use crate::service::error::ServiceError;
use crate::service::storage::{
    Chunk, ChunkKind, ChunkResult, ClaimedChunk, ClaimedJob, Ending, NewChunk,
};
use crate::service::types::{CampaignSoFar, JobState, Problem};
use anyhow::Context;
use futures::{FutureExt, TryStreamExt};
use serde::Deserialize;
use serde_json::Value;
use std::collections::VecDeque;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use tokio::fs::File;
use tokio::io::{AsyncWriteExt, BufWriter};
use tokio::sync::OwnedSemaphorePermit;
use uuid::Uuid;

/// Campaigns of which the cells and the places of the data are kept between chunks.
const KEPT: usize = 4;

/// A campaign, and what a child has to be told of it.
pub(super) struct Known {
    spec: Value,
    campaign: Arc<Campaign>,
    located: Vec<Option<Located>>,
}

/// The campaigns of which chunks were worked off lately.
#[derive(Default)]
pub(super) struct Campaigns(Mutex<VecDeque<(Uuid, Arc<Known>)>>);

impl Campaigns {
    fn get(&self, id: Uuid) -> Option<Arc<Known>> {
        let kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        kept.iter()
            .find(|(kept_id, _)| *kept_id == id)
            .map(|(_, known)| known.clone())
    }

    fn keep(&self, id: Uuid, known: Arc<Known>) {
        let mut kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        kept.retain(|(kept_id, _)| *kept_id != id);
        kept.push_back((id, known));
        while kept.len() > KEPT {
            kept.pop_front();
        }
    }

    pub(super) fn forget(&self, id: Uuid) {
        self.0
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .retain(|(kept_id, _)| *kept_id != id);
    }
}

/// The part of a campaign's report that is read again.
#[derive(Deserialize)]
struct WithResult {
    result: CampaignResult,
}

/// What a chunk made, before files are kept.
enum Made {
    Result(ChunkResult),
    Report(Product),
}

impl Jobs {
    /// Makes the claimed job a campaign: its chunks follow.
    pub(super) async fn start_campaign(&self, job: &ClaimedJob) -> anyhow::Result<()> {
        let control = self.begin((job.id, None));
        let runs_total = self.known(job.id).await.map(|known| known.campaign.total());
        let begun =
            runs_total.map_err(|failure| self.ending_of(job.id, "the job", &control, failure));
        let changed = self
            .written(job.id, || match &begun {
                Ok(runs_total) => self.storage.start_campaign(job, *runs_total).boxed(),
                Err(Some(ending)) => self.storage.finish(job, ending).boxed(),
                Err(None) => self.storage.release(job).boxed(),
            })
            .await;
        self.running.unregister((job.id, None));
        self.publish_or_do_again(changed?, (job.id, None)).await
    }

    pub(super) async fn look_at_chunk(
        &self,
        entry: Entry,
        number: u32,
        permit: OwnedSemaphorePermit,
    ) -> anyhow::Result<()> {
        let job_id = entry.job_id;
        match self
            .storage
            .claim_chunk(job_id, number, entry.id, self.config.crash_limit)
            .await?
        {
            Chunk::NotNow => Ok(()),
            Chunk::Refused(changed) => {
                self.publish(changed).await;
                Ok(())
            }
            Chunk::Run(chunk) => {
                let control = self.begin((job_id, Some(number)));
                let made = self.make_chunk(&chunk, &control, permit).await;
                let written = self.conclude_chunk(&chunk, &control, made).await;
                self.running.unregister((job_id, Some(number)));
                written
            }
        }
    }

    async fn make_chunk(
        &self,
        chunk: &ClaimedChunk,
        control: &Control,
        permit: OwnedSemaphorePermit,
    ) -> Result<Made, Failure> {
        let known = self.known(chunk.job_id).await?;
        if chunk.kind == ChunkKind::Look {
            return self
                .look_at_pieces(chunk.job_id, &known, control, permit)
                .await;
        }
        let runs = Runs {
            is_pilot: chunk.kind == ChunkKind::Pilot,
            items: chunk.items.clone(),
            outcomes: chunk.outcomes.clone(),
            done: chunk.runs_done,
            total: chunk.runs_total,
        };
        let order = Order::Runs {
            campaign: known.order(chunk.job_id).await?,
            runs,
        };
        // Progress is told with each chunk that ends; a chunk is short.
        match self
            .in_child(chunk.job_id, order, control, permit, |_| async {}.boxed())
            .await?
        {
            child::Made::Piece {
                piece,
                runs,
                outcomes,
            } => Ok(Made::Result(ChunkResult::Piece {
                piece,
                runs,
                outcomes,
            })),
            made => Err(unexpected(&made).into()),
        }
    }

    async fn look_at_pieces(
        &self,
        id: Uuid,
        known: &Known,
        control: &Control,
        permit: OwnedSemaphorePermit,
    ) -> Result<Made, Failure> {
        let failed = self.storage.failed_chunks(id).await?;
        if let Some(items) = failed.first() {
            let problem = given_up(&known.campaign, items, failed.len());
            return Ok(Made::Result(ChunkResult::Ended(Ending::Failed(problem))));
        }
        let directory = self.directory()?;
        let order = Order::Look {
            campaign: known.order(id).await?,
            pieces: self.write_pieces(id, directory.path()).await?,
            outcomes: self.storage.outcomes(id).await?,
            directory: directory.path().to_owned(),
        };
        match self
            .in_child(id, order, control, permit, |_| async {}.boxed())
            .await?
        {
            child::Made::Looked(Looked::More { chunks, runs_total }) => {
                Ok(Made::Result(ChunkResult::More {
                    chunks: chunks.into_iter().map(NewChunk).collect(),
                    runs_total,
                }))
            }
            child::Made::Looked(Looked::Report { files, warnings }) => Ok(Made::Report(Product {
                files,
                warnings,
                directory,
            })),
            made => Err(unexpected(&made).into()),
        }
    }

    /// Writes the pieces of a campaign into a file, however many they are.
    async fn write_pieces(&self, id: Uuid, directory: &Path) -> anyhow::Result<PathBuf> {
        let path = directory.join("pieces");
        let file = File::create(&path)
            .await
            .with_context(|| format!("cannot write {}", path.display()))?;
        let (mut file, mut pieces) = (BufWriter::new(file), self.storage.pieces(id));
        while let Some(piece) = pieces.try_next().await? {
            file.write_all(piece.as_bytes()).await?;
            file.write_all(b"\n").await?;
        }
        file.flush().await?;
        Ok(path)
    }

    /// Writes what came of the chunk; an error means that somebody has to work it off again.
    async fn conclude_chunk(
        &self,
        chunk: &ClaimedChunk,
        control: &Control,
        made: Result<Made, Failure>,
    ) -> anyhow::Result<()> {
        // Until the end is written, the files belong to nobody; nobody may sweep them up meanwhile.
        let _no_sweeping = if let Ok(Made::Report(_)) = &made {
            Some(self.surely_no_sweeping().await?)
        } else {
            None
        };
        let kept = match made {
            Ok(Made::Result(result)) => Ok(result),
            Ok(Made::Report(product)) => self
                .keep(product)
                .await
                .map(ChunkResult::Ended)
                .map_err(Failure::Internal),
            Err(failure) => Err(failure),
        };
        let result = match kept {
            Ok(result) => Some(result),
            // The others are made first: the runs of a campaign that failed are kept for another.
            Err(Failure::Died(how)) if chunk.kind != ChunkKind::Look => {
                tracing::error!(job_id = %chunk.job_id, error = format!("{how:#}"), "runs of a campaign are given up: their process died twice");
                Some(ChunkResult::GivenUp)
            }
            Err(failure) => self
                .ending_of(chunk.job_id, "a chunk of the campaign", control, failure)
                .map(ChunkResult::Ended),
        };
        let changed = self
            .written(chunk.job_id, || match &result {
                Some(result) => self.storage.finish_chunk(chunk, result).boxed(),
                None => self.storage.release_chunk(chunk).boxed(),
            })
            .await?;
        if changed.is_some() && matches!(result, Some(ChunkResult::Ended(_))) {
            self.campaigns.forget(chunk.job_id);
            self.children.forget(chunk.job_id);
            self.running.stop(chunk.job_id, Stop::Canceled);
        }
        self.publish_or_do_again(changed, (chunk.job_id, Some(chunk.number)))
            .await
    }

    /// What the runs that are made say of the cells, while others are still being made or after they were given up.
    pub async fn cells(&self, id: Uuid) -> Result<CampaignSoFar, ServiceError> {
        let job = self.get(id).await?;
        if job.kind != JobKind::Campaign {
            let detail = format!(
                "the job is of the kind '{}'; only a campaign has cells",
                job.kind.name()
            );
            return Err(ServiceError::NotThere(detail));
        }
        if job.state == JobState::Succeeded {
            let content = self.artifact(id, "report.json").await?.content;
            let read =
                move || anyhow::Ok(serde_json::from_slice::<WithResult>(&content.read()?)?.result);
            let result = tokio::task::spawn_blocking(read)
                .await
                .context("reading a report panicked")?
                .context("a report is damaged")?;
            let runs = result.cells.iter().map(|cell| cell.runs).sum();
            return Ok(CampaignSoFar {
                is_final: true,
                runs,
                result,
            });
        }
        let Some(outcomes) = self.storage.outcomes(id).await? else {
            return Err(ServiceError::conflict(
                "result_not_ready",
                format!(
                    "the job is {}, and no run has been made yet",
                    job.state.name()
                ),
            ));
        };
        let directory = self.directory()?;
        let pieces = self.write_pieces(id, directory.path()).await?;
        let known = self
            .known(id)
            .await
            .map_err(|_| anyhow::anyhow!("the campaign could not be planned"))?;
        let order = Order::SoFar {
            campaign: known.order(id).await?,
            pieces,
            outcomes,
        };
        match self.looks.ask(order, "putting the runs together").await? {
            child::Made::SoFar { runs, result } => {
                let result = serde_json::from_str(result.get())
                    .context("the result of a campaign is another")?;
                Ok(CampaignSoFar {
                    is_final: false,
                    runs,
                    result,
                })
            }
            made => Err(unexpected(&made).into()),
        }
    }

    /// The campaign: kept from an earlier chunk, or planned.
    async fn known(&self, id: Uuid) -> Result<Arc<Known>, Failure> {
        if let Some(known) = self.campaigns.get(id) {
            return Ok(known);
        }
        let spec = self.storage.spec(id).await?;
        let plan = planned(JobKind::Campaign, spec.clone())
            .await?
            .map_err(Failure::Faults)?;
        let located = self.locate(&plan).await?;
        let campaign = plan.job_as().context("it is no campaign")?;
        let known = Arc::new(Known {
            spec,
            campaign,
            located,
        });
        self.campaigns.keep(id, known.clone());
        Ok(known)
    }
}

impl Known {
    async fn order(&self, id: Uuid) -> anyhow::Result<CampaignOrder> {
        Ok(CampaignOrder {
            id,
            spec: self.spec.clone(),
            inputs: local_files(self.located.clone()).await?,
        })
    }
}

/// The end of a campaign that has chunks nobody can work off.
fn given_up(campaign: &Campaign, items: &[Items], chunks: usize) -> Problem {
    let runs: u64 = items.iter().map(|range| range.end - range.start).sum();
    let place = items.first().map_or_else(String::new, |range| {
        format!(", from {} on", campaign.name_of(range.start))
    });
    let others = if chunks > 1 {
        format!("; so it was with {} other parts", chunks - 1)
    } else {
        String::new()
    };
    let detail = format!(
        "the process ended again and again while it made {runs} of the runs{place}{others}; all other runs are kept for when the job is rerun"
    );
    Problem::new("crashed", detail)
}
