//! `trackloom report`: what a run left, as one page.

use super::out;
use super::run::{Trouble, end};
use crate::formats::{ReadOptions, format_named};
use crate::model::dataset::Dataset;
use crate::model::fault::Fault;
use crate::model::sensor::SensorSettings;
use crate::service::http::dashboard;
use crate::service::views::layers::JobLayers;
use crate::service::views::report_page::{Source, render};
use anyhow::{Context, anyhow};
use clap::Args;
use serde_json::Value;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

#[derive(Args)]
pub(super) struct ReportArguments {
    /// A directory that `trackloom run --out` wrote, or its report.json; files that are absent say nothing
    #[arg(value_name = "JOB|FILE")]
    job: PathBuf,
    /// Where to write; report.html in the directory when absent
    #[arg(long, short, value_name = "FILE")]
    output: Option<PathBuf>,
}

pub(super) fn run(arguments: &ReportArguments) -> ExitCode {
    end(finish(arguments), "the page cannot be made")
}

fn finish(arguments: &ReportArguments) -> Result<(), Trouble> {
    let template = dashboard::report_template()
        .ok_or_else(|| anyhow!("this program was built without its dashboard"))?;
    let (folder, file) = places(&arguments.job);
    let bytes = std::fs::read(&file).map_err(|error| {
        let fault = Fault::new(file.display().to_string(), "not_found", error.to_string());
        vec![fault.allowing("a directory of `trackloom run --out`, or a report.json")]
    })?;
    let damaged =
        |detail: String| vec![Fault::new(file.display().to_string(), "malformed", detail)];
    let report: Value =
        serde_json::from_slice(&bytes).map_err(|error| damaged(error.to_string()))?;
    if report["kind"].as_str().is_none() {
        return Err(damaged("it is no report of a job".to_owned()).into());
    }
    let listed = out::listed(&folder);
    let layers = read_layers(&folder, &report["spec"], listed.as_ref())?;
    let causes = std::fs::read(folder.join("causes.csv")).ok();
    let causes = causes.filter(|_| is_of_run(listed.as_ref(), "causes.csv"));
    let name = name_of(&report, &folder);
    let source = Source {
        name: &name,
        report,
        layers: &layers,
        causes: causes.as_deref(),
    };
    let page = render(&template, source);
    let output = arguments
        .output
        .clone()
        .unwrap_or_else(|| folder.join("report.html"));
    std::fs::write(&output, page).with_context(|| format!("cannot write {}", output.display()))?;
    eprintln!("wrote {}", output.display());
    Ok(())
}

/// The directory of a run, and its report.
fn places(job: &Path) -> (PathBuf, PathBuf) {
    if job.is_dir() {
        return (job.to_owned(), job.join("report.json"));
    }
    let folder = job.parent().unwrap_or(Path::new("")).to_owned();
    (folder, job.to_owned())
}

fn name_of(report: &Value, folder: &Path) -> String {
    let name = report["spec"]["name"].as_str().map(str::to_owned);
    name.unwrap_or_else(|| folder.display().to_string())
}

/// Whether a file belongs to the report; where nobody lists them, all do.
fn is_of_run(listed: Option<&BTreeSet<String>>, name: &str) -> bool {
    listed.is_none_or(|listed| listed.contains(name))
}

/// The files of a run that its pictures are made of.
fn read_layers(
    folder: &Path,
    spec: &Value,
    listed: Option<&BTreeSet<String>>,
) -> Result<JobLayers, Trouble> {
    let mut layers = JobLayers {
        sensors: sensors_of(spec),
        spec: spec.clone(),
        ..JobLayers::default()
    };
    let names = ["detections.csv", "truth.csv", "tracks.csv"];
    for name in names.into_iter().filter(|name| is_of_run(listed, name)) {
        match read_dataset(&folder.join(name))? {
            Some(Dataset::Detections(recording)) => layers.detections = Some(recording),
            Some(Dataset::Truth(truth)) => layers.truth = Some(truth),
            Some(Dataset::Tracks(tracks)) => layers.tracks = Some(tracks),
            _ => {}
        }
    }
    Ok(layers)
}

fn sensors_of(spec: &Value) -> Vec<SensorSettings> {
    let sensors = spec.get("sensors").cloned().unwrap_or_default();
    serde_json::from_value(sensors).unwrap_or_default()
}

fn read_dataset(path: &Path) -> Result<Option<Dataset>, Trouble> {
    let Ok(bytes) = std::fs::read(path) else {
        return Ok(None);
    };
    let Some(csv) = format_named("csv") else {
        return Ok(None);
    };
    let read = (csv.read)(&mut bytes.as_slice(), &ReadOptions::default());
    read.map(|outcome| Some(outcome.dataset)).map_err(|faults| {
        let named = |fault: Fault| Fault {
            pointer: path.display().to_string(),
            ..fault
        };
        Trouble::from(faults.into_iter().map(named).collect::<Vec<_>>())
    })
}
