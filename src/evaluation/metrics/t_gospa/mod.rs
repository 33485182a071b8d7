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
//!    entangled for that, [`linear_programme`] bounds from below. Its prices say which pairs surely cost too much, and [`reduced`]
//!    solves what is left. Where that fails an assignment ([`feasible`]) bounds from above. The report says which was used, both
//!    bounds, and their difference as the gap, which is 0 for an exact value.
//! 3. Several sequences add up their p-th powers. `t_gospa_per_step` is (T-GOSPAᵖ / n)^(1/p), n steps at which a target is due.

mod exact;
mod feasible;
mod linear_programme;
mod primal_dual;
mod problem;
mod reduced;
mod trace;

use self::problem::{Cluster, Solution, Tally, clusters};
use self::reduced::Reduced;
use super::cutoff::{CUTOFF_M, Cutoff, ORDER};
use super::origin::{
    DUE_STEPS, Origin, PAIRS, PairColumn, SERIES, STEPS, Statistic, TRACK_POINTS, TRUTH_POINTS,
};
use super::{BuildMetric, Metric, MetricReport, NOTHING_DUE, Quantity, Sequence, Series};
use crate::evaluation::comparison::Comparison;
use crate::model::space::Space;
use crate::model::watch::Watch;
use crate::registry::{Method, Object, default, number};
use serde::Deserialize;
use serde_json::json;

pub const METHOD: Method<BuildMetric> = Method {
    name: "t_gospa",
    parameters: &PARAMETERS,
    build: |spec| Ok(Box::new(TGospa::deserialize(spec)?)),
};

static PARAMETERS: Object = Object {
    name: "TGospa",
    summary: "GOSPA over whole trajectories, with a price on every switch of tracks.",
    fields: &[
        CUTOFF_M,
        ORDER,
        default(
            "switch_penalty_m",
            "The penalty gamma of a truth's change of track.",
            number(0.0, 1e7, "m"),
            "20.0",
        ),
    ],
};

/// Unit of the parts of the sum.
const POWER: &str = "m^p";

#[derive(Deserialize)]
struct TGospa {
    #[serde(flatten)]
    cutoff: Cutoff,
    switch_penalty_m: f64,
}

/// Over all sequences.
#[derive(Default)]
struct Total {
    solution: Solution,
    truths: f64,
    tracks: f64,
    steps: f64,
    due_steps: f64,
    exact: usize,
    /// Clusters by linear programming: with whole numbers, and with fractions or cut into blocks.
    whole: usize,
    bounded: usize,
    is_unsolved: bool,
    /// How much more than the solutions assignments cost that are some, and how much less bounds do, as a share of cᵖ.
    slack: f64,
    excess: f64,
}

impl Metric for TGospa {
    fn accepts(&self, space: Option<Space>) -> bool {
        space.is_some_and(Space::has_places)
    }

    fn reach_m(&self, _: f64) -> f64 {
        self.cutoff.cutoff_m
    }

    fn evaluate(&self, sequences: &[Sequence]) -> MetricReport {
        self.evaluate_until(sequences, &Watch::never())
    }

    fn evaluate_until(&self, sequences: &[Sequence], watch: &Watch) -> MetricReport {
        let mut total = Total::default();
        for sequence in sequences {
            self.add(sequence.comparison, &mut total, watch);
        }
        let Cutoff { cutoff_m, p } = self.cutoff;
        let parameters = json!({
            "cutoff_m": cutoff_m,
            "p": p,
            "switch_penalty_m": self.switch_penalty_m,
            "method": total.method(),
        });
        let mut report = MetricReport::new("t_gospa", false, parameters, self.quantities(&total));
        report.origins = self.origins();
        report.warnings.extend(self.doubt(&total, &report));
        if let [sequence] = sequences {
            let columns = self.pair_columns(sequence.comparison, &total.solution);
            let [shares, powers] = &columns;
            let switches = &total.solution.switches;
            report.series = self.over_time(sequence.comparison, [shares, powers], switches);
            report.pairs = columns.into();
        }
        report
    }
}

/// Switches paid at each step.
fn switches_over_time(comparison: &Comparison, paid: &[(u32, f64)]) -> Series {
    let mut switches = vec![0.0; comparison.steps.len()];
    for &(pair, count) in paid {
        switches[comparison
            .steps
            .partition_point(|step| step.pairs.end <= pair as usize)] += count;
    }
    Series::over_time("switches", "", switches.into_iter().map(Some))
}

impl TGospa {
    fn origins(&self) -> Vec<Origin> {
        let half = 0.5 * self.cutoff.powers(1.0);
        const PARTS: &[&str] = &["localisation", "missed", "false", "switching"];
        vec![
            TRUTH_POINTS,
            TRACK_POINTS,
            STEPS,
            DUE_STEPS,
            Origin::rows("matched_points", Statistic::Sum, PAIRS, "share"),
            Origin::terms("missed_points", &["truth_points", "-matched_points"]),
            Origin::terms("false_points", &["track_points", "-matched_points"]),
            Origin::sum("switches", SERIES),
            Origin::rows("localisation", Statistic::Sum, PAIRS, "power"),
            Origin::terms("missed", &["missed_points"]).times(half),
            Origin::terms("false", &["false_points"]).times(half),
            Origin::terms("switching", &["switches"]).times(self.cutoff.powers(self.penalty())),
            Origin::terms("t_gospa", PARTS).root(self.cutoff.p),
            Origin::ratio("t_gospa_per_step", PARTS, &["due_steps"]).root(self.cutoff.p),
        ]
    }

    /// The share to which each near pair is assigned, and so much of its dᵖ.
    fn pair_columns(&self, comparison: &Comparison, solution: &Solution) -> [PairColumn; 2] {
        let (mut shares, mut powers) = (Vec::new(), Vec::new());
        for &(pair, share) in &solution.shares {
            let pair = &comparison.pairs[pair as usize];
            let power = share * self.cutoff.powers(self.cutoff.share_of(pair.distance));
            shares.push((pair.truth, pair.track, share));
            powers.push((pair.truth, pair.track, power));
        }
        [
            PairColumn::new("share", "", shares),
            PairColumn::new("power", POWER, powers),
        ]
    }

    /// What each step adds to the parts of the sum, and the switches paid at it.
    fn over_time(
        &self,
        comparison: &Comparison,
        [shares, powers]: [&PairColumn; 2],
        switches: &[(u32, f64)],
    ) -> Vec<Series> {
        let half = 0.5 * self.cutoff.powers(1.0);
        let names = ["matched", "missed", "false"];
        let parts = Series::of_matched(names, comparison, &shares.sums(comparison));
        let powers = powers.sums(comparison).into_iter().map(Some);
        let mut series = vec![Series::over_time("localisation", POWER, powers)];
        for part in &parts[1..] {
            // Rounding may leave a part just below 0 where it is none.
            let values = part.values.iter();
            let values = values.map(|value| Some((*value)?.max(0.0) * half));
            series.push(Series::over_time(part.name, POWER, values));
        }
        series.push(switches_over_time(comparison, switches));
        series
    }

    fn penalty(&self) -> f64 {
        self.cutoff.share_of(self.switch_penalty_m)
    }

    fn add(&self, comparison: &Comparison, total: &mut Total, watch: &Watch) {
        total.truths += comparison.truths.len() as f64;
        total.tracks += comparison.tracks.len() as f64;
        total.steps += comparison.steps.len() as f64;
        total.due_steps += comparison.due_steps() as f64;
        for cluster in clusters(comparison, self.cutoff) {
            if let Some(solution) = exact::solve(&cluster, self.penalty(), watch) {
                total.solution.add(solution);
                total.exact += 1;
            } else {
                self.add_entangled(&cluster, total, watch);
            }
        }
    }

    fn add_entangled(&self, cluster: &Cluster, total: &mut Total, watch: &Watch) {
        let Some(bound) = linear_programme::solve(cluster, self.penalty(), watch) else {
            total.is_unsolved = true;
            return;
        };
        if bound.is_exact {
            total.solution.add(bound.solution);
            total.whole += 1;
            return;
        }
        match reduced::solve(cluster, &bound, self.penalty(), watch) {
            Reduced::Exact(solution) => {
                total.solution.add(solution);
                total.whole += 1;
            }
            Reduced::AtMost(most) => {
                let cost = bound.solution.tally.cost(self.penalty());
                total.slack += (most - cost).max(0.0);
                total.excess += (cost - bound.least).max(0.0);
                total.solution.add(bound.solution);
                total.bounded += 1;
            }
        }
    }

    /// What a reader must know of a value that is a bound.
    fn doubt(&self, total: &Total, report: &MetricReport) -> Option<String> {
        let [lower, upper, gap] =
            ["t_gospa_lower", "t_gospa_upper", "gap"].map(|name| report.quantity(name));
        let (lower_m, upper_m, gap_m) = (lower?, upper?, gap.filter(|_| total.bounded > 0)?);
        let clusters = total.exact + total.whole + total.bounded;
        Some(format!(
            "t_gospa is a lower bound: the exact value lies between {lower_m:.3} m and {upper_m:.3} m, a gap of {gap_m:.3} m, because {} of \
             {clusters} groups of targets and tracks that are near each other are too entangled to be solved exactly",
            total.bounded
        ))
    }

    fn quantities(&self, total: &Total) -> Vec<Quantity> {
        let reason = if total.is_unsolved {
            "the linear programme has no solution"
        } else {
            "there is no step"
        };
        let (has_value, cutoff) = (!total.is_unsolved && total.steps > 0.0, self.cutoff);
        let Tally {
            gain,
            matched,
            switches,
        } = total.solution.tally;
        let (missed, unwanted) = (total.truths - matched, total.tracks - matched);
        // Rounding may leave a part just below 0 where it is none.
        let parts = [
            matched - gain,
            0.5 * missed,
            0.5 * unwanted,
            switches * self.penalty(),
        ]
        .map(|part: f64| part.max(0.0));
        let sum: f64 = parts.iter().sum();
        let some =
            |name, value: f64, unit| Quantity::or(name, has_value.then_some(value), unit, reason);
        let mut quantities = vec![
            some("t_gospa", cutoff.metres(sum), "m"),
            Quantity::or(
                "t_gospa_per_step",
                (has_value && total.due_steps > 0.0).then(|| cutoff.metres(sum / total.due_steps)),
                "m",
                if has_value { NOTHING_DUE } else { reason },
            ),
        ];
        let (lower, upper) = (
            cutoff.metres((sum - total.excess).max(0.0)),
            cutoff.metres(sum + total.slack),
        );
        quantities.extend([
            some("t_gospa_lower", lower, "m"),
            some("t_gospa_upper", upper, "m"),
            some("gap", upper - lower, "m"),
        ]);
        let names = ["localisation", "missed", "false", "switching"];
        quantities.extend(
            names
                .into_iter()
                .zip(parts)
                .map(|(name, part)| some(name, cutoff.powers(part), POWER)),
        );
        quantities.extend([
            some("matched_points", matched, ""),
            some("missed_points", missed, ""),
            some("false_points", unwanted, ""),
            some("switches", switches, ""),
            Quantity::new("steps", total.steps, ""),
            Quantity::new("due_steps", total.due_steps, ""),
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
