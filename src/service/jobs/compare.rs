//! Reading what a comparison of jobs needs.

use super::Jobs;
use super::read::{METRIC_SERIES, METRIC_TRUTHS};
use crate::service::error::ServiceError;
use crate::service::storage::blobs::Blobs;
use crate::service::types::{ComparedJob, Comparison, Job};
use crate::service::views::compare::{self, Side};
use crate::service::views::metrics::MetricTable;
use anyhow::Context;
use serde_json::Value;
use uuid::Uuid;

/// The files of one job, by their SHA-256.
struct Files {
    job: Job,
    report: String,
    metrics: Option<String>,
    truths: Option<String>,
    runs: Option<String>,
}

impl Jobs {
    /// Jobs side by side; `baseline` is the place of the one that the others are compared with.
    pub async fn compare(
        &self,
        ids: &[Uuid],
        baseline: usize,
        confidence: f64,
    ) -> Result<Comparison, ServiceError> {
        self.refuse_unknown(ids).await?;
        let mut files = Vec::new();
        for &id in ids {
            files.push(self.files_of(id).await.map_err(|error| of_job(id, error))?);
        }
        let blobs = self.blobs.clone();
        let work = move || -> Result<Comparison, ServiceError> {
            let sides = files
                .into_iter()
                .map(|files| side(&blobs, files))
                .collect::<anyhow::Result<Vec<Side>>>()?;
            Ok(compare::of(&sides, baseline, confidence))
        };
        tokio::task::spawn_blocking(work)
            .await
            .context("comparing jobs panicked")?
    }

    /// All jobs that are not there are told at once.
    async fn refuse_unknown(&self, ids: &[Uuid]) -> Result<(), ServiceError> {
        let mut missing = Vec::new();
        for &id in ids {
            match self.get(id).await {
                Ok(_) => {}
                Err(ServiceError::NotFound(_)) => missing.push(format!("there is no job '{id}'")),
                Err(ServiceError::Gone(_)) => missing.push(format!("job '{id}' has been deleted")),
                Err(error) => return Err(error),
            }
        }
        if missing.is_empty() {
            Ok(())
        } else {
            Err(ServiceError::NotThere(missing.join("; ")))
        }
    }

    async fn files_of(&self, id: Uuid) -> Result<Files, ServiceError> {
        self.ended_well(id).await?;
        let artifacts = self.storage.artifacts(id).await?;
        let named = |name: &str| {
            artifacts
                .iter()
                .find(|artifact| artifact.name == name)
                .map(|artifact| artifact.sha256.clone())
        };
        let report = named("report.json").ok_or(ServiceError::NotFound("report"))?;
        Ok(Files {
            job: self.get(id).await?,
            report,
            metrics: named(METRIC_SERIES),
            truths: named(METRIC_TRUTHS),
            runs: named("runs.csv"),
        })
    }
}

/// The conflict of one job among several.
fn of_job(id: Uuid, error: ServiceError) -> ServiceError {
    match error {
        ServiceError::Conflict { code, detail } => ServiceError::Conflict {
            code,
            detail: format!("job {id}: {detail}"),
        },
        other => other,
    }
}

/// Blocks.
fn side(blobs: &Blobs, files: Files) -> anyhow::Result<Side> {
    let read = |sha256: String| {
        let path = blobs.local(&sha256)?;
        std::fs::read(&path).with_context(|| format!("cannot read {}", path.display()))
    };
    let mut report: Value =
        serde_json::from_slice(&read(files.report)?).context("a report is damaged")?;
    let metrics = match files.metrics {
        Some(sha256) => MetricTable::read(&read(sha256)?)
            .with_context(|| format!("{METRIC_SERIES} is damaged"))?,
        None => MetricTable::default(),
    };
    let mut spec = report["spec"].take();
    if let Some(members) = spec.as_object_mut() {
        // Kinds are compared by themselves.
        members.shift_remove("kind");
    }
    let Job {
        id,
        kind,
        name,
        seed,
        ..
    } = files.job;
    Ok(Side {
        job: ComparedJob {
            id,
            kind,
            name,
            seed,
            total_s: report["timing"]["total_s"].as_f64().unwrap_or(0.0),
        },
        spec,
        result: report["result"].take(),
        metrics,
        truths: files.truths.map(read).transpose()?,
        runs: files.runs.map(read).transpose()?,
    })
}
