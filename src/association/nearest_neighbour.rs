//! Nearest neighbour: each track takes the detection with the smallest squared distance in its gate. When several
//! tracks want one detection, the closest pair of all goes first and the others choose among what is left.
//!
//! # Reference
//! Y. Bar-Shalom, X.-R. Li, Multitarget-Multisensor Tracking, 1995, section 3.2; the nearest-neighbour method of
//! J. Liang, Y. Liu, 2009. That paper does not say what happens when two tracks want one detection; the rule above
//! keeps "a detection belongs to one track", which its model check demands.
//!
//! # Symbols
//! d² squared distance of a (track, detection) pair.
//!
//! # Method
//! 1. Sort the pairs of the cluster by d², then track, then detection.
//! 2. Take each pair whose track and detection are both free.

use super::problem::{Problem, Weights};
use super::{Associator, BuildAssociator};
use crate::registry::{Method, Object};

pub const METHOD: Method<BuildAssociator> =
    Method { name: "nearest_neighbour", parameters: &PARAMETERS, build: |_| Ok(Box::new(NearestNeighbour::default())) };

static PARAMETERS: Object = Object {
    name: "NearestNeighbour",
    summary: "Each track takes its nearest detection; the closest pair of all goes first.",
    fields: &[],
};

#[derive(Debug, Default)]
pub struct NearestNeighbour {
    pairs: Vec<Pair>,
    /// For each detection of the scan, whether it is taken; only entries that `pairs` name are ever read or set.
    taken: Vec<bool>,
}

#[derive(Debug, Clone, Copy)]
struct Pair {
    squared_distance: f64,
    row: u32,
    detection: u32,
    edge: u32,
}

impl Associator for NearestNeighbour {
    fn associate(&mut self, problem: &Problem, weights: &mut Weights) {
        if problem.row_count() == 1 {
            choose_nearest(problem, weights);
            return;
        }
        self.sort_pairs(problem);
        for pair in &self.pairs {
            let is_served = weights.none[pair.row as usize] == 0.0;
            if !is_served && !self.taken[pair.detection as usize] {
                self.taken[pair.detection as usize] = true;
                weights.choose(pair.row as usize, pair.edge as usize);
            }
        }
        for pair in &self.pairs {
            self.taken[pair.detection as usize] = false;
        }
    }
}

/// The case without rivals.
fn choose_nearest(problem: &Problem, weights: &mut Weights) {
    for (row, edges) in problem.rows().map(|(row, edges)| (row, edges.edges())) {
        let distance = |&edge: &usize| problem.edge(edge).squared_distance;
        if let Some(nearest) = edges.min_by(|left, right| distance(left).total_cmp(&distance(right))) {
            weights.choose(row, nearest);
        }
    }
}

impl NearestNeighbour {
    fn sort_pairs(&mut self, problem: &Problem) {
        self.pairs.clear();
        for (row, edges) in problem.rows().map(|(row, edges)| (row, edges.edges())) {
            for index in edges {
                let edge = problem.edge(index);
                if self.taken.len() <= edge.detection as usize {
                    self.taken.resize(edge.detection as usize + 1, false);
                }
                let (row, detection, edge_index) = (row as u32, edge.detection, index as u32);
                self.pairs.push(Pair { squared_distance: edge.squared_distance, row, detection, edge: edge_index });
            }
        }
        let key = |left: &Pair, right: &Pair| (left.row, left.detection).cmp(&(right.row, right.detection));
        self.pairs.sort_unstable_by(|left, right| left.squared_distance.total_cmp(&right.squared_distance).then_with(|| key(left, right)));
    }
}

#[cfg(test)]
mod tests {
    use super::super::problem::tests::problem_of;
    use super::*;

    fn chosen(tracks: &[&[(u32, f64)]]) -> Vec<Option<u32>> {
        let mut problem = problem_of(tracks);
        let mut weights = Weights::default();
        weights.reset(&problem);
        let mut associator = NearestNeighbour::default();
        problem.for_each_cluster(10, |cluster| associator.associate(cluster, &mut weights));
        let pick = |row: &super::super::problem::Row| {
            row.edges().find(|&edge| weights.edges[edge] == 1.0).map(|edge| problem.edges()[edge].detection)
        };
        problem.rows().iter().map(pick).collect()
    }

    #[test]
    fn a_lone_track_takes_the_nearest_and_an_empty_gate_takes_none() {
        assert_eq!(chosen(&[&[(4, 3.0), (2, 1.0), (1, 2.0)], &[]]), vec![Some(2), None]);
    }

    #[test]
    fn the_closest_pair_goes_first_and_the_loser_takes_what_is_left() {
        assert_eq!(chosen(&[&[(0, 2.0), (1, 5.0)], &[(0, 1.0)]]), vec![Some(1), Some(0)]);
        assert_eq!(chosen(&[&[(0, 2.0)], &[(0, 1.0)]]), vec![None, Some(0)]);
    }

    #[test]
    fn equal_distances_go_to_the_earlier_track_and_detection() {
        assert_eq!(chosen(&[&[(1, 1.0), (0, 1.0)], &[(0, 1.0), (1, 1.0)]]), vec![Some(0), Some(1)]);
    }
}
