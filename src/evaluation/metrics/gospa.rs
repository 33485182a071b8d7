//! GOSPA: how far the tracks are from the truths at one step, as a sum over errors of position, missed truths and false
//! tracks. The three parts add up, so each can be looked at alone; a switch of tracks may count too.
//!
//! # Reference
//! A. S. Rahmathullah, Á. F. García-Fernández, L. Svensson, Generalized optimal sub-pattern assignment metric, 20th
//! International Conference on Information Fusion, 2017.
//!
//! # Symbols
//! c cutoff, p order, d distance (m, of directions degrees), s penalty of a switch; α = 2 throughout, the value at which the parts are what they are called.
//!
//! # Method
//! 1. GOSPAᵖ = min Σ dᵖ + cᵖ/2 (missed + false) over all partial assignments; a pair at c or beyond is one missed truth and
//!    one false track.
//! 2. With a switch penalty s, sᵖ is added for every truth whose track is another than at the step before, and half of it
//!    for one that lost its track or found one again; a truth's first track is no switch.
//! 3. The headline is the sum over all steps of all sequences, divided by the steps at which a target is due: so a false track costs
//!    as much where no target is. The parts are p-th powers, summed over steps.

use super::cutoff::{CUTOFF_DEG, CUTOFF_M, Cutoff, Cutoffs, Matcher, ORDER, Unit};
use super::origin::{
    DUE_STEPS, Origin, PAIRS, PairColumn, SERIES, STEPS, Statistic, TRACK_POINTS, TRUTH_POINTS,
};
use super::{BuildMetric, Metric, MetricReport, NOTHING_DUE, Quantity, Sequence, Series};
use crate::evaluation::comparison::{ComparedStep, Comparison};
use crate::registry::{Method, Object, default, number};
use serde::Deserialize;
use serde_json::json;

pub const METHOD: Method<BuildMetric> = Method {
    name: "gospa",
    parameters: &PARAMETERS,
    build: |spec| Ok(Box::new(Gospa::deserialize(spec)?)),
};

static PARAMETERS: Object = Object {
    name: "Gospa",
    summary: "Sum of position errors, missed truths and false tracks at each step, alpha = 2.",
    fields: &[
        CUTOFF_M,
        CUTOFF_DEG,
        ORDER,
        default(
            "switch_penalty_m",
            "What a truth's change of track costs at a step; 0 leaves changes out. Of directions it is as large a part of their cutoff.",
            number(0.0, 1e7, "m"),
            "0.0",
        ),
    ],
};

#[derive(Deserialize)]
struct Gospa {
    #[serde(flatten)]
    cutoffs: Cutoffs,
    switch_penalty_m: f64,
}

/// In metres or in degrees.
struct InUnit {
    unit: Unit,
    /// sᵖ / cᵖ.
    switch_share: f64,
    switch_penalty_m: f64,
}

/// Of one step, or summed: shares of cᵖ, and counts.
#[derive(Debug, Clone, Copy, Default)]
struct Parts {
    distance_m: f64,
    localisation: f64,
    matched: usize,
    missed: usize,
    unwanted: usize,
    switches: f64,
}

/// dᵖ of each matched pair, by its truth and its track.
type Powers = Vec<(u32, u32, f64)>;

/// The track of each truth at the step before, and whether it ever had one.
struct Memory {
    track: Vec<Option<u32>>,
    was_tracked: Vec<bool>,
    /// Of each truth presence of the step: its track.
    now: Vec<Option<u32>>,
}

impl Metric for Gospa {
    fn cutoffs(&self) -> Option<Cutoffs> {
        Some(self.cutoffs)
    }

    fn evaluate(&self, sequences: &[Sequence]) -> MetricReport {
        let of_places = Cutoff {
            cutoff_m: self.cutoffs.cutoff_m,
            p: self.cutoffs.p,
        };
        let gospa = InUnit {
            unit: self.cutoffs.unit(sequences),
            switch_share: of_places.share_of(self.switch_penalty_m),
            switch_penalty_m: self.switch_penalty_m,
        };
        gospa.evaluate(sequences)
    }
}

impl InUnit {
    fn evaluate(&self, sequences: &[Sequence]) -> MetricReport {
        let mut powers = Vec::new();
        let steps: Vec<Parts> = sequences
            .iter()
            .flat_map(|sequence| self.steps(sequence.comparison, &mut powers))
            .collect();
        let due = sequences
            .iter()
            .map(|sequence| sequence.comparison.due_steps())
            .sum();
        let quantities = self.quantities(&steps, due);
        let mut report = MetricReport::new("gospa", false, self.parameters(), quantities);
        report.origins = self.origins();
        if sequences.len() == 1 {
            report.series = self.series(&steps);
            report.pairs = vec![PairColumn::new("power", self.unit.power, powers)];
        }
        report
    }

    fn parameters(&self) -> serde_json::Value {
        let Cutoff { cutoff_m, p } = self.unit.cutoff;
        json!({self.unit.parameter: cutoff_m, "p": p, "alpha": 2.0, "switch_penalty_m": self.switch_penalty_m})
    }

    fn steps(&self, comparison: &Comparison, powers: &mut Powers) -> Vec<Parts> {
        let truths = comparison.truth_ids.len();
        let mut memory = Memory {
            track: vec![None; truths],
            was_tracked: vec![false; truths],
            now: Vec::new(),
        };
        let mut matcher = Matcher::default();
        comparison
            .steps
            .iter()
            .map(|step| self.step((&mut matcher, &mut memory, powers), comparison, step))
            .collect()
    }

    /// Steps 1 and 2.
    fn step(
        &self,
        (matcher, memory, powers): (&mut Matcher, &mut Memory, &mut Powers),
        comparison: &Comparison,
        step: &ComparedStep,
    ) -> Parts {
        let mut parts = Parts::default();
        memory.now.clear();
        memory.now.resize(step.truths.len(), None);
        matcher.assign(comparison, step, self.unit.cutoff, |pair, share| {
            parts.localisation += share;
            parts.matched += 1;
            powers.push((pair.truth, pair.track, self.unit.cutoff.powers(share)));
            memory.now[pair.truth as usize - step.truths.start] =
                Some(comparison.tracks[pair.track as usize].id);
        });
        parts.missed = step.truths.len() - parts.matched;
        parts.unwanted = step.tracks.len() - parts.matched;
        parts.switches = memory.switches(comparison, step);
        let strangers = 0.5 * (parts.missed + parts.unwanted) as f64;
        let switching = parts.switches * self.switch_share;
        parts.distance_m = self
            .unit
            .cutoff
            .metres(parts.localisation + strangers + switching);
        parts
    }

    fn quantities(&self, steps: &[Parts], due: usize) -> Vec<Quantity> {
        let count = due as f64;
        let sum = |of: fn(&Parts) -> f64| steps.iter().map(of).sum::<f64>();
        let parts = PARTS.map(|(_, of)| self.unit.cutoff.powers(of(self, &Parts::sum(steps))));
        let mut quantities = vec![Quantity::ratio(
            "gospa",
            sum(|step| step.distance_m),
            count,
            self.unit.name,
            NOTHING_DUE,
        )];
        let totals = [
            "localisation_sum",
            "missed_sum",
            "false_sum",
            "switching_sum",
        ];
        let means = [
            "localisation_mean",
            "missed_mean",
            "false_mean",
            "switching_mean",
        ];
        quantities.extend(
            totals
                .iter()
                .zip(parts)
                .map(|(name, part)| Quantity::new(name, part, self.unit.power)),
        );
        quantities.extend(
            means.iter().zip(parts).map(|(name, part)| {
                Quantity::ratio(name, part, count, self.unit.power, NOTHING_DUE)
            }),
        );
        quantities.extend([
            Quantity::new("matched", sum(|step| step.matched as f64), ""),
            Quantity::new("missed", sum(|step| step.missed as f64), ""),
            Quantity::new("false", sum(|step| step.unwanted as f64), ""),
            Quantity::new("switches", sum(|step| step.switches), ""),
            Quantity::count("steps", steps.len() as f64),
            Quantity::count("due_steps", count),
        ]);
        quantities
    }

    fn origins(&self) -> Vec<Origin> {
        let (sum, half, penalty) = (
            Statistic::Sum,
            0.5 * self.unit.cutoff.powers(1.0),
            self.unit.cutoff.powers(self.switch_share),
        );
        let parts = ["localisation", "missed", "false", "switching"];
        let totals = [
            "localisation_sum",
            "missed_sum",
            "false_sum",
            "switching_sum",
        ];
        let mut origins = vec![
            Origin::rows("gospa_sum", sum, SERIES, "gospa"),
            Origin::ratio("gospa", &["gospa_sum"], &["due_steps"]),
        ];
        origins.extend(
            totals
                .into_iter()
                .zip(parts)
                .map(|(total, part)| Origin::rows(total, sum, SERIES, part)),
        );
        origins.extend([
            Origin::ratio("localisation_mean", &["localisation_sum"], &["due_steps"]),
            Origin::ratio("missed_mean", &["missed_sum"], &["due_steps"]),
            Origin::ratio("false_mean", &["false_sum"], &["due_steps"]),
            Origin::ratio("switching_mean", &["switching_sum"], &["due_steps"]),
            Origin::rows("matched", Statistic::Count, PAIRS, "power"),
            Origin::terms("missed", &["truth_points", "-matched"]),
            Origin::terms("false", &["track_points", "-matched"]),
            Origin::sum("switches", SERIES),
            STEPS,
            DUE_STEPS,
            TRUTH_POINTS,
            TRACK_POINTS,
            Origin::rows("series.localisation", sum, PAIRS, "power"),
            Origin::terms("series.missed", &["series.truth_points", "-series.matched"]).times(half),
            Origin::terms("series.false", &["series.track_points", "-series.matched"]).times(half),
            Origin::terms("series.switching", &["series.switches"]).times(penalty),
            Origin::terms(
                "series.gospa",
                &[
                    "series.localisation",
                    "series.missed",
                    "series.false",
                    "series.switching",
                ],
            )
            .root(self.unit.cutoff.p),
        ]);
        origins
    }

    fn series(&self, steps: &[Parts]) -> Vec<Series> {
        let mut series = vec![Series::over_time(
            "gospa",
            self.unit.name,
            steps.iter().map(|step| Some(step.distance_m)),
        )];
        series.extend(PARTS.map(|(name, of)| {
            let values = steps
                .iter()
                .map(|step| Some(self.unit.cutoff.powers(of(self, step))));
            Series::over_time(name, self.unit.power, values)
        }));
        series.push(Series::over_time(
            "switches",
            "",
            steps.iter().map(|step| Some(step.switches)),
        ));
        series
    }
}

/// The parts by name, each as a share of cᵖ.
type Part = fn(&InUnit, &Parts) -> f64;
const PARTS: [(&str, Part); 4] = [
    ("localisation", |_, parts| parts.localisation),
    ("missed", |_, parts| 0.5 * parts.missed as f64),
    ("false", |_, parts| 0.5 * parts.unwanted as f64),
    ("switching", |gospa, parts| {
        parts.switches * gospa.switch_share
    }),
];

impl Parts {
    fn sum(steps: &[Parts]) -> Parts {
        steps.iter().fold(Parts::default(), |sum, step| Parts {
            distance_m: sum.distance_m + step.distance_m,
            localisation: sum.localisation + step.localisation,
            matched: sum.matched + step.matched,
            missed: sum.missed + step.missed,
            unwanted: sum.unwanted + step.unwanted,
            switches: sum.switches + step.switches,
        })
    }
}

impl Memory {
    /// Step 2, for the truths of the step; those that are absent are remembered as they were.
    fn switches(&mut self, comparison: &Comparison, step: &ComparedStep) -> f64 {
        let mut switches = 0.0;
        for (truth, &now) in comparison.truths[step.truths.clone()].iter().zip(&self.now) {
            let id = truth.id as usize;
            switches += match (self.track[id], now) {
                (before, now) if before == now || !self.was_tracked[id] => 0.0,
                (Some(_), Some(_)) => 1.0,
                _ => 0.5,
            };
            self.track[id] = now;
            self.was_tracked[id] |= now.is_some();
        }
        switches
    }
}
