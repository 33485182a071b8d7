//! Making runs of a campaign, a piece at a time, and putting the pieces together.

use super::Campaign;
use super::cells::Cell;
use super::outcomes::{self, Outcome, Rows};
use crate::experiment::observer::{Observer, Step};
use crate::experiment::plan::Plan;
use crate::experiment::run::{self, Decided, Inputs, RunError};
use crate::model::fault::Fault;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::ops::{ControlFlow, Range};
use std::time::Duration;

/// Numbers of runs: run r of cell c is `r · cells + c`, so that the cells take turns.
pub type Items = Range<u64>;

/// Some runs to make.
#[derive(Debug, Clone)]
pub struct Order {
    pub items: Vec<Items>,
    /// What is kept of each run; `None` where the first run is to tell.
    pub outcomes: Option<Vec<Outcome>>,
    /// After this time no further run is begun.
    pub enough: Option<Duration>,
    /// Runs of the campaign that were done before, for the observer.
    pub done: u64,
    /// Runs of the whole campaign, for the observer.
    pub total: u64,
}

/// What some runs gave; the lists go by run.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Piece {
    items: Vec<u64>,
    /// By outcome; `None` where the run has no such number.
    numbers: Vec<Vec<Option<f64>>>,
    /// What deciding took, in microseconds a scan, where it was timed by itself.
    decided_us: Vec<Option<f64>>,
    /// What the whole run took; 0 where the observer has no clock.
    spent_us: Vec<u64>,
    /// By outcome: why the first of these runs that lacks the number does.
    #[serde(default)]
    lacking: BTreeMap<usize, Lack>,
}

/// Why a run has no number, and which run it was.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Lack {
    item: u64,
    why: String,
}

impl Piece {
    /// How many runs it has.
    pub fn len(&self) -> usize {
        self.items.len()
    }

    pub fn is_empty(&self) -> bool {
        self.items.is_empty()
    }

    /// The numbers of its runs, in the order in which they were made.
    pub fn items(&self) -> &[u64] {
        &self.items
    }

    /// What its runs took together.
    pub fn spent(&self) -> Duration {
        Duration::from_micros(self.spent_us.iter().sum())
    }

    /// Forgets the runs from an item on.
    pub(super) fn keep_before(&mut self, item: u64) {
        let kept: Vec<usize> = (0..self.items.len())
            .filter(|&place| self.items[place] < item)
            .collect();
        *self = Piece {
            items: kept.iter().map(|&place| self.items[place]).collect(),
            numbers: kept
                .iter()
                .map(|&place| std::mem::take(&mut self.numbers[place]))
                .collect(),
            decided_us: kept.iter().map(|&place| self.decided_us[place]).collect(),
            spent_us: kept.iter().map(|&place| self.spent_us[place]).collect(),
            lacking: std::mem::take(&mut self.lacking)
                .into_iter()
                .filter(|(_, lack)| lack.item < item)
                .collect(),
        };
    }

    pub(super) fn spent_us(&self) -> &[u64] {
        &self.spent_us
    }
}

impl Campaign {
    /// Makes the runs of an order, at least one of them, with what was kept of each.
    ///
    /// # Errors
    /// As [`run::run`]; a fault names the cell and the run that has it.
    pub fn make(
        &self,
        order: Order,
        inputs: &Inputs,
        observer: &mut dyn Observer,
    ) -> Result<(Piece, Vec<Outcome>), RunError> {
        let mut outcomes = self.outcomes.clone().or(order.outcomes);
        let mut piece = Piece::default();
        let mut inner = Inner {
            observer,
            done: order.done,
            total: order.total,
        };
        let started = inner.now();
        let mut now = started;
        for item in order.items.into_iter().flatten() {
            let is_enough = order.enough.is_some_and(|enough| {
                now.zip(started)
                    .is_some_and(|(now, started)| now - started >= enough)
            });
            if is_enough && !piece.is_empty() {
                break;
            }
            let (run, cell) = self.run_of(item);
            let job = Plan {
                run,
                is_timed: run < self.timed_runs,
                ..cell.plan.clone()
            };
            let outcome = run::run(&job, inputs.clone(), &mut inner)
                .map_err(|error| placed(error, cell, run))?;
            let kept = outcomes.get_or_insert_with(|| outcomes::found_in(&outcome.result));
            let before = std::mem::replace(&mut now, inner.now());
            piece.items.push(item);
            let numbers: Vec<Option<f64>> = kept
                .iter()
                .map(|wanted| wanted.of(&outcome.result))
                .collect();
            for (index, wanted) in kept
                .iter()
                .enumerate()
                .filter(|(index, _)| numbers[*index].is_none())
            {
                piece.lacking.entry(index).or_insert_with(|| Lack {
                    item,
                    why: wanted.lack(&outcome.result, &outcome.warnings),
                });
            }
            piece.numbers.push(numbers);
            piece
                .decided_us
                .push(outcome.decided.filter(|_| job.is_timed).map(us_per_scan));
            piece.spent_us.push(
                now.zip(before)
                    .map_or(0, |(now, before)| (now - before).as_micros() as u64),
            );
            inner.done += 1;
            if inner.progress(Step::Run, 0, 0).is_break() {
                return Err(RunError::Stopped);
            }
        }
        Ok((piece, outcomes.unwrap_or_default()))
    }

    /// The run and the cell of an item.
    fn run_of(&self, item: u64) -> (u32, &Cell) {
        let cells = self.cells.len() as u64;
        ((item / cells) as u32, &self.cells[(item % cells) as usize])
    }

    /// `cell 'jpda', run 7`.
    pub fn name_of(&self, item: u64) -> String {
        let (run, cell) = self.run_of(item);
        format!("cell '{}', run {run}", cell.name)
    }
}

fn us_per_scan(decided: Decided) -> f64 {
    decided.spent.as_secs_f64() * 1e6 / decided.scans.max(1) as f64
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

/// Of the run with the least number, so that it does not matter how the runs were cut into pieces.
fn first_lack(pieces: &[Piece], outcome: usize) -> Option<String> {
    pieces
        .iter()
        .filter_map(|piece| piece.lacking.get(&outcome))
        .min_by_key(|lack| lack.item)
        .map(|lack| lack.why.clone())
}

/// Everything that the runs gave, by cell and there by run.
pub(super) struct Harvest {
    pub rows: Vec<Rows>,
    /// Why the first run that lacks an outcome does, by outcome.
    pub lacking: Vec<Option<String>>,
    pub decided_us: Vec<Vec<f64>>,
    pub runs: Vec<u32>,
}

impl Harvest {
    /// Puts pieces together, in whatever order they were made.
    pub fn of(campaign: &Campaign, pieces: &[Piece], outcomes: usize) -> Harvest {
        let mut order: Vec<(u64, u32, u32)> =
            Vec::with_capacity(pieces.iter().map(Piece::len).sum());
        for (number, piece) in pieces.iter().enumerate() {
            order.extend(
                piece
                    .items
                    .iter()
                    .enumerate()
                    .map(|(place, &item)| (item, number as u32, place as u32)),
            );
        }
        order.sort_unstable();
        let cells = campaign.cells.len();
        let mut harvest = Harvest {
            rows: vec![vec![Vec::new(); outcomes]; cells],
            lacking: (0..outcomes)
                .map(|outcome| first_lack(pieces, outcome))
                .collect(),
            decided_us: vec![Vec::new(); cells],
            runs: vec![0; cells],
        };
        for (item, number, place) in order {
            let cell = (item % cells as u64) as usize;
            harvest.runs[cell] += 1;
            let piece = &pieces[number as usize];
            for (column, &value) in harvest.rows[cell]
                .iter_mut()
                .zip(&piece.numbers[place as usize])
            {
                column.push(value);
            }
            harvest.decided_us[cell].extend(piece.decided_us[place as usize]);
        }
        harvest
    }
}
