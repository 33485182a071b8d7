//! Which beginnings become tracks, and what is told of their past: steps 3 and 4 of [`super`].

use super::choice::Past;
use super::ways::Rules;
use super::{Layer, MultiScan, OfSensor};
use crate::filtering::Filter;
use crate::model::track::Candidate;
use crate::model::watch::{Halt, Watch};
use crate::tracking::recorder::{RecordedPoint, Recorder};
use crate::tracking::single_hypothesis::existence::by_ratio;
use crate::tracking::single_hypothesis::lifecycle::{Glance, TrackLifecycleState};
use crate::tracking::single_hypothesis::{ActiveTrack, SingleHypothesis};

/// A point of a way and the scan it stands in.
type Step<'a, B, const K: usize> = (&'a Layer<K>, &'a Past<B>);

impl<F: Filter<K>, const K: usize> SingleHypothesis<F, K> {
    /// Step 3. With `is_last` all that is chosen begins.
    ///
    /// # Errors
    /// When there are too many candidates, or the watch says to stop.
    pub(super) fn decide(
        &mut self,
        rule: &MultiScan,
        waiting: &mut OfSensor<K>,
        (known_s, is_last): (f64, bool),
        recorder: &mut dyn Recorder,
        watch: &Watch,
    ) -> Result<(), Halt> {
        let has_due = self.scratch.ways.link(rule, waiting, is_last);
        let firsts = self.scratch.ways.firsts().to_vec();
        let mut used = vec![false; firsts.last().map_or(0, |last| *last as usize)];
        if has_due {
            let rules = Rules {
                rule,
                filter: &self.filter,
                sensor: &self.sensors[waiting.layers[0].scan.sensor],
                lifecycle: &self.lifecycle,
                highest_p_d: self.highest_p_d,
                max_speed_mps: self.max_speed_mps(rule),
            };
            let mut choice = std::mem::take(&mut self.scratch.choice);
            let ways = &mut self.scratch.ways;
            ways.choose(&rules, waiting, &mut choice, watch)?;
            waiting.counts.cut += choice.cut;
            waiting.counts.inexact += u64::from(!choice.is_exact);
            for (pasts, numbers) in choice.ways() {
                let is_due = is_last || numbers[0] < firsts[1];
                if is_due && self.begin_along(pasts, waiting, known_s, recorder) {
                    waiting.counts.begun += 1;
                    for &number in numbers {
                        used[number as usize] = true;
                    }
                }
            }
            self.scratch.choice = choice;
        }
        let oldest = waiting.layers[0].is_used.iter().zip(&used);
        let left = oldest.filter(|(was_used, is_used)| !**was_used && !**is_used);
        waiting.counts.left += left.count() as u64;
        forget(waiting, &firsts, &used);
        Ok(())
    }

    /// Step 4: a track that has lived through these scans. `false` where it would have ended on the way.
    fn begin_along(
        &mut self,
        pasts: &[Past<F::Belief>],
        waiting: &OfSensor<K>,
        known_s: f64,
        recorder: &mut dyn Recorder,
    ) -> bool {
        let layer_of = |at: &Past<F::Belief>| &waiting.layers[at.layer as usize];
        let steps: Vec<Step<F::Belief, K>> = pasts.iter().map(|at| (layer_of(at), at)).collect();
        let steps = &steps[..];
        let lives = self.lives(steps);
        let (Some(life), Some((_, last))) = (lives.last(), steps.last()) else {
            return false;
        };
        if lives.iter().any(TrackLifecycleState::is_over) {
            return false;
        }
        let track = ActiveTrack {
            serial: self.memory.next_serial(),
            life: *life,
            origin: last.origin,
        };
        let smoothed = self.smoothed(steps);
        for ((at, estimate), life) in steps.iter().zip(&smoothed).zip(&lives) {
            self.record_past(at, (track.serial, life), (estimate, known_s), recorder);
        }
        if life.is_confirmed() {
            self.memory.counted.targets += 1.0;
        }
        self.memory.push(track, last.belief);
        true
    }

    /// What the track had lived through at each scan.
    fn lives(&self, steps: &[Step<F::Belief, K>]) -> Vec<TrackLifecycleState> {
        let sensor = steps.first().map_or(0, |(layer, _)| layer.scan.sensor);
        let finds_targets = self.memory.finders & (1 << sensor.min(63)) != 0;
        let lifecycle = self.lifecycle.forbearing();
        let mut lives: Vec<TrackLifecycleState> = Vec::with_capacity(steps.len());
        for (layer, at) in steps {
            let life = match lives.last() {
                None => lifecycle.start(&Glance {
                    existence: Some(by_ratio(0.5, layer.log_odds)),
                    ..Glance::first(layer.scan.time_s, sensor)
                }),
                Some(before) => {
                    let mut life = *before;
                    let glance = Glance {
                        time_s: layer.scan.time_s,
                        sensor,
                        was_detected: at.detection.is_some(),
                        finds_targets,
                        share: at.share,
                        log_ratio: at.log_ratio,
                        existence: None,
                    };
                    lifecycle.advance(&mut life, &glance);
                    life
                }
            };
            lives.push(life);
        }
        lives
    }

    /// The estimates in the light of all detections.
    fn smoothed(&self, steps: &[Step<F::Belief, K>]) -> Vec<F::Belief> {
        let mut smoothed: Vec<F::Belief> = steps.iter().map(|(_, at)| at.belief).collect();
        for at in (1..steps.len()).rev() {
            let dt_s = steps[at].0.scan.time_s - steps[at - 1].0.scan.time_s;
            smoothed[at - 1] = F::smooth(&self.filter.step(dt_s), &smoothed[at - 1], &smoothed[at]);
        }
        smoothed
    }

    fn record_past(
        &mut self,
        (layer, at): &Step<F::Belief, K>,
        (serial, life): (u32, &TrackLifecycleState),
        (estimate, known_s): (&F::Belief, f64),
        recorder: &mut dyn Recorder,
    ) {
        let kept = self.lifecycle.smoothing.map(|_| &at.belief);
        self.scratch.pack(&F::kinematics(estimate), kept);
        recorder.point(&RecordedPoint {
            serial,
            scan_index: layer.scan_index,
            time_s: layer.scan.time_s,
            known_at_s: known_s,
            sensor: layer.scan.sensor,
            status: life.status(),
            existence: self.lifecycle.existence_of(life),
            kinematics: &self.scratch.kinematics,
            belief: &self.scratch.belief,
            nis: at.nis,
            modes: F::mode_probabilities(estimate),
            candidates: &[Candidate {
                detection: at
                    .detection
                    .map(|index| layer.points[index as usize].detection),
                probability: 1.0,
            }],
        });
    }
}

/// Drops the oldest layer with all ways from it, and those with a detection that is used.
fn forget<const K: usize>(waiting: &mut OfSensor<K>, firsts: &[u32], used: &[bool]) {
    for (index, layer) in waiting.layers.iter_mut().enumerate() {
        let used = &used[firsts[index] as usize..];
        for (is_used, becomes_used) in layer.is_used.iter_mut().zip(used) {
            *is_used |= becomes_used;
        }
    }
    for index in 0..waiting.layers.len() {
        let mut threes = std::mem::take(&mut waiting.layers[index].threes);
        threes.retain(|three| {
            let [first, second] = three.before.map(|before| index - before as usize);
            let layers = [first, second, index].into_iter();
            let mut detections = layers.zip(three.detections);
            first > 0 && !detections.any(|(layer, at)| waiting.layers[layer].is_used[at as usize])
        });
        waiting.layers[index].threes = threes;
    }
    waiting.spare.extend(waiting.layers.pop_front());
}
