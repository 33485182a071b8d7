//! Each track counts by its information: the mean of least variance when the errors of the tracks are independent. When they are
//! not, it claims to know more than it does.
//!
//! # Reference
//! R. A. Singer, A. J. Kanyuck, Computer control of multiple site track correlation, Automatica 7, 1971.
//!
//! # Symbols
//! x̂_s, P_s state and covariance of a member.
//!
//! # Method
//! P = (Σ P_s⁻¹)⁻¹, x̂ = P Σ P_s⁻¹ x̂_s.

use super::{BuildFusion, Fusion, Members};
use crate::math::gaussian::Gaussian;
use crate::model::state::{Covariance, GaussianState, State};
use crate::registry::{Method, Object};

static PARAMETERS: Object = Object {
    name: "WeightedFusion",
    summary: "The mean weighted by information, which takes the errors of the tracks to be independent.",
    fields: &[],
};

pub(super) const METHOD: Method<BuildFusion> = Method {
    name: "weighted",
    parameters: &PARAMETERS,
    build: |_| Ok(Box::new(Weighted)),
};

struct Weighted;

impl Fusion for Weighted {
    fn fuse(&self, members: &Members) -> Option<GaussianState> {
        let information: Covariance = members
            .estimates
            .iter()
            .map(|estimate| estimate.gaussian.inverse())
            .sum();
        let vector: State = members
            .estimates
            .iter()
            .map(|estimate| estimate.gaussian.inverse() * estimate.mean)
            .sum();
        let covariance = *Gaussian::new(&information)?.inverse();
        Some(GaussianState {
            mean: covariance * vector,
            covariance,
        })
    }
}
