//! The distinct assignments that the swarm looked at, each weighed as a joint event: their sums are association weights
//! as JPDA's, exact when every event was looked at.
//!
//! # Method
//! 1. An assignment is known by the exclusive or of 64-bit keys, one for each of its edges, kept in an open table. Among a million
//!    assignments two share a hash with a probability below 10⁻⁷.
//! 2. When it is new, its weight Π (weight of the edge ÷ weight of none), by its logarithm, is added to each of its choices.
//!    All sums are multiples of the largest weight so far, so that none leaves the range of numbers.

use super::super::problem::{Problem, Weights};
use super::cluster::{Cluster, Move, NOBODY};

#[derive(Debug, Clone, Default)]
pub(super) struct Visited {
    /// Hashes, 0 where there is none; a power of two of them.
    slots: Vec<u64>,
    /// The slots that are filled.
    filled: Vec<u32>,
    /// The logarithm of the weight that counts 1.
    log_unit: f64,
    /// Sum over the assignments that hold each edge.
    edge_mass: Vec<f64>,
    /// Sum over the assignments in which each row has none.
    missed_mass: Vec<f64>,
}

/// Slots of the first table.
const FIRST_SLOTS: usize = 1024;

/// Hash of the assignment without an edge; not 0, which marks a slot as free.
const EMPTY_HASH: u64 = 0x5851_f42d_4c95_7f2d;

impl Visited {
    /// Forgets the cluster before.
    pub(super) fn begin(&mut self, cluster: &Cluster) {
        if self.slots.is_empty() {
            self.slots.resize(FIRST_SLOTS, 0);
        }
        for slot in self.filled.drain(..) {
            self.slots[slot as usize] = 0;
        }
        self.log_unit = f64::NEG_INFINITY;
        self.edge_mass.clear();
        self.edge_mass.resize(cluster.edges(), 0.0);
        self.missed_mass.clear();
        self.missed_mass.resize(cluster.row_count(), 0.0);
    }

    /// Distinct assignments seen.
    pub(super) fn events(&self) -> u64 {
        self.filled.len() as u64
    }

    /// Counts an assignment that has this hash.
    pub(super) fn see(&mut self, cluster: &Cluster, entries: &[u32], hash: u64) {
        if self.is_new(hash) {
            self.add(cluster, entries.iter().copied());
        }
    }

    /// Counts the neighbour that is a step away from an assignment.
    #[inline]
    pub(super) fn see_neighbour(
        &mut self,
        cluster: &Cluster,
        entries: &[u32],
        hash: u64,
        step: &Move,
    ) {
        let old = cluster.code(entries[step.row as usize]);
        let mut hash = hash ^ old.key ^ cluster.code(step.code).key;
        if step.other != NOBODY {
            let old = cluster.code(entries[step.other as usize]);
            hash ^= old.key ^ cluster.code(step.other_code).key;
        }
        if self.is_new(hash) {
            let after = |(row, &code): (usize, &u32)| match row as u32 {
                row if row == step.row => step.code,
                row if row == step.other => step.other_code,
                _ => code,
            };
            self.add(cluster, entries.iter().enumerate().map(after));
        }
    }

    /// Counts everything that a single row can have.
    pub(super) fn see_all_of_one(&mut self, cluster: &Cluster) {
        self.begin(cluster);
        for code in cluster.codes_of(0).chain([cluster.missed()]) {
            self.see(cluster, &[code], cluster.code(code).key);
        }
    }

    /// Remembers a hash; whether it was unknown.
    #[inline]
    fn is_new(&mut self, hash: u64) -> bool {
        let hash = (hash ^ EMPTY_HASH).max(1);
        let slot = self.slot_of(hash);
        if self.slots[slot] == hash {
            return false;
        }
        self.slots[slot] = hash;
        self.filled.push(slot as u32);
        if 2 * self.filled.len() > self.slots.len() {
            self.grow();
        }
        true
    }

    /// Where a hash is, or would be.
    #[inline]
    fn slot_of(&self, hash: u64) -> usize {
        let mask = self.slots.len() - 1;
        let mut slot = hash as usize & mask;
        while self.slots[slot] != 0 && self.slots[slot] != hash {
            slot = (slot + 1) & mask;
        }
        slot
    }

    fn grow(&mut self) {
        let larger = vec![0; 2 * self.slots.len()];
        let smaller = std::mem::replace(&mut self.slots, larger);
        for place in 0..self.filled.len() {
            let hash = smaller[self.filled[place] as usize];
            let slot = self.slot_of(hash);
            self.slots[slot] = hash;
            self.filled[place] = slot as u32;
        }
    }

    /// Step 2.
    fn add(&mut self, cluster: &Cluster, entries: impl Iterator<Item = u32> + Clone) {
        let log_weight: f64 = entries
            .clone()
            .map(|code| cluster.code(code).log_ratio)
            .sum();
        if log_weight > self.log_unit {
            let factor = (self.log_unit - log_weight).exp();
            self.edge_mass
                .iter_mut()
                .chain(&mut self.missed_mass)
                .for_each(|mass| *mass *= factor);
            self.log_unit = log_weight;
        }
        let weight = (log_weight - self.log_unit).exp();
        for (code, missed) in entries.zip(&mut self.missed_mass) {
            // Everything behind the edges is a detection outside the gate, which counts as none, or none.
            *self.edge_mass.get_mut(code as usize).unwrap_or(missed) += weight;
        }
    }

    /// Writes the sums, each row's scaled to sum to 1, to the weights of the scan.
    pub(super) fn store(&self, cluster: &Cluster, problem: &Problem, weights: &mut Weights) {
        for (place, (index, row)) in problem.rows().enumerate() {
            let codes = cluster.codes_of(place);
            let masses = &self.edge_mass[codes.start as usize..codes.end as usize];
            let total = self.missed_mass[place] + masses.iter().sum::<f64>();
            for (edge, mass) in row.edges().zip(masses) {
                weights.edges[edge] = mass / total;
            }
            weights.missed[index] = self.missed_mass[place] / total;
        }
    }
}
