//! `trackloom compare`: two results side by side, and whether the second is worse.

use super::build_server::{Verdict, VerdictFiles, failures, number};
use super::out;
use super::output;
use super::run::{Format, Trouble, end};
use crate::model::fault::Fault;
use crate::service::types::{
    ComparedJob, Comparison, DifferenceVerdict, JobKind, PairedDifference, PairedNumber, PairedOver,
};
use crate::service::views::compare::{self, Side};
use crate::service::views::metrics::MetricTable;
use anyhow::Context;
use clap::Args;
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use uuid::Uuid;

#[derive(Args)]
pub(super) struct CompareArguments {
    /// The baseline: a directory that `trackloom run --out` wrote, or its report.json
    baseline: PathBuf,
    /// What is compared with it
    other: PathBuf,
    /// End with 1 where any number is significantly worse than in the baseline
    #[arg(long)]
    fail_if_worse: bool,
    /// Confidence of the intervals
    #[arg(long, default_value_t = 0.95, value_parser = confidence)]
    confidence: f64,
    /// What to print
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
    #[command(flatten)]
    files: VerdictFiles,
}

fn confidence(text: &str) -> Result<f64, String> {
    let value: f64 = text
        .parse()
        .map_err(|_| "a number above 0 and below 1".to_owned())?;
    if value > 0.0 && value < 1.0 {
        Ok(value)
    } else {
        Err("a number above 0 and below 1".to_owned())
    }
}

pub(super) fn run(arguments: &CompareArguments) -> ExitCode {
    end(finish(arguments), "the results cannot be compared")
}

fn finish(arguments: &CompareArguments) -> Result<(), Trouble> {
    let sides = [
        read_side(&arguments.baseline)?,
        read_side(&arguments.other)?,
    ];
    let comparison = compare::of(&sides, 0, arguments.confidence);
    match arguments.format {
        Format::Json => {
            let text = serde_json::to_string_pretty(&comparison).context("cannot write JSON")?;
            output::print(text).context("cannot write the comparison")?;
        }
        Format::Text => {
            output::print(text_of(&comparison)).context("cannot write the comparison")?;
        }
    }
    let mut verdicts = verdicts(&comparison);
    for metric in compare::lost_metrics(&sides[0], &sides[1]) {
        verdicts.push(Verdict {
            name: metric,
            met: false,
            detail: "the baseline has this metric, the other result has not".to_owned(),
        });
    }
    for (name, met) in compare::kept_limits(&sides[0], &sides[1]) {
        let detail = if met {
            "met in both"
        } else {
            "met in the baseline alone"
        };
        let detail = detail.to_owned();
        verdicts.push(Verdict { name, met, detail });
    }
    if arguments.fail_if_worse && verdicts.is_empty() {
        let detail = "nothing can be told apart: no number with a better direction has pairs enough for an interval";
        let fault = Fault::new("--fail-if-worse", "unsupported", detail);
        let cure = "directories of `trackloom run --out` with the same targets, runs or steps";
        return Err(vec![fault.allowing(cure)].into());
    }
    let suite = format!(
        "{} against {}",
        arguments.other.display(),
        arguments.baseline.display()
    );
    arguments.files.write(&suite, &verdicts)?;
    match failures(&verdicts).filter(|_| arguments.fail_if_worse) {
        Some(failed) => Err(Trouble::Failed(anyhow::anyhow!(
            "worse than the baseline: {failed}"
        ))),
        None => Ok(()),
    }
}

/// What a run left in a directory; files that are absent say nothing.
fn read_side(path: &Path) -> Result<Side, Trouble> {
    let report = if path.is_dir() {
        path.join(out::REPORT)
    } else {
        path.to_owned()
    };
    let bytes = std::fs::read(&report).map_err(|error| {
        let detail = format!("{error}");
        vec![
            Fault::new(report.display().to_string(), "not_found", detail)
                .allowing("a directory of `trackloom run --out`, or a report.json"),
        ]
    })?;
    let name = report.display().to_string();
    let mut report: Value =
        serde_json::from_slice(&bytes).map_err(|error| damaged(&name, error.to_string()))?;
    let kind = report["kind"].as_str().and_then(JobKind::from_name);
    let kind = kind.ok_or_else(|| damaged(&name, "it is no report of a job".to_owned()))?;
    let folder = if path.is_dir() {
        Some(path)
    } else {
        path.parent()
    };
    let listed = folder.and_then(out::listed);
    let beside = |name: &str| {
        let is_ours = listed.as_ref().is_none_or(|names| names.contains(name));
        std::fs::read(folder.filter(|_| is_ours)?.join(name)).ok()
    };
    let metrics = match beside("metric-series.csv") {
        Some(bytes) => MetricTable::read(&bytes)
            .map_err(|error| damaged(&name, format!("metric-series.csv beside it: {error}")))?,
        None => MetricTable::default(),
    };
    Ok(Side {
        job: ComparedJob {
            id: report["job_id"]
                .as_str()
                .and_then(|id| Uuid::parse_str(id).ok())
                .unwrap_or_default(),
            kind,
            name: Some(path.display().to_string()),
            seed: report["seed"]
                .as_u64()
                .and_then(|seed| u32::try_from(seed).ok())
                .unwrap_or(0),
            total_s: report["timing"]["total_s"].as_f64().unwrap_or(0.0),
        },
        spec: report["spec"].take(),
        result: report["result"].take(),
        metrics,
        truths: beside("metric-truths.csv"),
        runs: beside("runs.csv"),
    })
}

fn damaged(name: &str, detail: String) -> Vec<Fault> {
    vec![Fault::new(name, "malformed", detail)]
}

fn over(number: &PairedNumber) -> &'static str {
    match number.over {
        PairedOver::Runs => "runs",
        PairedOver::Targets => "targets",
        PairedOver::Steps => "steps",
    }
}

/// The difference of the second side from the baseline.
fn difference(number: &PairedNumber) -> Option<&PairedDifference> {
    number.differences.get(1)?.as_ref()
}

fn name_of(number: &PairedNumber) -> String {
    let cell = number
        .cell
        .as_ref()
        .map_or_else(String::new, |cell| format!(" in {cell}"));
    format!("{}{cell}, over {}", number.name, over(number))
}

/// A verdict for each number that has a direction and an interval: met where it is not worse.
fn verdicts(comparison: &Comparison) -> Vec<Verdict> {
    let mut verdicts = Vec::new();
    for paired in &comparison.paired {
        let Some((found, verdict)) =
            difference(paired).and_then(|found| Some((found, found.verdict?)))
        else {
            continue;
        };
        verdicts.push(Verdict {
            name: name_of(paired),
            met: verdict != DifferenceVerdict::Worse,
            detail: told(found, verdict),
        });
    }
    verdicts
}

fn told(found: &PairedDifference, verdict: DifferenceVerdict) -> String {
    let word = match verdict {
        DifferenceVerdict::Better => "better",
        DifferenceVerdict::Worse => "worse",
        DifferenceVerdict::NotSignificant => "no significant difference",
    };
    let interval = found.interval.map_or_else(String::new, |interval| {
        format!(" [{}, {}]", number(interval.low), number(interval.high))
    });
    format!(
        "{word}: {}{interval} in {} pairs",
        number(found.mean),
        found.pairs
    )
}

fn text_of(comparison: &Comparison) -> String {
    let mut told: Vec<String> = Vec::new();
    for note in &comparison.notes {
        told.push(format!("note: {note}"));
    }
    told.push(format!(
        "{:<58} {:>14} {:>14}  better",
        "number", "baseline", "other"
    ));
    for compared in &comparison.numbers {
        let [Some(baseline), Some(other)] = compared.values[..] else {
            continue;
        };
        let Some(higher) = compared.higher_is_better.filter(|_| baseline != other) else {
            continue;
        };
        let side = if (other > baseline) == higher {
            "other"
        } else {
            "baseline"
        };
        let (baseline, other) = (number(baseline), number(other));
        told.push(format!(
            "{:<58} {baseline:>14} {other:>14}  {side}",
            compared.path
        ));
    }
    let verdicts = verdicts(comparison);
    let apart = verdicts
        .iter()
        .filter(|verdict| !verdict.detail.starts_with("no significant"));
    let lines: Vec<String> = apart
        .map(|verdict| format!("{}: {}", verdict.name, verdict.detail))
        .collect();
    told.push(format!(
        "\n{} of {} paired numbers differ significantly",
        lines.len(),
        verdicts.len()
    ));
    told.extend(lines.iter().map(|line| format!("  {line}")));
    told.join("\n")
}
