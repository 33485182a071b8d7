//! Covariance intersection: weights of information that sum to 1. Its covariance is never too small, whatever the correlation of the
//! errors, as long as that of each track is not too small; the price is that it gains less than the weighted mean.
//!
//! # Reference
//! S. J. Julier, J. K. Uhlmann, A non-divergent estimation algorithm in the presence of unknown correlations, American Control
//! Conference 1997.
//!
//! # Symbols
//! x̂_1, P_1, x̂_2, P_2 two members; ω weight of the first; x̂, P what comes out.
//!
//! # Method
//! 1. P⁻¹ = ω P_1⁻¹ + (1 − ω) P_2⁻¹, x̂ = P [ω P_1⁻¹ x̂_1 + (1 − ω) P_2⁻¹ x̂_2], ω in [0, 1] such that the determinant of P
//!    (default: it does not depend on units) or its trace is least. Both are convex in ω, so that a golden-section search finds it.
//! 2. Of more than two members the result is fused with the next, in the order of the sensors.

use super::{BuildFusion, Fusion, Members};
use crate::math::gaussian::Gaussian;
use crate::model::state::{Covariance, GaussianState};
use crate::registry::{Kind, Method, Object, default};
use serde::Deserialize;

static PARAMETERS: Object = Object {
    name: "CovarianceIntersectionFusion",
    summary: "Sound under unknown correlation of the errors of the tracks; claims less than the weighted mean.",
    fields: &[default(
        "criterion",
        "What of the covariance is made least: determinant, which does not depend on units, or trace.",
        Kind::Choice(&["determinant", "trace"]),
        "\"determinant\"",
    )],
};

pub(super) const METHOD: Method<BuildFusion> = Method {
    name: "covariance_intersection",
    parameters: &PARAMETERS,
    build: |parameters| Ok(Box::new(CovarianceIntersection::deserialize(parameters)?)),
};

#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
struct CovarianceIntersection {
    criterion: Criterion,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Criterion {
    Determinant,
    Trace,
}

/// P⁻¹ and P⁻¹ x̂.
#[derive(Clone, Copy)]
struct Information {
    matrix: Covariance,
    vector: crate::model::state::State,
}

impl Fusion for CovarianceIntersection {
    fn fuse(&self, members: &Members) -> Option<GaussianState> {
        let informations = members.estimates.iter().map(|estimate| {
            let matrix = *estimate.gaussian.inverse();
            Information {
                matrix,
                vector: matrix * estimate.mean,
            }
        });
        let fused = informations.reduce(|left, right| self.two(&left, &right))?;
        let covariance = *Gaussian::new(&fused.matrix)?.inverse();
        Some(GaussianState {
            mean: covariance * fused.vector,
            covariance,
        })
    }
}

impl CovarianceIntersection {
    fn two(&self, left: &Information, right: &Information) -> Information {
        let weight = golden_section(|weight| self.size(&mix(left, right, weight).matrix));
        mix(left, right, weight)
    }

    /// What is made least, of the P with this inverse.
    fn size(&self, information: &Covariance) -> f64 {
        match self.criterion {
            Criterion::Determinant => -information.determinant(),
            Criterion::Trace => Gaussian::new(information)
                .map_or(f64::INFINITY, |gaussian| gaussian.inverse().trace()),
        }
    }
}

fn mix(left: &Information, right: &Information, weight: f64) -> Information {
    Information {
        matrix: left.matrix * weight + right.matrix * (1.0 - weight),
        vector: left.vector * weight + right.vector * (1.0 - weight),
    }
}

/// Where a function of one dip is least on [0, 1], to 1e-6; an end where that is no worse.
fn golden_section(size: impl Fn(f64) -> f64) -> f64 {
    let ratio = (5f64.sqrt() - 1.0) / 2.0;
    let (mut low, mut high) = (0.0, 1.0);
    let (mut a, mut b) = (1.0 - ratio, ratio);
    let (mut at_a, mut at_b) = (size(a), size(b));
    while high - low > 1e-6 {
        if at_a <= at_b {
            (high, b, at_b) = (b, a, at_a);
            a = high - ratio * (high - low);
            at_a = size(a);
        } else {
            (low, a, at_a) = (a, b, at_b);
            b = low + ratio * (high - low);
            at_b = size(b);
        }
    }
    let middle = (low + high) / 2.0;
    [0.0, 1.0].into_iter().fold(
        middle,
        |best, end| if size(end) <= size(best) { end } else { best },
    )
}
