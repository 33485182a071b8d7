//! Marginals by belief propagation on the edges of the cluster: exact when the cluster has no cycle, else close.
//!
//! # Reference
//! J. L. Williams, R. A. Lau, Approximate evaluation of marginal association probabilities with belief propagation,
//! IEEE Trans. Aerospace and Electronic Systems 50(4), 2014. The paper proves that the messages converge.
//!
//! # Symbols
//! wᵢⱼ weight of an edge, nᵢ of none, scaled so that the largest of a track is 1; μᵢⱼ message from track to detection,
//! νᵢⱼ message from detection to track.
//!
//! # Method
//! 1. νᵢⱼ = 1.
//! 2. μᵢⱼ = wᵢⱼ / (nᵢ + Σ wᵢₖ νᵢₖ over the track's other detections k).
//! 3. νᵢⱼ = 1 / (1 + Σ μₖⱼ over the detection's other tracks k).
//! 4. Repeat 2 and 3 until no ν changes by more than the tolerance, relative to itself.
//! 5. βᵢⱼ ∝ wᵢⱼ νᵢⱼ, βᵢ₀ ∝ nᵢ.

use super::cluster::{Cluster, Nodes};
use crate::model::watch::Watch;

/// Smallest nᵢ beside a largest weight of 1: below it the messages would leave the range of `f64`.
const SMALLEST_MISSED: f64 = 1e-290;

#[derive(Debug, Clone, Default)]
pub(super) struct BeliefPropagation {
    weight: Vec<f64>,
    missed: Vec<f64>,
    to_detection: Vec<f64>,
    to_track: Vec<f64>,
}

/// How the messages ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Settled {
    pub(super) iterations: u32,
    pub(super) is_converged: bool,
}

impl BeliefPropagation {
    pub(super) fn marginals(
        &mut self,
        cluster: &mut Cluster,
        (tolerance, max_iterations): (f64, u32),
        watch: &Watch,
    ) -> Settled {
        self.scale(cluster);
        let mut settled = Settled {
            iterations: 0,
            is_converged: false,
        };
        // Two messages an edge and round.
        let pieces = 4 * self.weight.len() as u64;
        while settled.iterations < max_iterations
            && !settled.is_converged
            && !watch.stops_after(pieces)
        {
            self.tell_detections(&cluster.tracks);
            settled.is_converged = self.tell_tracks(&cluster.detections) <= tolerance;
            settled.iterations += 1;
        }
        self.conclude(cluster);
        settled
    }

    /// Step 1, and the weights.
    fn scale(&mut self, cluster: &Cluster) {
        self.weight.clear();
        self.missed.clear();
        for track in 0..cluster.tracks.len() {
            let ratios = cluster
                .tracks
                .edges_of(track)
                .iter()
                .map(|&edge| cluster.log_ratio[edge as usize]);
            let top = ratios.clone().fold(0.0, f64::max);
            self.missed.push((-top).exp().max(SMALLEST_MISSED));
            self.weight.extend(ratios.map(|ratio| (ratio - top).exp()));
        }
        self.to_track.clear();
        self.to_track.resize(self.weight.len(), 1.0);
        self.to_detection.clear();
        self.to_detection.resize(self.weight.len(), 0.0);
    }

    /// Step 2.
    fn tell_detections(&mut self, tracks: &Nodes) {
        for track in 0..tracks.len() {
            let edges = tracks.edges_of(track);
            let term = |edge: u32| self.weight[edge as usize] * self.to_track[edge as usize];
            let total = edges
                .iter()
                .fold(self.missed[track], |sum, &edge| sum + term(edge));
            for &edge in edges {
                let rest = sum_without(edge, self.missed[track], total, edges, term);
                self.to_detection[edge as usize] = self.weight[edge as usize] / rest;
            }
        }
    }

    /// Step 3; returns the largest relative change.
    fn tell_tracks(&mut self, detections: &Nodes) -> f64 {
        let mut largest = 0.0f64;
        for detection in 0..detections.len() {
            let edges = detections.edges_of(detection);
            let term = |edge: u32| self.to_detection[edge as usize];
            let total = edges.iter().fold(1.0, |sum, &edge| sum + term(edge));
            for &edge in edges {
                let rest = sum_without(edge, 1.0, total, edges, term);
                let message = &mut self.to_track[edge as usize];
                largest = largest.max((*message * rest - 1.0).abs());
                *message = 1.0 / rest;
            }
        }
        largest
    }

    /// Step 5.
    fn conclude(&self, cluster: &mut Cluster) {
        for track in 0..cluster.tracks.len() {
            let edges = cluster.tracks.edges_of(track);
            let mut total = self.missed[track];
            for &edge in edges {
                let edge = edge as usize;
                cluster.beta[edge] = self.weight[edge] * self.to_track[edge];
                total += cluster.beta[edge];
            }
            for &edge in edges {
                cluster.beta[edge as usize] /= total;
            }
            cluster.missed[track] = self.missed[track] / total;
        }
    }
}

/// first + the terms of all edges but one. Subtracting that one from the total would leave nothing but rounding where it
/// is most of the total; then, which happens at most once a node, the others are summed again.
#[inline]
fn sum_without(edge: u32, first: f64, total: f64, edges: &[u32], term: impl Fn(u32) -> f64) -> f64 {
    let own = term(edge);
    if own <= 0.5 * total {
        total - own
    } else {
        edges
            .iter()
            .filter(|&&other| other != edge)
            .fold(first, |sum, &other| sum + term(other))
    }
}
