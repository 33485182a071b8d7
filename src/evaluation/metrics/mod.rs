//! Metrics: one file each, one line of [`METRICS`] each. All read the same comparison and its log of events.
//!
//! A metric takes several sequences (recordings, runs) at once and combines their counts, never their ratios; one
//! sequence is a list of one.

pub mod assignment;
pub mod clear;
mod cutoff;
pub mod direction;
mod gospa;
pub mod hota;
pub mod identity;
mod kinematics;
pub mod origin;
mod ospa;
mod ospa2;
mod siap;
mod t_gospa;
mod track_keeping;

pub use cutoff::METRES;

use self::origin::{Origin, PairColumn};
use super::EvaluationInput;
use super::comparison::Comparison;
use super::events::EventLog;
use crate::model::space::Space;
use crate::model::watch::Watch;
use crate::registry::{Method, Union};
use cutoff::Cutoffs;
use serde::Serialize;
use serde_json::{Map, Value};

/// One recording or run, compared.
#[derive(Debug, Clone, Copy)]
pub struct Sequence<'a> {
    pub comparison: &'a Comparison,
    pub events: &'a EventLog,
    /// What was compared; absent for boxes. [`super::comparison::Presence::point`] refers to its tracks.
    pub input: Option<EvaluationInput<'a>>,
}

/// A number with its unit; `null` comes with a reason.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Quantity {
    pub name: &'static str,
    pub value: Option<f64>,
    pub unit: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<&'static str>,
}

impl Quantity {
    pub fn new(name: &'static str, value: f64, unit: &'static str) -> Quantity {
        Quantity::or(name, Some(value), unit, "not a finite number")
    }

    /// So many of something.
    pub fn count(name: &'static str, count: impl Into<f64>) -> Quantity {
        Quantity::new(name, count.into(), "")
    }

    /// A value that may be undefined, then for this reason.
    pub fn or(
        name: &'static str,
        value: Option<f64>,
        unit: &'static str,
        reason: &'static str,
    ) -> Quantity {
        let value = value.filter(|value| value.is_finite());
        Quantity {
            name,
            value,
            unit,
            reason: value.is_none().then_some(reason),
        }
    }

    /// A ratio of counts or sums; undefined over zero, then for this reason.
    pub fn ratio(
        name: &'static str,
        over: f64,
        under: f64,
        unit: &'static str,
        reason: &'static str,
    ) -> Quantity {
        Quantity::or(name, (under != 0.0).then(|| over / under), unit, reason)
    }
}

/// Values at the steps of the comparison (`null` where undefined), or at the points of another axis.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Series {
    pub name: &'static str,
    pub unit: &'static str,
    /// `time_s` for one value a step of the comparison, else what `at` holds (`alpha`).
    pub axis: &'static str,
    pub at: Vec<f64>,
    pub values: Vec<Option<f64>>,
}

impl Series {
    /// One value a step.
    pub fn over_time(
        name: &'static str,
        unit: &'static str,
        values: impl Iterator<Item = Option<f64>>,
    ) -> Series {
        let values = values
            .map(|value| value.filter(|value| value.is_finite()))
            .collect();
        Series {
            name,
            unit,
            axis: "time_s",
            at: Vec::new(),
            values,
        }
    }

    /// By these names: what is matched at each step, what of its truths is not, and what of its tracks.
    fn of_matched(names: [&'static str; 3], comparison: &Comparison, matched: &[f64]) -> Vec<Self> {
        let both = || comparison.steps.iter().zip(matched);
        let truths = both().map(|(step, matched)| Some(step.truths.len() as f64 - matched));
        let tracks = both().map(|(step, matched)| Some(step.tracks.len() as f64 - matched));
        vec![
            Series::over_time(names[0], "", matched.iter().copied().map(Some)),
            Series::over_time(names[1], "", truths),
            Series::over_time(names[2], "", tracks),
        ]
    }
}

/// The numbers of one truth or one track.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Line {
    pub id: String,
    pub quantities: Vec<Quantity>,
}

/// What a metric says.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MetricReport {
    /// The headline.
    pub value: Option<f64>,
    pub unit: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<&'static str>,
    /// Whether larger values are better.
    pub higher_is_better: bool,
    /// All parameters that it was computed with.
    pub parameters: Map<String, Value>,
    /// Everything it says in numbers, the headline too.
    pub quantities: Vec<Quantity>,
    /// Truths and tracks one by one: of a single sequence only.
    pub per_truth: Vec<Line>,
    pub per_track: Vec<Line>,
    /// Over time: of a single sequence only.
    pub series: Vec<Series>,
    /// What pairs contribute: of a single sequence only.
    #[serde(skip)]
    pub pairs: Vec<PairColumn>,
    /// How its numbers are made.
    #[serde(skip)]
    pub origins: Vec<Origin>,
    /// What a reader must know of the numbers.
    #[serde(skip)]
    pub warnings: Vec<String>,
    /// What it says besides numbers: of a single sequence only, and `null` where there is nothing.
    #[serde(skip_serializing_if = "Value::is_null")]
    pub findings: Value,
}

impl MetricReport {
    /// The report whose headline is the quantity of this name.
    pub fn new(
        headline: &str,
        higher_is_better: bool,
        parameters: Value,
        quantities: Vec<Quantity>,
    ) -> MetricReport {
        let (value, unit, reason) =
            match quantities.iter().find(|quantity| quantity.name == headline) {
                Some(quantity) => (quantity.value, quantity.unit, quantity.reason),
                None => (None, "", Some("not computed")),
            };
        let parameters = if let Value::Object(map) = parameters {
            map
        } else {
            Map::new()
        };
        let (per_truth, per_track, series, pairs) = Default::default();
        let (origins, warnings, findings) = Default::default();
        MetricReport {
            value,
            unit,
            reason,
            higher_is_better,
            parameters,
            quantities,
            per_truth,
            per_track,
            series,
            pairs,
            origins,
            warnings,
            findings,
        }
    }

    /// The value of a quantity, by name.
    pub fn quantity(&self, name: &str) -> Option<f64> {
        self.quantities
            .iter()
            .find(|quantity| quantity.name == name)
            .and_then(|quantity| quantity.value)
    }
}

/// Why a mean over steps is not defined.
const NOTHING_DUE: &str = "no target is due at any step";

pub trait Metric: Send {
    /// Whether it is defined in this space, or, where there is none, for boxes.
    fn accepts(&self, space: Option<Space>) -> bool {
        space.is_some()
    }

    /// Its own cutoffs, where it has some.
    fn cutoffs(&self) -> Option<Cutoffs> {
        None
    }

    /// The largest distance (m) at which a pair of points matters to it, given the gate.
    fn reach_m(&self, gate_m: f64) -> f64 {
        self.cutoffs().map_or(gate_m, |own| own.cutoff_m)
    }

    /// The same of directions (degrees).
    fn reach_deg(&self, gate_deg: f64) -> f64 {
        match self.cutoffs() {
            Some(own) => own.cutoff_deg,
            None => self.reach_m(gate_deg),
        }
    }

    fn evaluate(&self, sequences: &[Sequence]) -> MetricReport;

    /// The same, unless the watch says to stop; then the report says nothing. For metrics that may take long.
    fn evaluate_until(&self, sequences: &[Sequence], _watch: &Watch) -> MetricReport {
        self.evaluate(sequences)
    }
}

/// Builds a metric from its checked parameters.
pub type BuildMetric = fn(&Value) -> Result<Box<dyn Metric>, serde_json::Error>;

/// Every metric.
pub const METRICS: &[Method<BuildMetric>] = &[
    ospa::METHOD,
    ospa::LABELLED,
    ospa2::METHOD,
    gospa::METHOD,
    t_gospa::METHOD,
    siap::METHOD,
    clear::METHOD,
    identity::METHOD,
    hota::METHOD,
    assignment::METHOD,
    kinematics::METHOD,
    track_keeping::METHOD,
];

pub static METRIC: Union = Union {
    name: "Metric",
    summary: "A number by which tracks are judged.",
    tag: "metric",
    variants: || METRICS.iter().map(Method::variant).collect(),
};
