//! How probable it is that a track has a target: integrated probabilistic data association, for one track and for many at once.
//!
//! # Reference
//! D. Musicki, R. Evans, S. Stankovic, Integrated Probabilistic Data Association, IEEE Transactions on Automatic Control 39(6),
//! 1994; D. Musicki, R. Evans, Joint Integrated Probabilistic Data Association, IEEE Transactions on Aerospace and Electronic
//! Systems 40(3), 2004.
//!
//! # Symbols
//! r probability of existence; p_S that of surviving dt; P_D, P_G probability of detection and of the gate; N density of a
//! detection around what is expected; λ clutter density; βⱼ weight of detection j, β₀ of none; Λ likelihood ratio of a scan;
//! b tracks confirmed so far, c detections so far that were clutter, each as far as it probably was.
//!
//! # Method
//! 1. r ← p_S r with p_S = e^(−dt / `lifetime_s`).
//! 2. A row of the problem has r P_D for P_D: ln(r P_D N / λ) for a detection, ln(1 − r P_D P_G) for none. So tentative and
//!    confirmed tracks compete in one problem, each by how probable it is.
//! 3. Soft weights: a missed target exists with m = (1 − P_D P_G) r / (1 − P_D P_G r); r' = Σ βⱼ + β₀ m, and the track is updated
//!    by βⱼ / r' and β₀ m / r', which sum to 1.
//! 4. A hard association says nothing of how sure it is, so r' = r Λ / (1 − r + r Λ) with Λ = P_D N / λ of the chosen detection
//!    or 1 − P_D P_G. With one candidate this is step 3 where the detection is the track's or clutter.
//! 5. A new track of one detection has r = (1 + b) / (2 + b + c): how often such a detection was a target; at least twice what deletes
//!    a track, so that targets are found after long clutter.
//!
//! A sensor that is not taken to see a track ([`super::lifecycle`]) says nothing by a miss: then m = r.

use crate::association::problem::{ScanProblem, Weights};
use crate::registry::{Bound, Field, Kind, Object, above, default};
use crate::tracking::bits;
use serde::{Deserialize, Serialize};

/// The parameters of [`EXISTENCE`].
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct ExistenceRule {
    pub confirm_existence: f64,
    pub delete_existence: f64,
    pub lifetime_s: f64,
    /// Points are told only where r is above this.
    #[serde(skip)]
    pub report_existence: f64,
}

pub(super) static EXISTENCE: Object = Object {
    name: "ExistenceConfirmation",
    summary: "The probability that the track has a target: integrated probabilistic data association (Musicki et al. 1994, 2004). Tentative and confirmed tracks compete in one problem.",
    fields: &[
        default(
            "confirm_existence",
            "A track is confirmed once its probability of existence is this or more.",
            Kind::Number {
                min: Bound::Including(0.5),
                max: Bound::Excluding(1.0),
                unit: "",
            },
            "0.95",
        ),
        default(
            "delete_existence",
            "A track is deleted when its probability of existence is this or less.",
            Kind::Number {
                min: Bound::Including(1e-6),
                max: Bound::Excluding(0.5),
                unit: "",
            },
            "0.01",
        ),
        LIFETIME,
    ],
};

pub(super) const LIFETIME: Field = default(
    "lifetime_s",
    "How long a target lasts on average: it survives dt with the probability e^(-dt/lifetime_s).",
    above(0.0, 1e9, "s"),
    "1000.0",
);

/// What a scan leaves of a track.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Posterior {
    /// r'.
    pub existence: f64,
    /// Weights of detections times this are those of a target that exists.
    pub scale: f64,
    /// The weight of none, of a target that exists.
    pub missed: f64,
}

/// Surely without a target.
const GONE: Posterior = Posterior {
    existence: 0.0,
    scale: 0.0,
    missed: 1.0,
};

/// Step 1.
pub(super) fn survival(dt_s: f64, lifetime_s: f64) -> f64 {
    (-dt_s / lifetime_s).exp()
}

/// r' = r Λ / (1 − r + r Λ).
pub(super) fn by_ratio(existence: f64, log_ratio: f64) -> f64 {
    if existence >= 1.0 {
        return 1.0;
    }
    // Of the odds' logarithm, which neither overflows nor loses what is near 1.
    let log_odds = existence.ln() - (-existence).ln_1p() + log_ratio;
    1.0 / (1.0 + (-log_odds).exp())
}

/// Steps 3 and 4 of a row whose track existed with probability `existence`; `detectable` is P_D P_G, 0 where a miss says nothing.
pub(super) fn after(
    (problem, weights, row): (&ScanProblem, &Weights, usize),
    existence: f64,
    detectable: f64,
    is_soft: bool,
) -> Posterior {
    let edges = problem.rows()[row].edges();
    let missed = weights.missed[row];
    let if_missed = (1.0 - detectable) * existence / (1.0 - detectable * existence);
    if is_soft {
        let detected: f64 = weights.edges[edges].iter().sum();
        let (after, missed) = (detected + missed * if_missed, missed * if_missed);
        if after <= 0.0 {
            return GONE;
        }
        return Posterior {
            existence: after.min(1.0),
            scale: 1.0 / after,
            missed: missed / after,
        };
    }
    let chosen = edges.into_iter().find(|&edge| weights.edges[edge] > 0.0);
    let log_ratio = chosen.map(|edge| problem.edges()[edge].log_likelihood - existence.ln());
    Posterior {
        existence: log_ratio.map_or(if_missed, |ratio| by_ratio(existence, ratio)),
        scale: 1.0,
        missed,
    }
}

/// b and c.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Counted {
    #[serde(with = "bits")]
    pub targets: f64,
    #[serde(with = "bits")]
    pub clutter: f64,
}

impl Counted {
    /// (1 + b) / (1 + c): how much more often a detection that no track wants was a target than clutter.
    pub fn odds(&self) -> f64 {
        (1.0 + self.targets) / (1.0 + self.clutter)
    }

    /// Step 5.
    pub fn existence(&self) -> f64 {
        (1.0 + self.targets) / (2.0 + self.targets + self.clutter)
    }
}

#[cfg(test)]
mod tests;
