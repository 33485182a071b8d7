//! Beginnings over several scans: of the detections that no track used those that follow each other best over a window of scans become
//! tracks, all chosen at once.
//!
//! # Reference
//! S. S. Blackman, R. Popoli, Design and Analysis of Modern Tracking Systems, 1999, sections 6.2 (score of a track) and 6.7; the joint
//! choice is that of track-oriented multiple hypothesis tracking, for beginnings alone.
//!
//! # Symbols
//! W scans of the window; b beginnings so far, c detections so far that were in none; ν, S innovation and its covariance; P_D, P_G
//! probability of detection and of the gate; λ clutter density; L score.
//!
//! # Method
//! For each sensor by itself:
//! 1. Each unused detection is a root, L = ln((1 + b)/(1 + c)): how much more often such a detection was a target than clutter.
//! 2. Each way so far goes on with each unused detection inside its gate, L ← L + ln(P_D N(ν; 0, S)/λ), and with none,
//!    L ← L + ln(1 − P_D P_G), at most `max_gap_scans` times in a row. The second detection is one that a target at `max_speed_mps`
//!    reaches. Ways that can no longer have `min_detections` end.
//! 3. When the window is full, the ways with `min_detections` and L > 0 that share no detection and have the largest sum of scores are
//!    chosen ([`crate::math::set_packing`]), exactly as long as that takes no more than [`MAX_STEPS`] steps a cluster. Those whose root
//!    is in the oldest scan begin; the others wait, for more may come. Roots in the oldest scan that do not begin are clutter.
//! 4. A beginning has lived through its scans: its hits and misses count for confirmation and deletion. Its past points are estimates in
//!    the light of all its detections; scans that missed it are coasted.
//!
//! More than `max_nodes` ways are cut: of each root the best go first. That is told.

mod choose;
mod written;

use super::SingleHypothesis;
use super::initiation::{Point, SPEED_REACH, reach_m};
use super::lifecycle::Lifecycle;
use crate::filtering::Filter;
use crate::hypotheses::{About, Look};
use crate::math::gaussian::gate_threshold;
use crate::model::scan::Scan;
use crate::model::sensing::MeasurementModel;
use crate::model::watch::{Halt, Watch};
use crate::tracking::recorder::Recorder;
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;

pub(super) use written::WrittenBeginnings;

/// Sets that are tried in a cluster of beginnings.
const MAX_STEPS: usize = 200_000;

/// The parameters of the initiation.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct MultiScan {
    pub max_speed_mps: Option<f64>,
    pub window_scans: u32,
    pub min_detections: u32,
    pub max_gap_scans: u32,
    pub max_nodes: u32,
}

/// A way through the scans of a window, as far as one of them.
#[derive(Debug, Clone, Copy)]
struct Node<B> {
    /// In the layer before; none of a root.
    parent: Option<u32>,
    /// Number of the layer of its root, and the detection there.
    root: u32,
    first: u32,
    /// Of the root.
    origin: Option<u32>,
    /// Its index in its scan; none where the scan missed it.
    detection: Option<u32>,
    hits: u32,
    /// Scans since the last detection.
    gap: u32,
    score: f64,
    /// What the scan added to the score.
    log_ratio: f64,
    /// P_D there over the highest of the sensors.
    share: f64,
    nis: Option<f64>,
    belief: B,
}

/// One scan of the window.
#[derive(Debug, Clone)]
struct Layer<B, const K: usize> {
    /// Of the scans of its sensor.
    number: u32,
    scan_index: u32,
    time_s: f64,
    /// Of each detection that no track used, if it tells where its target is.
    points: Vec<Option<Point<K>>>,
    nodes: Vec<Node<B>>,
}

/// What waits to begin, of one sensor.
#[derive(Debug, Clone)]
struct OfSensor<B, const K: usize> {
    /// The oldest first.
    layers: VecDeque<Layer<B, K>>,
    scans: u32,
    counts: Counts,
}

/// What became of detections that no track used.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Counts {
    /// b.
    begun: u64,
    /// c.
    left: u64,
    /// Ways that were cut for want of room.
    cut: u64,
    /// Clusters of which the best choice was not found in time.
    inexact: u64,
}

impl Counts {
    /// L of a root.
    fn log_odds(&self) -> f64 {
        ((1 + self.begun) as f64 / (1 + self.left) as f64).ln()
    }
}

impl<B, const K: usize> Default for OfSensor<B, K> {
    fn default() -> Self {
        OfSensor {
            layers: VecDeque::new(),
            scans: 0,
            counts: Counts::default(),
        }
    }
}

/// What waits to begin, of each sensor.
#[derive(Debug, Clone)]
pub(super) struct Beginnings<B, const K: usize>(Vec<OfSensor<B, K>>);

impl<B, const K: usize> Default for Beginnings<B, K> {
    fn default() -> Self {
        Beginnings(Vec::new())
    }
}

impl<B, const K: usize> Beginnings<B, K> {
    fn of(&mut self, sensor: usize) -> &mut OfSensor<B, K> {
        if self.0.len() <= sensor {
            self.0.resize_with(sensor + 1, OfSensor::default);
        }
        &mut self.0[sensor]
    }

    /// What a user is told of choices that may not be the best.
    pub fn warnings(&self) -> Vec<String> {
        let sum =
            |of: fn(&Counts) -> u64| self.0.iter().map(|sensor| of(&sensor.counts)).sum::<u64>();
        let (cut, inexact) = (sum(|counts| counts.cut), sum(|counts| counts.inexact));
        let mut warnings = Vec::new();
        if cut > 0 {
            warnings.push(format!(
                "beginnings: {cut} of the ways from detection to detection were cut, the least likely of each first; a larger \
                 max_nodes, or a lower max_speed_mps, keeps more"
            ));
        }
        if inexact > 0 {
            warnings.push(format!(
                "beginnings: {inexact} times so many detections competed that the best choice found may not be the best there is"
            ));
        }
        warnings
    }
}

impl<F: Filter<K>, const K: usize> SingleHypothesis<F, K> {
    /// Takes the unused detections of a scan, and begins what is decided with it.
    pub(super) fn begin_over_scans(
        &mut self,
        rule: &MultiScan,
        (scan, report): (&Scan, &MeasurementModel),
        recorder: &mut dyn Recorder,
        watch: &Watch,
    ) -> Result<(), Halt> {
        let points = (0..scan.detections.len()).map(|index| self.point_of(scan, report, index));
        let points: Vec<Option<Point<K>>> = points.collect();
        let mut waiting = std::mem::take(self.memory.beginnings.of(scan.sensor));
        let mut layer = Layer {
            number: waiting.scans,
            scan_index: self.memory.scans,
            time_s: scan.time_s,
            points,
            nodes: Vec::new(),
        };
        waiting.scans += 1;
        self.go_on(rule, (scan, report), &waiting, &mut layer, watch)?;
        self.add_roots((scan, report), &waiting.counts, &mut layer);
        waiting.counts.cut += cut(&mut layer.nodes, rule.max_nodes as usize);
        waiting.layers.push_back(layer);
        if waiting.layers.len() >= rule.window_scans as usize {
            let known_s = scan.time_s;
            self.decide(rule, scan.sensor, &mut waiting, (known_s, false), recorder);
        }
        *self.memory.beginnings.of(scan.sensor) = waiting;
        Ok(())
    }

    /// Step 2.
    fn go_on(
        &mut self,
        rule: &MultiScan,
        (scan, report): (&Scan, &MeasurementModel),
        waiting: &OfSensor<F::Belief, K>,
        layer: &mut Layer<F::Belief, K>,
        watch: &Watch,
    ) -> Result<(), Halt> {
        let Some(last) = waiting.layers.back().filter(|last| !last.nodes.is_empty()) else {
            return Ok(());
        };
        let mut beliefs: Vec<F::Belief> = last.nodes.iter().map(|node| node.belief).collect();
        let members: Vec<u32> = (0..beliefs.len() as u32).collect();
        let look = Look {
            filter: &self.filter,
            sensor: &self.sensors[scan.sensor],
            report,
            scan,
            step: &self.filter.step(scan.time_s - last.time_s),
        };
        let about = |leaf: u32| About {
            origin: last.nodes[leaf as usize].origin,
            ..About::default()
        };
        let reach = Reach::new::<K>(rule, &self.lifecycle);
        let hypotheses = &mut self.scratch.hypotheses;
        hypotheses.write(look, 0, (&mut beliefs, &members), &about, watch)?;
        for row in 0..hypotheses.problem().rows().len() {
            let leaf = hypotheses.track(row);
            let way = Way {
                parent: leaf as u32,
                node: Node {
                    share: hypotheses.p_d(row) / self.highest_p_d,
                    belief: beliefs[leaf],
                    ..last.nodes[leaf]
                },
                scans_left: rule
                    .window_scans
                    .saturating_sub(layer.number - last.nodes[leaf].root + 1),
            };
            let log_missed = hypotheses.problem().rows()[row].log_missed;
            layer.nodes.extend(way.missed(rule, log_missed));
            for edge in hypotheses.problem().rows()[row].edges() {
                let found = hypotheses.problem().edges()[edge];
                let second = layer.points[found.detection as usize].as_ref();
                if !reach.allows(waiting, &way.node, second) {
                    continue;
                }
                if let Some(mut hit) = way.hit(rule, found.detection, found.log_likelihood) {
                    hit.nis = Some(hypotheses.fit(edge));
                    hypotheses.take(row, edge, &mut hit.belief);
                    layer.nodes.push(hit);
                }
            }
            if watch.stops_after(64) {
                return Err(Halt::Stopped);
            }
        }
        Ok(())
    }

    /// Step 1.
    fn add_roots(
        &self,
        (scan, report): (&Scan, &MeasurementModel),
        counts: &Counts,
        layer: &mut Layer<F::Belief, K>,
    ) {
        let score = counts.log_odds();
        for (index, point) in layer.points.iter().enumerate() {
            if let Some(point) = point {
                layer.nodes.push(Node {
                    parent: None,
                    root: layer.number,
                    first: index as u32,
                    origin: point.origin,
                    detection: Some(index as u32),
                    hits: 1,
                    gap: 0,
                    score,
                    log_ratio: 0.0,
                    share: 1.0,
                    nis: None,
                    belief: self.belief_of(point, (scan, report)),
                });
            }
        }
    }
}

/// How far apart the first two detections may be.
struct Reach {
    max_speed_mps: f64,
    /// γ.
    gate_threshold: f64,
}

impl Reach {
    /// Of places with `K / 2` coordinates.
    fn new<const K: usize>(rule: &MultiScan, lifecycle: &Lifecycle) -> Self {
        let told_mps = SPEED_REACH * lifecycle.initial_speed_sigma_mps;
        Reach {
            max_speed_mps: rule.max_speed_mps.unwrap_or(told_mps),
            gate_threshold: gate_threshold(lifecycle.gate_probability, (K / 2) as u32),
        }
    }

    /// Whether `second` may follow a way; one that does not say where its target is may. Directions have no speed.
    fn allows<B, const K: usize>(
        &self,
        waiting: &OfSensor<B, K>,
        node: &Node<B>,
        second: Option<&Point<K>>,
    ) -> bool {
        let Some(oldest) = waiting.layers.front().filter(|_| node.hits == 1 && K > 2) else {
            return true;
        };
        let root = &waiting.layers[(node.root - oldest.number) as usize];
        let first = root.points[node.first as usize].as_ref();
        first.zip(second).is_none_or(|(first, second)| {
            let (distance_m, most_m) =
                reach_m(first, second, self.max_speed_mps, self.gate_threshold);
            distance_m <= most_m
        })
    }
}

/// A way that goes on into a scan, with the belief that is expected there.
struct Way<B> {
    parent: u32,
    node: Node<B>,
    /// Of the window, after this one.
    scans_left: u32,
}

impl<B: Copy> Way<B> {
    fn missed(&self, rule: &MultiScan, log_missed: f64) -> Option<Node<B>> {
        let node = Node {
            parent: Some(self.parent),
            detection: None,
            gap: self.node.gap + 1,
            score: self.node.score + log_missed,
            log_ratio: log_missed,
            nis: None,
            ..self.node
        };
        let may_last = node.gap <= rule.max_gap_scans && self.may_suffice(rule, &node);
        may_last.then_some(node)
    }

    fn hit(&self, rule: &MultiScan, detection: u32, log_likelihood: f64) -> Option<Node<B>> {
        let node = Node {
            parent: Some(self.parent),
            detection: Some(detection),
            hits: self.node.hits + 1,
            gap: 0,
            score: self.node.score + log_likelihood,
            log_ratio: log_likelihood,
            ..self.node
        };
        self.may_suffice(rule, &node).then_some(node)
    }

    /// Whether enough detections may still come.
    fn may_suffice(&self, rule: &MultiScan, node: &Node<B>) -> bool {
        node.hits + self.scans_left >= rule.min_detections
    }
}

/// Keeps so many ways: of each root the best first. Tells how many were cut.
fn cut<B>(nodes: &mut Vec<Node<B>>, most: usize) -> u64 {
    if nodes.len() <= most {
        return 0;
    }
    let mut order: Vec<usize> = (0..nodes.len()).collect();
    let root = |at: usize| (nodes[at].root, nodes[at].first);
    order.sort_by(|&a, &b| {
        root(a)
            .cmp(&root(b))
            .then(nodes[b].score.total_cmp(&nodes[a].score))
    });
    let mut rank_of = vec![0; nodes.len()];
    for (place, &at) in order.iter().enumerate().skip(1) {
        let before = order[place - 1];
        rank_of[at] = if root(at) == root(before) {
            rank_of[before] + 1
        } else {
            0
        };
    }
    order.sort_by(|&a, &b| {
        let by_rank = rank_of[a].cmp(&rank_of[b]);
        by_rank
            .then(nodes[b].score.total_cmp(&nodes[a].score))
            .then(a.cmp(&b))
    });
    let mut is_kept = vec![false; nodes.len()];
    order.iter().take(most).for_each(|&at| is_kept[at] = true);
    let cut = nodes.len() - most;
    let mut at = 0;
    nodes.retain(|_| {
        at += 1;
        is_kept[at - 1]
    });
    cut as u64
}
