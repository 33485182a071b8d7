//! What a sensor sees of a scan: the clutter that is expected at its detections, and what is learnt of it.

use super::SingleHypothesis;
use crate::filtering::Filter;
use crate::model::scan::Scan;
use crate::model::sensing::MeasurementModel;
use crate::model::sensor::Sensor;
use crate::model::sight::Sight;
use crate::model::sight::clutter::{ClutterMap, ClutterPlan};

impl<F: Filter<K>, const K: usize> SingleHypothesis<F, K> {
    /// Takes the detections of a scan.
    pub(super) fn begin(&mut self, scan: &Scan, report: &MeasurementModel) {
        let sensor = &self.sensors[scan.sensor];
        let map = self.memory.maps[scan.sensor].as_ref();
        let hypotheses = &mut self.scratch.hypotheses;
        hypotheses.begin_scan(&self.filter, report, scan, |ratios| {
            if let Some(sight) = &sensor.sight {
                sight.clutter_ratios(scan, map, sensor.clutter_density, ratios);
            }
        });
    }

    /// What the tracks that chose first leave of each detection, where somebody wants to know.
    pub(super) fn count_left(&mut self, scan: &Scan) {
        let learns = self.memory.maps[scan.sensor].is_some();
        if !learns && self.lifecycle.existence_rule().is_none() {
            return;
        }
        let super::scratch::Scratch {
            hypotheses,
            weights,
            left,
            ..
        } = &mut self.scratch;
        left.clear();
        left.resize(scan.detections.len(), 1.0);
        for (edge, weight) in hypotheses.problem().edges().iter().zip(&weights.edges) {
            let left = &mut left[edge.detection as usize];
            *left = (*left - weight).max(0.0);
        }
    }

    /// Learns the clutter of a scan from what the confirmed tracks left over.
    pub(super) fn learn_clutter(&mut self, scan: &Scan) {
        let sensor = &self.sensors[scan.sensor];
        let (Some(sight), Some(map)) = (&sensor.sight, &mut self.memory.maps[scan.sensor]) else {
            return;
        };
        let Some(ClutterPlan::Map(plan)) = &sight.clutter else {
            return;
        };
        let (from_m, left) = (sight.place_in(scan), &self.scratch.left);
        map.learn(plan, (scan, &from_m), left, sensor.clutter_density);
    }
}

pub(super) fn new_map(sensor: &Sensor) -> Option<ClutterMap> {
    sensor.sight.as_ref().and_then(Sight::new_map)
}

/// Of sensors that are all the same, theirs.
pub(super) fn highest_p_d(sensors: &[Sensor]) -> f64 {
    sensors
        .iter()
        .map(|sensor| sensor.p_d)
        .fold(f64::MIN_POSITIVE, f64::max)
}
