//! Sequential nearest neighbour: sensor by sensor, without tracks. The first sensor's reports found the groups; each report
//! of a later sensor joins the nearest group within the gate, or founds one.
//!
//! # Reference
//! Y. Bar-Shalom, X.-R. Li, Multitarget-Multisensor Tracking, 1995, section 8.3: association of the reports of sensors one
//! after another.
//!
//! # Symbols
//! ν difference of a report and a group's centre, S sum of their covariances, d² = νᵀ S⁻¹ ν; γ the gate in σ.
//!
//! # Method
//! For each sensor in turn:
//! 1. d² of its reports and the groups that the sensors before it have made; pairs with d² > γ² are not considered.
//! 2. Each report takes its nearest group; or, with one report of a sensor in a group, the closest pair goes first and the
//!    others choose among what is left.
//! 3. The centres move to the information-weighted means of their reports; reports without group found new ones.

use super::closest_pairs::{choose, gate};
use super::information::{Information, squared_distance};
use super::nearest_neighbour::SIGMAS;
use super::{BuildGrouper, Grouper, Grouping, Place, SensorReport, Snapshot, by_sensor};
use crate::math::rng::Seed;
use crate::model::fault::Fault;
use crate::registry::{Method, Object, default};
use serde::Deserialize;
use serde_json::Value;

pub const METHOD: Method<BuildGrouper> = Method {
    name: "sequential_nearest_neighbour",
    parameters: &PARAMETERS,
    build,
};

static PARAMETERS: Object = Object {
    name: "SequentialNearestNeighbourGrouper",
    summary: "Sensor by sensor, without tracks: each report joins the nearest group of the sensors before, or founds one.",
    fields: &[
        default(
            "gate_sigmas",
            "Largest distance of a report from a group, in σ.",
            SIGMAS,
            "4.0",
        ),
        super::ONE_PER_SENSOR,
    ],
};

fn build(parameters: &Value, _: Seed) -> Result<Box<dyn Grouper>, serde_json::Error> {
    Ok(Box::new(SequentialNearestNeighbour::deserialize(
        parameters,
    )?))
}

#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct SequentialNearestNeighbour {
    pub gate_sigmas: f64,
    pub one_per_sensor: bool,
}

impl SequentialNearestNeighbour {
    /// For each report its group; those of one sensor stand together.
    pub fn groups(&self, reports: &[SensorReport]) -> Vec<usize> {
        let mut groups: Vec<Information> = Vec::new();
        let mut group_of = Vec::with_capacity(reports.len());
        for range in by_sensor(reports) {
            let centres: Vec<Option<Place>> = groups.iter().map(Information::mean).collect();
            let distance = |report: usize, group: usize| {
                centres[group].map_or(f64::INFINITY, |centre| {
                    squared_distance(&reports[report].place, &centre)
                })
            };
            let chosen = choose(
                range.clone(),
                centres.len(),
                gate(Some(self.gate_sigmas)),
                self.one_per_sensor,
                distance,
            );
            for (report, chosen) in range.zip(chosen) {
                let place = &reports[report].place;
                match chosen {
                    Some(group) => groups[group].add(place),
                    None => groups.push(Information::from_place(place)),
                }
                group_of.push(chosen.unwrap_or(groups.len() - 1));
            }
        }
        group_of
    }
}

impl Grouper for SequentialNearestNeighbour {
    fn uses_predictions(&self) -> bool {
        false
    }

    fn group(&mut self, snapshot: &Snapshot) -> Result<Grouping, Vec<Fault>> {
        Ok(Grouping::direct(self.groups(snapshot.reports)))
    }
}
