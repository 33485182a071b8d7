//! Keeping datasets: checked before they are kept, kept once, and swept up when nothing needs them.

use super::in_child::{LOOKS, UPLOADS, unexpected};
use super::read::refuse_any;
use super::submit::sorted;
use super::{DatasetFilter, DatasetMeta, Inner, JobsError, ReceivedFile, StoredFile};
use crate::formats::format_named;
use crate::model::dataset::DatasetSummary;
use crate::model::fault::Fault;
use crate::registry::control_character_fault;
use crate::service::child::{Made, Order, Upload};
use crate::service::storage::blobs::{Content, sha256_hex};
use crate::service::storage::{Cursor, NewDataset, NoSweeping, StoredDataset};
use crate::service::types::{DatasetInfo, DatasetPage};
use anyhow::Context;
use serde_json::json;
use serde_json::value::RawValue;
use tokio::sync::RwLockReadGuard;
use tokio::task::spawn_blocking;
use uuid::Uuid;

/// Guards against sweeping in this process and in others.
pub(super) type NoSweepingHere<'a> = (RwLockReadGuard<'a, ()>, NoSweeping);

impl Inner {
    pub(super) async fn add_dataset(
        &self,
        file: ReceivedFile,
        meta: DatasetMeta,
    ) -> Result<(DatasetInfo, bool), JobsError> {
        if self.closing.is_cancelled() {
            return Err(JobsError::ShuttingDown);
        }
        refuse_any(text_faults(&meta))?;
        let new = self.checked(&file, meta).await?;
        let _no_sweeping = self.no_sweeping().await?;
        let adopt = {
            let (blobs, ReceivedFile { path, sha256, .. }) = (self.blobs.clone(), file);
            move || blobs.adopt(&path, &sha256)
        };
        spawn_blocking(adopt)
            .await
            .context("keeping an upload panicked")??;
        let (id, is_new) = self.storage.add_dataset(&new).await?;
        Ok((self.stored_dataset(id).await?.info, is_new))
    }

    /// Has a child tell the format and read the file with it.
    async fn checked(
        &self,
        file: &ReceivedFile,
        meta: DatasetMeta,
    ) -> Result<NewDataset, JobsError> {
        let upload = Upload {
            path: file.path.clone(),
            file_name: meta.file_name.clone(),
            format: meta.format.clone(),
            kind: meta.kind,
            columns: meta.columns.clone(),
            bearing_time: meta.bearing_time,
        };
        let (format, summary, warnings) = self.check_file(upload).await?;
        Ok(new_dataset(file, meta, format, summary, warnings))
    }

    async fn check_file(
        &self,
        upload: Upload,
    ) -> Result<(String, DatasetSummary, Vec<String>), JobsError> {
        match self
            .ask(
                Order::Check(upload),
                (&self.uploads, UPLOADS),
                "reading the file",
            )
            .await?
        {
            Made::Checked {
                format,
                summary,
                warnings,
            } => Ok((format, summary, warnings)),
            made => Err(unexpected(&made).into()),
        }
    }

    /// Summarises a dataset that is kept already.
    pub(super) async fn summarize(
        &self,
        stored: StoredDataset,
    ) -> Result<DatasetSummary, JobsError> {
        let (blobs, sha256) = (self.blobs.clone(), stored.info.sha256.clone());
        let path = spawn_blocking(move || blobs.local(&sha256))
            .await
            .context("fetching a file panicked")??;
        let StoredDataset {
            info,
            columns,
            bearing_time,
            ..
        } = stored;
        let (format, kind) = (Some(info.format), Some(info.kind.into()));
        Ok(self
            .check_file(Upload {
                path,
                file_name: None,
                format,
                kind,
                columns,
                bearing_time,
            })
            .await?
            .1)
    }

    /// The dataset, unless there is none or it has been deleted.
    pub(super) async fn stored_dataset(&self, id: Uuid) -> Result<StoredDataset, JobsError> {
        let stored = self
            .storage
            .dataset(id)
            .await?
            .ok_or(JobsError::NotFound("dataset"))?;
        if stored.deleted {
            Err(JobsError::Gone("dataset"))
        } else {
            Ok(stored)
        }
    }

    pub(super) async fn list_datasets(
        &self,
        filter: DatasetFilter,
    ) -> Result<DatasetPage, JobsError> {
        refuse_any(filter.faults())?;
        let cursor = match &filter.cursor {
            Some(text) => Some(Cursor::decode(text, filter.sort).ok_or(JobsError::InvalidCursor)?),
            None => None,
        };
        let (items, next_cursor, total) = self.storage.datasets(&filter, cursor).await?;
        Ok(DatasetPage {
            items,
            next_cursor,
            total,
        })
    }

    pub(super) async fn delete_dataset(&self, id: Uuid) -> Result<(), JobsError> {
        let stored = self.stored_dataset(id).await?;
        let users = self.storage.delete_dataset(id).await?;
        if !users.is_empty() {
            return Err(JobsError::conflict(
                "in_use",
                format!("the dataset is needed by {}", listed(&users)),
            ));
        }
        self.collect_garbage(vec![stored.info.sha256]).await
    }

    pub(super) async fn dataset_content(&self, id: Uuid) -> Result<StoredFile, JobsError> {
        let StoredDataset {
            info, file_name, ..
        } = self.stored_dataset(id).await?;
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

    pub(super) async fn preview(&self, id: Uuid, rows: usize) -> Result<Box<RawValue>, JobsError> {
        let located = self.located(self.stored_dataset(id).await?);
        let input = spawn_blocking(|| located.local())
            .await
            .context("fetching a file panicked")??;
        match self
            .ask(
                Order::Preview { input, rows },
                (&self.looks, LOOKS),
                "reading the dataset",
            )
            .await?
        {
            Made::Preview(preview) => Ok(preview),
            made => Err(unexpected(&made).into()),
        }
    }

    /// The content of a blob of so many bytes.
    pub(super) async fn content(&self, sha256: &str, bytes: u64) -> Result<Content, JobsError> {
        if let Some(known) = self.blobs.known(sha256) {
            return Ok(known);
        }
        let (blobs, sha256) = (self.blobs.clone(), sha256.to_owned());
        Ok(spawn_blocking(move || blobs.content(&sha256, bytes))
            .await
            .context("fetching a file panicked")??)
    }

    /// While the answer lives, nobody sweeps, here or in another process.
    pub(super) async fn no_sweeping(&self) -> anyhow::Result<NoSweepingHere<'_>> {
        Ok((
            self.sweeping.read().await,
            self.storage.no_sweeping().await?,
        ))
    }

    /// Removes contents that nothing has any more.
    pub(super) async fn collect_garbage(&self, contents: Vec<String>) -> Result<(), JobsError> {
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

/// Ids for a sentence, not too many.
pub(super) fn listed(jobs: &[Uuid]) -> String {
    const MOST: usize = 5;
    let named = jobs
        .iter()
        .take(MOST)
        .map(|id| format!("job {id}"))
        .collect::<Vec<_>>()
        .join(", ");
    if jobs.len() > MOST {
        format!("{named} and {} more", jobs.len() - MOST)
    } else {
        named
    }
}

/// Names with characters that not every database keeps.
fn text_faults(meta: &DatasetMeta) -> Vec<Fault> {
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

fn new_dataset(
    file: &ReceivedFile,
    meta: DatasetMeta,
    format: String,
    summary: DatasetSummary,
    warnings: Vec<String>,
) -> NewDataset {
    let mut said = json!({
        "name": meta.name, "kind": summary.kind, "format": format, "columns": meta.columns, "sensors": meta.sensors
    });
    if let Some(axes) = meta.bearing_time {
        said["bearing_time"] = json!(axes);
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
        bearing_time: meta.bearing_time,
        summary,
        sensors: meta.sensors,
        warnings,
        origin_job_id: None,
        file_name: meta.file_name,
    }
}
