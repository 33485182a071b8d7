//! `trackloom convert`: a file in another format, without a server.

use super::files::{FILE_SOURCE, FileSource};
use super::run::{Trouble, end};
use crate::formats::{WRITERS, WriteError, Writer, writer_named};
use crate::model::dataset::{Dataset, DatasetKind};
use crate::model::fault::Fault;
use crate::model::sensor::SensorSettings;
use crate::registry;
use anyhow::Context;
use clap::Args;
use clap::builder::PossibleValuesParser;
use serde::Deserialize;
use serde_json::{Map, Value, json};
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

#[derive(Args)]
pub(super) struct ConvertArguments {
    /// The file to read
    file: PathBuf,
    /// The format to write
    #[arg(long, value_name = "FORMAT", value_parser = PossibleValuesParser::new(WRITERS.iter().map(|writer| writer.name)))]
    to: String,
    /// Where to write; standard output when absent
    #[arg(long, short, value_name = "FILE")]
    output: Option<PathBuf>,
    /// The format of the file; told from its content when absent
    #[arg(long)]
    format: Option<String>,
    /// What the file holds; told from its content when absent
    #[arg(long, value_parser = PossibleValuesParser::new(DatasetKind::ALL.map(DatasetKind::name)))]
    kind: Option<String>,
    /// A column of the file and its canonical name
    #[arg(long = "column", value_name = "COLUMN=NAME")]
    columns: Vec<String>,
    /// Where on the Earth the origin of the data is (degrees, and metres above the ellipsoid)
    #[arg(long, value_name = "LAT,LON[,HEIGHT]", allow_hyphen_values = true)]
    origin: Option<String>,
    /// What is known of the sensors, as JSON: [{"sensor_id": "radar", "x_m": 0, "y_m": 0}]
    #[arg(long, value_name = "JSON")]
    sensors: Option<String>,
    /// Anything else that the reader has to be told, such as date=2026-01-31; values are JSON or text
    #[arg(long = "option", value_name = "NAME=VALUE")]
    options: Vec<String>,
}

pub(super) fn convert(arguments: &ConvertArguments) -> ExitCode {
    end(finish(arguments), "the file cannot be converted")
}

fn finish(arguments: &ConvertArguments) -> Result<(), Trouble> {
    // The parser of arguments lets no other name through.
    let Some(writer) = writer_named(&arguments.to) else {
        return Ok(());
    };
    let dataset = read(arguments)?;
    match &arguments.output {
        None => write(writer, &dataset, std::io::stdout().lock()),
        Some(path) => write_file(writer, &dataset, path),
    }
}

fn read(arguments: &ConvertArguments) -> Result<Dataset, Vec<Fault>> {
    let source = source(arguments)?;
    let kind = arguments.kind.as_deref();
    let kind = DatasetKind::ALL
        .into_iter()
        .find(|known| Some(known.name()) == kind);
    let sensors = arguments.sensors.as_deref().unwrap_or("[]");
    let sensors: Vec<SensorSettings> = serde_json::from_str(sensors)
        .map_err(|error| vec![Fault::new("--sensors", "malformed", error.to_string())])?;
    let mut warnings = Vec::new();
    let read = source.read(Path::new(""), kind, &mut warnings);
    for warning in &warnings {
        eprintln!("warning: {warning}");
    }
    let mut dataset = read?.dataset;
    dataset.describe_sensors(&sensors);
    Ok(dataset)
}

/// The arguments as the source of a job file says them, checked by its table.
fn source(arguments: &ConvertArguments) -> Result<FileSource, Vec<Fault>> {
    let mut source = Map::new();
    source.insert("source".to_owned(), json!("file"));
    source.insert("path".to_owned(), json!(arguments.file));
    if let Some(format) = &arguments.format {
        source.insert("format".to_owned(), json!(format));
    }
    if let Some(text) = &arguments.origin {
        source.insert("origin".to_owned(), origin(text)?);
    }
    let mut columns = Map::new();
    for pair in &arguments.columns {
        let (column, name) = parted("--column", pair)?;
        columns.insert(column.to_owned(), json!(name));
    }
    if !columns.is_empty() {
        source.insert("columns".to_owned(), Value::Object(columns));
    }
    for pair in &arguments.options {
        let (name, value) = parted("--option", pair)?;
        let value = serde_json::from_str(value).unwrap_or_else(|_| json!(value));
        source.insert(name.to_owned(), value);
    }
    let checked = registry::check(&Value::Object(source), &FILE_SOURCE)?;
    FileSource::deserialize(checked)
        .map_err(|error| vec![Fault::new("", "malformed", error.to_string())])
}

fn parted<'a>(argument: &str, pair: &'a str) -> Result<(&'a str, &'a str), Vec<Fault>> {
    let malformed = || {
        let detail = format!("'{pair}' has no '='");
        vec![Fault::new(argument, "malformed", detail)]
    };
    pair.split_once('=').ok_or_else(malformed)
}

fn origin(text: &str) -> Result<Value, Vec<Fault>> {
    let numbers: Result<Vec<f64>, _> = text.split(',').map(|part| part.trim().parse()).collect();
    match numbers.as_deref() {
        Ok([lat_deg, lon_deg]) => Ok(json!({"lat_deg": lat_deg, "lon_deg": lon_deg})),
        Ok([lat_deg, lon_deg, height_m]) => {
            Ok(json!({"lat_deg": lat_deg, "lon_deg": lon_deg, "height_m": height_m}))
        }
        _ => {
            let detail = format!("'{text}' is no place");
            let fault = Fault::new("--origin", "malformed", detail);
            Err(vec![fault.allowing("LAT,LON or LAT,LON,HEIGHT")])
        }
    }
}

/// Writes under another name first, so that the file is never half written.
fn write_file(writer: &Writer, dataset: &Dataset, path: &Path) -> Result<(), Trouble> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let part = path.with_file_name(format!(".{name}.part"));
    let cannot = || format!("cannot write {}", path.display());
    let file = File::create(&part).with_context(cannot)?;
    let written = write(writer, dataset, file).and_then(|()| {
        let renamed = std::fs::rename(&part, path).with_context(cannot);
        renamed.map_err(Trouble::Failed)
    });
    if written.is_err() {
        // What is left of it is of no use, and its loss no news.
        let _ = std::fs::remove_file(&part);
    }
    written
}

fn write(writer: &Writer, dataset: &Dataset, out: impl Write) -> Result<(), Trouble> {
    let mut out = BufWriter::with_capacity(1 << 16, out);
    match writer.put(dataset, &mut out) {
        Err(WriteError::Faults(faults)) => Err(faults.into()),
        Err(WriteError::Output(error)) => Err(Trouble::Failed(error.into())),
        Ok(()) => out.flush().map_err(|error| Trouble::Failed(error.into())),
    }
}
