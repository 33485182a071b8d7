//! From what a plan asks for to the files that hold it.

use super::{Failure, Inner, JobsError};
use crate::experiment::{InputRequest, Known, Plan, Source};
use crate::formats::npy::BearingTimeAxes;
use crate::model::dataset::{Dataset, DatasetKind};
use crate::model::fault::Fault;
use crate::model::sensor::SensorSettings;
use crate::service::child::InputFile;
use crate::service::storage::blobs::Blobs;
use crate::service::storage::{SourceId, SourceRef, StoredDataset};
use anyhow::Context;
use std::collections::BTreeMap;
use uuid::Uuid;

/// What to read an input from.
#[derive(Clone)]
pub(super) struct Located {
    blobs: Blobs,
    format: String,
    kind: DatasetKind,
    columns: BTreeMap<String, String>,
    bearing_time: Option<BearingTimeAxes>,
    sensors: Vec<SensorSettings>,
    sha256: String,
}

/// What the request reads, for the tables.
pub(super) fn source_refs(plan: &Plan) -> Vec<SourceRef> {
    let source_ref = |request: &InputRequest| {
        let id = match &request.source {
            Source::Dataset { dataset_id, .. } => SourceId::Dataset(dataset_id.clone()),
            Source::Job { job_id, .. } => SourceId::Job(job_id.clone()),
        };
        SourceRef {
            pointer: request.pointer.clone(),
            role: request.role,
            id,
        }
    };
    plan.inputs().iter().map(source_ref).collect()
}

impl Inner {
    /// Finds the file of each input, in the order of the plan; `None` where an optional one is absent.
    pub(super) async fn locate(&self, plan: &Plan) -> Result<Vec<Option<Located>>, JobsError> {
        let mut located = Vec::new();
        let mut faults = Vec::new();
        for request in plan.inputs() {
            let found = match &request.source {
                Source::Dataset { dataset_id, .. } => self.locate_dataset(dataset_id).await?,
                Source::Job { job_id, .. } => self.locate_artifact(job_id, request.role).await?,
            };
            if found.is_none() && !request.optional {
                faults.push(absent(request));
            }
            located.push(found);
        }
        if faults.is_empty() {
            Ok(located)
        } else {
            Err(JobsError::Invalid(faults))
        }
    }

    /// What is known of each input before it is loaded, in the order of the plan, and what cannot be known yet.
    pub(super) async fn known_of(
        &self,
        plan: &Plan,
    ) -> Result<(Vec<Option<Known>>, Vec<String>), JobsError> {
        let (mut known, mut unknown) = (Vec::new(), Vec::new());
        for request in plan.inputs() {
            let dataset = match &request.source {
                Source::Dataset { dataset_id, .. } => Uuid::try_parse(dataset_id).ok(),
                Source::Job { job_id, .. } => self.made_by(job_id, request.role).await?,
            };
            let found = match dataset {
                Some(id) if request.role == DatasetKind::Detections => self.facts_of(id).await?,
                _ => None,
            };
            if let (Source::Job { job_id, .. }, None, DatasetKind::Detections, false) =
                (&request.source, &found, request.role, request.optional)
            {
                unknown.push(format!(
                    "not checked: {}: job '{job_id}' has not made its detections yet",
                    request.pointer
                ));
            }
            known.push(found);
        }
        Ok((known, unknown))
    }

    /// The dataset of this role that a job has made.
    async fn made_by(&self, job_id: &str, role: DatasetKind) -> Result<Option<Uuid>, JobsError> {
        let Ok(id) = Uuid::try_parse(job_id) else {
            return Ok(None);
        };
        let name = format!("{}.csv", role.name());
        let artifacts = self.storage.artifacts(id).await?;
        Ok(artifacts
            .into_iter()
            .find(|artifact| artifact.name == name)
            .and_then(|artifact| artifact.dataset_id))
    }

    /// What is known of a recording. What an earlier version kept is read once more, and remembered.
    async fn facts_of(&self, id: Uuid) -> Result<Option<Known>, JobsError> {
        let Some(stored) = self
            .storage
            .dataset(id)
            .await?
            .filter(|stored| !stored.deleted)
        else {
            return Ok(None);
        };
        if stored.info.kind != DatasetKind::Detections {
            return Ok(None);
        }
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

    async fn locate_dataset(&self, id: &str) -> Result<Option<Located>, JobsError> {
        let Ok(id) = Uuid::try_parse(id) else {
            return Ok(None);
        };
        let dataset = self
            .storage
            .dataset(id)
            .await?
            .filter(|dataset| !dataset.deleted);
        Ok(dataset.map(|dataset| self.located(dataset)))
    }

    /// The artefact `<role>.csv` of the job; the tracks of a job that put tracks together are `system_tracks.csv`.
    pub(super) async fn locate_artifact(
        &self,
        job_id: &str,
        role: DatasetKind,
    ) -> Result<Option<Located>, JobsError> {
        let Ok(id) = Uuid::try_parse(job_id) else {
            return Ok(None);
        };
        let name = format!("{}.csv", role.name());
        let artifacts = self.storage.artifacts(id).await?;
        let is_of_role = |known: &str| {
            known == name || role == DatasetKind::Tracks && known == "system_tracks.csv"
        };
        let Some(artifact) = artifacts
            .into_iter()
            .find(|artifact| is_of_role(&artifact.name))
        else {
            return Ok(None);
        };
        let sensors = match artifact.dataset_id {
            // The row stays when the dataset is deleted, and the artefact keeps the file.
            Some(dataset_id) => self
                .storage
                .dataset(dataset_id)
                .await?
                .map(|dataset| dataset.info.sensors)
                .unwrap_or_default(),
            None => Vec::new(),
        };
        Ok(Some(Located {
            blobs: self.blobs.clone(),
            format: "csv".to_owned(),
            kind: role,
            columns: BTreeMap::new(),
            bearing_time: None,
            sensors,
            sha256: artifact.sha256,
        }))
    }

    pub(super) fn located(&self, dataset: StoredDataset) -> Located {
        let StoredDataset {
            info,
            columns,
            bearing_time,
            ..
        } = dataset;
        Located {
            blobs: self.blobs.clone(),
            format: info.format,
            kind: info.kind,
            columns,
            bearing_time,
            sensors: info.sensors,
            sha256: info.sha256,
        }
    }
}

/// Local files of what was located, fetched where they are elsewhere.
pub(super) async fn local_files(
    located: Vec<Option<Located>>,
) -> anyhow::Result<Vec<Option<InputFile>>> {
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

fn absent(request: &InputRequest) -> Fault {
    let role = request.role.name();
    match &request.source {
        Source::Dataset { dataset_id, .. } => Fault::new(
            format!("{}/dataset_id", request.pointer),
            "not_found",
            format!("there is no dataset '{dataset_id}'"),
        ),
        Source::Job { job_id, .. } => Fault::new(
            format!("{}/job_id", request.pointer),
            "not_found",
            format!("job '{job_id}' made no {role}"),
        ),
    }
}

impl Located {
    /// The file, fetched where it is elsewhere; to be opened soon. Blocks.
    pub(super) fn local(self) -> anyhow::Result<InputFile> {
        let Located {
            blobs,
            format,
            kind,
            columns,
            bearing_time,
            sensors,
            sha256,
        } = self;
        Ok(InputFile {
            path: blobs.local(&sha256)?,
            format,
            kind,
            columns,
            bearing_time,
            sensors,
            sha256,
        })
    }

    /// Reads the whole file. Blocks.
    pub(super) fn read(&self) -> Result<Dataset, JobsError> {
        self.clone()
            .local()?
            .read()
            .map_err(|failure| match failure {
                Failure::Faults(faults) => JobsError::Invalid(faults),
                failure => JobsError::Internal(anyhow::anyhow!(
                    "a stored file cannot be read: {failure:?}"
                )),
            })
    }

    pub(super) fn sensors(&self) -> &[SensorSettings] {
        &self.sensors
    }
}
