//! The tracks that links hold together. A problem falls into clusters; each is solved by itself, and the costs add up.
//!
//! # Method
//! A cluster is a connected component of links. Where the cost of a tuple is a sum over links (chain, all pairs) only links of
//! negative cost connect: a tuple that they do not hold together costs no more in the pieces they do hold together. A chain
//! never needs a link of positive cost, so there it does not exist.
//!
//! Tracks have numbers of their own here, in the same order; so have the sensors. A *row* is a tuple by sensor: the track of
//! each sensor, or [`NONE`]. Cost and link are looked up by sensor, so that nothing is stored for tracks that are not linked.

use super::problem::{CorrelationProblem, Costs};
use crate::math::disjoint_sets;

pub(super) const NONE: u32 = u32::MAX;

/// A cost below this is a gain worth having; smaller ones are rounding.
pub(super) const LEAST_GAIN: f64 = 1e-9;

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Edge {
    pub(super) track: u32,
    pub(super) cost: f64,
}

pub(super) struct Cluster<'a> {
    problem: &'a CorrelationProblem,
    /// What the problem calls each track, ascending.
    tracks: Vec<u32>,
    sensor_of: Vec<u32>,
    sensors: usize,
    /// Where the edges of a track to each sensor begin, `sensors + 1` numbers a track.
    places: Vec<u32>,
    edges: Vec<Edge>,
}

/// All clusters of two tracks or more, in the order of their first tracks.
pub(super) fn clusters(problem: &CorrelationProblem) -> Vec<Cluster<'_>> {
    let mut parents = Vec::new();
    disjoint_sets::reset(&mut parents, problem.tracks());
    for track in 0..problem.tracks() as u32 {
        for link in problem
            .links(track)
            .iter()
            .filter(|link| connects(problem, link.cost))
        {
            disjoint_sets::join(&mut parents, track, link.track);
        }
    }
    let roots: Vec<u32> = (0..problem.tracks() as u32)
        .map(|track| disjoint_sets::root(&mut parents, track))
        .collect();
    let mut members: Vec<Vec<u32>> = vec![Vec::new(); problem.tracks()];
    for (track, &root) in roots.iter().enumerate() {
        members[root as usize].push(track as u32);
    }
    let mut local_of = vec![NONE; problem.tracks()];
    members
        .into_iter()
        .filter(|members| members.len() > 1)
        .map(|members| Cluster::new(problem, members, &mut local_of))
        .collect()
}

fn connects(problem: &CorrelationProblem, cost: f64) -> bool {
    cost < 0.0 || matches!(problem.costs, Costs::Joint(_))
}

impl<'a> Cluster<'a> {
    /// `local_of` is as long as the problem has tracks, all [`NONE`], and is left so.
    fn new(problem: &'a CorrelationProblem, tracks: Vec<u32>, local_of: &mut [u32]) -> Self {
        let mut sensor_of: Vec<u32> = tracks
            .iter()
            .map(|&track| problem.sensor_of(track) as u32)
            .collect();
        let mut numbers = sensor_of.clone();
        numbers.dedup();
        for sensor in &mut sensor_of {
            *sensor = numbers.partition_point(|number| number < sensor) as u32;
        }
        for (local, &track) in tracks.iter().enumerate() {
            local_of[track as usize] = local as u32;
        }
        let mut cluster = Cluster {
            problem,
            sensor_of,
            sensors: numbers.len(),
            places: Vec::new(),
            edges: Vec::new(),
            tracks,
        };
        for local in 0..cluster.tracks.len() {
            cluster.add_edges(local, local_of);
        }
        for &track in &cluster.tracks {
            local_of[track as usize] = NONE;
        }
        cluster
    }

    fn add_edges(&mut self, local: usize, local_of: &[u32]) {
        let is_chain = self.is_chain();
        let mut sensor = 0;
        self.places.push(self.edges.len() as u32);
        for link in self.problem.links(self.tracks[local]) {
            let track = local_of[link.track as usize];
            if track == NONE || (is_chain && link.cost >= 0.0) {
                continue;
            }
            while sensor < self.sensor_of[track as usize] {
                self.places.push(self.edges.len() as u32);
                sensor += 1;
            }
            self.edges.push(Edge {
                track,
                cost: link.cost,
            });
        }
        let filled = (local + 1) * (self.sensors + 1);
        self.places.resize(filled, self.edges.len() as u32);
    }

    pub(super) fn is_chain(&self) -> bool {
        matches!(self.problem.costs, Costs::Chain)
    }

    /// Whether the cost of a tuple is the sum over all its pairs.
    pub(super) fn is_pairwise(&self) -> bool {
        matches!(self.problem.costs, Costs::AllPairs)
    }

    pub(super) fn len(&self) -> usize {
        self.tracks.len()
    }

    pub(super) fn sensors(&self) -> usize {
        self.sensors
    }

    pub(super) fn sensor_of(&self, track: u32) -> usize {
        self.sensor_of[track as usize] as usize
    }

    /// What the problem calls a track.
    pub(super) fn name_of(&self, track: u32) -> u32 {
        self.tracks[track as usize]
    }

    /// What the problem calls the members of a tuple.
    pub(super) fn names(&self, tuple: &[u32]) -> Vec<u32> {
        tuple.iter().map(|&track| self.name_of(track)).collect()
    }

    /// Its number here.
    pub(super) fn number_of(&self, name: u32) -> Option<u32> {
        self.tracks
            .binary_search(&name)
            .ok()
            .map(|track| track as u32)
    }

    /// The name of a cluster's random choices: its first track.
    pub(super) fn name(&self) -> u64 {
        u64::from(self.tracks[0])
    }

    /// What a track is linked with, ascending.
    pub(super) fn edges(&self, track: u32) -> &[Edge] {
        let first = track as usize * (self.sensors + 1);
        &self.edges[self.places[first] as usize..self.places[first + self.sensors] as usize]
    }

    /// What a track is linked with in one sensor, ascending.
    #[inline]
    pub(super) fn edges_to(&self, track: u32, sensor: usize) -> &[Edge] {
        let place = track as usize * (self.sensors + 1) + sensor;
        &self.edges[self.places[place] as usize..self.places[place + 1] as usize]
    }

    #[inline]
    pub(super) fn link(&self, a: u32, b: u32) -> Option<f64> {
        self.edges_to(a, self.sensor_of(b))
            .iter()
            .find(|edge| edge.track == b)
            .map(|edge| edge.cost)
    }

    /// The cost of a row, or of a tuple, which is a row without gaps; infinite where it does not exist. A chain is cut where a link is
    /// missing.
    #[inline]
    pub(super) fn cost(&self, row: &[u32]) -> f64 {
        match &self.problem.costs {
            Costs::Chain => self.cost_of_chain(row),
            Costs::AllPairs => self.cost_of_pairs(row),
            Costs::Joint(_) => self.cost_of_all(row),
        }
    }

    #[inline]
    fn cost_of_chain(&self, row: &[u32]) -> f64 {
        let mut sum = 0.0;
        let mut before = NONE;
        for &track in row.iter().filter(|&&track| track != NONE) {
            if before != NONE {
                sum += self.link(before, track).unwrap_or(0.0);
            }
            before = track;
        }
        sum
    }

    #[inline]
    fn cost_of_pairs(&self, row: &[u32]) -> f64 {
        let mut sum = 0.0;
        for (sensor, &track) in row.iter().enumerate().filter(|&(_, &track)| track != NONE) {
            for &other in row[sensor + 1..].iter().filter(|&&other| other != NONE) {
                let Some(cost) = self.link(track, other) else {
                    return f64::INFINITY;
                };
                sum += cost;
            }
        }
        sum
    }

    fn cost_of_all(&self, row: &[u32]) -> f64 {
        if self.cost_of_pairs(row) == f64::INFINITY {
            return f64::INFINITY;
        }
        let tuple: Vec<u32> = row
            .iter()
            .filter(|&&track| track != NONE)
            .map(|&track| self.name_of(track))
            .collect();
        match &self.problem.costs {
            Costs::Joint(joint) if tuple.len() > 1 => joint.cost(&tuple),
            _ => 0.0,
        }
    }

    /// For each track and sensor the costs of the track's best links to that sensor and those behind it, summed; a sensor without a
    /// link of negative cost counts 0. `sensors + 1` numbers a track.
    pub(super) fn best_links(&self) -> Vec<f64> {
        let mut sums = vec![0.0; self.len() * (self.sensors + 1)];
        for (track, sums) in sums.chunks_exact_mut(self.sensors + 1).enumerate() {
            for sensor in (0..self.sensors).rev() {
                let edges = self.edges_to(track as u32, sensor).iter();
                sums[sensor] =
                    sums[sensor + 1] + edges.fold(0.0, |least: f64, edge| least.min(edge.cost));
            }
        }
        sums
    }

    /// What no solution undercuts, at first sight: each track has one partner of each sensor at most (all pairs), one
    /// before and one after it (chain). Nothing is known of joint costs.
    pub(super) fn least_cost(&self) -> f64 {
        match &self.problem.costs {
            Costs::Chain => self
                .sum_of_least(|track, sensor| sensor > self.sensor_of(track), f64::min)
                .max(self.sum_of_least(|track, sensor| sensor < self.sensor_of(track), f64::min)),
            Costs::AllPairs => 0.5 * self.sum_of_least(|_, _| true, |sum, least| sum + least),
            Costs::Joint(_) => f64::NEG_INFINITY,
        }
    }

    fn sum_of_least(&self, counts: impl Fn(u32, usize) -> bool, add: fn(f64, f64) -> f64) -> f64 {
        let of_track = |track| {
            (0..self.sensors)
                .filter(|&sensor| counts(track, sensor))
                .map(|sensor| self.least_edge(track, sensor))
                .fold(0.0, add)
        };
        (0..self.len() as u32).map(of_track).sum()
    }

    /// Of the edges of a track to a sensor; 0 where all cost something.
    fn least_edge(&self, track: u32, sensor: usize) -> f64 {
        let edges = self.edges_to(track, sensor).iter();
        edges.fold(0.0, |least: f64, edge| least.min(edge.cost))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_links_worth_having_hold_a_cluster_together() {
        let pairs = [
            (0, 2, -3.0),
            (1, 3, -1.0),
            (0, 3, 5.0),
            (2, 4, -2.0),
            (0, 4, 1.0),
        ];
        let problem = CorrelationProblem::new(&[2, 2, 1], &pairs, Costs::AllPairs);
        let found = clusters(&problem);
        let names = |cluster: &Cluster| {
            (0..cluster.len() as u32)
                .map(|track| cluster.name_of(track))
                .collect::<Vec<_>>()
        };
        assert_eq!(
            found.iter().map(names).collect::<Vec<_>>(),
            [vec![0, 2, 4], vec![1, 3]]
        );
        assert_eq!(found[0].cost(&[0, 1, 2]), -4.0);
        assert_eq!(
            (found[0].link(0, 2), found[1].sensors(), found[1].link(0, 1)),
            (Some(1.0), 2, Some(-1.0))
        );
        // Half of −3, −3 − 2 and −2: the link of 0 and 4 is dear.
        assert_eq!(found[0].least_cost(), -5.0);
    }

    #[test]
    fn a_chain_is_cut_where_a_link_is_missing() {
        let problem = CorrelationProblem::new(
            &[1, 1, 1, 1],
            &[(0, 1, -3.0), (1, 2, 2.0), (2, 3, -1.0), (0, 3, -1.0)],
            Costs::Chain,
        );
        let found = clusters(&problem);
        assert_eq!(
            (
                found.len(),
                found[0].link(1, 2),
                found[0].cost(&[0, 1, 2, 3])
            ),
            (1, None, -4.0)
        );
        // Forward 0 → 1 and 2 → 3; backward the same.
        assert_eq!(found[0].least_cost(), -4.0);
    }
}
