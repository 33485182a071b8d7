//! Fuzzy c-means as an associator: tracks are clusters, the detections in their gates are objects. The centres begin where the
//! tracks expect their detections and move by fuzzy c-means; the memberships at the end say whose each detection is.
//!
//! # Reference
//! Cai Yubao et al., Application of fuzzy data association algorithm on multitarget tracking; the clustering is that of
//! [`crate::math::fuzzy_c_means`], the noise cluster that of R. N. Davé, Characterization and detection of noise in
//! clustering, Pattern Recognition Letters 12, 1991, 657–664. The paper knows the number of targets and has neither clutter
//! nor misses; the noise cluster and the weights of step 4 are ours.
//!
//! # Symbols
//! z_k detection, ẑ_i and S_i what track i expects; v_i centre; d_ik² = (z_k − v_i)ᵀ S_i⁻¹ (z_k − v_i); u_ik membership, u_0k
//! that of noise; q fuzzifier; δ_i², δ_k² squared distance of noise; P_D, P_G, λ as elsewhere; βᵢₖ weight, βᵢ₀ of none.
//!
//! # Method
//! A pair outside the gate is no pair: its membership is 0, and it is in no sum.
//! 1. δ_i² = 2 ln(P_D N(0; 0, Sᵢ) / (λ (1 − P_D P_G))): where a detection at that distance is as probable as a miss and
//!    clutter; at least 1. δ_k² is the mean over the tracks whose gate has k.
//! 2. v_i = ẑ_i. From the second iteration on v_i = Σ_k u_ik^q z_k / Σ_k u_ik^q: where the tracks expected their detections
//!    then counts no more. An angle is averaged about the present centre.
//! 3. u_ik = d_ik^(−2/(q−1)) / (Σ_j d_jk^(−2/(q−1)) + δ_k^(−2/(q−1))), until no membership changes by more than the
//!    tolerance. J = Σ_k (Σ_i u_ik^q d_ik² + u_0k^q δ_k²) does not rise. One track alone is not clustered: its centre stays.
//! 4. `hard`: the assignment of detections to tracks with the largest total membership; where memberships tell nothing,
//!    the smaller distance from ẑ decides. A track that is left over has none.
//!    `weighted`: u_ik is taken for the probability that k is of track i, independent over k but for "one at most":
//!    βᵢₖ = oᵢₖ / (1 + Σ_l oᵢₗ), βᵢ₀ = 1 / (1 + Σ_l oᵢₗ) with the odds oᵢₖ = u_ik / (1 − u_ik). Then βᵢₖ ≤ u_ik, so no
//!    detection counts more than once over all tracks. For a track alone this is β ∝ d^(−2/(q−1)), none at the distance δ.

mod clustering;
#[cfg(test)]
mod tests;

use super::problem::{Problem, Weights};
use super::{Associator, BuildAssociator, Needs, Trace};
use crate::math::assignment::AssignmentSolver;
use crate::math::fuzzy_c_means::{Fuzzifier, FuzzyError};
use crate::registry::{Bound, Kind, Method, Object, above, default, whole};
use clustering::Clustering;
use serde::{Deserialize, Serialize};
use serde_json::json;
use std::fmt;

pub const METHOD: Method<BuildAssociator> = Method {
    name: "fuzzy_c_means",
    parameters: &PARAMETERS,
    build: |spec, _| {
        let means = FuzzyCMeans::new(FuzzyAssociatorSettings::deserialize(spec)?);
        Ok(Box::new(means.map_err(serde::de::Error::custom)?))
    },
};

static PARAMETERS: Object = Object {
    name: "FuzzyCMeans",
    summary: "Fuzzy c-means: tracks are clusters, and each detection is of the track to which it belongs most.",
    fields: &[
        default(
            "weights",
            "hard: each track takes one detection at most, by the largest total membership; weighted: each track averages over \
                      its detections by their memberships.",
            Kind::Choice(&["hard", "weighted"]),
            "\"hard\"",
        ),
        default(
            "fuzzifier",
            "q: the larger, the fuzzier.",
            above(1.0, 100.0, ""),
            "2.0",
        ),
        default(
            "tolerance",
            "The clustering is at rest when no membership changes by more.",
            Kind::Number {
                min: Bound::Excluding(0.0),
                max: Bound::Excluding(1.0),
                unit: "",
            },
            "1e-4",
        ),
        default(
            "max_iterations",
            "Iterations after which a cluster ends, at rest or not; those that are not are counted.",
            whole(1, 10_000, ""),
            "100",
        ),
        default(
            "trace",
            "Whether to write down J, memberships and centres of every iteration (association_trace.csv).",
            Kind::Flag,
            "false",
        ),
    ],
};

#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Answer {
    Hard,
    Weighted,
}

/// The parameters of [`PARAMETERS`].
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
struct FuzzyAssociatorSettings {
    weights: Answer,
    fuzzifier: f64,
    tolerance: f64,
    max_iterations: u32,
    trace: bool,
}

const TRACE_HEADER: &str = "occasion,cluster,iteration,quantity,track,detection,value";

/// What a unit of d² weighs beside memberships, so that it decides between equal ones alone.
const TIE_BREAK: f64 = 1e-8;

#[derive(Debug, Clone)]
struct FuzzyCMeans {
    settings: FuzzyAssociatorSettings,
    fuzzifier: Fuzzifier,
    clustering: Clustering,
    solver: AssignmentSolver,
    diagnostics: Diagnostics,
    trace: Option<Trace>,
}

/// The part `association.diagnostics` of a report.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
struct Diagnostics {
    /// Tracks alone, which need no clustering.
    lone_tracks: u64,
    /// Clusters of two tracks or more.
    clusters: u64,
    iterations: Iterations,
    /// Clusters that were not at rest within the tolerance at last.
    not_converged: u64,
}

#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
struct Iterations {
    /// Of a cluster of two tracks or more; none before the first.
    mean: Option<f64>,
    max: u32,
    #[serde(skip)]
    sum: u64,
}

impl Associator for FuzzyCMeans {
    fn needs(&self) -> Needs {
        Needs::Places
    }

    fn is_soft(&self) -> bool {
        self.settings.weights == Answer::Weighted
    }

    fn associate(&mut self, problem: &Problem, weights: &mut Weights) {
        let is_alone = problem.row_count() == 1;
        if is_alone {
            self.diagnostics.lone_tracks += 1;
            if self.settings.weights == Answer::Hard && self.trace.is_none() {
                choose_nearest(problem, weights);
                return;
            }
        }
        self.clustering.load(problem);
        self.cluster(problem, is_alone);
        match self.settings.weights {
            Answer::Hard => self.assign(problem, weights),
            Answer::Weighted => self.clustering.weigh(weights),
        }
    }

    fn diagnostics(&self) -> Option<serde_json::Value> {
        serde_json::to_value(&self.diagnostics).ok()
    }

    fn trace(&self) -> Option<&Trace> {
        self.trace.as_ref()
    }

    fn fork(&self) -> Box<dyn Associator> {
        Box::new(self.clone())
    }

    fn memory(&self) -> serde_json::Value {
        json!((
            &self.diagnostics,
            self.diagnostics.iterations.sum,
            &self.trace
        ))
    }

    fn recall(&mut self, memory: &serde_json::Value) -> Result<(), serde_json::Error> {
        (
            self.diagnostics,
            self.diagnostics.iterations.sum,
            self.trace,
        ) = Deserialize::deserialize(memory)?;
        Ok(())
    }
}

/// A track alone: its largest membership is that of its nearest detection.
fn choose_nearest(problem: &Problem, weights: &mut Weights) {
    for (row, state) in problem.rows() {
        let squared = |&edge: &usize| problem.edge(edge).squared_distance;
        if let Some(nearest) = state
            .edges()
            .min_by(|left, right| squared(left).total_cmp(&squared(right)))
        {
            weights.choose(row, nearest);
        }
    }
}

impl FuzzyCMeans {
    fn new(settings: FuzzyAssociatorSettings) -> Result<Self, FuzzyError> {
        Ok(FuzzyCMeans {
            settings,
            fuzzifier: Fuzzifier::new(settings.fuzzifier)?,
            clustering: Clustering::default(),
            solver: AssignmentSolver::default(),
            diagnostics: Diagnostics::default(),
            trace: settings.trace.then(|| Trace::new(TRACE_HEADER)),
        })
    }

    /// Steps 2 and 3.
    fn cluster(&mut self, problem: &Problem, is_alone: bool) {
        let mut cost = self.clustering.share(problem.places(), self.fuzzifier);
        self.write(problem, 0, cost);
        if is_alone {
            return;
        }
        let (mut iterations, mut change) = (0, f64::INFINITY);
        let pieces = 8 * problem
            .rows()
            .map(|(_, row)| u64::from(row.count))
            .sum::<u64>();
        while change > self.settings.tolerance
            && iterations < self.settings.max_iterations
            && !problem.stops_after(pieces)
        {
            self.clustering
                .move_centres(problem.places(), self.fuzzifier);
            cost = self.clustering.share(problem.places(), self.fuzzifier);
            change = self.clustering.largest_change();
            iterations += 1;
            self.write(problem, iterations, cost);
        }
        self.diagnostics
            .count_clustering(iterations, change <= self.settings.tolerance);
    }

    fn write(&mut self, problem: &Problem, iteration: u32, cost: f64) {
        let Some(trace) = &mut self.trace else { return };
        let cluster = problem.rows().next().map_or(0, |(row, _)| row);
        let problem_index = problem.problem_index();
        self.clustering
            .describe(cost, |quantity, track, detection, value| {
                let (track, detection) = (Cell(track), Cell(detection));
                trace.push(format_args!(
                    "{problem_index},{cluster},{iteration},{quantity},{track},{detection},{value}"
                ));
            });
    }

    /// Step 4, hard.
    fn assign(&mut self, problem: &Problem, weights: &mut Weights) {
        self.clustering.spread_over_edges(weights);
        self.solver.clear();
        for (_, row) in problem.rows() {
            for index in row.edges() {
                let edge = problem.edge(index);
                self.solver.push_edge(
                    edge.detection,
                    TIE_BREAK * edge.squared_distance - weights.edges[index],
                );
            }
            self.solver.end_row(0.0);
        }
        let is_solved = self.solver.solve().is_some();
        debug_assert!(
            is_solved,
            "a cluster in which every track may miss has an assignment"
        );
        for (index, (row, state)) in problem.rows().enumerate() {
            weights.edges[state.edges()].fill(0.0);
            if let Some(edge) = self.solver.edge_of(index) {
                weights.choose(row, state.first as usize + edge);
            }
        }
    }
}

/// A number of a table, or an empty cell.
struct Cell(Option<u32>);

impl fmt::Display for Cell {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        self.0.map_or(Ok(()), |number| number.fmt(formatter))
    }
}

impl Diagnostics {
    fn count_clustering(&mut self, iterations: u32, converged: bool) {
        self.clusters += 1;
        self.not_converged += u64::from(!converged);
        self.iterations.sum += u64::from(iterations);
        self.iterations.max = self.iterations.max.max(iterations);
        self.iterations.mean = Some(self.iterations.sum as f64 / self.clusters as f64);
    }
}
