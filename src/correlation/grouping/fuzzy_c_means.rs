//! Fuzzy c-means as a grouper: reports are objects, targets are clusters; each report goes to the cluster to which it belongs
//! most.
//!
//! # Reference
//! Cai Yubao et al., Application of fuzzy data association algorithm on multitarget tracking; the clustering itself is
//! [`crate::math::fuzzy_c_means`].
//!
//! # Symbols
//! x_k report k with covariance R_k, v_i centre i, u_ik membership; d² = (x_k − v_i)ᵀ R_k⁻¹ (x_k − v_i).
//!
//! # Method
//! 1. The first centres: the predictions, the reports of one sensor, reports drawn at random, or the best of a genetic
//!    search. Where c is not known, fuzzy c-means runs for each c of a range, and the one with the best validity index stays.
//! 2. Fuzzy c-means from there.
//! 3. Each report to the cluster of its largest membership; or, with one report of a sensor in a group, for each sensor the
//!    assignment of its reports to different clusters with the largest total membership. A report that gets none is a group
//!    of its own.

use super::constrained_hard_c_means::with_groups_of_their_own;
use super::{BuildGrouper, Grouper, Grouping, Place, Report, Snapshot, by_sensor};
use crate::math::fuzzy_c_means::genetic::{self, GeneticSettings};
use crate::math::fuzzy_c_means::harden::{self, BySource};
use crate::math::fuzzy_c_means::{
    FuzzyCMeans, FuzzyError, Metric, Objects, Outcome, Settings, Step, start, validity,
};
use crate::math::gaussian::Gaussian;
use crate::math::rng::{Purpose, Seed};
use crate::model::fault::Fault;
use crate::registry::{
    Field, Kind, Method, Object, Union, default, number, required, variant, whole,
};
use serde::Deserialize;
use serde_json::Value;

pub const METHOD: Method<BuildGrouper> = Method {
    name: "fuzzy_c_means",
    parameters: &PARAMETERS,
    build,
};

static PARAMETERS: Object = Object {
    name: "FuzzyCMeansGrouper",
    summary: "Each report goes to the cluster to which it belongs most.",
    fields: &[
        default(
            "initial",
            "Where the first centres come from.",
            Kind::Union(&INITIAL),
            r#"{"from":"predictions"}"#,
        ),
        super::FUZZIFIER,
        super::TOLERANCE,
        super::MAX_ITERATIONS,
        super::ONE_PER_SENSOR,
        default(
            "trace",
            "Whether to keep costs, centres and memberships of every iteration for a file.",
            Kind::Flag,
            "false",
        ),
    ],
};

static INITIAL: Union = Union {
    name: "FuzzyInitialCentres",
    summary: "Where the first centres come from.",
    tag: "from",
    variants: || {
        vec![
            variant("predictions", &PREDICTIONS),
            variant("sensor", &SENSOR),
            variant("random", &RANDOM),
            variant("genetic", &GENETIC),
        ]
    },
};

static PREDICTIONS: Object = Object {
    name: "CentresOfPredictions",
    summary: "One centre where each track is predicted.",
    fields: &[],
};

static SENSOR: Object = Object {
    name: "CentresOfOneSensor",
    summary: "The reports of the sensor that has most, then each time the report that is farthest from all centres.",
    fields: &[CLUSTERS],
};

static RANDOM: Object = Object {
    name: "CentresAtRandom",
    summary: "Different reports, drawn at random.",
    fields: &[CLUSTERS],
};

static GENETIC: Object = Object {
    name: "CentresOfGeneticSearch",
    summary: "The best of a population of centres, each driven to its optimum before it is crossed and mutated. The cost is (generations + 1) · population runs.",
    fields: &[
        CLUSTERS,
        default("population", "Individuals.", whole(2, 1000, ""), "10"),
        default(
            "generations",
            "Generations after the first population.",
            whole(0, 1000, ""),
            "10",
        ),
        default(
            "crossover_rate",
            "Probability that a child has two parents.",
            SHARE,
            "0.8",
        ),
        default(
            "mutation_rate",
            "Probability that a centre of a child becomes a random report.",
            SHARE,
            "0.15",
        ),
    ],
};

const SHARE: Kind = number(0.0, 1.0, "");

const CLUSTERS: Field = required(
    "clusters",
    "c, the number of clusters.",
    Kind::Union(&CLUSTER_COUNT),
);

static CLUSTER_COUNT: Union = Union {
    name: "ClusterCount",
    summary: "How the number of clusters is known.",
    tag: "by",
    variants: || vec![variant("count", &COUNT), variant("validity", &VALIDITY)],
};

static COUNT: Object = Object {
    name: "GivenClusterCount",
    summary: "It is given.",
    fields: &[required("count", "c.", NUMBER)],
};

static VALIDITY: Object = Object {
    name: "ValidClusterCount",
    summary: "Fuzzy c-means runs for each number of a range; the one with the best validity index stays.",
    fields: &[
        default(
            "index",
            "xie_beni: compact clusters far apart; partition_coefficient: memberships near 0 or 1.",
            Kind::Choice(&["xie_beni", "partition_coefficient"]),
            "\"xie_beni\"",
        ),
        default("min", "Smallest c.", NUMBER, "2"),
        required("max", "Largest c.", NUMBER),
    ],
};

const NUMBER: Kind = whole(2, 10_000, "");

#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
struct Parameters {
    initial: Initial,
    fuzzifier: f64,
    tolerance: f64,
    max_iterations: u32,
    one_per_sensor: bool,
    trace: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(tag = "from", rename_all = "snake_case")]
enum Initial {
    Predictions,
    Sensor {
        clusters: Clusters,
    },
    Random {
        clusters: Clusters,
    },
    Genetic {
        clusters: Clusters,
        population: u32,
        generations: u32,
        crossover_rate: f64,
        mutation_rate: f64,
    },
}

#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(tag = "by", rename_all = "snake_case")]
enum Clusters {
    Count {
        count: usize,
    },
    Validity {
        index: ValidityIndex,
        min: usize,
        max: usize,
    },
}

#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case")]
enum ValidityIndex {
    XieBeni,
    PartitionCoefficient,
}

fn build(parameters: &Value, seed: Seed) -> Result<Box<dyn Grouper>, serde_json::Error> {
    let parameters = Parameters::deserialize(parameters)?;
    let Parameters {
        fuzzifier,
        tolerance,
        max_iterations,
        ..
    } = parameters;
    let clustering = FuzzyCMeans::new(Settings {
        fuzzifier,
        tolerance,
        max_iterations,
    })
    .map_err(serde::de::Error::custom)?;
    let history = parameters.trace.then(History::default);
    Ok(Box::new(FuzzyGrouper {
        parameters,
        seed,
        clustering,
        hardener: BySource::default(),
        history,
    }))
}

/// One iteration at one instant; 0 is that of the first centres.
#[derive(Debug, Clone, PartialEq)]
pub struct Iteration {
    pub snapshot: u64,
    pub iteration: u32,
    pub cost: f64,
    /// v_i: x and y of each centre.
    pub centres: Vec<f64>,
    /// u_ik at `k * c + i`.
    pub memberships: Vec<f64>,
}

/// What was kept of the searches.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct History {
    pub iterations: Vec<Iteration>,
    /// Numbers in `iterations`.
    size: usize,
    /// Iterations that were not kept, for there was no room.
    pub left_out: u64,
}

impl History {
    /// Numbers that are kept.
    const MAX_SIZE: usize = 1_000_000;

    fn keep(&mut self, snapshot: u64, step: &Step) {
        let size = 1 + step.centres.len() + step.memberships.len();
        if self.size + size > Self::MAX_SIZE {
            self.left_out += 1;
            return;
        }
        self.size += size;
        let (centres, memberships) = (step.centres.to_vec(), step.memberships.to_vec());
        self.iterations.push(Iteration {
            snapshot,
            iteration: step.iteration,
            cost: step.cost,
            centres,
            memberships,
        });
    }
}

struct FuzzyGrouper {
    parameters: Parameters,
    seed: Seed,
    clustering: FuzzyCMeans,
    hardener: BySource,
    history: Option<History>,
}

impl Grouper for FuzzyGrouper {
    fn uses_predictions(&self) -> bool {
        self.parameters.initial == Initial::Predictions
    }

    fn group(&mut self, snapshot: &Snapshot) -> Result<Grouping, Vec<Fault>> {
        let values: Vec<f64> = snapshot
            .reports
            .iter()
            .flat_map(|report| coordinates(&report.place))
            .collect();
        let inverses = inverse_covariances(snapshot.reports);
        let objects = Objects::new(&values, &[false, false], Metric::Mahalanobis(&inverses))
            .map_err(fault)?;
        let (centres, spent) = self.first_centres(snapshot, &objects).map_err(fault)?;
        let run = match &mut self.history {
            None => self.clustering.run(&objects, &centres),
            Some(history) => self.clustering.run_observed(&objects, &centres, |step| {
                history.keep(snapshot.number, step)
            }),
        };
        let outcome = run.map_err(fault)?;
        Ok(self.harden(
            snapshot.reports,
            &Outcome {
                iterations: spent + outcome.iterations,
                ..outcome
            },
        ))
    }

    fn trace(&self) -> Option<&History> {
        self.history.as_ref()
    }
}

/// What a search takes to place its first centres: they, and the iterations it cost to find them.
type FirstCentres = Result<(Vec<f64>, u32), FuzzyError>;

impl FuzzyGrouper {
    fn first_centres(&mut self, snapshot: &Snapshot, objects: &Objects) -> FirstCentres {
        let clusters = match self.parameters.initial {
            Initial::Predictions => {
                return Ok((
                    snapshot.predictions.iter().flat_map(coordinates).collect(),
                    0,
                ));
            }
            Initial::Sensor { clusters }
            | Initial::Random { clusters }
            | Initial::Genetic { clusters, .. } => clusters,
        };
        match clusters {
            Clusters::Count { count } => self.centres_of_count(count, snapshot, objects),
            Clusters::Validity { index, min, max } => {
                self.centres_of_index(index, min..=max, snapshot, objects)
            }
        }
    }

    fn centres_of_count(
        &mut self,
        count: usize,
        snapshot: &Snapshot,
        objects: &Objects,
    ) -> FirstCentres {
        let mut centres = Vec::new();
        let mut spent = 0;
        // Each instant draws from a stream of its own, each number of clusters anew.
        let mut draw = self
            .seed
            .stream(Purpose::Clustering, count as u64, snapshot.number);
        match self.parameters.initial {
            // Nothing to do: these have no count.
            Initial::Predictions => {}
            Initial::Sensor { .. } => {
                let most = by_sensor(snapshot.reports).fold(0..0, |most, next| {
                    if next.len() > most.len() { next } else { most }
                });
                centres.extend(most.take(count).flat_map(|report| objects.object(report)));
                start::farthest_first(objects, count, &mut centres)?;
            }
            Initial::Random { .. } => start::random(objects, count, &mut draw, &mut centres)?,
            Initial::Genetic {
                population,
                generations,
                crossover_rate,
                mutation_rate,
                ..
            } => {
                let settings = GeneticSettings {
                    population,
                    generations,
                    crossover_rate,
                    mutation_rate,
                };
                let found =
                    genetic::search(&mut self.clustering, objects, count, settings, &mut draw)?;
                centres.extend_from_slice(self.clustering.centres());
                spent = u32::try_from(found.iterations).unwrap_or(u32::MAX);
            }
        }
        Ok((centres, spent))
    }

    fn centres_of_index(
        &mut self,
        index: ValidityIndex,
        range: std::ops::RangeInclusive<usize>,
        snapshot: &Snapshot,
        objects: &Objects,
    ) -> FirstCentres {
        let index = match index {
            ValidityIndex::XieBeni => validity::Index::XieBeni,
            ValidityIndex::PartitionCoefficient => validity::Index::PartitionCoefficient,
        };
        let mut spent = 0;
        let mut chosen = self.clustering.clone();
        let (_, tried) = validity::choose(&mut chosen, objects, range, index, |count, initial| {
            let (centres, of_search) = self.centres_of_count(count, snapshot, objects)?;
            initial.extend(centres);
            spent += of_search;
            Ok(())
        })?;
        spent += tried.iter().map(|tried| tried.iterations).sum::<u32>();
        Ok((chosen.centres().to_vec(), spent))
    }

    fn harden(&mut self, reports: &[Report], outcome: &Outcome) -> Grouping {
        let (memberships, clusters) = (self.clustering.memberships(), self.clustering.clusters());
        let mut labels = Vec::new();
        if self.parameters.one_per_sensor {
            let sensors: Vec<u32> = reports.iter().map(|report| report.sensor).collect();
            self.hardener.harden(
                clusters,
                &sensors,
                |report, cluster| -memberships[report * clusters + cluster],
                &mut labels,
            );
        } else {
            let mut largest = Vec::new();
            harden::largest(memberships, clusters, &mut largest);
            labels.extend(largest.into_iter().map(Some));
        }
        let membership = |(report, label): (usize, &Option<usize>)| {
            label.map(|cluster| memberships[report * clusters + cluster])
        };
        Grouping {
            memberships: labels.iter().enumerate().map(membership).collect(),
            group_of: with_groups_of_their_own(&labels, clusters),
            iterations: Some(outcome.iterations),
            cost: Some(outcome.cost),
            converged: outcome.converged,
        }
    }
}

fn coordinates(place: &Place) -> [f64; 2] {
    [place.position_m[0], place.position_m[1]]
}

/// A number of clusters stands in the parameters of the first centres; what else is at fault, beside them.
fn fault(error: FuzzyError) -> Vec<Fault> {
    vec![
        error.fault(if matches!(error, FuzzyError::Clusters { .. }) {
            "/initial"
        } else {
            ""
        }),
    ]
}

/// Four numbers for each report.
fn inverse_covariances(reports: &[Report]) -> Vec<f64> {
    let inverse = |report: &Report| {
        let gaussian = Gaussian::new(&report.place.covariance);
        gaussian.map_or([0.0; 4], |gaussian| {
            let inverse = gaussian.inverse();
            [
                inverse[(0, 0)],
                inverse[(0, 1)],
                inverse[(1, 0)],
                inverse[(1, 1)],
            ]
        })
    };
    reports.iter().flat_map(inverse).collect()
}
