//! Errors of position and velocity of matched tracks: how large, in which direction, and whether they are as large as the
//! tracks themselves say.
//!
//! # Reference
//! Y. Bar-Shalom, X.-R. Li, T. Kirubarajan, Estimation with Applications to Tracking and Navigation, 2001, sections 5.4.2
//! and 11.3.
//!
//! # Symbols
//! e error, track minus truth; u unit vector of the truth's velocity; P covariance of the track; N samples of n numbers.
//!
//! # Method
//! 1. Every match of the log gives one e, along all axes of the space. Along the course over ground is e · u, across it (to the
//!    right positive) e · (u_y, −u_x); neither exists for a truth at rest, and in a volume the error of height is beside them.
//! 2. Root mean squares, means (bias), and the smallest position error that 95 % of the matches do not exceed.
//! 3. Of directions the error of the bearing: root mean square and mean.
//! 4. [`consistency`]: NEES of position (n = 2, in a volume 3) and of the whole state (n = 4, 6), and the NIS that tracks carry.

mod consistency;
mod directions;

use self::consistency::{Consistency, Normalised};
use super::origin::{Origin, PAIRS, PairColumn, Statistic};
use super::{BuildMetric, Line, Metric, MetricReport, Quantity, Sequence, Series};
use crate::evaluation::comparison::Presence;
use crate::evaluation::events::EventKind;
use crate::model::space::{Place, Space};
use crate::model::state::Position;
use crate::model::track::TrackPoint;
use crate::registry::{Method, Object, default, number, whole};
use serde::Deserialize;
use serde_json::{Value, json};
use std::ops::Range;

pub const METHOD: Method<BuildMetric> = Method {
    name: "kinematics",
    parameters: &PARAMETERS,
    build: |spec| Ok(Box::new(Kinematics::deserialize(spec)?)),
};

static PARAMETERS: Object = Object {
    name: "Kinematics",
    summary: "Errors of position and velocity, along and across the course, and their consistency with the covariances.",
    fields: &[
        default(
            "confidence",
            "Probability with which a consistent filter lies within the chi-square bounds.",
            number(0.5, 0.9999, ""),
            "0.95",
        ),
        default(
            "measurement_dimensions",
            "How many numbers a measurement has, for the bounds of the NIS: 1 of bearings alone, 2 of positions.",
            whole(1, 6, ""),
            "2",
        ),
    ],
};

#[derive(Deserialize)]
struct Kinematics {
    confidence: f64,
    measurement_dimensions: u32,
}

/// What one match says.
struct Sample {
    step: usize,
    truth: u32,
    /// Indices into the truths and tracks of the comparison.
    places: (u32, u32),
    error_m: Place,
    error_mps: Option<Place>,
    /// Along and across the course.
    on_course_m: Option<(f64, f64)>,
    normalised: Normalised,
}

const NO_MATCH: &str = "no track matches a target";
const NO_VELOCITY: &str = "no track with a velocity matches a target with one";
const NO_COURSE: &str = "no matched target is known to move";

impl Metric for Kinematics {
    fn evaluate(&self, sequences: &[Sequence]) -> MetricReport {
        let space = sequences.first().and_then(|first| first.comparison.space);
        if space == Some(Space::Bearing) {
            return directions::evaluate(sequences, self.confidence);
        }
        let has_heights = sequences.iter().any(has_heights);
        let axes = if has_heights { 3 } else { 2 };
        let mut consistency = Consistency::new(self.confidence, self.measurement_dimensions, axes);
        let by_sequence: Vec<Vec<Sample>> = sequences.iter().map(samples).collect();
        let all: Vec<&Sample> = by_sequence.iter().flatten().collect();
        let mut quantities = errors(&all, has_heights);
        quantities.extend(consistency.summary(&by_sequence));
        let mut report = MetricReport::new(
            "position_rmse",
            false,
            self.parameters(sequences),
            quantities,
        );
        // Where there are detections the tracks may be of this job, whose updates are all known.
        let is_nis_told = sequences
            .iter()
            .all(|sequence| sequence.input.is_none_or(|input| input.recording.is_none()));
        report.warnings = consistency.doubts(&report.quantities, is_nis_told);
        let of_heights = if has_heights { FROM_HEIGHTS } else { &[] };
        let origins = FROM.iter().chain(of_heights).chain(consistency::FROM);
        report.origins = origins.copied().collect();
        if let ([sequence], [samples]) = (sequences, &by_sequence[..]) {
            let steps = sequence.comparison.steps.len();
            report.per_truth = truth_lines(sequence, samples, &mut consistency);
            report.series = vec![position_series(samples, steps)];
            report.series.extend(consistency.series(samples, steps));
            report.pairs = pair_columns(samples, has_heights);
        }
        report
    }
}

const fn rows(quantity: &'static str, statistic: Statistic, column: &'static str) -> Origin {
    Origin::rows(quantity, statistic, PAIRS, column)
}

const FROM: &[Origin] = &[
    rows("matches", Statistic::Count, "position_error"),
    rows("position_rmse", Statistic::RootMeanSquare, "position_error"),
    rows("position_95", Statistic::NearestRank95, "position_error"),
    rows("velocity_rmse", Statistic::RootMeanSquare, "velocity_error"),
    rows("along_rmse", Statistic::RootMeanSquare, "along_error"),
    rows("across_rmse", Statistic::RootMeanSquare, "across_error"),
    rows("along_bias", Statistic::Mean, "along_error"),
    rows("across_bias", Statistic::Mean, "across_error"),
    rows("x_bias", Statistic::Mean, "x_error"),
    rows("y_bias", Statistic::Mean, "y_error"),
];

const FROM_HEIGHTS: &[Origin] = &[
    rows("z_rmse", Statistic::RootMeanSquare, "z_error"),
    rows("z_bias", Statistic::Mean, "z_error"),
];

fn has_heights(sequence: &Sequence) -> bool {
    sequence.comparison.space == Some(Space::Volume)
}

/// What each match says.
fn pair_columns(samples: &[Sample], has_heights: bool) -> Vec<PairColumn> {
    let column = |name, unit, of: &dyn Fn(&Sample) -> Option<f64>| {
        let mut cells = Vec::new();
        for sample in samples {
            let (truth, track) = sample.places;
            cells.extend(of(sample).map(|value| (truth, track, value)));
        }
        PairColumn::new(name, unit, cells)
    };
    let mut columns = vec![
        column("position_error", "m", &|sample| Some(sample.error_m.norm())),
        column("x_error", "m", &|sample| Some(sample.error_m.x)),
        column("y_error", "m", &|sample| Some(sample.error_m.y)),
        column("along_error", "m", &|sample| {
            sample.on_course_m.map(|(along_m, _)| along_m)
        }),
        column("across_error", "m", &|sample| {
            sample.on_course_m.map(|(_, across_m)| across_m)
        }),
        column("velocity_error", "m/s", &|sample| {
            sample.error_mps.map(|error_mps| error_mps.norm())
        }),
    ];
    columns.extend(has_heights.then(|| column("z_error", "m", &|sample| Some(sample.error_m.z))));
    columns.extend(consistency::families().map(|(name, of)| column(name, "", &of)));
    columns
}

impl Kinematics {
    fn parameters(&self, sequences: &[Sequence]) -> Value {
        json!({
            "gate_m": sequences.first().map(|sequence| sequence.comparison.gate),
            "confidence": self.confidence,
            "measurement_dimensions": self.measurement_dimensions,
        })
    }
}

/// Step 1.
fn samples(sequence: &Sequence) -> Vec<Sample> {
    let comparison = sequence.comparison;
    let sample = |event: &crate::evaluation::events::Event| {
        let step = &comparison.steps[event.step as usize];
        let places = (
            find(&comparison.truths, &step.truths, event.truth?)?,
            find(&comparison.tracks, &step.tracks, event.track?)?,
        );
        let truth = comparison.truth_beside(places.0, places.1);
        let track = &comparison.tracks[places.1];
        let places = (places.0 as u32, places.1 as u32);
        let error_m = track.position_m - truth.position_m;
        let error_mps = track
            .velocity_mps()
            .zip(truth.velocity_mps())
            .map(|(track, truth)| track - truth);
        let point = point_of(sequence, track);
        let space = comparison.space.unwrap_or_default();
        let normalised = point.map(|point| Normalised {
            innovation: point.nis,
            ..Normalised::new(space, error_m, error_mps, &point.estimate)
        });
        let on_course_m = truth
            .velocity_mps()
            .and_then(|velocity_mps| on_course(error_m.xy(), velocity_mps.xy()));
        Some(Sample {
            step: event.step as usize,
            truth: truth.id,
            places,
            error_m,
            error_mps,
            on_course_m,
            normalised: normalised.unwrap_or_default(),
        })
    };
    let matches = sequence
        .events
        .events
        .iter()
        .filter(|event| event.kind == EventKind::Match);
    matches.filter_map(sample).collect()
}

/// The index of one among those of a step.
fn find(presences: &[Presence], step: &Range<usize>, id: u32) -> Option<usize> {
    presences[step.clone()]
        .binary_search_by_key(&id, |presence| presence.id)
        .ok()
        .map(|place| step.start + place)
}

/// The point of the input that a presence was made of.
fn point_of<'a>(sequence: &Sequence<'a>, track: &Presence) -> Option<&'a TrackPoint> {
    sequence
        .input?
        .tracks
        .tracks
        .get(track.id as usize)?
        .points
        .get(track.point as usize)
}

/// The error along and across a course, y north and x east.
fn on_course(error_m: Position, velocity_mps: Position) -> Option<(f64, f64)> {
    let course = velocity_mps.try_normalize(0.0)?;
    Some((
        error_m.dot(&course),
        error_m.x * course.y - error_m.y * course.x,
    ))
}

/// Step 2.
fn errors(samples: &[&Sample], has_heights: bool) -> Vec<Quantity> {
    let velocity: Vec<f64> = samples
        .iter()
        .filter_map(|sample| sample.error_mps)
        .map(|error| error.norm_squared())
        .collect();
    let along: Vec<f64> = samples
        .iter()
        .filter_map(|sample| sample.on_course_m)
        .map(|(along, _)| along)
        .collect();
    let across: Vec<f64> = samples
        .iter()
        .filter_map(|sample| sample.on_course_m)
        .map(|(_, across)| across)
        .collect();
    let x: Vec<f64> = samples.iter().map(|sample| sample.error_m.x).collect();
    let y: Vec<f64> = samples.iter().map(|sample| sample.error_m.y).collect();
    let mut quantities = vec![
        root_mean("position_rmse", &position_squares(samples), "m", NO_MATCH),
        Quantity::or(
            "position_95",
            nearest_rank_95(position_errors(samples)),
            "m",
            NO_MATCH,
        ),
        root_mean("velocity_rmse", &velocity, "m/s", NO_VELOCITY),
        root_mean("along_rmse", &squares(&along), "m", NO_COURSE),
        root_mean("across_rmse", &squares(&across), "m", NO_COURSE),
        mean("along_bias", &along, "m", NO_COURSE),
        mean("across_bias", &across, "m", NO_COURSE),
        mean("x_bias", &x, "m", NO_MATCH),
        mean("y_bias", &y, "m", NO_MATCH),
    ];
    if has_heights {
        let z: Vec<f64> = samples.iter().map(|sample| sample.error_m.z).collect();
        quantities.push(root_mean("z_rmse", &squares(&z), "m", NO_MATCH));
        quantities.push(mean("z_bias", &z, "m", NO_MATCH));
    }
    quantities.push(Quantity::new("matches", samples.len() as f64, ""));
    quantities
}

fn squares(values: &[f64]) -> Vec<f64> {
    values.iter().map(|value| value * value).collect()
}

fn position_squares(samples: &[&Sample]) -> Vec<f64> {
    samples
        .iter()
        .map(|sample| sample.error_m.norm_squared())
        .collect()
}

fn mean(name: &'static str, values: &[f64], unit: &'static str, reason: &'static str) -> Quantity {
    Quantity::ratio(name, values.iter().sum(), values.len() as f64, unit, reason)
}

fn root_mean(
    name: &'static str,
    squares: &[f64],
    unit: &'static str,
    reason: &'static str,
) -> Quantity {
    let mean = mean(name, squares, unit, reason);
    Quantity::or(name, mean.value.map(f64::sqrt), unit, reason)
}

/// The nearest rank: the smallest error that at least 95 % do not exceed.
fn nearest_rank_95(mut errors: Vec<f64>) -> Option<f64> {
    let rank = (errors.len() * 95).div_ceil(100).checked_sub(1)?;
    let (_, error, _) = errors.select_nth_unstable_by(rank, f64::total_cmp);
    Some(*error)
}

fn position_errors(samples: &[&Sample]) -> Vec<f64> {
    samples.iter().map(|sample| sample.error_m.norm()).collect()
}

fn truth_lines(
    sequence: &Sequence,
    samples: &[Sample],
    consistency: &mut Consistency,
) -> Vec<Line> {
    let mut of_truth: Vec<Vec<&Sample>> = vec![Vec::new(); sequence.comparison.truth_ids.len()];
    for sample in samples {
        of_truth[sample.truth as usize].push(sample);
    }
    let line = |(id, samples): (&String, &Vec<&Sample>)| {
        let mut quantities = errors(samples, has_heights(sequence));
        quantities.extend(consistency.means(samples));
        Line {
            id: id.clone(),
            quantities,
        }
    };
    sequence
        .comparison
        .truth_ids
        .iter()
        .zip(&of_truth)
        .map(line)
        .collect()
}

/// Root mean square error of position over the targets matched at each step.
fn position_series(samples: &[Sample], steps: usize) -> Series {
    let mut sums = vec![(0.0, 0.0); steps];
    for sample in samples {
        sums[sample.step].0 += sample.error_m.norm_squared();
        sums[sample.step].1 += 1.0;
    }
    Series::over_time(
        "position_rmse",
        "m",
        sums.into_iter()
            .map(|(sum, count)| (count > 0.0).then(|| f64::sqrt(sum / count))),
    )
}
