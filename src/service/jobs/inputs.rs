//! From what a plan asks for to the files that hold it.

use super::Jobs;
use crate::experiment::{Estimates, InputRequest, Known, Plan, SMOOTHED_TRACKS, Source};
use crate::formats::FormatOptions;
use crate::model::dataset::DatasetKind;
use crate::model::fault::Fault;
use crate::service::child::FileContent;
use crate::service::datasets::Located;
use crate::service::error::ServiceError;
use crate::service::storage::{SourceId, SourceRef};
use std::collections::BTreeMap;
use uuid::Uuid;

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
    plan.inputs.iter().map(source_ref).collect()
}

impl Jobs {
    /// Finds the file of each input, in the order of the plan; `None` where an optional one is absent.
    pub(super) async fn locate(&self, plan: &Plan) -> Result<Vec<Option<Located>>, ServiceError> {
        let mut located = Vec::new();
        let mut faults = Vec::new();
        for request in &plan.inputs {
            let found = match &request.source {
                Source::Dataset { dataset_id, .. } => self.datasets.locate(dataset_id).await?,
                Source::Job {
                    job_id, estimates, ..
                } => {
                    let wanted = (request.role, *estimates);
                    self.locate_artifact(job_id, wanted).await?
                }
            };
            if found.is_none() && !request.optional {
                faults.push(absent(request));
            }
            located.push(found);
        }
        if faults.is_empty() {
            Ok(located)
        } else {
            Err(ServiceError::Invalid(faults))
        }
    }

    /// What is known of each input before it is loaded, in the order of the plan, and what cannot be known yet.
    pub(super) async fn known_of(
        &self,
        plan: &Plan,
    ) -> Result<(Vec<Option<Known>>, Vec<String>), ServiceError> {
        let (mut known, mut unknown) = (Vec::new(), Vec::new());
        for request in &plan.inputs {
            let dataset = match &request.source {
                Source::Dataset { dataset_id, .. } => Uuid::try_parse(dataset_id).ok(),
                Source::Job { job_id, .. } => self.made_by(job_id, request.role).await?,
            };
            let found = match dataset {
                Some(id) if request.role == DatasetKind::Detections => {
                    self.datasets.facts_of(id).await?
                }
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
    async fn made_by(&self, job_id: &str, role: DatasetKind) -> Result<Option<Uuid>, ServiceError> {
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

    /// The artefact `<role>.csv` of the job; the tracks of a job that put tracks together are `system_tracks.csv`, smoothed ones
    /// `smoothed_tracks.csv`.
    pub(super) async fn locate_artifact(
        &self,
        job_id: &str,
        (role, estimates): (DatasetKind, Estimates),
    ) -> Result<Option<Located>, ServiceError> {
        let Ok(id) = Uuid::try_parse(job_id) else {
            return Ok(None);
        };
        let name = format!("{}.csv", role.name());
        let artifacts = self.storage.artifacts(id).await?;
        let is_of_role = |known: &str| match (role, estimates) {
            (DatasetKind::Tracks, Estimates::Smoothed) => known == SMOOTHED_TRACKS,
            (DatasetKind::Tracks, _) => known == name || known == "system_tracks.csv",
            _ => known == name,
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
        let content = FileContent {
            format: "csv".to_owned(),
            kind: role,
            columns: BTreeMap::new(),
            options: FormatOptions::default(),
            sensors,
            sha256: artifact.sha256,
        };
        let blobs = self.blobs.clone();
        Ok(Some(Located { blobs, content }))
    }
}

fn absent(request: &InputRequest) -> Fault {
    let role = request.role.name();
    match &request.source {
        Source::Dataset { dataset_id, .. } => Fault::new(
            format!("{}/dataset_id", request.pointer),
            "not_found",
            format!("there is no dataset '{dataset_id}'"),
        ),
        Source::Job {
            job_id,
            estimates: Estimates::Smoothed,
            ..
        } if request.role == DatasetKind::Tracks => Fault::new(
            format!("{}/estimates", request.pointer),
            "not_found",
            format!("job '{job_id}' smoothed no tracks: it has no {SMOOTHED_TRACKS}"),
        )
        .allowing("a job with tracker.smoothing"),
        Source::Job { job_id, .. } => Fault::new(
            format!("{}/job_id", request.pointer),
            "not_found",
            format!("job '{job_id}' made no {role}"),
        ),
    }
}
