//! A chain is one assignment: each track has at most one successor, a linked track of a later sensor, and is the successor
//! of at most one. Whatever is so chosen falls into chains with one track of a sensor each, and J is the sum of the links.
//!
//! # Method
//! Rows are the tracks as predecessors, columns the tracks as successors, edges the links of negative cost; having no
//! successor costs 0 ([`crate::math::assignment`]). The duals of the assignment certify J.

use super::problem::CorrelationProblem;
use crate::math::assignment::AssignmentSolver;

/// The tuples of least cost, and what no solution undercuts.
pub(super) fn cheapest_chains(problem: &CorrelationProblem) -> (Vec<Vec<u32>>, f64) {
    let mut solver = AssignmentSolver::default();
    solver.clear();
    for track in 0..problem.tracks() as u32 {
        // Links ascend, and tracks of later sensors have larger numbers.
        for link in problem
            .links(track)
            .iter()
            .filter(|link| link.track > track && link.cost < 0.0)
        {
            solver.push_edge(link.track, link.cost);
        }
        solver.end_row(0.0);
    }
    let bound = solver
        .solve()
        .map(|_| sum_of_duals(&solver, problem.tracks()))
        .unwrap_or_default();
    let mut tuple_of = vec![usize::MAX; problem.tracks()];
    let mut tuples: Vec<Vec<u32>> = Vec::new();
    for track in 0..problem.tracks() {
        if tuple_of[track] == usize::MAX {
            tuple_of[track] = tuples.len();
            tuples.push(Vec::new());
        }
        tuples[tuple_of[track]].push(track as u32);
        if let Some(next) = solver.column_of(track) {
            tuple_of[next as usize] = tuple_of[track];
        }
    }
    (tuples, bound)
}

fn sum_of_duals(solver: &AssignmentSolver, tracks: usize) -> f64 {
    (0..tracks)
        .map(|track| solver.row_dual(track) + solver.column_dual(track as u32))
        .sum()
}
