//! Correlation: which reports, or which tracks, of several sensors are of one target.
//!
//! [`grouping`] puts the reports of one instant together. The correlators put tracks together: a [`problem::CorrelationProblem`] says
//! what each tuple of tracks costs, a [`Correlator`] looks for the cheapest [`Solution`]. One file a correlator, one line of
//! [`CORRELATORS`].

use crate::math::rng::Seed;
use crate::model::fault::Fault;
use crate::model::watch::Watch;
use crate::registry::{Method, Union};
use problem::CorrelationProblem;

mod admissible;
pub mod alignment;
mod bound;
mod candidates;
mod chain;
mod cluster;
mod cover;
pub mod cross_covariance;
pub mod estimates;
pub mod evidence;
mod exact;
pub mod fusion;
mod fuzzy;
mod genetic;
pub mod grouping;
mod improve;
mod lagrangian;
pub mod modified;
mod nearest;
mod partition;
mod pricing;
pub mod problem;
pub mod statistic;
mod tuples;
mod weighted;

/// The tracks of all sensors in tuples, and what was found on the way.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Solution {
    /// Every track is in exactly one tuple, alone in its own if it must; members in ascending order, tuples by their first.
    pub tuples: Vec<Vec<u32>>,
    /// J: the sum of the costs of the tuples.
    pub cost: f64,
    /// No solution costs less, where the correlator knows so.
    pub dual_bound: Option<f64>,
    pub search: Option<SearchHistory>,
}

impl Solution {
    /// From tuples without a track in common; tracks in none of them are alone.
    fn from_tuples(problem: &CorrelationProblem, mut tuples: Vec<Vec<u32>>) -> Self {
        let mut is_in_one = vec![false; problem.tracks()];
        tuples
            .iter()
            .flatten()
            .for_each(|&track| is_in_one[track as usize] = true);
        tuples.extend(
            (0..problem.tracks() as u32)
                .filter(|&track| !is_in_one[track as usize])
                .map(|track| vec![track]),
        );
        tuples.sort_unstable();
        let cost_of = |tuple: &Vec<u32>| {
            problem
                .cost(tuple)
                .expect("correlators build only tuples that exist")
        };
        let cost = tuples.iter().map(cost_of).sum();
        Solution {
            tuples,
            cost,
            dual_bound: None,
            search: None,
        }
    }

    /// With a bound; rounding must not put it above what was found.
    fn with_bound(self, bound: Option<f64>) -> Self {
        Solution {
            dual_bound: bound.map(|bound| bound.min(self.cost)),
            ..self
        }
    }
}

/// How a correlator searched.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SearchHistory {
    /// The cost of the best and of the mean solution of each generation, the first included; of a relaxation, the cost of the
    /// answer and the bound of each round.
    pub best: Vec<f64>,
    pub mean: Vec<f64>,
    /// Solutions whose cost was computed.
    pub evaluations: u64,
    /// Why it ended: `evaluations`, `generations`, `unchanged`, `optimal`.
    pub stop: &'static str,
}

/// Looks for the cheapest way to put tracks together.
pub trait Correlator: Send {
    /// # Errors
    /// What of its parameters or of the size of the problem it cannot work with, with a pointer into the parameters.
    fn correlate(&mut self, problem: &CorrelationProblem) -> Result<Solution, Vec<Fault>>;

    /// The same, unless the watch says to stop; then the answer, or the refusal, is of no use. For those whose search may take long.
    ///
    /// # Errors
    /// As [`Correlator::correlate`].
    fn correlate_until(
        &mut self,
        problem: &CorrelationProblem,
        _watch: &Watch,
    ) -> Result<Solution, Vec<Fault>> {
        self.correlate(problem)
    }
}

/// Builds a correlator from its checked parameters and the seed of its random choices, if it makes any.
pub type BuildCorrelator =
    fn(&serde_json::Value, Seed) -> Result<Box<dyn Correlator>, serde_json::Error>;

/// Every correlator.
pub const CORRELATORS: &[Method<BuildCorrelator>] = &[
    nearest::METHOD,
    weighted::METHOD,
    modified::METHOD,
    fuzzy::METHOD,
    genetic::METHOD,
    lagrangian::METHOD,
    exact::METHOD,
];

pub static CORRELATOR: Union = Union {
    name: "Correlator",
    summary: "How tracks of several sensors are put together.",
    tag: "method",
    variants: || CORRELATORS.iter().map(Method::variant).collect(),
};
