//! From the estimates of tracks to a problem: which pairs are linked, and what a tuple costs.
//!
//! # Reference
//! Huo Liang et al. 2008, equations 6 to 11 (the chain); S. Deb, M. Yeddanapudi, K. Pattipati, Y. Bar-Shalom, A generalized S-D
//! assignment algorithm for multisensor-multitarget state estimation, IEEE Transactions on Aerospace and Electronic Systems 33,
//! 1997 (the likelihood ratio).
//!
//! # Symbols
//! λ, Q of [`Evidence`](super::evidence::Evidence); δ(ν) the quantile of chi-square with ν degrees of freedom at 1 − α; n_x numbers of
//! a state; k common times; β_T, β_F densities of targets and of false tracks in the space of states; P_s probability that sensor s
//! has a track of a target, u_s = β_F + β_T P_s Π (1 − P_r) over the other sensors r.
//!
//! # Method
//! 1. A pair of different sensors is linked when λ is small enough. `chain`: λ < δ(k n_x), for a link of positive cost is never worth
//!    it: the tuple without it costs less. The others: λ / k within the gate, the quantile with n_x degrees of freedom at the gate's
//!    probability, since a link that is bad by itself may be part of a good tuple.
//! 2. The cost of a link is λ − δ(k n_x). `chain` adds those of neighbours in the order of the sensors, `all_pairs` those of all pairs.
//! 3. `fused`: Q − (m − 1) δ(ν / (m − 1)), ν the degrees of freedom of Q, m members: each of the m − 1 links that hold the tuple
//!    together allows as much as a link by itself, (m − 1) δ(k n_x). With δ(ν), which grows more slowly than ν, tuples of all tracks
//!    would be worth less than the pairs that they can be divided into, and pairs of strangers worth more.
//! 4. `likelihood_ratio`: −ln[β_T Π P_s Π (1 − P_r) ∫ Π N(x̂_s; x, P_s) dx / Π u_s], s of the tuple, r the absent sensors. Errors of
//!    tracks are correlated in time, so that k times count as one: the logarithm of the integral is its mean over them.
//!
//! A track alone costs 0 in all of them.

use super::candidates::candidates;
use super::cross_covariance::CrossTable;
use super::estimates::Estimates;
use super::evidence::{Evidence, Spread, Times};
use super::problem::{CorrelationProblem, Costs, JointCost};
use crate::math::gaussian::{chi_square_quantile, chi_square_tail};
use crate::registry::{Bound, Field, Kind, Object, Union, above, default, optional, variant};
use serde::Deserialize;
use std::sync::Arc;

/// Pairs that are looked at, of one problem.
pub const MAX_PAIRS: usize = 500_000;

/// Times that tracks are compared at, over all pairs.
pub const MAX_COMPARISONS: usize = 20_000_000;

const ALPHA: Field = default(
    "alpha",
    "α: share of the tracks of one target that are taken apart when errors are as their covariances say and white in time.",
    Kind::Number {
        min: Bound::Excluding(0.0),
        max: Bound::Excluding(1.0),
        unit: "",
    },
    "0.01",
);

const K: Field = default(
    "k",
    "all: sum over all common times, sound when errors are white in time; latest: the latest common time alone.",
    Kind::Choice(&["all", "latest"]),
    "\"all\"",
);

const GATE: Field = default(
    "gate_probability",
    "A pair is linked when its mean squared distance a time is below the chi-square quantile of this probability.",
    Kind::Number {
        min: Bound::Excluding(0.0),
        max: Bound::Excluding(1.0),
        unit: "",
    },
    "0.9999",
);

const fn density(name: &'static str, summary: &'static str) -> Field {
    let kind = above(0.0, 1e12, "");
    optional(name, summary, kind)
}

static CHAIN: Object = Object {
    name: "ChainStatistic",
    summary: "b of Huo et al. 2008: the sum of λ − δ over neighbours in the order of the sensors; an absent sensor is skipped.",
    fields: &[ALPHA, K],
};

static ALL_PAIRS: Object = Object {
    name: "AllPairsStatistic",
    summary: "The sum of λ − δ over all pairs of a tuple.",
    fields: &[ALPHA, K, GATE],
};

static FUSED: Object = Object {
    name: "FusedStatistic",
    summary: "Squared distances from the information-weighted mean of the tuple, less the quantile of a link for each track but one.",
    fields: &[ALPHA, K, GATE],
};

static LIKELIHOOD_RATIO: Object = Object {
    name: "LikelihoodRatioStatistic",
    summary: "Minus the logarithm of how much more probable one target is than separate tracks; uses the probability that a sensor has a track.",
    fields: &[
        K,
        GATE,
        default(
            "p_d",
            "Probability that a sensor has a track of a target, for sensors whose settings do not say.",
            Kind::Number {
                min: Bound::Excluding(0.0),
                max: Bound::Excluding(1.0),
                unit: "",
            },
            "0.9",
        ),
        density(
            "target_density",
            "β_T: targets per unit of the space of states, 1/(m²·(m/s)²), or 1/m² where tracks have no velocity; told from the tracks when absent.",
        ),
        density(
            "false_density",
            "β_F: false tracks of a sensor per the same unit; a tenth of the target density when absent.",
        ),
    ],
};

pub static STATISTIC: Union = Union {
    name: "Statistic",
    summary: "What a tuple of tracks costs.",
    tag: "kind",
    variants: || {
        vec![
            variant("chain", &CHAIN),
            variant("all_pairs", &ALL_PAIRS),
            variant("fused", &FUSED),
            variant("likelihood_ratio", &LIKELIHOOD_RATIO),
        ]
    },
};

/// A checked statistic.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Statistic {
    Chain {
        alpha: f64,
        k: Times,
    },
    AllPairs {
        alpha: f64,
        k: Times,
        gate_probability: f64,
    },
    Fused {
        alpha: f64,
        k: Times,
        gate_probability: f64,
    },
    LikelihoodRatio {
        k: Times,
        gate_probability: f64,
        p_d: f64,
        target_density: Option<f64>,
        false_density: Option<f64>,
    },
}

impl Statistic {
    pub fn name(&self) -> &'static str {
        match self {
            Statistic::Chain { .. } => "chain",
            Statistic::AllPairs { .. } => "all_pairs",
            Statistic::Fused { .. } => "fused",
            Statistic::LikelihoodRatio { .. } => "likelihood_ratio",
        }
    }

    pub fn times(&self) -> Times {
        match *self {
            Statistic::Chain { k, .. }
            | Statistic::AllPairs { k, .. }
            | Statistic::Fused { k, .. }
            | Statistic::LikelihoodRatio { k, .. } => k,
        }
    }

    /// α, of the statistics that have one.
    pub fn alpha(&self) -> Option<f64> {
        match *self {
            Statistic::Chain { alpha, .. }
            | Statistic::AllPairs { alpha, .. }
            | Statistic::Fused { alpha, .. } => Some(alpha),
            Statistic::LikelihoodRatio { .. } => None,
        }
    }

    /// The probability of the quantile below which a pair's mean squared distance a time may lie.
    fn gate_probability(&self) -> f64 {
        match *self {
            // δ(k n_x) / k is largest for k = 1.
            Statistic::Chain { alpha, .. } => 1.0 - alpha,
            Statistic::AllPairs {
                gate_probability, ..
            }
            | Statistic::Fused {
                gate_probability, ..
            }
            | Statistic::LikelihoodRatio {
                gate_probability, ..
            } => gate_probability,
        }
    }

    fn gate(&self, dimensions: usize) -> f64 {
        chi_square_quantile(self.gate_probability(), dimensions as f64)
    }
}

/// Pairs that may be linked, ascending.
///
/// # Errors
/// How many there are, when they are more than this machine should compare: pairs, or pairs times common times.
pub fn pairs_of(estimates: &Estimates, statistic: &Statistic) -> Result<Vec<(u32, u32)>, String> {
    let limit = MAX_PAIRS.min(MAX_COMPARISONS / estimates.times().max(1));
    candidates(estimates, statistic.gate(estimates.dimensions()), limit).ok_or_else(|| {
        format!(
            "the {} tracks are near each other in more than {limit} pairs, each at up to {} times: more than about {:.0} s of comparing",
            estimates.tracks(),
            estimates.times(),
            // Reckoned with 0.4 µs a pair and time.
            limit as f64 * estimates.times() as f64 * 4e-7
        )
    })
}

/// δ of the degrees of freedom of a link, by multiples of n_x.
#[derive(Debug, Clone)]
struct Thresholds {
    dimensions: usize,
    of_multiple: Vec<f64>,
}

impl Thresholds {
    fn new(alpha: f64, dimensions: usize, multiples: usize) -> Self {
        let of_multiple = (0..=multiples).map(|count| match count {
            0 => 0.0,
            _ => chi_square_quantile(1.0 - alpha, (count * dimensions) as f64),
        });
        Thresholds {
            dimensions,
            of_multiple: of_multiple.collect(),
        }
    }

    fn at(&self, degrees_of_freedom: usize) -> f64 {
        self.of_multiple[degrees_of_freedom / self.dimensions]
    }

    /// (m − 1) δ(ν / (m − 1)) of a tuple; straight between the multiples of n_x, where not all members are there at all times.
    fn of_tuple(&self, degrees_of_freedom: usize, members: usize) -> f64 {
        let (times, links) = (degrees_of_freedom / self.dimensions, members - 1);
        let (whole, rest) = (times / links, times % links);
        let below = (links - rest) as f64 * self.of_multiple[whole];
        match rest {
            0 => below,
            _ => below + rest as f64 * self.of_multiple[whole + 1],
        }
    }
}

/// Builds problems of one set of estimates, one for each number of times that is looked at.
pub struct Correlation {
    pub statistic: Statistic,
    pub estimates: Arc<Estimates>,
    pub cross: Option<Arc<CrossTable>>,
    /// Where tracks may be linked, of [`pairs_of`].
    pub pairs: Vec<(u32, u32)>,
    /// P_s of each sensor.
    pub p_d: Vec<f64>,
}

impl Correlation {
    /// The evidence of the first `until` times.
    pub fn evidence(&self, until: usize) -> Evidence {
        Evidence {
            estimates: self.estimates.clone(),
            cross: self.cross.clone(),
            times: self.statistic.times(),
            until,
        }
    }

    pub fn problem(&self, until: usize) -> CorrelationProblem {
        let evidence = self.evidence(until);
        let problem = self.problem_of(evidence.clone());
        if evidence.cross.is_none() {
            return problem;
        }
        problem.with_independent(self.problem_of(Evidence {
            cross: None,
            ..evidence
        }))
    }

    fn problem_of(&self, evidence: Evidence) -> CorrelationProblem {
        let until = evidence.until;
        let links = self.links(&evidence);
        let costs = match self.statistic {
            Statistic::Chain { .. } => Costs::Chain,
            Statistic::AllPairs { .. } => Costs::AllPairs,
            Statistic::Fused { alpha, .. } => {
                let thresholds = Thresholds::new(alpha, self.estimates.dimensions(), until);
                Costs::Joint(Box::new(Fused {
                    evidence: evidence.clone(),
                    thresholds,
                }))
            }
            Statistic::LikelihoodRatio { .. } => {
                Costs::Joint(Box::new(self.likelihood_ratio(evidence.clone())))
            }
        };
        CorrelationProblem::new(&self.estimates.tracks_of, &links, costs).with_evidence(evidence)
    }

    /// The linked pairs with their costs.
    fn links(&self, evidence: &Evidence) -> Vec<(u32, u32, f64)> {
        let dimensions = self.estimates.dimensions();
        let gate = self.statistic.gate(dimensions);
        let ratio = matches!(self.statistic, Statistic::LikelihoodRatio { .. })
            .then(|| self.likelihood_ratio(evidence.clone()));
        let thresholds = self
            .statistic
            .alpha()
            .map(|alpha| Thresholds::new(alpha, dimensions, evidence.until));
        let link = |&(a, b): &(u32, u32)| {
            let pair = evidence.pair(a, b)?;
            let cost = match (&thresholds, &ratio) {
                (Some(thresholds), _) => pair.lambda - thresholds.at(pair.times * dimensions),
                (None, Some(ratio)) => ratio.cost(&[a, b]),
                (None, None) => return None,
            };
            let is_linked = match self.statistic {
                Statistic::Chain { .. } => cost < 0.0,
                _ => pair.lambda <= gate * pair.times as f64 && cost.is_finite(),
            };
            is_linked.then_some((a, b, cost))
        };
        self.pairs.iter().filter_map(link).collect()
    }

    fn likelihood_ratio(&self, evidence: Evidence) -> LikelihoodRatio {
        let (target_density, false_density) = self.densities().unwrap_or((1.0, 0.1));
        let log_absent: Vec<f64> = self.p_d.iter().map(|p_d| (1.0 - p_d).ln()).collect();
        let all_absent: f64 = log_absent.iter().sum();
        // −ln P_s + ln(1 − P_s) + ln u_s: what a track in a tuple changes against its sensor's absence.
        let of_member = |(p_d, absent): (&f64, &f64)| {
            let alone = false_density + target_density * p_d * (all_absent - absent).exp();
            alone.ln() - p_d.ln() + absent
        };
        let of_sensor = self.p_d.iter().zip(&log_absent).map(of_member).collect();
        LikelihoodRatio {
            evidence,
            base: -target_density.ln() - all_absent,
            of_sensor,
            sensors: self.estimates.sensors_of_tracks(),
        }
    }

    /// β_T and β_F: as given, or told from the tracks: the most that a sensor has, over what all of them cover.
    pub fn densities(&self) -> Option<(f64, f64)> {
        let Statistic::LikelihoodRatio {
            target_density,
            false_density,
            ..
        } = self.statistic
        else {
            return None;
        };
        let target_density = target_density.unwrap_or_else(|| {
            let most = self.estimates.tracks_of.iter().copied().max().unwrap_or(1);
            most as f64 / extent(&self.estimates)
        });
        Some((
            target_density,
            false_density.unwrap_or(target_density / 10.0),
        ))
    }
}

/// The size of the box around all states, each with one standard deviation on either side.
fn extent(estimates: &Estimates) -> f64 {
    (0..estimates.dimensions())
        .map(|axis| side(estimates, axis))
        .product()
}

/// The length along an axis of what the estimates reach within one standard deviation.
fn side(estimates: &Estimates, axis: usize) -> f64 {
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for track in 0..estimates.tracks() as u32 {
        for estimate in estimates.of_track(track).iter().flatten() {
            let sigma = estimate.covariance[(axis, axis)].sqrt();
            low = low.min(estimate.mean[axis] - sigma);
            high = high.max(estimate.mean[axis] + sigma);
        }
    }
    high - low
}

/// Q − (m − 1) δ.
struct Fused {
    evidence: Evidence,
    thresholds: Thresholds,
}

impl JointCost for Fused {
    fn cost(&self, tuple: &[u32]) -> f64 {
        let spread = self.evidence.spread(tuple);
        spread.q
            - self
                .thresholds
                .of_tuple(spread.degrees_of_freedom, tuple.len())
    }
}

struct LikelihoodRatio {
    evidence: Evidence,
    /// −ln β_T − Σ ln(1 − P_r) over all sensors.
    base: f64,
    /// For each sensor ln u_s − ln P_s + ln(1 − P_s).
    of_sensor: Vec<f64>,
    sensors: Vec<usize>,
}

impl JointCost for LikelihoodRatio {
    fn cost(&self, tuple: &[u32]) -> f64 {
        let spread = self.evidence.spread(tuple);
        let of_members: f64 = tuple
            .iter()
            .map(|&track| self.of_sensor[self.sensors[track as usize]])
            .sum();
        self.base + of_members - spread.log_density / spread.times.max(1) as f64
    }
}

/// The p-value of a tuple's Q; `None` for one that says nothing together.
pub fn p_value(spread: &Spread) -> Option<f64> {
    (spread.degrees_of_freedom > 0)
        .then(|| chi_square_tail(spread.q, spread.degrees_of_freedom as f64))
}
