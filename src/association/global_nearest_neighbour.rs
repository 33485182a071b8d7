//! Global nearest neighbour: of all ways to give each track of a cluster one detection or none, each detection to one
//! track at most, the most probable one. Unlike nearest neighbour, a track gives its detection up when that makes the whole
//! more probable, and it takes none when clutter and a missed detection explain the scan better.
//!
//! # Reference
//! S. Blackman, R. Popoli, Design and Analysis of Modern Tracking Systems, 1999, section 6.4; for the cost of a miss
//! Y. Bar-Shalom, X.-R. Li, Multitarget-Multisensor Tracking, 1995, section 6.2 (the probability of a joint event).
//!
//! # Symbols
//! P_D, P_G probability of detection and of the gate; λ clutter density; N(ν; 0, S) density of an innovation.
//!
//! # Method
//! A joint event has the probability ∏ P_D N(νᵢⱼ; 0, Sᵢ) / λ over its pairs times ∏ (1 − P_D P_G) over its tracks without
//! a detection, up to a factor that all events share (detections that no track takes are clutter of density λ).
//! 1. cᵢⱼ = −ln(P_D N(νᵢⱼ; 0, Sᵢ) / λ) for a pair in the gate, mᵢ = −ln(1 − P_D P_G) for a miss.
//! 2. Assign at least total cost ([`crate::math::assignment`]).

use super::problem::{Problem, Row, Weights};
use super::{Associator, BuildAssociator};
use crate::math::assignment::AssignmentSolver;
use crate::registry::{Method, Object};

pub const METHOD: Method<BuildAssociator> = Method {
    name: "global_nearest_neighbour",
    parameters: &PARAMETERS,
    build: |_, _| Ok(Box::new(GlobalNearestNeighbour::default())),
};

static PARAMETERS: Object = Object {
    name: "GlobalNearestNeighbour",
    summary: "The most probable assignment of all tracks to detections at once, misses and clutter weighed.",
    fields: &[],
};

#[derive(Debug, Clone, Default)]
pub struct GlobalNearestNeighbour {
    solver: AssignmentSolver,
}

impl Associator for GlobalNearestNeighbour {
    fn associate(&mut self, problem: &Problem, weights: &mut Weights) {
        if problem.row_count() == 1 {
            problem
                .rows()
                .for_each(|(row, state)| choose_alone(problem, row, state, weights));
            return;
        }
        solve(
            &mut self.solver,
            problem,
            |edge| -problem.edge(edge).log_likelihood,
            |row| -problem.row(row).log_missed,
        );
        for (index, (row, state)) in problem.rows().enumerate() {
            if let Some(edge) = self.solver.edge_of(index) {
                weights.choose(row, state.first as usize + edge);
            }
        }
    }

    fn fork(&self) -> Box<dyn Associator> {
        Box::new(self.clone())
    }
}

/// Step 2 with the costs of edges and, by row, of misses: all finite.
pub(super) fn solve(
    solver: &mut AssignmentSolver,
    problem: &Problem,
    edge_cost: impl Fn(usize) -> f64,
    miss_cost: impl Fn(usize) -> f64,
) {
    solver.clear();
    for (index, row) in problem.rows() {
        for edge in row.edges() {
            solver.push_edge(problem.edge(edge).detection, edge_cost(edge));
        }
        solver.end_row(miss_cost(index));
    }
    // Every miss costs a finite sum, so there always is an assignment.
    let is_solved = solver.solve_until(problem.watch()).is_some();
    debug_assert!(
        is_solved || problem.watch().is_stopped(),
        "a cluster in which every track may miss has an assignment"
    );
}

/// The case without rivals.
fn choose_alone(problem: &Problem, row: usize, state: &Row, weights: &mut Weights) {
    let mut best = (state.log_missed, None);
    for edge in state.edges() {
        let log_likelihood = problem.edge(edge).log_likelihood;
        if log_likelihood > best.0 {
            best = (log_likelihood, Some(edge));
        }
    }
    if let Some(edge) = best.1 {
        weights.choose(row, edge);
    }
}

#[cfg(test)]
mod tests {
    use super::super::problem::Edge;
    use super::super::problem::ScanProblem;
    use super::super::problem::tests::{chosen_by, problem_of};
    use super::*;

    fn chosen(tracks: &[&[(u32, f64)]]) -> Vec<Option<u32>> {
        chosen_by(
            &mut GlobalNearestNeighbour::default(),
            &mut problem_of(tracks),
        )
    }

    #[test]
    fn a_track_gives_up_its_nearest_when_the_whole_gains() {
        // Costs ½ d², misses ln 10 = 2.30. Nearest neighbour would take (0, 0) and leave track 1 without: 0.25 + 2.30. The
        // optimum is (0, 1) and (1, 0): 0.75 + 0.5.
        assert_eq!(
            chosen(&[&[(0, 0.5), (1, 1.5)], &[(0, 1.0)]]),
            vec![Some(1), Some(0)]
        );
    }

    #[test]
    fn what_clutter_explains_better_is_left_alone() {
        // A miss costs ln 10 = 2.303: d² = 4.6 is a little cheaper, 4.61 a little dearer, alone and in company.
        assert_eq!(chosen(&[&[(0, 4.6)], &[(1, 4.61)]]), vec![Some(0), None]);
        assert_eq!(
            chosen(&[&[(0, 4.6), (1, 9.0)], &[(1, 4.61)]]),
            vec![Some(0), None]
        );
    }

    #[test]
    fn the_cost_of_a_miss_decides_who_misses() {
        // Both want detection 0, of likelihood ratio 5 and 4; a miss has 0.5 for track 0 and 0.1 for track 1. Track 0 with
        // it: 5 · 0.1 = 0.5; track 1 with it: 0.5 · 4 = 2.
        let mut problem = ScanProblem::default();
        problem.begin(0, 1);
        for (ratio, missed) in [(5.0f64, 0.5f64), (4.0, 0.1)] {
            problem.push_edge(Edge {
                detection: 0,
                squared_distance: 1.0,
                log_likelihood: ratio.ln(),
            });
            problem.end_row(missed.ln(), 0.0);
        }
        assert_eq!(
            chosen_by(&mut GlobalNearestNeighbour::default(), &mut problem),
            vec![None, Some(0)]
        );
    }
}
