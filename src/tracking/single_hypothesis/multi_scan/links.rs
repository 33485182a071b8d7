//! Which detections of a window a due root competes for, so that ways of the others need not be known.

use super::node::Node;
use super::threes::Three;
use super::{MultiScan, OfSensor};
use crate::math::disjoint_sets;

/// What a detection decides.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) enum Part {
    #[default]
    Nothing,
    /// A beginning with others of which at most one is in a layer, and too few for two beginnings.
    Lone,
    Shared,
}

/// Which detections a due root competes for. Memory is reused, as all here.
#[derive(Debug, Default)]
pub(super) struct Links {
    /// The number of the first detection of each layer, and of all.
    pub firsts: Vec<u32>,
    parents: Vec<u32>,
    is_due: Vec<bool>,
    /// Of each detection.
    parts: Vec<Part>,
    /// The ways of which are looked at.
    pub part: Part,
    /// Of each root of a tree of `parents` how many detections it has, and the layer of the last one; none where two are in one layer.
    counts: Vec<(u32, Option<usize>)>,
    /// Their threes by number, in order.
    threes: Vec<[u32; 3]>,
    /// Where two detections are enough any may follow any.
    is_free: bool,
}

impl Links {
    /// Tells whether anything can be due.
    pub fn rebuild<const K: usize>(
        &mut self,
        rule: &MultiScan,
        waiting: &OfSensor<K>,
        is_last: bool,
    ) -> bool {
        self.firsts.clear();
        self.firsts.push(0);
        let mut total = 0;
        for layer in &waiting.layers {
            total += layer.points.len() as u32;
            self.firsts.push(total);
        }
        self.is_free = rule.min_detections <= 2;
        self.threes.clear();
        self.parts.clear();
        let part = if self.is_free {
            Part::Shared
        } else {
            Part::Nothing
        };
        self.parts.resize(total as usize, part);
        if self.is_free {
            return true;
        }
        let is_due =
            |(index, three): &(usize, Three)| is_last || three.before[0] as usize == *index;
        let has_due = threes(waiting).any(|three| is_due(&three));
        if has_due {
            disjoint_sets::reset(&mut self.parents, total as usize);
            self.is_due.clear();
            self.is_due.resize(total as usize, false);
            self.link(waiting);
            for three in threes(waiting).filter(is_due) {
                let [root, ..] = self.numbers(&three);
                self.is_due[disjoint_sets::root(&mut self.parents, root) as usize] = true;
            }
            self.want(waiting);
        }
        has_due
    }

    /// Detections of a three are linked.
    fn link<const K: usize>(&mut self, waiting: &OfSensor<K>) {
        for three in threes(waiting) {
            let [first, rest @ ..] = self.numbers(&three);
            for other in rest {
                disjoint_sets::join(&mut self.parents, first, other);
            }
        }
    }

    /// Notes what is linked to something due.
    fn want<const K: usize>(&mut self, waiting: &OfSensor<K>) {
        for (index, three) in threes(waiting) {
            let numbers = self.numbers(&(index, three));
            if self.is_due[disjoint_sets::root(&mut self.parents, numbers[0]) as usize] {
                for number in numbers {
                    self.parts[number as usize] = Part::Shared;
                }
                self.threes.push(numbers);
            }
        }
        self.threes.sort_unstable();
    }

    /// Notes which of these are alone, where `fewer` of them would be two beginnings.
    pub fn find_lone(&mut self, fewer: u32) {
        self.counts.clear();
        self.counts.resize(self.parts.len(), (0, Some(usize::MAX)));
        if self.is_free {
            return;
        }
        for layer in 0..self.firsts.len() - 1 {
            for number in self.firsts[layer]..self.firsts[layer + 1] {
                if self.parts[number as usize] != Part::Nothing {
                    let root = disjoint_sets::root(&mut self.parents, number);
                    let (count, last) = &mut self.counts[root as usize];
                    *count += 1;
                    *last = last.filter(|&last| last != layer).map(|_| layer);
                }
            }
        }
        for number in 0..self.parts.len() {
            if self.parts[number] != Part::Nothing {
                let root = disjoint_sets::root(&mut self.parents, number as u32);
                let (count, last) = self.counts[root as usize];
                if last.is_some() && count < fewer {
                    self.parts[number] = Part::Lone;
                }
            }
        }
    }

    pub fn has(&self, part: Part) -> bool {
        self.parts.contains(&part)
    }

    /// How many detections are linked, of the first of them; none of another.
    pub fn count_from(&self, number: u32) -> Option<u32> {
        let is_first = self.parents[number as usize] == number;
        is_first.then(|| self.counts[number as usize].0)
    }

    /// Those of a beginning that is chosen decide nothing more; the lone ones of which none is compete as all do.
    pub fn settle(&mut self, chosen: &[u32]) {
        for &number in chosen {
            self.parts[number as usize] = Part::Nothing;
        }
    }

    pub fn share_lone(&mut self) {
        let parts = self.parts.iter_mut();
        for part in parts.filter(|part| **part == Part::Lone) {
            *part = Part::Shared;
        }
    }

    fn numbers(&self, (index, three): &(usize, Three)) -> [u32; 3] {
        let [first, second] = three.before.map(|before| index - before as usize);
        let layers = [first, second, *index];
        std::array::from_fn(|at| self.firsts[layers[at]] + three.detections[at])
    }

    /// Whether something due competes for a detection.
    pub fn wants(&self, layer: usize, detection: usize) -> bool {
        self.parts[self.firsts[layer] as usize + detection] == self.part
    }

    /// Those that begin with a root.
    fn of_root(&self, root: u32) -> &[[u32; 3]] {
        let from = self.threes.partition_point(|three| three[0] < root);
        let to = self.threes[from..].partition_point(|three| three[0] == root);
        &self.threes[from..from + to]
    }

    fn of_pair(&self, root: u32, second: u32) -> &[[u32; 3]] {
        let threes = self.of_root(root);
        let from = threes.partition_point(|three| three[1] < second);
        let to = threes[from..].partition_point(|three| three[1] == second);
        &threes[from..from + to]
    }

    /// The number of the last detection with which a root may go on, if there is one.
    pub fn root_until(&self, root: u32) -> Option<u32> {
        if self.is_free {
            return Some(u32::MAX);
        }
        self.of_root(root).last().map(|three| three[1])
    }

    /// The same of a root and a second detection.
    pub fn pair_until(&self, root: u32, second: u32) -> Option<u32> {
        if self.is_free {
            return Some(u32::MAX);
        }
        self.of_pair(root, second).last().map(|three| three[2])
    }

    /// The detections of a layer with which a way may go on, where that is known.
    pub fn list(&self, node: &Node, layer: usize) -> Option<impl Iterator<Item = u32>> {
        if self.is_free || node.hits > 2 {
            return None;
        }
        let (threes, place) = match node.second {
            None => (self.of_root(node.root), 1),
            Some(second) => (self.of_pair(node.root, second), 2),
        };
        let (first, end) = (self.firsts[layer], self.firsts[layer + 1]);
        let from = threes.partition_point(|three| three[place] < first);
        let to = threes.partition_point(|three| three[place] < end);
        let mut last = None;
        let inside = threes[from..to]
            .iter()
            .map(move |three| three[place] - first);
        Some(inside.filter(move |&detection| last.replace(detection) != Some(detection)))
    }
}

/// Of all layers, with the index of the layer in which each ends.
fn threes<const K: usize>(waiting: &OfSensor<K>) -> impl Iterator<Item = (usize, Three)> {
    let layers = waiting.layers.iter().enumerate();
    layers.flat_map(|(index, layer)| layer.threes.iter().map(move |&three| (index, three)))
}
