//! OSPA: how far the set of tracks is from the set of truths at one step, a distance per head in metres. Errors of position
//! and of number both count, up to a cutoff.
//!
//! # Reference
//! D. Schuhmacher, B.-T. Vo, B.-N. Vo, A Consistent Metric for Performance Evaluation of Multi-Object Filters, IEEE Trans.
//! Signal Processing 56, 2008, 3447–3457. Labels: B. Ristic, B.-N. Vo, D. Clark, B.-T. Vo, A Metric for Performance Evaluation of
//! Multi-Target Tracking Algorithms, IEEE Trans. Signal Processing 59, 2011, 3452–3457.
//!
//! # Symbols
//! m, n sizes of the smaller and the larger set; c cutoff, p order, d distance (m, of directions degrees); a penalty of a label.
//!
//! # Method
//! 1. OSPAᵖ = (min Σ min(d, c)ᵖ + cᵖ (n − m)) / n over all assignments of the smaller set into the larger; 0 when both are
//!    empty. The sum is the localisation part, the rest the cardinality part.
//! 2. With labels (`labelled_ospa`) dᵖ grows by aᵖ where the track is not the one that the truth has over the whole time. That
//!    one is by the assignment of whole truths to whole tracks which gains most, Σ (1 − (d / c)ᵖ) over the steps at which they are
//!    within the cutoff. The sum of aᵖ is the labelling part.
//! 3. The headline is the sum over all steps of all sequences, divided by the steps at which a target is due.

use super::cutoff::{CUTOFF_DEG, CUTOFF_M, Cutoffs, Matcher, ORDER, Unit};
use super::origin::{
    DUE_STEPS, Origin, PAIRS, PairColumn, SERIES, STEPS, Statistic, TRACK_POINTS, TRUTH_POINTS,
};
use super::{BuildMetric, Metric, MetricReport, NOTHING_DUE, Quantity, Sequence, Series};
use crate::evaluation::comparison::{ComparedStep, Comparison, Pair};
use crate::math::assignment::AssignmentSolver;
use crate::registry::{Method, Object, default, number};
use serde::Deserialize;
use serde_json::json;

pub const METHOD: Method<BuildMetric> = Method {
    name: "ospa",
    parameters: &PARAMETERS,
    build: |spec| {
        Ok(Box::new(Ospa {
            cutoffs: Cutoffs::deserialize(spec)?,
            label_share: None,
        }))
    },
};

static PARAMETERS: Object = Object {
    name: "Ospa",
    summary: "Distance per head between the sets of truths and of tracks at each step.",
    fields: &[CUTOFF_M, CUTOFF_DEG, ORDER],
};

pub const LABELLED: Method<BuildMetric> = Method {
    name: "labelled_ospa",
    parameters: &LABELLED_PARAMETERS,
    build: |spec| {
        let label = Label::deserialize(spec)?;
        Ok(Box::new(Ospa {
            cutoffs: Cutoffs::deserialize(spec)?,
            label_share: Some(label.label_share),
        }))
    },
};

static LABELLED_PARAMETERS: Object = Object {
    name: "LabelledOspa",
    summary: "OSPA that also costs where a truth has another track than over the whole time.",
    fields: &[
        CUTOFF_M,
        CUTOFF_DEG,
        ORDER,
        default(
            "label_share",
            "What another track costs, as a part of the cutoff.",
            number(0.0, 1.0, ""),
            "0.5",
        ),
    ],
};

#[derive(Deserialize)]
struct Label {
    label_share: f64,
}

struct Ospa {
    cutoffs: Cutoffs,
    /// a / c; `None` without labels.
    label_share: Option<f64>,
}

/// In metres or in degrees.
struct InUnit {
    unit: Unit,
    label_share: Option<f64>,
    /// aᵖ / cᵖ.
    label_power: f64,
}

/// Of one step or the sum over steps, in metres or degrees.
#[derive(Default)]
struct Parts {
    distance: f64,
    localisation: f64,
    labelling: f64,
    cardinality: f64,
}

/// dᵖ of each matched pair, by its truth and its track, and the same of labels.
#[derive(Default)]
struct Powers {
    of_distances: Vec<(u32, u32, f64)>,
    of_labels: Vec<(u32, u32, f64)>,
}

type Part = (&'static str, fn(&Parts) -> f64);

/// What is told of each step.
const PARTS: [Part; 3] = [
    ("ospa", |parts| parts.distance),
    ("localisation", |parts| parts.localisation),
    ("cardinality", |parts| parts.cardinality),
];

const LABELLED_PARTS: [Part; 4] = [
    ("labelled_ospa", |parts| parts.distance),
    ("localisation", |parts| parts.localisation),
    ("labelling", |parts| parts.labelling),
    ("cardinality", |parts| parts.cardinality),
];

impl Metric for Ospa {
    fn cutoffs(&self) -> Option<Cutoffs> {
        Some(self.cutoffs)
    }

    fn evaluate(&self, sequences: &[Sequence]) -> MetricReport {
        let unit = self.cutoffs.unit(sequences);
        let ospa = InUnit {
            unit,
            label_share: self.label_share,
            label_power: self.label_share.unwrap_or_default().powf(unit.cutoff.p),
        };
        ospa.evaluate(sequences)
    }
}

impl InUnit {
    fn parts(&self) -> &'static [Part] {
        match self.label_share {
            None => &PARTS,
            Some(_) => &LABELLED_PARTS,
        }
    }

    fn evaluate(&self, sequences: &[Sequence]) -> MetricReport {
        let (mut matcher, mut powers) = (Matcher::default(), Powers::default());
        let mut parts = Vec::new();
        for Sequence { comparison, .. } in sequences {
            let labels = self.label_share.map(|_| self.labels(comparison));
            for step in &comparison.steps {
                let labels = labels.as_deref();
                parts.push(self.step(&mut matcher, (comparison, step), labels, &mut powers));
            }
        }
        let mut quantities = Vec::new();
        let mut series = Vec::new();
        let due: usize = sequences
            .iter()
            .map(|sequence| sequence.comparison.due_steps())
            .sum();
        for &(name, of) in self.parts() {
            let values = || parts.iter().map(of);
            let (sum, unit) = (values().sum(), self.unit.name);
            quantities.push(Quantity::ratio(name, sum, due as f64, unit, NOTHING_DUE));
            series.push(Series::over_time(name, unit, values().map(Some)));
        }
        quantities.push(Quantity::count("steps", parts.len() as f64));
        quantities.push(Quantity::count("due_steps", due as f64));
        let mut parameters =
            json!({self.unit.parameter: self.unit.cutoff.cutoff_m, "p": self.unit.cutoff.p});
        if let Some(share) = self.label_share {
            parameters["label_share"] = json!(share);
        }
        let mut report = MetricReport::new(self.parts()[0].0, false, parameters, quantities);
        report.origins = self.origins();
        if sequences.len() == 1 {
            let power = self.unit.power;
            report.series = series;
            report.pairs = vec![PairColumn::new("power", power, powers.of_distances)];
            if self.label_share.is_some() {
                let of_labels = PairColumn::new("label_power", power, powers.of_labels);
                report.pairs.push(of_labels);
            }
        }
        report
    }

    fn origins(&self) -> Vec<Origin> {
        let sum = |name, column| Origin::rows(name, Statistic::Sum, SERIES, column);
        let is_labelled = self.label_share.is_some();
        let mut origins = vec![
            sum("localisation_sum", "localisation"),
            sum("cardinality_sum", "cardinality"),
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
            .times(self.unit.cutoff.powers(1.0)),
        ];
        if is_labelled {
            origins.extend([
                sum("labelled_ospa_sum", "labelled_ospa"),
                Origin::ratio("labelled_ospa", &["labelled_ospa_sum"], &["due_steps"]),
                sum("labelling_sum", "labelling"),
                Origin::ratio("labelling", &["labelling_sum"], &["due_steps"]),
                sum("series.labelling", "labelling"),
                Origin::rows("label_powers", Statistic::Sum, PAIRS, "label_power"),
            ]);
        } else {
            origins.extend([
                sum("ospa_sum", "ospa"),
                Origin::ratio("ospa", &["ospa_sum"], &["due_steps"]),
            ]);
        }
        let (name, over): (_, &[_]) = if is_labelled {
            const OVER: &[&str] = &[
                "series.powers",
                "series.label_powers",
                "series.unmatched_powers",
            ];
            ("series.labelled_ospa", OVER)
        } else {
            const OVER: &[&str] = &["series.powers", "series.unmatched_powers"];
            ("series.ospa", OVER)
        };
        let root = Origin::ratio(name, over, &["series.larger_set"]).root(self.unit.cutoff.p);
        origins.push(root);
        origins
    }

    /// Step 2: of each truth the track that it has over the whole time.
    fn labels(&self, comparison: &Comparison) -> Vec<Option<u32>> {
        let cutoff = self.unit.cutoff;
        let mut gains: Vec<(u32, u32, f64)> = Vec::new();
        for pair in &comparison.pairs {
            if pair.distance < cutoff.cutoff_m {
                let truth = comparison.truths[pair.truth as usize].id;
                let track = comparison.tracks[pair.track as usize].id;
                gains.push((truth, track, 1.0 - cutoff.share_of(pair.distance)));
            }
        }
        // Stable, so that sums are in order of time.
        gains.sort_by_key(|&(truth, track, _)| (truth, track));
        let mut labels = vec![None; comparison.truth_ids.len()];
        let (mut solver, mut rows) = (AssignmentSolver::default(), Vec::new());
        solver.clear();
        for of_truth in gains.chunk_by(|left, right| left.0 == right.0) {
            for of_pair in of_truth.chunk_by(|left, right| left.1 == right.1) {
                let gain: f64 = of_pair.iter().map(|(_, _, gain)| gain).sum();
                solver.push_edge(of_pair[0].1, -gain);
            }
            solver.end_row(0.0);
            rows.push(of_truth[0].0);
        }
        if solver.solve().is_some() {
            for (row, truth) in rows.iter().enumerate() {
                labels[*truth as usize] = solver.column_of(row);
            }
        }
        labels
    }

    /// Steps 1 and 2. A member of the smaller set without a pair within the cutoff costs c as part of the localisation.
    fn step(
        &self,
        matcher: &mut Matcher,
        (comparison, step): (&Comparison, &ComparedStep),
        labels: Option<&[Option<u32>]>,
        powers: &mut Powers,
    ) -> Parts {
        let (fewer, more) = (
            step.truths.len().min(step.tracks.len()),
            step.truths.len().max(step.tracks.len()),
        );
        if more == 0 {
            return Parts::default();
        }
        let cutoff = self.unit.cutoff;
        let of_label = |pair: &Pair| match labels {
            Some(labels) if !is_labelled(comparison, pair, labels) => self.label_power,
            _ => 0.0,
        };
        let (mut pairs, mut sum, mut labelling) = (0, 0.0, 0.0);
        matcher.assign_by(
            comparison,
            step,
            |pair| {
                if pair.distance < cutoff.cutoff_m {
                    cutoff.share_of(pair.distance) + of_label(pair)
                } else {
                    1.0
                }
            },
            |pair, _| {
                let (label, of_distance) = (of_label(pair), cutoff.share_of(pair.distance));
                pairs += 1;
                sum += of_distance;
                labelling += label;
                let (truth, track) = (pair.truth, pair.track);
                let power = cutoff.powers(of_distance);
                powers.of_distances.push((truth, track, power));
                if labels.is_some() {
                    powers.of_labels.push((truth, track, cutoff.powers(label)));
                }
            },
        );
        let localisation = sum + (fewer - pairs) as f64;
        let cardinality = (more - fewer) as f64;
        let heads = more as f64;
        Parts {
            distance: cutoff.metres((localisation + labelling + cardinality) / heads),
            localisation: cutoff.metres(localisation / heads),
            labelling: cutoff.metres(labelling / heads),
            cardinality: cutoff.metres(cardinality / heads),
        }
    }
}

/// Whether the track of a pair is the one that the truth has over the whole time.
fn is_labelled(comparison: &Comparison, pair: &Pair, labels: &[Option<u32>]) -> bool {
    let truth = comparison.truths[pair.truth as usize].id;
    let track = comparison.tracks[pair.track as usize].id;
    labels[truth as usize] == Some(track)
}
