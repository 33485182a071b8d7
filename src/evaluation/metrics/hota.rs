//! HOTA: detection and association judged evenly, over thresholds of similarity.
//!
//! # Reference
//! J. Luiten, A. Ošep, P. Dendorfer, P. Torr, A. Geiger, L. Leal-Taixé, B. Leibe, HOTA: A Higher Order Metric for Evaluating
//! Multi-Object Tracking, International Journal of Computer Vision 129, 2021; OWTA: Y. Liu et al., Opening up Open World
//! Tracking, CVPR 2022.
//!
//! # Symbols
//! α threshold, 0.05 to 0.95 in steps of 0.05; s similarity of a pair at a step; gᵢ, tⱼ points of a truth and of a track;
//! cᵢⱼ(α) at how many steps they are matched with s ≥ α.
//!
//! # Method
//! 1. Each pair's share of its step, s / (row sum + column sum − s), summed over time to pᵢⱼ; the alignment of a truth
//!    and a track is aᵢⱼ = pᵢⱼ / (gᵢ + tⱼ − pᵢⱼ).
//! 2. At each step the matching with the greatest Σ aᵢⱼ s, once for all α. A match counts for every α up to its s.
//! 3. At each α: TP matches, DetA = TP / (TP + FN + FP), AssA = Σ c² / (gᵢ + tⱼ − c) / TP, AssRe and AssPr with gᵢ and tⱼ
//!    alone below the line, LocA = Σ s / TP, HOTA = √(DetA AssA), OWTA = √(DetRe AssA). The headlines are means over α.
//! 4. Over time: TP, FN and FP of each step, and what its matches add to Σ c² / (gᵢ + tⱼ − c) = TP AssA (`association`), means over α.
//!
//! As TrackEval has it, at an α without a match the parts of association count as 0 and LocA as 1. Several sequences add
//! their counts and sums at each α, so that association is weighted by TP.

use super::origin::{Origin, PAIRS, PairColumn, Source, Statistic, TRACK_POINTS, TRUTH_POINTS};
use super::{BuildMetric, Metric, MetricReport, Quantity, Sequence, Series};
use crate::evaluation::acquaintances::Acquaintances;
use crate::evaluation::comparison::{Comparison, Pair, Presence};
use crate::evaluation::matching::StepMatcher;
use crate::model::space::Space;
use crate::registry::{Method, Object};
use serde_json::json;

pub const METHOD: Method<BuildMetric> = Method {
    name: "hota",
    parameters: &PARAMETERS,
    build: |_| Ok(Box::new(Hota)),
};

static PARAMETERS: Object = Object {
    name: "Hota",
    summary: "HOTA with detection, association and localisation parts, over thresholds of similarity.",
    fields: &[],
};

const ALPHAS: usize = 19;

/// Threshold number `index`, as TrackEval computes it.
fn alpha(index: usize) -> f64 {
    0.05 + index as f64 * 0.05
}

/// How many thresholds a similarity reaches; what misses one by rounding alone reaches it.
fn alphas_reached(similarity: f64) -> usize {
    let mut count = ((similarity * 20.0) as usize).min(ALPHAS);
    while count < ALPHAS && similarity >= alpha(count) - f64::EPSILON {
        count += 1;
    }
    while count > 0 && similarity < alpha(count - 1) - f64::EPSILON {
        count -= 1;
    }
    count
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hota;

/// The matches of one sequence.
struct Matched {
    /// For each acquaintance how many reach exactly 0, 1, 2 … thresholds.
    counts: Vec<[u32; ALPHAS + 1]>,
    /// Truth, track, and how many thresholds they reach, in order of the steps.
    cells: Vec<(u32, u32, f64)>,
    /// Of each cell.
    acquaintance: Vec<u32>,
}

/// Sums at each α, over one sequence or several.
#[derive(Debug, Clone, Default)]
struct Sums {
    truth_points: f64,
    track_points: f64,
    tp: [f64; ALPHAS],
    similarity: [f64; ALPHAS],
    association: [f64; ALPHAS],
    association_recall: [f64; ALPHAS],
    association_precision: [f64; ALPHAS],
}

impl Metric for Hota {
    fn accepts(&self, _: Option<Space>) -> bool {
        true
    }

    /// Where similarity becomes 0.
    fn reach_m(&self, gate_m: f64) -> f64 {
        2.0 * gate_m
    }

    fn evaluate(&self, sequences: &[Sequence]) -> MetricReport {
        let (mut sums, mut pairs, mut over_time) = (Sums::default(), Vec::new(), Vec::new());
        for Sequence { comparison, .. } in sequences {
            let (reached, association) = sums.add(comparison);
            if sequences.len() == 1 {
                over_time = self::over_time(comparison, &reached, &association);
                pairs.push(reached);
            }
        }
        let first = sequences.first().map(|sequence| sequence.comparison);
        let of_points = first.filter(|comparison| comparison.space.is_some());
        let similarity = if of_points.is_some() {
            "1 - distance / (2 gate)"
        } else {
            "intersection over union"
        };
        let gate = of_points.map(|comparison| comparison.gate);
        let alphas: Vec<f64> = (0..ALPHAS).map(alpha).collect();
        let parameters = json!({"alphas": alphas, "similarity": similarity, "gate": gate});
        let curves = sums.curves();
        let report = MetricReport::new("hota", true, parameters, sums.quantities(&curves));
        let over_alpha = |(name, values): (&'static str, [f64; ALPHAS])| {
            let values = values
                .into_iter()
                .map(|value| Some(value).filter(|_| sums.is_defined()))
                .collect();
            Series {
                name,
                unit: "",
                axis: "alpha",
                at: alphas.clone(),
                values,
            }
        };
        let curves = curves.into_iter().chain(sums.counts()).map(over_alpha);
        let series = curves.chain(over_time).collect();
        MetricReport {
            series,
            pairs,
            origins: FROM.to_vec(),
            ..report
        }
    }
}

/// A number at each threshold, of the matches that reach it.
const fn reaching(curve: &'static str, statistic: Statistic) -> Origin {
    Origin::rows(curve, statistic, PAIRS, "thresholds")
}

const FROM: &[Origin] = &[
    TRUTH_POINTS,
    TRACK_POINTS,
    reaching("curves.tp", Statistic::CountReaching),
    Origin::terms("curves.fn", &["truth_points", "-curves.tp"]),
    Origin::terms("curves.fp", &["track_points", "-curves.tp"]),
    Origin::ratio(
        "curves.det_a",
        &["curves.tp"],
        &["curves.tp", "curves.fn", "curves.fp"],
    ),
    Origin::ratio("curves.det_re", &["curves.tp"], &["curves.tp", "curves.fn"]),
    Origin::ratio("curves.det_pr", &["curves.tp"], &["curves.tp", "curves.fp"]),
    reaching("curves.ass_a", Statistic::AssociationJaccard),
    reaching("curves.ass_re", Statistic::AssociationRecall),
    reaching("curves.ass_pr", Statistic::AssociationPrecision),
    reaching("curves.loc_a", Statistic::MeanReaching),
    Origin::numbers(
        "curves.hota",
        Statistic::GeometricMean,
        &["curves.det_a", "curves.ass_a"],
    ),
    Origin::numbers(
        "curves.owta",
        Statistic::GeometricMean,
        &["curves.det_re", "curves.ass_a"],
    ),
    Origin::numbers("hota", Statistic::MeanOfCurve, &["curves.hota"]),
    Origin::numbers("det_a", Statistic::MeanOfCurve, &["curves.det_a"]),
    Origin::numbers("ass_a", Statistic::MeanOfCurve, &["curves.ass_a"]),
    Origin::numbers("loc_a", Statistic::MeanOfCurve, &["curves.loc_a"]),
    Origin::numbers("det_re", Statistic::MeanOfCurve, &["curves.det_re"]),
    Origin::numbers("det_pr", Statistic::MeanOfCurve, &["curves.det_pr"]),
    Origin::numbers("ass_re", Statistic::MeanOfCurve, &["curves.ass_re"]),
    Origin::numbers("ass_pr", Statistic::MeanOfCurve, &["curves.ass_pr"]),
    Origin::numbers("owta", Statistic::MeanOfCurve, &["curves.owta"]),
    Origin::numbers("hota_0", Statistic::FirstOfCurve, &["curves.hota"]),
    Origin::numbers("loc_a_0", Statistic::FirstOfCurve, &["curves.loc_a"]),
    Origin::numbers("hota_loc_a_0", Statistic::Product, &["hota_0", "loc_a_0"]),
    Origin::rows("series.reached", Statistic::Sum, PAIRS, "thresholds"),
    MEAN_TP,
    Origin::terms("series.fn", &["series.truth_points", "-series.tp"]),
    Origin::terms("series.fp", &["series.track_points", "-series.tp"]),
];

/// Of a step: the mean over the thresholds.
const MEAN_TP: Origin = Origin {
    source: Source::Numbers {
        over: &["series.reached"],
        under: &[],
        factor: 1.0 / ALPHAS as f64,
        power: 1.0,
    },
    ..Origin::terms("series.tp", &[])
};

/// Method, 4.
fn over_time(
    comparison: &Comparison,
    reached: &PairColumn,
    association: &PairColumn,
) -> Vec<Series> {
    let of_alphas = |sum: f64| sum / ALPHAS as f64;
    let matched: Vec<f64> = reached
        .sums(comparison)
        .into_iter()
        .map(of_alphas)
        .collect();
    let mut series = Series::of_matched(["tp", "fn", "fp"], comparison, &matched);
    let association = association.sums(comparison).into_iter().map(of_alphas);
    series.push(Series::over_time("association", "", association.map(Some)));
    series
}

impl Sums {
    /// Adds a sequence; says of each match how many thresholds it reaches, and what it adds to the association at all of them.
    fn add(&mut self, comparison: &Comparison) -> (PairColumn, PairColumn) {
        let acquaintances = comparison.acquaintances();
        let (truth_points, track_points) = (
            points(&comparison.truths, &comparison.truth_ids),
            points(&comparison.tracks, &comparison.track_ids),
        );
        let points_of = |(truth, track): (u32, u32)| {
            (truth_points[truth as usize], track_points[track as usize])
        };
        let alignment = alignment(comparison, acquaintances, points_of);
        let matched = self.matches(comparison, acquaintances, &alignment);
        let mut shares = Vec::with_capacity(acquaintances.ids.len());
        for (&ids, counts) in acquaintances.ids.iter().zip(&matched.counts) {
            shares.push(self.add_acquaintance(points_of(ids), counts));
        }
        self.truth_points += comparison.truths.len() as f64;
        self.track_points += comparison.tracks.len() as f64;
        let cells = matched.cells.iter().zip(&matched.acquaintance);
        let association = cells.map(|(&(truth, track, reached), &acquaintance)| {
            let share = shares[acquaintance as usize][reached as usize];
            (truth, track, share)
        });
        let association = PairColumn::new("association", "", association.collect());
        let reached = PairColumn::new("thresholds", "", matched.cells);
        (reached, association)
    }

    /// Step 2.
    fn matches(
        &mut self,
        comparison: &Comparison,
        acquaintances: &Acquaintances,
        alignment: &[f64],
    ) -> Matched {
        let mut matched = Matched {
            counts: vec![[0; ALPHAS + 1]; acquaintances.ids.len()],
            cells: Vec::with_capacity(comparison.truths.len()),
            acquaintance: Vec::with_capacity(comparison.truths.len()),
        };
        let mut similarity = [0.0; ALPHAS + 1];
        let mut matcher = StepMatcher::default();
        for step in &comparison.steps {
            let worth = |index: usize, pair: &Pair| {
                alignment[acquaintances.of_pair[index] as usize] * pair.similarity
            };
            for &index in matcher.best(comparison, step, worth) {
                let pair = &comparison.pairs[index as usize];
                let reached = alphas_reached(pair.similarity);
                let acquaintance = acquaintances.of_pair[index as usize];
                matched.counts[acquaintance as usize][reached] += 1;
                matched.acquaintance.push(acquaintance);
                similarity[reached] += pair.similarity;
                let cell = (pair.truth, pair.track, reached as f64);
                matched.cells.push(cell);
            }
        }
        let mut sum = 0.0;
        for index in (0..ALPHAS).rev() {
            sum += similarity[index + 1];
            self.similarity[index] += sum;
        }
        matched
    }

    /// Step 3 for one truth and one track; for each number of thresholds what a match that reaches so many adds to the
    /// association at all of them.
    fn add_acquaintance(
        &mut self,
        (truth_points, track_points): (f64, f64),
        reached: &[u32; ALPHAS + 1],
    ) -> [f64; ALPHAS + 1] {
        let (mut matches, mut shares) = (0.0, [0.0; ALPHAS + 1]);
        for index in (0..ALPHAS).rev() {
            matches += f64::from(reached[index + 1]);
            if matches > 0.0 {
                self.tp[index] += matches;
                self.association[index] +=
                    matches * matches / (truth_points + track_points - matches);
                self.association_recall[index] += matches * matches / truth_points;
                self.association_precision[index] += matches * matches / track_points;
                shares[index + 1] = matches / (truth_points + track_points - matches);
            }
        }
        for index in 0..ALPHAS {
            shares[index + 1] += shares[index];
        }
        shares
    }

    fn is_defined(&self) -> bool {
        self.truth_points + self.track_points > 0.0
    }

    /// Every part at each α.
    fn curves(&self) -> [(&'static str, [f64; ALPHAS]); 9] {
        let det_re = self.tp.map(|tp| tp / self.truth_points.max(1.0));
        let det_a = self
            .tp
            .map(|tp| tp / (self.truth_points + self.track_points - tp).max(1.0));
        let ass_a = self.per_match(&self.association, 0.0);
        [
            ("hota", geometric_means(&det_a, &ass_a)),
            ("det_a", det_a),
            ("ass_a", ass_a),
            ("loc_a", self.per_match(&self.similarity, 1.0)),
            ("det_re", det_re),
            ("det_pr", self.tp.map(|tp| tp / self.track_points.max(1.0))),
            ("ass_re", self.per_match(&self.association_recall, 0.0)),
            ("ass_pr", self.per_match(&self.association_precision, 0.0)),
            ("owta", geometric_means(&det_re, &ass_a)),
        ]
    }

    /// Sums divided by the matches of each threshold; `alone` where there is none.
    fn per_match(&self, sums: &[f64; ALPHAS], alone: f64) -> [f64; ALPHAS] {
        std::array::from_fn(|index| {
            if self.tp[index] > 0.0 {
                sums[index] / self.tp[index]
            } else {
                alone
            }
        })
    }

    fn counts(&self) -> [(&'static str, [f64; ALPHAS]); 3] {
        [
            ("tp", self.tp),
            ("fn", self.tp.map(|tp| self.truth_points - tp)),
            ("fp", self.tp.map(|tp| self.track_points - tp)),
        ]
    }

    /// The means over α; 0 / 0 is `null` with a reason.
    fn quantities(&self, curves: &[(&'static str, [f64; ALPHAS]); 9]) -> Vec<Quantity> {
        let no_truth = (self.truth_points == 0.0).then_some("no truth at any step");
        let no_track = (self.track_points == 0.0).then_some("no track at any step");
        let nothing = (!self.is_defined()).then_some("neither truth nor track at any step");
        let no_match = (self.tp[0] == 0.0).then_some("nothing was matched at any threshold");
        let mut quantities = Vec::new();
        for (name, values) in curves {
            let reason = match *name {
                "hota" | "det_a" => nothing,
                "det_re" | "owta" => no_truth,
                "det_pr" => no_track,
                _ => no_match,
            };
            let mean = values.iter().sum::<f64>() / ALPHAS as f64;
            quantities.push(unless(reason, name, mean));
        }
        let (hota_0, loc_a_0) = (curves[0].1[0], curves[3].1[0]);
        quantities.push(unless(nothing, "hota_0", hota_0));
        quantities.push(unless(no_match, "loc_a_0", loc_a_0));
        quantities.push(unless(no_match, "hota_loc_a_0", hota_0 * loc_a_0));
        quantities
    }
}

fn geometric_means(left: &[f64; ALPHAS], right: &[f64; ALPHAS]) -> [f64; ALPHAS] {
    std::array::from_fn(|index| (left[index] * right[index]).sqrt())
}

/// The value, unless there is a reason why it is undefined.
fn unless(reason: Option<&'static str>, name: &'static str, value: f64) -> Quantity {
    Quantity::or(
        name,
        Some(value).filter(|_| reason.is_none()),
        "",
        reason.unwrap_or("not a finite number"),
    )
}

/// At how many steps each exists.
fn points(presences: &[Presence], ids: &[String]) -> Vec<f64> {
    let mut points = vec![0.0; ids.len()];
    presences
        .iter()
        .for_each(|presence| points[presence.id as usize] += 1.0);
    points
}

/// Step 1: a for each acquaintance.
fn alignment(
    comparison: &Comparison,
    acquaintances: &Acquaintances,
    points_of: impl Fn((u32, u32)) -> (f64, f64),
) -> Vec<f64> {
    let mut shares = vec![0.0; acquaintances.ids.len()];
    let (mut of_truth, mut of_track) = (
        vec![0.0; comparison.truths.len()],
        vec![0.0; comparison.tracks.len()],
    );
    for pair in &comparison.pairs {
        of_truth[pair.truth as usize] += pair.similarity;
        of_track[pair.track as usize] += pair.similarity;
    }
    for (pair, &acquaintance) in comparison.pairs.iter().zip(&acquaintances.of_pair) {
        let together =
            of_truth[pair.truth as usize] + of_track[pair.track as usize] - pair.similarity;
        if together > f64::EPSILON {
            shares[acquaintance as usize] += pair.similarity / together;
        }
    }
    for (share, &ids) in shares.iter_mut().zip(&acquaintances.ids) {
        let (truth_points, track_points) = points_of(ids);
        *share /= truth_points + track_points - *share;
    }
    shares
}

#[cfg(test)]
mod tests;
