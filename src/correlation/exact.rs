//! The optimum itself, proven.

use super::chain::cheapest_chains;
use super::cluster::clusters;
use super::cover::cheapest_cover;
use super::improve::{Improver, improve_all};
use super::nearest::nearest_tuples;
use super::problem::{CorrelationProblem, Costs};
use super::tuples::TooLarge;
use super::weighted::weighted_tuples;
use super::{BuildCorrelator, Correlator, SearchHistory, Solution};
use crate::model::fault::Fault;
use crate::model::watch::Watch;
use crate::registry::{Method, Object, default, whole};
use serde::Deserialize;

pub const METHOD: Method<BuildCorrelator> = Method {
    name: "exact",
    parameters: &PARAMETERS,
    build: |spec, _| Ok(Box::new(Exact::deserialize(spec)?)),
};

static PARAMETERS: Object = Object {
    name: "ExactCorrelator",
    summary: "The optimum, proven: a chain by one assignment at any size, other costs by branch and bound.",
    fields: &[default(
        "max_nodes",
        "Nodes that branch and bound may look at in a cluster before the problem is refused.",
        whole(1, 1_000_000_000, ""),
        "10000000",
    )],
};

#[derive(Debug, Deserialize)]
struct Exact {
    max_nodes: u64,
}

impl Correlator for Exact {
    fn correlate(&mut self, problem: &CorrelationProblem) -> Result<Solution, Vec<Fault>> {
        self.correlate_until(problem, &Watch::never())
    }

    fn correlate_until(
        &mut self,
        problem: &CorrelationProblem,
        watch: &Watch,
    ) -> Result<Solution, Vec<Fault>> {
        let (tuples, bound) = match problem.costs {
            Costs::Chain => cheapest_chains(problem),
            Costs::AllPairs | Costs::Joint(_) => {
                (self.cheapest_covers(problem, watch)?, f64::INFINITY)
            }
        };
        Ok(proven(Solution::from_tuples(problem, tuples), bound))
    }
}

impl Exact {
    /// Cluster by cluster.
    fn cheapest_covers(
        &self,
        problem: &CorrelationProblem,
        watch: &Watch,
    ) -> Result<Vec<Vec<u32>>, Vec<Fault>> {
        let known = [nearest_tuples(problem), weighted_tuples(problem)];
        let mut improver = Improver::default();
        let mut tuples = Vec::new();
        for cluster in clusters(problem) {
            let start = improve_all(&cluster, &known, &mut improver).swap_remove(0);
            let mut nodes = self.max_nodes;
            let found = cheapest_cover(&cluster, start.cost(), &mut nodes, watch).map_err(|TooLarge| {
                let detail = format!(
                    "a cluster of {} tracks of {} sensors needs more than {} nodes to prove its optimum",
                    cluster.len(),
                    cluster.sensors(),
                    self.max_nodes
                );
                vec![Fault::new("/max_nodes", "too_large", detail).allowing("more nodes, or the correlator genetic")]
            })?;
            let best = found.unwrap_or_else(|| start.tuples().collect());
            tuples.extend(best.iter().map(|tuple| cluster.names(tuple)));
        }
        Ok(tuples)
    }
}

fn proven(solution: Solution, bound: f64) -> Solution {
    let search = SearchHistory {
        best: vec![solution.cost],
        mean: vec![solution.cost],
        evaluations: 1,
        stop: "optimal",
    };
    Solution {
        dual_bound: Some(bound.min(solution.cost)),
        search: Some(search),
        ..solution
    }
}
