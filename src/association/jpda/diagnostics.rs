//! What JPDA did: how many clusters by which algorithm, how large they were, and what an approximation may have cost.

use super::AgainstCoalescence;
use super::belief_propagation::Settled;
use super::cluster::Cluster;
use serde::{Deserialize, Serialize};

/// The largest error of a marginal by belief propagation in the table of `docs/jpda.md`: 24 300 random problems of up to
/// 12 × 12. It was measured, not proved.
const LARGEST_MEASURED_ERROR: f64 = 0.4;

/// The part `association.diagnostics` of a report.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Diagnostics {
    clusters: Clusters,
    /// That with the most edges.
    largest_cluster: Size,
    /// Nodes in the widest frontier of any cluster computed exactly: its tables had two to this power cells.
    largest_frontier: u32,
    caps: Caps,
    approximation: Approximation,
    /// Only where it was asked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    best_permutation: Option<KeptEvents>,
}

/// What `best_permutation` did with clusters of more than one track.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
struct KeptEvents {
    clusters: u64,
    /// Most joint events kept in one cluster.
    most_events: u64,
    /// Clusters with more than `max_states` of them, or with a block too wide: they have the marginals of JPDA, and are
    /// counted among its clusters.
    left_to_jpda: u64,
}

/// Clusters by the algorithm that gave their marginals.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Clusters {
    /// A single track: the closed form.
    pub(super) single: u64,
    pub(super) enumerate: u64,
    pub(super) exact: u64,
    pub(super) belief_propagation: u64,
}

/// How often a cap kept a cluster from an algorithm that was asked for, or that `auto` would have preferred.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Caps {
    /// More than `max_events` joint events.
    pub(super) enumerate: u64,
    /// Tables of more than `max_states` cells, or together more than an exact sum may visit.
    pub(super) exact: u64,
}

#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
struct Size {
    tracks: usize,
    detections: usize,
    edges: usize,
}

#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
struct Approximation {
    /// Clusters by belief propagation that have a cycle; without one it is exact.
    clusters: u64,
    largest_cluster: Size,
    most_iterations: u32,
    /// Clusters whose messages had not settled within the tolerance after the largest number of iterations.
    not_converged: u64,
    /// An estimate of the largest error of a marginal, not a bound: the largest one measured (`docs/jpda.md`). 0 when
    /// every cluster was exact, none when some did not converge.
    estimated_largest_error: Option<f64>,
}

impl Diagnostics {
    pub(super) fn new(against_coalescence: AgainstCoalescence) -> Self {
        let is_star = against_coalescence == AgainstCoalescence::BestPermutation;
        let approximation = Approximation {
            estimated_largest_error: Some(0.0),
            ..Approximation::default()
        };
        Diagnostics {
            approximation,
            best_permutation: is_star.then(KeptEvents::default),
            ..Diagnostics::default()
        }
    }

    pub(super) fn single(&mut self, detections: usize) {
        self.clusters.single += 1;
        self.largest_cluster.grow(Size {
            tracks: 1,
            detections,
            edges: detections,
        });
    }

    pub(super) fn count_enumerated(&mut self, cluster: &Cluster) {
        self.clusters.enumerate += 1;
        self.largest_cluster.grow(Size::from_cluster(cluster));
    }

    pub(super) fn exact(&mut self, cluster: &Cluster, frontier: u32) {
        self.clusters.exact += 1;
        self.largest_frontier = self.largest_frontier.max(frontier);
        self.largest_cluster.grow(Size::from_cluster(cluster));
    }

    /// `kept` are its events; none where they were too many.
    pub(super) fn count_best_permutation(&mut self, cluster: &Cluster, kept: Option<u64>) {
        let counts = self.best_permutation.get_or_insert_default();
        match kept {
            Some(events) => {
                counts.clusters += 1;
                counts.most_events = counts.most_events.max(events);
                self.largest_cluster.grow(Size::from_cluster(cluster));
            }
            None => counts.left_to_jpda += 1,
        }
    }

    pub(super) fn count_propagated(&mut self, cluster: &Cluster, settled: Settled) {
        let size = Size::from_cluster(cluster);
        self.clusters.belief_propagation += 1;
        self.largest_cluster.grow(size);
        let approximation = &mut self.approximation;
        approximation.most_iterations = approximation.most_iterations.max(settled.iterations);
        if size.has_cycle() {
            approximation.clusters += 1;
            approximation.largest_cluster.grow(size);
            approximation.estimated_largest_error = approximation
                .estimated_largest_error
                .map(|_| LARGEST_MEASURED_ERROR);
        }
        if !settled.is_converged {
            approximation.not_converged += 1;
            approximation.estimated_largest_error = None;
        }
    }

    pub(super) fn caps(&mut self) -> &mut Caps {
        &mut self.caps
    }
}

impl Size {
    fn from_cluster(cluster: &Cluster) -> Self {
        Size {
            tracks: cluster.tracks.len(),
            detections: cluster.detections.len(),
            edges: cluster.log_ratio.len(),
        }
    }

    fn grow(&mut self, other: Size) {
        if other.edges > self.edges {
            *self = other;
        }
    }

    /// A connected graph without cycles has one edge less than nodes.
    fn has_cycle(&self) -> bool {
        self.edges >= self.tracks + self.detections
    }
}
