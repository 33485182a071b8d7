//! The track that knows its position best, as it is: nothing is gained from the others, and nothing is assumed of their errors.
//!
//! # Symbols
//! P_xx + P_yy the variance of a member's position.
//!
//! # Method
//! At each time the member with the least P_xx + P_yy; the first of several. The choice may change from time to time.

use super::{BuildFusion, Fusion, Members};
use crate::correlation::estimates::AlignedEstimate;
use crate::model::state::GaussianState;
use crate::registry::{Method, Object};

static PARAMETERS: Object = Object {
    name: "BestSensorFusion",
    summary: "At each time the track with the least variance of position, as it is.",
    fields: &[],
};

pub(super) const METHOD: Method<BuildFusion> = Method {
    name: "best_sensor",
    parameters: &PARAMETERS,
    build: |_| Ok(Box::new(BestSensor)),
};

struct BestSensor;

impl Fusion for BestSensor {
    fn fuse(&self, members: &Members) -> Option<GaussianState> {
        let variance =
            |estimate: &AlignedEstimate| estimate.covariance[(0, 0)] + estimate.covariance[(1, 1)];
        let best = members
            .estimates
            .iter()
            .min_by(|left, right| variance(left).total_cmp(&variance(right)))?;
        Some(GaussianState {
            mean: best.mean,
            covariance: best.covariance,
        })
    }
}
