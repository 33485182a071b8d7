//! A session as a dataset, while it is open and when it is closed.

use super::Sessions;
use super::live::Live;
use super::table::{Looking, Writing};
use crate::experiment::session::Scene;
use crate::formats::FormatOptions;
use crate::model::dataset::DatasetKind;
use crate::model::sensor::SensorSettings;
use crate::service::datasets::DatasetMeta;
use crate::service::error::ServiceError;
use crate::service::storage::{SessionEnd, StoredSession};
use crate::service::types::{DatasetInfo, SessionInfo, SessionState};
use anyhow::Context;
use serde_json::{Value, json};
use std::sync::Arc;
use uuid::Uuid;

impl Sessions {
    /// The scans so far as a dataset of detections.
    pub async fn record(&self, id: Uuid) -> Result<(DatasetInfo, bool), ServiceError> {
        let stored = self.stored(id).await?;
        self.record_stored(&stored).await
    }

    async fn record_stored(
        &self,
        stored: &StoredSession,
    ) -> Result<(DatasetInfo, bool), ServiceError> {
        let scene = Arc::new(Scene::plan(&stored.spec).map_err(ServiceError::Invalid)?);
        let sensors = scene.recorded_sensors.clone();
        // A table begins with its columns, which are known at its end: the log is read twice, and never held.
        let looking = Looking::new(scene.clone());
        let (looking, entries) = self.read_log(stored.id, 0, looking, Looking::take).await?;
        let table = looking.end()?;
        let path = self.datasets.temp_dir().join(Uuid::now_v7().to_string());
        let writing = Writing::begin(scene, table, entries, path)?;
        let (writing, _) = self.read_log(stored.id, 0, writing, Writing::take).await?;
        let file = tokio::task::spawn_blocking(move || writing.end()).await;
        let file = file.context("writing a recording panicked")??;
        self.datasets.add(file, meta_of(stored, sensors)).await
    }

    /// Ends a session: what it took becomes a dataset, and a job tracks it with the same settings.
    /// `submit` is given the body of the job, and gives its identity.
    pub async fn close<F>(
        &self,
        id: Uuid,
        submit: impl FnOnce(Value) -> F,
    ) -> Result<SessionInfo, ServiceError>
    where
        F: Future<Output = Result<Uuid, ServiceError>>,
    {
        let stored = self.stored(id).await?;
        if stored.state != SessionState::Open {
            return self.get(id).await;
        }
        let live = self.open(&stored).await?;
        let Some(_ending) = self.begin_ending(id) else {
            let detail = "the session is being closed";
            return Err(ServiceError::conflict("session_closed", detail));
        };
        let fence = live.fence;
        // Whoever pushes now finds it closed.
        live.rest(&self.storage).await;
        let mut end = SessionEnd::default();
        if self.stored(id).await?.entries > 0 {
            match self.record_stored(&stored).await {
                Ok((dataset, _)) => {
                    end.dataset_id = Some(dataset.id);
                    end.track_ids = ids_of(&live);
                    let scene = live.session().scene().clone();
                    let mut body = scene.job_on(&dataset.id.to_string());
                    if let Some(name) = &stored.name {
                        body["name"] = json!(name);
                    }
                    end.job_id = Some(submit(body).await?);
                }
                // Heartbeats alone are no recording.
                Err(ServiceError::Invalid(faults))
                    if faults.iter().all(|fault| fault.code == "empty") => {}
                Err(error) => return Err(error),
            }
        }
        if !self.storage.end_session(id, fence, &end).await? {
            return Err(ServiceError::Unavailable);
        }
        self.get(id).await
    }
}

/// What the job's tracks are called while the session lives, which nobody asks any more.
fn ids_of(live: &Live) -> Option<Vec<String>> {
    let mut session = live.session();
    // A tracker that cannot go on has failed before.
    session.finish().ok()?;
    session.is_by_rule().then(|| session.confirmed_track_ids())
}

/// What the dataset of a session says of itself.
fn meta_of(stored: &StoredSession, sensors: Vec<SensorSettings>) -> DatasetMeta {
    let mut options = FormatOptions::default();
    options.add("origin", &stored.spec.get("origin"));
    let name = stored.name.clone();
    DatasetMeta {
        name: Some(name.unwrap_or_else(|| format!("session {}", stored.id))),
        kind: Some(DatasetKind::Detections),
        format: Some("csv".to_owned()),
        options,
        sensors,
        ..DatasetMeta::default()
    }
}
