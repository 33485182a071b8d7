//! Metrics of a job: truth and tracks of each sequence put side by side, the log of events, every metric over all
//! sequences together and over each alone, and the files that say more than the report.

use super::metric_files::{self, MAX_PAIRS, Reports, TIME};
use super::progress::Told;
use crate::evaluation::EvaluationInput;
use crate::evaluation::breaks::{self, Break};
use crate::evaluation::comparison::{Alignment, Comparison, PointSettings, Shape};
use crate::evaluation::events::{EventKind, EventLog};
use crate::evaluation::extent::Extent;
use crate::evaluation::metrics::{METRICS, Metric, MetricReport, Quantity, Sequence};
use crate::evaluation::nearness;
use crate::experiment::files::text;
use crate::experiment::observer::Observer;
use crate::experiment::run::{Artifact, RunError};
use crate::model::boxes::BoxSet;
use crate::model::fault::Fault;
use crate::model::truth::TruthSet;
use crate::model::watch::Watch;
use serde::Deserialize;
use serde_json::{Map, Value, json};

/// Truth and tracks of one recording or run.
pub struct Subject<'a> {
    /// As the request calls it; empty where there is only one.
    pub name: &'a str,
    pub content: Content<'a>,
}

pub enum Content<'a> {
    /// `truth` is the truth of `input`.
    Points {
        input: EvaluationInput<'a>,
        truth: &'a TruthSet,
    },
    Boxes {
        truth: &'a BoxSet,
        tracks: &'a BoxSet,
    },
}

impl<'a> Content<'a> {
    fn input(&self) -> Option<EvaluationInput<'a>> {
        match *self {
            Content::Points { input, .. } => Some(input),
            Content::Boxes { .. } => None,
        }
    }
}

/// What the metrics say.
pub struct Judgement {
    /// The parts of the report: `metrics`, `events`, and with several sequences `sequences`.
    pub parts: Vec<(&'static str, Value)>,
    pub artifacts: Vec<Artifact>,
    pub warnings: Vec<String>,
}

/// A metric under the name that it has in the report.
struct Named {
    name: String,
    kind: &'static str,
    metric: Box<dyn Metric>,
}

/// The parameters of `comparison`.
#[derive(Debug, Clone, Copy, Deserialize)]
struct Settings {
    gate_m: f64,
    gate_deg: f64,
    min_iou: f64,
    alignment: Aligned,
}

#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(tag = "method", rename_all = "snake_case")]
enum Aligned {
    Interpolate { max_gap_s: f64 },
    Nearest { max_gap_s: f64 },
}

/// Judges the subjects by the metrics of `spec`; makes files where they are wanted.
pub fn judge(
    spec: &Value,
    subjects: &[Subject],
    wants_files: bool,
    observer: &mut dyn Observer,
) -> Result<Judgement, RunError> {
    let metrics = metrics_of(spec)?;
    refuse_mixtures(subjects)?;
    let steps = if subjects.len() > 1 {
        subjects.len() + 1
    } else {
        1
    };
    let mut told = Told::new(observer, (metrics.len() * steps) as u64);
    let comparisons = told.watching(|watch| compare(spec, subjects, &metrics, watch))??;
    let logs = told.watching(|watch| {
        comparisons
            .iter()
            .map(|comparison| EventLog::new_until(comparison, watch))
            .collect::<Vec<_>>()
    })?;
    let sequences: Vec<Sequence> = subjects
        .iter()
        .zip(comparisons.iter().zip(&logs))
        .map(|(subject, (comparison, events))| Sequence {
            comparison,
            events,
            input: subject.content.input(),
        })
        .collect();
    let mut together = Vec::new();
    for named in &metrics {
        together.push((
            named.name.as_str(),
            told.watching(|watch| named.metric.evaluate_until(&sequences, watch))?,
        ));
        told.one_more()?;
    }
    let mut alone = Vec::new();
    for sequence in sequences.iter().take(if sequences.len() > 1 {
        sequences.len()
    } else {
        0
    }) {
        let mut reports = Vec::new();
        for named in &metrics {
            let report = told.watching(|watch| {
                named
                    .metric
                    .evaluate_until(std::slice::from_ref(sequence), watch)
            })?;
            reports.push((named.name.as_str(), report));
            told.one_more()?;
        }
        alone.push(reports);
    }
    let of_each: Vec<&Reports> = if alone.is_empty() {
        vec![&together]
    } else {
        alone.iter().collect()
    };
    let names: Vec<&str> = subjects.iter().map(|subject| subject.name).collect();
    let mut parts = vec![
        (
            "metrics",
            with_origins(written(&together), &together, &of_each),
        ),
        ("events", event_counts(subjects, &sequences)),
    ];
    if !alone.is_empty() {
        let sequence = |(subject, reports): (&Subject, &Vec<_>)| json!({"name": subject.name, "metrics": written(reports)});
        parts.push((
            "sequences",
            subjects.iter().zip(&alone).map(sequence).collect(),
        ));
    }
    let (mut artifacts, pairs) = if wants_files {
        metric_files::files(&names, &sequences, &of_each)
    } else {
        Default::default()
    };
    if wants_files {
        let result: Map<String, Value> = parts
            .iter()
            .map(|(name, value)| ((*name).to_owned(), value.clone()))
            .collect();
        artifacts.extend(
            text::metrics(&Value::Object(result)).map(|text| text_file("metrics.txt", text)),
        );
    }
    let warnings = subjects
        .iter()
        .zip(&comparisons)
        .flat_map(|(subject, comparison)| {
            let place = if subject.name.is_empty() {
                String::new()
            } else {
                format!("{}: ", subject.name)
            };
            comparison
                .warnings
                .iter()
                .map(move |warning| format!("{place}{warning}"))
        });
    let apart = subjects
        .iter()
        .zip(&comparisons)
        .filter_map(|(subject, comparison)| never_near(subject, comparison));
    let of_metrics = together
        .iter()
        .flat_map(|(_, report)| report.warnings.iter().cloned());
    let too_many = (pairs > MAX_PAIRS)
        .then(|| format!("pairs.csv is left out: {pairs} pairs are more than {MAX_PAIRS}"));
    Ok(Judgement {
        parts,
        artifacts,
        warnings: warnings
            .chain(apart)
            .chain(of_metrics)
            .chain(too_many)
            .collect(),
    })
}

/// Builds the metrics. The second of one kind is called `gospa_2`, and so on.
fn metrics_of(spec: &Value) -> Result<Vec<Named>, RunError> {
    let mut metrics: Vec<Named> = Vec::new();
    for (index, body) in spec["metrics"].as_array().into_iter().flatten().enumerate() {
        // The checked spec names only metrics of the table, with parameters that fit; anything else is a fault of ours.
        let unusable = || {
            RunError::Faults(vec![Fault::new(
                format!("/metrics/{index}"),
                "malformed",
                "the settings cannot be used",
            )])
        };
        let entry = METRICS
            .iter()
            .find(|entry| body["metric"] == entry.name)
            .ok_or_else(unusable)?;
        let metric = (entry.build)(body).map_err(|_| unusable())?;
        let name = match metrics
            .iter()
            .filter(|other| other.kind == entry.name)
            .count()
        {
            0 => entry.name.to_owned(),
            others => format!("{}_{}", entry.name, others + 1),
        };
        metrics.push(Named {
            name,
            kind: entry.name,
            metric,
        });
    }
    Ok(metrics)
}

/// The metrics that directions can be judged by.
pub const FOR_BEARINGS: &str = "track_keeping";

/// Whether this entry of `metrics` is one of [`FOR_BEARINGS`].
pub fn accepts_bearings(body: &Value) -> bool {
    let entry = METRICS.iter().find(|entry| body["metric"] == entry.name);
    entry
        .and_then(|entry| (entry.build)(body).ok())
        .is_some_and(|metric| metric.accepts(Shape::Bearings))
}

fn compare(
    spec: &Value,
    subjects: &[Subject],
    metrics: &[Named],
    watch: &Watch,
) -> Result<Vec<Comparison>, RunError> {
    let settings = Settings::deserialize(&spec["comparison"]).map_err(|error| {
        RunError::Faults(vec![Fault::new(
            "/comparison",
            "malformed",
            error.to_string(),
        )])
    })?;
    let alignment = match settings.alignment {
        Aligned::Interpolate { max_gap_s } => Alignment::Interpolate { max_gap_s },
        Aligned::Nearest { max_gap_s } => Alignment::Nearest { max_gap_s },
    };
    let reach_m = metrics
        .iter()
        .map(|named| named.metric.reach_m(settings.gate_m))
        .fold(settings.gate_m, f64::max);
    let time_tolerance_s = time_tolerance_s(spec);
    let places = PointSettings {
        alignment,
        gate_m: settings.gate_m,
        reach_m,
        time_tolerance_s,
    };
    let directions = PointSettings {
        alignment,
        gate_m: settings.gate_deg,
        reach_m: settings.gate_deg,
        time_tolerance_s,
    };
    let mut extent = Extent::new(watch);
    let mut comparison = |subject: &Subject| match &subject.content {
        Content::Points { input, truth } => {
            let settings = if truth.is_of_bearings() {
                &directions
            } else {
                &places
            };
            Comparison::of_points_within(input, truth, settings, &mut extent)
        }
        Content::Boxes { truth, tracks } => {
            Comparison::of_boxes_within(truth, tracks, settings.min_iou, &mut extent)
        }
    };
    let comparisons: Vec<Comparison> = subjects.iter().map(&mut comparison).collect();
    extent.finish()?;
    refuse_shapes(metrics, &comparisons)?;
    let strangers: Vec<Fault> = subjects
        .iter()
        .zip(&comparisons)
        .enumerate()
        .filter_map(|(index, pair)| strangers(index, pair))
        .collect();
    if strangers.is_empty() {
        Ok(comparisons)
    } else {
        Err(RunError::Faults(strangers))
    }
}

/// What the request says of times that are one step.
pub fn time_tolerance_s(spec: &Value) -> Option<f64> {
    spec.pointer("/comparison/alignment/time_tolerance_s")
        .and_then(Value::as_f64)
}

/// A warning where no track ever comes within the gate of a target: what is far apart is rather of two units or clocks than missed.
fn never_near(subject: &Subject, comparison: &Comparison) -> Option<String> {
    let Content::Points { input, truth } = &subject.content else {
        return None;
    };
    if comparison.shape != Shape::Points
        || comparison
            .pairs
            .iter()
            .any(|pair| pair.distance <= comparison.gate)
    {
        return None;
    }
    let least_m = nearness::least_distance(comparison);
    let place = if subject.name.is_empty() {
        String::new()
    } else {
        format!("{}: ", subject.name)
    };
    let shifted = nearness::clock_shift_s(truth, input.tracks, comparison.gate).map(|shift_s| {
        let (size_s, direction) = (shift_s.abs(), if shift_s < 0.0 { "earlier" } else { "later" });
        format!("; with the times of the tracks {size_s:.3} s {direction} they would meet: do both have one clock?")
    });
    let question = "; are both in one unit and in the same coordinates?".to_owned();
    least_m.is_finite().then(|| {
        format!(
            "{place}no track ever comes within the gate of a target: the least distance is {least_m:.1} m, the gate {} m{}",
            comparison.gate,
            shifted.unwrap_or(question)
        )
    })
}

/// Truth and tracks whose times do not meet: any number made of them would mislead.
fn strangers(index: usize, (subject, comparison): (&Subject, &Comparison)) -> Option<Fault> {
    let is_shared = || {
        comparison
            .steps
            .iter()
            .any(|step| !step.truths.is_empty() && !step.tracks.is_empty())
    };
    let (tracks_span, truth_span, meet) = match &subject.content {
        Content::Points { input, truth } => {
            let tracks_s = span(
                input
                    .tracks
                    .tracks
                    .iter()
                    .flat_map(|track| &track.points)
                    .map(|point| point.time_s),
            )?;
            let truth_s = span(
                truth
                    .targets()
                    .iter()
                    .flat_map(|target| &target.points)
                    .map(|point| point.time_s),
            )?;
            // Scans may well see the one after the other; without them the clocks alone tell.
            let meet = match input.recording {
                Some(_) => !comparison.truths.is_empty() && !comparison.tracks.is_empty(),
                None => is_shared(),
            };
            (tracks_s, truth_s, meet)
        }
        Content::Boxes { truth, tracks } => {
            let frames = |set: &BoxSet| span(set.boxes().iter().map(|one| f64::from(one.frame)));
            (frames(tracks)?, frames(truth)?, is_shared())
        }
    };
    if meet {
        return None;
    }
    let pointer = if subject.name.is_empty() {
        "/truth".to_owned()
    } else {
        format!("/sequences/{index}/truth")
    };
    let (what, unit, allowed) = match subject.content {
        Content::Points { .. } => (
            "times",
            " s",
            "truth at the times of the tracks, on the same clock",
        ),
        Content::Boxes { .. } => (
            "frames",
            "",
            "truth in the frames of the tracks, counted alike",
        ),
    };
    let spans = format!(
        "({} to {}{unit}) and of tracks ({} to {}{unit})",
        truth_span.0, truth_span.1, tracks_span.0, tracks_span.1
    );
    Some(
        Fault::new(
            pointer,
            "disjoint",
            format!("the {what} of truth {spans} do not meet"),
        )
        .allowing(allowed),
    )
}

fn span(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    values.fold(None, |span, value| match span {
        None => Some((value, value)),
        Some((first, last)) => Some((f64::min(first, value), f64::max(last, value))),
    })
}

/// Numbers of boxes, of places and of directions have no common unit, so they make no number together.
fn refuse_mixtures(subjects: &[Subject]) -> Result<(), RunError> {
    let shape = |subject: &Subject| match &subject.content {
        Content::Points { truth, .. } if truth.is_of_bearings() => "directions",
        Content::Points { .. } => "points",
        Content::Boxes { .. } => "boxes",
    };
    let Some(first) = subjects.first().map(shape) else {
        return Ok(());
    };
    let fault = |(index, other): (usize, &str)| {
        let detail = format!(
            "this sequence is of {other}, the first of {first}: they make no number together"
        );
        Fault::new(format!("/sequences/{index}"), "conflict", detail)
            .allowing(format!("sequences of {first}"))
    };
    let faults: Vec<Fault> = subjects
        .iter()
        .map(shape)
        .enumerate()
        .filter(|(_, other)| *other != first)
        .map(fault)
        .collect();
    if faults.is_empty() {
        Ok(())
    } else {
        Err(faults.into())
    }
}

/// A metric of metres says nothing of boxes or directions.
fn refuse_shapes(metrics: &[Named], comparisons: &[Comparison]) -> Result<(), RunError> {
    let unfit_shape = |named: &Named| {
        comparisons
            .iter()
            .map(|comparison| comparison.shape)
            .find(|shape| !named.metric.accepts(*shape))
    };
    let refusal = |named: &Named| {
        let (found, allowed) = match unfit_shape(named)? {
            Shape::Points => ("points", "hota, clear, identity"),
            Shape::Bearings => ("directions", FOR_BEARINGS),
            Shape::Boxes => ("boxes", "hota, clear, identity (profile vision)"),
        };
        let detail = format!(
            "'{}' is defined for positions in metres, not for {found}",
            named.name
        );
        Some(Fault::new("/metrics", "unsupported", detail).allowing(allowed))
    };
    let unfit: Vec<Fault> = metrics.iter().filter_map(refusal).collect();
    if unfit.is_empty() {
        Ok(())
    } else {
        Err(RunError::Faults(unfit))
    }
}

fn written(reports: &[(&str, MetricReport)]) -> Value {
    reports
        .iter()
        .map(|(name, report)| ((*name).to_owned(), report_value(report)))
        .collect::<Map<_, _>>()
        .into()
}

/// Adds how the numbers of each metric are made; what a sequence says is made of its own rows in the same way.
fn with_origins(mut metrics: Value, together: &Reports, of_each: &[&Reports]) -> Value {
    for (place, (name, report)) in together.iter().enumerate() {
        let alone: Vec<&MetricReport> = of_each.iter().map(|reports| &reports[place].1).collect();
        metrics[*name]["from"] = metric_files::origins(name, report, &alone);
    }
    metrics
}

/// A metric in the report. Series over time and the lines of truths and tracks are in files.
fn report_value(report: &MetricReport) -> Value {
    let mut value = json!({
        "value": report.value, "unit": report.unit, "higher_is_better": report.higher_is_better, "parameters": report.parameters,
        "quantities": report.quantities.iter().map(|quantity| (quantity.name.to_owned(), quantity_value(quantity))).collect::<Map<_, _>>(),
        "curves": report.series.iter().filter(|series| series.axis != TIME).collect::<Vec<_>>()
    });
    if let Some(reason) = report.reason {
        value["reason"] = json!(reason);
    }
    if !report.findings.is_null() {
        value["findings"] = report.findings.clone();
    }
    value
}

fn quantity_value(quantity: &Quantity) -> Value {
    let mut value = json!({"value": quantity.value, "unit": quantity.unit});
    if let Some(reason) = quantity.reason {
        value["reason"] = json!(reason);
    }
    value
}

fn event_counts(subjects: &[Subject], sequences: &[Sequence]) -> Value {
    let count = |kind| {
        sequences
            .iter()
            .map(|sequence| sequence.events.count(kind))
            .sum::<usize>()
    };
    let counts: Map<String, Value> = EventKind::ALL
        .into_iter()
        .map(|(kind, name)| (name.to_owned(), json!(count(kind))))
        .collect();
    let total = |of: fn(&Comparison) -> usize| {
        sequences
            .iter()
            .map(|sequence| of(sequence.comparison))
            .sum::<usize>()
    };
    let is_named = sequences.len() > 1;
    let explained = subjects
        .iter()
        .zip(sequences)
        .flat_map(|(subject, sequence)| breaks_of(subject, sequence, is_named));
    let breaks: Vec<Break> = explained.take(MAX_BREAKS).collect();
    json!({
        "counts": counts,
        "breaks": breaks,
        "steps": total(|comparison| comparison.steps.len()),
        "truth_points": total(|comparison| comparison.truths.len()),
        "track_points": total(|comparison| comparison.tracks.len())
    })
}

fn breaks_of<'a>(
    subject: &'a Subject,
    sequence: &'a Sequence,
    is_named: bool,
) -> impl Iterator<Item = Break> + use<'a> {
    let name = is_named.then(|| subject.name.to_owned());
    let breaks = breaks::explain(
        sequence.comparison,
        sequence.events,
        sequence.input.as_ref(),
    );
    breaks.map(move |found| Break {
        sequence: name.clone(),
        ..found
    })
}

/// Breaks that the report explains; all of them are in the file of events.
const MAX_BREAKS: usize = 1000;

fn text_file(name: &'static str, text: String) -> Artifact {
    Artifact::file(
        name,
        "text/plain; charset=utf-8",
        (text + "\n").into_bytes(),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::state::{Position, State};
    use crate::model::track::{Estimate, PlaneEstimate, Track, TrackPoint, TrackSet};
    use crate::model::truth::{Target, TruthPoint};

    /// Truth at 0 to 9 s and a track of ten seconds from `start_s` on.
    fn fault(start_s: f64) -> Option<Fault> {
        let times_s = || (0..10).map(f64::from);
        let points = times_s()
            .map(|time_s| TruthPoint::in_plane(time_s, Position::zeros(), None))
            .collect();
        let truth = TruthSet::new(vec![Target {
            truth_id: "A".to_owned(),
            points,
        }])
        .unwrap();
        let estimate = Estimate::Plane(PlaneEstimate {
            state: State::zeros(),
            has_velocity: false,
            covariance: None,
        });
        let point = |time_s| TrackPoint {
            time_s,
            sensor: None,
            estimate,
            status: None,
            nis: None,
            first_candidate: 0,
            candidates: 0,
        };
        let track = Track {
            track_id: "T".to_owned(),
            points: times_s().map(|time_s| point(start_s + time_s)).collect(),
        };
        let tracks = TrackSet {
            tracks: vec![track],
            ..Default::default()
        };
        let input = EvaluationInput {
            recording: None,
            truth: Some(&truth),
            tracks: &tracks,
        };
        let alignment = Alignment::Interpolate { max_gap_s: 5.0 };
        let settings = PointSettings {
            alignment,
            gate_m: 10.0,
            reach_m: 10.0,
            time_tolerance_s: None,
        };
        let comparison = Comparison::of_points(&input, &truth, &settings);
        strangers(
            0,
            (
                &Subject {
                    name: "",
                    content: Content::Points {
                        input,
                        truth: &truth,
                    },
                },
                &comparison,
            ),
        )
    }

    #[test]
    fn clocks_that_do_not_meet_are_refused_with_both_spans() {
        let found = fault(100.0).unwrap();
        assert_eq!(
            (found.pointer.as_str(), found.code.as_str()),
            ("/truth", "disjoint")
        );
        assert_eq!(
            found.detail,
            "the times of truth (0 to 9 s) and of tracks (100 to 109 s) do not meet"
        );
        assert_eq!(
            [fault(0.0), fault(6.5), fault(9.0)].map(|fault| fault.is_none()),
            [true; 3]
        );
    }
}
