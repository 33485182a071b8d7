//! Looking at jobs: one, many, their files, and what happens to them while someone waits.

use super::{JobFilter, Jobs};
use crate::experiment::Estimates;
use crate::experiment::job_shape::with_kind;
use crate::model::dataset::{Dataset, DatasetKind};
use crate::model::fault::Fault;
use crate::service::datasets::{Located, StoredFile};
use crate::service::error::{ServiceError, cursor_of, refuse_any};
use crate::service::storage::{Page, StoredArtifact};
use crate::service::types::{ArtifactInfo, ArtifactList, Event, EventPage, Job, JobPage, JobState};
use crate::service::views::layers::JobLayers;
use crate::service::views::metrics::MetricTable;
use anyhow::{Context, anyhow};
use futures::Stream;
use serde_json::Value;
use std::collections::VecDeque;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::watch;
use tokio::time::{Instant, timeout_at};
use uuid::Uuid;

impl Jobs {
    /// The job, unless there is none or it has been deleted.
    pub async fn get(&self, id: Uuid) -> Result<Job, ServiceError> {
        let stored = self
            .storage
            .job(id)
            .await?
            .ok_or(ServiceError::NotFound("job"))?;
        if stored.deleted {
            Err(ServiceError::Gone("job"))
        } else {
            Ok(stored.job)
        }
    }

    pub async fn list(&self, filter: JobFilter) -> Result<JobPage, ServiceError> {
        refuse_any(filter.faults())?;
        let after = cursor_of(&filter.paging)?;
        let Page {
            items,
            next_cursor,
            total,
        } = self.storage.jobs(&filter, after).await?;
        Ok(JobPage {
            items,
            next_cursor,
            total,
        })
    }

    /// The job as soon as it has ended, or as it is after `patience`.
    pub async fn wait(&self, id: Uuid, patience: Duration) -> Result<Job, ServiceError> {
        let deadline = Instant::now() + patience;
        let mut news = self.hub.subscribe(id);
        loop {
            let job = self.get(id).await?;
            if job.state.is_terminal() || !self.news_before(deadline, &mut news).await {
                return Ok(job);
            }
        }
    }

    /// Events after number `after`; if there are none yet, waits up to `patience` for one.
    pub async fn history(
        &self,
        id: Uuid,
        after: u64,
        patience: Duration,
    ) -> Result<EventPage, ServiceError> {
        let deadline = Instant::now() + patience;
        let mut news = self.hub.subscribe(id);
        loop {
            let job = self.get(id).await?;
            let events = self.storage.events(id, after).await?;
            if !events.is_empty()
                || job.state.is_terminal()
                || !self.news_before(deadline, &mut news).await
            {
                return Ok(EventPage {
                    next_after: events.last().map_or(after, Event::seq),
                    events,
                });
            }
        }
    }

    /// Events after number `after` as they happen; ends after the last one, and when the service stops.
    pub async fn events(
        self: &Arc<Self>,
        id: Uuid,
        after: u64,
    ) -> Result<impl Stream<Item = Event> + Send + use<>, ServiceError> {
        self.get(id).await?;
        let reading = Reading {
            jobs: self.clone(),
            id,
            after,
            read: VecDeque::new(),
            news: self.hub.subscribe(id),
            is_over: false,
        };
        Ok(futures::stream::unfold(reading, |mut reading| async move {
            let event = reading.next().await?;
            reading.after = event.seq();
            reading.is_over = event.is_last();
            Some((event, reading))
        }))
    }

    /// Waits for news; `false` when the time is up or the service stops.
    async fn news_before(&self, deadline: Instant, news: &mut watch::Receiver<()>) -> bool {
        tokio::select! {
            heard = timeout_at(deadline, news.changed()) => matches!(heard, Ok(Ok(()))),
            () = self.closing.cancelled() => false,
        }
    }

    pub async fn artifacts(&self, id: Uuid) -> Result<ArtifactList, ServiceError> {
        self.get(id).await?;
        let info = |artifact: StoredArtifact| ArtifactInfo {
            href: format!("/v1/jobs/{id}/artifacts/{}", artifact.name),
            name: artifact.name,
            media_type: artifact.media_type,
            bytes: artifact.bytes,
            sha256: artifact.sha256,
            dataset_id: artifact.dataset_id,
        };
        Ok(ArtifactList {
            items: self
                .storage
                .artifacts(id)
                .await?
                .into_iter()
                .map(info)
                .collect(),
        })
    }

    pub async fn artifact(&self, id: Uuid, name: &str) -> Result<StoredFile, ServiceError> {
        let StoredArtifact {
            name,
            media_type,
            bytes,
            sha256,
            ..
        } = self.stored_artifact(id, name).await?;
        Ok(StoredFile {
            content: self.datasets.content(&sha256, bytes).await?,
            media_type,
            bytes,
            sha256,
            file_name: name,
        })
    }

    /// The dataset that a file of a job is.
    pub async fn dataset_of_artifact(&self, id: Uuid, name: &str) -> Result<Uuid, ServiceError> {
        let artifact = self.stored_artifact(id, name).await?;
        artifact.dataset_id.ok_or_else(|| {
            let detail = format!("the file '{name}' is no dataset: it has one format");
            ServiceError::Invalid(vec![Fault::new("/query/format", "unsupported", detail)])
        })
    }

    async fn stored_artifact(&self, id: Uuid, name: &str) -> Result<StoredArtifact, ServiceError> {
        self.ended_well(id).await?;
        let artifacts = self.storage.artifacts(id).await?;
        let found = artifacts.iter().find(|artifact| artifact.name == name);
        found.cloned().ok_or_else(|| {
            let known: Vec<&str> = artifacts
                .iter()
                .map(|artifact| artifact.name.as_str())
                .collect();
            ServiceError::NotThere(format!(
                "the job has no file '{name}'; it has {}",
                known.join(", ")
            ))
        })
    }

    pub async fn report(&self, id: Uuid) -> Result<StoredFile, ServiceError> {
        self.artifact(id, "report.json").await
    }

    /// The job's request as normalised, with its kind.
    pub async fn spec(&self, id: Uuid) -> Result<Value, ServiceError> {
        let job = self.get(id).await?;
        Ok(with_kind(job.kind, &self.storage.spec(id).await?))
    }

    /// Refuses a job that has no results.
    pub(super) async fn ended_well(&self, id: Uuid) -> Result<(), ServiceError> {
        match self.get(id).await?.state {
            JobState::Succeeded => Ok(()),
            state @ (JobState::Queued | JobState::Running) => Err(ServiceError::conflict(
                "result_not_ready",
                format!("the job is {}", state.name()),
            )),
            JobState::Failed => Err(ServiceError::conflict(
                "job_failed",
                "the job failed; its error says why",
            )),
            JobState::Canceled => Err(ServiceError::conflict("job_failed", "the job was canceled")),
        }
    }

    /// The data behind the pictures of a job that ended well.
    pub async fn load_job_layers(&self, id: Uuid) -> Result<Arc<JobLayers>, ServiceError> {
        self.ended_well(id).await?;
        let artifacts = self.storage.artifacts(id).await?;
        let bytes = artifacts
            .iter()
            .filter(|artifact| artifact.dataset_id.is_some())
            .map(|artifact| artifact.bytes)
            .sum();
        self.recent
            .get(id, bytes, || self.read_layers(id, artifacts))
            .await
    }

    async fn read_layers(
        &self,
        id: Uuid,
        artifacts: Vec<StoredArtifact>,
    ) -> Result<JobLayers, ServiceError> {
        let mut files = Vec::new();
        // Of a bearing-time record the job has a picture.
        for kind in [
            DatasetKind::Detections,
            DatasetKind::Truth,
            DatasetKind::Tracks,
        ] {
            files.extend(
                self.locate_artifact(&id.to_string(), (kind, Estimates::Filtered))
                    .await?,
            );
        }
        let spec = self.storage.spec(id).await?;
        let metrics = artifacts
            .into_iter()
            .find(|artifact| artifact.name == METRIC_SERIES);
        let blobs = self.blobs.clone();
        let read = move || {
            let metrics = metrics
                .map(|artifact| blobs.local(&artifact.sha256))
                .transpose()?;
            read_files(spec, &files, metrics)
        };
        tokio::task::spawn_blocking(read)
            .await
            .context("reading a job's files panicked")?
    }
}

/// Reads the files side by side. Blocks.
fn read_files(
    spec: Value,
    files: &[Located],
    metrics: Option<PathBuf>,
) -> Result<JobLayers, ServiceError> {
    let mut layers = JobLayers {
        spec,
        ..JobLayers::default()
    };
    if let Some(path) = metrics {
        let bytes =
            std::fs::read(&path).with_context(|| format!("cannot read {}", path.display()))?;
        layers.metrics =
            MetricTable::read(&bytes).with_context(|| format!("{METRIC_SERIES} is damaged"))?;
    }
    let datasets = std::thread::scope(|scope| {
        let readers: Vec<_> = files
            .iter()
            .map(|file| scope.spawn(|| file.read()))
            .collect();
        readers
            .into_iter()
            .map(|reader| {
                reader
                    .join()
                    .map_err(|_| anyhow!("reading a file panicked"))?
            })
            .collect::<Result<Vec<_>, ServiceError>>()
    })?;
    for (file, dataset) in files.iter().zip(datasets) {
        match dataset {
            Dataset::Detections(recording) => {
                layers.detections = Some(recording);
                layers.sensors = file.content.sensors.clone();
            }
            Dataset::Truth(truth) => layers.truth = Some(truth),
            Dataset::Tracks(tracks) => layers.tracks = Some(tracks),
            // Boxes live in a picture, not in the plane.
            Dataset::TruthBoxes(_) | Dataset::TrackBoxes(_) | Dataset::BearingTime(_) => {}
        }
    }
    Ok(layers)
}

/// The file from which the series `metrics` comes.
pub(super) const METRIC_SERIES: &str = "metric-series.csv";
pub(super) const METRIC_TRUTHS: &str = "metric-truths.csv";

/// Where a reader of live events is.
struct Reading {
    jobs: Arc<Jobs>,
    id: Uuid,
    after: u64,
    read: VecDeque<Event>,
    news: watch::Receiver<()>,
    is_over: bool,
}

impl Reading {
    async fn next(&mut self) -> Option<Event> {
        while !self.is_over {
            if let Some(event) = self.read.pop_front() {
                return Some(event);
            }
            // Asked before the events are read, so that none can slip in between.
            let has_ended = self.has_ended().await;
            match self.jobs.storage.events(self.id, self.after).await {
                Ok(events) if events.is_empty() => {
                    self.is_over = has_ended || !self.hears_more().await
                }
                Ok(events) => self.read.extend(events),
                Err(error) => {
                    tracing::warn!(job_id = %self.id, %error, "events could not be read");
                    self.is_over = true;
                }
            }
        }
        None
    }

    /// Nothing will ever come: the reader already knew the last event, or the job has been deleted.
    async fn has_ended(&self) -> bool {
        self.jobs
            .get(self.id)
            .await
            .map_or(true, |job| job.state.is_terminal())
    }

    async fn hears_more(&mut self) -> bool {
        tokio::select! {
            heard = self.news.changed() => heard.is_ok(),
            () = self.jobs.closing.cancelled() => false,
        }
    }
}
