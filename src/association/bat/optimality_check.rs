//! How close the swarm came: every search is compared with the optimum of the same objective by linear assignment, which
//! costs a small part of the search.

use super::super::problem::Problem;
use super::cluster::Cluster;
use super::swarm::Swarm;
use super::visited::Visited;
use crate::math::assignment::AssignmentSolver;
use serde::{Deserialize, Serialize};
use std::fmt::Write;

/// Objectives this close, relative to the optimum, are equal: two sums of the same terms in another order.
const EQUAL: f64 = 1e-12;

#[derive(Debug, Clone, Default)]
pub(super) struct OptimalityCheck {
    solver: AssignmentSolver,
    counts: Counts,
}

/// What all searches came to.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Counts {
    clusters: Clusters,
    evaluations: u64,
    reached: u64,
    sum_of_gaps: f64,
    largest_gap: f64,
    visited_events: u64,
}

#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
struct Clusters {
    /// A single track: the closed form.
    single: u64,
    /// By the swarm.
    searched: u64,
}

/// The part `association.diagnostics` of a report.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct BatDiagnostics {
    clusters: Clusters,
    /// Objectives computed: one a bat, a neighbour, and an edge of a single track.
    evaluations: u64,
    optimum: Optimum,
    /// Distinct assignments that made up the weights, over all searches.
    #[serde(skip_serializing_if = "Option::is_none")]
    visited_events: Option<u64>,
}

/// Of the searched clusters; none without any.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
struct Optimum {
    reached: u64,
    share_reached: Option<f64>,
    /// See [`gap`].
    mean_gap: Option<f64>,
    largest_gap: Option<f64>,
}

impl OptimalityCheck {
    pub(super) fn counts(&self) -> Counts {
        self.counts
    }

    pub(super) fn set_counts(&mut self, counts: Counts) {
        self.counts = counts;
    }

    /// J of the best assignment.
    pub(super) fn optimum(&mut self, cluster: &Cluster) -> f64 {
        self.solver.clear();
        for row in 0..cluster.row_count() {
            for code in cluster.codes_of(row).map(|code| cluster.code(code)) {
                self.solver.push_edge(code.detection, -code.gain);
            }
            self.solver.end_row(0.0);
        }
        let is_solved = self.solver.solve().is_some();
        debug_assert!(
            is_solved,
            "a cluster in which every track may miss has an assignment"
        );
        let taken = |row: usize| {
            self.solver.edge_of(row).map_or(cluster.missed(), |place| {
                cluster.codes_of(row).start + place as u32
            })
        };
        (0..cluster.row_count())
            .map(|row| cluster.code(taken(row)).gain)
            .sum()
    }

    pub(super) fn count_single(&mut self, candidates: usize) {
        self.counts.clusters.single += 1;
        self.counts.evaluations += candidates as u64;
    }

    pub(super) fn count_search(&mut self, swarm: &Swarm, optimum: f64, visited: Option<&Visited>) {
        self.counts.clusters.searched += 1;
        self.counts.evaluations += swarm.evaluations();
        let gap = gap(swarm.best_value(), optimum);
        self.counts.reached += u64::from(gap == 0.0);
        self.counts.sum_of_gaps += gap;
        self.counts.largest_gap = self.counts.largest_gap.max(gap);
        self.counts.visited_events += visited.map_or(0, Visited::events);
    }

    pub(super) fn diagnostics(&self, is_soft: bool) -> BatDiagnostics {
        let searched = self.counts.clusters.searched as f64;
        let share = |sum: f64| (searched > 0.0).then_some(sum / searched);
        let optimum = Optimum {
            reached: self.counts.reached,
            share_reached: share(self.counts.reached as f64),
            mean_gap: share(self.counts.sum_of_gaps),
            largest_gap: share(searched * self.counts.largest_gap),
        };
        let visited_events = is_soft.then_some(self.counts.visited_events);
        BatDiagnostics {
            clusters: self.counts.clusters,
            evaluations: self.counts.evaluations,
            optimum,
            visited_events,
        }
    }
}

/// What an objective lacks: (J* − J) / J*, with 1 for a J* below 1. A sum of likelihoods never is below 1, for it counts in
/// multiples of the largest.
pub(super) fn gap(value: f64, optimum: f64) -> f64 {
    let lack = (optimum - value) / optimum.max(1.0);
    if lack <= EQUAL { 0.0 } else { lack }
}

/// The detections of an assignment as the paper writes them: numbered from 1 in their scan, 0 for none and for what is
/// outside the gate, divided by spaces.
pub(super) fn assignment(problem: &Problem, cluster: &Cluster, entries: &[u32]) -> String {
    let mut text = String::new();
    for (place, ((_, row), &code)) in problem.rows().zip(entries).enumerate() {
        let is_edge = (code as usize) < cluster.edges();
        let edge = || row.first as usize + (code - cluster.codes_of(place).start) as usize;
        let number = if is_edge {
            problem.edge(edge()).detection + 1
        } else {
            0
        };
        let space = if place == 0 { "" } else { " " };
        write!(text, "{space}{number}").expect("a string takes all text");
    }
    text
}
