//! From what a plan asks for to loaded datasets.

use super::{Inner, JobsError};
use crate::experiment::known_data::Known;
use crate::experiment::plan::{InputRequest, Plan, Source};
use crate::experiment::run::Input;
use crate::formats::{Format, ReadOptions, ReadOutcome, format_named};
use crate::model::dataset::{Dataset, DatasetKind};
use crate::model::fault::Fault;
use crate::model::sensor::SensorSettings;
use crate::service::storage::blobs::Blobs;
use crate::service::storage::{SourceId, SourceRef, StoredDataset};
use anyhow::Context;
use std::fs::File;
use std::io::BufReader;
use std::path::Path;
use uuid::Uuid;

/// What to read an input from.
#[derive(Clone)]
pub(super) struct Located {
    blobs: Blobs,
    format: &'static Format,
    options: ReadOptions,
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
        SourceRef { pointer: request.pointer.clone(), role: request.role, id }
    };
    plan.inputs.iter().map(source_ref).collect()
}

impl Inner {
    /// Finds the file of each input, in the order of the plan; `None` where an optional one is absent.
    pub(super) async fn locate(&self, plan: &Plan) -> Result<Vec<Option<Located>>, JobsError> {
        let mut located = Vec::new();
        let mut faults = Vec::new();
        for request in &plan.inputs {
            let found = match &request.source {
                Source::Dataset { dataset_id, .. } => self.locate_dataset(dataset_id).await?,
                Source::Job { job_id, .. } => self.locate_artifact(job_id, request.role).await?,
            };
            if found.is_none() && !request.optional {
                faults.push(absent(request));
            }
            located.push(found);
        }
        if faults.is_empty() { Ok(located) } else { Err(JobsError::Invalid(faults)) }
    }

    /// What is known of each input before it is loaded, in the order of the plan, and what cannot be known yet.
    pub(super) async fn known_of(&self, plan: &Plan) -> Result<(Vec<Option<Known>>, Vec<String>), JobsError> {
        let (mut known, mut unknown) = (Vec::new(), Vec::new());
        for request in &plan.inputs {
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
                unknown.push(format!("not checked: {}: job '{job_id}' has not made its detections yet", request.pointer));
            }
            known.push(found);
        }
        Ok((known, unknown))
    }

    /// The dataset of this role that a job has made.
    async fn made_by(&self, job_id: &str, role: DatasetKind) -> Result<Option<Uuid>, JobsError> {
        let Ok(id) = Uuid::try_parse(job_id) else { return Ok(None) };
        let name = format!("{}.csv", role.name());
        let artifacts = self.storage.artifacts(id).await?;
        Ok(artifacts.into_iter().find(|artifact| artifact.name == name).and_then(|artifact| artifact.dataset_id))
    }

    /// What is known of a recording. What an earlier version kept is read once more, and remembered.
    async fn facts_of(&self, id: Uuid) -> Result<Option<Known>, JobsError> {
        let Some(stored) = self.storage.dataset(id).await?.filter(|stored| !stored.deleted) else { return Ok(None) };
        if stored.info.kind != DatasetKind::Detections.into() {
            return Ok(None);
        }
        let sensors = stored.info.sensors.iter().cloned().map(Into::into).collect();
        let facts = match stored.facts.clone() {
            Some(facts) => Some(facts),
            None => {
                let summary = self.load_dataset(id).await?.summary();
                self.storage.note_summary(id, &summary).await?;
                summary.facts
            }
        };
        Ok(facts.map(|recording| Known { recording, sensors }))
    }

    async fn locate_dataset(&self, id: &str) -> Result<Option<Located>, JobsError> {
        let Ok(id) = Uuid::try_parse(id) else { return Ok(None) };
        let dataset = self.storage.dataset(id).await?.filter(|dataset| !dataset.deleted);
        Ok(dataset.map(|dataset| self.located(dataset)).transpose()?)
    }

    /// The artefact `<role>.csv` of the job; the tracks of a job that put tracks together are `system_tracks.csv`.
    pub(super) async fn locate_artifact(&self, job_id: &str, role: DatasetKind) -> Result<Option<Located>, JobsError> {
        let Ok(id) = Uuid::try_parse(job_id) else { return Ok(None) };
        let name = format!("{}.csv", role.name());
        let artifacts = self.storage.artifacts(id).await?;
        let is_of_role = |known: &str| known == name || role == DatasetKind::Tracks && known == "system_tracks.csv";
        let Some(artifact) = artifacts.into_iter().find(|artifact| is_of_role(&artifact.name)) else { return Ok(None) };
        let sensors = match artifact.dataset_id {
            // The row stays when the dataset is deleted, and the artefact keeps the file.
            Some(dataset_id) => self.storage.dataset(dataset_id).await?.map(|dataset| dataset.info.sensors).unwrap_or_default(),
            None => Vec::new(),
        };
        Ok(Some(Located {
            blobs: self.blobs.clone(),
            format: format_named("csv").context("the format csv is missing")?,
            options: ReadOptions { kind: Some(role), ..ReadOptions::default() },
            sensors: sensors.into_iter().map(Into::into).collect(),
            sha256: artifact.sha256,
        }))
    }

    pub(super) fn located(&self, dataset: StoredDataset) -> anyhow::Result<Located> {
        let StoredDataset { info, columns, bearing_time, .. } = dataset;
        Ok(Located {
            blobs: self.blobs.clone(),
            format: format_named(&info.format).with_context(|| format!("a stored dataset has the unknown format {}", info.format))?,
            options: ReadOptions { kind: Some(info.kind.into()), columns, bearing_time },
            sensors: info.sensors.into_iter().map(Into::into).collect(),
            sha256: info.sha256,
        })
    }
}

fn absent(request: &InputRequest) -> Fault {
    let role = request.role.name();
    match &request.source {
        Source::Dataset { dataset_id, .. } => {
            Fault::new(format!("{}/dataset_id", request.pointer), "not_found", format!("there is no dataset '{dataset_id}'"))
        }
        Source::Job { job_id, .. } => {
            Fault::new(format!("{}/job_id", request.pointer), "not_found", format!("job '{job_id}' made no {role}"))
        }
    }
}

/// Reads one file. Blocks.
pub(super) fn read_file(path: &Path, format: &Format, options: &ReadOptions) -> Result<ReadOutcome, JobsError> {
    let file = File::open(path).with_context(|| format!("cannot open {}", path.display()))?;
    (format.read)(&mut BufReader::with_capacity(1 << 16, file), options).map_err(JobsError::Invalid)
}

impl Located {
    /// Reads the whole file. Blocks.
    pub(super) fn read(&self) -> Result<Dataset, JobsError> {
        Ok(read_file(&self.blobs.local(&self.sha256)?, self.format, &self.options)?.dataset)
    }

    pub(super) fn sensors(&self) -> &[SensorSettings] {
        &self.sensors
    }

    /// Reads what the request asks for: the file, or the named sensors' part of it. Blocks.
    pub(super) fn load(self, request: &InputRequest) -> Result<Input, JobsError> {
        let dataset = self.read().map_err(|error| repoint(error, &request.pointer))?;
        let (Source::Dataset { sensor_ids, .. } | Source::Job { sensor_ids, .. }) = &request.source;
        let (mut dataset, mut sensors) = (dataset, self.sensors);
        if let Some(wanted) = sensor_ids {
            dataset = dataset
                .only_sensors(wanted)
                .map_err(|faults| repoint(JobsError::Invalid(faults), &format!("{}/sensor_ids", request.pointer)))?;
            sensors.retain(|sensor| wanted.contains(&sensor.sensor_id));
        }
        Ok(Input { dataset, sensors, sha256: self.sha256 })
    }
}

/// Puts the place in the request before the pointers of faults.
fn repoint(error: JobsError, pointer: &str) -> JobsError {
    match error {
        JobsError::Invalid(faults) => {
            JobsError::Invalid(faults.into_iter().map(|fault| Fault { pointer: format!("{pointer}{}", fault.pointer), ..fault }).collect())
        }
        other => other,
    }
}
