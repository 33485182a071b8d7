//! Taking pairs in an order of merit: the best (track, detection) pair of the cluster first, then the best of those
//! whose track and detection are both free, and so on. Memory is reused.

use super::problem::{Edge, Problem, Weights};

/// The pairs of a cluster and what is taken already.
#[derive(Debug, Clone, Default)]
pub(super) struct Greedy {
    pairs: Vec<Pair>,
    /// For each detection of the scan, whether it is taken; only entries that `pairs` name are ever read or set.
    taken: Vec<bool>,
}

#[derive(Debug, Clone, Copy)]
struct Pair {
    rank: f64,
    squared_distance: f64,
    row: u32,
    detection: u32,
    edge: u32,
}

impl Greedy {
    /// Takes the pairs in order of `rank` (least first), then of squared distance, track and detection.
    pub fn associate(
        &mut self,
        problem: &Problem,
        weights: &mut Weights,
        rank: impl Fn(&Edge) -> f64,
    ) {
        if problem.row_count() == 1 {
            choose_alone(problem, weights, rank);
            return;
        }
        self.sort_pairs(problem, rank);
        for pair in &self.pairs {
            let is_served = weights.missed[pair.row as usize] == 0.0;
            if !is_served && !self.taken[pair.detection as usize] {
                self.taken[pair.detection as usize] = true;
                weights.choose(pair.row as usize, pair.edge as usize);
            }
        }
        for pair in &self.pairs {
            self.taken[pair.detection as usize] = false;
        }
    }

    fn sort_pairs(&mut self, problem: &Problem, rank: impl Fn(&Edge) -> f64) {
        self.pairs.clear();
        for (row, edges) in problem.rows().map(|(row, edges)| (row, edges.edges())) {
            for index in edges {
                let edge = problem.edge(index);
                if self.taken.len() <= edge.detection as usize {
                    self.taken.resize(edge.detection as usize + 1, false);
                }
                let (row, detection, squared_distance) =
                    (row as u32, edge.detection, edge.squared_distance);
                self.pairs.push(Pair {
                    rank: rank(edge),
                    squared_distance,
                    row,
                    detection,
                    edge: index as u32,
                });
            }
        }
        let names = |pair: &Pair| (pair.row, pair.detection);
        self.pairs.sort_unstable_by(|left, right| {
            let merit = left
                .rank
                .total_cmp(&right.rank)
                .then(left.squared_distance.total_cmp(&right.squared_distance));
            merit.then_with(|| names(left).cmp(&names(right)))
        });
    }
}

/// The case without rivals.
fn choose_alone(problem: &Problem, weights: &mut Weights, rank: impl Fn(&Edge) -> f64) {
    for (row, edges) in problem.rows().map(|(row, edges)| (row, edges.edges())) {
        let merit = |&index: &usize| {
            (
                rank(problem.edge(index)),
                problem.edge(index).squared_distance,
            )
        };
        let best = edges.min_by(|left, right| {
            let (left, right) = (merit(left), merit(right));
            left.0.total_cmp(&right.0).then(left.1.total_cmp(&right.1))
        });
        if let Some(best) = best {
            weights.choose(row, best);
        }
    }
}
