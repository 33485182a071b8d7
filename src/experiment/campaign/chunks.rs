//! Making runs of a campaign, a chunk at a time, and collecting the runs of all chunks.

use super::Campaign;
use super::cells::Cell;
use super::outcomes::{self, Outcome, Rows};
use crate::experiment::job::{self, AssociationTime, Inputs, RunError, RunSettings, run_with};
use crate::experiment::observer::{Observer, Step, report_progress};
use crate::math::rng::Seed;
use crate::model::fault::Fault;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::ops::{ControlFlow, Range};
use std::time::Duration;

/// Numbers of runs: run r of cell c is `r · cells + c`, so that the cells take turns.
pub type Items = Range<u64>;

/// Some runs to make.
#[derive(Debug, Clone)]
pub struct ChunkRequest {
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
pub struct ChunkResult {
    items: Vec<u64>,
    /// By outcome; `None` where the run has no such number.
    numbers: Vec<Vec<Option<f64>>>,
    /// What deciding took, in microseconds a scan, where it was timed by itself.
    #[serde(rename = "decided_us")]
    association_us: Vec<Option<f64>>,
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

impl ChunkResult {
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
        *self = ChunkResult {
            items: kept.iter().map(|&place| self.items[place]).collect(),
            numbers: kept
                .iter()
                .map(|&place| std::mem::take(&mut self.numbers[place]))
                .collect(),
            association_us: kept
                .iter()
                .map(|&place| self.association_us[place])
                .collect(),
            spent_us: kept.iter().map(|&place| self.spent_us[place]).collect(),
            lacking: std::mem::take(&mut self.lacking)
                .into_iter()
                .filter(|(_, lack)| lack.item < item)
                .collect(),
        };
    }

    fn push(&mut self, item: u64, found: &job::Outcome, wanted: &[Outcome], spent: Duration) {
        let result = &found.result;
        let numbers: Vec<Option<f64>> = wanted.iter().map(|wanted| wanted.of(result)).collect();
        for (index, wanted) in wanted.iter().enumerate() {
            if numbers[index].is_none() {
                self.lacking.entry(index).or_insert_with(|| Lack {
                    item,
                    why: wanted.lack(result, &found.warnings),
                });
            }
        }
        self.items.push(item);
        self.numbers.push(numbers);
        self.association_us
            .push(found.association_time.map(us_per_scan));
        self.spent_us.push(spent.as_micros() as u64);
    }

    pub(super) fn spent_us(&self) -> &[u64] {
        &self.spent_us
    }
}

impl Campaign {
    /// Makes the runs of an order, at least one of them, with what was kept of each.
    ///
    /// # Errors
    /// As [`run_with`]; a fault names the cell and the run that has it.
    pub fn make(
        &self,
        request: ChunkRequest,
        inputs: &Inputs,
        observer: &mut dyn Observer,
    ) -> Result<(ChunkResult, Vec<Outcome>), RunError> {
        let mut outcomes = self.outcomes.clone().or(request.outcomes);
        let mut chunk = ChunkResult::default();
        let mut inner = Inner {
            observer,
            done: request.done,
            total: request.total,
        };
        let started = inner.now();
        let mut now = started;
        for item in request.items.into_iter().flatten() {
            let is_enough = request.enough.is_some_and(|enough| {
                now.zip(started)
                    .is_some_and(|(now, started)| now - started >= enough)
            });
            if is_enough && !chunk.is_empty() {
                break;
            }
            let found = self.make_one(item, inputs, &mut inner)?;
            let kept = outcomes.get_or_insert_with(|| outcomes::found_in(&found.result));
            let before = std::mem::replace(&mut now, inner.now());
            let spent = now
                .zip(before)
                .map_or(Duration::ZERO, |(now, before)| now - before);
            chunk.push(item, &found, kept, spent);
            inner.done += 1;
            report_progress(&mut inner, Step::Run, 0, 0)?;
        }
        Ok((chunk, outcomes.unwrap_or_default()))
    }

    fn make_one(
        &self,
        item: u64,
        inputs: &Inputs,
        observer: &mut dyn Observer,
    ) -> Result<job::Outcome, RunError> {
        let (run, cell) = self.run_of(item);
        let settings = RunSettings {
            seed: Seed {
                seed: cell.plan.seed,
                run,
            },
            wants_files: false,
            time_association: run < self.timed_runs,
        };
        let mut found = run_with(&cell.plan, inputs.clone(), settings, observer)
            .map_err(|error| place(error, cell, run))?;
        // Some time themselves wherever there is a clock.
        found.association_time = found.association_time.filter(|_| settings.time_association);
        Ok(found)
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

fn us_per_scan(time: AssociationTime) -> f64 {
    time.spent.as_secs_f64() * 1e6 / time.scans.max(1) as f64
}

fn place(error: RunError, cell: &Cell, run: u32) -> RunError {
    let name = &cell.name;
    let placed = |fault: Fault| Fault {
        detail: format!("cell '{name}', run {run}: {}", fault.detail),
        pointer: format!("/base{}", fault.pointer),
        ..fault
    };
    match error {
        RunError::Faults(faults) => RunError::Faults(faults.into_iter().map(placed).collect()),
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

/// Of the run with the least number, so that it does not matter how the runs were cut into chunks.
fn first_lack(chunks: &[ChunkResult], outcome: usize) -> Option<String> {
    chunks
        .iter()
        .filter_map(|chunk| chunk.lacking.get(&outcome))
        .min_by_key(|lack| lack.item)
        .map(|lack| lack.why.clone())
}

/// Everything that the runs gave, by cell and there by run.
pub(super) struct CollectedRuns {
    pub rows: Vec<Rows>,
    /// Why the first run that lacks an outcome does, by outcome.
    pub lacking: Vec<Option<String>>,
    pub association_us: Vec<Vec<f64>>,
    pub runs: Vec<u32>,
}

impl CollectedRuns {
    /// Puts chunks together, in whatever order they were made.
    pub fn new(campaign: &Campaign, chunks: &[ChunkResult], outcomes: usize) -> CollectedRuns {
        let mut order: Vec<(u64, u32, u32)> =
            Vec::with_capacity(chunks.iter().map(ChunkResult::len).sum());
        for (number, chunk) in chunks.iter().enumerate() {
            order.extend(
                chunk
                    .items
                    .iter()
                    .enumerate()
                    .map(|(place, &item)| (item, number as u32, place as u32)),
            );
        }
        order.sort_unstable();
        let cells = campaign.cells.len();
        let mut collected = CollectedRuns {
            rows: vec![vec![Vec::new(); outcomes]; cells],
            lacking: (0..outcomes)
                .map(|outcome| first_lack(chunks, outcome))
                .collect(),
            association_us: vec![Vec::new(); cells],
            runs: vec![0; cells],
        };
        for (item, number, place) in order {
            let cell = (item % cells as u64) as usize;
            collected.runs[cell] += 1;
            let chunk = &chunks[number as usize];
            for (column, &value) in collected.rows[cell]
                .iter_mut()
                .zip(&chunk.numbers[place as usize])
            {
                column.push(value);
            }
            collected.association_us[cell].extend(chunk.association_us[place as usize]);
        }
        collected
    }
}
