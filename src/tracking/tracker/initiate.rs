//! Starting tracks with the detections that no track used.

use super::{ActiveTrack, Tracker, TrackerParts};
use crate::association::Needs;
use crate::filtering::Filter;
use crate::math::gaussian::gate_threshold;
use crate::model::scan::{Detection, Scan};
use crate::model::track::Candidate;
use crate::model::watch::{Halt, Watch};
use crate::tracking::initiation::{Initiation, Pair, PairRule, Point};
use crate::tracking::likelihood_constants::LikelihoodConstants;

impl<F: Filter<N, D>, const N: usize, const D: usize> Tracker<F, N, D> {
    /// Starts tracks with the detections that no track used, and counts these.
    pub(super) fn initiate(
        &mut self,
        scan: &Scan,
        detections: &[Detection],
        watch: &Watch,
    ) -> Result<u32, Halt> {
        if let Initiation::Truth { .. } = self.parts.lifecycle.initiation {
            return Ok(self.view.used.iter().filter(|is_used| !**is_used).count() as u32);
        }
        let mut unused = 0;
        for (index, detection) in detections.iter().enumerate() {
            if self.view.used[index] {
                continue;
            }
            let (measurement, sensor) = (
                &self.view.measurements[index],
                &self.parts.sensors[scan.sensor],
            );
            let sigma_mps = self.parts.lifecycle.initial_speed_sigma_mps;
            let Some(state) = self.parts.filter.initiate(measurement, sensor, sigma_mps) else {
                continue;
            };
            let named = (scan.first + index) as u32;
            let point = Point {
                scan: self.scans,
                time_s: scan.time_s,
                detection: named,
                origin: detection.origin,
                state,
            };
            unused += 1;
            if self.pair_rule.is_some() {
                self.initiator.push(point);
            } else {
                let track = self.start(&point);
                self.tracks.push(track);
            }
        }
        if let Some(rule) = &self.pair_rule {
            self.initiator.pair(scan, rule, watch)?;
            for index in 0..self.initiator.pairs().len() {
                self.start_with_two(scan, self.initiator.pairs()[index]);
            }
        }
        Ok(unused)
    }

    /// A new track, with its first point remembered.
    fn start(&mut self, point: &Point<N>) -> ActiveTrack<N> {
        let serial = self.history.started;
        self.history.started += 1;
        let track = ActiveTrack {
            serial,
            life: self.parts.lifecycle.start(),
            state: point.state,
            origin: point.origin,
        };
        self.remember_detection(&track, point, false);
        track
    }

    /// Starts the track of a pair, unless its score says at once that it is clutter.
    fn start_with_two(&mut self, scan: &Scan, pair: Pair<N>) {
        let (sensor, lifecycle) = (&self.parts.sensors[scan.sensor], self.parts.lifecycle);
        let log_ratio = (sensor.p_d / sensor.clutter_density).ln() - pair.log_reach_volume;
        let mut life = lifecycle.start();
        let log_missed = LikelihoodConstants::new(sensor, lifecycle.gate_probability).log_missed;
        (0..pair.missed).for_each(|_| lifecycle.advance(&mut life, false, log_missed));
        let was_confirmed = life.is_confirmed();
        lifecycle.advance(&mut life, true, log_ratio);
        if life.is_over() {
            return;
        }
        let track = ActiveTrack {
            life,
            state: pair.state,
            ..self.start(&pair.first)
        };
        self.remember_detection(&track, &pair.second, was_confirmed);
        self.tracks.push(track);
    }

    /// Remembers a track that a detection started, alone or as the second of two.
    fn remember_detection(
        &mut self,
        track: &ActiveTrack<N>,
        point: &Point<N>,
        was_confirmed: bool,
    ) {
        let first_candidate = self.history.candidates.len();
        self.history.candidates.push(Candidate {
            detection: Some(point.detection),
            probability: 1.0,
        });
        self.history
            .remember(track, point.scan, first_candidate, was_confirmed, None);
    }
}

/// What makes two points a pair, where tracks begin with two.
pub(super) fn pair_rule<F: Filter<N, D>, const N: usize, const D: usize>(
    parts: &TrackerParts<F>,
) -> Option<PairRule> {
    let Initiation::TwoPoint {
        max_speed_mps,
        max_wait_scans,
    } = parts.lifecycle.initiation
    else {
        return None;
    };
    Some(PairRule {
        max_speed_mps,
        max_wait_scans,
        gate_threshold: gate_threshold(parts.lifecycle.gate_probability, (N / 2) as u32),
        spectral_density: parts.filter.motion().spectral_density,
        by_origin: parts.associator.needs() == Needs::Origins,
    })
}
