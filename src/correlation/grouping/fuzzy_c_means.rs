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
//! 1. The first centres: the predictions, the reports of one sensor, reports drawn at random, those that fit memberships drawn
//!    at random (the paper's U⁽⁰⁾), or the best of a genetic search. Where c is not known, fuzzy c-means runs for each c of a range, and the one with the best validity index stays.
//! 2. Fuzzy c-means from there.
//! 3. Each report to the cluster of its largest membership; or, with one report of a sensor in a group, for each sensor the
//!    assignment of its reports to different clusters with the largest total membership. A report that gets none is a group
//!    of its own.

mod parameters;

use super::attributes::Attributes;
use super::constrained_hard_c_means::with_groups_of_their_own;
use super::{BuildGrouper, Grouper, Grouping, Place, SensorReport, Snapshot, by_sensor};
use crate::math::fuzzy_c_means::genetic::{self, GeneticSettings};
use crate::math::fuzzy_c_means::harden::{self, BySource};
use crate::math::fuzzy_c_means::{
    ClusteringResult, Fuzzifier, FuzzyCMeans, FuzzyCMeansSettings, FuzzyError, IterationState,
    Metric, Objects, start, validity,
};
use crate::math::gaussian::Gaussian;
use crate::math::rng::{Purpose, Seed};
use crate::model::fault::Fault;
use crate::registry::Method;
use parameters::{Clusters, Initial, PARAMETERS, Parameters, ValidityIndex};
use serde::Deserialize;
use serde_json::Value;

pub const METHOD: Method<BuildGrouper> = Method {
    name: "fuzzy_c_means",
    parameters: &PARAMETERS,
    build,
};

fn build(parameters: &Value, seed: Seed) -> Result<Box<dyn Grouper>, serde_json::Error> {
    let parameters = Parameters::deserialize(parameters)?;
    let Parameters {
        fuzzifier,
        tolerance,
        max_iterations,
        ..
    } = parameters;
    let clustering = FuzzyCMeans::new(FuzzyCMeansSettings {
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
    /// v_i: x and y of each centre, or its attributes.
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

    fn keep(&mut self, snapshot: u64, step: &IterationState) {
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

    fn takes_attributes(&self) -> bool {
        true
    }

    fn group(&mut self, snapshot: &Snapshot) -> Result<Grouping, Vec<Fault>> {
        let (values, inverses) = values_and_inverses(snapshot);
        let angles = snapshot
            .described
            .map_or(&[false, false][..], |described| described.angles);
        let objects =
            Objects::new(&values, angles, Metric::Mahalanobis(&inverses)).map_err(fault)?;
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
            &ClusteringResult {
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
            Initial::Predictions => return Ok((predicted_centres(snapshot), 0)),
            Initial::Sensor { clusters }
            | Initial::Random { clusters }
            | Initial::Memberships { clusters }
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
            Initial::Memberships { .. } => {
                let mut memberships = Vec::new();
                start::random_memberships(objects.len(), count, &mut draw, &mut memberships)?;
                let fuzzifier = Fuzzifier::new(self.parameters.fuzzifier)?;
                start::of_memberships(objects, fuzzifier, &memberships, &mut centres)?;
            }
            Initial::Genetic {
                population,
                generations,
                crossover_rate,
                mutation_rate,
                driven,
                ..
            } => {
                let settings = GeneticSettings {
                    population,
                    generations,
                    crossover_rate,
                    mutation_rate,
                    is_driven: driven,
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

    fn harden(&mut self, reports: &[SensorReport], outcome: &ClusteringResult) -> Grouping {
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

fn predicted_centres(snapshot: &Snapshot) -> Vec<f64> {
    match snapshot.described {
        Some(described) => values_of(described.predictions),
        None => snapshot.predictions.iter().flat_map(coordinates).collect(),
    }
}

fn values_of(attributes: &[Attributes]) -> Vec<f64> {
    attributes
        .iter()
        .flat_map(|of_one| of_one.values.iter().copied())
        .collect()
}

/// What is clustered: attributes where they are given, else places; and the inverse covariance of each report.
fn values_and_inverses(snapshot: &Snapshot) -> (Vec<f64>, Vec<f64>) {
    let Some(described) = snapshot.described else {
        let places = snapshot.reports.iter();
        let values = places.flat_map(|report| coordinates(&report.place));
        return (values.collect(), inverse_covariances(snapshot.reports));
    };
    let mut inverses = Vec::new();
    for report in described.reports {
        match report.covariance.clone().cholesky() {
            Some(factor) => inverses.extend_from_slice(factor.inverse().as_slice()),
            None => inverses.extend(std::iter::repeat_n(0.0, report.covariance.len())),
        }
    }
    (values_of(described.reports), inverses)
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
fn inverse_covariances(reports: &[SensorReport]) -> Vec<f64> {
    let inverse = |report: &SensorReport| {
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
