//! Keeping the disk in order behind the back of jobs: files that only the tables make safe are synced, and the tables' log is written back.

use super::Jobs;
use anyhow::Context;
use std::time::Duration;
use tokio::sync::oneshot;

/// Notes that nobody has dealt with for so long are of a process that died, with its machine perhaps.
const LEFT: Duration = Duration::from_secs(120);

impl Jobs {
    pub(super) async fn tidy(&self) -> anyhow::Result<()> {
        self.sync_blobs().await?;
        if self.lock.is_none() {
            self.restore_blobs(Some(LEFT)).await?;
        }
        self.storage.tidy().await
    }

    /// Syncs the files whose contents this process has noted, all at once, and forgets the contents.
    async fn sync_blobs(&self) -> anyhow::Result<()> {
        loop {
            let ids = self.storage.unsynced().await?;
            if ids.is_empty() {
                return Ok(());
            }
            let blobs = self.blobs.clone();
            on_a_thread(move || blobs.sync()).await?;
            self.storage.forget_unsynced(ids).await?;
        }
    }

    /// Looks at the files of notes that are at least so old, or of all, and writes those anew that are not whole: a power failure takes what was not
    /// synced.
    pub(super) async fn restore_blobs(&self, age: Option<Duration>) -> anyhow::Result<()> {
        loop {
            let left = self.storage.left_unsynced(age).await?;
            if left.is_empty() {
                return Ok(());
            }
            let _no_sweeping = self.datasets.no_sweeping().await?;
            let mut wanted = Vec::new();
            for blob in &left {
                if self.storage.blob_is_used(&blob.sha256).await? {
                    wanted.push(blob.clone());
                }
            }
            let blobs = self.blobs.clone();
            let restore = move || {
                wanted
                    .iter()
                    .try_for_each(|blob| blobs.restore(&blob.sha256, &blob.content))?;
                blobs.sync()
            };
            on_a_thread(restore).await?;
            self.storage
                .forget_unsynced(left.into_iter().map(|blob| blob.id).collect())
                .await?;
        }
    }
}

/// A thread of its own, not one of the runtime's: the process can end without waiting for a slow disk.
async fn on_a_thread(
    work: impl FnOnce() -> anyhow::Result<()> + Send + 'static,
) -> anyhow::Result<()> {
    let (sender, done) = oneshot::channel();
    let work = move || {
        // Nobody waits any more when the service has stopped.
        let _ = sender.send(work());
    };
    std::thread::Builder::new()
        .name("upkeep".to_owned())
        .spawn(work)
        .context("cannot start a thread")?;
    done.await.context("the upkeep of files panicked")?
}
