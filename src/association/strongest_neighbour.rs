//! Strongest neighbour: each track takes the detection with the largest amplitude in its gate. When several tracks want
//! one detection, the strongest pair of all goes first (of equal ones the closest) and the others choose among what is left.
//!
//! # Reference
//! X.-R. Li, Y. Bar-Shalom, Theoretical analysis and performance prediction of tracking with strongest neighbor filter,
//! IEEE Trans. Aerospace and Electronic Systems 32, 1996; Y. Bar-Shalom, X.-R. Li, Multitarget-Multisensor Tracking,
//! 1995, section 3.2. They speak of one target; the rule for several is that of nearest neighbour.
//!
//! # Symbols
//! a amplitude of a detection; d² squared distance of a (track, detection) pair.
//!
//! # Method
//! 1. Sort the pairs of the cluster by falling a, then d², track and detection.
//! 2. Take each pair whose track and detection are both free.

use super::greedy::Greedy;
use super::problem::{Problem, Weights};
use super::{Associator, BuildAssociator, Needs};
use crate::registry::{Method, Object};

pub const METHOD: Method<BuildAssociator> = Method {
    name: "strongest_neighbour",
    parameters: &PARAMETERS,
    build: |_, _| Ok(Box::new(StrongestNeighbour::default())),
};

static PARAMETERS: Object = Object {
    name: "StrongestNeighbour",
    summary: "Each track takes the detection with the largest amplitude in its gate; only for recordings with amplitudes.",
    fields: &[],
};

#[derive(Debug, Clone, Default)]
pub struct StrongestNeighbour {
    greedy: Greedy,
}

impl Associator for StrongestNeighbour {
    fn needs(&self) -> Needs {
        Needs::Amplitudes
    }

    fn associate(&mut self, problem: &Problem, weights: &mut Weights) {
        self.greedy
            .associate(problem, weights, |edge| -problem.amplitude(edge.detection));
    }

    fn fork(&self) -> Box<dyn Associator> {
        Box::new(self.clone())
    }
}

#[cfg(test)]
mod tests {
    use super::super::problem::tests::{chosen_by, problem_of};
    use super::*;

    fn chosen(tracks: &[&[(u32, f64)]], amplitudes: &[f64]) -> Vec<Option<u32>> {
        let mut problem = problem_of(tracks);
        problem.set_amplitudes(amplitudes.iter().copied());
        chosen_by(&mut StrongestNeighbour::default(), &mut problem)
    }

    #[test]
    fn a_lone_track_takes_the_strongest_in_its_gate_however_far() {
        assert_eq!(
            chosen(&[&[(0, 1.0), (2, 8.0), (1, 2.0)]], &[3.0, 4.0, 5.0, 9.0]),
            vec![Some(2)]
        );
    }

    #[test]
    fn the_strongest_pair_goes_first_and_of_equals_the_closest() {
        // Both want detection 1; track 1 is closer, track 0 takes its second strongest.
        assert_eq!(
            chosen(&[&[(0, 1.0), (1, 5.0)], &[(1, 2.0)]], &[3.0, 4.0]),
            vec![Some(0), Some(1)]
        );
        assert_eq!(
            chosen(&[&[(1, 5.0)], &[(1, 2.0), (0, 1.0)]], &[3.0, 4.0]),
            vec![None, Some(1)]
        );
    }
}
