//! What happens when the queue says "look at this": claim it, have a child run it, write how it ended.

use super::Jobs;
use super::control::{Control, Stop, Work};
use super::submit::planned;
use crate::experiment::JobKind;
use crate::service::child::Failure;
use crate::service::child::{Made, MadeFile, Order, crash_text, unexpected};
use crate::service::datasets::NoSweepingHere;
use crate::service::datasets::local_files;
use crate::service::engine::Entry;
use crate::service::error::may_pass;
use crate::service::storage::blobs::{Blobs, Damaged, ReceivedFile};
use crate::service::storage::{Changed, Claim, ClaimedJob, Ending, NewArtifact};
use crate::service::types::{Problem, Progress};
use anyhow::{Context, bail, ensure};
use futures::FutureExt;
use futures::future::BoxFuture;
use std::sync::Arc;
use std::time::Duration;
use tempfile::TempDir;
use tokio::sync::OwnedSemaphorePermit;
use uuid::Uuid;

/// Writing the end of a job is tried this often, one second apart, where nobody knows why it fails. While the database is away or the
/// disk is full it is tried until the service stops.
const WRITE_TRIES: u32 = 60;

/// How often it is looked whether work that runs here has ended.
const AGAIN: Duration = Duration::from_millis(200);

/// What a job made, before it is kept; what is not kept goes with the directory.
pub(super) struct Product {
    pub files: Vec<MadeFile>,
    pub warnings: Vec<String>,
    pub directory: TempDir,
}

impl Jobs {
    /// Works off the entry if that is still to be done. Extra calls for the same work do nothing.
    pub(super) async fn handle_entry(self: Arc<Self>, entry: Entry) -> anyhow::Result<()> {
        let work = (entry.job_id, entry.chunk);
        // The queue took this process for dead and gives the entry out again: what runs here goes on, and is waited for, since an entry
        // that is answered is gone.
        while self.running.has(work) {
            tokio::select! {
                () = tokio::time::sleep(AGAIN) => {}
                () = self.closing.cancelled() => bail!("the service stops"),
            }
        }
        // What was running when a process died runs alone, so that it cannot take others with it.
        let crashes = match entry.chunk {
            None => self.storage.crashes(entry.job_id, entry.id).await?,
            Some(number) => {
                self.storage
                    .chunk_crashes(entry.job_id, number, entry.id)
                    .await?
            }
        };
        let slots = if crashes > 0 { self.config.slots } else { 1 };
        let permit = tokio::select! {
            permit = self.slots.clone().acquire_many_owned(u32::try_from(slots)?) => permit?,
            // An error leaves the entry to another process.
            () = self.closing.cancelled() => bail!("the service stops"),
        };
        ensure!(
            !self.running.has(work),
            "another entry has begun the same work meanwhile"
        );
        match entry.chunk {
            None => self.look_at_job(entry, permit).await,
            Some(number) => self.look_at_chunk(entry, number, permit).await,
        }
    }

    async fn look_at_job(&self, entry: Entry, permit: OwnedSemaphorePermit) -> anyhow::Result<()> {
        let id = entry.job_id;
        match self
            .storage
            .claim(id, entry.id, self.config.crash_limit)
            .await?
        {
            Claim::NotNow => Ok(()),
            Claim::Refused(changed) => {
                self.publish(changed).await;
                Ok(())
            }
            Claim::Run(job) if job.kind == JobKind::Campaign => self.start_campaign(&job).await,
            Claim::Run(job) => {
                self.announce(&[id]).await;
                let control = self.begin((id, None));
                let made = self.run(&job, &control, permit).await;
                let written = self.conclude(&job, &control, made).await;
                self.running.unregister((id, None));
                written
            }
        }
    }

    /// Registers work; where the service stops already, its stop sign is up from the start.
    pub(super) fn begin(&self, work: Work) -> Arc<Control> {
        let control = self.running.register(work);
        if self.closing.is_cancelled() {
            control.stop(Stop::ShuttingDown);
        }
        control
    }

    /// Makes what the job makes, with an ear for wishes that came before the stop sign was up.
    async fn run(
        &self,
        job: &ClaimedJob,
        control: &Control,
        permit: OwnedSemaphorePermit,
    ) -> Result<Product, Failure> {
        let stored = self.storage.job(job.id).await.map_err(Failure::Internal)?;
        if stored.is_some_and(|stored| stored.job.cancel_requested_at.is_some()) {
            control.stop(Stop::Canceled);
        }
        self.make(job, control, permit).await
    }

    /// Keeps what was made, and writes how the job ended; an error means that somebody has to run it again.
    async fn conclude(
        &self,
        job: &ClaimedJob,
        control: &Control,
        made: Result<Product, Failure>,
    ) -> anyhow::Result<()> {
        if let Ok(product) = &made {
            self.make_room_for(product).await;
        }
        // Until the end is written, the files belong to nobody; nobody may sweep them up meanwhile.
        let _no_sweeping = if made.is_ok() {
            Some(self.surely_no_sweeping().await?)
        } else {
            None
        };
        let kept = match made {
            Ok(product) => self.keep(product).await.map_err(Failure::Internal),
            Err(failure) => Err(failure),
        };
        let ending = kept.map_or_else(
            |failure| self.ending_of(job.id, "the job", control, failure),
            Some,
        );
        let changed = self
            .written(job.id, || match &ending {
                Some(ending) => self.storage.finish(job, ending).boxed(),
                None => self.storage.release(job).boxed(),
            })
            .await?;
        self.publish_or_do_again(changed, (job.id, None)).await
    }

    /// Tells of what was written. Where nothing was, because a database that died has forgotten the claim, an error has the queue give the
    /// entry out again: nobody else would.
    pub(super) async fn publish_or_do_again(
        &self,
        changed: Option<Changed>,
        (job_id, chunk): Work,
    ) -> anyhow::Result<()> {
        match changed {
            Some(changed) => self.publish(changed).await,
            None => ensure!(
                !self.storage.is_unclaimed(job_id, chunk).await?,
                "the database has forgotten who does it"
            ),
        }
        Ok(())
    }

    /// Old jobs go for what a job made; where that fails, it is kept all the same.
    async fn make_room_for(&self, product: &Product) {
        let bytes = product.files.iter().map(|file| file.bytes).sum();
        if let Err(error) = self.make_room(bytes).await {
            tracing::warn!(%error, "no room was made for a job");
        }
        self.room.note_more(bytes);
    }

    /// The guard, however often it has to be asked for: what was made is not thrown away.
    pub(super) async fn surely_no_sweeping(&self) -> anyhow::Result<NoSweepingHere<'_>> {
        let mut tries = 0;
        loop {
            match self.datasets.no_sweeping().await {
                Err(error) if self.may_try_again(&error, &mut tries) => {
                    tracing::warn!(error = format!("{error:#}"), "files wait to be kept");
                    tokio::time::sleep(Duration::from_secs(1)).await;
                }
                guard => return guard,
            }
        }
    }

    /// `None` hands the work back to the queue.
    pub(super) fn ending_of(
        &self,
        job_id: Uuid,
        what: &str,
        control: &Control,
        failure: Failure,
    ) -> Option<Ending> {
        match (failure, control.reason()) {
            (Failure::Stopped, Some(Stop::ShuttingDown)) => None,
            (Failure::Stopped, Some(Stop::TimeLimit)) => {
                let detail = format!(
                    "{what} ran longer than {} s",
                    self.config.job_time_limit.as_secs_f64()
                );
                failed(Problem::new("time_limit", detail))
            }
            (Failure::Stopped, _) => Some(Ending::Canceled),
            (Failure::Faults(faults), _) => failed(Problem::validation(faults)),
            (Failure::Memory, _) => failed(Problem::new("memory_limit", self.memory_text(what))),
            (Failure::Died(how), _) => failed(Problem::new("crashed", crash_text(what, &how))),
            (Failure::Internal(error), _) if may_pass(&error) => {
                tracing::warn!(%job_id, error = format!("{error:#}"), "the database or the disk was not there; the work is queued again");
                None
            }
            (Failure::Internal(error), _) if error.downcast_ref::<Damaged>().is_some() => {
                let detail = "a file that the job reads is damaged; the log says which";
                failed(Problem::new("damaged", detail))
            }
            (Failure::Internal(error), _) => {
                tracing::error!(%job_id, error = format!("{error:#}"), "a job failed inside the service");
                let detail = "the job failed inside the service; its log says why";
                failed(Problem::new("internal", detail))
            }
        }
    }

    async fn make(
        &self,
        job: &ClaimedJob,
        control: &Control,
        permit: OwnedSemaphorePermit,
    ) -> Result<Product, Failure> {
        let plan = planned(job.kind, job.spec.clone())
            .await?
            .map_err(Failure::Faults)?;
        let inputs = local_files(self.locate(&plan).await?).await?;
        let directory = self.directory()?;
        let order = Order::Job {
            id: job.id,
            kind: job.kind,
            spec: job.spec.clone(),
            inputs,
            directory: directory.path().to_owned(),
        };
        match self
            .in_child(job.id, order, control, permit, |progress| {
                self.tell(job, progress).boxed()
            })
            .await?
        {
            Made::Files { files, warnings } => Ok(Product {
                files,
                warnings,
                directory,
            }),
            made => Err(unexpected(&made).into()),
        }
    }

    /// A directory for what a child makes; it goes with its name.
    pub(super) fn directory(&self) -> anyhow::Result<TempDir> {
        TempDir::new_in(self.blobs.temporary()).context("cannot make a directory for files")
    }

    /// Progress that cannot be written is lost, not the job.
    async fn tell(&self, job: &ClaimedJob, progress: Progress) {
        match self.storage.progress(job.id, job.attempt, &progress).await {
            Ok(changed) => self.announce(&changed.unwrap_or_default().touched).await,
            Err(error) => tracing::warn!(job_id = %job.id, %error, "progress was not written"),
        }
    }

    /// Puts the files in place, however often that has to be tried: what was made is not thrown away.
    pub(super) async fn keep(&self, product: Product) -> anyhow::Result<Ending> {
        let Product {
            files,
            warnings,
            directory,
        } = product;
        let files = Arc::new(files);
        let mut tries = 0;
        let kept = loop {
            let (blobs, files) = (self.blobs.clone(), files.clone());
            match tokio::task::spawn_blocking(move || keep_all(&blobs, &files)).await? {
                // A bucket has tried for long by itself.
                Err(error) if may_pass(&error) && self.may_try_again(&error, &mut tries) => {
                    tracing::error!(
                        error = format!("{error:#}"),
                        "the files of a job were not kept; trying again"
                    );
                    tokio::time::sleep(Duration::from_secs(1)).await;
                }
                kept => break kept?,
            }
        };
        drop(directory);
        Ok(Ending::Succeeded {
            artifacts: kept,
            warnings,
        })
    }

    /// Whether what failed is tried once more. A service that stops has no time for what may take long.
    fn may_try_again(&self, error: &anyhow::Error, tries: &mut u32) -> bool {
        if self.closing.is_cancelled() {
            *tries += WRITE_TRIES / 2;
        } else if !may_pass(error) {
            *tries += 1;
        }
        *tries < WRITE_TRIES
    }

    /// Writes, however often that takes: nothing must stay `running` when nobody runs it. `None`: it had ended already.
    pub(super) async fn written<'a>(
        &self,
        job_id: Uuid,
        write: impl Fn() -> BoxFuture<'a, anyhow::Result<Option<Changed>>> + Send + Sync,
    ) -> anyhow::Result<Option<Changed>> {
        let mut tries = 0;
        loop {
            match write().await {
                Ok(Some(changed)) => return Ok(Some(changed)),
                Ok(None) => {
                    tracing::info!(%job_id, "it has ended already, by another copy or a wish; what this one made is dropped");
                    return Ok(None);
                }
                Err(error) => {
                    tracing::error!(%job_id, error = format!("{error:#}"), "the end of a piece of work was not written");
                    if !self.may_try_again(&error, &mut tries) {
                        return Err(error);
                    }
                }
            }
            tokio::time::sleep(Duration::from_secs(1)).await;
        }
    }
}

fn failed(problem: Problem) -> Option<Ending> {
    Some(Ending::Failed(problem))
}

/// Makes the files blobs. Blocks.
fn keep_all(blobs: &Blobs, files: &[MadeFile]) -> anyhow::Result<Vec<NewArtifact>> {
    let received = |file: &MadeFile| ReceivedFile {
        path: file.path.clone(),
        sha256: file.sha256.clone(),
        bytes: file.bytes,
    };
    let unsynced = blobs.adopt_all(&files.iter().map(received).collect::<Vec<_>>())?;
    let kept = files
        .iter()
        .zip(unsynced)
        .map(|(file, unsynced)| NewArtifact {
            name: file.name.clone(),
            media_type: file.media_type.clone(),
            bytes: file.bytes,
            sha256: file.sha256.clone(),
            dataset: file.dataset.clone(),
            sensors: file.sensors.clone(),
            unsynced,
        });
    Ok(kept.collect())
}
