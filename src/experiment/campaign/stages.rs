//! What a campaign makes next: the runs up to the next look at its intervals, cut into chunks of about the same time.

use super::Campaign;
use super::cells::Cell;
use super::chunks::{ChunkResult, CollectedRuns, Items};
use super::stop::looks;
use crate::experiment::job::Plan;
use std::collections::HashSet;
use std::ops::Range;
use std::time::Duration;

/// Of what is left, a lot is at most such a part.
const LOTS_LEFT: f64 = 16.0;

/// What is to be done when nothing is being made.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Next {
    /// These runs; `skipped` are those that cells which have ended do not make.
    Runs { items: Vec<Items>, skipped: u64 },
    /// Nothing: the result can be had of [`Campaign::report`].
    Result,
}

/// Adds an item that is greater than all in the ranges.
fn join(ranges: &mut Vec<Items>, item: u64) {
    match ranges.last_mut() {
        Some(range) if range.end == item => range.end += 1,
        _ => ranges.push(item..item + 1),
    }
}

impl Campaign {
    /// What is missing. It depends on the numbers of the runs alone, not on how the chunks were cut or who made them.
    pub fn next(&self, chunks: &[ChunkResult]) -> Next {
        let Some(stop) = &self.stop else {
            return self.missing(chunks, 0..self.runs, 0, |_| false);
        };
        let collected =
            CollectedRuns::new(self, chunks, self.outcomes.as_ref().map_or(0, Vec::len));
        let mut has_ended = vec![false; self.cells.len()];
        let (mut from, mut skipped) = (0, 0);
        for until in looks(self.runs) {
            let missing = self.missing(chunks, from..until, skipped, |cell| has_ended[cell]);
            if missing != Next::Result || until == self.runs {
                return missing;
            }
            for (cell, has_ended) in has_ended
                .iter_mut()
                .enumerate()
                .filter(|(_, has_ended)| !**has_ended)
            {
                *has_ended = stop.is_reached(cell, &collected.rows[cell], until as usize);
                skipped += u64::from(*has_ended) * u64::from(self.runs - until);
            }
            from = until;
        }
        Next::Result
    }

    fn missing(
        &self,
        chunks: &[ChunkResult],
        runs: Range<u32>,
        skipped: u64,
        has_ended: impl Fn(usize) -> bool,
    ) -> Next {
        let cells = self.cells.len() as u64;
        let (first, last) = (u64::from(runs.start) * cells, u64::from(runs.end) * cells);
        let made: HashSet<u64> = chunks
            .iter()
            .flat_map(ChunkResult::items)
            .copied()
            .filter(|item| (first..last).contains(item))
            .collect();
        let mut missing: Vec<Items> = Vec::new();
        for item in
            (first..last).filter(|item| !made.contains(item) && !has_ended((item % cells) as usize))
        {
            join(&mut missing, item);
        }
        if missing.is_empty() {
            Next::Result
        } else {
            Next::Runs {
                items: missing,
                skipped,
            }
        }
    }

    /// Cuts runs into lots that take about `longest` each, towards the end less, down to `shortest`, so that nobody waits long for the last
    /// one. What a run takes is what the runs made so far took: a cell without any is reckoned by its estimate, as much too low or too
    /// high as those of the others were.
    pub fn cut(
        &self,
        items: Vec<Items>,
        chunks: &[ChunkResult],
        shortest: Duration,
        longest: Duration,
    ) -> Vec<Vec<Items>> {
        let (costs_s, mut left_s) = (
            self.costs_s(chunks),
            self.cost(&items, chunks).as_secs_f64(),
        );
        let target_of =
            |left_s: f64| (left_s / LOTS_LEFT).clamp(shortest.as_secs_f64(), longest.as_secs_f64());
        let (mut lots, mut lot, mut cost_s, mut target_s) =
            (Vec::new(), Vec::<Items>::new(), 0.0, target_of(left_s));
        for item in items.into_iter().flatten() {
            join(&mut lot, item);
            cost_s += costs_s[(item % costs_s.len() as u64) as usize];
            if cost_s >= target_s {
                lots.push(std::mem::take(&mut lot));
                left_s -= std::mem::take(&mut cost_s);
                target_s = target_of(left_s);
            }
        }
        lots.extend(Some(lot).filter(|lot| !lot.is_empty()));
        lots
    }

    /// What these runs will take together.
    pub fn cost(&self, items: &[Items], chunks: &[ChunkResult]) -> Duration {
        let costs_s = self.costs_s(chunks);
        let of_item = |item: u64| costs_s[(item % costs_s.len() as u64) as usize];
        Duration::from_secs_f64(items.iter().cloned().flatten().map(of_item).sum())
    }

    /// What a run of each cell takes.
    fn costs_s(&self, chunks: &[ChunkResult]) -> Vec<f64> {
        let mut spent = vec![(0.0, 0.0); self.cells.len()];
        for (&item, &spent_us) in chunks
            .iter()
            .flat_map(|chunk| chunk.items().iter().zip(chunk.spent_us()))
        {
            let (sum_s, count) = &mut spent[(item % self.cells.len() as u64) as usize];
            *sum_s += spent_us as f64 / 1e6;
            *count += 1.0;
        }
        let estimate_s = |plan: &Plan| plan.cost.cost_s.max(1e-6);
        let (mut made_s, mut reckoned_s) = (0.0, 0.0);
        for (cell, (sum_s, count)) in self.cells.iter().zip(&spent) {
            made_s += sum_s;
            reckoned_s += count * estimate_s(&cell.plan);
        }
        let ratio = if reckoned_s > 0.0 {
            made_s / reckoned_s
        } else {
            1.0
        };
        let cost_s = |(cell, (sum_s, count)): (&Cell, &(f64, f64))| {
            if *count > 0.0 {
                sum_s / count
            } else {
                estimate_s(&cell.plan) * ratio
            }
        };
        self.cells.iter().zip(&spent).map(cost_s).collect()
    }
}
