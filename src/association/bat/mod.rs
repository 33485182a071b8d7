//! Bat algorithm data association (BADA): the tracks of a cluster share its detections in the way that is worth most, and
//! a swarm of bats looks for that way. Each bat is one assignment; it moves by changing or swapping entries.
//!
//! # Reference
//! Wang Y., Li Y., Huang H., multi-target data association by the bat algorithm (BADA), the paper this follows; X.-S. Yang, A
//! new metaheuristic bat-inspired algorithm, in Nature Inspired Cooperative Strategies for Optimization, 2010, 65–74.
//!
//! # Symbols
//! gᵢⱼ = N(νᵢⱼ; 0, Sᵢ) likelihood of detection j for target i; x a bat, xᵢ the detection of target i, 0 = none; x* the best
//! bat; J the objective; D Hamming distance; v speed; A loudness; r pulse rate, r⁰ its first value; α, γ constants of both; n
//! the iteration, from 1.
//!
//! # Method
//! Objective: `likelihood_sum` J = Σ gᵢⱼ over the pairs of the assignment, the paper's; it never prefers "none", so the gate is
//! the price of a miss. `log_likelihood_ratio` J = Σ ln(P_D gᵢⱼ / λ) − ln(1 − P_D P_G): against the event in which no track
//! has a detection, so its optimum is that of the global nearest neighbour.
//! 1. Every bat draws a detection for each target, the next free one where that is taken; r⁰ uniform in \[0, 1), r = r⁰.
//! 2. n = 1, 2, …: each bat moves, x ← x ⊕ v: v uniform in 1..D (1 when D = 0) neighbours are made, and the best of them
//!    replaces the bat, better or not. A neighbour gets a random detection at a random position; where another target
//!    holds that detection, the two swap, and what lies outside the other's gate becomes 0.
//! 3. With probability 1 − r the bat becomes a neighbour of x* instead, better or not.
//! 4. With probability A, if J(x) > J(x*): x* ← x, A ← α A, r ← r⁰ (1 − e^(−γ n)).
//!
//! The likelihood gᵢⱼ comes from the edges of the problem, ln(P_D gᵢⱼ / λ): P_D and λ are common to a cluster, and J counts in
//! multiples of its largest g. With polar reports λ is a density in the plane, and so is g there: the density in (r, β) divided by
//! the range that the track expects.
//!
//! Whether 0 may be drawn follows from the settings: with `log_likelihood_ratio`, whose optimum may hold it, and with
//! `weights: visited`, whose sum must cover misses. To the sum of likelihoods alone it is irrelevant. Tracks without a
//! candidate are in no cluster and never draw. A track alone takes its optimum in closed form; the swarm would find the same.

pub(super) mod at_truth;
mod cluster;
mod cluster_rng;
mod optimality_check;
mod swarm;
#[cfg(test)]
mod tests;
mod visited;

use super::problem::{Problem, Weights};
use super::{Associator, BuildAssociator, Trace};
use crate::math::rng::{Purpose, Seed};
use crate::registry::{Kind, Method, Object, above, default, whole};
use cluster::Cluster;
use cluster_rng::ClusterRng;
use optimality_check::OptimalityCheck;
use serde::Deserialize;
use serde_json::json;
use swarm::Swarm;
use visited::Visited;

/// Bats × iterations that a request may ask for: a cluster of six tracks then takes some 30 ms.
pub const MAX_MOVES: u64 = 1_000_000;

pub const METHOD: Method<BuildAssociator> = Method {
    name: "bat",
    parameters: &PARAMETERS,
    build: |spec, seed| Ok(Box::new(Bat::new(BatSettings::deserialize(spec)?, seed))),
};

static PARAMETERS: Object = Object {
    name: "Bat",
    summary: "Bat algorithm data association: a swarm searches the assignment of largest total likelihood.",
    fields: &[
        default(
            "population",
            "Bats. Population times iterations is at most 1000000.",
            whole(1, 10_000, "bats"),
            "20",
        ),
        default(
            "iterations",
            "Times that every bat moves.",
            whole(1, 10_000, ""),
            "15",
        ),
        default(
            "objective",
            "likelihood_sum: the sum of the pairs' likelihoods, as in the paper, which takes a detection wherever the gate has one; \
                      log_likelihood_ratio: the probability of the joint event, misses and clutter weighed.",
            Kind::Choice(&["likelihood_sum", "log_likelihood_ratio"]),
            "\"likelihood_sum\"",
        ),
        default(
            "candidates",
            "gated: a target draws among the detections in its gate; all: among all of the scan, where those outside its gate \
                      count nothing and are refused at the update.",
            Kind::Choice(&["gated", "all"]),
            "\"gated\"",
        ),
        default(
            "weights",
            "best: the best bat's detections, as in the paper; visited: weights as JPDA's, summed over the distinct assignments \
                      that the swarm has looked at.",
            Kind::Choice(&["best", "visited"]),
            "\"best\"",
        ),
        default(
            "loudness",
            "Loudness A at the start: below 1, better bats are refused at random.",
            above(0.0, 2.0, ""),
            "1",
        ),
        default(
            "alpha",
            "Factor of the loudness when a bat is accepted as the best.",
            above(0.0, 1.0, ""),
            "0.98",
        ),
        default(
            "gamma",
            "Speed at which the pulse rate returns to its first value.",
            above(0.0, 100.0, ""),
            "0.98",
        ),
        default(
            "trace",
            "Whether to write down every iteration of every cluster (association_trace.csv).",
            Kind::Flag,
            "false",
        ),
    ],
};

#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Objective {
    LikelihoodSum,
    LogLikelihoodRatio,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Candidates {
    Gated,
    All,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Answer {
    Best,
    Visited,
}

/// The parameters of [`PARAMETERS`].
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(default)]
struct BatSettings {
    population: u32,
    iterations: u32,
    objective: Objective,
    candidates: Candidates,
    weights: Answer,
    loudness: f64,
    alpha: f64,
    gamma: f64,
    trace: bool,
}

impl Default for BatSettings {
    fn default() -> Self {
        BatSettings {
            population: 20,
            iterations: 15,
            objective: Objective::LikelihoodSum,
            candidates: Candidates::Gated,
            weights: Answer::Best,
            loudness: 1.0,
            alpha: 0.98,
            gamma: 0.98,
            trace: false,
        }
    }
}

impl BatSettings {
    /// Whether 0 may be drawn.
    fn draws_missed(&self) -> bool {
        self.objective == Objective::LogLikelihoodRatio || self.weights == Answer::Visited
    }
}

const TRACE_HEADER: &str =
    "occasion,cluster,iteration,best_j,mean_j,evaluations,optimal_j,gap,assignment";

#[derive(Debug, Clone)]
struct Bat {
    settings: BatSettings,
    seed: Seed,
    cluster: Cluster,
    swarm: Swarm,
    /// Only for [`Answer::Visited`].
    visited: Option<Visited>,
    optimality: OptimalityCheck,
    trace: Option<Trace>,
}

impl Bat {
    fn new(settings: BatSettings, seed: Seed) -> Self {
        Bat {
            settings,
            seed,
            cluster: Cluster::default(),
            swarm: Swarm::default(),
            visited: (settings.weights == Answer::Visited).then(Visited::default),
            optimality: OptimalityCheck::default(),
            trace: settings.trace.then(|| Trace::new(TRACE_HEADER)),
        }
    }

    /// The swarm's search of the loaded cluster.
    fn search(&mut self, problem: &Problem) {
        let Bat {
            settings,
            seed,
            cluster,
            swarm,
            visited,
            optimality,
            trace,
        } = self;
        let name = problem.rows().next().map_or(0, |(row, _)| row);
        let mut rng = ClusterRng::new(seed.stream(
            Purpose::Associator,
            name as u64,
            u64::from(problem.problem_index()),
        ));
        let optimum = optimality.optimum(cluster);
        swarm.search(cluster, settings, visited.as_mut(), &mut rng, |swarm, iteration| {
            if let Some(trace) = trace {
                let (best, gap) = (swarm.best_value(), optimality_check::gap(swarm.best_value(), optimum));
                let (mean, assignment) = (swarm.mean_value(), optimality_check::assignment(problem, cluster, swarm.best()));
                let (problem_index, evaluations) = (problem.problem_index(), swarm.evaluations());
                trace.push(format_args!("{problem_index},{name},{iteration},{best},{mean},{evaluations},{optimum},{gap},{assignment}"));
            }
            !problem.stops_after(8 * u64::from(settings.population) * problem.row_count() as u64)
        });
        optimality.count_search(swarm, optimum, visited.as_ref());
    }
}

impl Associator for Bat {
    fn is_soft(&self) -> bool {
        self.settings.weights == Answer::Visited
    }

    fn associate(&mut self, problem: &Problem, weights: &mut Weights) {
        self.cluster.load(problem, &self.settings);
        let is_single = problem.row_count() == 1;
        if is_single {
            self.optimality.count_single(self.cluster.edges());
        } else {
            self.search(problem);
        }
        match &mut self.visited {
            Some(visited) => {
                if is_single {
                    visited.see_all_of_one(&self.cluster);
                }
                visited.store(&self.cluster, problem, weights);
            }
            None if is_single => {
                self.cluster
                    .choose(problem, &[self.cluster.best_of_first()], weights)
            }
            None => self.cluster.choose(problem, self.swarm.best(), weights),
        }
    }

    fn diagnostics(&self) -> Option<serde_json::Value> {
        serde_json::to_value(self.optimality.diagnostics(self.is_soft())).ok()
    }

    fn trace(&self) -> Option<&Trace> {
        self.trace.as_ref()
    }

    fn fork(&self) -> Box<dyn Associator> {
        Box::new(self.clone())
    }

    fn memory(&self) -> serde_json::Value {
        json!((self.optimality.counts(), &self.trace))
    }

    fn recall(&mut self, memory: &serde_json::Value) -> Result<(), serde_json::Error> {
        let (counts, trace) = Deserialize::deserialize(memory)?;
        self.optimality.set_counts(counts);
        self.trace = trace;
        Ok(())
    }
}
