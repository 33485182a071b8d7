//! The tracker of Poisson multi-Bernoulli filtering: undetected targets are a Poisson process, each track exists with a probability,
//! and one joint problem a scan weighs both.
//!
//! # Reference
//! J. L. Williams, Marginal Multi-Bernoulli Filters: RFS Derivation of MHT, JIPDA, and Association-Based MeMBer, IEEE Transactions
//! on Aerospace and Electronic Systems 51(3), 2015.
//!
//! # Method
//! That of [`super::single_hypothesis`] with a life cycle by existence ([`super::single_hypothesis::existence`]) and beginnings from
//! what was never detected ([`super::single_hypothesis::undetected`]). Without births it is joint integrated probabilistic data
//! association. Any associator serves; its weights are the marginals.

use super::single_hypothesis::build;
use super::{
    BuildTracker, Confirmation, ExistenceRule, LIFECYCLE, Lifecycle, TrackerParts, Undetected,
};
use crate::registry::Method;

pub const NAME: &str = "poisson_multi_bernoulli";

pub const METHOD: Method<BuildTracker> = Method {
    name: NAME,
    parameters: &LIFECYCLE,
    build: |parts| {
        let undetected = parts.undetected.unwrap_or_default();
        build(TrackerParts {
            lifecycle: lifecycle(parts.lifecycle, &undetected),
            undetected: Some(undetected),
            ..parts
        })
    },
};

/// A track lives as long as it is not one of the undetected targets again, and its points are told where it is probable.
fn lifecycle(lifecycle: Lifecycle, undetected: &Undetected) -> Lifecycle {
    Lifecycle {
        confirmation: Confirmation::Existence(ExistenceRule {
            confirm_existence: undetected.report_existence,
            delete_existence: undetected.recycle_existence,
            lifetime_s: undetected.lifetime_s,
            report_existence: undetected.report_existence,
        }),
        ..lifecycle
    }
}
