//! OSPA: how far the set of tracks is from the set of truths at one step, a distance per head in metres. Errors of position
//! and of number both count, up to a cutoff.
//!
//! # Reference
//! D. Schuhmacher, B.-T. Vo, B.-N. Vo, A Consistent Metric for Performance Evaluation of Multi-Object Filters, IEEE Trans.
//! Signal Processing 56, 2008, 3447–3457.
//!
//! # Symbols
//! m, n sizes of the smaller and the larger set; c cutoff, p order, d distance.
//!
//! # Method
//! 1. OSPAᵖ = (min Σ min(d, c)ᵖ + cᵖ (n − m)) / n over all assignments of the smaller set into the larger; 0 when both are
//!    empty. The sum is the localisation part, the rest the cardinality part.
//! 2. The headline is the sum over all steps of all sequences, divided by the steps at which a target is due.

use super::cutoff::{CUTOFF_M, Cutoff, Matcher, ORDER};
use super::origin::{
    DUE_STEPS, Origin, PAIRS, PairColumn, SERIES, STEPS, Statistic, TRACK_POINTS, TRUTH_POINTS,
};
use super::{BuildMetric, Metric, MetricReport, NOTHING_DUE, Quantity, Sequence, Series};
use crate::evaluation::comparison::{ComparedStep, Comparison};
use crate::model::space::Space;
use crate::registry::{Method, Object};
use serde::Deserialize;
use serde_json::json;

pub const METHOD: Method<BuildMetric> = Method {
    name: "ospa",
    parameters: &PARAMETERS,
    build: |spec| Ok(Box::new(Ospa(Cutoff::deserialize(spec)?))),
};

static PARAMETERS: Object = Object {
    name: "Ospa",
    summary: "Distance per head between the sets of truths and of tracks at each step.",
    fields: &[CUTOFF_M, ORDER],
};

struct Ospa(Cutoff);

/// Of one step or the sum over steps, in metres.
#[derive(Default)]
struct Parts {
    distance_m: f64,
    localisation_m: f64,
    cardinality_m: f64,
}

type Part = (&'static str, fn(&Parts) -> f64);

/// What is told of each step.
const PARTS: [Part; 3] = [
    ("ospa", |parts| parts.distance_m),
    ("localisation", |parts| parts.localisation_m),
    ("cardinality", |parts| parts.cardinality_m),
];

impl Metric for Ospa {
    fn accepts(&self, space: Option<Space>) -> bool {
        space.is_some_and(Space::has_places)
    }

    fn reach_m(&self, _: f64) -> f64 {
        self.0.cutoff_m
    }

    fn evaluate(&self, sequences: &[Sequence]) -> MetricReport {
        let (mut matcher, mut powers) = (Matcher::default(), Vec::new());
        let steps = sequences.iter().flat_map(|sequence| {
            sequence
                .comparison
                .steps
                .iter()
                .map(|step| (sequence.comparison, step))
        });
        let parts: Vec<Parts> = steps
            .map(|(comparison, step)| self.step(&mut matcher, comparison, step, &mut powers))
            .collect();
        let mut quantities = Vec::new();
        let mut series = Vec::new();
        let due: usize = sequences
            .iter()
            .map(|sequence| sequence.comparison.due_steps())
            .sum();
        for (name, of) in PARTS {
            let values = || parts.iter().map(of);
            let sum = values().sum();
            quantities.push(Quantity::ratio(name, sum, due as f64, "m", NOTHING_DUE));
            series.push(Series::over_time(name, "m", values().map(Some)));
        }
        quantities.push(Quantity::count("steps", parts.len() as f64));
        quantities.push(Quantity::count("due_steps", due as f64));
        let parameters = json!({"cutoff_m": self.0.cutoff_m, "p": self.0.p});
        let mut report = MetricReport::new("ospa", false, parameters, quantities);
        report.origins = self.origins();
        if sequences.len() == 1 {
            report.series = series;
            report.pairs = vec![PairColumn::new("power", "m^p", powers)];
        }
        report
    }
}

impl Ospa {
    fn origins(&self) -> Vec<Origin> {
        let sum = |name, column| Origin::rows(name, Statistic::Sum, SERIES, column);
        vec![
            sum("ospa_sum", "ospa"),
            sum("localisation_sum", "localisation"),
            sum("cardinality_sum", "cardinality"),
            Origin::ratio("ospa", &["ospa_sum"], &["due_steps"]),
            Origin::ratio("localisation", &["localisation_sum"], &["due_steps"]),
            Origin::ratio("cardinality", &["cardinality_sum"], &["due_steps"]),
            sum("series.localisation", "localisation"),
            sum("series.cardinality", "cardinality"),
            STEPS,
            DUE_STEPS,
            TRUTH_POINTS,
            TRACK_POINTS,
            Origin::rows("powers", Statistic::Sum, PAIRS, "power"),
            Origin::rows("matched", Statistic::Count, PAIRS, "power"),
            Origin::numbers(
                "series.larger_set",
                Statistic::Largest,
                &["series.truth_points", "series.track_points"],
            ),
            Origin::terms(
                "series.unmatched_powers",
                &["series.larger_set", "-series.matched"],
            )
            .times(self.0.powers(1.0)),
            Origin::ratio(
                "series.ospa",
                &["series.powers", "series.unmatched_powers"],
                &["series.larger_set"],
            )
            .root(self.0.p),
        ]
    }

    /// Step 1. A member of the smaller set without a pair within the cutoff costs c as part of the localisation.
    fn step(
        &self,
        matcher: &mut Matcher,
        comparison: &Comparison,
        step: &ComparedStep,
        powers: &mut Vec<(u32, u32, f64)>,
    ) -> Parts {
        let (fewer, more) = (
            step.truths.len().min(step.tracks.len()),
            step.truths.len().max(step.tracks.len()),
        );
        if more == 0 {
            return Parts::default();
        }
        let (mut pairs, mut sum) = (0, 0.0);
        matcher.assign(comparison, step, self.0, |pair, share| {
            pairs += 1;
            sum += share;
            powers.push((pair.truth, pair.track, self.0.powers(share)));
        });
        let localisation = sum + (fewer - pairs) as f64;
        let cardinality = (more - fewer) as f64;
        let metres = |share: f64| self.0.metres(share / more as f64);
        Parts {
            distance_m: metres(localisation + cardinality),
            localisation_m: metres(localisation),
            cardinality_m: metres(cardinality),
        }
    }
}
