//! What a child can do, but for campaigns.

use super::campaign::Kept;
use super::input::{InputFile, faults_or_memory, open};
use super::protocol::{Checked, Made, MadeFile, Order, Upload};
use crate::experiment::inspect::inspect;
use crate::experiment::observer::{Observer, Step};
use crate::experiment::{self, Artifact, Inputs, JobKind, Plan};
use crate::formats::{FORMATS, ReadOptions, WriteError, format_named, read_file, writer_named};
use crate::model::dataset::DatasetSummary;
use crate::model::fault::Fault;
use crate::service::child::Failure;
use crate::service::child::meter::Meter;
use crate::service::child::report;
use crate::service::storage::blobs::sha256_hex;
use crate::service::types::ReportInput;
use crate::service::views::preview;
use anyhow::Context;
use serde_json::Value;
use serde_json::value::to_raw_value;
use std::fs::File;
use std::io::{BufReader, BufWriter, Write};
use std::path::{Path, PathBuf};
use uuid::Uuid;

/// Does what is ordered.
pub(super) fn work(
    order: Order,
    kept: &mut Kept,
    meter: impl Fn(JobKind) -> Meter,
) -> Result<Made, Failure> {
    match order {
        Order::Check(upload) => check(&upload),
        Order::Preview { input, rows } => Ok(Made::Preview(
            to_raw_value(&preview::of(&input.read()?, rows)).map_err(internal)?,
        )),
        Order::Write {
            input,
            format,
            path,
        } => write_as(&input, &format, &path),
        Order::Job {
            id,
            kind,
            spec,
            inputs,
            directory,
        } => job(id, (kind, &spec), inputs, &directory, meter(kind)),
        Order::Runs { campaign, runs } => {
            kept.make_runs(campaign, runs, &mut meter(JobKind::Campaign))
        }
        Order::Look {
            campaign,
            pieces,
            outcomes,
            directory,
        } => kept.look(
            campaign,
            &pieces,
            outcomes.as_deref(),
            &directory,
            &mut meter(JobKind::Campaign),
        ),
        Order::SoFar {
            campaign,
            pieces,
            outcomes,
        } => kept.so_far(campaign, &pieces, &outcomes, &mut meter(JobKind::Campaign)),
    }
}

pub(super) fn internal(error: serde_json::Error) -> Failure {
    Failure::Internal(error.into())
}

/// Tells the format and reads the file with it.
fn check(upload: &Upload) -> Result<Made, Failure> {
    let file = open(&upload.path)?;
    let format = match &upload.format {
        Some(name) => Some(
            format_named(name)
                .ok_or_else(|| unknown_format(format!("there is no format '{name}'")))?,
        ),
        None => None,
    };
    let options = ReadOptions {
        kind: upload.kind,
        columns: upload.columns.clone(),
        options: upload.options.clone(),
    };
    let file_name = upload.file_name.as_deref().unwrap_or_default();
    let mut input = BufReader::with_capacity(1 << 16, file);
    let (read, format) =
        read_file(file_name, &mut input, format, &options).map_err(faults_or_memory)?;
    let summary = DatasetSummary {
        units: Some(read.units.clone()),
        ..read.dataset.summary()
    };
    let warnings = read.warnings.clone();
    let inspection = upload
        .inspect
        .then(|| inspect(read, format.name, file_name));
    Ok(Made::Checked(Box::new(Checked {
        format: format.name.to_owned(),
        summary,
        warnings,
        inspection: inspection
            .map(serde_json::to_value)
            .transpose()
            .map_err(internal)?,
    })))
}

fn unknown_format(detail: String) -> Failure {
    let known = FORMATS
        .iter()
        .map(|format| format.name)
        .collect::<Vec<_>>()
        .join(", ");
    Failure::Faults(vec![
        Fault::new("/meta/format", "unknown_value", detail).allowing(known),
    ])
}

/// Writes a dataset in another format.
fn write_as(input: &InputFile, format: &str, path: &Path) -> Result<Made, Failure> {
    let writer = writer_named(format).with_context(|| format!("there is no writer '{format}'"))?;
    let mut dataset = input.read()?;
    dataset.describe_sensors(&input.content.sensors);
    let file = File::create(path).context("cannot write a dataset")?;
    let mut out = BufWriter::with_capacity(1 << 16, file);
    match writer.put(&dataset, &mut out) {
        Err(WriteError::Faults(faults)) => return Err(Failure::Faults(faults)),
        Err(WriteError::Output(error)) => return Err(Failure::Internal(error.into())),
        Ok(()) => {}
    }
    out.flush().context("cannot write a dataset")?;
    Ok(Made::Written)
}

/// Loads, runs and reports.
fn job(
    id: Uuid,
    (kind, spec): (JobKind, &Value),
    files: Vec<Option<InputFile>>,
    directory: &Path,
    mut meter: Meter,
) -> Result<Made, Failure> {
    let plan = experiment::plan(kind, spec).map_err(Failure::Faults)?;
    let (inputs, read) = load(&plan, files, &mut meter)?;
    let outcome = experiment::run(&plan, inputs, &mut meter)?;
    let report = report::build(id, &plan, &read, &outcome, meter.timing()).map_err(internal)?;
    let files = leave(directory, outcome.artifacts, report)?;
    Ok(Made::Files {
        files,
        warnings: outcome.warnings,
    })
}

/// Reads the inputs of the plan, in its order. All files are opened first: a copy of an object in a bucket may be gone later.
pub(super) fn load(
    plan: &Plan,
    files: Vec<Option<InputFile>>,
    meter: &mut Meter,
) -> Result<(Inputs, Vec<ReportInput>), Failure> {
    let total = files.len() as u64;
    let mut opened = Vec::new();
    for file in files {
        opened.push(
            file.map(|file| Ok::<_, Failure>((open(&file.path)?, file)))
                .transpose()?,
        );
    }
    let (mut inputs, mut read) = (Vec::new(), Vec::new());
    for (done, (request, opened)) in plan.inputs.iter().zip(opened).enumerate() {
        if meter.progress(Step::Load, done as u64, total).is_break() {
            return Err(Failure::Stopped);
        }
        let input = opened
            .map(|(file, input)| input.load(file, request))
            .transpose()?;
        read.extend(input.as_ref().map(|input| ReportInput::new(request, input)));
        inputs.push(input);
    }
    if meter.progress(Step::Load, total, total).is_break() {
        return Err(Failure::Stopped);
    }
    Ok((inputs, read))
}

/// Writes what a job leaves behind, its report last, into the directory that the service gave.
pub(super) fn leave(
    directory: &Path,
    artifacts: Vec<Artifact>,
    report: Vec<u8>,
) -> Result<Vec<MadeFile>, Failure> {
    let report = Artifact::file("report.json", "application/json", report);
    let write = |artifact: Artifact| -> Result<MadeFile, Failure> {
        let Artifact {
            name,
            media_type,
            bytes,
            dataset,
            sensors,
        } = artifact;
        let path: PathBuf = directory.join(name);
        std::fs::write(&path, &bytes)
            .with_context(|| format!("cannot write {}", path.display()))?;
        let (name, media_type) = (name.to_owned(), media_type.to_owned());
        Ok(MadeFile {
            name,
            media_type,
            path,
            bytes: bytes.len() as u64,
            sha256: sha256_hex(&bytes),
            dataset,
            sensors,
        })
    };
    artifacts.into_iter().chain([report]).map(write).collect()
}
