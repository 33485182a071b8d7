//! The genetic algorithm: a population of ways to put the tracks together is crossed and mutated, and the cheaper ones have
//! more offspring. One variant is the paper's; the other searches cluster by cluster and improves every individual.
//!
//! # Reference
//! Huo L., Zhang Z., Bai P., Song Y., Xiong X., A sort of model of multi-sensor multi-object flight path connection based on
//! GA, J. Air Force Engineering University (Natural Science Edition) 9(3), 2008, 28–31. For the improved variant P. Galinier,
//! J.-K. Hao, Hybrid evolutionary algorithms for graph coloring, J. Combinatorial Optimization 3, 1999, 379–397 (individuals
//! are partitions at rest under local search; crossover hands down whole parts).
//!
//! # Symbols
//! J the cost, which is the fitness (smaller is fitter); P_c, P_m rates of crossover and mutation, P_r of reproduction;
//! G generations; G′, ε the end when the best cost stays.
//!
//! # Method
//! Selection, generations and the end: [`evolve`]; the share P_r of a generation that lives on is 1 less the generation gap.
//! - `paper`: one chromosome for the whole problem ([`paper`]), partially matched crossover and swap ([`permutation`]),
//!   a random first population.
//!   With `complete` it is the problem as printed ([`complete`]): complete tuples, Σ b as the fitness.
//! - `improved`: each cluster by itself ([`improved`]); the answers of `lagrangian`, `nearest` and `weighted` are in the first
//!   population, of a chain its optimum. A cluster whose cost is proven to be least, by the relaxation or because each track has
//!   its best link to each sensor, is done at once.
//!   One whose search ends above its bound is searched again from other individuals, each with every track alone, up to four times
//!   in all.
//! - `unseeded`: the same without those answers, to see what the search alone is worth.
//!
//! The random choices of a cluster come from the stream named after its first track and the number of the call.

mod complete;
mod evolve;
mod improved;
mod paper;
mod permutation;

use super::bound::dual_bound;
use super::chain::cheapest_chains;
use super::cluster::{Cluster, clusters};
use super::improve::{Improver, improve_all};
use super::lagrangian::relaxed_answer;
use super::nearest::nearest_tuples;
use super::partition::Partition;
use super::problem::{CorrelationProblem, Costs};
use super::weighted::weighted_tuples;
use super::{BuildCorrelator, Correlator, SearchHistory, Solution};
use crate::math::rng::{Purpose, Seed};
use crate::model::fault::Fault;
use crate::model::watch::Watch;
use crate::registry::{Bound, Kind, Method, Object, above, default, number, whole};
use complete::CompleteProblem;
use evolve::{Coding, Evolution, evolve};
use improved::Partitions;
use paper::Chromosomes;
use rand::SeedableRng;
use rand::rngs::Xoshiro256PlusPlus;
use serde::Deserialize;

pub const METHOD: Method<BuildCorrelator> = Method {
    name: "genetic",
    parameters: &PARAMETERS,
    build: |spec, seed| {
        Ok(Box::new(Genetic {
            settings: GeneticCorrelatorSettings::deserialize(spec)?,
            seed,
            calls: 0,
        }))
    },
};

static PARAMETERS: Object = Object {
    name: "GeneticCorrelator",
    summary: "A genetic algorithm: partitions of the tracks are crossed and mutated, the cheaper ones have more offspring.",
    fields: &[
        default(
            "variant",
            "improved: cluster by cluster, whole tuples are handed down, every individual is improved by local search, the first \
                      of them the answers of other correlators; unseeded: the same from every track alone; paper: one chromosome of \
                      permutations, partially matched crossover and swap; with complete as published.",
            Kind::Choice(&["improved", "unseeded", "paper"]),
            "\"improved\"",
        ),
        default(
            "complete",
            "Of the variant paper: the problem as printed. Each tuple has a track of every sensor, none is absent or alone, and J is the sum \
             of b, the λ of neighbours, without a threshold; refused where sensors have different numbers of tracks.",
            Kind::Flag,
            "false",
        ),
        default("population", "Individuals.", whole(2, 10_000, ""), "20"),
        default(
            "generations",
            "G, generations after the first population.",
            whole(1, 100_000, ""),
            "200",
        ),
        default(
            "crossover_rate",
            "P_c, probability that a pair is crossed.",
            SHARE,
            "0.8",
        ),
        default(
            "mutation_rate",
            "P_m, probability that a child mutates.",
            SHARE,
            "0.3",
        ),
        default(
            "generation_gap",
            "Share of a generation that is new; the others live on (P_r = 1 less the gap).",
            above(0.0, 1.0, ""),
            "0.5",
        ),
        default(
            "elite",
            "Fittest individuals that live on in any case.",
            whole(1, 10_000, ""),
            "2",
        ),
        default(
            "stop_after",
            "G', generations in a row with the best cost unchanged after which the search ends.",
            whole(1, 100_000, ""),
            "30",
        ),
        default(
            "max_evaluations",
            "Solutions, or changes of one, whose cost is computed in a cluster before the search ends.",
            whole(1, 1_000_000_000_000, ""),
            "100000",
        ),
        default(
            "epsilon",
            "A change of the best cost by no more than this counts as none.",
            Kind::Number {
                min: Bound::Including(0.0),
                max: Bound::None,
                unit: "",
            },
            "1e-9",
        ),
    ],
};

const SHARE: Kind = number(0.0, 1.0, "");

/// Searches of a cluster whose answer is not proven.
const ISLANDS: usize = 4;

#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Variant {
    Improved,
    Unseeded,
    Paper,
}

/// The parameters of [`PARAMETERS`].
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
struct GeneticCorrelatorSettings {
    variant: Variant,
    complete: bool,
    population: usize,
    generations: usize,
    crossover_rate: f64,
    mutation_rate: f64,
    generation_gap: f64,
    elite: usize,
    stop_after: usize,
    max_evaluations: u64,
    epsilon: f64,
}

#[derive(Debug)]
struct Genetic {
    settings: GeneticCorrelatorSettings,
    seed: Seed,
    /// Calls so far.
    calls: u64,
}

impl Correlator for Genetic {
    fn correlate(&mut self, problem: &CorrelationProblem) -> Result<Solution, Vec<Fault>> {
        self.correlate_until(problem, &Watch::never())
    }

    fn correlate_until(
        &mut self,
        problem: &CorrelationProblem,
        watch: &Watch,
    ) -> Result<Solution, Vec<Fault>> {
        self.calls += 1;
        match (self.settings.variant, self.settings.complete) {
            (Variant::Paper, true) => self.evolve_complete(problem, watch),
            (Variant::Paper, false) => Ok(self.evolve_chromosomes(problem, watch)),
            (_, true) => {
                let detail = "only chromosomes of permutations have complete tuples";
                let fault = Fault::new("/complete", "conflict", detail);
                Err(vec![fault.allowing("variant paper")])
            }
            (_, false) => Ok(self.evolve_clusters(problem, watch)),
        }
    }
}

impl Genetic {
    fn rng(&self, name: u64) -> Xoshiro256PlusPlus {
        Xoshiro256PlusPlus::from_rng(&mut self.seed.stream(
            Purpose::Correlator,
            name,
            self.calls - 1,
        ))
    }

    fn evolve_chromosomes(&self, problem: &CorrelationProblem, watch: &Watch) -> Solution {
        let mut coding = Chromosomes::new(problem, None);
        let (tuples, search) = self.search(&mut coding, watch);
        Solution {
            search: Some(search),
            ..Solution::from_tuples(problem, tuples).with_bound(dual_bound(problem))
        }
    }

    /// The problem as printed; its tuples need no links, and J is Σ b.
    fn evolve_complete(
        &self,
        problem: &CorrelationProblem,
        watch: &Watch,
    ) -> Result<Solution, Vec<Fault>> {
        let complete = CompleteProblem::of(problem)?;
        let mut coding = Chromosomes::new(problem, Some(&complete));
        let (tuples, search) = self.search(&mut coding, watch);
        let solution = Solution {
            tuples,
            cost: search.best[search.best.len() - 1],
            dual_bound: None,
            search: Some(search),
        };
        Ok(solution.with_bound(complete.least_cost()))
    }

    /// The tuples of the best chromosome, and how it was found.
    fn search(&self, coding: &mut Chromosomes, watch: &Watch) -> (Vec<Vec<u32>>, SearchHistory) {
        let mut rng = self.rng(0);
        let Evolution {
            best,
            best_costs,
            mean_costs,
            stop,
        } = evolve(coding, &self.settings, f64::NEG_INFINITY, &mut rng, watch);
        let search = SearchHistory {
            best: best_costs,
            mean: mean_costs,
            evaluations: coding.evaluations(),
            stop,
        };
        (coding.tuples(&best), search)
    }

    fn evolve_clusters(&self, problem: &CorrelationProblem, watch: &Watch) -> Solution {
        let start = (self.settings.variant == Variant::Improved).then(|| Start::new(problem));
        let (mut tuples, mut searches, mut bound) = (Vec::new(), Vec::new(), Some(0.0));
        let mut improver = Improver::default();
        for cluster in clusters(problem) {
            if watch.is_stopped() {
                break;
            }
            let before = improver.evaluations;
            let (seeds, of_cluster) = start.as_ref().map_or((Vec::new(), None), |start| {
                start.of_cluster(&cluster, &mut improver)
            });
            let least_cost = of_cluster.map_or(cluster.least_cost(), |bound| {
                bound.max(cluster.least_cost())
            });
            let mut coding = Partitions::new(&cluster, seeds, of_cluster.is_some(), improver);
            let mut rng = self.rng(cluster.name());
            let mut found = evolve(&mut coding, &self.settings, least_cost, &mut rng, watch);
            for _ in 1..ISLANDS {
                if of_cluster.is_none() || found.stop != "unchanged" {
                    break;
                }
                coding.forget_seeds();
                found = found.then(evolve(
                    &mut coding,
                    &self.settings,
                    least_cost,
                    &mut rng,
                    watch,
                ));
            }
            improver = coding.into_improver();
            tuples.extend(found.best.tuples().map(|tuple| cluster.names(&tuple)));
            bound = bound
                .zip(of_cluster)
                .map(|(sum, of_cluster)| sum + of_cluster.min(found.best.cost()));
            let Evolution {
                best_costs,
                mean_costs,
                stop,
                ..
            } = found;
            searches.push(SearchHistory {
                best: best_costs,
                mean: mean_costs,
                evaluations: improver.evaluations - before,
                stop,
            });
        }
        let of_problem = start
            .and_then(|start| start.least_of_chain)
            .or_else(|| dual_bound(problem));
        let bound = [bound, of_problem].into_iter().flatten().reduce(f64::max);
        Solution {
            search: Some(sum_searches(&searches)),
            ..Solution::from_tuples(problem, tuples).with_bound(bound)
        }
    }
}

/// What others answer, to begin with.
struct Start {
    /// The optimum of a chain; else the answers of `nearest` and `weighted`.
    answers: Vec<Vec<Vec<u32>>>,
    /// The least cost of a chain.
    least_of_chain: Option<f64>,
}

impl Start {
    fn new(problem: &CorrelationProblem) -> Self {
        if let Costs::Chain = problem.costs {
            let (tuples, least) = cheapest_chains(problem);
            return Start {
                answers: vec![tuples],
                least_of_chain: Some(least),
            };
        }
        Start {
            answers: vec![nearest_tuples(problem), weighted_tuples(problem)],
            least_of_chain: None,
        }
    }

    /// The first individuals of a cluster, at rest under local search, and what no other undercuts, where that is known.
    fn of_cluster(
        &self,
        cluster: &Cluster,
        improver: &mut Improver,
    ) -> (Vec<Partition>, Option<f64>) {
        if self.least_of_chain.is_some() {
            let optimum = Partition::of_problem(cluster, &self.answers[0]);
            let bound = optimum.cost();
            return (vec![optimum], Some(bound));
        }
        let mut seeds = improve_all(cluster, &self.answers, improver);
        let (answer, bound) = relaxed_answer(cluster, seeds[0].clone(), improver);
        seeds.insert(0, answer);
        (seeds, bound)
    }
}

/// Of each generation; a search that has ended keeps its last costs.
fn sum_costs(
    searches: &[SearchHistory],
    generations: usize,
    costs: fn(&SearchHistory) -> &[f64],
) -> Vec<f64> {
    let at = |generation: usize| {
        let all = searches.iter().map(costs);
        all.map(|costs| costs[generation.min(costs.len() - 1)])
            .sum()
    };
    (0..generations).map(at).collect()
}

/// The searches of all clusters as one: those that have ended stay where they are.
fn sum_searches(searches: &[SearchHistory]) -> SearchHistory {
    let generations = searches
        .iter()
        .map(|search| search.best.len())
        .max()
        .unwrap_or(1);
    let stops = ["evaluations", "generations", "unchanged"];
    let stop = stops
        .into_iter()
        .find(|stop| searches.iter().any(|search| search.stop == *stop))
        .unwrap_or("optimal");
    SearchHistory {
        best: sum_costs(searches, generations, |search| &search.best),
        mean: sum_costs(searches, generations, |search| &search.mean),
        evaluations: searches.iter().map(|search| search.evaluations).sum(),
        stop,
    }
}
