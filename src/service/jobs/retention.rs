//! Old jobs make room for new ones.

use super::Jobs;
use crate::service::error::ServiceError;
use crate::service::storage::{Changed, Deletion, EndOfJob};
use crate::service::types::Usage;
use std::time::Duration;
use uuid::Uuid;

/// Jobs that are deleted before it is looked again how much room there is.
const BATCH: u64 = 50;
/// How much of the room is kept free for what comes until the next look.
const SPARE: u64 = 10;
/// A deleted job is "gone" for so long; then nobody knows of it.
pub(super) const TOMBSTONE_AGE: Duration = Duration::from_secs(30 * 24 * 3600);

impl Jobs {
    /// What is kept, and what may be.
    pub async fn usage(&self) -> Result<Usage, ServiceError> {
        let kept = self.storage.kept().await?;
        let (ended, pinned) = self.storage.ended_and_pinned().await?;
        Ok(Usage {
            files_bytes: kept.files_bytes,
            tables_bytes: kept.tables_bytes,
            max_data_bytes: self.config.max_data_bytes,
            ended_jobs: ended,
            pinned_jobs: pinned,
            keep_jobs: self.config.keep_jobs,
            disk_free_bytes: self.room.free_bytes(),
        })
    }

    /// Deletes jobs that have ended, the oldest first, while there are more than may be kept, or while what is kept leaves less room than wanted.
    pub(super) async fn retain(&self) -> anyhow::Result<()> {
        if let Some(most) = self.config.keep_jobs {
            let (ended, _) = self.storage.ended_and_pinned().await?;
            self.delete_oldest(ended.saturating_sub(most)).await?;
        }
        let Some(most) = self.config.max_data_bytes else {
            return Ok(());
        };
        self.shrink_to(most - most / SPARE).await
    }

    /// Makes room for so many bytes, as far as there are jobs that may go.
    pub async fn make_room(&self, bytes: u64) -> Result<(), ServiceError> {
        if let Some(most) = self.config.max_data_bytes
            && self.room.lacks(bytes)
        {
            self.shrink_to(most.saturating_sub(bytes)).await?;
        }
        Ok(())
    }

    async fn shrink_to(&self, most_bytes: u64) -> anyhow::Result<()> {
        loop {
            let kept_bytes = self.storage.kept().await?.bytes();
            self.room.note_kept(kept_bytes);
            if kept_bytes <= most_bytes || self.delete_oldest(BATCH).await? == 0 {
                return Ok(());
            }
        }
    }

    /// Deletes so many of the jobs that may go, with the datasets that they made; gives how many there were.
    async fn delete_oldest(&self, wanted: u64) -> anyhow::Result<u64> {
        let (mut deleted, mut contents) = (0, Vec::new());
        let mut after: EndOfJob = (i64::MIN, Uuid::nil());
        while deleted < wanted {
            let oldest = self.storage.oldest_ended(after, wanted - deleted).await?;
            let Some(last) = oldest.last() else {
                break;
            };
            after = *last;
            for (_, id) in oldest {
                // What somebody else still reads stays until the next time.
                if let Deletion::Deleted(of_job) = self.storage.delete_job(id).await? {
                    deleted += 1;
                    contents.extend(of_job);
                    contents.extend(self.delete_made_by(id).await?);
                    self.publish(Changed::touch(id)).await;
                }
            }
        }
        if deleted > 0 {
            tracing::info!(jobs = deleted, "old jobs were deleted to make room");
            self.datasets.collect_garbage(contents).await?;
        }
        Ok(deleted)
    }

    /// Deletes the datasets that a job made, where no job waits for them; gives their contents.
    async fn delete_made_by(&self, job: Uuid) -> anyhow::Result<Vec<String>> {
        let mut contents = Vec::new();
        for (id, sha256) in self.storage.datasets_made_by(job).await? {
            if self.storage.delete_dataset(id).await?.is_empty() {
                contents.push(sha256);
            }
        }
        Ok(contents)
    }
}
