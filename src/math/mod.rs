//! Tools: angles, optimal assignment, Gaussian distances and likelihoods, and named streams of random numbers.

pub mod angle;
pub mod assignment;
pub mod gaussian;
pub mod rng;
