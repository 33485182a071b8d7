//! Whether tracks that carry the names of their targets stay with them: for tracks that began at the truth, where only the
//! association can lose them. Of a scene of two it is what "both tracks are correct" means, in two definitions.
//!
//! # Reference
//! The correct-association probability η of Wang, Li, Huang (bat algorithm data association for bearings): the share of the runs
//! in which every track stays with its own target. That paper does not say when a track does; here are two ways to say it.
//!
//! # Symbols
//! e distance of a track and the target of its name (of directions the shorter way round); σ standard deviation of a
//! measurement; *apart* (6), *lost* (10), *stay* (5) factors of σ.
//!
//! # Method
//! 1. *Identity* of a target: at every step at which it is more than *apart* σ from all others, it is the target nearest to its
//!    track; and at every step e ≤ *lost* σ. So a track may waver while targets cross, but not change sides.
//! 2. *Stay* of a target: e ≤ *stay* σ at every step.
//! 3. A step at which the target is there and its track is not breaks both.
//! 4. A run is kept, by either definition, when all its targets are. The headline is the share of kept runs (1 or 0 of one run).
//! 5. A target is lost at the first step that breaks its identity; it was swapped with the target nearest to its track then, if
//!    that is another one.

use super::origin::{Origin, PAIRS, PairColumn, Statistic, TRUTH_POINTS, TRUTHS};
use super::{BuildMetric, Line, Metric, MetricReport, Quantity, Sequence, Series};
use crate::evaluation::comparison::{ComparedStep, Comparison, Presence, turns};
use crate::model::sensor::SensorSettings;
use crate::model::space::{Place, Space};
use crate::registry::{Field, Method, Object, above, default, optional};
use serde::Deserialize;
use serde_json::{Value, json};
use std::collections::BTreeMap;

pub const METHOD: Method<BuildMetric> = Method {
    name: "track_keeping",
    parameters: &PARAMETERS,
    build: |spec| Ok(Box::new(TrackKeeping::deserialize(spec)?)),
};

static PARAMETERS: Object = Object {
    name: "TrackKeeping",
    summary: "Whether each track stays with the target whose name it carries: tracks that began at the truth, places or directions.",
    fields: &[
        optional(
            "sigma",
            "Standard deviation of a measurement, in degrees of directions, else in metres; that of the sensors when absent (the largest, of bearings or of x and y).",
            above(0.0, 1e6, "deg or m"),
        ),
        factor(
            "apart_sigmas",
            "Beyond this many sigmas from all others a target must be the nearest one to its track.",
            "6.0",
        ),
        factor(
            "lost_sigmas",
            "An error of more sigmas than this has lost the target.",
            "10.0",
        ),
        factor(
            "stay_sigmas",
            "The largest error, in sigmas, of a track that stays with its target.",
            "5.0",
        ),
    ],
};

const fn factor(name: &'static str, summary: &'static str, value: &'static str) -> Field {
    let kind = above(0.0, 1e6, "");
    default(name, summary, kind, value)
}

#[derive(Deserialize)]
struct TrackKeeping {
    sigma: Option<f64>,
    apart_sigmas: f64,
    lost_sigmas: f64,
    stay_sigmas: f64,
}

/// Of one target.
#[derive(Debug, Clone, PartialEq)]
struct Kept {
    identity: bool,
    stay: bool,
    /// Index of the step that broke the identity.
    lost: Option<usize>,
    swapped_with: Option<u32>,
    error_sum: f64,
    /// Steps with a track, and those of the target without one.
    errors: usize,
    missing: usize,
}

/// Of one run.
struct Run {
    targets: Vec<Kept>,
    /// Sum and number of the errors at each step.
    errors: Vec<(f64, usize)>,
    /// The error of each target and its track, as [`PairColumn`] has it.
    pairs: Vec<(u32, u32, f64)>,
}

const NO_SIGMA: &str = "sigma is not given, and no sensor of a recording tells it";
const NO_TARGET: &str = "there is no target";
const NO_NAME: &str = "no track is called like a target";

impl Metric for TrackKeeping {
    fn evaluate(&self, sequences: &[Sequence]) -> MetricReport {
        let sigmas: Vec<Option<f64>> = sequences
            .iter()
            .map(|sequence| self.sigma.or(sigma_of(sequence)))
            .collect();
        let runs: Vec<Run> = sequences
            .iter()
            .zip(&sigmas)
            .map(|(sequence, sigma)| self.run(sequence, sigma.unwrap_or(f64::NAN)))
            .collect();
        let unit = unit_of(sequences);
        let quantities = quantities(&runs, why_undefined(sequences, &sigmas), unit);
        let parameters = json!({
            "sigma": sigmas.first().copied().flatten(), "unit": unit, "apart_sigmas": self.apart_sigmas,
            "lost_sigmas": self.lost_sigmas, "stay_sigmas": self.stay_sigmas,
        });
        let mut report = MetricReport::new("identity", true, parameters, quantities);
        report.origins = FROM.to_vec();
        if let ([sequence], [run]) = (sequences, &runs[..]) {
            let is_defined = why_undefined(sequences, &sigmas).is_none();
            let lines = sequence.comparison.truth_ids.iter().zip(&run.targets);
            report.per_truth = lines
                .map(|(id, kept)| line(id, kept, sequence.comparison, is_defined, unit))
                .collect();
            let means = run
                .errors
                .iter()
                .map(|&(sum, count)| (count > 0).then(|| sum / count as f64));
            report.series = vec![Series::over_time("mean_absolute_error", unit, means)];
            report.pairs = vec![PairColumn::new("error", unit, run.pairs.clone())];
            if is_defined {
                report.findings = findings(sequence.comparison, run);
            }
        }
        report
    }
}

const FROM: &[Origin] = &[
    Origin::rows("mean_absolute_error", Statistic::Mean, PAIRS, "error"),
    Origin::rows("targets_identity", Statistic::Sum, TRUTHS, "identity"),
    Origin::rows("targets_stay", Statistic::Sum, TRUTHS, "stay"),
    Origin::all_rows("targets", TRUTHS),
    TRUTH_POINTS,
    Origin::rows("followed_points", Statistic::Count, PAIRS, "error"),
    Origin::terms("missing_points", &["truth_points", "-followed_points"]),
];

fn unit_of(sequences: &[Sequence]) -> &'static str {
    match sequences
        .first()
        .and_then(|sequence| sequence.comparison.space)
    {
        Some(Space::Bearing) => "deg",
        _ => "m",
    }
}

/// Why nothing can be said of the tracks' keeping.
fn why_undefined(sequences: &[Sequence], sigmas: &[Option<f64>]) -> Option<&'static str> {
    let comparisons = || sequences.iter().map(|sequence| sequence.comparison);
    if comparisons().all(|comparison| comparison.truth_ids.is_empty()) {
        return Some(NO_TARGET);
    }
    if !comparisons().any(has_named_track) {
        return Some(NO_NAME);
    }
    sigmas.iter().any(Option::is_none).then_some(NO_SIGMA)
}

/// Whether a track is called like a target.
fn has_named_track(comparison: &Comparison) -> bool {
    let mut track_ids = comparison.track_ids.iter();
    track_ids.any(|id| comparison.truth_ids.contains(id))
}

/// The largest of the sensors' standard deviations, if all tell one.
fn sigma_of(sequence: &Sequence) -> Option<f64> {
    let sigma = |sensor: &SensorSettings| match sequence.comparison.space? {
        Space::Bearing => sensor.sigma_bearing_deg,
        Space::Plane | Space::Volume => Some(sensor.sigma_x_m?.max(sensor.sigma_y_m?)),
    };
    let sensors = &sequence.input?.recording?.sensors;
    let sigmas: Option<Vec<f64>> = sensors.iter().map(sigma).collect();
    sigmas?.into_iter().reduce(f64::max)
}

impl TrackKeeping {
    fn run(&self, sequence: &Sequence, sigma: f64) -> Run {
        let comparison = sequence.comparison;
        let track_of = track_of_each(comparison);
        let start = Kept {
            identity: true,
            stay: true,
            lost: None,
            swapped_with: None,
            error_sum: 0.0,
            errors: 0,
            missing: 0,
        };
        let mut run = Run {
            targets: vec![start; comparison.truth_ids.len()],
            errors: vec![(0.0, 0); comparison.steps.len()],
            pairs: Vec::new(),
        };
        for (index, step) in comparison.steps.iter().enumerate() {
            let places = Places::new(comparison, step);
            for truth_place in step.truths.clone() {
                let truth = &comparison.truths[truth_place];
                let track =
                    track_of[truth.id as usize].and_then(|id| find(&comparison.tracks, step, id));
                let kept = &mut run.targets[truth.id as usize];
                let Some(track_place) = track else {
                    kept.missing += 1;
                    kept.stay = false;
                    kept.lose(index, None);
                    continue;
                };
                let track = &comparison.tracks[track_place];
                let beside = comparison.truth_beside(truth_place, track_place);
                let error = comparison.distance(&track.position_m, &beside.position_m);
                run.pairs
                    .push((truth_place as u32, track_place as u32, error));
                kept.error_sum += error;
                kept.errors += 1;
                run.errors[index].0 += error;
                run.errors[index].1 += 1;
                kept.stay &= error <= self.stay_sigmas * sigma;
                let nearest = places
                    .nearest(&track.position_m, None)
                    .filter(|(distance, id)| *id != truth.id && *distance < error);
                let apart = places.nearest(&truth.position_m, Some(truth.id));
                let is_apart =
                    apart.is_none_or(|(distance, _)| distance > self.apart_sigmas * sigma);
                if (is_apart && nearest.is_some()) || error > self.lost_sigmas * sigma {
                    kept.lose(index, nearest.map(|(_, id)| id));
                }
            }
        }
        run
    }
}

impl Kept {
    /// Only the first time counts.
    fn lose(&mut self, step: usize, nearest: Option<u32>) {
        if self.identity {
            (self.identity, self.lost, self.swapped_with) = (false, Some(step), nearest);
        }
    }

    fn mean_absolute_error(&self) -> Option<f64> {
        (self.errors > 0).then(|| self.error_sum / self.errors as f64)
    }
}

/// For each target the track of its name.
fn track_of_each(comparison: &Comparison) -> Vec<Option<u32>> {
    let ids: BTreeMap<&str, u32> = comparison
        .track_ids
        .iter()
        .enumerate()
        .map(|(id, name)| (name.as_str(), id as u32))
        .collect();
    comparison
        .truth_ids
        .iter()
        .map(|name| ids.get(name.as_str()).copied())
        .collect()
}

fn find(tracks: &[Presence], step: &ComparedStep, id: u32) -> Option<usize> {
    tracks[step.tracks.clone()]
        .binary_search_by_key(&id, |presence| presence.id)
        .ok()
        .map(|place| step.tracks.start + place)
}

/// The targets of a step, in order of x.
struct Places {
    space: Option<Space>,
    by_x: Vec<(Place, u32)>,
}

impl Places {
    fn new(comparison: &Comparison, step: &ComparedStep) -> Places {
        let mut by_x: Vec<(Place, u32)> = comparison.truths[step.truths.clone()]
            .iter()
            .map(|truth| (truth.position_m, truth.id))
            .collect();
        by_x.sort_by(|a, b| a.0.x.total_cmp(&b.0.x).then(a.1.cmp(&b.1)));
        Places {
            space: comparison.space,
            by_x,
        }
    }

    /// Distance and id of the nearest target other than `except`.
    fn nearest(&self, position: &Place, except: Option<u32>) -> Option<(f64, u32)> {
        let mut best: Option<(f64, u32)> = None;
        for turn in turns(self.space) {
            let wanted = position + Place::new(*turn, 0.0, 0.0);
            let after = self.by_x.partition_point(|(other, _)| other.x < wanted.x);
            let (below, above) = self.by_x.split_at(after);
            look(&mut below.iter().rev(), &wanted, except, &mut best);
            look(&mut above.iter(), &wanted, except, &mut best);
        }
        best
    }
}

/// Goes on until no place can be nearer than the best.
fn look(
    places: &mut dyn Iterator<Item = &(Place, u32)>,
    wanted: &Place,
    except: Option<u32>,
    best: &mut Option<(f64, u32)>,
) {
    for (other, id) in places {
        if best.is_some_and(|(distance, _)| (other.x - wanted.x).abs() > distance) {
            break;
        }
        let distance = (other.x - wanted.x)
            .hypot(other.y - wanted.y)
            .hypot(other.z - wanted.z);
        if Some(*id) != except && best.is_none_or(|(least, _)| distance < least) {
            *best = Some((distance, *id));
        }
    }
}

/// Steps 4 and 5 in numbers.
fn quantities(runs: &[Run], undefined: Option<&'static str>, unit: &'static str) -> Vec<Quantity> {
    let unless_undefined = |name, value: f64| {
        let value = undefined.is_none().then_some(value);
        Quantity::or(name, value, "", undefined.unwrap_or_default())
    };
    let all: Vec<&Run> = runs.iter().collect();
    let kept: Vec<&Run> = runs
        .iter()
        .filter(|run| undefined.is_none() && run.targets.iter().all(|kept| kept.identity))
        .collect();
    let missing: usize = targets_of(&all).map(|kept| kept.missing).sum();
    vec![
        unless_undefined("identity", share_of_runs(runs, |kept| kept.identity)),
        unless_undefined("stay", share_of_runs(runs, |kept| kept.stay)),
        mean_error("mean_absolute_error", &all, unit, NO_NAME),
        mean_error("mean_absolute_error_kept", &kept, unit, "no run is kept"),
        unless_undefined(
            "targets_identity",
            targets_of(&all).filter(|kept| kept.identity).count() as f64,
        ),
        unless_undefined(
            "targets_stay",
            targets_of(&all).filter(|kept| kept.stay).count() as f64,
        ),
        Quantity::new("targets", targets_of(&all).count() as f64, ""),
        Quantity::new("missing_points", missing as f64, ""),
    ]
}

fn targets_of<'r>(runs: &[&'r Run]) -> impl Iterator<Item = &'r Kept> {
    runs.iter().flat_map(|run| &run.targets)
}

/// The share of runs all of whose targets are kept in one sense.
fn share_of_runs(runs: &[Run], is_kept: fn(&Kept) -> bool) -> f64 {
    let kept = runs.iter().filter(|run| run.targets.iter().all(is_kept));
    kept.count() as f64 / runs.len() as f64
}

fn mean_error(
    name: &'static str,
    runs: &[&Run],
    unit: &'static str,
    reason: &'static str,
) -> Quantity {
    let sum = targets_of(runs).map(|kept| kept.error_sum).sum();
    let count = targets_of(runs).map(|kept| kept.errors).sum::<usize>();
    Quantity::ratio(name, sum, count as f64, unit, reason)
}

fn line(
    id: &str,
    kept: &Kept,
    comparison: &Comparison,
    is_defined: bool,
    unit: &'static str,
) -> Line {
    let flag = |name, is_kept: bool| {
        Quantity::or(
            name,
            is_defined.then(|| f64::from(u8::from(is_kept))),
            "",
            NO_SIGMA,
        )
    };
    let lost_time_s = kept
        .lost
        .filter(|_| is_defined)
        .map(|step| comparison.steps[step].time_s);
    Line {
        id: id.to_owned(),
        quantities: vec![
            flag("identity", kept.identity),
            flag("stay", kept.stay),
            Quantity::or("lost_time", lost_time_s, "s", "never lost"),
            Quantity::or(
                "mean_absolute_error",
                kept.mean_absolute_error(),
                unit,
                NO_NAME,
            ),
        ],
    }
}

fn findings(comparison: &Comparison, run: &Run) -> Value {
    let target = |(id, kept): (&String, &Kept)| {
        json!({
            "truth_id": id,
            "identity": kept.identity,
            "stay": kept.stay,
            "lost_step": kept.lost.map(|step| step + 1),
            "lost_time_s": kept.lost.map(|step| comparison.steps[step].time_s),
            "swapped_with": kept.swapped_with.map(|other| &comparison.truth_ids[other as usize]),
            "mean_absolute_error": kept.mean_absolute_error(),
        })
    };
    json!({ "targets": comparison.truth_ids.iter().zip(&run.targets).map(target).collect::<Vec<_>>() })
}

#[cfg(test)]
mod tests;
