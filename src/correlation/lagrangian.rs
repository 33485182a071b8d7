//! Lagrangian relaxation: that each track is in one tuple is given a price, the relaxed problem is solved again and again, and
//! the prices say how good the best answer can be at most.
//!
//! # Method
//! A chain is solved by its assignment, whose duals are the prices. Other costs, cluster by cluster:
//! 1. Tuples and multipliers: [`super::tuples`]; where there are too many tuples to list, and costs are sums over all pairs,
//!    [`super::pricing`].
//! 2. Back to an answer: tuples in order of r(T) under the best multipliers, each taken where its members are free; then local
//!    search ([`super::improve`]). The better of this and of the improved answers of `nearest` and `weighted` is the answer.
//! 3. Σ of the best L of all clusters is the dual bound. A cluster that `max_nodes` are not enough for is not relaxed: its answer
//!    is the local search's, and the bound is that of all pairs ([`super::bound`]), or none.

use super::bound::dual_bound;
use super::chain::cheapest_chains;
use super::cluster::{Cluster, clusters};
use super::improve::{Improver, improve_all};
use super::nearest::nearest_tuples;
use super::partition::Partition;
use super::pricing::price;
use super::problem::{CorrelationProblem, Costs};
use super::tuples::{Relaxation, TooLarge, Tuple, list_tuples, relax};
use super::weighted::weighted_tuples;
use super::{BuildCorrelator, Correlator, SearchHistory, Solution};
use crate::model::fault::Fault;
use crate::model::watch::Watch;
use crate::registry::{Method, Object, default, whole};
use serde::Deserialize;

pub const METHOD: Method<BuildCorrelator> = Method {
    name: "lagrangian",
    parameters: &PARAMETERS,
    build: |spec, _| Ok(Box::new(Lagrangian::deserialize(spec)?)),
};

/// Nodes that listing may take; where that is not enough, tuples are looked for as prices ask for them.
const MAX_LISTED: u64 = 50_000;

static PARAMETERS: Object = Object {
    name: "LagrangianCorrelator",
    summary: "Lagrangian relaxation: an answer, and a bound that no answer undercuts.",
    fields: &[
        default(
            "rounds",
            "Subgradient steps of a cluster.",
            whole(1, 100_000, ""),
            "300",
        ),
        default(
            "max_nodes",
            "Beginnings of tuples that may be looked at in a cluster; one that needs more for a bound is left to local search.",
            whole(1, 1_000_000_000, ""),
            "10000000",
        ),
    ],
};

#[derive(Debug, Deserialize)]
struct Lagrangian {
    rounds: usize,
    max_nodes: u64,
}

/// An answer for a cluster and its bound, for others to begin with; `start` is one at rest under local search.
pub(super) fn relaxed_answer(
    cluster: &Cluster,
    start: Partition,
    improver: &mut Improver,
) -> (Partition, Option<f64>) {
    let (answer, relaxation) = Lagrangian {
        rounds: 300,
        max_nodes: 1_000_000,
    }
    .solve(cluster, start, improver);
    (answer, relaxation.map(|found| found.bound))
}

impl Correlator for Lagrangian {
    fn correlate(&mut self, problem: &CorrelationProblem) -> Result<Solution, Vec<Fault>> {
        Ok(self.solve_all(
            problem,
            &[nearest_tuples(problem), weighted_tuples(problem)],
        ))
    }
}

impl Lagrangian {
    fn solve_all(&self, problem: &CorrelationProblem, known: &[Vec<Vec<u32>>]) -> Solution {
        if matches!(problem.costs, Costs::Chain) {
            let (tuples, bound) = cheapest_chains(problem);
            return Solution::from_tuples(problem, tuples).with_bound(Some(bound));
        }
        let mut improver = Improver::default();
        let (mut tuples, mut bound, mut bounds) = (Vec::new(), Some(0.0), Vec::new());
        for cluster in clusters(problem) {
            let start = improve_all(&cluster, known, &mut improver).swap_remove(0);
            let (answer, relaxation) = self.solve(&cluster, start, &mut improver);
            tuples.extend(answer.tuples().map(|tuple| cluster.names(&tuple)));
            bound = bound
                .zip(relaxation.as_ref())
                .map(|(sum, found)| sum + found.bound.min(answer.cost()));
            bounds.extend(relaxation.map(|found| found.bounds));
        }
        let solution = Solution::from_tuples(problem, tuples);
        let solution = solution.with_bound(
            [dual_bound(problem), bound]
                .into_iter()
                .flatten()
                .reduce(f64::max),
        );
        Solution {
            search: Some(search_of(&bounds, &solution)),
            ..solution
        }
    }

    /// From an answer at rest under local search.
    fn solve(
        &self,
        cluster: &Cluster,
        start: Partition,
        improver: &mut Improver,
    ) -> (Partition, Option<Relaxation>) {
        let Some(relaxation) = self.relax(cluster, &start) else {
            return (start, None);
        };
        let recovered = recover(cluster, &relaxation, improver);
        (
            if recovered.cost() < start.cost() {
                recovered
            } else {
                start
            },
            Some(relaxation),
        )
    }
}

impl Lagrangian {
    /// Step 1.
    fn relax(&self, cluster: &Cluster, start: &Partition) -> Option<Relaxation> {
        match list_tuples(
            cluster,
            &mut self.max_nodes.min(MAX_LISTED),
            &Watch::never(),
        ) {
            Ok(tuples) => Some(relax(&tuples, start.cost(), self.rounds)),
            Err(TooLarge) if cluster.is_pairwise() => price(cluster, start, self.max_nodes),
            Err(TooLarge) => None,
        }
    }
}

/// Step 2.
fn recover(cluster: &Cluster, relaxation: &Relaxation, improver: &mut Improver) -> Partition {
    let mut order: Vec<(f64, &Tuple)> = Vec::new();
    for tuple in relaxation.tuples.iter().flatten() {
        let members = tuple.members.iter();
        let prices = members.map(|&member| relaxation.multipliers[member as usize]);
        order.push((tuple.cost - prices.sum::<f64>(), tuple));
    }
    order.sort_by(|left, right| left.0.total_cmp(&right.0));
    let mut is_free = vec![true; cluster.len()];
    let mut taken: Vec<&[u32]> = Vec::new();
    for (_, tuple) in order {
        if tuple.members.iter().all(|&member| is_free[member as usize]) {
            tuple
                .members
                .iter()
                .for_each(|&member| is_free[member as usize] = false);
            taken.push(&tuple.members);
        }
    }
    let mut partition = Partition::from_tuples(cluster, taken.into_iter());
    improver.improve_all(cluster, &mut partition);
    partition
}

/// The bound round by round as the trace of the search, summed over clusters: those that have ended stay at their last.
fn search_of(bounds: &[Vec<f64>], solution: &Solution) -> SearchHistory {
    let rounds = bounds.iter().map(Vec::len).max().unwrap_or(0);
    let at = |round: usize| bounds.iter().map(|of| of[round.min(of.len() - 1)]).sum();
    let is_proven = solution
        .dual_bound
        .is_some_and(|bound| solution.cost - bound <= 1e-9);
    SearchHistory {
        best: vec![solution.cost; rounds],
        mean: (0..rounds).map(at).collect(),
        evaluations: bounds.iter().map(|of| of.len() as u64).sum(),
        stop: if is_proven { "optimal" } else { "generations" },
    }
}
