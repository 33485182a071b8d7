//! The ways through the scans of a window: steps 1 and 2 of [`super`], for the detections that a due root competes for.

use super::choice::{Choice, Chosen, Past};
use super::links::{Links, Part};
use super::lone::Bounds;
use super::node::{self, Node, Way};
use super::{Layer, MAX_STEPS, MultiScan, OfSensor, Point};
use crate::association::Needs;
use crate::filtering::Filter;
use crate::hypotheses::{About, Hypotheses, Look, Only};
use crate::math::gaussian::gate_threshold;
use crate::math::set_packing::{self, Sets};
use crate::model::sensor::Sensor;
use crate::model::watch::{Halt, Watch};
use crate::tracking::single_hypothesis::initiate::root_belief;
use crate::tracking::single_hypothesis::initiation::reach_m;
use crate::tracking::single_hypothesis::lifecycle::Lifecycle;

/// The ways as far as one layer, and what is believed of them; of the newest layer nothing yet.
#[derive(Debug)]
struct Stage<B> {
    nodes: Vec<Node>,
    beliefs: Vec<B>,
}

/// What decides how ways go on.
pub(super) struct Rules<'a, F> {
    pub rule: &'a MultiScan,
    pub filter: &'a F,
    pub sensor: &'a Sensor,
    pub lifecycle: &'a Lifecycle,
    pub highest_p_d: f64,
    pub max_speed_mps: f64,
}

/// The ways of a window; memory is reused.
pub(in crate::tracking::single_hypothesis) struct Ways<F: Filter<K>, const K: usize> {
    /// What widens the bound of threes.
    pub(super) slack: f64,
    hypotheses: Hypotheses<F, K>,
    links: Links,
    stages: Vec<Stage<F::Belief>>,
    /// What was expected of the nodes before the last layer there.
    predicted: Vec<F::Belief>,
    members: Vec<u32>,
    only: Only,
    /// Of each way that may begin its last node, its detections by number, and its score.
    leaves: Vec<u32>,
    sets: Sets,
    scores: Vec<f64>,
}

impl<F: Filter<K>, const K: usize> Ways<F, K> {
    pub fn new(gate_probability: f64, needs: Needs) -> Self {
        let needs = if needs.is_by_origin() {
            needs
        } else {
            Needs::Nothing
        };
        Ways {
            slack: 1.0,
            hypotheses: Hypotheses::new(gate_probability, needs),
            links: Links::default(),
            stages: Vec::new(),
            predicted: Vec::new(),
            members: Vec::new(),
            only: Only::default(),
            leaves: Vec::new(),
            sets: Sets::default(),
            scores: Vec::new(),
        }
    }

    /// Whether anything of the window can be due.
    pub(super) fn link(&mut self, rule: &MultiScan, waiting: &OfSensor<K>, is_last: bool) -> bool {
        self.links.rebuild(rule, waiting, is_last)
    }

    /// The number of the first detection of each layer, and of all.
    pub(super) fn firsts(&self) -> &[u32] {
        &self.links.firsts
    }

    /// Step 3.
    ///
    /// # Errors
    /// When there are too many candidates, or the watch says to stop.
    pub(super) fn choose(
        &mut self,
        rules: &Rules<F>,
        waiting: &OfSensor<K>,
        choice: &mut Choice<F::Belief>,
        watch: &Watch,
    ) -> Result<(), Halt> {
        choice.clear();
        if let Some(bounds) = Bounds::of(rules, waiting) {
            self.links.find_lone(2 * rules.rule.min_detections);
            if self.links.has(Part::Lone) {
                self.links.part = Part::Lone;
                choice.cut += self.expand(rules, waiting, watch)?;
                self.choose_lone(rules, (waiting, &bounds), choice);
                self.links.share_lone();
            }
        }
        if self.links.has(Part::Shared) {
            self.links.part = Part::Shared;
            choice.cut += self.expand(rules, waiting, watch)?;
            self.choose_shared(rules.rule, waiting.layers.len(), choice);
        }
        let numbers = &choice.numbers;
        choice.ways.sort_by_key(|way| numbers[way.numbers.start]);
        Ok(())
    }

    /// The ways that nothing but parts of them competes with, as far as no part can be better.
    fn choose_lone(
        &mut self,
        rules: &Rules<F>,
        (waiting, bounds): (&OfSensor<K>, &Bounds),
        choice: &mut Choice<F::Belief>,
    ) {
        let layers = waiting.layers.len();
        for leaf in 0..self.stages[layers - 1].nodes.len() {
            let node = self.stages[layers - 1].nodes[leaf];
            let is_whole = self.links.count_from(node.root) == Some(node.hits);
            if !is_whole || node.hits < rules.rule.min_detections {
                continue;
            }
            let chosen = self.tell((layers, leaf), choice);
            let pasts = &choice.pasts[chosen.pasts.clone()];
            if bounds.are_parts_worse(pasts, waiting) {
                self.links.settle(&choice.numbers[chosen.numbers.clone()]);
                if node.score > 0.0 {
                    choice.ways.push(chosen);
                }
            }
        }
    }

    /// The heaviest packing of the ways as far as the newest layer.
    fn choose_shared(&mut self, rule: &MultiScan, layers: usize, choice: &mut Choice<F::Belief>) {
        self.leaves.clear();
        self.sets.clear();
        self.scores.clear();
        let mut numbers = Vec::new();
        for leaf in 0..self.stages[layers - 1].nodes.len() {
            let node = self.stages[layers - 1].nodes[leaf];
            if node.hits < rule.min_detections || node.score <= 0.0 {
                continue;
            }
            numbers.clear();
            self.each_of((layers - 1, leaf), |layer, node| {
                let number = |detection| self.links.firsts[layer] + detection;
                numbers.extend(node.detection.map(number));
            });
            self.leaves.push(leaf as u32);
            self.sets.push(numbers.iter().rev().copied());
            self.scores.push(node.score);
        }
        let packing = set_packing::pack(&self.sets, &self.scores, MAX_STEPS);
        choice.is_exact = packing.is_exact;
        for way in packing.chosen {
            let leaf = self.leaves[way as usize] as usize;
            let chosen = self.tell((layers, leaf), choice);
            choice.ways.push(chosen);
        }
    }

    /// Steps 1 and 2 through all layers. Tells how many ways were cut.
    fn expand(
        &mut self,
        rules: &Rules<F>,
        waiting: &OfSensor<K>,
        watch: &Watch,
    ) -> Result<u64, Halt> {
        let mut cut = 0;
        for index in 0..waiting.layers.len() {
            if self.stages.len() == index {
                self.stages.push(Stage {
                    nodes: Vec::new(),
                    beliefs: Vec::new(),
                });
            }
            self.stages[index].nodes.clear();
            self.stages[index].beliefs.clear();
            self.read(rules, (waiting, index));
            if index > 0 && !self.stages[index - 1].nodes.is_empty() {
                self.go_on(rules, (waiting, index), watch)?;
            }
            self.add_roots(rules, (waiting, index));
            let nodes = &mut self.stages[index].nodes;
            cut += node::cut(nodes, rules.rule.max_nodes as usize);
            if index + 1 < waiting.layers.len() {
                self.believe(rules, (waiting, index));
            }
        }
        Ok(cut)
    }

    /// Takes the detections of a layer that something due competes for.
    fn read(&mut self, rules: &Rules<F>, (waiting, index): (&OfSensor<K>, usize)) {
        let layer = &waiting.layers[index];
        let report = rules.sensor.report_in(&layer.scan);
        let (hypotheses, ratios) = (&mut self.hypotheses, &layer.log_clutter_ratios);
        hypotheses.begin_scan(rules.filter, &report, &layer.scan, |log_ratios| {
            log_ratios.extend_from_slice(ratios);
        });
        for (at, is_used) in layer.is_used.iter().enumerate() {
            if *is_used || !self.links.wants(index, at) {
                hypotheses.mark_used(at as u32);
            }
        }
    }

    /// Step 2.
    fn go_on(
        &mut self,
        rules: &Rules<F>,
        (waiting, index): (&OfSensor<K>, usize),
        watch: &Watch,
    ) -> Result<(), Halt> {
        let [last, layer] = [&waiting.layers[index - 1], &waiting.layers[index]];
        let (before, after) = self.stages.split_at_mut(index);
        let (before, after) = (&before[index - 1], &mut after[0].nodes);
        self.predicted.clear();
        self.predicted.extend_from_slice(&before.beliefs);
        self.members.clear();
        self.members.extend(0..before.nodes.len() as u32);
        self.only.clear();
        for node in &before.nodes {
            self.only.push(self.links.list(node, index));
        }
        let look = Look {
            filter: rules.filter,
            sensor: rules.sensor,
            report: &rules.sensor.report_in(&layer.scan),
            scan: &layer.scan,
            step: &rules.filter.step(layer.scan.time_s - last.scan.time_s),
        };
        let about = |node: u32| About::of(before.nodes[node as usize].origin);
        let hypotheses = &mut self.hypotheses;
        let beliefs = (&mut self.predicted[..], &self.members[..], Some(&self.only));
        hypotheses.write_among(look, 0, beliefs, &about, watch)?;
        let reach = Reach::new::<F, K>(rules);
        for row in 0..hypotheses.problem().rows().len() {
            let parent = hypotheses.track(row);
            let way = Way {
                rule: rules.rule,
                links: &self.links,
                layer: index,
                layers_left: (waiting.layers.len() - 1 - index) as u32,
                node: Node {
                    parent: Some(parent as u32),
                    share: hypotheses.p_d(row) / rules.highest_p_d,
                    row: row as u32,
                    ..before.nodes[parent]
                },
            };
            let edges = hypotheses.problem().rows()[row].edges();
            let is_lone = self.links.part == Part::Lone;
            if !is_lone || edges.is_empty() {
                after.extend(way.missed(hypotheses.problem().rows()[row].log_missed));
            }
            for edge in edges {
                let found = hypotheses.problem().edges()[edge];
                if !reach.allows(waiting, &way.node, &layer.points[found.detection as usize]) {
                    continue;
                }
                if let Some(hit) = way.hit(found.detection, found.log_likelihood) {
                    after.push(Node {
                        nis: Some(hypotheses.fit(edge)),
                        edge: Some(edge as u32),
                        ..hit
                    });
                }
            }
            if watch.stops_after(64) {
                return Err(Halt::Stopped);
            }
        }
        Ok(())
    }

    /// Step 1.
    fn add_roots(&mut self, rules: &Rules<F>, (waiting, index): (&OfSensor<K>, usize)) {
        let layer = &waiting.layers[index];
        let layers_left = (waiting.layers.len() - 1 - index) as u32;
        if 1 + layers_left < rules.rule.min_detections {
            return;
        }
        for (at, point) in layer.points.iter().enumerate() {
            let root = self.links.firsts[index] + at as u32;
            let is_part = self.links.part == Part::Lone && self.links.count_from(root).is_none();
            if layer.is_used[at] || !self.links.wants(index, at) || is_part {
                continue;
            }
            if let Some(until) = self.links.root_until(root) {
                self.stages[index].nodes.push(Node {
                    parent: None,
                    root,
                    root_layer: index as u32,
                    second: None,
                    first: at as u32,
                    origin: point.origin,
                    detection: Some(at as u32),
                    hits: 1,
                    gap: 0,
                    until,
                    score: layer.log_odds,
                    log_ratio: 0.0,
                    share: 1.0,
                    nis: None,
                    row: 0,
                    edge: None,
                });
            }
        }
    }

    /// What is believed of the ways as far as a layer.
    fn believe(&mut self, rules: &Rules<F>, (waiting, index): (&OfSensor<K>, usize)) {
        let layer = &waiting.layers[index];
        let report = rules.sensor.report_in(&layer.scan);
        let mut beliefs = std::mem::take(&mut self.stages[index].beliefs);
        for node in &self.stages[index].nodes {
            beliefs.push(if node.parent.is_some() {
                self.updated(node)
            } else {
                let sigma_mps = rules.lifecycle.initial_speed_sigma_mps;
                let at = node.first as usize;
                let own = layer.scan.own_of(at);
                let detection = (&layer.points[at], at, &own);
                let look = (rules.filter, &self.hypotheses, &report);
                root_belief(look, detection, sigma_mps)
            });
        }
        self.stages[index].beliefs = beliefs;
    }

    /// What is believed of a node of the layer that was read last.
    fn updated(&self, node: &Node) -> F::Belief {
        let row = node.row as usize;
        let mut belief = self.predicted[self.hypotheses.track(row)];
        if let Some(edge) = node.edge {
            self.hypotheses.take(row, edge as usize, &mut belief);
        }
        belief
    }

    /// Writes down the points of a way, from the root on, and the numbers of its detections.
    fn tell(&self, (layers, leaf): (usize, usize), choice: &mut Choice<F::Belief>) -> Chosen {
        let (from, first) = (choice.pasts.len(), choice.numbers.len());
        let mut at = leaf;
        self.each_of((layers - 1, leaf), |layer, node| {
            let number = |detection| self.links.firsts[layer] + detection;
            choice.numbers.extend(node.detection.map(number));
            choice.pasts.push(Past {
                layer: layer as u32,
                detection: node.detection,
                origin: node.origin,
                log_ratio: node.log_ratio,
                share: node.share,
                nis: node.nis,
                belief: match self.stages[layer].beliefs.get(at) {
                    Some(belief) => *belief,
                    None => self.updated(node),
                },
            });
            at = node.parent.unwrap_or(0) as usize;
        });
        choice.pasts[from..].reverse();
        choice.numbers[first..].reverse();
        Chosen {
            pasts: from..choice.pasts.len(),
            numbers: first..choice.numbers.len(),
        }
    }

    /// From a leaf to its root.
    fn each_of(&self, (mut layer, mut at): (usize, usize), mut each: impl FnMut(usize, &Node)) {
        loop {
            let node = &self.stages[layer].nodes[at];
            each(layer, node);
            let Some(parent) = node.parent else {
                return;
            };
            (layer, at) = (layer - 1, parent as usize);
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
    fn new<F: Filter<K>, const K: usize>(rules: &Rules<F>) -> Self {
        Reach {
            max_speed_mps: rules.max_speed_mps,
            gate_threshold: gate_threshold(rules.lifecycle.gate_probability, (K / 2) as u32),
        }
    }

    /// Whether a detection may follow a way. Directions have no speed.
    fn allows<const K: usize>(
        &self,
        waiting: &OfSensor<K>,
        node: &Node,
        second: &Point<K>,
    ) -> bool {
        if node.hits > 1 || K <= 2 {
            return true;
        }
        let root: &Layer<K> = &waiting.layers[node.root_layer as usize];
        let first = &root.points[node.first as usize];
        let (distance_m, most_m) = reach_m(first, second, self.max_speed_mps, self.gate_threshold);
        distance_m <= most_m
    }
}
