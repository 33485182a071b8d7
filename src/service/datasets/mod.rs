//! Keeping datasets: checked before they are kept, kept once, and removed from the disk when nothing needs them.

mod located;
mod upload;

pub use located::{Located, local_files};
pub use upload::DatasetMeta;

use super::child::{Checked, Desk, Made, Order, Upload, unexpected};
use super::error::{ServiceError, cursor_of, refuse_any};
pub use super::storage::DatasetFilter;
use super::storage::blobs::Blobs;
pub use super::storage::blobs::{Content, ReceivedFile};
use super::storage::{NoSweeping, Page, Storage, StoredDataset};
use super::types::{DatasetInfo, DatasetPage};
use crate::experiment::Known;
use crate::formats::{Writer, format_named};
use crate::model::dataset::{DatasetKind, DatasetSummary};
use anyhow::Context;
use serde_json::Value;
use serde_json::value::RawValue;
use std::path::{Path, PathBuf};
use tokio::sync::{RwLock, RwLockReadGuard};
use tokio::task::spawn_blocking;
use tokio_util::sync::CancellationToken;
use upload::{new_dataset, text_faults};
use uuid::Uuid;

/// A file to serve; it stays where it is until its owner is deleted.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StoredFile {
    pub content: Content,
    pub media_type: String,
    pub bytes: u64,
    pub sha256: String,
    /// What to call it when it is saved.
    pub file_name: String,
}

/// A file that was written for one answer.
pub struct WrittenFile {
    pub file: std::fs::File,
    pub media_type: &'static str,
    /// What to call it when it is saved.
    pub file_name: String,
}

/// Guards against the removal of files, in this process and in others.
pub type NoSweepingHere<'a> = (RwLockReadGuard<'a, ()>, NoSweeping);

/// The datasets of one data directory.
pub struct Datasets {
    storage: Storage,
    blobs: Blobs,
    uploads: Desk,
    looks: Desk,
    /// Held for reading while files wait for their row, for writing while unused files are removed.
    sweeping: RwLock<()>,
    closing: CancellationToken,
}

impl Datasets {
    /// `uploads` checks files, `looks` reads those that are kept.
    pub fn new(
        storage: Storage,
        blobs: Blobs,
        (uploads, looks): (Desk, Desk),
        closing: CancellationToken,
    ) -> Self {
        Datasets {
            storage,
            blobs,
            uploads,
            looks,
            sweeping: RwLock::new(()),
            closing,
        }
    }

    /// Where uploads are received: on the same file system as the blobs.
    pub fn temp_dir(&self) -> &Path {
        self.blobs.temporary()
    }

    /// Checks a received file and keeps it. The same content with the same meta gives the dataset that exists, and `false`.
    pub async fn add(
        &self,
        file: ReceivedFile,
        meta: DatasetMeta,
    ) -> Result<(DatasetInfo, bool), ServiceError> {
        if self.closing.is_cancelled() {
            return Err(ServiceError::ShuttingDown);
        }
        refuse_any(text_faults(&meta))?;
        let checked = self.check(order_of(&file, &meta, false)).await?;
        let new = new_dataset(&file, meta, checked);
        let _no_sweeping = self.no_sweeping().await?;
        let adopt = {
            let (blobs, ReceivedFile { path, sha256, .. }) = (self.blobs.clone(), file);
            move || blobs.adopt(&path, &sha256)
        };
        spawn_blocking(adopt)
            .await
            .context("keeping an upload panicked")??;
        let (id, is_new) = self.storage.add_dataset(&new).await?;
        Ok((self.get(id).await?, is_new))
    }

    /// All that there is to say of a file, which is not kept.
    pub async fn inspect(
        &self,
        file: &ReceivedFile,
        meta: &DatasetMeta,
    ) -> Result<Value, ServiceError> {
        refuse_any(text_faults(meta))?;
        let checked = self.check(order_of(file, meta, true)).await?;
        Ok(checked.inspection.context("a file was not inspected")?)
    }

    /// Has a child tell the format and read the file with it.
    async fn check(&self, upload: Upload) -> Result<Checked, ServiceError> {
        let order = Order::Check(upload);
        match self.uploads.ask(order, "reading the file").await? {
            Made::Checked(checked) => Ok(*checked),
            made => Err(unexpected(&made).into()),
        }
    }

    /// The dataset, unless there is none or it has been deleted.
    pub async fn get(&self, id: Uuid) -> Result<DatasetInfo, ServiceError> {
        Ok(self.stored(id).await?.info)
    }

    async fn stored(&self, id: Uuid) -> Result<StoredDataset, ServiceError> {
        let stored = self
            .storage
            .dataset(id)
            .await?
            .ok_or(ServiceError::NotFound("dataset"))?;
        if stored.deleted {
            Err(ServiceError::Gone("dataset"))
        } else {
            Ok(stored)
        }
    }

    pub async fn list(&self, filter: DatasetFilter) -> Result<DatasetPage, ServiceError> {
        refuse_any(filter.faults())?;
        let after = cursor_of(&filter.paging)?;
        let Page {
            items,
            next_cursor,
            total,
        } = self.storage.datasets(&filter, after).await?;
        Ok(DatasetPage {
            items,
            next_cursor,
            total,
        })
    }

    /// Deletes a dataset, unless a queued or running job needs it.
    pub async fn delete(&self, id: Uuid) -> Result<(), ServiceError> {
        let stored = self.stored(id).await?;
        let users = self.storage.delete_dataset(id).await?;
        if !users.is_empty() {
            return Err(ServiceError::in_use("the dataset is", &users));
        }
        self.collect_garbage(vec![stored.info.sha256]).await
    }

    /// The file as it was uploaded or made.
    pub async fn file(&self, id: Uuid) -> Result<StoredFile, ServiceError> {
        let StoredDataset {
            info, file_name, ..
        } = self.stored(id).await?;
        let media_type = format_named(&info.format)
            .map_or("application/octet-stream", |format| format.media_type);
        Ok(StoredFile {
            content: self.content(&info.sha256, info.bytes).await?,
            media_type: media_type.to_owned(),
            bytes: info.bytes,
            sha256: info.sha256,
            file_name: file_name.unwrap_or(info.name),
        })
    }

    /// The first rows, as the JSON of a [`Preview`](crate::service::views::preview::Preview).
    pub async fn preview(&self, id: Uuid, rows: usize) -> Result<Box<RawValue>, ServiceError> {
        let located = Located::new(self.blobs.clone(), self.stored(id).await?);
        let input = spawn_blocking(|| located.local())
            .await
            .context("fetching a file panicked")??;
        let order = Order::Preview { input, rows };
        match self.looks.ask(order, "reading the dataset").await? {
            Made::Preview(preview) => Ok(preview),
            made => Err(unexpected(&made).into()),
        }
    }

    /// The dataset in another format. The file has no name: it goes with the answer.
    pub async fn written(&self, id: Uuid, writer: &Writer) -> Result<WrittenFile, ServiceError> {
        let stored = self.stored(id).await?;
        let name = stored.file_name.clone();
        let name = name.unwrap_or_else(|| stored.info.name.clone());
        let located = Located::new(self.blobs.clone(), stored);
        let place = self.temp_dir().to_owned();
        let prepare = move || {
            let input = located.local()?;
            anyhow::Ok((input, tempfile::NamedTempFile::new_in(place)?))
        };
        let (input, file) = spawn_blocking(prepare)
            .await
            .context("fetching a file panicked")??;
        let order = Order::Write {
            input,
            format: writer.name.to_owned(),
            path: file.path().to_owned(),
        };
        match self.looks.ask(order, "writing the dataset").await? {
            Made::Written => {}
            made => return Err(unexpected(&made).into()),
        }
        let opened = spawn_blocking(move || file.reopen().context("a written file is gone"))
            .await
            .context("opening a file panicked")??;
        let stem = Path::new(&name).file_stem();
        let stem = stem.map_or_else(|| name.clone(), |stem| stem.to_string_lossy().into_owned());
        Ok(WrittenFile {
            file: opened,
            media_type: writer.media_type,
            file_name: format!("{stem}.{}", writer.extension),
        })
    }

    /// The content of a blob of so many bytes.
    pub async fn content(&self, sha256: &str, bytes: u64) -> Result<Content, ServiceError> {
        if let Some(known) = self.blobs.known(sha256) {
            return Ok(known);
        }
        let (blobs, sha256) = (self.blobs.clone(), sha256.to_owned());
        Ok(spawn_blocking(move || blobs.content(&sha256, bytes))
            .await
            .context("fetching a file panicked")??)
    }

    /// What to read the dataset from; `None` where there is none of that id.
    pub async fn locate(&self, id: &str) -> Result<Option<Located>, ServiceError> {
        let Ok(id) = Uuid::try_parse(id) else {
            return Ok(None);
        };
        let stored = self.storage.dataset(id).await?;
        Ok(stored
            .filter(|stored| !stored.deleted)
            .map(|stored| Located::new(self.blobs.clone(), stored)))
    }

    /// What is known of a recording. What an earlier version kept is read once more, and remembered.
    pub async fn facts_of(&self, id: Uuid) -> Result<Option<Known>, ServiceError> {
        let stored = self.storage.dataset(id).await?;
        let Some(stored) =
            stored.filter(|stored| !stored.deleted && stored.info.kind == DatasetKind::Detections)
        else {
            return Ok(None);
        };
        let sensors = stored.info.sensors.clone();
        let facts = match stored.facts.clone() {
            Some(facts) => Some(facts),
            None => {
                let summary = self.summarize(stored).await?;
                self.storage.note_summary(id, &summary).await?;
                summary.facts
            }
        };
        Ok(facts.map(|recording| Known { recording, sensors }))
    }

    /// Summarises a dataset that is kept already.
    async fn summarize(&self, stored: StoredDataset) -> Result<DatasetSummary, ServiceError> {
        let upload = Upload {
            path: self.local(&stored.info.sha256).await?,
            file_name: None,
            format: Some(stored.info.format),
            kind: Some(stored.info.kind),
            columns: stored.columns,
            options: stored.options,
            inspect: false,
        };
        Ok(self.check(upload).await?.summary)
    }

    /// A local file of the content.
    async fn local(&self, sha256: &str) -> Result<PathBuf, ServiceError> {
        let (blobs, sha256) = (self.blobs.clone(), sha256.to_owned());
        Ok(spawn_blocking(move || blobs.local(&sha256))
            .await
            .context("fetching a file panicked")??)
    }

    /// While the answer lives, nobody removes files, here or in another process.
    pub async fn no_sweeping(&self) -> anyhow::Result<NoSweepingHere<'_>> {
        Ok((
            self.sweeping.read().await,
            self.storage.no_sweeping().await?,
        ))
    }

    /// Removes contents that nothing has any more.
    pub async fn collect_garbage(&self, contents: Vec<String>) -> Result<(), ServiceError> {
        let _alone = (self.sweeping.write().await, self.storage.sweeping().await?);
        let mut unused = Vec::new();
        for sha256 in contents.into_iter().chain(self.blobs.left_over()?) {
            if !self.storage.blob_is_used(&sha256).await? {
                unused.push(sha256);
            }
        }
        let blobs = self.blobs.clone();
        Ok(spawn_blocking(move || blobs.remove(&unused))
            .await
            .context("removing files panicked")??)
    }
}

/// A received file as a child is told to look at it.
fn order_of(file: &ReceivedFile, meta: &DatasetMeta, inspect: bool) -> Upload {
    Upload {
        path: file.path.clone(),
        file_name: meta.file_name.clone(),
        format: meta.format.clone(),
        kind: meta.kind,
        columns: meta.columns.clone(),
        options: meta.options.clone(),
        inspect,
    }
}
