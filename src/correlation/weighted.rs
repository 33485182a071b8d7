//! The weighted method: the tracks of the first sensor meet those of the second in the assignment of least
//! cost, the tuples so made meet those of the third, and so on. For two sensors the assignment is the optimum; for more, no
//! earlier choice is taken back.
//!
//! # Reference
//! R. A. Singer, A. J. Kanyuck, Computer control of multiple site track correlation, Automatica 7, 1971, 455–463.
//!
//! # Symbols
//! C = Pᵢ + Pⱼ covariance of the difference of two estimates, their errors taken to be independent; T a tuple made so far, j a
//! track of the next sensor; c(T, j) what j costs in T.
//!
//! # Method
//! For each sensor in turn:
//! 1. c(T, j): chain, the link of j with the last member of T; all pairs, the sum of its links with all members; else the
//!    cost of T with j less that of T.
//! 2. Assign the sensor's tracks to tuples at least total cost, none at 0 ([`crate::math::assignment`]). A track that gets
//!    none begins a tuple.
//!
//! Where the costs of the problem know of correlated errors, the tuples are looked for without ([`super::modified`] looks for them
//! with); those that do not exist or do not pay in the problem itself are divided, and J is stated in its costs.

use super::admissible::divide_rows;
use super::bound::dual_bound;
use super::problem::{CorrelationProblem, Costs};
use super::{BuildCorrelator, Correlator, Solution};
use crate::math::assignment::AssignmentSolver;
use crate::model::fault::Fault;
use crate::registry::{Method, Object};

pub const METHOD: Method<BuildCorrelator> = Method {
    name: "weighted",
    parameters: &PARAMETERS,
    build: |_, _| Ok(Box::new(Weighted)),
};

static PARAMETERS: Object = Object {
    name: "WeightedCorrelator",
    summary: "Sensor by sensor the assignment of least cost; the errors of two tracks count as independent.",
    fields: &[],
};

#[derive(Debug)]
struct Weighted;

impl Correlator for Weighted {
    fn correlate(&mut self, problem: &CorrelationProblem) -> Result<Solution, Vec<Fault>> {
        let tuples = match problem.independent() {
            None => weighted_tuples(problem),
            Some(independent) => divide_rows(problem, &weighted_tuples(independent)),
        };
        Ok(Solution::from_tuples(problem, tuples).with_bound(dual_bound(problem)))
    }
}

/// The tuples, those of one track too.
pub(super) fn weighted_tuples(problem: &CorrelationProblem) -> Vec<Vec<u32>> {
    let mut tuples: Vec<Vec<u32>> = Vec::new();
    let mut tuple_of = vec![0; problem.tracks()];
    let mut solver = AssignmentSolver::default();
    let mut joins = Vec::new();
    for sensor in 0..problem.sensors() {
        solver.clear();
        for track in problem.of_sensor(sensor) {
            costs_of_joining(problem, track, &tuples, &tuple_of, &mut joins);
            joins
                .iter()
                .filter(|(_, cost)| *cost < 0.0)
                .for_each(|&(tuple, cost)| solver.push_edge(tuple, cost));
            solver.end_row(0.0);
        }
        let is_solved = solver.solve().is_some();
        debug_assert!(
            is_solved,
            "tracks that may all begin a tuple have an assignment"
        );
        for (row, track) in problem.of_sensor(sensor).enumerate() {
            let tuple = solver.column_of(row).unwrap_or(tuples.len() as u32);
            if tuple as usize == tuples.len() {
                tuples.push(Vec::new());
            }
            tuples[tuple as usize].push(track);
            tuple_of[track as usize] = tuple;
        }
    }
    tuples
}

/// c(T, j) for each tuple that a track may join.
fn costs_of_joining(
    problem: &CorrelationProblem,
    track: u32,
    tuples: &[Vec<u32>],
    tuple_of: &[u32],
    joins: &mut Vec<(u32, f64)>,
) {
    joins.clear();
    let mut links: Vec<(u32, f64, u32)> = problem
        .links(track)
        .iter()
        .take_while(|link| problem.sensor_of(link.track) < problem.sensor_of(track))
        .map(|link| (tuple_of[link.track as usize], link.cost, link.track))
        .collect();
    if matches!(problem.costs, Costs::Chain) {
        for (tuple, cost, member) in links {
            if tuples[tuple as usize].last() == Some(&member) {
                joins.push((tuple, cost));
            }
        }
        return;
    }
    links.sort_unstable_by_key(|&(tuple, _, member)| (tuple, member));
    for of_tuple in links.chunk_by(|left, right| left.0 == right.0) {
        let number = of_tuple[0].0;
        let tuple = &tuples[number as usize];
        if of_tuple.len() < tuple.len() {
            continue;
        }
        let cost = match &problem.costs {
            Costs::Joint(_) => cost_of_growth(problem, tuple, track),
            _ => of_tuple.iter().map(|link| link.1).sum(),
        };
        joins.push((number, cost));
    }
}

fn cost_of_growth(problem: &CorrelationProblem, tuple: &[u32], track: u32) -> f64 {
    let cost = |tuple: &[u32]| problem.cost(tuple).unwrap_or(f64::INFINITY);
    let grown = [tuple, &[track]].concat();
    cost(&grown) - cost(tuple)
}

#[cfg(test)]
mod tests {
    use super::super::modified;
    use super::*;

    #[test]
    fn weighted_does_not_see_what_errors_have_in_common_and_modified_does() {
        // With the correlation 1 is the partner of 2, which 0 seems to be without.
        let seen = CorrelationProblem::new(&[2, 1], &[(0, 2, -9.0), (1, 2, -8.0)], Costs::AllPairs);
        let problem = CorrelationProblem::new(&[2, 1], &[(1, 2, -7.0)], Costs::AllPairs)
            .with_independent(seen);
        let found = Weighted.correlate(&problem).unwrap();
        assert_eq!(
            (found.tuples, found.cost),
            (vec![vec![0], vec![1], vec![2]], 0.0)
        );
        let modified = (modified::METHOD.build)(
            &serde_json::json!({}),
            crate::math::rng::Seed { seed: 0, run: 0 },
        )
        .unwrap()
        .correlate(&problem);
        let found = modified.unwrap();
        assert_eq!(
            (found.tuples, found.cost),
            (vec![vec![0], vec![1, 2]], -7.0)
        );
    }

    #[test]
    fn two_sensors_get_the_optimum_and_a_third_meets_what_was_made() {
        // {0, 1}, {2, 3}, {4}: 0–3 and 1–2 cost −11, 0–2 and 1–3 only −9 − 0. Then 4 goes to the tuple of 0 and 3: −4 + 1 for
        // all pairs; in a chain, where 0 and 4 are no neighbours, −4.
        let pairs = [
            (0, 2, -9.0),
            (0, 3, -6.0),
            (1, 2, -5.0),
            (3, 4, -4.0),
            (0, 4, 1.0),
        ];
        let problem = |costs| CorrelationProblem::new(&[2, 2, 1], &pairs, costs);
        let tuples = vec![vec![0, 3, 4], vec![1, 2]];
        let all = Weighted.correlate(&problem(Costs::AllPairs)).unwrap();
        assert_eq!((all.tuples, all.cost), (tuples.clone(), -14.0));
        let chain = Weighted.correlate(&problem(Costs::Chain)).unwrap();
        assert_eq!((chain.tuples, chain.cost), (tuples, -15.0));
    }
}
