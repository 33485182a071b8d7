//! A campaign: one job run many times over a grid of its parameters, with means, intervals and paired differences.
//!
//! Run r of every cell draws from the same named streams, so cells that differ in the method alone see the same scenes, and
//! their differences are taken run by run. The runs of all cells take turns, so that times compare as well.
//!
//! The runs are made in chunks, anywhere and in any order: what is to be made next, and in the end the result, depends on the chunks alone.

mod axes;
mod cells;
mod chunks;
mod limits;
mod outcomes;
#[cfg(feature = "parquet")]
mod parquet;
mod placing;
mod shares;
mod spec;
mod stages;
mod stop;
mod tables;

pub use chunks::{ChunkRequest, ChunkResult, Items};
pub use outcomes::{CampaignResult, Outcome};
pub use spec::CAMPAIGN;
pub use stages::Next;

use super::job::{
    self, CellTime, Cost, InputRequest, Job, Known, KnownInputs, Planner, RunError, Work, to_value,
    unsign_zeros,
};
use super::limits::Limit;
use super::observer::Observer;
use super::request::draft::{Draft, Planned};
use crate::experiment::input::known::cost_of;
use crate::math::rng::Seed;
use crate::math::stats;
use crate::model::fault::Fault;
use axes::Axis;
use cells::Cell;
use chunks::CollectedRuns;
use outcomes::{CellReport, Judge};
use spec::Spec;
use stop::{Ended, Stop};

/// Longer campaigns are refused.
const MAX_COST_S: f64 = 7.0 * 86_400.0;

/// Numbers kept, over all cells, runs and outcomes.
const MAX_NUMBERS: f64 = 50e6;

/// Outcomes that are reckoned with where none are listed: about what all metrics together have.
const UNLISTED_OUTCOMES: usize = 100;

/// Plans a campaign.
///
/// # Errors
/// All faults of the request, those of its base and its cells with where the campaign makes them.
pub fn plan(mut draft: Draft, planner: Planner) -> Result<Planned, Vec<Fault>> {
    let spec: Spec = draft.typed(|draft| {
        // What the table says of a base that is missing, it has said.
        let base = draft.at("/base");
        base.map_or_else(Vec::new, |base| cells::faults_of_base(base, planner))
    })?;
    let axes: Vec<Axis> = spec.grid.iter().cloned().map(Axis::from).collect();
    let cells = cells::cells_of(&spec, &axes, planner)?;
    let cost = cost_of_runs(&cells, spec.runs);
    draft.add(too_large(&spec, cells.len(), cost.cost_s));
    let compared = reference_point(&spec, &axes).unwrap_or_else(|fault| {
        draft.add([*fault]);
        None
    });
    let outcomes = spec.outcomes.as_deref().unwrap_or_default();
    draft.add(outcomes::named_twice(outcomes));
    let stop = Stop::new(&spec).unwrap_or_else(|fault| {
        draft.add([*fault]);
        None
    });
    draft.add(different_data(&cells));
    let inputs = inputs_of(&cells);
    draft.finish(inputs, cost, |spec: Spec| Campaign {
        cells,
        axes,
        compared,
        stop,
        outcomes: spec.outcomes,
        runs: spec.runs,
        timed_runs: spec.timed_runs,
        confidence: spec.confidence,
        seed: spec.seed,
        limits: spec.limits,
    })
}

fn cost_of_runs(cells: &[Cell], runs: u32) -> Cost {
    let runs = f64::from(runs);
    let detections: f64 = cells
        .iter()
        .map(|cell| cell.plan.cost.detections as f64)
        .sum();
    let cost_s: f64 = cells.iter().map(|cell| cell.plan.cost.cost_s).sum();
    Cost {
        detections: (detections * runs) as u64,
        cost_s: cost_s * runs,
        bytes: 0,
    }
}

fn too_large(spec: &Spec, cells: usize, cost_s: f64) -> Option<Fault> {
    let runs = spec.runs;
    let outcomes = spec.outcomes.as_ref().map_or(UNLISTED_OUTCOMES, Vec::len);
    let numbers = cells as f64 * f64::from(runs) * outcomes as f64;
    if cost_s <= MAX_COST_S && numbers <= MAX_NUMBERS {
        return None;
    }
    let detail = format!(
        "{cells} cells with {runs} runs each are about {cost_s:.0} s of work and {numbers:.0} numbers"
    );
    Some(
        Fault::new("/runs", "too_large", detail)
            .allowing(format!("at most {MAX_COST_S} s and {MAX_NUMBERS} numbers")),
    )
}

/// A checked campaign with its cells.
pub struct Campaign {
    cells: Vec<Cell>,
    axes: Vec<Axis>,
    /// The axis along which cells are compared, and its point that the others are compared with.
    compared: Option<(usize, usize)>,
    stop: Option<Stop>,
    /// The outcomes that the request lists; else the first run tells what there is.
    outcomes: Option<Vec<Outcome>>,
    runs: u32,
    timed_runs: u32,
    confidence: f64,
    seed: u32,
    /// What the cells must meet.
    limits: Vec<Limit>,
}

/// What is loaded once for all runs.
fn inputs_of(cells: &[Cell]) -> Vec<InputRequest> {
    let placed = |input: &InputRequest| InputRequest {
        pointer: format!("/base{}", input.pointer),
        ..input.clone()
    };
    let first = cells.first().map_or(&[][..], |cell| &cell.plan.inputs);
    first.iter().map(placed).collect()
}

/// Every cell needs the same.
fn different_data(cells: &[Cell]) -> Option<Fault> {
    let first = cells.first()?;
    let other = cells
        .iter()
        .find(|cell| cell.plan.inputs != first.plan.inputs)?;
    let detail = format!(
        "the cells '{}' and '{}' read different data",
        first.name, other.name
    );
    Some(Fault::new("/grid", "unsupported", detail).allowing("cells that read the same data"))
}

/// The axis along which cells are compared, and its point that the others are compared with.
fn reference_point(spec: &Spec, axes: &[Axis]) -> Result<Option<(usize, usize)>, Box<Fault>> {
    let Some(last) = axes.len().checked_sub(1) else {
        return Ok(None);
    };
    let Some(compare) = &spec.compare else {
        return Ok(Some((last, 0)));
    };
    let (name, to) = (&compare.axis, &compare.to);
    let Some(axis) = axes.iter().position(|axis| axis.name == *name) else {
        let known: Vec<&str> = axes.iter().map(|axis| axis.name.as_str()).collect();
        let detail = format!("there is no axis '{name}'");
        let fault = Fault::new("/compare/axis", "unknown_value", detail);
        return Err(Box::new(fault.allowing(known.join(", "))));
    };
    let Some(point) = axes[axis].point_named(to) else {
        let detail = format!("axis '{name}' has no point '{to}'");
        let fault = Fault::new("/compare/to", "unknown_value", detail);
        return Err(Box::new(fault.allowing(axes[axis].point_names())));
    };
    Ok(Some((axis, point)))
}

impl Job for Campaign {
    /// The faults of all cells with the data that they read.
    fn check_known(&self, _: &[InputRequest], known: &[Option<Known>]) -> KnownInputs {
        let cost = cost_of(known);
        KnownInputs {
            faults: placing::check_known(&self.cells, &self.axes, known),
            cost: Cost {
                cost_s: cost.cost_s * self.total() as f64,
                bytes: 0,
                ..cost
            },
            settled: None,
        }
    }

    /// Makes all runs one after the other; a fault names the cell and the run that has it.
    fn run(&self, work: Work, observer: &mut dyn Observer) -> Result<job::Outcome, RunError> {
        let (mut chunks, mut outcomes, mut made) = (Vec::new(), None, 0);
        while let Next::Runs { items, skipped } = self.next(&chunks) {
            let request = ChunkRequest {
                items,
                outcomes: outcomes.take(),
                enough: None,
                done: made + skipped,
                total: self.total(),
            };
            let (chunk, found) = self.make(request, &work.inputs, observer)?;
            made += chunk.len() as u64;
            chunks.push(chunk);
            outcomes = Some(found);
        }
        self.report(&chunks, &outcomes.unwrap_or_default())
    }
}

impl Campaign {
    /// Runs of all cells, where none ends before.
    pub fn total(&self) -> u64 {
        u64::from(self.runs) * self.cells.len() as u64
    }

    /// The result of a campaign whose runs are not all made yet, of as many runs of each cell as all cells have; and how many runs those
    /// are.
    ///
    /// # Errors
    /// When a file cannot be written.
    pub fn report_so_far(
        &self,
        mut chunks: Vec<ChunkResult>,
        outcomes: &[Outcome],
    ) -> Result<(job::Outcome, u64), RunError> {
        let (cells, mut goes_on) = (self.cells.len() as u64, vec![false; self.cells.len()]);
        if let Next::Runs { items, .. } = self.next(&chunks) {
            let first_missing = items.first().map_or(0, |range| range.start) / cells * cells;
            chunks
                .iter_mut()
                .for_each(|chunk| chunk.keep_before(first_missing));
            items
                .into_iter()
                .flatten()
                .for_each(|item| goes_on[(item % cells) as usize] = true);
        }
        let runs = chunks.iter().map(|chunk| chunk.len() as u64).sum();
        Ok((self.report_of(&chunks, outcomes, &goes_on)?, runs))
    }

    /// The result of a campaign whose runs are all made: [`Campaign::next`] has said so.
    ///
    /// # Errors
    /// When a file cannot be written.
    pub fn report(
        &self,
        chunks: &[ChunkResult],
        outcomes: &[Outcome],
    ) -> Result<job::Outcome, RunError> {
        self.report_of(chunks, outcomes, &vec![false; self.cells.len()])
    }

    fn report_of(
        &self,
        chunks: &[ChunkResult],
        outcomes: &[Outcome],
        goes_on: &[bool],
    ) -> Result<job::Outcome, RunError> {
        let collected = CollectedRuns::new(self, chunks, outcomes.len());
        let reports = self.cell_reports(outcomes, &collected, goes_on);
        let names: Vec<&str> = outcomes.iter().map(Outcome::name).collect();
        let CollectedRuns {
            rows,
            lacking,
            association_us,
            ..
        } = &collected;
        let artifacts = Vec::from([
            tables::runs(&self.cells, &names, rows, self.seed)?,
            tables::cells(&reports, &names)?,
            tables::markdown(&reports, &names),
            #[cfg(feature = "parquet")]
            parquet::runs(&self.cell_names(), &names, rows, self.seed)?,
        ]);
        let mut result = CampaignResult {
            outcomes: names.into_iter().map(str::to_owned).collect(),
            confidence: self.confidence,
            cells: reports,
            limits: None,
        };
        let mut warnings = outcomes::warnings(outcomes, rows, lacking);
        if !self.limits.is_empty() {
            let report = limits::judge(&self.limits, &result);
            warnings.extend(report.warning());
            result.limits = Some(report);
        }
        let mut result = to_value(&result)?;
        unsign_zeros(&mut result);
        Ok(job::Outcome {
            result,
            warnings,
            artifacts,
            association_time: None,
            cell_times: self.cell_times(association_us),
            checks: Vec::new(),
        })
    }

    #[cfg(feature = "parquet")]
    fn cell_names(&self) -> Vec<&str> {
        self.cells.iter().map(|cell| cell.name.as_str()).collect()
    }

    fn cell_reports(
        &self,
        outcomes: &[Outcome],
        collected: &CollectedRuns,
        goes_on: &[bool],
    ) -> Vec<CellReport> {
        let judge = Judge {
            outcomes,
            axes: &self.axes,
            confidence: self.confidence,
            seed: Seed {
                seed: self.seed,
                run: 0,
            },
        };
        let mut reports = Vec::with_capacity(self.cells.len());
        for (index, cell) in self.cells.iter().enumerate() {
            let other = self.reference_of(index).filter(|&other| other != index);
            let other = other.map(|other| (&self.cells[other], &collected.rows[other]));
            let ended = match collected.runs[index] == self.runs {
                _ if goes_on[index] => Ended::NotYet,
                true => Ended::Runs,
                false => Ended::HalfWidth,
            };
            reports.push(judge.report(cell, index, (&collected.rows[index], ended), other));
        }
        reports
    }

    /// The cell that a cell is compared with: at the same points but for that of one axis.
    fn reference_of(&self, index: usize) -> Option<usize> {
        let (axis, point) = self.compared?;
        let mut wanted = self.cells[index].points.clone();
        wanted[axis] = point;
        self.cells.iter().position(|cell| cell.points == wanted)
    }

    /// The middle of each cell's times, and its ratio to that of the cell it is compared with.
    fn cell_times(&self, times_us: &[Vec<f64>]) -> Vec<CellTime> {
        let middles: Vec<Option<f64>> = times_us.iter().map(|times_us| middle(times_us)).collect();
        let mut lines = Vec::new();
        for (index, cell) in self.cells.iter().enumerate() {
            let Some(decide_us_per_scan) = middles[index] else {
                continue;
            };
            let other = self.reference_of(index).and_then(|other| middles[other]);
            lines.push(CellTime {
                cell: cell.name.clone(),
                decide_us_per_scan,
                ratio: other
                    .filter(|other| *other > 0.0)
                    .map(|other| decide_us_per_scan / other),
                timed_runs: times_us[index].len() as u32,
            });
        }
        lines
    }
}

fn middle(times_us: &[f64]) -> Option<f64> {
    let mut sorted = times_us.to_vec();
    sorted.sort_by(f64::total_cmp);
    stats::quantile(&sorted, 0.5)
}
