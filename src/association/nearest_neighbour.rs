//! Nearest neighbour: each track takes the detection with the smallest squared distance in its gate. What happens when several
//! tracks want one detection is a parameter: the closest pair of all goes first, the oldest track goes first, or they share it.
//!
//! # Reference
//! Y. Bar-Shalom, X.-R. Li, Multitarget-Multisensor Tracking, 1995, section 3.2; the nearest-neighbour method of
//! J. Liang, Y. Liu, 2009. That paper does not say what happens when two tracks want one detection; `closest_pair`
//! keeps "a detection belongs to one track", which its model check demands. `shared` is the contender of papers that give
//! each target its nearest detection and ask no more, such as Wang, Li and Huang's on the bat algorithm.
//!
//! # Symbols
//! d² squared distance of a (track, detection) pair. It ranks the pairs, not the likelihood e^(−d²/2) / √|2πS|: the two differ
//! where tracks have different S, and there the likelihood would send the sure track first.
//!
//! # Method
//! 1. `closest_pair`: sort the pairs of the cluster by d², then track, then detection; take each pair whose track and detection
//!    are both free.
//! 2. `in_turn`: the tracks in their order, the oldest first; each takes the nearest of the detections still free.
//! 3. `shared`: each track takes its nearest, whether or not another took it. Then both are updated with it, and the model
//!    check of an evaluation reports it (`detection_shared_by_tracks`).

use super::greedy::Greedy;
use super::problem::{Problem, Row, Weights};
use super::{Associator, BuildAssociator};
use crate::registry::{Kind, Method, Object, default};
use serde::Deserialize;

pub const METHOD: Method<BuildAssociator> = Method {
    name: "nearest_neighbour",
    parameters: &PARAMETERS,
    build: |spec, _| {
        Ok(Box::new(NearestNeighbour::new(
            NearestNeighbourSettings::deserialize(spec)?,
        )))
    },
};

static PARAMETERS: Object = Object {
    name: "NearestNeighbour",
    summary: "Each track takes its nearest detection.",
    fields: &[default(
        "conflicts",
        "When tracks want one detection. closest_pair: the closest pair of all goes first, the others choose among what is left; \
                  in_turn: the oldest track goes first; shared: all take it.",
        Kind::Choice(&["shared", "in_turn", "closest_pair"]),
        "\"closest_pair\"",
    )],
};

#[derive(Debug, Clone, Copy, Deserialize)]
struct NearestNeighbourSettings {
    conflicts: Conflicts,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Conflicts {
    Shared,
    InTurn,
    ClosestPair,
}

#[derive(Debug, Clone)]
struct NearestNeighbour {
    conflicts: Conflicts,
    greedy: Greedy,
    /// For each detection of a scan, whether it is taken; nothing is between clusters.
    taken: Vec<bool>,
}

impl NearestNeighbour {
    fn new(settings: NearestNeighbourSettings) -> Self {
        NearestNeighbour {
            conflicts: settings.conflicts,
            greedy: Greedy::default(),
            taken: Vec::new(),
        }
    }

    fn in_turn(&mut self, problem: &Problem, weights: &mut Weights) {
        if self.taken.len() < problem.detections() as usize {
            self.taken.resize(problem.detections() as usize, false);
        }
        for (index, row) in problem.rows() {
            if let Some(edge) = nearest(problem, row, |detection| !self.taken[detection as usize]) {
                self.taken[problem.edge(edge).detection as usize] = true;
                weights.choose(index, edge);
            }
        }
        // Only what this cluster can have taken: a scan has many clusters.
        for (_, row) in problem.rows() {
            row.edges()
                .for_each(|edge| self.taken[problem.edge(edge).detection as usize] = false);
        }
    }
}

/// The edge to the nearest of the detections that may be taken; of equals the one with the lowest number.
fn nearest(problem: &Problem, row: &Row, may_take: impl Fn(u32) -> bool) -> Option<usize> {
    let rank = |&edge: &usize| {
        (
            problem.edge(edge).squared_distance,
            problem.edge(edge).detection,
        )
    };
    row.edges()
        .filter(|&edge| may_take(problem.edge(edge).detection))
        .min_by(|left, right| {
            let (left, right) = (rank(left), rank(right));
            left.0.total_cmp(&right.0).then(left.1.cmp(&right.1))
        })
}

impl Associator for NearestNeighbour {
    fn associate(&mut self, problem: &Problem, weights: &mut Weights) {
        match self.conflicts {
            Conflicts::ClosestPair => self
                .greedy
                .associate(problem, weights, |edge| edge.squared_distance),
            Conflicts::InTurn => self.in_turn(problem, weights),
            Conflicts::Shared => {
                for (index, row) in problem.rows() {
                    if let Some(edge) = nearest(problem, row, |_| true) {
                        weights.choose(index, edge);
                    }
                }
            }
        }
    }

    fn fork(&self) -> Box<dyn Associator> {
        Box::new(self.clone())
    }
}

#[cfg(test)]
mod tests {
    use super::super::problem::tests::{chosen_by, problem_of};
    use super::*;

    fn chosen_with(conflicts: Conflicts, tracks: &[&[(u32, f64)]]) -> Vec<Option<u32>> {
        chosen_by(
            &mut NearestNeighbour::new(NearestNeighbourSettings { conflicts }),
            &mut problem_of(tracks),
        )
    }

    fn chosen(tracks: &[&[(u32, f64)]]) -> Vec<Option<u32>> {
        chosen_with(Conflicts::ClosestPair, tracks)
    }

    #[test]
    fn the_rule_for_conflicts_decides_who_gives_way() {
        // All want detection 0; track 1 is closest to it, then track 0, then track 2.
        let tracks: &[&[(u32, f64)]] = &[
            &[(0, 2.0), (1, 5.0)],
            &[(0, 1.0), (1, 4.0)],
            &[(0, 3.0), (2, 7.0)],
            &[],
        ];
        assert_eq!(
            chosen_with(Conflicts::ClosestPair, tracks),
            vec![Some(1), Some(0), Some(2), None]
        );
        assert_eq!(
            chosen_with(Conflicts::InTurn, tracks),
            vec![Some(0), Some(1), Some(2), None]
        );
        assert_eq!(
            chosen_with(Conflicts::Shared, tracks),
            vec![Some(0), Some(0), Some(0), None]
        );
        // Two clusters; a track whose only candidate is taken goes without.
        let tracks: &[&[(u32, f64)]] = &[&[(0, 2.0)], &[(0, 1.0)], &[(3, 1.0), (2, 1.0)]];
        assert_eq!(
            chosen_with(Conflicts::InTurn, tracks),
            vec![Some(0), None, Some(2)]
        );
    }

    #[test]
    fn a_lone_track_takes_the_nearest_and_an_empty_gate_takes_none() {
        assert_eq!(
            chosen(&[&[(4, 3.0), (2, 1.0), (1, 2.0)], &[]]),
            vec![Some(2), None]
        );
    }

    #[test]
    fn the_closest_pair_goes_first_and_the_loser_takes_what_is_left() {
        assert_eq!(
            chosen(&[&[(0, 2.0), (1, 5.0)], &[(0, 1.0)]]),
            vec![Some(1), Some(0)]
        );
        assert_eq!(chosen(&[&[(0, 2.0)], &[(0, 1.0)]]), vec![None, Some(0)]);
    }

    #[test]
    fn equal_distances_go_to_the_earlier_track_and_detection() {
        assert_eq!(
            chosen(&[&[(1, 1.0), (0, 1.0)], &[(0, 1.0), (1, 1.0)]]),
            vec![Some(0), Some(1)]
        );
    }
}
