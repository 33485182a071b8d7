//! The mean of least variance when the errors of the tracks are correlated and the cross-covariances are known.
//!
//! # Reference
//! Y. Bar-Shalom, L. Campo, The effect of the common process noise on the two-sensor fused-track covariance, IEEE Transactions on
//! Aerospace and Electronic Systems 22, 1986; for more than two K. C. Chang, R. K. Saha, Y. Bar-Shalom, On optimal
//! track-to-track fusion, IEEE Transactions on Aerospace and Electronic Systems 33, 1997.
//!
//! # Symbols
//! x̂_s, P_s state and covariance of a member, P_st cross-covariance of two; z the states one below the other, Σ their joint
//! covariance, E identities one below the other.
//!
//! # Method
//! P = (Eᵀ Σ⁻¹ E)⁻¹, x̂ = P Eᵀ Σ⁻¹ z. For two it is x̂_1 + (P_1 − P_12) (P_1 + P_2 − P_12 − P_21)⁻¹ (x̂_2 − x̂_1).

use super::{BuildFusion, Fusion, Members};
use crate::math::gaussian::Gaussian;
use crate::model::state::{Covariance, GaussianState, State};
use crate::registry::{Method, Object};
use nalgebra::{DMatrix, DVector};

static PARAMETERS: Object = Object {
    name: "ModifiedFusion",
    summary: "The mean of least variance with the job's cross_covariance; the weighted mean where that is none.",
    fields: &[],
};

pub(super) const METHOD: Method<BuildFusion> = Method {
    name: "modified",
    parameters: &PARAMETERS,
    build: |_| Ok(Box::new(Modified)),
};

struct Modified;

impl Fusion for Modified {
    fn fuse(&self, members: &Members) -> Option<GaussianState> {
        let count = members.estimates.len();
        let joint = joint_covariance(members);
        let mut states = DVector::zeros(4 * count);
        let mut identities = DMatrix::zeros(4 * count, 4);
        for (member, estimate) in members.estimates.iter().enumerate() {
            states.rows_mut(4 * member, 4).copy_from(&estimate.mean);
            identities
                .view_mut((4 * member, 0), (4, 4))
                .copy_from(&Covariance::identity());
        }
        let decomposed = joint.cholesky()?;
        let weights = decomposed.solve(&identities);
        let information: Covariance = (identities.transpose() * &weights)
            .fixed_view::<4, 4>(0, 0)
            .into_owned();
        let vector: State = (weights.transpose() * states)
            .fixed_rows::<4>(0)
            .into_owned();
        let covariance = *Gaussian::new(&information)?.inverse();
        Some(GaussianState {
            mean: covariance * vector,
            covariance,
        })
    }
}

/// Σ.
fn joint_covariance(members: &Members) -> DMatrix<f64> {
    let count = members.estimates.len();
    let mut joint = DMatrix::zeros(4 * count, 4 * count);
    let mut place = |row: usize, column: usize, block: &Covariance| {
        joint
            .view_mut((4 * row, 4 * column), (4, 4))
            .copy_from(block)
    };
    for (member, estimate) in members.estimates.iter().enumerate() {
        place(member, member, &estimate.covariance);
    }
    let pairs = (0..count).flat_map(|left| (left + 1..count).map(move |right| (left, right)));
    for ((left, right), cross) in pairs.zip(members.cross) {
        place(left, right, cross);
        place(right, left, &cross.transpose());
    }
    joint
}
