//! What an upload says of itself, and the dataset that it becomes.

use crate::formats::FormatOptions;
use crate::model::dataset::DatasetKind;
use crate::model::fault::Fault;
use crate::model::sensor::SensorSettings;
use crate::registry::control_character_fault;
use crate::service::canonical::sorted;
use crate::service::child::Checked;
use crate::service::storage::NewDataset;
use crate::service::storage::blobs::{ReceivedFile, sha256_hex};
use serde::Deserialize;
use serde_json::json;
use std::collections::BTreeMap;

/// What the uploader said about a file.
#[derive(Debug, Clone, Default, Deserialize)]
pub struct DatasetMeta {
    pub name: Option<String>,
    pub kind: Option<DatasetKind>,
    /// A name of `formats::FORMATS`; absent: told from the file name, else `csv`.
    pub format: Option<String>,
    /// The file's column name → the canonical one.
    #[serde(default)]
    pub columns: BTreeMap<String, String>,
    /// What the format has to be told: all that is left, for the table of an upload lets nothing else through.
    #[serde(flatten)]
    pub options: FormatOptions,
    #[serde(default)]
    pub sensors: Vec<SensorSettings>,
    #[serde(skip)]
    pub file_name: Option<String>,
}

/// Names with characters that not every database keeps.
pub(super) fn text_faults(meta: &DatasetMeta) -> Vec<Fault> {
    let name = meta
        .name
        .as_deref()
        .and_then(|name| control_character_fault(name, "/meta/name"));
    let file_name = meta
        .file_name
        .as_deref()
        .and_then(|name| control_character_fault(name, "/file"));
    name.into_iter().chain(file_name).collect()
}

pub(super) fn new_dataset(file: &ReceivedFile, meta: DatasetMeta, checked: Checked) -> NewDataset {
    let Checked {
        format,
        summary,
        warnings,
        inspection: _,
    } = checked;
    let mut said = json!({
        "name": meta.name, "kind": summary.kind, "format": format, "columns": meta.columns, "sensors": meta.sensors
    });
    for (name, value) in meta.options.iter() {
        said[name.as_str()] = value.clone();
    }
    let name = meta
        .name
        .or_else(|| meta.file_name.clone())
        .unwrap_or_else(|| summary.kind.name().to_owned());
    NewDataset {
        name,
        format,
        bytes: file.bytes,
        sha256: file.sha256.clone(),
        meta_sha256: sha256_hex(sorted(&said).to_string().as_bytes()),
        columns: meta.columns,
        options: meta.options,
        summary,
        sensors: meta.sensors,
        warnings,
        origin_job_id: None,
        file_name: meta.file_name,
    }
}
