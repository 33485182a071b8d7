//! Which detections of a window a due root competes for, so that ways of the others need not be known.

use super::threes::Three;
use super::ways::Node;
use super::{MultiScan, OfSensor};
use crate::math::set_packing;

/// A second detection that a root may have, by their numbers, the layer of the second and the last one of a third.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Second {
    root: u32,
    second: u32,
    at: u32,
    until: u32,
}

/// Which detections a due root competes for. Memory is reused, as all here.
#[derive(Debug, Default)]
pub(super) struct Links {
    /// The number of the first detection of each layer, and of all.
    pub firsts: Vec<u32>,
    parents: Vec<u32>,
    is_due: Vec<bool>,
    is_wanted: Vec<bool>,
    seconds: Vec<Second>,
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
        self.seconds.clear();
        self.is_wanted.clear();
        self.is_wanted.resize(total as usize, self.is_free);
        if self.is_free {
            return true;
        }
        let is_due =
            |(index, three): &(usize, Three)| is_last || three.before[0] as usize == *index;
        let has_due = threes(waiting).any(|three| is_due(&three));
        if has_due {
            self.parents.clear();
            self.parents.extend(0..total);
            self.is_due.clear();
            self.is_due.resize(total as usize, false);
            self.link(waiting);
            for three in threes(waiting).filter(is_due) {
                let [root, ..] = self.numbers(&three);
                self.is_due[set_packing::root(&mut self.parents, root) as usize] = true;
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
                let one = set_packing::root(&mut self.parents, first);
                let other = set_packing::root(&mut self.parents, other);
                self.parents[one.max(other) as usize] = one.min(other);
            }
        }
    }

    /// Notes what is linked to something due.
    fn want<const K: usize>(&mut self, waiting: &OfSensor<K>) {
        for (index, three) in threes(waiting) {
            let numbers = self.numbers(&(index, three));
            if self.is_due[set_packing::root(&mut self.parents, numbers[0]) as usize] {
                for number in numbers {
                    self.is_wanted[number as usize] = true;
                }
                self.seconds.push(Second {
                    root: numbers[0],
                    second: numbers[1],
                    at: index as u32 - three.before[1],
                    until: index as u32,
                });
            }
        }
        self.seconds.sort_unstable();
        // The last of each pair is the one with the last third.
        self.seconds.reverse();
        self.seconds
            .dedup_by_key(|second| (second.root, second.second));
        self.seconds.reverse();
    }

    fn numbers(&self, (index, three): &(usize, Three)) -> [u32; 3] {
        let [first, second] = three.before.map(|before| index - before as usize);
        let layers = [first, second, *index];
        std::array::from_fn(|at| self.firsts[layers[at]] + three.detections[at])
    }

    /// Whether something due competes for a detection.
    pub fn wants(&self, layer: usize, detection: usize) -> bool {
        self.is_wanted[self.firsts[layer] as usize + detection]
    }

    /// The last layer with a second detection of a root, if it may have one.
    pub fn root_until(&self, layer: usize, detection: u32) -> Option<u32> {
        if self.is_free {
            return Some(u32::MAX);
        }
        let root = self.firsts[layer] + detection;
        let from = self.seconds.partition_point(|second| second.root < root);
        let seconds = self.seconds[from..].iter();
        let own = seconds.take_while(|second| second.root == root);
        own.map(|second| second.at).max()
    }

    /// The last layer with a third detection, if a root may have this second one.
    pub fn pair_until(&self, node: &Node, (layer, detection): (usize, u32)) -> Option<u32> {
        if self.is_free {
            return Some(u32::MAX);
        }
        let root = self.firsts[node.root as usize] + node.first;
        let wanted = (root, self.firsts[layer] + detection);
        let key = |second: &Second| (second.root, second.second);
        let place = self.seconds.binary_search_by_key(&wanted, key);
        place.ok().map(|at| self.seconds[at].until)
    }
}

/// Of all layers, with the index of the layer in which each ends.
fn threes<const K: usize>(waiting: &OfSensor<K>) -> impl Iterator<Item = (usize, Three)> {
    let layers = waiting.layers.iter().enumerate();
    layers.flat_map(|(index, layer)| layer.threes.iter().map(move |&three| (index, three)))
}
