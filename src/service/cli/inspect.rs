//! `trackloom inspect`: what a file holds, before any job.

use super::output;
use super::reading::{NOT_READ, ReadArguments, read_truth};
use super::run::{Trouble, end};
use crate::experiment::inspect::{Inspection, inspect, suspicions_beside_truth};
use crate::model::time::TimeBase;
use anyhow::Context;
use clap::Args;
use jiff::Timestamp;
use std::path::PathBuf;
use std::process::ExitCode;

#[derive(Args)]
pub(super) struct InspectArguments {
    #[command(flatten)]
    read: ReadArguments,
    /// The truth of what was seen, whose times and places must meet those of the file
    #[arg(long, value_name = "FILE")]
    truth: Option<PathBuf>,
    /// All of it as JSON
    #[arg(long)]
    json: bool,
}

pub(super) fn run(arguments: &InspectArguments) -> ExitCode {
    end(finish(arguments), NOT_READ)
}

fn finish(arguments: &InspectArguments) -> Result<(), Trouble> {
    let (read, format) = arguments.read.read()?;
    let path = arguments.read.file.to_string_lossy();
    let beside = match &arguments.truth {
        Some(truth) => suspicions_beside_truth(&read.dataset, &read_truth(truth)?),
        None => Vec::new(),
    };
    let mut found = inspect(read, format.name, &path);
    found.suspicions.extend(beside);
    if arguments.json {
        let text = serde_json::to_string_pretty(&found).context("the inspection is not JSON");
        return say(&text.map_err(Trouble::Failed)?);
    }
    say(&told(&found))
}

fn say(text: &str) -> Result<(), Trouble> {
    output::print(text).map_err(|error| Trouble::Failed(error.into()))
}

fn told(found: &Inspection) -> String {
    let mut lines = Vec::new();
    lines.push(format!("{} ({})", found.kind.name(), found.format));
    let units = &found.units;
    lines.push(format!(
        "  {} {}s: {} used, {} ignored, {} rejected",
        units.total,
        units.called,
        units.used,
        units.ignored_count(),
        units.rejected_count()
    ));
    for (kind, count) in &units.ignored {
        lines.push(format!("    ignored: {kind} {count}"));
    }
    for told in units.rejections() {
        lines.push(format!("    rejected: {told}"));
    }
    lines.push(format!(
        "  {} rows, {} scans, {} objects",
        found.rows, found.scans, found.objects
    ));
    if let Some(time) = &found.time {
        let (start, end) = (
            shown(time.start_s, found.time_base),
            shown(time.end_s, found.time_base),
        );
        lines.push(format!(
            "  {start} to {end} ({} s)",
            rounded(time.end_s - time.start_s)
        ));
    }
    if let Some(frame) = &found.frame {
        lines.push(format!(
            "  origin {} N {} E",
            frame.latitude_deg(),
            frame.longitude_deg()
        ));
    }
    if let Some(area) = &found.area {
        lines.push(format!(
            "  x {:.0} to {:.0} m, y {:.0} to {:.0} m",
            area.x_m[0], area.x_m[1], area.y_m[0], area.y_m[1]
        ));
    }
    for sensor in &found.sensors {
        let period = sensor.period_s.map_or(String::new(), |period_s| {
            format!(", every {} s", rounded(period_s))
        });
        lines.push(format!(
            "  sensor {}: {} detections in {} scans{period}",
            sensor.sensor_id, sensor.detections, sensor.scans
        ));
    }
    for warning in &found.warnings {
        lines.push(format!("  warning: {warning}"));
    }
    for suspicion in &found.suspicions {
        lines.push(format!("  suspicion: {suspicion}"));
    }
    lines.push(format!("  a job to start from:\n{:#}", found.job));
    lines.join("\n")
}

/// A time as UTC where it is one, else in seconds.
fn shown(time_s: f64, base: TimeBase) -> String {
    // To the millisecond that is nearest; it is written without what is below.
    let instant = Timestamp::from_nanosecond((time_s * 1e3).round() as i128 * 1_000_000);
    match instant {
        Ok(instant) if base.is_utc() => format!("{instant:.3}"),
        _ => format!("{} s", rounded(time_s)),
    }
}

/// To the microsecond, without zeros at the end.
fn rounded(time_s: f64) -> f64 {
    (time_s * 1e6).round() / 1e6
}
