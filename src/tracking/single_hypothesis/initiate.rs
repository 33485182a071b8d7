//! Starting tracks with the detections that no track used.

use super::initiation::{Initiation, Pair, PairRule, Point};
use super::lifecycle::{Glance, Lifecycle, TrackLifecycleState};
use super::scratch::Scratch;
use super::{ActiveTrack, Memory, SingleHypothesis};
use crate::association::Needs;
use crate::filtering::Filter;
use crate::hypotheses::{Hypotheses, Likelihoods};
use crate::math::gaussian::gate_threshold;
use crate::model::own::Own;
use crate::model::scan::Scan;
use crate::model::sensing::MeasurementModel;
use crate::model::space::Space;
use crate::model::state::GaussianState;
use crate::model::track::Candidate;
use crate::model::watch::{Halt, Watch};
use crate::tracking::GivenTrack;
use crate::tracking::recorder::{RecordedPoint, Recorder};

impl<F: Filter<K>, const K: usize> SingleHypothesis<F, K> {
    /// A track that is there from the start and never ends.
    pub(super) fn add(&mut self, given: GivenTrack) {
        let kinematics = GaussianState::unpacked(&given.kinematics);
        debug_assert!(kinematics.is_some(), "given tracks fit the filter");
        let Some(kinematics) = kinematics else {
            return;
        };
        let track = ActiveTrack {
            serial: self.memory.next_serial(),
            life: TrackLifecycleState::permanent(),
            origin: given.origin,
        };
        self.memory.given.push(given.name);
        self.memory.push(track, self.filter.begin(&kinematics));
    }

    /// A track that somebody begins at the last scan.
    pub(super) fn begin_by_hand(
        &mut self,
        packed: &[f64],
        recorder: &mut dyn Recorder,
    ) -> Option<u32> {
        let kinematics = GaussianState::unpacked(packed)?;
        let belief = self.filter.begin(&kinematics);
        let time_s = self.memory.last_time_s.unwrap_or(0.0);
        let track = ActiveTrack {
            serial: self.memory.next_serial(),
            life: self.lifecycle.begin_by_hand(time_s),
            origin: None,
        };
        self.scratch.pack(&kinematics, None::<&F::Belief>);
        recorder.point(&RecordedPoint {
            serial: track.serial,
            scan_index: self.memory.scans.saturating_sub(1),
            time_s,
            known_at_s: time_s,
            sensor: 0,
            status: track.life.status(),
            existence: self.lifecycle.existence_of(&track.life),
            kinematics: &self.scratch.kinematics,
            belief: &self.scratch.belief,
            nis: None,
            modes: F::mode_probabilities(&belief),
            candidates: &[],
        });
        self.memory.push(track, belief);
        Some(track.serial)
    }

    /// Starts tracks with the detections that no track used, and counts these.
    pub(super) fn initiate(
        &mut self,
        scan: &Scan,
        report: &MeasurementModel,
        recorder: &mut dyn Recorder,
        watch: &Watch,
    ) -> Result<u32, Halt> {
        let unused = self.scratch.hypotheses.unused();
        self.count_clutter();
        let may_start = self.sensors[scan.sensor].may_start;
        if matches!(self.lifecycle.initiation, Initiation::Truth { .. }) || !may_start {
            return Ok(unused);
        }
        if let (MeasurementModel::Bearing(bearing), true) =
            (report, K == 4 && !report.starts_in(Space::Plane))
        {
            self.start_at_crossings(scan, bearing, recorder)?;
            return Ok(unused);
        }
        if self.undetected.is_some() {
            self.begin_undetected(scan, recorder);
            return Ok(unused);
        }
        if let Initiation::MultiScan(rule) = self.lifecycle.initiation {
            self.begin_over_scans(&rule, (scan, report), recorder, watch)?;
            return Ok(unused);
        }
        for index in 0..scan.detections.len() {
            let Some(point) = self.point_of(scan, report, index) else {
                continue;
            };
            match self.pair_rule {
                Some(_) if !report.starts_alone() => self.memory.initiator.push(point),
                _ => self.start_with_one(&point, (scan, report), recorder),
            }
        }
        if let Some(rule) = self.pair_rule {
            self.memory.initiator.pair(scan, &rule, watch)?;
            for index in 0..self.memory.initiator.pairs().len() {
                let pair = self.memory.initiator.pairs()[index];
                self.start_with_two(pair, scan, recorder);
            }
        }
        Ok(unused)
    }

    /// A detection that no track used and that tells where its target is.
    pub(super) fn point_of(
        &self,
        scan: &Scan,
        report: &MeasurementModel,
        index: usize,
    ) -> Option<Point<K>> {
        let sigma_mps = self.lifecycle.initial_speed_sigma_mps;
        let (hypotheses, own) = (&self.scratch.hypotheses, scan.own_of(index));
        Some(Point {
            scan_index: self.memory.scans,
            time_s: scan.time_s,
            sensor: scan.sensor,
            detection: index as u32,
            origin: scan.detections[index].origin,
            after_s: own.after_s,
            state: hypotheses.locate(&self.filter, report, sigma_mps, (index, &own))?,
        })
    }

    /// What is believed of a target of which a detection alone is known.
    pub(super) fn belief_of(
        &self,
        point: &Point<K>,
        (scan, report): (&Scan, &MeasurementModel),
    ) -> F::Belief {
        let detection = point.detection as usize;
        let own = scan.own_of(detection);
        let look = (&self.filter, &self.scratch.hypotheses, report);
        let sigma_mps = self.lifecycle.initial_speed_sigma_mps;
        root_belief(look, (point, detection, &own), sigma_mps)
    }

    pub(super) fn start_with_one(
        &mut self,
        point: &Point<K>,
        (scan, report): (&Scan, &MeasurementModel),
        recorder: &mut dyn Recorder,
    ) {
        let belief = self.belief_of(point, (scan, report));
        let first = self.first_glance(point.time_s, point.sensor);
        let track = self.start((point, point.time_s), &first, &belief, recorder);
        self.memory.push(track, belief);
    }

    /// A detection that is the first of a track, which is as probable as such tracks were so far; never so little that the track is
    /// over before its second scan, for then nothing would begin after clutter alone.
    fn first_glance(&self, time_s: f64, sensor: usize) -> Glance {
        let rule = self.lifecycle.existence_rule();
        let least = rule.map_or(0.0, |rule| 2.0 * rule.delete_existence);
        Glance {
            existence: Some(self.memory.counted.existence().max(least)),
            ..Glance::first(time_s, sensor)
        }
    }

    /// Counts what is left of the detections as clutter, as far as it probably is.
    fn count_clutter(&mut self) {
        if self.lifecycle.existence_rule().is_none() {
            return;
        }
        let Memory { counted, .. } = &mut self.memory;
        let Scratch { left, newborn, .. } = &self.scratch;
        let target = counted.existence();
        for (index, left) in left.iter().enumerate() {
            let clutter = match newborn.get(index) {
                Some(newborn) => newborn.clutter(),
                None => 1.0 - target,
            };
            counted.clutter += left * clutter;
        }
    }

    /// A new track, with its first point told.
    pub(super) fn start(
        &mut self,
        (point, known_at_s): (&Point<K>, f64),
        first: &Glance,
        belief: &F::Belief,
        recorder: &mut dyn Recorder,
    ) -> ActiveTrack {
        let track = ActiveTrack {
            serial: self.memory.next_serial(),
            life: self.lifecycle.start(first),
            origin: point.origin,
        };
        self.record_start((&track, known_at_s), point, belief, recorder);
        track
    }

    /// Starts the track of a pair, unless its score says at once that it is clutter.
    fn start_with_two(&mut self, mut pair: Pair<K>, scan: &Scan, recorder: &mut dyn Recorder) {
        let (sensor, lifecycle) = (&self.sensors[pair.second.sensor], self.lifecycle);
        let likelihoods = Likelihoods::new(sensor, scan, lifecycle.gate_probability);
        let constants = likelihoods.of(1.0, || pair.second.state);
        let hypotheses = &self.scratch.hypotheses;
        let more_clutter = hypotheses.log_clutter_ratio(pair.second.detection as usize);
        let second = Glance {
            share: constants.p_d / self.highest_p_d,
            log_ratio: constants.log_density - more_clutter - pair.log_reach_volume,
            ..Glance::first(pair.second.time_s, pair.second.sensor)
        };
        let between = Glance {
            time_s: pair.first.time_s,
            was_detected: false,
            log_ratio: constants.log_missed,
            ..second
        };
        let beginning = self.first_glance(pair.first.time_s, pair.first.sensor);
        let mut life = lifecycle.start(&beginning);
        for _ in 0..pair.missed {
            lifecycle.advance(&mut life, &between);
        }
        lifecycle.advance(&mut life, &second);
        if life.is_over() {
            return;
        }
        let wandered = self
            .filter
            .rate_variance(pair.second.at_s() - pair.first.at_s());
        for rate in K / 2..K {
            pair.state.covariance[(rate, rate)] += wandered;
        }
        let first = self.filter.begin(&pair.first.in_scan());
        let track = ActiveTrack {
            life,
            ..self.start((&pair.first, scan.time_s), &beginning, &first, recorder)
        };
        let second = Point {
            state: pair.state,
            ..pair.second
        };
        let belief = self.filter.begin(&second.in_scan());
        self.record_start((&track, scan.time_s), &second, &belief, recorder);
        self.memory.push(track, belief);
    }

    /// Tells the recorder of a track that a detection started, alone or as the second of two.
    fn record_start(
        &mut self,
        (track, known_at_s): (&ActiveTrack, f64),
        point: &Point<K>,
        belief: &F::Belief,
        recorder: &mut dyn Recorder,
    ) {
        if !self.lifecycle.tells(&track.life) {
            return;
        }
        let kept = self.lifecycle.smoothing.map(|_| belief);
        self.scratch.pack(&point.in_scan(), kept);
        recorder.point(&RecordedPoint {
            serial: track.serial,
            scan_index: point.scan_index,
            time_s: point.time_s,
            known_at_s,
            sensor: point.sensor,
            status: track.life.status(),
            existence: self.lifecycle.existence_of(&track.life),
            kinematics: &self.scratch.kinematics,
            belief: &self.scratch.belief,
            nis: None,
            modes: F::mode_probabilities(belief),
            candidates: &[Candidate {
                detection: Some(point.detection),
                probability: 1.0,
            }],
        });
    }
}

/// What is believed of a target of which a detection alone is known: a point, its place among those of the hypotheses and what it has of
/// its own.
pub(super) fn root_belief<F: Filter<K>, const K: usize>(
    (filter, hypotheses, report): (&F, &Hypotheses<F, K>, &MeasurementModel),
    (point, detection, own): (&Point<K>, usize, &Own),
    speed_sigma_mps: f64,
) -> F::Belief {
    let mut parts = hypotheses.parts(filter, report, speed_sigma_mps, (detection, own));
    for part in &mut parts {
        *part = part.coasted::<K>(-own.after_s);
    }
    filter.begin_among(&point.in_scan(), &parts)
}

/// What makes two points a pair, where tracks begin with two. Kinematics have so many variables.
pub(super) fn pair_rule(lifecycle: &Lifecycle, needs: Needs, variables: usize) -> Option<PairRule> {
    let Initiation::TwoPoint {
        max_speed_mps,
        max_wait_scans,
    } = lifecycle.initiation
    else {
        return None;
    };
    Some(PairRule {
        max_speed_mps,
        max_wait_scans,
        gate_threshold: gate_threshold(lifecycle.gate_probability, (variables / 2) as u32),
        by_origin: needs.is_by_origin(),
    })
}
