//! Tools: angles, Gaussian distances and likelihoods, and named streams of random numbers.

pub mod angle;
pub mod gaussian;
pub mod rng;
