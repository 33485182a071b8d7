//! The steps of [`super`] in a scan.

use super::{Births, Intensity, Newborn};
use crate::filtering::Filter;
use crate::hypotheses::{About, Look};
use crate::model::scan::Scan;
use crate::model::sensing::MeasurementModel;
use crate::model::watch::{Halt, Watch};
use crate::tracking::recorder::Recorder;
use crate::tracking::single_hypothesis::SingleHypothesis;
use crate::tracking::single_hypothesis::initiation::Point;
use crate::tracking::single_hypothesis::lifecycle::Glance;

impl<F: Filter<K>, const K: usize> SingleHypothesis<F, K> {
    /// Steps 1 and 2: what the undetected targets add to the clutter of each detection.
    pub(in crate::tracking::single_hypothesis) fn expect_undetected(
        &mut self,
        (scan, report): (&Scan, &MeasurementModel),
        dt_s: f64,
        watch: &Watch,
    ) -> Result<(), Halt> {
        let Some(rule) = &self.undetected else {
            return Ok(());
        };
        let intensity = &mut self.memory.intensity;
        intensity.advance(&self.filter, rule, (dt_s, self.memory.scans == 0));
        self.scratch.newborn.clear();
        self.scratch
            .newborn
            .resize(scan.detections.len(), Newborn::none());
        self.update_parts((scan, report), watch)?;
        self.add_everywhere(scan, report);
        let ratios = self.scratch.newborn.iter().map(|newborn| newborn.ratio);
        self.scratch.hypotheses.crowd(ratios);
        Ok(())
    }

    /// Step 2 of the parts.
    fn update_parts(
        &mut self,
        (scan, report): (&Scan, &MeasurementModel),
        watch: &Watch,
    ) -> Result<(), Halt> {
        let Intensity {
            weights, beliefs, ..
        } = &mut self.memory.intensity;
        if weights.is_empty() {
            return Ok(());
        }
        let members: Vec<u32> = (0..weights.len() as u32).collect();
        let look = Look {
            filter: &self.filter,
            sensor: &self.sensors[scan.sensor],
            report,
            scan,
            // They are predicted already.
            step: &self.filter.step(0.0),
        };
        let (hypotheses, newborn) = (&mut self.scratch.hypotheses, &mut self.scratch.newborn);
        hypotheses.write(look, 0, (beliefs, &members), &|_| About::of(None), watch)?;
        for row in 0..hypotheses.problem().rows().len() {
            let part = hypotheses.track(row);
            for edge in hypotheses.problem().rows()[row].edges() {
                let found = hypotheses.problem().edges()[edge];
                let mut belief = beliefs[part];
                hypotheses.take(row, edge, &mut belief);
                let ratio = weights[part] * found.log_likelihood.exp();
                newborn[found.detection as usize].add::<F>(ratio, belief);
            }
            weights[part] *= 1.0 - hypotheses.p_d(row);
            if watch.stops_after(64) {
                return Err(Halt::Stopped);
            }
        }
        for &part in hypotheses.lost() {
            weights[part as usize] = 0.0;
        }
        Ok(())
    }

    /// Step 2 of what is the same everywhere.
    fn add_everywhere(&mut self, scan: &Scan, report: &MeasurementModel) {
        let sensor = &self.sensors[scan.sensor];
        // A count says how often such a detection is a target, however much clutter there is; a density does not.
        let (ratio, is_counted) = match self.undetected.as_ref().map(|rule| &rule.births) {
            Some(Births::Counted) => (self.memory.counted.odds(), true),
            Some(Births::Uniform { .. }) => {
                let ratio = sensor.p_d * self.memory.intensity.density / sensor.clutter_density;
                self.memory.intensity.density *= 1.0 - sensor.p_d;
                (ratio, false)
            }
            _ => return,
        };
        for index in 0..scan.detections.len() {
            let Some(point) = self.point_of(scan, report, index) else {
                continue;
            };
            let belief = self.belief_of(&point, (scan, report));
            let there = if is_counted {
                ratio
            } else {
                ratio * (-self.scratch.hypotheses.log_clutter_ratio(index)).exp()
            };
            if there > 0.0 {
                self.scratch.newborn[index].add::<F>(there, belief);
            }
        }
    }

    /// Step 3, with what the tracks left of each detection.
    pub(in crate::tracking::single_hypothesis) fn begin_undetected(
        &mut self,
        scan: &Scan,
        recorder: &mut dyn Recorder,
    ) {
        let Some(rule) = &self.undetected else {
            return;
        };
        let least = rule.recycle_existence;
        for index in 0..scan.detections.len() {
            let newborn = self.scratch.newborn[index];
            if newborn.ratio == 0.0 {
                continue;
            }
            let existence = self.scratch.left[index] * newborn.ratio / (1.0 + newborn.ratio);
            let belief = newborn.belief(&self.filter);
            if existence < least {
                self.memory.intensity.push(existence, belief);
                continue;
            }
            let point = Point {
                scan_index: self.memory.scans,
                time_s: scan.time_s,
                sensor: scan.sensor,
                detection: index as u32,
                origin: scan.detections[index].origin,
                after_s: 0.0,
                state: F::kinematics(&belief),
            };
            let first = Glance {
                existence: Some(existence),
                ..Glance::first(scan.time_s, scan.sensor)
            };
            let track = self.start((&point, scan.time_s), &first, &belief, recorder);
            self.memory.push(track, belief);
        }
    }
}
