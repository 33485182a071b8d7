//! When a track is believed: M of its last N scans had a detection, its score passed a threshold, or its probability of existence
//! did ([`super::existence`]). The score sums what
//! each scan says for "there is a target" against "this is all clutter", and is Wald's sequential test of the two.
//!
//! # Reference
//! S. S. Blackman, R. Popoli, Design and Analysis of Modern Tracking Systems, 1999, section 6.2; A. Wald, Sequential Tests of
//! Statistical Hypotheses, Annals of Mathematical Statistics 16, 1945.
//!
//! # Symbols
//! L the score; Λ likelihood ratio of a scan; βⱼ weight of detection j, β₀ of none; ν, S innovation and its covariance;
//! P_D, P_G probability of detection and of the gate; λ clutter density; α false, β missed track probability; V the volume of
//! the places within reach of a first point.
//!
//! # Method
//! 1. L = 0 at the first detection. The second one of a pair adds ln(P_D / (λ V)): it could have been anywhere in V.
//!    A scan of the sensor between the two adds what a miss does.
//! 2. L ← L + ln Λ with Λ = Σ βⱼ P_D N(νⱼ; 0, S) / λ + β₀ (1 − P_D P_G). A hard association has one β of 1: ln(P_D N / λ) for
//!    its detection, ln(1 − P_D P_G) for a miss. Soft weights give the mixture.
//! 3. A tentative track is confirmed when L ≥ ln((1 − β) / α) and dropped when L ≤ ln(β / (1 − α)).
//! 4. A confirmed track is deleted when L has fallen by `max_score_drop` below its highest value.

use super::existence::{EXISTENCE, ExistenceRule};
use crate::association::problem::{ScanProblem, Weights};
use crate::registry::{Bound, Kind, Object, Union, above, default, variant};
use crate::tracking::bits;
use serde::{Deserialize, Serialize};

/// When a track is confirmed.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(tag = "rule", rename_all = "snake_case")]
pub enum Confirmation {
    MOfN,
    Score(ScoreRule),
    Existence(ExistenceRule),
}

/// The parameters of [`SCORE`].
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct ScoreRule {
    pub false_track_probability: f64,
    pub missed_track_probability: f64,
    pub max_score_drop: f64,
}

static M_OF_N: Object = Object {
    name: "MOfNConfirmation",
    summary: "confirm_hits of the last confirm_window scans had a detection.",
    fields: &[],
};

static SCORE: Object = Object {
    name: "ScoreConfirmation",
    summary: "Sequential test of the track's log-likelihood ratio of target to clutter (Wald 1945; Blackman, Popoli 1999).",
    fields: &[
        default(
            "false_track_probability",
            "α: share of the tracks started by clutter that may be confirmed.",
            HALF,
            "0.001",
        ),
        default(
            "missed_track_probability",
            "β: share of the tracks started by targets that may be dropped unconfirmed.",
            HALF,
            "0.05",
        ),
        default(
            "max_score_drop",
            "A confirmed track is deleted when its score (a natural logarithm) has fallen this far below its highest value.",
            above(0.0, 1000.0, ""),
            "10.0",
        ),
    ],
};

/// Below one half each, so that the threshold of confirmation is positive and that of dropping negative.
const HALF: Kind = Kind::Number {
    min: Bound::Excluding(0.0),
    max: Bound::Excluding(0.5),
    unit: "",
};

pub(super) static CONFIRMATION: Union = Union {
    name: "Confirmation",
    summary: "When a track is confirmed, and by its score or its existence deleted.",
    tag: "rule",
    variants: || {
        vec![
            variant("m_of_n", &M_OF_N),
            variant("score", &SCORE),
            variant("existence", &EXISTENCE),
        ]
    },
};

/// L, and the highest that it was.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Score {
    #[serde(with = "bits")]
    current: f64,
    #[serde(with = "bits")]
    highest: f64,
}

impl Score {
    /// Step 2.
    pub fn add(&mut self, log_ratio: f64) {
        self.current += log_ratio;
        self.highest = self.highest.max(self.current);
    }
}

impl ScoreRule {
    /// Step 3.
    pub(super) fn is_confirmed(&self, score: &Score) -> bool {
        score.current >= ((1.0 - self.missed_track_probability) / self.false_track_probability).ln()
    }

    /// Steps 3 and 4.
    pub(super) fn is_over(&self, score: &Score, is_confirmed: bool) -> bool {
        if is_confirmed {
            score.highest - score.current >= self.max_score_drop
        } else {
            score.current
                <= (self.missed_track_probability / (1.0 - self.false_track_probability)).ln()
        }
    }
}

/// ln Λ of one row of the problem.
pub(super) fn log_ratio(problem: &ScanProblem, weights: &Weights, row: usize) -> f64 {
    let row_of = &problem.rows()[row];
    let terms = || {
        let detections = row_of
            .edges()
            .map(|edge| (weights.edges[edge], problem.edges()[edge].log_likelihood));
        detections
            .chain([(weights.missed[row], row_of.log_missed)])
            .filter(|(weight, _)| *weight > 0.0)
    };
    let largest = terms()
        .map(|(_, log_likelihood)| log_likelihood)
        .fold(f64::NEG_INFINITY, f64::max);
    largest
        + terms()
            .map(|(weight, log_likelihood)| weight * (log_likelihood - largest).exp())
            .sum::<f64>()
            .ln()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::association::problem::Edge;

    #[test]
    fn the_ratio_of_a_scan_is_the_mixture_of_its_weights() {
        // P_D N / λ is 30 and 10 for the two detections; 1 − P_D P_G = 0.1. With β = 0.6, 0.3 and 0.1: 18 + 3 + 0.01.
        let mut problem = ScanProblem::default();
        for (detection, ratio) in [(0, 30.0f64), (1, 10.0)] {
            problem.push_edge(Edge {
                detection,
                squared_distance: 1.0,
                log_likelihood: ratio.ln(),
            });
        }
        problem.end_row(0.1f64.ln(), 0.0);
        let mut weights = Weights::default();
        weights.reset(&problem);
        assert!(
            (log_ratio(&problem, &weights, 0) - 0.1f64.ln()).abs() < 1e-12,
            "nothing chosen yet: a miss"
        );
        weights.edges.copy_from_slice(&[0.6, 0.3]);
        weights.missed[0] = 0.1;
        assert!((log_ratio(&problem, &weights, 0) - 21.01f64.ln()).abs() < 1e-12);
        weights.edges.copy_from_slice(&[0.0, 1.0]);
        weights.missed[0] = 0.0;
        assert!((log_ratio(&problem, &weights, 0) - 10.0f64.ln()).abs() < 1e-12);
    }

    #[test]
    fn the_thresholds_are_walds() {
        // α = 0.01, β = 0.1: ln(0.9 / 0.01) = 4.4998 and ln(0.1 / 0.99) = −2.2925.
        let rule = ScoreRule {
            false_track_probability: 0.01,
            missed_track_probability: 0.1,
            max_score_drop: 3.0,
        };
        let at = |scores: &[f64]| {
            scores.iter().fold(Score::default(), |mut score, &step| {
                (score.add(step), score).1
            })
        };
        assert!(rule.is_confirmed(&at(&[4.5])) && !rule.is_confirmed(&at(&[4.499])));
        assert!(rule.is_over(&at(&[-2.293]), false) && !rule.is_over(&at(&[-2.292]), false));
        assert!(rule.is_over(&at(&[7.0, -3.0]), true) && !rule.is_over(&at(&[7.0, -2.9]), true));
        assert!(
            rule.is_over(&at(&[5.0, -1.0, 2.0, -1.5, -1.5]), true),
            "the fall is from 6, not from the start"
        );
    }
}
