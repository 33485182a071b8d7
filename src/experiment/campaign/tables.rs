//! The files of a campaign: every run, every cell, and a table for people.

use super::cells::Cell;
use super::outcomes::{CellReport, Rows};
use crate::experiment::files::tables::{optional, quoted};
use crate::experiment::job::Artifact;
use crate::math::stats::Interval;
use std::io::{Error, Write};

/// `runs.csv`: a line a cell and run, empty where a run has no such number.
pub(super) fn runs(
    cells: &[Cell],
    names: &[&str],
    rows: &[Rows],
    seed: u32,
) -> Result<Artifact, Error> {
    let mut bytes = format!(
        "cell,run,seed,{}\n",
        names
            .iter()
            .map(|name| quoted(name))
            .collect::<Vec<_>>()
            .join(",")
    )
    .into_bytes();
    for (cell, columns) in cells.iter().zip(rows) {
        let name = quoted(&cell.name);
        for run in 0..columns.first().map_or(0, Vec::len) {
            let numbers = columns
                .iter()
                .map(|column| optional(column[run]))
                .collect::<Vec<_>>()
                .join(",");
            writeln!(bytes, "{name},{run},{seed},{numbers}")?;
        }
    }
    Ok(Artifact::file("runs.csv", "text/csv", bytes))
}

/// `cells.csv`: a line a cell and outcome.
pub(super) fn cells(reports: &[CellReport], names: &[&str]) -> Result<Artifact, Error> {
    let mut bytes =
        b"cell,outcome,count,missing,mean,low,high,standard_deviation,min,median,max,difference,difference_low,difference_high\n".to_vec();
    for report in reports {
        for &name in names {
            let Some(summary) = report.outcomes.get(name) else {
                continue;
            };
            let difference = report.differences.get(name);
            let numbers = [
                summary.mean,
                summary.interval.map(|interval| interval.low),
                summary.interval.map(|interval| interval.high),
                summary.standard_deviation,
                summary.min,
                summary.median,
                summary.max,
                difference.and_then(|difference| difference.mean),
                difference
                    .and_then(|difference| difference.interval)
                    .map(|interval| interval.low),
                difference
                    .and_then(|difference| difference.interval)
                    .map(|interval| interval.high),
            ];
            let numbers = numbers.map(optional).join(",");
            writeln!(
                bytes,
                "{},{},{},{},{numbers}",
                quoted(&report.name),
                quoted(name),
                summary.count,
                summary.missing
            )?;
        }
    }
    Ok(Artifact::file("cells.csv", "text/csv", bytes))
}

/// `cells.md`: a row a cell, a column an outcome, each with its interval; below it the same of the differences to the cells that
/// others are compared with.
pub(super) fn markdown(reports: &[CellReport], names: &[&str]) -> Artifact {
    let mut text = head("cell", names);
    let mut differences = String::new();
    for report in reports {
        let found = names.iter().map(|name| {
            report
                .outcomes
                .get(*name)
                .map_or_else(String::new, |summary| {
                    with_interval(summary.mean, summary.interval)
                })
        });
        text.push_str(&line(&escape(&report.name), found));
        let Some(other) = &report.compared_with else {
            continue;
        };
        let found = names.iter().map(|name| {
            report
                .differences
                .get(*name)
                .map_or_else(String::new, |found| {
                    with_interval(found.mean, found.interval)
                })
        });
        let name = format!("{} − {}", escape(&report.name), escape(other));
        differences.push_str(&line(&name, found));
    }
    if !differences.is_empty() {
        let head = head("difference, run by run", names);
        text.push_str(&format!("\n{head}{differences}"));
    }
    Artifact::file("cells.md", "text/markdown", text.into_bytes())
}

fn escape(text: &str) -> String {
    text.replace('|', "\\|")
}

fn head(first: &str, names: &[&str]) -> String {
    let head = line(first, names.iter().map(|name| escape(name)));
    format!("{head}{}|\n", "|---".repeat(names.len() + 1))
}

fn line(first: &str, cells: impl Iterator<Item = String>) -> String {
    format!("| {first} | {} |\n", cells.collect::<Vec<_>>().join(" | "))
}

/// `0.987 (0.978 to 0.993)`.
fn with_interval(mean: Option<f64>, interval: Option<Interval>) -> String {
    let Some(mean) = mean else {
        return "–".to_owned();
    };
    match interval {
        Some(interval) => format!(
            "{} ({} to {})",
            round(mean),
            round(interval.low),
            round(interval.high)
        ),
        None => round(mean),
    }
}

/// With four decimals; what rounds to zero has no sign.
fn round(number: f64) -> String {
    let text = format!("{number:.4}");
    if text == "-0.0000" {
        "0.0000".to_owned()
    } else {
        text
    }
}
