//! The improved coding: an individual is a partition of one cluster into tuples, at rest under local search.
//!
//! # Method
//! - The first individuals are the answers of others, if there are; the rest begin with every track alone, or in large clusters, for
//!   which that takes long, as one of those answers after many mutations, if a relaxation has made them. All are
//!   improved ([`crate::correlation::improve`]), the tracks in random order.
//! - Crossover takes over whole tuples. From a random track on, by links, a random number of tuples of the one parent is
//!   gathered; they replace, in a copy of the other, the tuples that their tracks were in. What is left of those stays
//!   together. The child is improved around them.
//! - Mutation breaks the tuples of two linked tracks up and improves around them.

use super::evolve::Coding;
use crate::correlation::cluster::{Cluster, NONE};
use crate::correlation::improve::Improver;
use crate::correlation::partition::Partition;
use rand::RngExt;
use rand::rngs::Xoshiro256PlusPlus;
use rand::seq::SliceRandom;

/// Tracks of a cluster in which individuals begin with every track alone, though there are answers of others.
const MAX_FROM_NOTHING: usize = 100;

/// In a larger one there is one mutation of a first individual for so many tracks.
const TRACKS_A_MUTATION: usize = 100;

pub(super) struct Partitions<'a> {
    cluster: &'a Cluster<'a>,
    seeds: Vec<Partition>,
    is_bounded: bool,
    improver: Improver,
    region: Region,
    row: Vec<u32>,
    /// Evaluations of the improver before this cluster.
    before: u64,
}

/// Rows of one parent that links hold together.
#[derive(Debug, Default)]
struct Region {
    rows: Vec<u32>,
    is_in: Vec<bool>,
}

impl<'a> Partitions<'a> {
    /// `seeds` at rest under local search, of which a relaxation knows how good they are, if they are bounded.
    pub(super) fn new(
        cluster: &'a Cluster,
        seeds: Vec<Partition>,
        is_bounded: bool,
        mut improver: Improver,
    ) -> Self {
        improver.begin(cluster);
        let before = improver.evaluations;
        Partitions {
            cluster,
            seeds,
            is_bounded,
            improver,
            region: Region::default(),
            row: Vec::new(),
            before,
        }
    }

    /// From now on individuals begin without the answers of others.
    pub(super) fn forget_seeds(&mut self) {
        self.seeds.clear();
    }

    pub(super) fn into_improver(self) -> Improver {
        self.improver
    }

    /// Notes tracks in random order and improves.
    fn improve(
        &mut self,
        tracks: &mut [u32],
        partition: &mut Partition,
        rng: &mut Xoshiro256PlusPlus,
    ) {
        tracks.shuffle(rng);
        tracks.iter().for_each(|&track| self.improver.note(track));
        self.improver.improve(self.cluster, partition);
    }

    /// Puts the rows of the region into a child of the other parent.
    fn graft(&mut self, parent: &Partition, child: &mut Partition) {
        for index in 0..self.region.rows.len() {
            let row = parent.row(self.region.rows[index]);
            if row
                .iter()
                .find(|&&track| track != NONE)
                .is_some_and(|&track| child.row(child.row_of(track)) == row)
            {
                continue;
            }
            for sensor in 0..row.len() {
                if row[sensor] != NONE {
                    self.take_out(child, row, child.row_of(row[sensor]));
                }
            }
            child.add(self.cluster, row);
            row.iter()
                .filter(|&&track| track != NONE)
                .for_each(|&track| self.improver.note(track));
        }
    }

    /// Takes the tracks of `row` out of a row of the child; those that stay behind are noted.
    fn take_out(&mut self, child: &mut Partition, row: &[u32], from: u32) {
        self.row.clear();
        self.row.extend(
            child
                .row(from)
                .iter()
                .zip(row)
                .map(|(&track, &taken)| if track == taken { NONE } else { track }),
        );
        if self.row == child.row(from) {
            return;
        }
        child.clear(from);
        child.add(self.cluster, &self.row);
        self.row
            .iter()
            .filter(|&&track| track != NONE)
            .for_each(|&track| self.improver.note(track));
    }
}

impl Region {
    /// From a random track on, a random number of rows.
    fn gather(&mut self, cluster: &Cluster, partition: &Partition, rng: &mut Xoshiro256PlusPlus) {
        self.rows.clear();
        self.is_in.clear();
        self.is_in.resize(cluster.len(), false);
        let size = rng.random_range(1..=cluster.len().div_ceil(cluster.sensors()).max(2));
        self.take(partition.row_of(rng.random_range(0..cluster.len() as u32)));
        let mut next = 0;
        while next < self.rows.len() && self.rows.len() < size {
            for &track in partition
                .row(self.rows[next])
                .iter()
                .filter(|&&track| track != NONE)
            {
                cluster
                    .edges(track)
                    .iter()
                    .filter(|edge| edge.cost < 0.0)
                    .for_each(|edge| self.take(partition.row_of(edge.track)));
            }
            next += 1;
        }
        self.rows.truncate(size);
    }

    fn take(&mut self, row: u32) {
        if !std::mem::replace(&mut self.is_in[row as usize], true) {
            self.rows.push(row);
        }
    }
}

impl Coding for Partitions<'_> {
    type Individual = Partition;

    fn create(&mut self, number: usize, rng: &mut Xoshiro256PlusPlus) -> Partition {
        if let Some(seed) = self.seeds.get(number) {
            return seed.clone();
        }
        if self.is_bounded && !self.seeds.is_empty() && self.cluster.len() > MAX_FROM_NOTHING {
            let mut partition = self.seeds[number % self.seeds.len()].clone();
            (0..self.cluster.len() / TRACKS_A_MUTATION)
                .for_each(|_| self.mutate(&mut partition, rng));
            return partition;
        }
        let mut partition = Partition::singles(self.cluster);
        let mut tracks: Vec<u32> = (0..self.cluster.len() as u32).collect();
        self.improve(&mut tracks, &mut partition, rng);
        partition
    }

    fn cross(&mut self, left: &mut Partition, right: &mut Partition, rng: &mut Xoshiro256PlusPlus) {
        let parents = [left.clone(), right.clone()];
        for (child, parent) in [(right, &parents[0]), (left, &parents[1])] {
            let mut region = std::mem::take(&mut self.region);
            region.gather(self.cluster, parent, rng);
            self.region = region;
            self.graft(parent, child);
            self.improver.improve(self.cluster, child);
        }
    }

    fn mutate(&mut self, partition: &mut Partition, rng: &mut Xoshiro256PlusPlus) {
        let track = rng.random_range(0..self.cluster.len() as u32);
        let edges = self.cluster.edges(track);
        let other = edges[rng.random_range(0..edges.len())].track;
        let mut tracks = Vec::new();
        for number in [partition.row_of(track), partition.row_of(other)] {
            tracks.extend(
                partition
                    .row(number)
                    .iter()
                    .copied()
                    .filter(|&track| track != NONE),
            );
            partition.clear(number);
        }
        for &track in &tracks {
            self.row.clear();
            self.row.resize(self.cluster.sensors(), NONE);
            self.row[self.cluster.sensor_of(track)] = track;
            partition.add(self.cluster, &self.row);
        }
        self.improve(&mut tracks, partition, rng);
    }

    fn cost(&mut self, partition: &mut Partition) -> f64 {
        partition.cost()
    }

    fn evaluations(&self) -> u64 {
        self.improver.evaluations - self.before
    }
}
