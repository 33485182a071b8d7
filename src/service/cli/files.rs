//! Job files for `trackloom run`: a request with its `kind`, whose sources may be files.
//!
//! The plan knows no files: a file source is planned as a dataset whose identity is its place in the job file, and put
//! back into the spec of the report, so that the report can be run again.

use crate::experiment::job_shape::take_kind;
use crate::experiment::{Input, Inputs, JobKind, Plan, Source};
use crate::formats::{self, Format, FormatOptions, OPTION_FIELDS, ReadOptions, ReadOutcome};
use crate::model::dataset::{Dataset, DatasetKind};
use crate::model::fault::Fault;
use crate::registry::{
    self, Field, Kind, Object, joined, list, optional, placed, required, text_map,
};
use crate::service::panics;
use crate::service::storage::blobs::sha256_hex;
use serde::Deserialize;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// A job file, its file sources taken out.
pub(super) struct JobFile {
    pub kind: JobKind,
    /// The request as the plan checks it.
    pub body: Value,
    /// By JSON pointer.
    files: BTreeMap<String, FileSource>,
    /// Paths in the job file are relative to where it stands.
    folder: PathBuf,
}

#[derive(Debug, Clone, Deserialize)]
pub(super) struct FileSource {
    /// Always `file`.
    #[serde(rename = "source")]
    _source: String,
    path: String,
    format: Option<String>,
    #[serde(default)]
    columns: BTreeMap<String, String>,
    sensor_ids: Option<Vec<String>>,
    /// What is left: the table lets nothing else through.
    #[serde(flatten)]
    options: FormatOptions,
}

const TEXT: Kind = Kind::Text { max_length: 4096 };

pub(super) static FILE_SOURCE: Object = Object {
    name: "FileSource",
    summary: "A file, relative to the job file.",
    fields: &FILE_FIELDS,
};

const FILE_FIELDS: [Field; 5 + OPTION_FIELDS.len()] =
    joined(&[&COMMON, &OPTION_FIELDS, &SENSOR_IDS]);

const COMMON: [Field; 4] = [
    required("source", "file", Kind::Choice(&["file"])),
    required("path", "Where the file is.", TEXT),
    optional(
        "format",
        "Its format; told from the file when absent.",
        TEXT,
    ),
    optional(
        "columns",
        "The file's column name to the canonical one.",
        text_map(64, 100),
    ),
];

const SENSOR_IDS: [Field; 1] = [optional(
    "sensor_ids",
    "Only these sensors.",
    list(&TEXT, 1, 64),
)];

/// The JSON pointers of every place in a request that may name a source; those of a campaign are in its base.
fn source_pointers(body: &Value) -> Vec<String> {
    if let Some(base) = body.get("base") {
        return source_pointers(base)
            .into_iter()
            .map(|pointer| format!("/base{pointer}"))
            .collect();
    }
    let mut pointers = ["/input", "/truth", "/tracks", "/detections"]
        .map(String::from)
        .to_vec();
    let sequences = body["sequences"].as_array().map_or(0, Vec::len);
    let sets = body["sets"].as_array().map_or(0, Vec::len);
    pointers.extend((0..sets).map(|index| format!("/sets/{index}")));
    pointers
        .extend((0..sequences).flat_map(|index| {
            ["truth", "tracks"].map(|name| format!("/sequences/{index}/{name}"))
        }));
    pointers
}

impl JobFile {
    /// Takes apart a job file that stands in `folder`.
    pub(super) fn new(mut body: Value, folder: &Path) -> Result<Self, Vec<Fault>> {
        let kind = take_kind(&mut body)?;
        let mut files = BTreeMap::new();
        let mut faults = Vec::new();
        for pointer in source_pointers(&body) {
            let Some(source) = body
                .pointer_mut(&pointer)
                .filter(|source| source["source"] == "file")
            else {
                continue;
            };
            match registry::check(source, &FILE_SOURCE).map(FileSource::deserialize) {
                Ok(Ok(file)) => {
                    files.insert(pointer.clone(), file);
                }
                Ok(Err(error)) => {
                    faults.push(Fault::new(pointer.clone(), "malformed", error.to_string()))
                }
                Err(found) => faults.extend(placed(&pointer, found)),
            }
            *source = json!({"source": "dataset", "dataset_id": pointer});
        }
        if faults.is_empty() {
            Ok(JobFile {
                kind,
                body,
                files,
                folder: folder.to_owned(),
            })
        } else {
            Err(faults)
        }
    }

    /// A fault for each file that is not there, to be told with what else is wrong with the job.
    pub(super) fn missing_files(&self) -> Vec<Fault> {
        let absent = |(pointer, file): (&String, &FileSource)| {
            let path = self.folder.join(&file.path);
            let detail = format!("{}: there is no such file", path.display());
            (!path.exists()).then(|| Fault::new(format!("{pointer}/path"), "not_found", detail))
        };
        self.files.iter().filter_map(absent).collect()
    }

    /// The files that it reads.
    pub(super) fn paths(&self) -> impl Iterator<Item = PathBuf> {
        let files = self.files.values();
        files.map(|file| self.folder.join(&file.path))
    }

    /// Puts the file sources back into a normalised spec.
    pub(super) fn restore(&self, spec: &mut Value) {
        for (pointer, file) in &self.files {
            let mut source = json!({"source": "file", "path": file.path});
            if let Some(format) = &file.format {
                source["format"] = json!(format);
            }
            if !file.columns.is_empty() {
                source["columns"] = json!(file.columns);
            }
            for (name, value) in file.options.iter() {
                source[name] = value.clone();
            }
            if let Some(sensor_ids) = &file.sensor_ids {
                source["sensor_ids"] = json!(sensor_ids);
            }
            if let Some(place) = spec.pointer_mut(pointer) {
                *place = source;
            }
        }
    }

    /// Loads what the plan asks for. A source that is no file has no server to come from: a fault.
    pub(super) fn load(
        &self,
        plan: &Plan,
        warnings: &mut Vec<String>,
    ) -> Result<Inputs, Vec<Fault>> {
        let mut faults = Vec::new();
        let mut inputs = Vec::new();
        for request in &plan.inputs {
            let (Source::Dataset {
                dataset_id: pointer,
                ..
            }
            | Source::Job {
                job_id: pointer, ..
            }) = &request.source;
            match self.files.get(pointer.as_str()) {
                Some(file) => match self.read(file, request.role, warnings) {
                    Ok(input) => inputs.push(Some(input)),
                    Err(found) => faults.extend(placed(&request.pointer, found)),
                },
                None => {
                    let detail = "without a server a source is a file, a scenario or a preset";
                    faults.push(
                        Fault::new(
                            format!("{}/source", request.pointer),
                            "unknown_value",
                            detail,
                        )
                        .allowing("file, scenario, preset"),
                    );
                }
            }
        }
        if faults.is_empty() {
            Ok(inputs)
        } else {
            Err(faults)
        }
    }

    fn read(
        &self,
        file: &FileSource,
        role: DatasetKind,
        warnings: &mut Vec<String>,
    ) -> Result<Input, Vec<Fault>> {
        file.read(&self.folder, Some(role), warnings)
    }
}

/// What was read, and in which format.
type Read = (ReadOutcome, &'static Format);

impl FileSource {
    /// Reads the file with all that there is to say of it.
    pub(super) fn read_whole(
        &self,
        folder: &Path,
        kind: Option<DatasetKind>,
    ) -> Result<Read, Vec<Fault>> {
        Ok(self.read_bytes(folder, kind)?.0)
    }

    /// What is said of the file: its format, where that is said, and what a reader has to know.
    pub(super) fn told(
        &self,
        kind: Option<DatasetKind>,
    ) -> Result<(Option<&'static Format>, ReadOptions), Vec<Fault>> {
        let format = match &self.format {
            Some(name) => Some(formats::format_named(name).ok_or_else(|| unknown_format(name))?),
            None => None,
        };
        let options = ReadOptions {
            kind,
            columns: self.columns.clone(),
            options: self.options.clone(),
        };
        Ok((format, options))
    }

    fn read_bytes(
        &self,
        folder: &Path,
        kind: Option<DatasetKind>,
    ) -> Result<(Read, Vec<u8>), Vec<Fault>> {
        let path = folder.join(&self.path);
        let bytes = std::fs::read(&path).map_err(|error| {
            let detail = format!("{}: {error}", path.display());
            vec![Fault::new("/path", "not_found", detail)]
        })?;
        let (format, options) = self.told(kind)?;
        let read = panics::reading(|| {
            formats::read_file(&self.path, &mut bytes.as_slice(), format, &options)
        })?;
        Ok((read, bytes))
    }

    /// Reads the file, whose path is relative to the folder.
    pub(super) fn read(
        &self,
        folder: &Path,
        kind: Option<DatasetKind>,
        warnings: &mut Vec<String>,
    ) -> Result<Input, Vec<Fault>> {
        let (read, bytes) = self.read_bytes(folder, kind)?;
        let file = self;
        warnings.extend(
            read.0
                .warnings
                .into_iter()
                .map(|warning| format!("{}: {warning}", file.path)),
        );
        let dataset = match &file.sensor_ids {
            Some(wanted) => only(read.0.dataset, wanted)?,
            None => read.0.dataset,
        };
        let sha256 = sha256_hex(&bytes);
        Ok(Input {
            dataset,
            sensors: Vec::new(),
            sha256,
        })
    }
}

fn unknown_format(name: &str) -> Vec<Fault> {
    let known: Vec<&str> = formats::FORMATS.iter().map(|format| format.name).collect();
    let detail = format!("there is no format '{name}'");
    vec![Fault::new("/format", "unknown_value", detail).allowing(known.join(", "))]
}

fn only(dataset: Dataset, wanted: &[String]) -> Result<Dataset, Vec<Fault>> {
    dataset
        .only_sensors(wanted)
        .map_err(|faults| placed("/sensor_ids", faults))
}
