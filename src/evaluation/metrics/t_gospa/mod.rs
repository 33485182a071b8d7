//! Trajectory GOSPA: how far whole tracks are from whole truths. Errors of position, missed truths and false tracks count at
//! every step as in GOSPA, and every change of a truth's track costs a switch: the one number for identity in metres.
//!
//! # Reference
//! Á. F. García-Fernández, A. S. Rahmathullah, L. Svensson, A Metric on the Space of Finite Sets of Trajectories for
//! Evaluation of Multi-Target Tracking Algorithms, IEEE Trans. Signal Processing 68, 2020, 3917–3928.
//!
//! # Symbols
//! c cutoff, p order, γ switch penalty, d distance.
//!
//! # Method
//! 1. T-GOSPAᵖ = min Σ dᵖ + cᵖ/2 (missed + false) + γᵖ switches, over all ways to assign tracks to truths at every step.
//!    A change from one track to another is one switch, a loss or a find one half.
//! 2. [`problem`] cuts it into clusters that do not touch; [`exact`] solves each by dynamic programming; what is too
//!    entangled for that, [`linear_programme`] bounds from below. The report says which was used.
//! 3. Several sequences add up their p-th powers. `t_gospa_per_step` is (T-GOSPAᵖ / steps)^(1/p).

mod exact;
mod linear_programme;
mod problem;

use self::problem::{Tally, clusters};
use super::cutoff::{CUTOFF_M, Cutoff, ORDER};
use super::{BuildMetric, Metric, MetricReport, Quantity, Sequence};
use crate::evaluation::comparison::{Comparison, Shape};
use crate::registry::{Bound, Kind, Method, Object, default};
use serde::Deserialize;
use serde_json::json;

pub const METHOD: Method<BuildMetric> =
    Method { name: "t_gospa", parameters: &PARAMETERS, build: |spec| Ok(Box::new(TGospa::deserialize(spec)?)) };

static PARAMETERS: Object = Object {
    name: "TGospa",
    summary: "GOSPA over whole trajectories, with a price on every switch of tracks.",
    fields: &[
        CUTOFF_M,
        ORDER,
        default(
            "switch_penalty_m",
            "The penalty gamma of a truth's change of track.",
            Kind::Number { min: Bound::Including(0.0), max: Bound::Including(1e7), unit: "m" },
            "20.0",
        ),
    ],
};

#[derive(Deserialize)]
struct TGospa {
    #[serde(flatten)]
    cutoff: Cutoff,
    switch_penalty_m: f64,
}

/// Over all sequences.
#[derive(Default)]
struct Total {
    tally: Tally,
    truths: f64,
    tracks: f64,
    steps: f64,
    exact: usize,
    /// Clusters by linear programming: with whole numbers, and with fractions or cut into blocks.
    whole: usize,
    bounded: usize,
    is_unsolved: bool,
}

impl Metric for TGospa {
    fn accepts(&self, shape: Shape) -> bool {
        shape == Shape::Points
    }

    fn reach_m(&self, _: f64) -> f64 {
        self.cutoff.cutoff_m
    }

    fn evaluate(&self, sequences: &[Sequence]) -> MetricReport {
        let mut total = Total::default();
        for sequence in sequences {
            self.add(sequence.comparison, &mut total);
        }
        let Cutoff { cutoff_m, p } = self.cutoff;
        let parameters = json!({
            "cutoff_m": cutoff_m,
            "p": p,
            "switch_penalty_m": self.switch_penalty_m,
            "method": total.method(),
        });
        MetricReport::new("t_gospa", false, parameters, self.quantities(&total))
    }
}

impl TGospa {
    fn penalty(&self) -> f64 {
        self.cutoff.share_of(self.switch_penalty_m)
    }

    fn add(&self, comparison: &Comparison, total: &mut Total) {
        total.truths += comparison.truths.len() as f64;
        total.tracks += comparison.tracks.len() as f64;
        total.steps += comparison.steps.len() as f64;
        for cluster in clusters(comparison, self.cutoff) {
            if let Some(tally) = exact::solve(&cluster, self.penalty()) {
                total.tally += tally;
                total.exact += 1;
                continue;
            }
            match linear_programme::solve(&cluster.steps, self.penalty()) {
                Some(bound) => {
                    total.tally += bound.tally;
                    *if bound.is_exact { &mut total.whole } else { &mut total.bounded } += 1;
                }
                None => total.is_unsolved = true,
            }
        }
    }

    fn quantities(&self, total: &Total) -> Vec<Quantity> {
        let reason = if total.is_unsolved { "the linear programme has no solution" } else { "there is no step" };
        let (has_value, cutoff) = (!total.is_unsolved && total.steps > 0.0, self.cutoff);
        let Tally { gain, matched, switches } = total.tally;
        let (missed, unwanted) = (total.truths - matched, total.tracks - matched);
        // Rounding may leave a part just below 0 where it is none.
        let parts = [matched - gain, 0.5 * missed, 0.5 * unwanted, switches * self.penalty()].map(|part: f64| part.max(0.0));
        let sum: f64 = parts.iter().sum();
        let some = |name, value: f64, unit| Quantity::or(name, has_value.then_some(value), unit, reason);
        let mut quantities =
            vec![some("t_gospa", cutoff.metres(sum), "m"), some("t_gospa_per_step", cutoff.metres(sum / total.steps.max(1.0)), "m")];
        let names = ["localisation", "missed", "false", "switching"];
        quantities.extend(names.into_iter().zip(parts).map(|(name, part)| some(name, cutoff.powers(part), "m^p")));
        quantities.extend([
            some("matched_points", matched, ""),
            some("missed_points", missed, ""),
            some("false_points", unwanted, ""),
            some("switches", switches, ""),
            Quantity::new("steps", total.steps, ""),
            Quantity::new("clusters_exact", total.exact as f64, ""),
            Quantity::new("clusters_linear_programme_whole", total.whole as f64, ""),
            Quantity::new("clusters_linear_programme_bound", total.bounded as f64, ""),
        ]);
        quantities
    }
}

impl Total {
    /// Which method gave the value, and what that makes it.
    fn method(&self) -> &'static str {
        match (self.whole, self.bounded) {
            (0, 0) => "dynamic programming: exact",
            (_, 0) => "dynamic and linear programming with whole solutions: exact",
            _ => "dynamic and linear programming: lower bound",
        }
    }
}
