//! The files of a campaign: every run, every cell, and a table for people.

use super::cells::Cell;
use super::outcomes::{CellReport, Rows, Summary};
use crate::experiment::run::Artifact;
use crate::experiment::tables::{optional, quoted};
use std::io::{Error, Write};

/// `runs.csv`: a line a cell and run, empty where a run has no such number.
pub(super) fn runs(cells: &[Cell], names: &[&str], rows: &[Rows], seed: u32) -> Result<Artifact, Error> {
    let mut bytes = format!("cell,run,seed,{}\n", names.iter().map(|name| quoted(name)).collect::<Vec<_>>().join(",")).into_bytes();
    for (cell, columns) in cells.iter().zip(rows) {
        let name = quoted(&cell.name);
        for run in 0..columns.first().map_or(0, Vec::len) {
            let numbers = columns.iter().map(|column| optional(column[run])).collect::<Vec<_>>().join(",");
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
            let Some(summary) = report.outcomes.get(name) else { continue };
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
                difference.and_then(|difference| difference.interval).map(|interval| interval.low),
                difference.and_then(|difference| difference.interval).map(|interval| interval.high),
            ];
            let numbers = numbers.map(optional).join(",");
            writeln!(bytes, "{},{},{},{},{numbers}", quoted(&report.name), quoted(name), summary.count, summary.missing)?;
        }
    }
    Ok(Artifact::file("cells.csv", "text/csv", bytes))
}

/// `cells.md`: a row a cell, a column an outcome, each with its interval.
pub(super) fn markdown(reports: &[CellReport], names: &[&str]) -> Artifact {
    let escaped = |text: &str| text.replace('|', "\\|");
    let mut text = format!("| cell | {} |\n", names.iter().map(|name| escaped(name)).collect::<Vec<_>>().join(" | "));
    text.push_str(&"|---".repeat(names.len() + 1));
    text.push_str("|\n");
    for report in reports {
        let cells = names.iter().map(|&name| report.outcomes.get(name).map_or_else(String::new, with_interval)).collect::<Vec<_>>();
        text.push_str(&format!("| {} | {} |\n", escaped(&report.name), cells.join(" | ")));
    }
    Artifact::file("cells.md", "text/markdown", text.into_bytes())
}

/// `0.987 (0.978 to 0.993)`.
fn with_interval(summary: &Summary) -> String {
    let Some(mean) = summary.mean else { return "–".to_owned() };
    match summary.interval {
        Some(interval) => format!("{mean:.4} ({:.4} to {:.4})", interval.low, interval.high),
        None => format!("{mean:.4}"),
    }
}
