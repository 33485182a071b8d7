//! The modified weighted method: as [`super::weighted`], but with what the errors of two tracks have in common, since both filters
//! met the same process noise.
//!
//! # Reference
//! Y. Bar-Shalom, On the track-to-track correlation problem, IEEE Trans. Automatic Control 26, 1981, 571–572.
//!
//! # Symbols
//! C = Pᵢ + Pⱼ − Pᵢⱼ − Pᵢⱼᵀ covariance of the difference of two estimates, Pᵢⱼ their cross-covariance.
//!
//! # Method
//! The steps of [`super::weighted`] on the costs of the problem, which hold C. Without cross-covariances the two methods are one.

use super::bound::dual_bound;
use super::problem::CorrelationProblem;
use super::weighted::weighted_tuples;
use super::{BuildCorrelator, Correlator, Solution};
use crate::model::fault::Fault;
use crate::registry::{Method, Object};

pub const METHOD: Method<BuildCorrelator> = Method {
    name: "modified",
    parameters: &PARAMETERS,
    build: |_, _| Ok(Box::new(Modified)),
};

static PARAMETERS: Object = Object {
    name: "ModifiedCorrelator",
    summary: "Sensor by sensor the assignment of least cost, with what cross_covariance says the errors of two tracks have in common.",
    fields: &[],
};

#[derive(Debug)]
struct Modified;

impl Correlator for Modified {
    fn correlate(&mut self, problem: &CorrelationProblem) -> Result<Solution, Vec<Fault>> {
        Ok(
            Solution::from_tuples(problem, weighted_tuples(problem))
                .with_bound(dual_bound(problem)),
        )
    }
}
