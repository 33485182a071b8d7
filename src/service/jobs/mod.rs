//! Submitting, running, waiting for and cancelling jobs, and keeping datasets: the facade of everything behind HTTP.

mod error;
mod request;

pub use error::JobsError;
pub use request::*;

use super::config::Config;
use super::types::{ArtifactList, DatasetInfo, DatasetPage, Event, EventPage, Job, JobKind, JobPage, JobState};
use crate::model::dataset::Dataset;
use futures::Stream;
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;
use uuid::Uuid;

/// The jobs and datasets of one data directory, with the workers that run the jobs. Clones share everything.
#[derive(Clone)]
pub struct Jobs(Arc<Config>);

impl Jobs {
    /// Opens the data directory, takes up what an earlier process left, and starts the workers.
    ///
    /// # Errors
    /// When another process uses the directory, or it cannot be read or written.
    pub async fn open(config: Config) -> anyhow::Result<Jobs> {
        Ok(Jobs(Arc::new(config)))
    }

    /// Where uploads are received: on the same file system as the blobs.
    pub fn temp_dir(&self) -> &Path {
        &self.0.data_dir
    }

    /// Checks a request and queues its job. A key that was used for the same request gives the job of that time.
    pub async fn submit(&self, kind: JobKind, body: Value, idempotency_key: Option<String>) -> Result<Submitted, JobsError> {
        let _ = (kind, body, idempotency_key);
        unimplemented!()
    }

    /// The same checks as [`Self::submit`], without a job.
    pub async fn validate(&self, kind: JobKind, body: Value) -> Result<Validation, JobsError> {
        let _ = (kind, body);
        unimplemented!()
    }

    pub async fn get(&self, id: Uuid) -> Result<Job, JobsError> {
        let _ = id;
        unimplemented!()
    }

    pub async fn list(&self, filter: JobFilter) -> Result<JobPage, JobsError> {
        let _ = filter;
        unimplemented!()
    }

    /// How many jobs are in each state.
    pub async fn counts(&self) -> Result<BTreeMap<JobState, u64>, JobsError> {
        unimplemented!()
    }

    pub async fn patch(&self, id: Uuid, patch: JobPatch) -> Result<Job, JobsError> {
        let _ = (id, patch);
        unimplemented!()
    }

    /// Deletes a job that has ended, with its files; datasets that it made stay.
    pub async fn delete(&self, id: Uuid) -> Result<(), JobsError> {
        let _ = id;
        unimplemented!()
    }

    /// Asks a job to stop: a queued one is canceled at once, a running one as soon as it notices.
    pub async fn cancel(&self, id: Uuid) -> Result<Job, JobsError> {
        let _ = id;
        unimplemented!()
    }

    /// Queues a new job with the spec of this one.
    pub async fn rerun(&self, id: Uuid) -> Result<Job, JobsError> {
        let _ = id;
        unimplemented!()
    }

    /// The job as soon as it has ended, or as it is after `patience`.
    pub async fn wait(&self, id: Uuid, patience: Duration) -> Result<Job, JobsError> {
        let _ = (id, patience);
        unimplemented!()
    }

    /// Events after number `after`; if there are none yet, waits up to `patience` for one.
    pub async fn history(&self, id: Uuid, after: u64, patience: Duration) -> Result<EventPage, JobsError> {
        let _ = (id, after, patience);
        unimplemented!()
    }

    /// Events after number `after` as they happen; ends after the last one, and when the service stops.
    pub async fn events(&self, id: Uuid, after: u64) -> Result<impl Stream<Item = Event> + Send + use<>, JobsError> {
        let _ = (id, after);
        Ok(futures::stream::empty())
    }

    pub async fn report(&self, id: Uuid) -> Result<StoredFile, JobsError> {
        let _ = id;
        unimplemented!()
    }

    pub async fn artifacts(&self, id: Uuid) -> Result<ArtifactList, JobsError> {
        let _ = id;
        unimplemented!()
    }

    pub async fn artifact(&self, id: Uuid, name: &str) -> Result<StoredFile, JobsError> {
        let _ = (id, name);
        unimplemented!()
    }

    /// The job's request as normalised.
    pub async fn spec(&self, id: Uuid) -> Result<Value, JobsError> {
        let _ = id;
        unimplemented!()
    }

    /// The data behind the pictures of a job.
    pub async fn load_job_layers(&self, id: Uuid) -> Result<JobLayers, JobsError> {
        let _ = id;
        unimplemented!()
    }

    /// Checks a received file and keeps it. The same content with the same meta gives the dataset that exists, and `false`.
    pub async fn add_dataset(&self, file: ReceivedFile, meta: DatasetMeta) -> Result<(DatasetInfo, bool), JobsError> {
        let _ = (file, meta);
        unimplemented!()
    }

    pub async fn dataset(&self, id: Uuid) -> Result<DatasetInfo, JobsError> {
        let _ = id;
        unimplemented!()
    }

    pub async fn list_datasets(&self, filter: DatasetFilter) -> Result<DatasetPage, JobsError> {
        let _ = filter;
        unimplemented!()
    }

    /// Deletes a dataset, unless a queued or running job needs it.
    pub async fn delete_dataset(&self, id: Uuid) -> Result<(), JobsError> {
        let _ = id;
        unimplemented!()
    }

    pub async fn dataset_content(&self, id: Uuid) -> Result<StoredFile, JobsError> {
        let _ = id;
        unimplemented!()
    }

    /// The dataset as read from its file.
    pub async fn load_dataset(&self, id: Uuid) -> Result<Dataset, JobsError> {
        let _ = id;
        unimplemented!()
    }

    /// Whether [`Self::shutdown`] has begun.
    pub fn is_shutting_down(&self) -> bool {
        false
    }

    /// Takes no more work, hands running jobs back to the queue, and returns when all is written.
    pub async fn shutdown(&self) {}
}
