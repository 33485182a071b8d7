//! Nearest neighbour: the two closest tracks are put together first, then the next two, as long as a tuple has one track of
//! each sensor and all the links it needs. No choice is ever taken back.
//!
//! # Reference
//! The nearest neighbour method of track correlation, as in He You, Wang Guohong et al., Radar Data Processing with
//! Applications, 2016, chapter on track-to-track association; the greedy form over all pairs of sensors.
//!
//! # Symbols
//! λ − δ the cost of a link: how far apart two tracks are, less what is allowed.
//!
//! # Method
//! 1. Order all links of negative cost, the cheapest first; of equals the one of the first tracks.
//! 2. For each in turn put the tuples of its two tracks together, if the tuple exists.

use super::bound::dual_bound;
use super::problem::CorrelationProblem;
use super::{BuildCorrelator, Correlator, Solution};
use crate::model::fault::Fault;
use crate::registry::{Method, Object};

pub const METHOD: Method<BuildCorrelator> = Method {
    name: "nearest",
    parameters: &PARAMETERS,
    build: |_, _| Ok(Box::new(Nearest)),
};

static PARAMETERS: Object = Object {
    name: "NearestCorrelator",
    summary: "The two closest tracks first, then the next two, no choice ever taken back.",
    fields: &[],
};

#[derive(Debug)]
struct Nearest;

impl Correlator for Nearest {
    fn correlate(&mut self, problem: &CorrelationProblem) -> Result<Solution, Vec<Fault>> {
        Ok(Solution::from_tuples(problem, nearest_tuples(problem)).with_bound(dual_bound(problem)))
    }
}

/// All tracks in tuples; some are empty.
pub(super) fn nearest_tuples(problem: &CorrelationProblem) -> Vec<Vec<u32>> {
    let tracks = problem.tracks() as u32;
    let mut tuples: Vec<Vec<u32>> = (0..tracks).map(|track| vec![track]).collect();
    let mut tuple_of: Vec<u32> = (0..tracks).collect();
    for (_, a, b) in ordered_links(problem) {
        let (left, right) = (tuple_of[a as usize], tuple_of[b as usize]);
        if left == right {
            continue;
        }
        if let Some(joined) = join(problem, &tuples[left as usize], &tuples[right as usize]) {
            joined
                .iter()
                .for_each(|&track| tuple_of[track as usize] = left);
            tuples[left as usize] = joined;
            tuples[right as usize].clear();
        }
    }
    tuples.retain(|tuple| !tuple.is_empty());
    tuples
}

fn ordered_links(problem: &CorrelationProblem) -> Vec<(f64, u32, u32)> {
    let of_track = |a: u32| {
        let later = problem
            .links(a)
            .iter()
            .filter(move |link| link.track > a && link.cost < 0.0);
        later.map(move |link| (link.cost, a, link.track))
    };
    let mut links: Vec<_> = (0..problem.tracks() as u32).flat_map(of_track).collect();
    links.sort_unstable_by(|left, right| {
        left.0
            .total_cmp(&right.0)
            .then((left.1, left.2).cmp(&(right.1, right.2)))
    });
    links
}

/// Both tuples as one, where it exists.
fn join(problem: &CorrelationProblem, left: &[u32], right: &[u32]) -> Option<Vec<u32>> {
    let mut tuple = [left, right].concat();
    tuple.sort_unstable();
    let shares_sensor = tuple
        .windows(2)
        .any(|pair| problem.sensor_of(pair[0]) == problem.sensor_of(pair[1]));
    (!shares_sensor && problem.cost(&tuple).is_some()).then_some(tuple)
}

#[cfg(test)]
mod tests {
    use super::super::problem::Costs;
    use super::*;

    #[test]
    fn the_closest_pair_is_first_and_never_given_up() {
        // Sensors {0, 1}, {2, 3}, {4}. 0–2 is first; then 1–2 and 0–3 would put two of a sensor together; 4 joins 2.
        let pairs = [
            (0, 2, -9.0),
            (0, 3, -8.0),
            (1, 2, -8.5),
            (2, 4, -4.0),
            (0, 4, 6.0),
            (3, 4, -1.0),
        ];
        let solution = Nearest
            .correlate(&CorrelationProblem::new(
                &[2, 2, 1],
                &pairs,
                Costs::AllPairs,
            ))
            .unwrap();
        assert_eq!(
            (solution.tuples, solution.cost),
            (vec![vec![0, 2, 4], vec![1], vec![3]], -7.0)
        );
    }

    #[test]
    fn a_tuple_that_lacks_a_link_is_not_made() {
        let pairs = [(0, 1, -9.0), (1, 2, -5.0)];
        let tuples = |costs| {
            Nearest
                .correlate(&CorrelationProblem::new(&[1, 1, 1], &pairs, costs))
                .unwrap()
                .tuples
        };
        assert_eq!(tuples(Costs::AllPairs), [vec![0, 1], vec![2]]);
        assert_eq!(tuples(Costs::Chain), [vec![0, 1, 2]]);
    }
}
