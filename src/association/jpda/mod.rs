//! Joint probabilistic data association: each track is updated with all detections in its gate, each weighted by the
//! probability that it came from the target, summed over every way in which the tracks of a cluster can share them.
//!
//! # Reference
//! Y. Bar-Shalom, T. E. Fortmann, Tracking and Data Association, 1988, section 9.3; Y. Bar-Shalom, X.-R. Li,
//! Multitarget-Multisensor Tracking, 1995, section 6.2. The algorithms for the sums name theirs in their files.
//!
//! # Symbols
//! A joint event gives each track at most one of its detections and each detection to at most one track. βᵢⱼ is the
//! probability that track i has detection j, βᵢ₀ that it has none.
//!
//! # Method
//! 1. P(event) ∝ Π over tracks of the weight of its detection, or of none.
//! 2. βᵢⱼ = Σ P over the events in which i has j: by one of the algorithms named in the parameter `marginals`. (Where
//!    others call this choice JPDA's method: here `method` is already the word that names JPDA itself.)
//!
//! `auto` decides for each cluster: the closed form for a single track, the list of all events where it is short, else
//! the exact sum where its tables stay within `max_states` and `max_auto_cost`, else belief propagation. No cap is passed silently: the
//! diagnostics count what each algorithm did and what a cap kept from the one asked for.
//!
//! Averages draw the tracks of close targets together. Against that: `best_permutation.rs` (JPDA*) and `decide.rs` (NN-JPDA).

mod belief_propagation;
mod best_permutation;
mod blocks;
mod cluster;
mod decide;
mod diagnostics;
mod enumerate;
mod exact;
mod kept_events;
mod number;
mod plan;
#[cfg(test)]
mod tests;

use super::problem::{Problem, Weights};
use super::{Associator, BuildAssociator};
use crate::math::assignment::AssignmentSolver;
use crate::model::watch::Watch;
use crate::registry::{Kind, Method, Object, default, number, whole};
use belief_propagation::BeliefPropagation;
use best_permutation::BestPermutation;
use cluster::Cluster;
use decide::decide;
use diagnostics::Diagnostics;
use enumerate::Enumerate;
use exact::{Exact, Planned};
use plan::Limits;
use serde::Deserialize;
use serde_json::json;

pub const METHOD: Method<BuildAssociator> = Method {
    name: "jpda",
    parameters: &PARAMETERS,
    build: |spec, _| Ok(Box::new(Jpda::new(JpdaSettings::deserialize(spec)?))),
};

static PARAMETERS: Object = Object {
    name: "Jpda",
    summary: "Joint probabilistic data association: every detection in the gate counts by its probability.",
    fields: &[
        default(
            "against_coalescence",
            "What keeps the tracks of close targets from being drawn together: best_permutation (JPDA*, Blom and Bloem 2000) counts, of \
                      all joint events that detect the same tracks with the same detections, the most probable one alone; \
                      nearest_neighbour (NN-JPDA, Fitzgerald 1986) gives each track one detection or none, by the largest product \
                      of their probabilities.",
            Kind::Choice(&["none", "best_permutation", "nearest_neighbour"]),
            "\"none\"",
        ),
        default(
            "marginals",
            "How the probabilities of a cluster are summed: auto picks the cheapest exact way and approximates only where \
                      none is within the caps; enumerate lists joint events as the papers do; exact sums them without listing; \
                      belief_propagation approximates.",
            Kind::Choice(&["auto", "exact", "enumerate", "belief_propagation"]),
            "\"auto\"",
        ),
        default(
            "max_events",
            "Joint events of a cluster that enumerate lists; a cluster with more is left to auto, and counted. A hundred \
                      million take about a second.",
            whole(1, 100_000_000, "events"),
            "1000000",
        ),
        default(
            "max_states",
            "Cells of one table of exact; a cluster that needs more goes to belief propagation, and is counted. Joint events of \
                      a cluster that best_permutation keeps; one with more is served as with none, and counted.",
            whole(1, 16_777_216, "states"),
            "65536",
        ),
        default(
            "max_auto_cost",
            "Cells that auto lets an exact sum visit, over all its tables; a cluster that needs more goes to belief \
                      propagation, and is counted. A million take a few milliseconds.",
            whole(1, MAX_EXACT_COST as i64, "cells"),
            "200000",
        ),
        default(
            "tolerance",
            "Belief propagation ends when no message changes by more than this, relative to itself; below 1e-14 rounding \
                      alone would keep it from ending.",
            number(1e-14, 0.1, ""),
            "1e-9",
        ),
        default(
            "max_iterations",
            "Belief propagation ends after this many rounds of messages; a cluster that has not settled is counted. Ten \
                      thousand rounds of a cluster with 30 000 edges take a few seconds.",
            whole(1, 10_000, ""),
            "1000",
        ),
    ],
};

#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Marginals {
    Auto,
    Exact,
    Enumerate,
    BeliefPropagation,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
enum AgainstCoalescence {
    None,
    BestPermutation,
    NearestNeighbour,
}

/// The parameters of [`PARAMETERS`].
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(default)]
struct JpdaSettings {
    against_coalescence: AgainstCoalescence,
    marginals: Marginals,
    max_events: u64,
    max_states: u64,
    max_auto_cost: u64,
    tolerance: f64,
    max_iterations: u32,
}

impl Default for JpdaSettings {
    fn default() -> Self {
        JpdaSettings {
            against_coalescence: AgainstCoalescence::None,
            marginals: Marginals::Auto,
            max_events: 1_000_000,
            max_states: 65_536,
            max_auto_cost: 200_000,
            tolerance: 1e-9,
            max_iterations: 1000,
        }
    }
}

/// Clusters with at most this many joint events are listed by `auto`: planning an exact sum would cost more.
const FEW_EVENTS: f64 = 32.0;

/// Cells that one exact sum may visit, over all its tables: beyond it the memory for them would be too large.
const MAX_EXACT_COST: u64 = 1 << 25;

#[derive(Debug, Clone)]
struct Jpda {
    settings: JpdaSettings,
    diagnostics: Diagnostics,
    cluster: Cluster,
    enumerate: Enumerate,
    exact: Exact,
    belief_propagation: BeliefPropagation,
    best_permutation: BestPermutation,
    solver: AssignmentSolver,
}

impl Associator for Jpda {
    fn is_soft(&self) -> bool {
        self.settings.against_coalescence != AgainstCoalescence::NearestNeighbour
    }

    fn associate(&mut self, problem: &Problem, weights: &mut Weights) {
        if problem.row_count() == 1 {
            let detections = weigh_single(problem, weights);
            self.diagnostics.single(detections);
        } else {
            self.cluster.load(problem);
            self.weigh(problem.watch());
            self.cluster.store(problem, weights);
        }
        if !self.is_soft() {
            decide(&mut self.solver, problem, weights);
        }
    }

    fn diagnostics(&self) -> Option<serde_json::Value> {
        serde_json::to_value(&self.diagnostics).ok()
    }

    fn fork(&self) -> Box<dyn Associator> {
        Box::new(self.clone())
    }

    fn memory(&self) -> serde_json::Value {
        json!(self.diagnostics)
    }

    fn recall(&mut self, memory: &serde_json::Value) -> Result<(), serde_json::Error> {
        self.diagnostics = Diagnostics::deserialize(memory)?;
        Ok(())
    }
}

/// The closed form for a track without rivals: its own weights, divided by their sum. Returns how many detections it has.
fn weigh_single(problem: &Problem, weights: &mut Weights) -> usize {
    let mut detections = 0;
    for (index, row) in problem.rows() {
        let top = row
            .edges()
            .map(|edge| problem.edge(edge).log_likelihood)
            .fold(row.log_missed, f64::max);
        let missed = (row.log_missed - top).exp();
        let mut total = missed;
        for edge in row.edges() {
            let weight = (problem.edge(edge).log_likelihood - top).exp();
            weights.edges[edge] = weight;
            total += weight;
        }
        for edge in row.edges() {
            weights.edges[edge] /= total;
        }
        weights.missed[index] = missed / total;
        detections = row.edges().len();
    }
    detections
}

impl Jpda {
    fn new(settings: JpdaSettings) -> Self {
        Jpda {
            settings,
            diagnostics: Diagnostics::new(settings.against_coalescence),
            cluster: Cluster::default(),
            enumerate: Enumerate::default(),
            exact: Exact::default(),
            belief_propagation: BeliefPropagation::default(),
            best_permutation: BestPermutation::default(),
            solver: AssignmentSolver::default(),
        }
    }

    /// The marginals of the cluster at hand.
    fn weigh(&mut self, watch: &Watch) {
        let is_star = self.settings.against_coalescence == AgainstCoalescence::BestPermutation;
        if is_star && self.keep_best(watch) {
            return;
        }
        match self.settings.marginals {
            Marginals::Auto => self.choose(watch),
            Marginals::Enumerate => self.list_or_choose(watch),
            Marginals::Exact => self.sum_or_propagate(MAX_EXACT_COST, watch),
            Marginals::BeliefPropagation => self.propagate(watch),
        }
    }

    /// Whether the events that JPDA* keeps were few enough.
    fn keep_best(&mut self, watch: &Watch) -> bool {
        let max_events = self.settings.max_states;
        let kept = self
            .best_permutation
            .marginals(&mut self.cluster, max_events, watch);
        self.diagnostics.count_best_permutation(&self.cluster, kept);
        kept.is_some()
    }

    /// The cheapest exact algorithm within the caps, else belief propagation.
    fn choose(&mut self, watch: &Watch) {
        let few = FEW_EVENTS.min(self.settings.max_events as f64);
        if self.cluster.most_events() > few || !self.list() {
            self.sum_or_propagate(self.settings.max_auto_cost, watch);
        }
    }

    fn list_or_choose(&mut self, watch: &Watch) {
        if !self.list() {
            self.diagnostics.caps().enumerate += 1;
            self.choose(watch);
        }
    }

    fn sum_or_propagate(&mut self, max_cost: u64, watch: &Watch) {
        let limits = Limits {
            width: self.settings.max_states.ilog2(),
            cost: max_cost,
        };
        match self.exact.plan(&self.cluster, limits) {
            Some(planned) => self.sum(planned),
            None => {
                self.diagnostics.caps().exact += 1;
                self.propagate(watch);
            }
        }
    }

    /// Whether the events were few enough to be listed.
    fn list(&mut self) -> bool {
        let is_listed = self
            .enumerate
            .marginals(&mut self.cluster, self.settings.max_events);
        if is_listed {
            self.diagnostics.count_enumerated(&self.cluster);
        }
        is_listed
    }

    fn sum(&mut self, planned: Planned) {
        self.exact.marginals(&mut self.cluster, planned);
        self.diagnostics.exact(&self.cluster, planned.frontier);
    }

    fn propagate(&mut self, watch: &Watch) {
        let JpdaSettings {
            tolerance,
            max_iterations,
            ..
        } = self.settings;
        let settled = self.belief_propagation.marginals(
            &mut self.cluster,
            (tolerance, max_iterations),
            watch,
        );
        self.diagnostics.count_propagated(&self.cluster, settled);
    }
}
