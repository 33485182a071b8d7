//! Nearest neighbour on predictions: each report goes to the prediction that is nearest to it, if that is within the gate;
//! one that is outside every gate is a group of its own.
//!
//! # Reference
//! Y. Bar-Shalom, X.-R. Li, Multitarget-Multisensor Tracking, 1995, section 3.2; the method that Cai Yubao et al.,
//! Application of fuzzy data association algorithm on multitarget tracking, compare with.
//!
//! # Symbols
//! ν difference of a report and a prediction, S sum of their covariances, d² = νᵀ S⁻¹ ν; γ the gate in σ.
//!
//! # Method
//! 1. d² of each report and each prediction; pairs with d² > γ² are not considered.
//! 2. Each report takes its nearest prediction; or, with one report of a sensor for a prediction, the closest pair of a
//!    sensor's reports goes first and the others choose among what is left.
//! 3. Each report without prediction founds a group.

use super::closest_pairs::{choose, gate};
use super::information::squared_distance;
use super::{BuildGrouper, Grouper, Grouping, Snapshot, by_sensor};
use crate::math::rng::Seed;
use crate::model::fault::Fault;
use crate::registry::{Kind, Method, Object, above, optional};
use serde::Deserialize;
use serde_json::Value;

pub const METHOD: Method<BuildGrouper> = Method {
    name: "nearest_neighbour",
    parameters: &PARAMETERS,
    build,
};

static PARAMETERS: Object = Object {
    name: "NearestNeighbourGrouper",
    summary: "Each report goes to the nearest prediction within the gate, or is a group of its own.",
    fields: &[
        optional(
            "gate_sigmas",
            "Largest distance of a report from its prediction, in σ; without a gate when absent.",
            SIGMAS,
        ),
        super::ONE_PER_SENSOR,
    ],
};

pub(super) const SIGMAS: Kind = above(0.0, 1000.0, "σ");

fn build(parameters: &Value, _: Seed) -> Result<Box<dyn Grouper>, serde_json::Error> {
    Ok(Box::new(NearestNeighbour::deserialize(parameters)?))
}

#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct NearestNeighbour {
    #[serde(default)]
    pub gate_sigmas: Option<f64>,
    pub one_per_sensor: bool,
}

impl Grouper for NearestNeighbour {
    fn uses_predictions(&self) -> bool {
        true
    }

    fn takes_attributes(&self) -> bool {
        true
    }

    fn group(&mut self, snapshot: &Snapshot) -> Result<Grouping, Vec<Fault>> {
        let Snapshot {
            reports,
            predictions,
            described,
            ..
        } = *snapshot;
        let distance = |report: usize, prediction: usize| match described {
            Some(described) => described.squared_distance(report, prediction),
            None => squared_distance(&reports[report].place, &predictions[prediction]),
        };
        let mut group_of = Vec::with_capacity(reports.len());
        let mut next = predictions.len();
        for range in by_sensor(reports) {
            for chosen in choose(
                range,
                predictions.len(),
                gate(self.gate_sigmas),
                self.one_per_sensor,
                distance,
            ) {
                group_of.push(chosen.unwrap_or(next));
                next += usize::from(chosen.is_none());
            }
        }
        Ok(Grouping::direct(group_of))
    }
}
