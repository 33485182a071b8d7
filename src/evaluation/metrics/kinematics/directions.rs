//! Errors of matched directions, in degrees, clockwise positive, the shorter way round.
//!
//! # Symbols
//! e error, p variance of a track's bearing (rad² in its estimate); N samples; χ²(k, q) the q-quantile with k degrees of freedom.
//!
//! # Method
//! 1. Root mean square, mean (bias), and the smallest |e| that 95 % of the matches do not exceed.
//! 2. NEES = e² / p of tracks with covariances. Of a consistent filter the mean of N samples, if they are independent, lies within
//!    χ²(N, ½ ∓ ½ confidence) / N with that confidence.

use super::consistency::NO_COVARIANCE;
use super::{NO_MATCH, find, mean, nearest_rank_95, point_of, root_mean, squares};
use crate::evaluation::events::EventKind;
use crate::evaluation::metrics::origin::{Origin, PAIRS, PairColumn, Statistic};
use crate::evaluation::metrics::{Line, MetricReport, Quantity, Sequence, Series};
use crate::math::gaussian::chi_square_quantile;
use serde_json::json;

/// One match.
struct Sample {
    step: u32,
    truth: u32,
    /// Indices into the truths and tracks of the comparison.
    places: (u32, u32),
    error_deg: f64,
    nees: Option<f64>,
}

const FROM: [Origin; 6] = [
    Origin::rows("matches", Statistic::Count, PAIRS, "bearing_error"),
    Origin::rows(
        "bearing_rmse",
        Statistic::RootMeanSquare,
        PAIRS,
        "bearing_error",
    ),
    Origin::rows("bearing_bias", Statistic::Mean, PAIRS, "bearing_error"),
    Origin::rows(
        "bearing_95",
        Statistic::NearestRank95,
        PAIRS,
        "bearing_offset",
    ),
    Origin::rows("nees_bearing", Statistic::Mean, PAIRS, "nees_bearing"),
    Origin::rows(
        "nees_bearing_samples",
        Statistic::Count,
        PAIRS,
        "nees_bearing",
    ),
];

/// `confidence` is that of the bounds of the NEES.
pub fn evaluate(sequences: &[Sequence], confidence: f64) -> MetricReport {
    let by_sequence: Vec<Vec<Sample>> = sequences.iter().map(samples).collect();
    let all: Vec<&Sample> = by_sequence.iter().flatten().collect();
    let gate_deg = sequences.first().map(|sequence| sequence.comparison.gate);
    let parameters = json!({"gate_deg": gate_deg, "confidence": confidence});
    let mut report = MetricReport::new("bearing_rmse", false, parameters, errors(&all, confidence));
    report.origins = FROM.to_vec();
    if let ([sequence], [samples]) = (sequences, &by_sequence[..]) {
        report.pairs = vec![
            column("bearing_error", "deg", samples, |sample| {
                Some(sample.error_deg)
            }),
            column("bearing_offset", "deg", samples, |sample| {
                Some(sample.error_deg.abs())
            }),
            column("nees_bearing", "", samples, |sample| sample.nees),
        ];
        report.per_truth = lines(sequence, samples, confidence);
        report.series = vec![series(samples, sequence.comparison.steps.len())];
    }
    report
}

fn column(
    name: &'static str,
    unit: &'static str,
    samples: &[Sample],
    of: fn(&Sample) -> Option<f64>,
) -> PairColumn {
    let mut cells = Vec::new();
    for sample in samples {
        let (truth, track) = sample.places;
        cells.extend(of(sample).map(|value| (truth, track, value)));
    }
    PairColumn::new(name, unit, cells)
}

fn samples(sequence: &Sequence) -> Vec<Sample> {
    let comparison = sequence.comparison;
    let mut samples = Vec::new();
    for event in &sequence.events.events {
        let (EventKind::Match, Some(truth), Some(track)) = (event.kind, event.truth, event.track)
        else {
            continue;
        };
        let step = &comparison.steps[event.step as usize];
        let (Some(here), Some(there)) = (
            find(&comparison.truths, &step.truths, truth),
            find(&comparison.tracks, &step.tracks, track),
        ) else {
            continue;
        };
        let beside = comparison.truth_beside(here, there);
        let turn_deg = comparison.tracks[there].position_m.x - beside.position_m.x;
        let error_deg = (turn_deg + 180.0).rem_euclid(360.0) - 180.0;
        let point = point_of(sequence, &comparison.tracks[there]);
        let covariance = point.and_then(|point| point.estimate.covariance.as_ref());
        let variance = covariance.and_then(|packed| packed.first().copied());
        samples.push(Sample {
            step: event.step,
            truth,
            places: (here as u32, there as u32),
            error_deg,
            nees: variance
                .filter(|variance| *variance > 0.0)
                .map(|variance| error_deg.to_radians().powi(2) / variance),
        });
    }
    samples
}

fn errors(samples: &[&Sample], confidence: f64) -> Vec<Quantity> {
    let errors_deg: Vec<f64> = samples.iter().map(|sample| sample.error_deg).collect();
    let offsets_deg = errors_deg.iter().map(|error_deg| error_deg.abs()).collect();
    let mut quantities = vec![
        root_mean("bearing_rmse", &squares(&errors_deg), "deg", NO_MATCH),
        mean("bearing_bias", &errors_deg, "deg", NO_MATCH),
        Quantity::or("bearing_95", nearest_rank_95(offsets_deg), "deg", NO_MATCH),
        Quantity::count("matches", samples.len() as f64),
    ];
    quantities.extend(consistency(samples, confidence));
    quantities
}

/// Method 2.
fn consistency(samples: &[&Sample], confidence: f64) -> [Quantity; 4] {
    let values: Vec<f64> = samples.iter().filter_map(|sample| sample.nees).collect();
    let count = values.len() as f64;
    let bound = |side: f64| {
        let probability = 0.5 + 0.5 * side * confidence;
        (count > 0.0).then(|| chi_square_quantile(probability, count) / count)
    };
    [
        mean("nees_bearing", &values, "", NO_COVARIANCE),
        Quantity::or("nees_bearing_lower", bound(-1.0), "", NO_COVARIANCE),
        Quantity::or("nees_bearing_upper", bound(1.0), "", NO_COVARIANCE),
        Quantity::new("nees_bearing_samples", count, ""),
    ]
}

fn lines(sequence: &Sequence, samples: &[Sample], confidence: f64) -> Vec<Line> {
    let ids = &sequence.comparison.truth_ids;
    let mut of_truth: Vec<Vec<&Sample>> = vec![Vec::new(); ids.len()];
    for sample in samples {
        of_truth[sample.truth as usize].push(sample);
    }
    let line = |(id, samples): (&String, &Vec<&Sample>)| Line {
        id: id.clone(),
        quantities: errors(samples, confidence),
    };
    ids.iter().zip(&of_truth).map(line).collect()
}

/// Over the targets matched at each step.
fn series(samples: &[Sample], steps: usize) -> Series {
    let mut sums = vec![(0.0, 0.0); steps];
    for sample in samples {
        let sum: &mut (f64, f64) = &mut sums[sample.step as usize];
        *sum = (sum.0 + sample.error_deg * sample.error_deg, sum.1 + 1.0);
    }
    let root = |(sum, count): (f64, f64)| (count > 0.0).then(|| f64::sqrt(sum / count));
    Series::over_time("bearing_rmse", "deg", sums.into_iter().map(root))
}
