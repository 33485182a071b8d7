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

use super::greedy::Greedy;
use super::problem::{Problem, Weights};
use super::{Associator, BuildAssociator};
use crate::registry::{Method, Object};

pub const METHOD: Method<BuildAssociator> =
    Method { name: "nearest_neighbour", parameters: &PARAMETERS, build: |_, _| Ok(Box::new(NearestNeighbour::default())) };

static PARAMETERS: Object = Object {
    name: "NearestNeighbour",
    summary: "Each track takes its nearest detection; the closest pair of all goes first.",
    fields: &[],
};

#[derive(Debug, Default)]
pub struct NearestNeighbour {
    greedy: Greedy,
}

impl Associator for NearestNeighbour {
    fn associate(&mut self, problem: &Problem, weights: &mut Weights) {
        self.greedy.associate(problem, weights, |edge| edge.squared_distance);
    }
}

#[cfg(test)]
mod tests {
    use super::super::problem::tests::{chosen_by, problem_of};
    use super::*;

    fn chosen(tracks: &[&[(u32, f64)]]) -> Vec<Option<u32>> {
        chosen_by(&mut NearestNeighbour::default(), &mut problem_of(tracks))
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
