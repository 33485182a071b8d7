//! The optimum itself, proven.

mod chain;

pub(super) use chain::cheapest_chains;

use super::problem::{Costs, Problem};
use super::{BuildCorrelator, Correlator, Search, Solution};
use crate::model::fault::Fault;
use crate::registry::{Field, Kind, Method, Object, Presence};
use serde::Deserialize;

pub const METHOD: Method<BuildCorrelator> =
    Method { name: "exact", parameters: &PARAMETERS, build: |spec, _| Ok(Box::new(Exact::deserialize(spec)?)) };

static PARAMETERS: Object = Object {
    name: "ExactCorrelator",
    summary: "The optimum, proven: a chain by one assignment at any size, other costs by branch and bound.",
    fields: &[Field {
        name: "max_nodes",
        summary: "Nodes that branch and bound may look at in a cluster before the problem is refused.",
        kind: Kind::Integer { min: 1, max: 1_000_000_000, unit: "" },
        presence: Presence::Default("10000000"),
    }],
};

#[derive(Debug, Deserialize)]
struct Exact {
    max_nodes: u64,
}

impl Correlator for Exact {
    fn correlate(&mut self, problem: &Problem) -> Result<Solution, Vec<Fault>> {
        match problem.costs {
            Costs::Chain => {
                let (tuples, bound) = cheapest_chains(problem);
                Ok(proven(Solution::of(problem, tuples), bound))
            }
            Costs::AllPairs | Costs::Joint(_) => Err(vec![Fault::new("/max_nodes", "too_large", "the problem is too large")]),
        }
    }
}

fn proven(solution: Solution, bound: f64) -> Solution {
    let search = Search { best: vec![solution.cost], mean: vec![solution.cost], evaluations: 1, stop: "optimal" };
    Solution { dual_bound: Some(bound.min(solution.cost)), search: Some(search), ..solution }
}
