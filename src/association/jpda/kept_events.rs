//! The sum over the joint events of one block that are the best of their kind: of all with the same detected tracks and the
//! same used detections, the most probable one alone.
//!
//! # Symbols
//! The larger of the block's two sides are its elements, the other its nodes. D a set of elements, U a set of as many nodes;
//! M\[D, U\] weight of the best way to give the elements of D the nodes of U; wᵢⱼ weight of element i with node j.
//!
//! # Method
//! 1. M\[D ∪ i, U\] = max over j ∈ U of wᵢⱼ M\[D, U ∖ j\] for an i after all of D: what is best without its last pair is best. So
//!    the kept events are a tree, each with one that it grew from, and are found depth first by D. Of equals the first stays.
//! 2. On the way back the weight of each goes to the one it grew from: a pair's sum is that of the events it was added in.
//!
//! Sums are split by whether the vertex in which the block hangs is used, so that what else hangs there may be weighed later.

use super::blocks::Blocks;
use super::cluster::Cluster;
use super::number::Number;
use crate::model::watch::Watch;
use std::ops::Range;

/// Nodes of the largest block that is summed: a table over their sets has a word for each.
const MAX_NODES: u32 = 20;

/// Of the events without and with the vertex in which the block hangs.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Split<T>(pub(super) [T; 2]);

impl<T: Number> Split<T> {
    fn add(&mut self, other: Split<T>) {
        self.0 = [self.0[0] + other.0[0], self.0[1] + other.0[1]];
    }

    /// The sum of both, the events with that vertex weighed by `share`.
    pub(super) fn weighed(self, share: T) -> T {
        self.0[0] + share * self.0[1]
    }
}

/// What is summed over the blocks.
#[derive(Debug, Clone, Default)]
pub(super) struct Sums<T> {
    /// For each edge of the cluster its weight.
    pub(super) weight: Vec<T>,
    /// For each edge, the sum over the events that hold it.
    pub(super) with: Vec<Split<T>>,
    /// For each vertex, the sum over the events of its parent block that leave it; only for those that are watched.
    pub(super) without: Vec<Split<T>>,
}

/// Bounds of one sum.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bounds<'a> {
    /// Events that may still be kept.
    pub(super) events: u64,
    pub(super) watch: &'a Watch<'a>,
}

/// A kept event.
#[derive(Debug, Clone, Copy)]
struct Event<T> {
    /// U, by bits.
    used: u32,
    /// The pair that was added last, and the event that it was added to.
    edge: u32,
    grown_from: u32,
    /// ln M, of the given weights.
    log_weight: f64,
    weight: T,
    /// Sum over it and all that grew from it.
    mass: Split<T>,
}

#[derive(Debug, Clone, Copy)]
struct Pair {
    edge: u32,
    node: u32,
}

/// A vertex whose sum without it is wanted.
#[derive(Debug, Clone, Copy)]
struct Watched {
    vertex: u32,
    /// Its number among the elements or the nodes.
    number: u32,
}

#[derive(Debug, Clone, Default)]
pub(super) struct KeptEvents<T> {
    /// Grouped by element.
    pairs: Vec<Pair>,
    ends: Vec<u32>,
    nodes: u32,
    /// For each vertex of the cluster its number in the block.
    number_of: Vec<u32>,
    watched_elements: Vec<Watched>,
    watched_nodes: Vec<Watched>,
    top: Top,
    /// For each element whether it is in D.
    is_taken: Vec<bool>,
    /// Those of the D at hand and of all that it contains on the way to it.
    events: Vec<Event<T>>,
    /// For each set of nodes the event of the D at hand that uses it.
    event_of: Vec<u32>,
    total: Split<T>,
}

/// The vertex in which the block hangs.
#[derive(Debug, Clone, Copy, Default)]
enum Top {
    #[default]
    Nowhere,
    Element(u32),
    Node(u32),
}

const NONE: u32 = u32::MAX;

impl<T: Number> KeptEvents<T> {
    /// Sums over the kept events of a block, and tells the sum over all and how many they were. `None` when they are more
    /// than allowed, or the block is too wide. The vertices with `is_watched` get their sums without them.
    pub(super) fn sum(
        &mut self,
        cluster: &Cluster,
        (blocks, block): (&mut Blocks, usize),
        sums: &mut Sums<T>,
        is_watched: &[bool],
        bounds: Bounds,
    ) -> Option<(Split<T>, u64)> {
        if !self.load(cluster, (blocks, block), is_watched) {
            return None;
        }
        self.events.push(Event {
            used: 0,
            edge: NONE,
            grown_from: NONE,
            log_weight: 0.0,
            weight: T::ONE,
            mass: Split::default(),
        });
        let mut left = bounds;
        if !self.visit(cluster, sums, 0..1, 0, &mut left) {
            return None;
        }
        Some((self.total, bounds.events - left.events))
    }

    /// Prepares the block; false when it has too many nodes.
    fn load(
        &mut self,
        cluster: &Cluster,
        (blocks, block): (&mut Blocks, usize),
        is_watched: &[bool],
    ) -> bool {
        let top = blocks.top_of(block);
        let edges = blocks.edges_of_mut(block);
        edges.sort_unstable();
        self.clear(cluster.vertices());
        let counts = self.number_vertices(cluster, edges);
        // Elements are the larger side; of equals the tracks.
        let side = usize::from(counts[1] > counts[0]);
        edges.sort_unstable_by_key(|&edge| {
            (self.number_of[cluster.ends_of(edge)[side] as usize], edge)
        });
        self.ends.resize(counts[side] as usize, 0);
        for &edge in edges.iter() {
            let ends = cluster.ends_of(edge);
            let [element, node] = [ends[side], ends[1 - side]].map(|end| end as usize);
            let (element, node) = (self.number_of[element], self.number_of[node]);
            self.pairs.push(Pair { edge, node });
            self.ends[element as usize] = self.pairs.len() as u32;
        }
        for &edge in edges.iter() {
            let ends = cluster.ends_of(edge);
            self.note(ends[side], true, top, is_watched);
            self.note(ends[1 - side], false, top, is_watched);
        }
        self.nodes = counts[1 - side];
        self.is_taken.resize(self.ends.len(), false);
        if self.nodes > MAX_NODES {
            return false;
        }
        if self.event_of.len() < 1 << self.nodes {
            self.event_of.resize(1 << self.nodes, NONE);
        }
        true
    }

    fn clear(&mut self, vertices: usize) {
        self.pairs.clear();
        self.ends.clear();
        self.watched_elements.clear();
        self.watched_nodes.clear();
        self.top = Top::Nowhere;
        self.is_taken.clear();
        self.events.clear();
        self.total = Split::default();
        if self.number_of.len() < vertices {
            self.number_of.resize(vertices, NONE);
        }
    }

    /// Numbers tracks and detections of the block, each from 0, and counts them.
    fn number_vertices(&mut self, cluster: &Cluster, edges: &[u32]) -> [u32; 2] {
        let mut counts = [0; 2];
        for &edge in edges {
            for (end, count) in cluster.ends_of(edge).into_iter().zip(&mut counts) {
                let number = &mut self.number_of[end as usize];
                if *number == NONE {
                    *number = *count;
                    *count += 1;
                }
            }
        }
        counts
    }

    /// Notes what is wanted of a vertex, once, and forgets its number.
    fn note(&mut self, vertex: u32, is_element: bool, top: u32, is_watched: &[bool]) {
        let number = std::mem::replace(&mut self.number_of[vertex as usize], NONE);
        if number == NONE {
            return;
        }
        if vertex == top {
            self.top = if is_element {
                Top::Element(number)
            } else {
                Top::Node(number)
            };
        } else if is_watched[vertex as usize] {
            let watched = Watched { vertex, number };
            if is_element {
                self.watched_elements.push(watched);
            } else {
                self.watched_nodes.push(watched);
            }
        }
    }

    /// Step 1 for the events of one D, and for all that grow from them by elements from `next` on; false when they are more
    /// than allowed.
    fn visit(
        &mut self,
        cluster: &Cluster,
        sums: &mut Sums<T>,
        events: Range<usize>,
        next: usize,
        bounds: &mut Bounds,
    ) -> bool {
        self.count(events.clone(), sums);
        if self.events[events.start].used.count_ones() == self.nodes {
            return true;
        }
        for element in next..self.ends.len() {
            let first = self.events.len();
            self.grow(cluster, &sums.weight, events.clone(), element);
            let grown = self.events.len() - first;
            let Some(left) = bounds.events.checked_sub(grown as u64) else {
                return false;
            };
            bounds.events = left;
            let work = events.len() * self.pairs_of(element).len() + 1;
            if bounds.watch.stops_after(work as u64) {
                return false;
            }
            if grown > 0 {
                self.is_taken[element] = true;
                if !self.visit(cluster, sums, first..first + grown, element + 1, bounds) {
                    return false;
                }
                self.is_taken[element] = false;
                self.give_back(first, &mut sums.with);
            }
        }
        true
    }

    fn pairs_of(&self, element: usize) -> Range<usize> {
        let start = if element == 0 {
            0
        } else {
            self.ends[element - 1]
        };
        start as usize..self.ends[element] as usize
    }

    /// Adds the events with one element more, each the best of those with the same nodes.
    fn grow(&mut self, cluster: &Cluster, weight: &[T], events: Range<usize>, element: usize) {
        let first = self.events.len();
        for from in events {
            let Event {
                used,
                log_weight,
                weight: before,
                ..
            } = self.events[from];
            for pair in self.pairs_of(element) {
                let Pair { edge, node } = self.pairs[pair];
                if used & (1 << node) != 0 {
                    continue;
                }
                let grown = Event {
                    used: used | (1 << node),
                    edge,
                    grown_from: from as u32,
                    log_weight: log_weight + cluster.log_ratio[edge as usize],
                    weight: before * weight[edge as usize],
                    mass: Split::default(),
                };
                let place = &mut self.event_of[grown.used as usize];
                if *place == NONE {
                    *place = self.events.len() as u32;
                    self.events.push(grown);
                } else if grown.log_weight > self.events[*place as usize].log_weight {
                    self.events[*place as usize] = grown;
                }
            }
        }
        for event in &self.events[first..] {
            self.event_of[event.used as usize] = NONE;
        }
    }

    /// Counts the events of one D in the sums over all, and over those without a vertex.
    fn count(&mut self, events: Range<usize>, sums: &mut Sums<T>) {
        let mut of_set = Split::default();
        for event in &mut self.events[events] {
            let is_top_used = match self.top {
                Top::Nowhere => false,
                Top::Element(number) => self.is_taken[number as usize],
                Top::Node(number) => event.used & (1 << number) != 0,
            };
            event.mass.0[usize::from(is_top_used)] = event.weight;
            of_set.add(event.mass);
            for node in &self.watched_nodes {
                if event.used & (1 << node.number) == 0 {
                    sums.without[node.vertex as usize].add(event.mass);
                }
            }
        }
        for element in &self.watched_elements {
            if !self.is_taken[element.number as usize] {
                sums.without[element.vertex as usize].add(of_set);
            }
        }
        self.total.add(of_set);
    }

    /// Step 2: takes the last events away again.
    fn give_back(&mut self, first: usize, with: &mut [Split<T>]) {
        while self.events.len() > first
            && let Some(event) = self.events.pop()
        {
            with[event.edge as usize].add(event.mass);
            self.events[event.grown_from as usize].mass.add(event.mass);
        }
    }
}
