//! The sum over joint events as the papers write it: every event of the cluster in turn, depth first.
//!
//! # Reference
//! T. E. Fortmann, Y. Bar-Shalom, M. Scheffe, Sonar tracking of multiple targets using joint probabilistic data
//! association, IEEE J. Oceanic Engineering 8(3), 1983.
//!
//! # Method
//! 1. The first track takes none or one of its detections, the second none or one of those still free, and so on.
//! 2. An event weighs the product of its choices; all events that share a choice add to that choice's marginal.
//! 3. Divide by the sum over all events.

use super::cluster::Cluster;
use super::number::{Number, Wide};

/// Clusters of more tracks are not listed at all: the search is as deep as there are tracks.
const MAX_TRACKS: usize = 1000;

#[derive(Debug, Clone, Default)]
pub(super) struct Enumerate {
    ordinary: EventSearch<f64>,
    extreme: EventSearch<Wide>,
}

#[derive(Debug, Clone, Default)]
struct EventSearch<T> {
    weight: Vec<T>,
    /// Sum over the events that hold each edge.
    mass: Vec<T>,
    /// Sum over the events in which each track has none.
    missed: Vec<T>,
    used: Vec<bool>,
    events_left: u64,
}

impl Enumerate {
    /// Writes the marginals; false, and nothing written, when there are more than `max_events` joint events.
    pub(super) fn marginals(&mut self, cluster: &mut Cluster, max_events: u64) -> bool {
        if cluster.tracks.len() > MAX_TRACKS {
            return false;
        }
        if cluster.is_narrow() {
            self.ordinary.run(cluster, max_events)
        } else {
            self.extreme.run(cluster, max_events)
        }
    }
}

impl<T: Number> EventSearch<T> {
    fn run(&mut self, cluster: &mut Cluster, max_events: u64) -> bool {
        self.weight.clear();
        self.weight
            .extend(cluster.log_ratio.iter().map(|&logarithm| T::exp(logarithm)));
        self.mass.clear();
        self.mass.resize(self.weight.len(), T::default());
        self.missed.clear();
        self.missed.resize(cluster.tracks.len(), T::default());
        self.used.clear();
        self.used.resize(cluster.detections.len(), false);
        self.events_left = max_events;
        let Some(total) = self.visit(cluster, 0, T::ONE) else {
            return false;
        };
        for (beta, mass) in cluster.beta.iter_mut().zip(&self.mass) {
            *beta = mass.share_of(total);
        }
        for (missed, mass) in cluster.missed.iter_mut().zip(&self.missed) {
            *missed = mass.share_of(total);
        }
        true
    }

    /// The sum over all choices of the tracks from `track` on, the earlier ones having chosen with product `chosen`.
    fn visit(&mut self, cluster: &Cluster, track: usize, chosen: T) -> Option<T> {
        if track == cluster.tracks.len() {
            self.events_left = self.events_left.checked_sub(1)?;
            return Some(T::ONE);
        }
        let mut total = self.visit(cluster, track + 1, chosen)?;
        self.missed[track] = self.missed[track] + chosen * total;
        for &edge in cluster.tracks.edges_of(track) {
            let detection = cluster.detection_of(edge);
            if !self.used[detection] {
                self.used[detection] = true;
                let weight = self.weight[edge as usize];
                let rest = weight * self.visit(cluster, track + 1, chosen * weight)?;
                self.used[detection] = false;
                self.mass[edge as usize] = self.mass[edge as usize] + chosen * rest;
                total = total + rest;
            }
        }
        Some(total)
    }
}
