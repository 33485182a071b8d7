//! `trackloom run`: one job, no server.

use super::build_server::{VerdictFiles, failures, verdicts_of};
use super::files::JobFile;
use super::output;
use super::{BAD_INPUT, out, table};
use crate::experiment::job_shape::with_kind;
use crate::experiment::observer::{Observer, Step};
use crate::experiment::{self, JobKind, Known, LimitsReport, Outcome, Plan, RunError, presets};
use crate::model::fault::Fault;
use crate::registry;
use crate::service::child::meter::Meter;
use crate::service::child::report;
use crate::service::types::Progress;
use crate::service::types::ReportInput;
use anyhow::Context;
use clap::{Args, ValueEnum};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde::Deserialize;
use serde_json::{Value, json};
use std::io::{IsTerminal, Read};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::time::{Duration, Instant};
use tokio::sync::watch;
use uuid::Uuid;

#[derive(Args)]
pub(super) struct RunArguments {
    /// A job file: the body of a request with its `kind`, - for standard input; `trackloom presets NAME` prints one. Or --preset
    #[arg(value_name = "JOB", conflicts_with = "preset")]
    job: Option<PathBuf>,
    /// Run this preset; `papers` runs every campaign that computes the claims of a paper, one after the other
    #[arg(long)]
    preset: Option<String>,
    /// Seed instead of the job's own
    #[arg(long)]
    seed: Option<u32>,
    /// Runs of each cell of a campaign instead of the job's own
    #[arg(long)]
    runs: Option<u32>,
    /// Write report.json and the artefacts into this directory; of `papers`, each campaign's into one of its own
    #[arg(long)]
    out: Option<PathBuf>,
    /// What to print
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
    #[command(flatten)]
    files: VerdictFiles,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum Format {
    /// All of it as JSON
    Json,
    /// A summary
    Text,
}

/// Why there is no report, or no file.
pub(super) enum Trouble {
    Faults(Vec<Fault>),
    Failed(anyhow::Error),
}

impl From<Vec<Fault>> for Trouble {
    fn from(faults: Vec<Fault>) -> Self {
        Trouble::Faults(faults)
    }
}

impl From<anyhow::Error> for Trouble {
    fn from(error: anyhow::Error) -> Self {
        Trouble::Failed(error)
    }
}

pub(super) fn run(arguments: &RunArguments) -> ExitCode {
    end(finish(arguments), "the job is not valid")
}

/// Says what is wrong; `invalid` is the head of faults.
pub(super) fn end(done: Result<(), Trouble>, invalid: &str) -> ExitCode {
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(Trouble::Faults(faults)) => {
            eprintln!("trackloom: {invalid}");
            for fault in &faults {
                eprintln!("  {}", fault_line(fault));
            }
            ExitCode::from(BAD_INPUT)
        }
        Err(Trouble::Failed(error)) => {
            eprintln!("trackloom: {error:#}");
            ExitCode::FAILURE
        }
    }
}

/// `/tracker/max_missed: 0 is outside the allowed range (allowed: [1, 1000])`
fn fault_line(fault: &Fault) -> String {
    let mut line = if fault.pointer.is_empty() {
        "job".to_owned()
    } else {
        fault.pointer.clone()
    };
    if let Some(number) = fault.line {
        line.push_str(&format!(" line {number}"));
    }
    if let Some(column) = &fault.column {
        line.push_str(&format!(" column {column}"));
    }
    line.push_str(&format!(": {}", fault.detail));
    if let Some(allowed) = &fault.allowed {
        line.push_str(&format!(" (allowed: {allowed})"));
    }
    line
}

fn finish(arguments: &RunArguments) -> Result<(), Trouble> {
    match (
        &arguments.job,
        arguments.preset.as_deref().unwrap_or_default(),
    ) {
        (Some(path), _) => {
            let is_stdin = path == Path::new("-");
            let folder = if is_stdin {
                Path::new(".")
            } else {
                path.parent().unwrap_or(Path::new("."))
            };
            let job = JobFile::new(read_json(path, is_stdin)?, folder)?;
            finish_job(job, arguments, arguments.out.as_deref())
        }
        (None, "") => Err(vec![Fault::new(
            "JOB",
            "missing",
            "say which job: a job file, - for standard input, or --preset NAME",
        )]
        .into()),
        (None, "papers") => presets::PAPERS.iter().try_for_each(|name| {
            let out = arguments.out.as_ref().map(|folder| folder.join(name));
            finish_job(preset_job(name)?, arguments, out.as_deref())
        }),
        (None, name) => finish_job(preset_job(name)?, arguments, arguments.out.as_deref()),
    }
}

fn finish_job(
    mut job: JobFile,
    arguments: &RunArguments,
    out: Option<&Path>,
) -> Result<(), Trouble> {
    if let Some(seed) = arguments.seed {
        job.body["seed"] = json!(seed);
    }
    if let Some(runs) = arguments.runs {
        if job.kind != JobKind::Campaign {
            let detail = format!(
                "a job of the kind '{}' is one run; --runs is of campaigns",
                job.kind.name()
            );
            return Err(vec![Fault::new("--runs", "unsupported", detail)].into());
        }
        job.body["runs"] = json!(runs);
    }
    let mut plan = match (experiment::plan(job.kind, &job.body), job.missing_files()) {
        (Ok(plan), missing) if missing.is_empty() => plan,
        (planned, missing) => {
            return Err(planned
                .err()
                .into_iter()
                .flatten()
                .chain(missing)
                .collect::<Vec<_>>()
                .into());
        }
    };
    plan.wants_files = out.is_some();
    let (report, outcome) = compute(&job, plan)?;
    if let Some(folder) = out {
        out::write(folder, &report, &outcome.artifacts, job.paths())?;
        let names: Vec<&str> = outcome
            .artifacts
            .iter()
            .map(|artifact| artifact.name)
            .chain([out::LIST, out::REPORT])
            .collect();
        eprintln!("wrote {} into {}", names.join(", "), folder.display());
    }
    print(&report, arguments.format)?;
    hold_limits(&outcome.result, job.kind, &arguments.files)
}

/// Writes what a build server reads, and fails where a limit is not met.
fn hold_limits(result: &Value, kind: JobKind, files: &VerdictFiles) -> Result<(), Trouble> {
    let report: Option<LimitsReport> = match result.get("limits") {
        Some(limits) => Some(
            LimitsReport::deserialize(limits).context("the limits of the result are damaged")?,
        ),
        None => None,
    };
    let verdicts = report.as_ref().map(verdicts_of).unwrap_or_default();
    files.write(&format!("trackloom {}", kind.name()), &verdicts)?;
    match failures(&verdicts) {
        Some(failed) => Err(anyhow::anyhow!("limits: {failed}").into()),
        None => Ok(()),
    }
}

fn preset_job(name: &str) -> Result<JobFile, Trouble> {
    let unknown = || {
        let known: Vec<String> = presets::all()
            .into_iter()
            .map(|preset| preset.name)
            .chain(presets::ALIASES.map(|(alias, _)| alias.to_owned()))
            .chain(["papers".to_owned()])
            .collect();
        vec![
            Fault::new(
                "--preset",
                "unknown_value",
                format!("there is no preset '{name}'"),
            )
            .allowing(known.join(", ")),
        ]
    };
    let preset = presets::find(name).ok_or_else(unknown)?;
    Ok(JobFile::new(
        with_kind(preset.kind, &preset.body),
        Path::new("."),
    )?)
}

fn read_json(path: &Path, is_stdin: bool) -> Result<Value, Vec<Fault>> {
    let name = if is_stdin {
        "standard input".to_owned()
    } else {
        path.display().to_string()
    };
    let fault = |code: &str, detail: String| vec![Fault::new(name.clone(), code, detail)];
    let bytes = if is_stdin {
        read_stdin()
    } else {
        std::fs::read(path)
    }
    .map_err(|error| fault("not_found", error.to_string()))?;
    let (value, duplicates) =
        registry::parse(&bytes).map_err(|error| fault("malformed", error.to_string()))?;
    if duplicates.is_empty() {
        Ok(value)
    } else {
        Err(duplicates)
    }
}

fn read_stdin() -> std::io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    std::io::stdin().lock().read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// Loads, runs with a progress bar, and builds the report.
fn compute(job: &JobFile, mut plan: Plan) -> Result<(Vec<u8>, Outcome), Trouble> {
    let (news, told) = watch::channel(None);
    // Nobody stops it.
    let mut meter = Meter::new(job.kind, Arc::default(), move |progress| {
        news.send_replace(Some(progress));
    });
    let bar = Bar::start(told);
    let _ = meter.progress(Step::Load, 0, 1);
    let mut warnings = Vec::new();
    let inputs = job.load(&plan, &mut warnings)?;
    let known: Vec<Option<Known>> = inputs
        .iter()
        .map(|input| {
            input
                .as_ref()
                .and_then(|input| Known::from_dataset(&input.dataset, &input.sensors))
        })
        .collect();
    let faults = experiment::check_known(&mut plan, &known);
    if !faults.is_empty() {
        return Err(faults.into());
    }
    let _ = meter.progress(Step::Load, 1, 1);
    let read: Vec<ReportInput> = plan
        .inputs
        .iter()
        .zip(&inputs)
        .filter_map(|(request, input)| input.as_ref().map(|input| ReportInput::new(request, input)))
        .collect();
    let outcome = experiment::run(&plan, inputs, &mut meter);
    let timing = meter.timing();
    drop(meter);
    bar.end();
    let mut outcome = match outcome {
        Ok(outcome) => outcome,
        Err(RunError::Faults(faults)) => return Err(faults.into()),
        Err(RunError::Stopped) => return Err(anyhow::anyhow!("the job was stopped").into()),
    };
    warnings.append(&mut outcome.warnings);
    outcome.warnings = warnings;
    job.restore(&mut plan.spec);
    let report = report::build(Uuid::now_v7(), &plan, &read, &outcome, timing)
        .context("the report cannot be written")?;
    Ok((report, outcome))
}

/// Without a terminal, progress is a line now and then.
const LINE_EVERY: Duration = Duration::from_secs(10);

/// Progress on stderr: a bar where that is a terminal, else lines.
struct Bar {
    thread: std::thread::JoinHandle<()>,
}

impl Bar {
    /// Shows what is told until the sender is gone.
    fn start(told: watch::Receiver<Option<Progress>>) -> Self {
        let bar = ProgressBar::with_draw_target(Some(1000), ProgressDrawTarget::stderr());
        let style = ProgressStyle::with_template("{msg:10} {bar:40} {percent:>3} %  {eta} left")
            .unwrap_or_else(|_| ProgressStyle::default_bar());
        bar.set_style(style);
        let thread = std::thread::spawn(move || {
            let is_terminal = std::io::stderr().is_terminal();
            let mut line_due = Instant::now() + LINE_EVERY;
            while told.has_changed().is_ok() {
                if let Some(progress) = told.borrow().as_ref() {
                    if !is_terminal && Instant::now() >= line_due {
                        line_due += LINE_EVERY;
                        eprintln!("{}", progress_line(progress));
                    }
                    bar.set_message(format!("{:?}", progress.step).to_lowercase());
                    bar.set_position((progress.fraction * 1000.0) as u64);
                }
                std::thread::sleep(Duration::from_millis(50));
            }
            bar.finish_and_clear();
        });
        Bar { thread }
    }

    fn end(self) {
        // A bar that failed to draw is no reason to lose the job.
        let _ = self.thread.join();
    }
}

/// `associate  45 %  12 s left`
fn progress_line(progress: &Progress) -> String {
    let step = format!("{:?}", progress.step).to_lowercase();
    let left = progress
        .eta_s
        .map_or_else(String::new, |eta_s| format!("  {eta_s:.0} s left"));
    format!("{step}  {:.0} %{left}", 100.0 * progress.fraction)
}

fn print(report: &[u8], format: Format) -> anyhow::Result<()> {
    let text = match format {
        Format::Json => String::from_utf8(report.to_vec())?,
        Format::Text => table::summary(&serde_json::from_slice(report)?),
    };
    Ok(output::print(&text)?)
}
