//! A campaign: one job run many times over a grid of its parameters, with means, intervals and paired differences.
//!
//! Run r of every cell draws from the same named streams, so cells that differ in the method alone see the same scenes, and
//! their differences are taken run by run. The runs of all cells take turns, so that times compare as well.
//!
//! The runs are made in pieces, anywhere and in any order: what is to be made next, and in the end the result, depends on the pieces alone.

mod cells;
mod outcomes;
#[cfg(feature = "parquet")]
mod parquet;
mod pieces;
mod requests;
mod shares;
mod stages;
mod stop;
mod tables;

pub use outcomes::Outcome;
pub use pieces::{Items, Order, Piece};
pub use requests::CAMPAIGN;
pub use stages::Next;

use crate::experiment::input::known::Known;
use crate::experiment::observer::Observer;
use crate::experiment::plan::{Estimate, InputRequest, JobKind, Plan};
use crate::experiment::run::{self, CellTime, Inputs, RunError, to_value};
use crate::math::rng::Seed;
use crate::math::stats;
use crate::model::fault::Fault;
use cells::{Axis, Cell};
use outcomes::Judge;
use pieces::Harvest;
use serde_json::{Value, json};
use std::sync::Arc;
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
    let sum = |part: fn(&Estimate) -> f64| {
        cells
            .iter()
            .map(|cell| part(&cell.plan.estimate))
            .sum::<f64>()
            * runs as f64
    };
    let estimate = Estimate {
        detections: sum(|part| part.detections as f64) as u64,
        cost_s: sum(|part| part.cost_s),
        bytes: 0,
    };
    let numbers = cells.len() as f64
        * runs as f64
        * spec["outcomes"]
            .as_array()
            .map_or(UNLISTED_OUTCOMES, Vec::len) as f64;
    if estimate.cost_s > MAX_COST_S || numbers > MAX_NUMBERS {
        let detail = format!(
            "{} cells with {runs} runs each are about {:.0} s of work and {numbers:.0} numbers",
            cells.len(),
            estimate.cost_s
        );
        faults.push(
            Fault::new("/runs", "too_large", detail)
                .allowing(format!("at most {MAX_COST_S} s and {MAX_NUMBERS} numbers")),
        );
    }
    let compared = reference_point(&spec, &axes)
        .map_err(|fault| faults.push(*fault))
        .ok()
        .flatten();
    faults.extend(outcomes::named_twice(&spec));
    let seed = spec["seed"]
        .as_u64()
        .and_then(|seed| u32::try_from(seed).ok())
        .unwrap_or_default();
    let stop = Stop::of(&spec, Seed { seed, run: 0 })
        .map_err(|fault| faults.push(*fault))
        .ok()
        .flatten();
    let inputs = inputs_of(&cells, &mut faults);
    if !faults.is_empty() {
        return Err(faults);
    }
    let campaign = Campaign {
        cells,
        axes,
        compared,
        stop,
        outcomes: outcomes::listed(&spec),
        runs: spec["runs"].as_u64().unwrap_or(1) as u32,
        timed_runs: spec["timed_runs"].as_u64().unwrap_or(0) as u32,
        confidence: spec["confidence"].as_f64().unwrap_or(0.95),
        seed,
    };
    let campaign = Some(Arc::new(campaign));
    Ok(Plan {
        kind: JobKind::Campaign,
        spec,
        seed,
        run: 0,
        wants_files: true,
        is_timed: false,
        inputs,
        estimate,
        campaign,
    })
}

/// A checked campaign with its cells.
#[derive(Debug)]
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
}

/// What is loaded once for all runs: every cell needs the same.
fn inputs_of(cells: &[Cell], faults: &mut Vec<Fault>) -> Vec<InputRequest> {
    let Some(first) = cells.first() else {
        return Vec::new();
    };
    if let Some(other) = cells
        .iter()
        .find(|cell| cell.plan.inputs != first.plan.inputs)
    {
        let detail = format!(
            "the cells '{}' and '{}' read different data",
            first.name, other.name
        );
        faults.push(
            Fault::new("/grid", "unsupported", detail).allowing("cells that read the same data"),
        );
    }
    let placed = |input: &InputRequest| InputRequest {
        pointer: format!("/base{}", input.pointer),
        ..input.clone()
    };
    first.plan.inputs.iter().map(placed).collect()
}

/// The axis along which cells are compared, and its point that the others are compared with.
fn reference_point(spec: &Value, axes: &[Axis]) -> Result<Option<(usize, usize)>, Box<Fault>> {
    let Some(last) = axes.len().checked_sub(1) else {
        return Ok(None);
    };
    let Some(compare) = spec.get("compare") else {
        return Ok(Some((last, 0)));
    };
    let (name, to) = (
        compare["axis"].as_str().unwrap_or_default(),
        compare["to"].as_str().unwrap_or_default(),
    );
    let axis = axes
        .iter()
        .position(|axis| axis.name == name)
        .ok_or_else(|| {
            let known = axes
                .iter()
                .map(|axis| axis.name.as_str())
                .collect::<Vec<_>>()
                .join(", ");
            Box::new(
                Fault::new(
                    "/compare/axis",
                    "unknown_value",
                    format!("there is no axis '{name}'"),
                )
                .allowing(known),
            )
        })?;
    let point = axes[axis].point_named(to).ok_or_else(|| {
        Box::new(
            Fault::new(
                "/compare/to",
                "unknown_value",
                format!("axis '{name}' has no point '{to}'"),
            )
            .allowing(axes[axis].point_names()),
        )
    })?;
    Ok(Some((axis, point)))
}

/// Makes all runs one after the other.
///
/// # Errors
/// As [`run::run`]; a fault names the cell and the run that has it.
pub(super) fn run(
    campaign: &Campaign,
    inputs: &Inputs,
    observer: &mut dyn Observer,
) -> Result<run::Outcome, RunError> {
    let (mut pieces, mut outcomes, mut made) = (Vec::new(), None, 0);
    loop {
        match campaign.next(&pieces) {
            Next::Runs { items, spared } => {
                let order = Order {
                    items,
                    outcomes: outcomes.take(),
                    enough: None,
                    done: made + spared,
                    total: campaign.total(),
                };
                let (piece, found) = campaign.make(order, inputs, observer)?;
                made += piece.len() as u64;
                pieces.push(piece);
                outcomes = Some(found);
            }
            Next::Result => return campaign.report(&pieces, &outcomes.unwrap_or_default()),
        }
    }
}

impl Campaign {
    pub(super) fn cell_count(&self) -> usize {
        self.cells.len()
    }

    /// The faults of all cells with the data that they read.
    pub(super) fn check_known(&self, known: &[Option<Known>]) -> Vec<Fault> {
        cells::check_known(&self.cells, &self.axes, known)
    }

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
        mut pieces: Vec<Piece>,
        outcomes: &[Outcome],
    ) -> Result<(run::Outcome, u64), RunError> {
        let (cells, mut goes_on) = (self.cells.len() as u64, vec![false; self.cells.len()]);
        if let Next::Runs { items, .. } = self.next(&pieces) {
            let first_missing = items.first().map_or(0, |range| range.start) / cells * cells;
            pieces
                .iter_mut()
                .for_each(|piece| piece.keep_before(first_missing));
            items
                .into_iter()
                .flatten()
                .for_each(|item| goes_on[(item % cells) as usize] = true);
        }
        let runs = pieces.iter().map(|piece| piece.len() as u64).sum();
        Ok((self.report_of(&pieces, outcomes, &goes_on)?, runs))
    }

    /// The result of a campaign whose runs are all made: [`Campaign::next`] has said so.
    ///
    /// # Errors
    /// When a file cannot be written.
    pub fn report(&self, pieces: &[Piece], outcomes: &[Outcome]) -> Result<run::Outcome, RunError> {
        self.report_of(pieces, outcomes, &vec![false; self.cells.len()])
    }

    fn report_of(
        &self,
        pieces: &[Piece],
        outcomes: &[Outcome],
        goes_on: &[bool],
    ) -> Result<run::Outcome, RunError> {
        let harvest = Harvest::of(self, pieces, outcomes.len());
        let reference = |index: usize| {
            self.compared
                .and_then(|(axis, point)| reference_of(&self.cells, index, axis, point))
        };
        let judge = Judge {
            outcomes,
            axes: &self.axes,
            confidence: self.confidence,
            seed: Seed {
                seed: self.seed,
                run: 0,
            },
        };
        let report = |(index, cell): (usize, &Cell)| {
            let other = reference(index)
                .filter(|&other| other != index)
                .map(|other| (&self.cells[other], &harvest.rows[other]));
            let ended = match harvest.runs[index] == self.runs {
                _ if goes_on[index] => Ended::NotYet,
                true => Ended::Runs,
                false => Ended::HalfWidth,
            };
            judge.report(cell, index, (&harvest.rows[index], ended), other)
        };
        let reports: Vec<_> = self.cells.iter().enumerate().map(report).collect();
        let names: Vec<&str> = outcomes.iter().map(Outcome::name).collect();
        let artifacts = Vec::from([
            tables::runs(&self.cells, &names, &harvest.rows, self.seed)?,
            tables::cells(&reports, &names)?,
            tables::markdown(&reports, &names),
            #[cfg(feature = "parquet")]
            parquet::runs(
                &self
                    .cells
                    .iter()
                    .map(|cell| cell.name.as_str())
                    .collect::<Vec<_>>(),
                &names,
                &harvest.rows,
                self.seed,
            )?,
        ]);
        let warnings = outcomes::doubts(outcomes, &harvest.rows, &harvest.lacking);
        let mut result =
            json!({"outcomes": names, "confidence": self.confidence, "cells": to_value(&reports)?});
        run::unsign_zeros(&mut result);
        let cell_times = times(&self.cells, &harvest.decided_us, reference);
        Ok(run::Outcome {
            result,
            warnings,
            artifacts,
            decided: None,
            cell_times,
        })
    }
}

/// The cell at the same points but for that of one axis.
fn reference_of(cells: &[Cell], index: usize, axis: usize, point: usize) -> Option<usize> {
    let mut wanted = cells[index].points.clone();
    wanted[axis] = point;
    cells.iter().position(|cell| cell.points == wanted)
}

/// The middle of each cell's times, and its ratio to that of the cell it is compared with.
fn times(
    cells: &[Cell],
    times_us: &[Vec<f64>],
    reference: impl Fn(usize) -> Option<usize>,
) -> Vec<CellTime> {
    let middle = |index: usize| {
        let mut sorted = times_us[index].clone();
        sorted.sort_by(f64::total_cmp);
        stats::quantile(&sorted, 0.5)
    };
    let line = |(index, cell): (usize, &Cell)| {
        let decide_us_per_scan = middle(index)?;
        let ratio = reference(index)
            .and_then(middle)
            .filter(|other| *other > 0.0)
            .map(|other| decide_us_per_scan / other);
        Some(CellTime {
            cell: cell.name.clone(),
            decide_us_per_scan,
            ratio,
            timed_runs: times_us[index].len() as u32,
        })
    };
    cells.iter().enumerate().filter_map(line).collect()
}
