//! Reading what the page of a job is made of.

use super::Jobs;
use crate::service::error::ServiceError;
use crate::service::storage::StoredArtifact;
use crate::service::storage::blobs::Blobs;
use crate::service::types::Job;
use crate::service::views::report_page::{Source, render};
use anyhow::{Context, anyhow};
use serde_json::Value;
use uuid::Uuid;

const REPORT: &str = "report.json";
const CAUSES: &str = "causes.csv";

/// The hash of the file of this name.
fn named(artifacts: &[StoredArtifact], name: &str) -> Option<String> {
    let found = artifacts.iter().find(|artifact| artifact.name == name);
    found.map(|artifact| artifact.sha256.clone())
}

fn read(blobs: &Blobs, sha256: &str) -> anyhow::Result<Vec<u8>> {
    let path = blobs.local(sha256)?;
    std::fs::read(&path).with_context(|| format!("cannot read {}", path.display()))
}

impl Jobs {
    /// The page of a job that ended well, in its template.
    pub async fn report_page(&self, id: Uuid, template: String) -> Result<String, ServiceError> {
        let layers = self.load_job_layers(id).await?;
        let Job { kind, name, .. } = self.get(id).await?;
        let artifacts = self.storage.artifacts(id).await?;
        let report = named(&artifacts, REPORT).ok_or(ServiceError::NotFound("report"))?;
        let causes = named(&artifacts, CAUSES);
        let blobs = self.blobs.clone();
        let work = move || -> anyhow::Result<String> {
            let report = read(&blobs, &report)?;
            let report: Value = serde_json::from_slice(&report).context("a report is damaged")?;
            let causes = causes.map(|causes| read(&blobs, &causes)).transpose()?;
            let name = name.unwrap_or_else(|| format!("{} job", kind.name()));
            let source = Source {
                name: &name,
                report,
                layers: &layers,
                causes: causes.as_deref(),
            };
            Ok(render(&template, source))
        };
        let made = tokio::task::spawn_blocking(work).await;
        made.map_err(|_| anyhow!("making a page panicked"))?
            .map_err(ServiceError::from)
    }
}
