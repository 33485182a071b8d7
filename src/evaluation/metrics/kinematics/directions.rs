//! Errors of matched directions, in degrees, clockwise positive, the shorter way round.

use super::{NO_MATCH, find, mean, root_mean, squares};
use crate::evaluation::events::EventKind;
use crate::evaluation::metrics::origin::{Origin, PAIRS, PairColumn, Statistic};
use crate::evaluation::metrics::{Line, MetricReport, Quantity, Sequence, Series};
use serde_json::json;

/// One match.
struct Sample {
    step: u32,
    truth: u32,
    /// Indices into the truths and tracks of the comparison.
    places: (u32, u32),
    error_deg: f64,
}

const FROM: [Origin; 3] = [
    Origin::rows("matches", Statistic::Count, PAIRS, "bearing_error"),
    Origin::rows(
        "bearing_rmse",
        Statistic::RootMeanSquare,
        PAIRS,
        "bearing_error",
    ),
    Origin::rows("bearing_bias", Statistic::Mean, PAIRS, "bearing_error"),
];

pub fn evaluate(sequences: &[Sequence]) -> MetricReport {
    let by_sequence: Vec<Vec<Sample>> = sequences.iter().map(samples).collect();
    let all: Vec<&Sample> = by_sequence.iter().flatten().collect();
    let gate_deg = sequences.first().map(|sequence| sequence.comparison.gate);
    let parameters = json!({"gate_deg": gate_deg});
    let mut report = MetricReport::new("bearing_rmse", false, parameters, errors(&all));
    report.origins = FROM.to_vec();
    if let ([sequence], [samples]) = (sequences, &by_sequence[..]) {
        let cell = |sample: &Sample| (sample.places.0, sample.places.1, sample.error_deg);
        let cells = samples.iter().map(cell).collect();
        report.pairs = vec![PairColumn::new("bearing_error", "deg", cells)];
        report.per_truth = lines(sequence, samples);
        report.series = vec![series(samples, sequence.comparison.steps.len())];
    }
    report
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
        samples.push(Sample {
            step: event.step,
            truth,
            places: (here as u32, there as u32),
            error_deg: (turn_deg + 180.0).rem_euclid(360.0) - 180.0,
        });
    }
    samples
}

fn errors(samples: &[&Sample]) -> Vec<Quantity> {
    let errors_deg: Vec<f64> = samples.iter().map(|sample| sample.error_deg).collect();
    vec![
        root_mean("bearing_rmse", &squares(&errors_deg), "deg", NO_MATCH),
        mean("bearing_bias", &errors_deg, "deg", NO_MATCH),
        Quantity::count("matches", samples.len() as f64),
    ]
}

fn lines(sequence: &Sequence, samples: &[Sample]) -> Vec<Line> {
    let ids = &sequence.comparison.truth_ids;
    let mut of_truth: Vec<Vec<&Sample>> = vec![Vec::new(); ids.len()];
    for sample in samples {
        of_truth[sample.truth as usize].push(sample);
    }
    let line = |(id, samples): (&String, &Vec<&Sample>)| Line {
        id: id.clone(),
        quantities: errors(samples),
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
