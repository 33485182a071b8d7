//! A session as a dataset, while it is open and when it is closed.

use super::Sessions;
use super::live::Live;
use crate::experiment::session::{Entry, Scene, SessionRecording};
use crate::formats::FormatOptions;
use crate::model::dataset::DatasetKind;
use crate::model::fault::Fault;
use crate::model::sensor::SensorSettings;
use crate::service::datasets::{DatasetMeta, ReceivedFile};
use crate::service::error::ServiceError;
use crate::service::storage::blobs::sha256_hex;
use crate::service::storage::{SessionEnd, StoredSession};
use crate::service::types::{DatasetInfo, SessionInfo, SessionState};
use anyhow::Context;
use serde_json::{Value, json};
use std::path::PathBuf;
use std::sync::Arc;
use uuid::Uuid;

/// Scans of a recording that a session can become.
const MOST_RECORDED: usize = 1_000_000;

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
        let recording = SessionRecording::new(scene);
        let (recording, _) = self.read_log(stored.id, 0, recording, add_to).await?;
        if recording.scans() == 0 {
            let detail = "the session has no scans";
            return Err(ServiceError::Invalid(vec![Fault::new("", "empty", detail)]));
        }
        let path = self.datasets.temp_dir().join(Uuid::now_v7().to_string());
        let work = move || write(recording, path);
        let file = tokio::task::spawn_blocking(work).await;
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

fn add_to(recording: &mut SessionRecording, entry: Entry) -> Result<(), ServiceError> {
    let added = recording.add(entry);
    added.map_err(|fault| ServiceError::Invalid(vec![*fault]))?;
    if recording.scans() > MOST_RECORDED {
        let detail = format!("the session has more than {MOST_RECORDED} scans");
        let fault = Fault::new("", "too_large", detail);
        return Err(ServiceError::Invalid(vec![fault]));
    }
    Ok(())
}

fn write(recording: SessionRecording, path: PathBuf) -> anyhow::Result<ReceivedFile> {
    let faults = |faults: Vec<Fault>| anyhow::anyhow!("no recording: {faults:?}");
    let bytes = recording.into_csv().map_err(faults)?;
    std::fs::write(&path, &bytes)?;
    Ok(ReceivedFile {
        sha256: sha256_hex(&bytes),
        bytes: bytes.len() as u64,
        path,
    })
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
