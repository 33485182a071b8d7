//! A file that holds a dataset, with what has to be known to read it.

use crate::experiment::{Input, InputRequest};
use crate::formats::{FormatOptions, ReadOptions, format_named, read_file};
use crate::model::dataset::{Dataset, DatasetKind};
use crate::model::fault::Fault;
use crate::model::sensor::SensorSettings;
use crate::registry::placed;
use crate::service::child::Failure;
use anyhow::Context;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, BufReader};
use std::path::{Path, PathBuf};

#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct InputFile {
    pub path: PathBuf,
    pub content: FileContent,
}

/// What a file holds, and how to read it.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct FileContent {
    pub format: String,
    pub kind: DatasetKind,
    pub columns: BTreeMap<String, String>,
    pub options: FormatOptions,
    pub sensors: Vec<SensorSettings>,
    pub sha256: String,
}

pub(super) fn open(path: &Path) -> Result<File, Failure> {
    Ok(File::open(path).with_context(|| format!("cannot open {}", path.display()))?)
}

impl InputFile {
    /// Reads the whole file. Blocks.
    pub(in crate::service) fn read(&self) -> Result<Dataset, Failure> {
        self.read_from(open(&self.path)?)
    }

    fn read_from(&self, file: File) -> Result<Dataset, Failure> {
        let content = &self.content;
        let format = format_named(&content.format).with_context(|| {
            format!("a stored dataset has the unknown format {}", content.format)
        })?;
        let options = ReadOptions {
            kind: Some(content.kind),
            columns: content.columns.clone(),
            options: content.options.clone(),
        };
        let mut input = BufReader::with_capacity(1 << 16, file);
        let (read, _) =
            read_file("", &mut input, Some(format), &options).map_err(faults_or_memory)?;
        Ok(read.dataset)
    }

    /// Reads what the request asks for: the file, or the named sensors' part of it. Blocks.
    pub(super) fn load(self, file: File, request: &InputRequest) -> Result<Input, Failure> {
        let mut dataset = self
            .read_from(file)
            .map_err(|failure| repoint(failure, &request.pointer))?;
        let mut sensors = self.content.sensors;
        if let Some(wanted) = request.source.sensor_ids() {
            let place = format!("{}/sensor_ids", request.pointer);
            dataset = dataset
                .only_sensors(wanted)
                .map_err(|faults| Failure::Faults(placed(&place, faults)))?;
            sensors.retain(|sensor| wanted.contains(&sensor.sensor_id));
        }
        Ok(Input {
            dataset,
            sensors,
            sha256: self.content.sha256,
        })
    }
}

/// The faults of a file. Reading a whole file at once does not abort where memory is refused, as everything else does; it says so.
pub(super) fn faults_or_memory(faults: Vec<Fault>) -> Failure {
    let refused = io::Error::from(io::ErrorKind::OutOfMemory).to_string();
    if faults.iter().any(|fault| fault.detail.contains(&refused)) {
        Failure::Memory
    } else {
        Failure::Faults(faults)
    }
}

/// Puts the place in the request before the pointers of faults.
fn repoint(failure: Failure, pointer: &str) -> Failure {
    match failure {
        Failure::Faults(faults) => Failure::Faults(placed(pointer, faults)),
        other => other,
    }
}
