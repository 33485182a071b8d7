//! The problem as the paper prints it: every sensor has one track of each target, so that every tuple has a track of each sensor,
//! none is absent and none stays alone.
//!
//! # Symbols
//! T tracks of each of M sensors; λ of two tracks ([`Evidence`](crate::correlation::evidence::Evidence)); b the sum of λ over the
//! neighbours of a tuple; J = Σ b (eqs. 9, 11, 12).
//!
//! # Method
//! - The λ of all pairs of neighbouring sensors, also of those that no one would link, stand in M − 1 tables of T × T.
//! - b adds neighbours only, so the least J is that of M − 1 assignments, one a table.

use crate::correlation::problem::{CorrelationProblem, Costs};
use crate::correlation::statistic::MAX_PAIRS;
use crate::math::assignment::assign_dense;
use crate::model::fault::Fault;

pub(super) struct CompleteProblem {
    /// T.
    pub(super) targets: usize,
    /// For each sensor but the last λ between its tracks and those of the next, row by row.
    lambdas: Vec<Vec<f64>>,
}

impl CompleteProblem {
    /// # Errors
    /// A fault of `/complete`: another statistic than the chain, sensors with different numbers of tracks, tracks without a common
    /// time, or more pairs than should be compared.
    pub(super) fn of(problem: &CorrelationProblem) -> Result<Self, Vec<Fault>> {
        let refused = |detail: String, allowed: &str| {
            vec![Fault::new("/complete", "unsupported", detail).allowing(allowed)]
        };
        if !matches!(problem.costs, Costs::Chain) {
            let detail = "complete tuples cost b, the sum of λ over neighbouring sensors";
            return Err(refused(detail.to_owned(), "statistic.kind chain"));
        }
        let counts: Vec<usize> = (0..problem.sensors())
            .map(|sensor| problem.of_sensor(sensor).len())
            .collect();
        let targets = counts[0];
        if counts.iter().any(|&count| count != targets) {
            let names: Vec<String> = counts.iter().map(usize::to_string).collect();
            let detail = format!(
                "the sensors have {} tracks, and complete tuples have one of each",
                names.join(", ")
            );
            return Err(refused(detail, "false, or as many tracks of every sensor"));
        }
        if targets * targets * (counts.len() - 1) > MAX_PAIRS {
            let detail = format!("{} sensors of {targets} tracks", counts.len());
            let allowed = format!("at most {MAX_PAIRS} pairs of tracks of neighbouring sensors");
            return Err(refused(detail, &allowed));
        }
        let tables = (1..counts.len()).map(|sensor| lambdas_before(problem, sensor));
        match tables.collect() {
            Some(lambdas) => Ok(CompleteProblem { targets, lambdas }),
            None => {
                let detail = "two tracks of neighbouring sensors have no common time";
                Err(refused(detail.to_owned(), "false"))
            }
        }
    }

    /// J of a chromosome.
    pub(super) fn cost(&self, chromosome: &[u32]) -> f64 {
        let mut sum = 0.0;
        for row in 0..self.targets {
            let mut before = row;
            for (lambdas, permutation) in self
                .lambdas
                .iter()
                .zip(chromosome.chunks_exact(self.targets))
            {
                let next = permutation[row] as usize;
                sum += lambdas[before * self.targets + next];
                before = next;
            }
        }
        sum
    }

    /// The least J.
    pub(super) fn least_cost(&self) -> Option<f64> {
        let least = |lambdas: &Vec<f64>| Some(assign_dense(lambdas, self.targets)?.cost);
        self.lambdas.iter().map(least).sum()
    }
}

/// λ between the tracks of a sensor and those of the one before it; `None` where two have no common time.
fn lambdas_before(problem: &CorrelationProblem, sensor: usize) -> Option<Vec<f64>> {
    let evidence = problem.evidence()?;
    let mut lambdas = Vec::new();
    for before in problem.of_sensor(sensor - 1) {
        for track in problem.of_sensor(sensor) {
            lambdas.push(evidence.pair(before, track)?.lambda);
        }
    }
    Some(lambdas)
}
