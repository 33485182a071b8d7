//! From a stored dataset to the file that holds it.

use crate::formats::FormatOptions;
use crate::model::dataset::{Dataset, DatasetKind};
use crate::model::sensor::SensorSettings;
use crate::service::child::{Failure, InputFile};
use crate::service::error::ServiceError;
use crate::service::storage::StoredDataset;
use crate::service::storage::blobs::Blobs;
use anyhow::{Context, anyhow};
use std::collections::BTreeMap;

/// What to read a dataset from.
#[derive(Clone)]
pub struct Located {
    pub blobs: Blobs,
    pub format: String,
    pub kind: DatasetKind,
    pub columns: BTreeMap<String, String>,
    pub options: FormatOptions,
    pub sensors: Vec<SensorSettings>,
    pub sha256: String,
}

impl Located {
    pub fn new(blobs: Blobs, dataset: StoredDataset) -> Self {
        let StoredDataset {
            info,
            columns,
            options,
            ..
        } = dataset;
        Located {
            blobs,
            format: info.format,
            kind: info.kind,
            columns,
            options,
            sensors: info.sensors,
            sha256: info.sha256,
        }
    }

    /// The file, fetched where it is elsewhere; to be opened soon. Blocks.
    pub fn local(self) -> anyhow::Result<InputFile> {
        let Located {
            blobs,
            format,
            kind,
            columns,
            options,
            sensors,
            sha256,
        } = self;
        Ok(InputFile {
            path: blobs.local(&sha256)?,
            format,
            kind,
            columns,
            options,
            sensors,
            sha256,
        })
    }

    /// Reads the whole file. Blocks.
    pub fn read(&self) -> Result<Dataset, ServiceError> {
        let read = self.clone().local()?.read();
        read.map_err(|failure| match failure {
            Failure::Faults(faults) => ServiceError::Invalid(faults),
            failure => ServiceError::Internal(anyhow!("a stored file cannot be read: {failure:?}")),
        })
    }
}

/// Local files of what was located, fetched where they are elsewhere.
pub async fn local_files(located: Vec<Option<Located>>) -> anyhow::Result<Vec<Option<InputFile>>> {
    if located.iter().all(Option::is_none) {
        return Ok(vec![None; located.len()]);
    }
    let fetch = move || {
        located
            .into_iter()
            .map(|located| located.map(Located::local).transpose())
            .collect()
    };
    tokio::task::spawn_blocking(fetch)
        .await
        .context("fetching files panicked")?
}
