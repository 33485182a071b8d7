//! The random numbers of one cluster's search: a small generator, started from the stream that is named after the cluster.
//! A search makes a thousand draws, each a nanosecond; the stream's own generator would take several times as long.
//!
//! # Reference
//! D. Blackman, S. Vigna, Scrambled linear pseudorandom number generators, ACM Trans. Mathematical Software 47, 2021 (xoshiro256++,
//! which `rand` promises to keep, the same on every platform); D. Lemire, Fast random integer generation in an interval, ACM
//! Trans. Modeling and Computer Simulation 29, 2019.

use rand::rngs::Xoshiro256PlusPlus;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

#[derive(Debug, Clone)]
pub(super) struct ClusterRng(Xoshiro256PlusPlus);

impl ClusterRng {
    pub(super) fn new(mut stream: ChaCha8Rng) -> Self {
        ClusterRng(Xoshiro256PlusPlus::from_rng(&mut stream))
    }

    /// Two numbers of 32 bits.
    #[inline]
    pub(super) fn pair(&mut self) -> (u32, u32) {
        let bits = self.0.next_u64();
        ((bits >> 32) as u32, bits as u32)
    }

    /// Uniform in 0 .. `end`.
    #[inline]
    pub(super) fn below(&mut self, end: u32) -> u32 {
        scale(self.pair().0, end)
    }

    /// Uniform in [0, 1).
    #[inline]
    pub(super) fn unit(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
    }
}

/// 32 random bits as a number in 0 .. `end`. The probabilities of two numbers differ by 2⁻³² at most.
#[inline]
pub(super) fn scale(bits: u32, end: u32) -> u32 {
    ((u64::from(bits) * u64::from(end)) >> 32) as u32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rng::{Purpose, Seed};

    fn rng() -> ClusterRng {
        ClusterRng::new(Seed { seed: 1, run: 0 }.stream(Purpose::Associator, 0, 0))
    }

    #[test]
    fn numbers_below_an_end_are_equally_frequent() {
        let mut rng = rng();
        let mut counts = [0u32; 7];
        (0..70_000).for_each(|_| counts[rng.below(7) as usize] += 1);
        // Five standard deviations of a count are 463.
        assert!(
            counts.iter().all(|count| count.abs_diff(10_000) < 463),
            "{counts:?}"
        );
        let mean = (0..70_000).map(|_| rng.unit()).sum::<f64>() / 70_000.0;
        assert!((mean - 0.5).abs() < 0.0055, "{mean}");
        assert_eq!((scale(0, 7), scale(u32::MAX, 7)), (0, 6));
    }

    #[test]
    fn the_first_draw_of_a_known_cluster_never_changes() {
        // A golden value: a change here changes every search.
        assert_eq!(rng().pair(), (3_359_891_638, 997_371_684));
    }
}
