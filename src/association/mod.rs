//! Data association: which detection belongs to which track. One file an associator, one line of [`ASSOCIATORS`].

use crate::math::rng::Seed;
use crate::registry::{Method, Union};

pub mod bat;
pub mod fuzzy_c_means;
pub mod global_nearest_neighbour;
mod greedy;
pub mod jpda;
mod local_numbers;
pub mod nearest_neighbour;
pub mod oracle;
pub mod pda;
pub mod problem;
pub mod strongest_neighbour;
mod trace;

pub use trace::Trace;

use problem::{Problem, Weights};

/// What an associator needs to know of the detections besides their distances.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Needs {
    Nothing,
    /// The amplitude of each: [`problem::Problem::amplitude`] answers.
    Amplitudes,
    /// The places themselves, and what the tracks expect: [`problem::Problem::places`] answers.
    Places,
    /// The target that each came from. Then a track's only candidate, gate or not, is the detection of the target whose
    /// detection started it: the truth, for a yardstick.
    Origins,
    /// The same, beside the candidates of its gate: [`problem::Problem::own`] says which is the truth.
    OriginsInGates,
}

impl Needs {
    /// Whether detections are chosen by the target that they came from.
    pub fn is_by_origin(self) -> bool {
        matches!(self, Needs::Origins | Needs::OriginsInGates)
    }
}

/// Weighs the candidates of the tracks of one cluster.
pub trait Associator: Send {
    fn needs(&self) -> Needs {
        Needs::Nothing
    }

    /// Whether its weights may lie between 0 and 1.
    fn is_soft(&self) -> bool {
        false
    }

    /// Writes for every track of the problem weights over its candidates and "none" that sum to 1. Work that may take longer
    /// than some milliseconds asks [`Problem::stops_after`] on the way.
    fn associate(&mut self, problem: &Problem, weights: &mut Weights);

    /// What it wants to say of all it did so far, as JSON for the report.
    fn diagnostics(&self) -> Option<serde_json::Value> {
        None
    }

    /// What it wrote down step by step, for a file of the job.
    fn trace(&self) -> Option<&Trace> {
        None
    }

    /// The same associator once more.
    fn fork(&self) -> Box<dyn Associator>;

    /// What it remembers from scan to scan.
    fn memory(&self) -> serde_json::Value {
        serde_json::Value::Null
    }

    /// Takes back what [`Associator::memory`] told.
    ///
    /// # Errors
    /// A memory of another associator.
    fn recall(&mut self, _memory: &serde_json::Value) -> Result<(), serde_json::Error> {
        Ok(())
    }
}

/// Builds an associator from its checked parameters and the seed of its random choices, if it makes any.
pub type BuildAssociator =
    fn(&serde_json::Value, Seed) -> Result<Box<dyn Associator>, serde_json::Error>;

/// Every associator.
pub const ASSOCIATORS: &[Method<BuildAssociator>] = &[
    nearest_neighbour::METHOD,
    strongest_neighbour::METHOD,
    global_nearest_neighbour::METHOD,
    pda::METHOD,
    jpda::METHOD,
    fuzzy_c_means::METHOD,
    bat::METHOD,
    oracle::METHOD,
];

pub static ASSOCIATOR: Union = Union {
    name: "Associator",
    summary: "How detections are given to tracks.",
    tag: "method",
    variants: || ASSOCIATORS.iter().map(Method::variant).collect(),
};
