//! What no way to put the tracks together undercuts, so that every answer says how far from the optimum it may be.
//!
//! # Method
//! - Chain: the optimum itself, one assignment ([`super::chain`]).
//! - All pairs: the tuples of any solution give, for each pair of sensors, an assignment of their tracks; J is the sum of its
//!   links. So J is at least the sum of the optimal assignments of all pairs of sensors, each solved by itself. (It is the
//!   relaxation that forgets that two tracks with a common partner are partners.)
//! - Joint costs fall into no pairs; there is no bound.

use super::chain::cheapest_chains;
use super::problem::{CorrelationProblem, Costs};
use crate::math::assignment::AssignmentSolver;

pub(super) fn dual_bound(problem: &CorrelationProblem) -> Option<f64> {
    match problem.costs {
        Costs::Chain => Some(cheapest_chains(problem).1),
        Costs::AllPairs => Some(sum_over_pairs(problem)),
        Costs::Joint(_) => None,
    }
}

fn sum_over_pairs(problem: &CorrelationProblem) -> f64 {
    let mut solver = AssignmentSolver::default();
    let pairs = (0..problem.sensors())
        .flat_map(|left| (left + 1..problem.sensors()).map(move |right| (left, right)));
    pairs
        .map(|(left, right)| least_of_pair(problem, left, right, &mut solver))
        .sum()
}

/// The optimal assignment of two sensors' tracks.
fn least_of_pair(
    problem: &CorrelationProblem,
    left: usize,
    right: usize,
    solver: &mut AssignmentSolver,
) -> f64 {
    let columns = problem.of_sensor(right);
    solver.clear();
    for track in problem.of_sensor(left) {
        let links = problem.links(track);
        let first = links.partition_point(|link| link.track < columns.start);
        for link in links[first..]
            .iter()
            .take_while(|link| link.track < columns.end)
            .filter(|link| link.cost < 0.0)
        {
            solver.push_edge(link.track - columns.start, link.cost);
        }
        solver.end_row(0.0);
    }
    solver
        .solve()
        .expect("tracks that may all stay alone have an assignment")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bound_of_all_pairs_forgets_common_partners() {
        // 0–1 and 1–2 are worth −3 and −2, 0–2 costs 4: the pairs alone give −5, the optimum is −3.
        let pairs = [(0, 1, -3.0), (1, 2, -2.0), (0, 2, 4.0)];
        assert_eq!(
            dual_bound(&CorrelationProblem::new(
                &[1, 1, 1],
                &pairs,
                Costs::AllPairs
            )),
            Some(-5.0)
        );
        assert_eq!(
            dual_bound(&CorrelationProblem::new(&[1, 1, 1], &pairs, Costs::Chain)),
            Some(-5.0)
        );
        // Two tracks of the first sensor want the same track: one assignment, not two links.
        assert_eq!(
            dual_bound(&CorrelationProblem::new(
                &[2, 1],
                &[(0, 2, -3.0), (1, 2, -2.0)],
                Costs::AllPairs
            )),
            Some(-3.0)
        );
    }
}
