//! What a child does for campaigns: runs, looks at what there is, and results.

use super::protocol::{CampaignOrder, Looked, Made, Runs};
use super::work::{internal, leave, load};
use crate::experiment::campaign::{Campaign, ChunkRequest, ChunkResult, Next, Outcome};
use crate::experiment::{self, Inputs, JobKind, Plan};
use crate::service::child::Failure;
use crate::service::child::meter::Meter;
use crate::service::child::report;
use crate::service::types::{ReportInput, Timing};
use anyhow::Context;
use serde_json::value::to_raw_value;
use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;
use uuid::Uuid;

/// The first runs take about this long, to tell how long the others will.
const PILOT: Duration = Duration::from_millis(250);
/// A chunk of runs takes about this long; in a campaign of very many longer, towards its end less.
const CHUNK: Duration = Duration::from_secs(2);
const SHORTEST_CHUNK: Duration = Duration::from_millis(250);
const MOST_CHUNKS: u32 = 10_000;

/// A campaign with its cells and data, ready for its runs.
struct Loaded {
    id: Uuid,
    plan: Plan,
    campaign: Arc<Campaign>,
    inputs: Inputs,
    read: Vec<ReportInput>,
}

/// The campaign of which a chunk was worked off last; only one, since its data count towards the memory of what comes next.
#[derive(Default)]
pub(super) struct Kept(Option<Loaded>);

impl Kept {
    /// Forgets what is not of this campaign.
    pub(super) fn only(&mut self, id: Option<Uuid>) {
        if self.0.as_ref().is_some_and(|loaded| Some(loaded.id) != id) {
            self.0 = None;
        }
    }

    fn loaded(&mut self, order: CampaignOrder, meter: &mut Meter) -> Result<&Loaded, Failure> {
        let loaded = match self.0.take() {
            Some(loaded) if loaded.id == order.id => loaded,
            _ => {
                let plan =
                    experiment::plan(JobKind::Campaign, &order.spec).map_err(Failure::Faults)?;
                let (inputs, read) = load(&plan, order.inputs, meter)?;
                let campaign = plan.job_as().context("it is no campaign")?;
                Loaded {
                    id: order.id,
                    plan,
                    campaign,
                    inputs,
                    read,
                }
            }
        };
        Ok(self.0.insert(loaded))
    }

    pub(super) fn make_runs(
        &mut self,
        campaign: CampaignOrder,
        runs: Runs,
        meter: &mut Meter,
    ) -> Result<Made, Failure> {
        let loaded = self.loaded(campaign, meter)?;
        let items = match runs.is_pilot.then(|| loaded.campaign.next(&[])) {
            Some(Next::Runs { items, .. }) => items,
            _ => runs.items,
        };
        let outcomes = runs
            .outcomes
            .as_deref()
            .map(|json| read_outcomes(Some(json)))
            .transpose()?;
        let request = ChunkRequest {
            items,
            outcomes,
            enough: runs.is_pilot.then_some(PILOT),
            done: runs.done,
            total: runs.total,
        };
        let (piece, outcomes) = loaded.campaign.make(request, &loaded.inputs, meter)?;
        Ok(Made::Piece {
            runs: piece.len() as u64,
            outcomes: serde_json::to_string(&outcomes).map_err(internal)?,
            piece: serde_json::to_string(&piece).map_err(internal)?,
        })
    }

    /// Cuts what is missing into chunks, or makes the report.
    pub(super) fn look(
        &mut self,
        order: CampaignOrder,
        pieces: &Path,
        outcomes: Option<&str>,
        directory: &Path,
        meter: &mut Meter,
    ) -> Result<Made, Failure> {
        let loaded = self.loaded(order, meter)?;
        let (pieces, outcomes) = (read_pieces(pieces)?, read_outcomes(outcomes)?);
        let campaign = &loaded.campaign;
        if let Next::Runs { items, skipped } = campaign.next(&pieces) {
            let target = CHUNK.max(campaign.cost(&items, &pieces) / MOST_CHUNKS);
            let chunks = campaign.cut(items, &pieces, SHORTEST_CHUNK, target);
            return Ok(Made::Looked(Looked::More {
                chunks,
                runs_total: campaign.total() - skipped,
            }));
        }
        let outcome = campaign.report(&pieces, &outcomes)?;
        let spent_s = pieces
            .iter()
            .map(ChunkResult::spent)
            .sum::<Duration>()
            .as_secs_f64();
        let timing = meter.timing();
        let timing = Timing {
            total_s: timing.total_s + spent_s,
            ..timing
        };
        let report = report::build(loaded.id, &loaded.plan, &loaded.read, &outcome, timing)
            .map_err(internal)?;
        let made = Looked::Report {
            files: leave(directory, outcome.artifacts, report)?,
            warnings: outcome.warnings,
        };
        // Nothing more is asked of it.
        self.0 = None;
        Ok(Made::Looked(made))
    }

    pub(super) fn so_far(
        &mut self,
        order: CampaignOrder,
        pieces: &Path,
        outcomes: &str,
        meter: &mut Meter,
    ) -> Result<Made, Failure> {
        let loaded = self.loaded(order, meter)?;
        let (outcome, runs) = loaded
            .campaign
            .report_so_far(read_pieces(pieces)?, &read_outcomes(Some(outcomes))?)?;
        Ok(Made::SoFar {
            runs,
            result: to_raw_value(&outcome.result).map_err(internal)?,
        })
    }
}

fn read_pieces(path: &Path) -> anyhow::Result<Vec<ChunkResult>> {
    let file = File::open(path).with_context(|| format!("cannot open {}", path.display()))?;
    let mut pieces = Vec::new();
    for line in BufReader::new(file).lines() {
        pieces.push(
            serde_json::from_str(&line.context("cannot read the pieces")?)
                .context("a stored piece is damaged")?,
        );
    }
    Ok(pieces)
}

fn read_outcomes(json: Option<&str>) -> anyhow::Result<Vec<Outcome>> {
    json.map_or(Ok(Vec::new()), serde_json::from_str)
        .context("stored outcomes are damaged")
}
