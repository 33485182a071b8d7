//! Metrics of a job: truth and tracks of each sequence put side by side, the log of events, every metric over all
//! sequences together and over each alone, and the files that say more than the report.

use super::causes;
use super::compare::{Subject, compare, never_near, refuse_mixtures};
use super::head::compared;
use super::metric_files::{self, MAX_PAIRS, Reports};
use super::progress::MetricProgress;
use super::report::{event_counts, metrics_value};
use super::spec::ComparisonSpec;
use crate::evaluation::causes::Episode;
use crate::evaluation::comparison::Comparison;
use crate::evaluation::events::EventLog;
use crate::evaluation::metrics::{BuildMetric, Metric, Sequence};
use crate::evaluation::scope::LeftOut;
use crate::experiment::files::text;
use crate::experiment::job::{Artifact, RunError};
use crate::experiment::observer::Observer;
use crate::experiment::request::methods::Choice;
use serde_json::{Map, Value, json};

/// What the metrics say.
pub struct Judgement {
    /// The parts of the report: `metrics`, `events`, `comparison`, and with several sequences `sequences`.
    pub parts: Map<String, Value>,
    pub artifacts: Vec<Artifact>,
    pub warnings: Vec<String>,
}

/// A metric under the name that it has in the report.
pub struct NamedMetric {
    pub name: String,
    kind: &'static str,
    pub metric: Box<dyn Metric>,
}

/// Judges the subjects by the metrics; makes files where they are wanted.
///
/// # Errors
/// [`RunError::Stopped`]; what cannot be compared or judged.
pub fn compute_metrics(
    metrics: &[Choice<BuildMetric>],
    (spec, left_out): (&ComparisonSpec, LeftOut),
    subjects: &[Subject],
    wants_files: bool,
    observer: &mut dyn Observer,
) -> Result<Judgement, RunError> {
    let metrics = build_metrics(metrics);
    refuse_mixtures(subjects)?;
    let are_several = subjects.len() > 1;
    let rounds = if are_several { subjects.len() + 1 } else { 1 };
    let mut progress = MetricProgress::new(observer, (metrics.len() * rounds) as u64);
    let comparisons = progress.watching(|watch| compare(spec, subjects, &metrics, watch))??;
    let logs: Vec<EventLog> = progress.watching(|watch| {
        let log = |comparison| EventLog::new_until(comparison, watch);
        comparisons.iter().map(log).collect()
    })?;
    let pairs = comparisons.iter().zip(&logs);
    let sequences: Vec<Sequence> = subjects
        .iter()
        .zip(pairs)
        .map(|(subject, (comparison, events))| Sequence {
            comparison,
            events,
            input: subject.content.input(),
        })
        .collect();
    let episodes = progress.watching(|watch| causes::explain(&sequences, spec, watch))?;
    let together = evaluate(&metrics, &sequences, &mut progress)?;
    let mut alone = Vec::new();
    if are_several {
        for sequence in sequences.chunks(1) {
            alone.push(evaluate(&metrics, sequence, &mut progress)?);
        }
    }
    let of_each: Vec<&Reports> = if are_several {
        alone.iter().collect()
    } else {
        vec![&together]
    };
    let judged = Judged {
        subjects,
        sequences: &sequences,
        episodes: &episodes,
        of_each: &of_each,
    };
    let mut parts = judged.report(&together, &alone);
    let head = compared(spec, left_out, subjects, &comparisons);
    parts.extend(head.map(|head| ("comparison".to_owned(), json!(head))));
    let (artifacts, pairs) = if wants_files {
        judged.files(&parts)
    } else {
        Default::default()
    };
    let mut warnings = warnings(subjects, &comparisons, &together);
    if pairs > MAX_PAIRS {
        warnings.push(format!(
            "pairs.csv is left out: {pairs} pairs are more than {MAX_PAIRS}"
        ));
    }
    Ok(Judgement {
        parts,
        artifacts,
        warnings,
    })
}

/// The second metric of one kind is called `gospa_2`, and so on.
fn build_metrics(choices: &[Choice<BuildMetric>]) -> Vec<NamedMetric> {
    let mut metrics: Vec<NamedMetric> = Vec::new();
    for choice in choices {
        let kind = choice.name();
        let others = metrics.iter().filter(|other| other.kind == kind).count();
        let name = match others {
            0 => kind.to_owned(),
            others => format!("{kind}_{}", others + 1),
        };
        metrics.push(NamedMetric {
            name,
            kind,
            metric: choice.build(),
        });
    }
    metrics
}

fn evaluate<'m>(
    metrics: &'m [NamedMetric],
    sequences: &[Sequence],
    progress: &mut MetricProgress,
) -> Result<Reports<'m>, RunError> {
    let mut reports = Vec::with_capacity(metrics.len());
    for NamedMetric { name, metric, .. } in metrics {
        let report = progress.watching(|watch| metric.evaluate_until(sequences, watch))?;
        reports.push((name.as_str(), report));
        progress.one_more()?;
    }
    Ok(reports)
}

/// What was judged, and what each sequence says.
struct Judged<'j> {
    subjects: &'j [Subject<'j>],
    sequences: &'j [Sequence<'j>],
    episodes: &'j [Vec<Episode>],
    of_each: &'j [&'j Reports<'j>],
}

impl Judged<'_> {
    fn report(&self, together: &Reports, alone: &[Reports]) -> Map<String, Value> {
        let mut parts = Map::new();
        let metrics = metrics_value(together, Some(self.of_each));
        let events = event_counts(self.subjects, self.sequences, self.episodes);
        parts.insert("metrics".to_owned(), metrics);
        parts.insert("events".to_owned(), events);
        if !alone.is_empty() {
            let lines = self.subjects.iter().zip(alone).map(|(subject, reports)| {
                json!({"name": subject.name, "metrics": metrics_value(reports, None)})
            });
            parts.insert("sequences".to_owned(), lines.collect());
        }
        parts
    }

    /// The files, and how many pairs there are.
    fn files(&self, parts: &Map<String, Value>) -> (Vec<Artifact>, usize) {
        let names: Vec<&str> = self.subjects.iter().map(|subject| subject.name).collect();
        let (mut files, pairs) = metric_files::files(&names, self.sequences, self.of_each);
        files.push(causes::file(&names, self.sequences, self.episodes));
        let result = Value::Object(parts.clone());
        if let Some(table) = text::metrics(&result) {
            let head = text::judged(&result).map_or_else(String::new, |head| head + "\n\n");
            let bytes = format!("{head}{table}\n").into_bytes();
            files.push(Artifact::file(
                "metrics.txt",
                "text/plain; charset=utf-8",
                bytes,
            ));
        }
        (files, pairs)
    }
}

fn warnings(subjects: &[Subject], comparisons: &[Comparison], together: &Reports) -> Vec<String> {
    let mut warnings = Vec::new();
    for (subject, comparison) in subjects.iter().zip(comparisons) {
        let prefix = subject.prefix();
        let said = comparison.warnings.iter();
        warnings.extend(said.map(|warning| format!("{prefix}{warning}")));
    }
    for (subject, comparison) in subjects.iter().zip(comparisons) {
        warnings.extend(never_near(subject, comparison));
    }
    for (_, report) in together {
        warnings.extend(report.warnings.iter().cloned());
    }
    warnings
}
