//! Tools: optimal assignment, fuzzy clustering, set packing, Gaussian distances and likelihoods, intervals of means, and named
//! streams of random numbers.

pub mod assignment;
pub mod disjoint_sets;
pub mod fuzzy_c_means;
pub mod gaussian;
pub mod rng;
pub mod semidefinite;
pub mod set_packing;
pub mod stats;
