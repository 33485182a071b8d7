//! What the metrics say, as parts of a report.

use super::causes;
use super::compare::Subject;
use super::metric_files::{self, Reports, TIME};
use crate::evaluation::causes::Episode;
use crate::evaluation::comparison::Comparison;
use crate::evaluation::events::EventKind;
use crate::evaluation::metrics::{MetricReport, Quantity, Sequence, Series};
use serde::Serialize;
use serde_json::{Map, Value, json};

/// The metrics of a report. `of_each` is what they say of each sequence: then the report tells how its numbers are made, and what
/// a sequence says is made of its own rows in the same way.
pub fn metrics_value(reports: &Reports, of_each: Option<&[&Reports]>) -> Value {
    let mut values = Map::new();
    for (place, (name, report)) in reports.iter().enumerate() {
        let alone = of_each.map(|of_each| -> Vec<&MetricReport> {
            of_each.iter().map(|reports| &reports[place].1).collect()
        });
        let from = alone.map(|alone| metric_files::origins(name, report, &alone));
        values.insert((*name).to_owned(), report_value(report, from));
    }
    Value::Object(values)
}

/// A metric in the report. Series over time and the lines of truths and tracks are in files.
fn report_value(report: &MetricReport, from: Option<Value>) -> Value {
    let mut value = Map::new();
    let mut put = |name: &str, part: Value| value.insert(name.to_owned(), part);
    put("value", json!(report.value));
    put("unit", json!(report.unit));
    put("higher_is_better", json!(report.higher_is_better));
    put("parameters", json!(report.parameters));
    put("quantities", quantities_value(&report.quantities));
    let is_curve = |series: &&Series| series.axis != TIME;
    put(
        "curves",
        json!(report.series.iter().filter(is_curve).collect::<Vec<_>>()),
    );
    if let Some(reason) = report.reason {
        put("reason", json!(reason));
    }
    if !report.findings.is_null() {
        put("findings", report.findings.clone());
    }
    if let Some(from) = from {
        put("from", from);
    }
    Value::Object(value)
}

fn quantities_value(quantities: &[Quantity]) -> Value {
    let mut values = Map::new();
    for quantity in quantities {
        let Quantity {
            name,
            value,
            unit,
            reason,
        } = *quantity;
        values.insert(
            name.to_owned(),
            json!(Number {
                value,
                unit,
                reason
            }),
        );
    }
    Value::Object(values)
}

/// A quantity under its name.
#[derive(Serialize)]
struct Number {
    value: Option<f64>,
    unit: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    reason: Option<&'static str>,
}

/// The part `events` of a report.
pub fn event_counts(
    subjects: &[Subject],
    sequences: &[Sequence],
    episodes: &[Vec<Episode>],
) -> Value {
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
    json!({
        "counts": counts,
        "causes": causes::counts(episodes),
        "breaks": causes::breaks(subjects, sequences, episodes),
        "steps": total(|comparison| comparison.steps.len()),
        "truth_points": total(|comparison| comparison.truths.len()),
        "track_points": total(|comparison| comparison.tracks.len())
    })
}
