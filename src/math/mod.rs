//! Tools: Gaussian distances and likelihoods, and named streams of random numbers.

pub mod gaussian;
pub mod rng;
