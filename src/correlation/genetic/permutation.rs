//! What the paper does to the permutations of a chromosome: partially matched crossover and the swap of two positions.
//!
//! # Reference
//! D. E. Goldberg, R. Lingle, Alleles, loci, and the traveling salesman problem, Proc. 1st Int. Conf. on Genetic Algorithms,
//! 1985, 154–159.
//!
//! # Method
//! The stretches between two cut points map each value of the one parent to that at the same position of the other. In both
//! children those two values change places, wherever they are: inside the cut each has then the other parent's stretch, and
//! outside it nothing is there twice.

use std::ops::Range;

/// Memory of a crossover.
#[derive(Debug, Default)]
pub(super) struct Crossover {
    /// Where each value is, in both children.
    places: [Vec<u32>; 2],
    /// The stretches of both parents.
    stretches: [Vec<u32>; 2],
}

impl Crossover {
    /// PMX of two permutations of 0..n.
    pub(super) fn cross(&mut self, left: &mut [u32], right: &mut [u32], cut: Range<usize>) {
        for ((places, stretch), parent) in self
            .places
            .iter_mut()
            .zip(&mut self.stretches)
            .zip([&*left, &*right])
        {
            places.resize(parent.len(), 0);
            parent
                .iter()
                .enumerate()
                .for_each(|(place, &value)| places[value as usize] = place as u32);
            stretch.clear();
            stretch.extend_from_slice(&parent[cut.clone()]);
        }
        let [of_left, of_right] = &mut self.places;
        for (index, place) in cut.enumerate() {
            bring(left, of_left, self.stretches[1][index], place);
            bring(right, of_right, self.stretches[0][index], place);
        }
    }
}

/// A value changes places with the one that is where it is to be.
fn bring(permutation: &mut [u32], places: &mut [u32], value: u32, to: usize) {
    let (from, other) = (places[value as usize], permutation[to]);
    permutation.swap(from as usize, to);
    places[other as usize] = from;
    places[value as usize] = to as u32;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rng::{Purpose, Seed};
    use rand::rngs::Xoshiro256PlusPlus;
    use rand::{RngExt, SeedableRng};

    #[test]
    fn goldbergs_example() {
        // A = 9 8 4 | 5 6 7 | 1 3 2 10 and B = 8 7 1 | 2 3 10 | 9 5 4 6, counted from 1.
        let from_one = |values: [u32; 10]| values.map(|value| value - 1);
        let mut a = from_one([9, 8, 4, 5, 6, 7, 1, 3, 2, 10]);
        let mut b = from_one([8, 7, 1, 2, 3, 10, 9, 5, 4, 6]);
        Crossover::default().cross(&mut a, &mut b, 3..6);
        assert_eq!(a, from_one([9, 8, 4, 2, 3, 10, 1, 6, 5, 7]));
        assert_eq!(b, from_one([8, 10, 1, 5, 6, 7, 9, 2, 4, 3]));
    }

    fn is_permutation(values: &[u32], seen: &mut u64) -> bool {
        *seen = 0;
        values.iter().for_each(|&value| *seen |= 1 << value);
        seen.count_ones() as usize == values.len() && *seen < 1 << values.len()
    }

    #[test]
    fn a_million_crossovers_and_swaps_leave_permutations() {
        let mut rng = Xoshiro256PlusPlus::from_rng(&mut Seed { seed: 2, run: 0 }.stream(
            Purpose::Correlator,
            0,
            0,
        ));
        let (mut crossover, mut seen) = (Crossover::default(), 0);
        for length in 1..=20 {
            let mut parents: [Vec<u32>; 2] = std::array::from_fn(|_| (0..length).collect());
            for _ in 0..25_000 {
                let [left, right] = &mut parents;
                let (one, other) = (
                    rng.random_range(0..=length as usize),
                    rng.random_range(0..=length as usize),
                );
                let cut = one.min(other)..one.max(other);
                let given = right[cut.clone()].to_vec();
                crossover.cross(left, right, cut.clone());
                assert_eq!(left[cut], given);
                assert!(is_permutation(left, &mut seen) && is_permutation(right, &mut seen));
                left.swap(
                    rng.random_range(0..length as usize),
                    rng.random_range(0..length as usize),
                );
                assert!(is_permutation(left, &mut seen));
            }
        }
    }
}
