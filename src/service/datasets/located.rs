//! From a stored dataset to the file that holds it.

use crate::model::dataset::Dataset;
use crate::service::child::{Failure, FileContent, InputFile};
use crate::service::error::ServiceError;
use crate::service::storage::StoredDataset;
use crate::service::storage::blobs::Blobs;
use anyhow::{Context, anyhow};

/// What to read a dataset from.
#[derive(Clone)]
pub struct Located {
    pub blobs: Blobs,
    pub content: FileContent,
}

impl Located {
    pub fn new(blobs: Blobs, dataset: StoredDataset) -> Self {
        let StoredDataset {
            info,
            columns,
            options,
            ..
        } = dataset;
        let content = FileContent {
            format: info.format,
            kind: info.kind,
            columns,
            options,
            sensors: info.sensors,
            sha256: info.sha256,
        };
        Located { blobs, content }
    }

    /// The file, fetched where it is elsewhere; to be opened soon. Blocks.
    pub fn local(self) -> anyhow::Result<InputFile> {
        Ok(InputFile {
            path: self.blobs.local(&self.content.sha256)?,
            content: self.content,
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
