//! What happens to a chunk of a campaign: claimed, worked off on a thread of its own, and its result written once.

use super::control::{Control, Stop};
use super::meter::Meter;
use super::report::{self, ReportInput, Timing};
use super::runner::{Failure, Product, load};
use super::submit::planned;
use super::{Inner, JobsError};
use crate::experiment::campaign::{Campaign, Items, Next, Order, Outcome, Piece};
use crate::experiment::plan::{JobKind, Plan};
use crate::experiment::run::{Inputs, RunError};
use crate::service::engine::Entry;
use crate::service::storage::{Chunk, ChunkKind, ChunkResult, ClaimedChunk, ClaimedJob, Ending, NewChunk};
use crate::service::types::{CampaignResult, CampaignSoFar, JobState, Problem};
use anyhow::Context;
use futures::FutureExt;
use serde::Deserialize;
use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;
use tokio::sync::{OwnedSemaphorePermit, watch};
use uuid::Uuid;

/// The first runs take about this long, to tell how long the others will.
const PILOT: Duration = Duration::from_millis(250);
/// A chunk of runs takes about this long; in a campaign of very many longer, towards its end less.
const CHUNK: Duration = Duration::from_secs(2);
const SHORTEST_CHUNK: Duration = Duration::from_millis(250);
const MOST_CHUNKS: u32 = 10_000;
/// Campaigns whose cells and data are kept between chunks.
const KEPT: usize = 4;

/// A campaign with its cells and data, ready for its runs.
pub(super) struct Loaded {
    plan: Plan,
    campaign: Arc<Campaign>,
    inputs: Inputs,
    read: Vec<ReportInput>,
}

/// The campaigns of which chunks were worked off lately.
#[derive(Default)]
pub(super) struct Campaigns(Mutex<VecDeque<(Uuid, Arc<Loaded>)>>);

impl Campaigns {
    fn get(&self, id: Uuid) -> Option<Arc<Loaded>> {
        let kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        kept.iter().find(|(known, _)| *known == id).map(|(_, loaded)| loaded.clone())
    }

    fn keep(&self, id: Uuid, loaded: Arc<Loaded>) {
        let mut kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        kept.retain(|(known, _)| *known != id);
        kept.push_back((id, loaded));
        while kept.len() > KEPT {
            kept.pop_front();
        }
    }

    pub(super) fn forget(&self, id: Uuid) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).retain(|(known, _)| *known != id);
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

impl Inner {
    /// Makes the claimed job a campaign: its chunks follow.
    pub(super) async fn start_campaign(&self, job: &ClaimedJob) -> anyhow::Result<()> {
        let control = self.begin((job.id, None));
        let runs_total = self.loaded(job.id, control.sign()).await.map(|loaded| loaded.campaign.total());
        let begun = runs_total.map_err(|failure| self.ending_of(job.id, "the job", &control, failure));
        let changed = self
            .written(job.id, || match &begun {
                Ok(runs_total) => self.storage.start_campaign(job, *runs_total).boxed(),
                Err(Some(ending)) => self.storage.finish(job, ending).boxed(),
                Err(None) => self.storage.release(job).boxed(),
            })
            .await;
        self.running.unregister((job.id, None));
        self.publish(changed?.unwrap_or_default()).await;
        Ok(())
    }

    pub(super) async fn look_at_chunk(&self, entry: Entry, number: u32, permit: OwnedSemaphorePermit) -> anyhow::Result<()> {
        let job_id = entry.job_id;
        match self.storage.claim_chunk(job_id, number, entry.id, self.config.crash_limit).await? {
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

    async fn make_chunk(&self, chunk: &ClaimedChunk, control: &Arc<Control>, permit: OwnedSemaphorePermit) -> Result<Made, Failure> {
        let loaded = self.loaded(chunk.job_id, control.sign()).await?;
        // Progress is told with each chunk that ends; a chunk is short.
        let tell = |_| async {}.boxed();
        if chunk.kind != ChunkKind::Look {
            let (job_id, chunk) = (chunk.job_id, chunk.clone());
            let work = move |mut meter: Meter| make_runs(&chunk, &loaded, &mut meter);
            return self.on_thread(job_id, JobKind::Campaign, control, permit, work, tell).await;
        }
        let failed = self.storage.failed_chunks(chunk.job_id).await?;
        if let Some(items) = failed.first() {
            let problem = given_up(&loaded.campaign, items, failed.len(), self.config.crash_limit);
            return Ok(Made::Result(ChunkResult::Ended(Ending::Failed(problem))));
        }
        let (pieces, outcomes) = (self.storage.pieces(chunk.job_id).await?, self.storage.outcomes(chunk.job_id).await?);
        let id = chunk.job_id;
        let work = move |meter: Meter| look(id, &loaded, &read_pieces(&pieces)?, &read_outcomes(outcomes.as_deref())?, &meter);
        self.on_thread(id, JobKind::Campaign, control, permit, work, tell).await
    }

    /// Writes what came of the chunk; an error means that somebody has to work it off again.
    async fn conclude_chunk(&self, chunk: &ClaimedChunk, control: &Control, made: Result<Made, Failure>) -> anyhow::Result<()> {
        // Until the end is written, the files belong to nobody; nobody may sweep them up meanwhile.
        let _no_sweeping = if let Ok(Made::Report(_)) = &made { Some(self.surely_no_sweeping().await?) } else { None };
        let kept = match made {
            Ok(Made::Result(result)) => Ok(result),
            Ok(Made::Report(product)) => self.keep(product).await.map(ChunkResult::Ended).map_err(Failure::Internal),
            Err(failure) => Err(failure),
        };
        let result = match kept {
            Ok(result) => Some(result),
            Err(failure) => self.ending_of(chunk.job_id, "a chunk of the campaign", control, failure).map(ChunkResult::Ended),
        };
        let changed = self
            .written(chunk.job_id, || match &result {
                Some(result) => self.storage.finish_chunk(chunk, result).boxed(),
                None => self.storage.release_chunk(chunk).boxed(),
            })
            .await?;
        let Some(changed) = changed else { return Ok(()) };
        if let Some(ChunkResult::Ended(_)) = result {
            self.campaigns.forget(chunk.job_id);
            self.running.stop(chunk.job_id, Stop::Canceled);
        }
        self.publish(changed).await;
        Ok(())
    }

    /// What the runs that are made say of the cells, while others are still being made or after they were given up.
    pub(super) async fn cells_so_far(&self, id: Uuid) -> Result<CampaignSoFar, JobsError> {
        let job = self.job(id).await?;
        if job.kind != crate::service::types::JobKind::Campaign {
            let detail = format!("the job is of the kind '{}'; only a campaign has cells", job.kind.name());
            return Err(JobsError::NotThere(detail));
        }
        if job.state == JobState::Succeeded {
            let path = self.artifact(id, "report.json").await?.path;
            let read = move || anyhow::Ok(serde_json::from_slice::<WithResult>(&std::fs::read(&path)?)?.result);
            let result = tokio::task::spawn_blocking(read).await.context("reading a report panicked")?.context("a report is damaged")?;
            let runs = result.cells.iter().map(|cell| cell.runs).sum();
            return Ok(CampaignSoFar { is_final: true, runs, result });
        }
        let Some(outcomes) = self.storage.outcomes(id).await? else {
            return Err(JobsError::conflict("result_not_ready", format!("the job is {}, and no run has been made yet", job.state.name())));
        };
        let pieces = self.storage.pieces(id).await?;
        let loaded = self.loaded(id, watch::channel(None).1).await.map_err(|_| anyhow::anyhow!("the campaign could not be loaded"))?;
        let report = move || -> anyhow::Result<CampaignSoFar> {
            let (outcome, runs) = loaded.campaign.report_so_far(read_pieces(&pieces)?, &read_outcomes(Some(&outcomes))?)?;
            Ok(CampaignSoFar { is_final: false, runs, result: serde_json::from_value(outcome.result)? })
        };
        Ok(tokio::task::spawn_blocking(report).await.context("putting runs together panicked")??)
    }

    /// The campaign with its data: kept from an earlier chunk, or planned and read.
    async fn loaded(&self, id: Uuid, sign: watch::Receiver<Option<Stop>>) -> Result<Arc<Loaded>, Failure> {
        if let Some(loaded) = self.campaigns.get(id) {
            return Ok(loaded);
        }
        let spec = self.storage.spec(id).await?;
        let plan = planned(JobKind::Campaign, spec).await?.map_err(Failure::Faults)?;
        let located = self.locate(&plan).await?;
        let mut meter = Meter::new(JobKind::Campaign, sign, watch::Sender::new(None));
        let read = move || -> Result<Loaded, Failure> {
            let (inputs, read) = load(&plan, located, &mut meter)?;
            let campaign = plan.campaign.clone().context("a campaign has no cells")?;
            Ok(Loaded { plan, campaign, inputs, read })
        };
        let loaded = Arc::new(tokio::task::spawn_blocking(read).await.context("reading data panicked")??);
        self.campaigns.keep(id, loaded.clone());
        Ok(loaded)
    }
}

fn read_pieces(pieces: &[String]) -> anyhow::Result<Vec<Piece>> {
    pieces.iter().map(|json| serde_json::from_str(json)).collect::<Result<_, _>>().context("a stored piece is damaged")
}

fn read_outcomes(json: Option<&str>) -> anyhow::Result<Vec<Outcome>> {
    json.map_or(Ok(Vec::new()), serde_json::from_str).context("stored outcomes are damaged")
}

fn make_runs(chunk: &ClaimedChunk, loaded: &Loaded, meter: &mut Meter) -> Result<Made, Failure> {
    let is_pilot = chunk.kind == ChunkKind::Pilot;
    let items = match is_pilot.then(|| loaded.campaign.next(&[])) {
        Some(Next::Runs { items, .. }) => items,
        _ => chunk.items.clone(),
    };
    let outcomes = chunk.outcomes.as_deref().map(|json| read_outcomes(Some(json))).transpose()?;
    let order = Order { items, outcomes, enough: is_pilot.then_some(PILOT), done: chunk.runs_done, total: chunk.runs_total };
    let (piece, outcomes) = loaded.campaign.make(order, &loaded.inputs, meter)?;
    let json = |error: serde_json::Error| Failure::Internal(error.into());
    Ok(Made::Result(ChunkResult::Piece {
        runs: piece.len() as u64,
        outcomes: serde_json::to_string(&outcomes).map_err(json)?,
        piece: serde_json::to_string(&piece).map_err(json)?,
    }))
}

/// Cuts what is missing into chunks, or makes the report.
fn look(id: Uuid, loaded: &Loaded, pieces: &[Piece], outcomes: &[Outcome], meter: &Meter) -> Result<Made, Failure> {
    let campaign = &loaded.campaign;
    if let Next::Runs { items, spared } = campaign.next(pieces) {
        let target = CHUNK.max(campaign.cost(&items, pieces) / MOST_CHUNKS);
        let chunks = campaign.cut(items, pieces, SHORTEST_CHUNK, target).into_iter().map(NewChunk).collect();
        return Ok(Made::Result(ChunkResult::More { chunks, runs_total: campaign.total() - spared }));
    }
    let outcome = campaign.report(pieces, outcomes)?;
    let spent_s = pieces.iter().map(Piece::spent).sum::<Duration>().as_secs_f64();
    let timing = meter.timing();
    let timing = Timing { total_s: timing.total_s + spent_s, ..timing };
    let report = report::build(id, &loaded.plan, &loaded.read, &outcome, timing).map_err(|error| Failure::Internal(error.into()))?;
    Ok(Made::Report(Product { artifacts: outcome.artifacts, report, warnings: outcome.warnings }))
}

/// The end of a campaign that has chunks nobody can work off.
fn given_up(campaign: &Campaign, items: &[Items], chunks: usize, crash_limit: u32) -> Problem {
    let runs: u64 = items.iter().map(|range| range.end - range.start).sum();
    let place = items.first().map_or_else(String::new, |range| format!(", from {} on", campaign.name_of(range.start)));
    let others = if chunks > 1 { format!("; so it was with {} other parts", chunks - 1) } else { String::new() };
    let detail = format!(
        "the process ended {crash_limit} times while it made {runs} of the runs{place}{others}; all other runs are kept for when the job is rerun"
    );
    Problem::new("crashed", detail)
}

impl From<RunError> for Failure {
    fn from(error: RunError) -> Self {
        match error {
            RunError::Stopped => Failure::Stopped,
            RunError::Faults(faults) => Failure::Faults(faults),
        }
    }
}

impl From<anyhow::Error> for Failure {
    fn from(error: anyhow::Error) -> Self {
        Failure::Internal(error)
    }
}
