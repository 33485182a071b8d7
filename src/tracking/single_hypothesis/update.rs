//! What a scan does to a track whose detections are weighed.

use super::existence::{self, Posterior};
use super::lifecycle::Glance;
use super::scratch::Scratch;
use super::{SingleHypothesis, USED_WEIGHT, confirmation};
use crate::filtering::Filter;
use crate::model::scan::Scan;
use crate::model::track::Candidate;
use crate::tracking::recorder::{RecordedPoint, Recorder};

impl<F: Filter<K>, const K: usize> SingleHypothesis<F, K> {
    /// Updates the track of one row by its weights, and tells what was decided.
    pub(super) fn update(&mut self, row: usize, scan: &Scan, recorder: &mut dyn Recorder) {
        let posterior = self.posterior(row, scan);
        let scale = posterior.map_or(1.0, |posterior| posterior.scale);
        let (detected, missed, weighted_nis) = self.list_candidates(row, posterior);
        let Scratch {
            hypotheses,
            weights,
            weighted,
            ..
        } = &mut self.scratch;
        let log_ratio = if self.lifecycle.is_scored() {
            confirmation::log_ratio(hypotheses.problem(), weights, row)
        } else {
            0.0
        };
        let index = hypotheses.track(row);
        hypotheses.update(
            row,
            (&weights.edges, scale),
            weighted,
            &mut self.memory.beliefs[index],
        );
        let bit = 1 << scan.sensor.min(63);
        let finds_targets = self.memory.finders & bit != 0;
        let (track, belief) = self.memory.track_mut(index);
        let was_confirmed = track.life.is_confirmed();
        let glance = Glance {
            time_s: scan.time_s,
            sensor: scan.sensor,
            // The scan is a hit when it is more probable that the track was detected than that it was not.
            was_detected: detected > missed,
            finds_targets,
            share: hypotheses.p_d(row) / self.highest_p_d,
            log_ratio,
            existence: posterior.map(|posterior| posterior.existence),
        };
        self.lifecycle.advance(&mut track.life, &glance);
        self.lifecycle
            .limit(&mut track.life, || F::kinematics(belief).covariance);
        let (is_over, is_confirmed) = (track.life.is_over(), track.life.is_confirmed());
        if is_confirmed && !was_confirmed {
            self.memory.counted.targets += 1.0;
        }
        // One that ends does so before this scan: what nobody carries on is not a track any more, and uses nothing.
        if !is_over {
            self.mark_used();
            if was_confirmed && detected > 0.0 {
                self.memory.nis.add(weighted_nis, detected);
            }
            if was_confirmed && detected > missed {
                self.memory.finders |= bit;
            }
            let nis = (detected > 0.0).then(|| weighted_nis / detected);
            self.record(index, scan, nis, recorder);
        }
    }

    /// Lists what may have continued a row's track, if that exists. Tells the weight of all detections, of none, and the weighted
    /// sum of normalised innovations squared.
    fn list_candidates(&mut self, row: usize, posterior: Option<Posterior>) -> (f64, f64, f64) {
        let Scratch {
            hypotheses,
            weights,
            candidates,
            ..
        } = &mut self.scratch;
        let scale = posterior.map_or(1.0, |posterior| posterior.scale);
        candidates.clear();
        let (mut detected, mut weighted_nis) = (0.0, 0.0);
        for edge in hypotheses.problem().rows()[row].edges() {
            let weight = weights.edges[edge] * scale;
            if weight > 0.0 {
                detected += weight;
                weighted_nis += weight * hypotheses.fit(edge);
                candidates.push(Candidate {
                    detection: Some(hypotheses.problem().edges()[edge].detection),
                    probability: weight,
                });
            }
        }
        let missed = posterior.map_or(weights.missed[row], |posterior| posterior.missed);
        if missed > 0.0 {
            candidates.push(Candidate {
                detection: None,
                probability: missed,
            });
        }
        (detected, missed, weighted_nis)
    }

    /// What the scan leaves of the existence of a row's track, if it has one.
    fn posterior(&self, row: usize, scan: &Scan) -> Option<Posterior> {
        self.lifecycle.existence_rule()?;
        let hypotheses = &self.scratch.hypotheses;
        let life = &self.memory.tracks[hypotheses.track(row)].life;
        let finds_targets = self.memory.finders & (1 << scan.sensor.min(63)) != 0;
        let sees = self.lifecycle.sees(life, scan.sensor, finds_targets);
        let detectable = hypotheses.p_d(row) * self.lifecycle.gate_probability;
        Some(existence::after(
            (hypotheses.problem(), &self.scratch.weights, row),
            life.existence(),
            if sees { detectable } else { 0.0 },
            self.associator.is_soft(),
        ))
    }

    fn mark_used(&mut self) {
        let Scratch {
            hypotheses,
            candidates,
            ..
        } = &mut self.scratch;
        for candidate in candidates {
            if let Some(detection) = candidate.detection
                && candidate.probability >= USED_WEIGHT
            {
                hypotheses.mark_used(detection);
            }
        }
    }

    /// Tells the recorder of a track at this scan, with the candidates at hand.
    fn record(&mut self, index: usize, scan: &Scan, nis: Option<f64>, recorder: &mut dyn Recorder) {
        let (track, belief) = (&self.memory.tracks[index], &self.memory.beliefs[index]);
        if !self.lifecycle.tells(&track.life) {
            return;
        }
        let kept = self.lifecycle.smoothing.map(|_| belief);
        self.scratch.pack(&F::kinematics(belief), kept);
        recorder.point(&RecordedPoint {
            serial: track.serial,
            scan_index: self.memory.scans,
            time_s: scan.time_s,
            known_at_s: scan.time_s,
            sensor: scan.sensor,
            status: track.life.status(),
            existence: self.lifecycle.existence_of(&track.life),
            kinematics: &self.scratch.kinematics,
            belief: &self.scratch.belief,
            nis,
            modes: F::mode_probabilities(belief),
            candidates: &self.scratch.candidates,
        });
    }
}
