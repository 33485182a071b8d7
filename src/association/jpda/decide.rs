//! NN-JPDA: the probabilities of JPDA, then one detection or none for each track for good. Nothing is averaged in the
//! update, so close tracks are not drawn together.
//!
//! # Reference
//! R. J. Fitzgerald, Development of practical PDA logic for multitarget tracking by microprocessor, Proc. American Control
//! Conference, 1986.
//!
//! # Method
//! 1. Of all ways to give each track of the cluster one detection or none, each detection once, the one with the largest
//!    Σ ln β over the tracks, misses counted with their β₀.
//! 2. Its weights become 1, all others 0.

use crate::association::global_nearest_neighbour;
use crate::association::problem::{Problem, Weights};
use crate::math::assignment::AssignmentSolver;

/// Replaces the probabilities of a cluster.
pub(super) fn decide(solver: &mut AssignmentSolver, problem: &Problem, weights: &mut Weights) {
    global_nearest_neighbour::solve(
        solver,
        problem,
        |edge| cost(weights.edges[edge]),
        |row| cost(weights.missed[row]),
    );
    for (place, (row, state)) in problem.rows().enumerate() {
        weights.edges[state.edges()].fill(0.0);
        weights.missed[row] = 1.0;
        if let Some(edge) = solver.edge_of(place) {
            weights.choose(row, state.first as usize + edge);
        }
    }
}

/// −ln β. What has lost all its digits is as good as impossible, and still finite.
fn cost(probability: f64) -> f64 {
    -probability.max(f64::MIN_POSITIVE).ln()
}
