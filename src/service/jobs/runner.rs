//! What happens when the queue says "look at this": claim it, run it on a thread of its own, write how it ended.

use super::control::{CLOSING_GRACE, Control, Stop, Work};
use super::datasets::NoSweepingHere;
use super::error::may_pass;
use super::inputs::Located;
use super::meter::Meter;
use super::report::{self, ReportInput};
use super::submit::planned;
use super::{Inner, JobsError};
use crate::experiment::observer::{Observer, Step};
use crate::experiment::plan::{JobKind, Plan};
use crate::experiment::run::{self, Artifact, Inputs};
use crate::model::fault::Fault;
use crate::service::engine::Entry;
use crate::service::storage::blobs::{Blobs, Damaged};
use crate::service::storage::{Changed, Claim, ClaimedJob, Ending, NewArtifact};
use crate::service::types::{Problem, Progress};
use anyhow::{Context, anyhow, bail, ensure};
use futures::FutureExt;
use futures::future::BoxFuture;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::{OwnedSemaphorePermit, oneshot, watch};
use uuid::Uuid;

/// Writing the end of a job is tried this often, one second apart, where nobody knows why it fails. While the database is away or the
/// disk is full it is tried until the service stops.
const WRITE_TRIES: u32 = 60;

/// How often it is looked whether work that runs here has ended.
const AGAIN: Duration = Duration::from_millis(200);

/// What a job made, before it is kept.
pub(super) struct Product {
    pub artifacts: Vec<Artifact>,
    pub report: Vec<u8>,
    pub warnings: Vec<String>,
}

/// Why a job made nothing.
pub(super) enum Failure {
    Stopped,
    Faults(Vec<Fault>),
    Internal(anyhow::Error),
}

impl From<JobsError> for Failure {
    fn from(error: JobsError) -> Self {
        match error {
            JobsError::Invalid(faults) => Failure::Faults(faults),
            JobsError::Internal(error) => Failure::Internal(error),
            // Which of its errors it was is in the log.
            JobsError::Unavailable => Failure::Internal(sqlx::Error::PoolTimedOut.into()),
            JobsError::NoRoom(reason) => Failure::Internal(reason.into()),
            JobsError::Damaged(damaged) => Failure::Internal(damaged.into()),
            other => Failure::Internal(anyhow!(other)),
        }
    }
}

impl Inner {
    /// Works off the entry if that is still to be done. Extra calls for the same work do nothing.
    pub(super) async fn look(self: Arc<Self>, entry: Entry) -> anyhow::Result<()> {
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
            Some(number) => self.storage.chunk_crashes(entry.job_id, number, entry.id).await?,
        };
        let slots = if crashes > 0 { self.config.slots } else { 1 };
        let permit = tokio::select! {
            permit = self.slots.clone().acquire_many_owned(u32::try_from(slots)?) => permit?,
            // An error leaves the entry to another process.
            () = self.closing.cancelled() => bail!("the service stops"),
        };
        ensure!(!self.running.has(work), "another entry has begun the same work meanwhile");
        match entry.chunk {
            None => self.look_at_job(entry, permit).await,
            Some(number) => self.look_at_chunk(entry, number, permit).await,
        }
    }

    async fn look_at_job(&self, entry: Entry, permit: OwnedSemaphorePermit) -> anyhow::Result<()> {
        let id = entry.job_id;
        match self.storage.claim(id, entry.id, self.config.crash_limit).await? {
            Claim::NotNow => Ok(()),
            Claim::Refused(changed) => {
                self.publish(changed).await;
                Ok(())
            }
            Claim::Run(job) if job.kind == JobKind::Campaign => self.start_campaign(&job).await,
            Claim::Run(job) => {
                self.announce(&[id]).await;
                let control = self.begin((id, None));
                let made = self.attend(&job, &control, permit).await;
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
    async fn attend(&self, job: &ClaimedJob, control: &Arc<Control>, permit: OwnedSemaphorePermit) -> Result<Product, Failure> {
        let stored = self.storage.job(job.id).await.map_err(Failure::Internal)?;
        if stored.is_some_and(|stored| stored.job.cancel_requested_at.is_some()) {
            control.stop(Stop::Canceled);
        }
        self.make(job, control, permit).await
    }

    /// Keeps what was made, and writes how the job ended; an error means that somebody has to run it again.
    async fn conclude(&self, job: &ClaimedJob, control: &Control, made: Result<Product, Failure>) -> anyhow::Result<()> {
        // Until the end is written, the files belong to nobody; nobody may sweep them up meanwhile.
        let _no_sweeping = if made.is_ok() { Some(self.surely_no_sweeping().await?) } else { None };
        let kept = match made {
            Ok(product) => self.keep(product).await.map_err(Failure::Internal),
            Err(failure) => Err(failure),
        };
        let ending = kept.map_or_else(|failure| self.ending_of(job.id, "the job", control, failure), Some);
        let changed = self
            .written(job.id, || match &ending {
                Some(ending) => self.storage.finish(job, ending).boxed(),
                None => self.storage.release(job).boxed(),
            })
            .await?;
        self.publish(changed.unwrap_or_default()).await;
        Ok(())
    }

    /// The guard, however often it has to be asked for: what was made is not thrown away.
    pub(super) async fn surely_no_sweeping(&self) -> anyhow::Result<NoSweepingHere<'_>> {
        let mut tries = 0;
        loop {
            match self.no_sweeping().await {
                Err(error) if self.may_try_again(&error, &mut tries) => {
                    tracing::warn!(error = format!("{error:#}"), "files wait to be kept");
                    tokio::time::sleep(Duration::from_secs(1)).await;
                }
                guard => return guard,
            }
        }
    }

    /// `None` hands the work back to the queue.
    pub(super) fn ending_of(&self, job_id: Uuid, what: &str, control: &Control, failure: Failure) -> Option<Ending> {
        match (failure, control.reason()) {
            (Failure::Stopped, Some(Stop::ShuttingDown)) => None,
            (Failure::Stopped, Some(Stop::TimeLimit)) => {
                let detail = format!("{what} ran longer than {} s", self.config.job_time_limit.as_secs_f64());
                Some(Ending::Failed(Problem::new("time_limit", detail)))
            }
            (Failure::Stopped, _) => Some(Ending::Canceled),
            (Failure::Faults(faults), _) => Some(Ending::Failed(Problem::validation(faults))),
            (Failure::Internal(error), _) if may_pass(&error) => {
                tracing::warn!(%job_id, error = format!("{error:#}"), "the database or the disk was not there; the work is queued again");
                None
            }
            (Failure::Internal(error), _) if error.downcast_ref::<Damaged>().is_some() => {
                Some(Ending::Failed(Problem::new("damaged", "a file that the job reads is damaged; the log says which")))
            }
            (Failure::Internal(error), _) => {
                tracing::error!(%job_id, error = format!("{error:#}"), "a job failed inside the service");
                Some(Ending::Failed(Problem::new("internal", "the job failed inside the service; its log says why")))
            }
        }
    }

    async fn make(&self, job: &ClaimedJob, control: &Arc<Control>, permit: OwnedSemaphorePermit) -> Result<Product, Failure> {
        let plan = planned(job.kind, job.spec.clone()).await?.map_err(Failure::Faults)?;
        let located = self.locate(&plan).await?;
        let id = job.id;
        let work = move |meter: Meter| work(id, &plan, located, meter);
        self.on_thread(id, job.kind, control, permit, work, |progress| self.tell(job, progress).boxed()).await
    }

    /// Does `work` on a thread of its own, and `tell`s how far it is.
    pub(super) async fn on_thread<'a, T: Send + 'static>(
        &self,
        job_id: Uuid,
        kind: JobKind,
        control: &Arc<Control>,
        permit: OwnedSemaphorePermit,
        work: impl FnOnce(Meter) -> Result<T, Failure> + Send + 'static,
        tell: impl Fn(Option<Progress>) -> BoxFuture<'a, ()> + Send + Sync,
    ) -> Result<T, Failure> {
        let (news, told) = watch::channel(None);
        let meter = Meter::new(kind, control.sign(), news);
        let (sender, made) = oneshot::channel();
        let work = move || {
            // The slot is free again when the thread has really ended, also when nobody waits for it any more.
            let _permit = permit;
            let made = catch_unwind(AssertUnwindSafe(|| work(meter)));
            let _ = sender.send(made.unwrap_or_else(|_| Err(Failure::Internal(anyhow!("the job panicked")))));
        };
        // A thread of its own, not one of the runtime's: the process can end without waiting for it.
        std::thread::Builder::new().name("job".to_owned()).spawn(work).context("cannot start a thread").map_err(Failure::Internal)?;
        self.watch_over(job_id, control, made, told, tell).await
    }

    async fn watch_over<'a, T>(
        &self,
        job_id: Uuid,
        control: &Control,
        mut made: oneshot::Receiver<Result<T, Failure>>,
        mut told: watch::Receiver<Option<Progress>>,
        tell: impl Fn(Option<Progress>) -> BoxFuture<'a, ()> + Send + Sync,
    ) -> Result<T, Failure> {
        let limit = tokio::time::sleep(self.config.job_time_limit);
        let grace_over = async {
            tokio::select! {
                () = control.grace_over() => {}
                () = async { self.closing.cancelled().await; tokio::time::sleep(CLOSING_GRACE).await } => {}
            }
        };
        tokio::pin!(limit, grace_over);
        loop {
            tokio::select! {
                made = &mut made => return made.unwrap_or_else(|_| Err(Failure::Internal(anyhow!("the job's thread vanished")))),
                () = &mut grace_over => {
                    tracing::warn!(%job_id, "a job did not stop when asked; leaving it to itself");
                    return Err(Failure::Stopped);
                }
                () = &mut limit, if control.reason().is_none() => control.stop(Stop::TimeLimit),
                Ok(()) = told.changed() => {
                    let progress = told.borrow_and_update().clone();
                    tell(progress).await;
                }
            }
        }
    }

    /// Progress that cannot be written is lost, not the job.
    async fn tell(&self, job: &ClaimedJob, progress: Option<Progress>) {
        let Some(progress) = progress else { return };
        match self.storage.progress(job.id, job.attempt, &progress).await {
            Ok(changed) => self.announce(&changed.unwrap_or_default().touched).await,
            Err(error) => tracing::warn!(job_id = %job.id, %error, "progress was not written"),
        }
    }

    /// Puts the files in place, however often that has to be tried: what was made is not thrown away.
    pub(super) async fn keep(&self, product: Product) -> anyhow::Result<Ending> {
        let Product { mut artifacts, report, warnings } = product;
        artifacts.push(Artifact::file("report.json", "application/json", report));
        let artifacts = Arc::new(artifacts);
        let mut tries = 0;
        loop {
            let (blobs, artifacts) = (self.blobs.clone(), artifacts.clone());
            match tokio::task::spawn_blocking(move || keep_all(&blobs, &artifacts)).await? {
                Err(error) if self.may_try_again(&error, &mut tries) => {
                    tracing::error!(error = format!("{error:#}"), "the files of a job were not kept; trying again");
                    tokio::time::sleep(Duration::from_secs(1)).await;
                }
                kept => return Ok(Ending::Succeeded { artifacts: kept?, warnings }),
            }
        }
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

/// Makes the files blobs. Blocks.
fn keep_all(blobs: &Blobs, artifacts: &[Artifact]) -> anyhow::Result<Vec<NewArtifact>> {
    let received = blobs.receive_all(artifacts.iter().map(|artifact| artifact.bytes.as_slice()))?;
    let unsynced = blobs.adopt_all(&received).inspect_err(|_| blobs.discard(&received))?;
    let kept = artifacts.iter().zip(received).zip(unsynced).map(|((artifact, file), unsynced)| NewArtifact {
        name: artifact.name.to_owned(),
        media_type: artifact.media_type.to_owned(),
        bytes: file.bytes,
        sha256: file.sha256,
        dataset: artifact.dataset.clone(),
        sensors: artifact.sensors.clone(),
        unsynced,
    });
    Ok(kept.collect())
}

/// Loads, runs and reports. Blocks, and stops soon after the stop sign is up.
fn work(id: Uuid, plan: &Plan, located: Vec<Option<Located>>, mut meter: Meter) -> Result<Product, Failure> {
    let (inputs, read) = load(plan, located, &mut meter)?;
    let outcome = run::run(plan, inputs, &mut meter)?;
    let report = report::build(id, plan, &read, &outcome, meter.timing()).map_err(|error| Failure::Internal(error.into()))?;
    Ok(Product { artifacts: outcome.artifacts, report, warnings: outcome.warnings })
}

pub(super) fn load(plan: &Plan, located: Vec<Option<Located>>, meter: &mut Meter) -> Result<(Inputs, Vec<ReportInput>), Failure> {
    let total = located.len() as u64;
    let (mut inputs, mut read) = (Vec::new(), Vec::new());
    for (done, (request, located)) in plan.inputs.iter().zip(located).enumerate() {
        if meter.progress(Step::Load, done as u64, total).is_break() {
            return Err(Failure::Stopped);
        }
        let input = located.map(|located| located.load(request)).transpose()?;
        read.extend(input.as_ref().map(|input| ReportInput::new(request, input)));
        inputs.push(input);
    }
    if meter.progress(Step::Load, total, total).is_break() {
        return Err(Failure::Stopped);
    }
    Ok((inputs, read))
}
