//! Which beginnings become tracks, and what is told of their past: steps 3 and 4 of [`super`].

use super::{Layer, MAX_STEPS, MultiScan, Node, OfSensor};
use crate::filtering::Filter;
use crate::math::set_packing;
use crate::model::track::Candidate;
use crate::tracking::recorder::{RecordedPoint, Recorder};
use crate::tracking::single_hypothesis::existence::by_ratio;
use crate::tracking::single_hypothesis::lifecycle::{Glance, TrackLifecycleState};
use crate::tracking::single_hypothesis::{ActiveTrack, SingleHypothesis};

/// Its nodes from the root on: the index of each in its layer, and of the layer.
type Path = Vec<(usize, usize)>;

/// A node of a way and the scan it stands in.
type Step<'a, B, const K: usize> = (&'a Layer<B, K>, &'a Node<B>);

impl<F: Filter<K>, const K: usize> SingleHypothesis<F, K> {
    /// Decides the rest, for no scan follows.
    pub(in crate::tracking::single_hypothesis) fn decide_rest(
        &mut self,
        rule: &MultiScan,
        recorder: &mut dyn Recorder,
    ) {
        let known_s = self.memory.last_time_s.unwrap_or(0.0);
        for sensor in 0..self.sensors.len() {
            let mut waiting = std::mem::take(self.memory.beginnings.of(sensor));
            if !waiting.layers.is_empty() {
                self.decide(rule, sensor, &mut waiting, (known_s, true), recorder);
            }
            *self.memory.beginnings.of(sensor) = waiting;
        }
    }

    /// Step 3. With `is_last` all that is chosen begins.
    pub(super) fn decide(
        &mut self,
        rule: &MultiScan,
        sensor: usize,
        waiting: &mut OfSensor<F::Belief, K>,
        (known_s, is_last): (f64, bool),
        recorder: &mut dyn Recorder,
    ) {
        let oldest = waiting.layers[0].number;
        let ways = candidates(rule, waiting);
        let firsts = first_elements(waiting);
        let elements = |(path, _): &(Path, f64)| elements(waiting, &firsts, path);
        let sets: Vec<Vec<u32>> = ways.iter().map(elements).collect();
        let scores: Vec<f64> = ways.iter().map(|(_, score)| *score).collect();
        let packing = set_packing::pack(&sets, &scores, MAX_STEPS);
        waiting.counts.inexact += u64::from(!packing.is_exact);
        let mut used = vec![false; firsts.last().map_or(0, |last| *last as usize)];
        for &chosen in &packing.chosen {
            let (path, _) = &ways[chosen as usize];
            let root = &waiting.layers[path[0].0].nodes[path[0].1];
            let is_due = is_last || root.root == oldest;
            if is_due && self.begin_along(sensor, waiting, path, known_s, recorder) {
                waiting.counts.begun += 1;
                for &element in &sets[chosen as usize] {
                    used[element as usize] = true;
                }
            }
        }
        let oldest_points = waiting.layers[0].points.iter().enumerate();
        let left = oldest_points.filter(|(at, point)| point.is_some() && !used[*at]);
        waiting.counts.left += left.count() as u64;
        forget(waiting, &firsts, &used);
    }

    /// Step 4: a track that has lived through these scans. `false` where it would have ended on the way.
    fn begin_along(
        &mut self,
        sensor: usize,
        waiting: &OfSensor<F::Belief, K>,
        path: &Path,
        known_s: f64,
        recorder: &mut dyn Recorder,
    ) -> bool {
        let nodes: Vec<Step<F::Belief, K>> = path
            .iter()
            .map(|&(layer, node)| (&waiting.layers[layer], &waiting.layers[layer].nodes[node]))
            .collect();
        let lives = self.lives(sensor, &nodes);
        let (Some(life), Some((_, last))) = (lives.last(), nodes.last()) else {
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
        let smoothed = self.smoothed(&nodes);
        for ((at, estimate), life) in nodes.iter().zip(&smoothed).zip(&lives) {
            self.record_past(
                sensor,
                at,
                (track.serial, life),
                (estimate, known_s),
                recorder,
            );
        }
        if life.is_confirmed() {
            self.memory.counted.targets += 1.0;
        }
        self.memory.push(track, last.belief);
        true
    }

    /// What the track had lived through at each scan.
    fn lives(&self, sensor: usize, nodes: &[Step<F::Belief, K>]) -> Vec<TrackLifecycleState> {
        let finds_targets = self.memory.finders & (1 << sensor.min(63)) != 0;
        let mut lives: Vec<TrackLifecycleState> = Vec::with_capacity(nodes.len());
        for (layer, node) in nodes {
            let life = match lives.last() {
                None => self.lifecycle.start(&Glance {
                    existence: Some(by_ratio(0.5, node.score)),
                    ..Glance::first(layer.time_s, sensor)
                }),
                Some(before) => {
                    let mut life = *before;
                    let glance = Glance {
                        time_s: layer.time_s,
                        sensor,
                        was_detected: node.detection.is_some(),
                        finds_targets,
                        share: node.share,
                        log_ratio: node.log_ratio,
                        existence: None,
                    };
                    self.lifecycle.advance(&mut life, &glance);
                    life
                }
            };
            lives.push(life);
        }
        lives
    }

    /// The estimates in the light of all detections.
    fn smoothed(&self, nodes: &[Step<F::Belief, K>]) -> Vec<F::Belief> {
        let mut smoothed: Vec<F::Belief> = nodes.iter().map(|(_, node)| node.belief).collect();
        for at in (1..nodes.len()).rev() {
            let dt_s = nodes[at].0.time_s - nodes[at - 1].0.time_s;
            smoothed[at - 1] = F::smooth(&self.filter.step(dt_s), &smoothed[at - 1], &smoothed[at]);
        }
        smoothed
    }

    fn record_past(
        &mut self,
        sensor: usize,
        (layer, node): &Step<F::Belief, K>,
        (serial, life): (u32, &TrackLifecycleState),
        (estimate, known_s): (&F::Belief, f64),
        recorder: &mut dyn Recorder,
    ) {
        let kept = self.lifecycle.smoothing.map(|_| &node.belief);
        self.scratch.pack(&F::kinematics(estimate), kept);
        recorder.point(&RecordedPoint {
            serial,
            scan_index: layer.scan_index,
            time_s: layer.time_s,
            known_at_s: known_s,
            sensor,
            status: life.status(),
            existence: self.lifecycle.existence_of(life),
            kinematics: &self.scratch.kinematics,
            belief: &self.scratch.belief,
            nis: node.nis,
            modes: F::mode_probabilities(estimate),
            candidates: &[Candidate {
                detection: node.detection,
                probability: 1.0,
            }],
        });
    }
}

/// The ways that may begin, with their scores.
fn candidates<B, const K: usize>(rule: &MultiScan, waiting: &OfSensor<B, K>) -> Vec<(Path, f64)> {
    let newest = waiting.layers.len() - 1;
    let leaves = waiting.layers[newest].nodes.iter().enumerate();
    leaves
        .filter(|(_, node)| node.hits >= rule.min_detections && node.score > 0.0)
        .map(|(leaf, node)| (path_to(waiting, newest, leaf), node.score))
        .collect()
}

fn path_to<B, const K: usize>(waiting: &OfSensor<B, K>, newest: usize, leaf: usize) -> Path {
    let mut path = vec![(newest, leaf)];
    let (mut layer, mut node) = (newest, leaf);
    while let Some(parent) = waiting.layers[layer].nodes[node].parent {
        (layer, node) = (layer - 1, parent as usize);
        path.push((layer, node));
    }
    path.reverse();
    path
}

/// The number of the first detection of each layer, and of all.
fn first_elements<B, const K: usize>(waiting: &OfSensor<B, K>) -> Vec<u32> {
    let mut firsts = vec![0];
    for layer in &waiting.layers {
        firsts.push(firsts[firsts.len() - 1] + layer.points.len() as u32);
    }
    firsts
}

/// The detections of a way, by those numbers.
fn elements<B, const K: usize>(waiting: &OfSensor<B, K>, firsts: &[u32], path: &Path) -> Vec<u32> {
    let number = |&(layer, node): &(usize, usize)| {
        let detection = waiting.layers[layer].nodes[node].detection?;
        Some(firsts[layer] + detection)
    };
    path.iter().filter_map(number).collect()
}

/// Drops the oldest layer with all ways from it, and those with a detection that is used.
fn forget<B: Copy, const K: usize>(waiting: &mut OfSensor<B, K>, firsts: &[u32], used: &[bool]) {
    let oldest = waiting.layers[0].number;
    let mut places: Vec<Option<u32>> = Vec::new();
    for (index, layer) in waiting.layers.iter_mut().enumerate() {
        for (at, point) in layer.points.iter_mut().enumerate() {
            if used[firsts[index] as usize + at] {
                *point = None;
            }
        }
        let mut kept = Vec::with_capacity(layer.nodes.len());
        let mut now = vec![None; layer.nodes.len()];
        for (at, node) in layer.nodes.iter().enumerate() {
            let is_used = |detection: u32| used[(firsts[index] + detection) as usize];
            let parent = node.parent.map(|parent| places[parent as usize]);
            let lives =
                node.root != oldest && parent != Some(None) && !node.detection.is_some_and(is_used);
            if lives {
                now[at] = Some(kept.len() as u32);
                kept.push(Node {
                    parent: parent.flatten(),
                    ..*node
                });
            }
        }
        layer.nodes = kept;
        places = now;
    }
    waiting.layers.pop_front();
}
