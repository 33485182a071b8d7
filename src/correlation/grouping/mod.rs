//! Which reports of several sensors, made at one instant, are of one target. One file a grouper, one line of
//! [`GROUPERS`].
//!
//! Where the reports come from, and where the tracks come from that predict them, is not known here.

use crate::math::fuzzy_c_means::MAX_ATTRIBUTES;
use crate::math::rng::Seed;
use crate::model::fault::Fault;
use crate::model::state::{Position, PositionCovariance};
use crate::registry::{Bound, Field, Kind, Method, Union, above, default, whole};

pub mod attributes;
mod closest_pairs;
pub mod constrained_hard_c_means;
pub mod fuzzy_c_means;
mod information;
pub mod nearest_neighbour;
pub mod sequential_nearest_neighbour;
#[cfg(test)]
mod tests;

/// A place, and how well it is known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    pub position_m: Position,
    pub covariance: PositionCovariance,
}

/// What one sensor reported of one target.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SensorReport {
    pub place: Place,
    pub sensor: u32,
}

/// One instant: what all sensors reported, and where targets were expected.
#[derive(Debug, Clone, Copy)]
pub struct Snapshot<'a> {
    /// Its number, from 0; a grouper that draws lots draws others at each.
    pub number: u64,
    /// Those of one sensor stand together.
    pub reports: &'a [SensorReport],
    /// Empty for groupers that use none.
    pub predictions: &'a [Place],
    /// What is compared instead of places.
    pub described: Option<attributes::Described<'a>>,
}

/// The reports of one instant in groups.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Grouping {
    /// For each report its group. A grouper that uses predictions calls the group of prediction i by the number i; groups
    /// beyond them, and those of groupers without predictions, have numbers of their own. Some numbers may stay empty.
    pub group_of: Vec<usize>,
    /// For each report how much it belongs to its group, where the grouper says.
    pub memberships: Vec<Option<f64>>,
    /// Rounds of a search.
    pub iterations: Option<u32>,
    /// What the search made as small as it could.
    pub cost: Option<f64>,
    /// Whether the search came to rest by itself.
    pub converged: bool,
}

impl Grouping {
    /// Found without a search, and without memberships.
    fn direct(group_of: Vec<usize>) -> Self {
        Grouping {
            memberships: vec![None; group_of.len()],
            group_of,
            iterations: None,
            cost: None,
            converged: true,
        }
    }

    /// Groups with members.
    pub fn count(&self) -> usize {
        let mut numbers = self.group_of.clone();
        numbers.sort_unstable();
        numbers.dedup();
        numbers.len()
    }
}

/// Puts the reports of one instant into groups.
pub trait Grouper: Send {
    /// Whether it needs [`Snapshot::predictions`].
    fn uses_predictions(&self) -> bool;

    /// Whether it compares [`Snapshot::described`] where that is given.
    fn takes_attributes(&self) -> bool {
        false
    }

    /// Every report gets exactly one group.
    ///
    /// # Errors
    /// What of its parameters does not fit these reports, with a pointer into the parameters.
    fn group(&mut self, snapshot: &Snapshot) -> Result<Grouping, Vec<Fault>>;

    /// What it wrote down step by step, if it was asked to.
    fn trace(&self) -> Option<&fuzzy_c_means::History> {
        None
    }
}

/// Builds a grouper from its checked parameters and the seed of its random choices, if it makes any.
pub type BuildGrouper = fn(&serde_json::Value, Seed) -> Result<Box<dyn Grouper>, serde_json::Error>;

/// Every grouper.
pub const GROUPERS: &[Method<BuildGrouper>] = &[
    nearest_neighbour::METHOD,
    sequential_nearest_neighbour::METHOD,
    fuzzy_c_means::METHOD,
    constrained_hard_c_means::METHOD,
];

pub static GROUPER: Union = Union {
    name: "Grouper",
    summary: "How reports of one instant are put together.",
    tag: "method",
    variants: || GROUPERS.iter().map(Method::variant).collect(),
};

const ONE_PER_SENSOR: Field = default(
    "one_per_sensor",
    "Whether a group has at most one report of each sensor.",
    Kind::Flag,
    "false",
);

/// Of fuzzy c-means, as a grouper and as a correlator.
pub(super) const FUZZIFIER: Field = default(
    "fuzzifier",
    "q: the larger, the fuzzier.",
    above(1.0, 100.0, ""),
    "2.0",
);

/// The same.
pub(super) const TOLERANCE: Field = default(
    "tolerance",
    "The search is at rest when no membership changes by more.",
    Kind::Number {
        min: Bound::Excluding(0.0),
        max: Bound::Excluding(1.0),
        unit: "",
    },
    "1e-4",
);

const MAX_ITERATIONS: Field = default(
    "max_iterations",
    "Iterations after which the search ends, at rest or not.",
    whole(1, 10_000, ""),
    "100",
);

/// The reports of each sensor, by their places in the list.
fn by_sensor(reports: &[SensorReport]) -> impl Iterator<Item = std::ops::Range<usize>> {
    let mut first = 0;
    reports
        .chunk_by(|left, right| left.sensor == right.sensor)
        .map(move |chunk| {
            let range = first..first + chunk.len();
            first = range.end;
            range
        })
}
