//! A campaign: one job run many times over a grid of its parameters, with means, intervals and paired differences.
//!
//! Run r of every cell draws from the same named streams, so cells that differ in the method alone see the same scenes, and
//! their differences are taken run by run. The runs of all cells take turns, so that times compare as well.

mod cells;
mod outcomes;
#[cfg(feature = "parquet")]
mod parquet;
mod requests;
mod stop;
mod tables;

pub use requests::CAMPAIGN;

use super::observer::{Observer, Step};
use super::plan::{Estimate, InputRequest, JobKind, Plan};
use super::run::{self, CellTime, Decided, Inputs, RunError, to_value};
use crate::math::rng::Seed;
use crate::math::stats;
use crate::model::fault::Fault;
use cells::{Axis, Cell};
use outcomes::{Judge, Outcome, Rows};
use serde_json::{Value, json};
use std::ops::ControlFlow;
use std::time::Duration;
use stop::{Ended, Stop};

/// Longer campaigns are refused.
const MAX_COST_S: f64 = 7.0 * 86_400.0;

/// Numbers kept, over all cells, runs and outcomes.
const MAX_NUMBERS: f64 = 50e6;

/// Outcomes that are reckoned with where none are listed: about what all metrics together have.
const UNLISTED_OUTCOMES: usize = 100;

/// A checked campaign, from a spec that the table has checked already.
///
/// # Errors
/// All of `faults`, and every fault of base, grid and comparison.
pub(super) fn plan(spec: Value, mut faults: Vec<Fault>) -> Result<Plan, Vec<Fault>> {
    if !faults.is_empty() {
        faults.extend(cells::faults_of_base(&spec));
        return Err(faults);
    }
    let axes = cells::axes_of(&spec);
    let cells = cells::cells_of(&spec, &axes)?;
    let runs = spec["runs"].as_u64().unwrap_or(1);
    let sum = |part: fn(&Estimate) -> f64| cells.iter().map(|cell| part(&cell.plan.estimate)).sum::<f64>() * runs as f64;
    let estimate = Estimate { detections: sum(|part| part.detections as f64) as u64, cost_s: sum(|part| part.cost_s), bytes: 0 };
    let numbers = cells.len() as f64 * runs as f64 * spec["outcomes"].as_array().map_or(UNLISTED_OUTCOMES, Vec::len) as f64;
    if estimate.cost_s > MAX_COST_S || numbers > MAX_NUMBERS {
        let detail =
            format!("{} cells with {runs} runs each are about {:.0} s of work and {numbers:.0} numbers", cells.len(), estimate.cost_s);
        faults.push(Fault::new("/runs", "too_large", detail).allowing(format!("at most {MAX_COST_S} s and {MAX_NUMBERS} numbers")));
    }
    if let Err(fault) = reference_point(&spec, &axes) {
        faults.push(*fault);
    }
    faults.extend(outcomes::named_twice(&spec));
    let seed = spec["seed"].as_u64().and_then(|seed| u32::try_from(seed).ok()).unwrap_or_default();
    faults.extend(Stop::of(&spec, Seed { seed, run: 0 }).err().map(|fault| *fault));
    let inputs = inputs_of(&cells, &mut faults);
    if !faults.is_empty() {
        return Err(faults);
    }
    Ok(Plan { kind: JobKind::Campaign, spec, seed, run: 0, wants_files: true, is_timed: false, inputs, estimate })
}

/// What is loaded once for all runs: every cell needs the same.
fn inputs_of(cells: &[Cell], faults: &mut Vec<Fault>) -> Vec<InputRequest> {
    let Some(first) = cells.first() else { return Vec::new() };
    if let Some(other) = cells.iter().find(|cell| cell.plan.inputs != first.plan.inputs) {
        let detail = format!("the cells '{}' and '{}' read different data", first.name, other.name);
        faults.push(Fault::new("/grid", "unsupported", detail).allowing("cells that read the same data"));
    }
    let placed = |input: &InputRequest| InputRequest { pointer: format!("/base{}", input.pointer), ..input.clone() };
    first.plan.inputs.iter().map(placed).collect()
}

/// The axis along which cells are compared, and its point that the others are compared with.
fn reference_point(spec: &Value, axes: &[Axis]) -> Result<Option<(usize, usize)>, Box<Fault>> {
    let Some(last) = axes.len().checked_sub(1) else { return Ok(None) };
    let Some(compare) = spec.get("compare") else { return Ok(Some((last, 0))) };
    let (name, to) = (compare["axis"].as_str().unwrap_or_default(), compare["to"].as_str().unwrap_or_default());
    let axis = axes.iter().position(|axis| axis.name == name).ok_or_else(|| {
        let known = axes.iter().map(|axis| axis.name.as_str()).collect::<Vec<_>>().join(", ");
        Box::new(Fault::new("/compare/axis", "unknown_value", format!("there is no axis '{name}'")).allowing(known))
    })?;
    let point = axes[axis].point_named(to).ok_or_else(|| {
        Box::new(
            Fault::new("/compare/to", "unknown_value", format!("axis '{name}' has no point '{to}'")).allowing(axes[axis].point_names()),
        )
    })?;
    Ok(Some((axis, point)))
}

/// Everything that the runs give.
struct Harvest {
    outcomes: Vec<Outcome>,
    /// By cell.
    rows: Vec<Rows>,
    times_us: Vec<Vec<f64>>,
    ended: Vec<Ended>,
}

/// Does the work of a campaign.
///
/// # Errors
/// As [`run::run`]; a fault names the cell and the run that has it.
pub(super) fn run(plan: &Plan, inputs: &Inputs, observer: &mut dyn Observer) -> Result<run::Outcome, RunError> {
    let axes = cells::axes_of(&plan.spec);
    let cells = cells::cells_of(&plan.spec, &axes)?;
    let harvest = gather(plan, &cells, inputs, observer)?;
    let compared = reference_point(&plan.spec, &axes).map_err(|fault| vec![*fault])?;
    let reference = |index: usize| compared.and_then(|(axis, point)| reference_of(&cells, index, axis, point));
    let confidence = plan.spec["confidence"].as_f64().unwrap_or(0.95);
    let judge = Judge { outcomes: &harvest.outcomes, axes: &axes, confidence, seed: plan.stream() };
    let report = |(index, cell): (usize, &Cell)| {
        let other = reference(index).filter(|&other| other != index).map(|other| (&cells[other], &harvest.rows[other]));
        judge.report(cell, index, (&harvest.rows[index], harvest.ended[index]), other)
    };
    let reports: Vec<_> = cells.iter().enumerate().map(report).collect();
    let names: Vec<&str> = harvest.outcomes.iter().map(Outcome::name).collect();
    let artifacts = Vec::from([
        tables::runs(&cells, &names, &harvest.rows, plan.seed)?,
        tables::cells(&reports, &names)?,
        tables::markdown(&reports, &names),
        #[cfg(feature = "parquet")]
        parquet::runs(&cells.iter().map(|cell| cell.name.as_str()).collect::<Vec<_>>(), &names, &harvest.rows, plan.seed)?,
    ]);
    let warnings = outcomes::doubts(&harvest.outcomes, &harvest.rows);
    let result = json!({"outcomes": names, "confidence": confidence, "cells": to_value(&reports)?});
    let cell_times = times(&cells, &harvest.times_us, reference);
    Ok(run::Outcome { result, warnings, artifacts, decided: None, cell_times })
}

fn gather(plan: &Plan, cells: &[Cell], inputs: &Inputs, observer: &mut dyn Observer) -> Result<Harvest, RunError> {
    let runs = plan.spec["runs"].as_u64().unwrap_or(1) as u32;
    let timed_runs = plan.spec["timed_runs"].as_u64().unwrap_or(0) as u32;
    let mut outcomes = outcomes::listed(&plan.spec);
    let mut rows: Vec<Rows> = vec![Vec::new(); cells.len()];
    let mut times_us = vec![Vec::new(); cells.len()];
    let stop = Stop::of(&plan.spec, plan.stream()).map_err(|fault| vec![*fault])?;
    let mut ended = vec![None; cells.len()];
    let mut inner = Inner { observer, done: 0, total: u64::from(runs) * cells.len() as u64 };
    for run in 0..runs {
        for (index, cell) in cells.iter().enumerate().filter(|(index, _)| ended[*index].is_none()) {
            let job = Plan { run, is_timed: run < timed_runs, ..cell.plan.clone() };
            let outcome = run::run(&job, inputs.clone(), &mut inner).map_err(|error| placed(error, cell, run))?;
            let kept = outcomes.get_or_insert_with(|| outcomes::found_in(&outcome.result));
            rows[index].resize_with(kept.len(), Vec::new);
            for (column, wanted) in rows[index].iter_mut().zip(kept.iter()) {
                column.push(wanted.of(&outcome.result));
            }
            times_us[index].extend(outcome.decided.filter(|_| job.is_timed).map(us_per_scan));
            inner.done += 1;
            if inner.progress(Step::Run, 0, 0).is_break() {
                return Err(RunError::Stopped);
            }
        }
        let left = runs - run - 1;
        for stop in stop.iter().filter(|_| left > 0 && stop::looks_after(run + 1)) {
            let reached = |index: &usize| ended[*index].is_none() && stop.is_reached(*index, &rows[*index]);
            for index in (0..cells.len()).filter(reached).collect::<Vec<_>>() {
                ended[index] = Some(Ended::HalfWidth);
                inner.done += u64::from(left);
            }
        }
        if ended.iter().all(Option::is_some) {
            break;
        }
    }
    let ended = ended.into_iter().map(|ended| ended.unwrap_or(Ended::Runs)).collect();
    Ok(Harvest { outcomes: outcomes.unwrap_or_default(), rows, times_us, ended })
}

fn us_per_scan(decided: Decided) -> f64 {
    decided.spent.as_secs_f64() * 1e6 / decided.scans.max(1) as f64
}

/// The cell at the same points but for that of one axis.
fn reference_of(cells: &[Cell], index: usize, axis: usize, point: usize) -> Option<usize> {
    let mut wanted = cells[index].points.clone();
    wanted[axis] = point;
    cells.iter().position(|cell| cell.points == wanted)
}

fn placed(error: RunError, cell: &Cell, run: u32) -> RunError {
    let name = &cell.name;
    let place = |fault: Fault| Fault {
        detail: format!("cell '{name}', run {run}: {}", fault.detail),
        pointer: format!("/base{}", fault.pointer),
        ..fault
    };
    match error {
        RunError::Faults(faults) => RunError::Faults(faults.into_iter().map(place).collect()),
        RunError::Stopped => RunError::Stopped,
    }
}

/// The middle of each cell's times, and its ratio to that of the cell it is compared with.
fn times(cells: &[Cell], times_us: &[Vec<f64>], reference: impl Fn(usize) -> Option<usize>) -> Vec<CellTime> {
    let middle = |index: usize| {
        let mut sorted = times_us[index].clone();
        sorted.sort_by(f64::total_cmp);
        stats::quantile(&sorted, 0.5)
    };
    let line = |(index, cell): (usize, &Cell)| {
        let decide_us_per_scan = middle(index)?;
        let ratio = reference(index).and_then(middle).filter(|other| *other > 0.0).map(|other| decide_us_per_scan / other);
        Some(CellTime { cell: cell.name.clone(), decide_us_per_scan, ratio, timed_runs: times_us[index].len() as u32 })
    };
    cells.iter().enumerate().filter_map(line).collect()
}

/// Tells of runs whatever the steps inside them are.
struct Inner<'a> {
    observer: &'a mut dyn Observer,
    done: u64,
    total: u64,
}

impl Observer for Inner<'_> {
    fn progress(&mut self, _: Step, _: u64, _: u64) -> ControlFlow<()> {
        self.observer.progress(Step::Run, self.done, self.total)
    }

    fn now(&self) -> Option<Duration> {
        self.observer.now()
    }
}
