//! What is told of a file on the command line, by the commands that read one.

use super::files::{FILE_SOURCE, FileSource};
use crate::formats::{Format, ReadOptions, ReadOutcome};
use crate::model::dataset::{Dataset, DatasetKind};
use crate::model::fault::Fault;
use crate::model::sensor::SensorSettings;
use crate::model::truth::TruthSet;
use crate::registry;
use clap::Args;
use clap::builder::PossibleValuesParser;
use serde::Deserialize;
use serde_json::{Map, Value, json};
use std::path::{Path, PathBuf};

#[derive(Args)]
pub(super) struct ReadArguments {
    /// The file to read
    pub file: PathBuf,
    /// The format of the file; told from its content when absent
    #[arg(long)]
    pub format: Option<String>,
    /// What the file holds; told from its content when absent
    #[arg(long, value_parser = PossibleValuesParser::new(DatasetKind::ALL.map(DatasetKind::name)))]
    kind: Option<String>,
    /// A column of the file, and its canonical name, with its unit in brackets where it is another: alt='height_m [ft]'
    #[arg(long = "column", value_name = "COLUMN=NAME")]
    columns: Vec<String>,
    /// A file of such columns and of options, as JSON: {"columns": {"alt": "height_m [ft]"}, "time_format": "…"}
    #[arg(long, value_name = "FILE")]
    mapping: Option<PathBuf>,
    /// Where on the Earth the origin of the data is (degrees, and metres above the ellipsoid)
    #[arg(long, value_name = "LAT,LON[,HEIGHT]", allow_hyphen_values = true)]
    origin: Option<String>,
    /// The time of the first unit of a feed without times, such as 2026-01-31T12:00:00Z
    #[arg(long, value_name = "TIME")]
    start: Option<String>,
    /// What is known of the sensors, as JSON: [{"sensor_id": "radar", "x_m": 0, "y_m": 0}]
    #[arg(long, value_name = "JSON")]
    sensors: Option<String>,
    /// Anything else that the reader has to be told, such as date=2026-01-31; values are JSON or text
    #[arg(long = "option", value_name = "NAME=VALUE")]
    options: Vec<String>,
}

impl ReadArguments {
    /// The dataset; warnings go to the standard error.
    ///
    /// # Errors
    /// What is wrong with the arguments or the file.
    pub fn dataset(&self) -> Result<Dataset, Vec<Fault>> {
        let (mut read, _) = self.read()?;
        for warning in &read.warnings {
            eprintln!("warning: {warning}");
        }
        let sensors = self.sensors.as_deref().unwrap_or("[]");
        let sensors: Vec<SensorSettings> = serde_json::from_str(sensors)
            .map_err(|error| vec![Fault::new("--sensors", "malformed", error.to_string())])?;
        read.dataset.describe_sensors(&sensors);
        Ok(read.dataset)
    }

    /// What is said of the file, for who reads it another way: the format, where it is said, and the options.
    ///
    /// # Errors
    /// What is wrong with the arguments.
    pub fn told(
        &self,
        kind: DatasetKind,
    ) -> Result<(Option<&'static Format>, ReadOptions), Vec<Fault>> {
        source(self)?.told(Some(kind)).map_err(of_arguments)
    }

    /// What was read, and in which format.
    ///
    /// # Errors
    /// As of [`ReadArguments::dataset`].
    pub fn read(&self) -> Result<(ReadOutcome, &'static Format), Vec<Fault>> {
        let kind = self.kind.as_deref();
        let kind = DatasetKind::ALL
            .into_iter()
            .find(|known| Some(known.name()) == kind);
        let read = source(self)?.read_whole(Path::new(""), kind);
        read.map_err(of_arguments)
    }
}

/// The head of what is wrong with a file.
pub(super) const NOT_READ: &str = "the file cannot be read; docs/formats.md says what each format needs, docs/files.md what columns mean";

/// Faults where the command line says what they are about: what an upload calls `/meta/kind` is `--kind` here.
fn of_arguments(faults: Vec<Fault>) -> Vec<Fault> {
    let placed = |fault: Fault| Fault {
        pointer: argument_of(&fault.pointer).unwrap_or(fault.pointer),
        ..fault
    };
    faults.into_iter().map(placed).collect()
}

fn argument_of(pointer: &str) -> Option<String> {
    let (name, within) = match pointer.strip_prefix("/meta/")? {
        said if said.contains('/') => said.split_once('/')?,
        said => (said, ""),
    };
    Some(match name {
        "kind" | "format" | "origin" | "start" => format!("--{name}"),
        "columns" => format!("--column {within}").trim_end().to_owned(),
        _ => format!("--option {name}"),
    })
}

/// The truth in a file of which nothing else is said.
///
/// # Errors
/// What is wrong with the file.
pub(super) fn read_truth(path: &Path) -> Result<TruthSet, Vec<Fault>> {
    let source = json!({"source": "file", "path": path});
    let source = FileSource::deserialize(source)
        .map_err(|error| vec![Fault::new("--truth", "malformed", error.to_string())])?;
    let (read, _) = source.read_whole(Path::new(""), Some(DatasetKind::Truth))?;
    match read.dataset {
        Dataset::Truth(truth) => Ok(truth),
        _ => {
            let detail = "the file holds no truth of places";
            Err(vec![Fault::new("--truth", "unsupported", detail)])
        }
    }
}

/// The mapping of a file, empty where there is none.
fn mapping(path: Option<&Path>) -> Result<Map<String, Value>, Vec<Fault>> {
    let Some(path) = path else {
        return Ok(Map::new());
    };
    let fault = |detail: String| {
        vec![Fault::new(
            "--mapping",
            "malformed",
            format!("{}: {detail}", path.display()),
        )]
    };
    let bytes = std::fs::read(path).map_err(|error| fault(error.to_string()))?;
    serde_json::from_slice(&bytes).map_err(|error| fault(error.to_string()))
}

/// The arguments as the source of a job file says them, checked by its table.
fn source(arguments: &ReadArguments) -> Result<FileSource, Vec<Fault>> {
    let mut source = mapping(arguments.mapping.as_deref())?;
    source.insert("source".to_owned(), json!("file"));
    source.insert("path".to_owned(), json!(arguments.file));
    if let Some(format) = &arguments.format {
        source.insert("format".to_owned(), json!(format));
    }
    if let Some(text) = &arguments.origin {
        source.insert("origin".to_owned(), origin(text)?);
    }
    if let Some(start) = &arguments.start {
        source.insert("start".to_owned(), json!(start));
    }
    let mapped = source.remove("columns");
    let mut columns = mapped
        .and_then(|mapped| mapped.as_object().cloned())
        .unwrap_or_default();
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
