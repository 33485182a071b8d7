//! The optimum itself, proven.

use super::bound::dual_bound;
use super::chain::cheapest_chains;
use super::cluster::{Cluster, clusters};
use super::cover::cheapest_cover;
use super::improve::{Improver, improve_all};
use super::nearest::nearest_tuples;
use super::problem::{CorrelationProblem, Costs};
use super::tuples::TooLarge;
use super::weighted::weighted_tuples;
use super::{BuildCorrelator, Correlator, SearchHistory, Solution};
use crate::model::fault::Fault;
use crate::model::watch::Watch;
use crate::registry::{Kind, Method, Object, default, whole};
use serde::Deserialize;

pub const METHOD: Method<BuildCorrelator> = Method {
    name: "exact",
    parameters: &PARAMETERS,
    build: |spec, _| Ok(Box::new(Exact::deserialize(spec)?)),
};

static PARAMETERS: Object = Object {
    name: "ExactCorrelator",
    summary: "The optimum, proven: a chain by one assignment at any size, other costs by branch and bound.",
    fields: &[
        default(
            "max_nodes",
            "Nodes that branch and bound may look at in a cluster before the problem is refused.",
            whole(1, 1_000_000_000, ""),
            "10000000",
        ),
        default(
            "may_be_unproven",
            "Whether a problem that needs more nodes is answered, by local search where the proof is missing, instead of refused.",
            Kind::Flag,
            "false",
        ),
    ],
};

#[derive(Debug, Deserialize)]
struct Exact {
    max_nodes: u64,
    may_be_unproven: bool,
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
        if let Costs::Chain = problem.costs {
            let (tuples, bound) = cheapest_chains(problem);
            return Ok(with_search(problem, tuples, Some(bound), "optimal"));
        }
        let (tuples, is_proven) = self.cheapest_covers(problem, watch)?;
        let (bound, stop) = if is_proven {
            (Some(f64::INFINITY), "optimal")
        } else {
            (dual_bound(problem), "evaluations")
        };
        Ok(with_search(problem, tuples, bound, stop))
    }
}

impl Exact {
    /// Cluster by cluster; and whether all of them are proven.
    fn cheapest_covers(
        &self,
        problem: &CorrelationProblem,
        watch: &Watch,
    ) -> Result<(Vec<Vec<u32>>, bool), Vec<Fault>> {
        let known = [nearest_tuples(problem), weighted_tuples(problem)];
        let mut improver = Improver::default();
        let (mut tuples, mut is_proven) = (Vec::new(), true);
        for cluster in clusters(problem) {
            let start = improve_all(&cluster, &known, &mut improver).swap_remove(0);
            let mut nodes = self.max_nodes;
            let found = match cheapest_cover(&cluster, start.cost(), &mut nodes, watch) {
                Ok(found) => found,
                Err(TooLarge) if self.may_be_unproven => {
                    is_proven = false;
                    None
                }
                Err(TooLarge) => return Err(vec![self.too_large(&cluster)]),
            };
            let best = found.unwrap_or_else(|| start.tuples().collect());
            tuples.extend(best.iter().map(|tuple| cluster.names(tuple)));
        }
        Ok((tuples, is_proven))
    }

    fn too_large(&self, cluster: &Cluster) -> Fault {
        let detail = format!(
            "a cluster of {} tracks of {} sensors needs more than {} nodes to prove its optimum",
            cluster.len(),
            cluster.sensors(),
            self.max_nodes
        );
        Fault::new("/max_nodes", "too_large", detail)
            .allowing("more nodes, may_be_unproven, or the correlator genetic")
    }
}

fn with_search(
    problem: &CorrelationProblem,
    tuples: Vec<Vec<u32>>,
    bound: Option<f64>,
    stop: &'static str,
) -> Solution {
    let solution = Solution::from_tuples(problem, tuples).with_bound(bound);
    let search = SearchHistory {
        best: vec![solution.cost],
        mean: vec![solution.cost],
        evaluations: 1,
        stop,
    };
    Solution {
        search: Some(search),
        ..solution
    }
}
