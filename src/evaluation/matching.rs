//! The best matching of the truths and tracks of one step: the one with the greatest sum of worths.
//!
//! # Method
//! A pair that nobody competes for is taken as it is. The others go to the sparse assignment, which never looks beyond
//! the truths and tracks that compete with each other. Memory is reused from step to step.

use super::comparison::{ComparedStep, Comparison, Pair};
use crate::math::assignment::AssignmentSolver;
use crate::model::watch::Watch;

/// Matches one step after another.
#[derive(Debug, Default)]
pub struct StepMatcher<'w> {
    /// Where there is one, a matching that it stops is any.
    watch: Option<&'w Watch<'w>>,
    solver: AssignmentSolver,
    worths: Vec<f64>,
    /// For each truth and each track of the step: with how many it may be matched.
    rivals_of_truth: Vec<u32>,
    rivals_of_track: Vec<u32>,
    /// For each edge of the solver its pair, and for each row its first edge.
    edges: Vec<u32>,
    rows: Vec<u32>,
    matched: Vec<u32>,
}

impl<'w> StepMatcher<'w> {
    /// One that stops when the watch says so.
    pub fn until(watch: &'w Watch<'w>) -> Self {
        StepMatcher {
            watch: Some(watch),
            ..StepMatcher::default()
        }
    }

    /// The pairs of the best matching, by their index in [`Comparison::pairs`], rising. A pair whose worth is not above
    /// 0 is never matched.
    pub fn best(
        &mut self,
        comparison: &Comparison,
        step: &ComparedStep,
        worth: impl Fn(usize, &Pair) -> f64,
    ) -> &[u32] {
        let pairs = &comparison.pairs[step.pairs.clone()];
        self.matched.clear();
        self.worths.clear();
        restart(&mut self.rivals_of_truth, step.truths.len());
        restart(&mut self.rivals_of_track, step.tracks.len());
        for (index, pair) in pairs.iter().enumerate() {
            let worth = worth(step.pairs.start + index, pair);
            let counts = u32::from(worth > 0.0);
            self.rivals_of_truth[pair.truth as usize - step.truths.start] += counts;
            self.rivals_of_track[pair.track as usize - step.tracks.start] += counts;
            self.worths.push(worth);
        }
        self.sort_out(pairs, step);
        if !self.edges.is_empty() {
            self.solve();
        }
        &self.matched
    }

    /// Takes what nobody competes for, and puts the rest into the solver.
    fn sort_out(&mut self, pairs: &[Pair], step: &ComparedStep) {
        self.edges.clear();
        self.rows.clear();
        let mut row_of = u32::MAX;
        for (index, pair) in pairs.iter().enumerate() {
            if self.worths[index].is_nan() || self.worths[index] <= 0.0 {
                continue;
            }
            let track = pair.track as usize - step.tracks.start;
            let number = (step.pairs.start + index) as u32;
            if self.rivals_of_truth[pair.truth as usize - step.truths.start] == 1
                && self.rivals_of_track[track] == 1
            {
                self.matched.push(number);
                continue;
            }
            if row_of != pair.truth {
                self.open_row();
                row_of = pair.truth;
            }
            self.solver.push_edge(track as u32, -self.worths[index]);
            self.edges.push(number);
        }
    }

    fn open_row(&mut self) {
        if self.rows.is_empty() {
            self.solver.clear();
        } else {
            self.solver.end_row(0.0);
        }
        self.rows.push(self.edges.len() as u32);
    }

    fn solve(&mut self) {
        self.solver.end_row(0.0);
        let is_solved = match self.watch {
            Some(watch) => self.solver.solve_until(watch).is_some() || watch.is_stopped(),
            None => self.solver.solve().is_some(),
        };
        debug_assert!(
            is_solved,
            "an assignment in which everyone may stay alone exists"
        );
        for (row, &first) in self.rows.iter().enumerate() {
            self.matched.extend(
                self.solver
                    .edge_of(row)
                    .map(|edge| self.edges[first as usize + edge]),
            );
        }
        self.matched.sort_unstable();
    }
}

/// As many zeros.
fn restart(counts: &mut Vec<u32>, length: usize) {
    counts.clear();
    counts.resize(length, 0);
}
