//! The live session of the tour: the shipped recording, pushed into a session at the pace at which it was made.

use crate::formats::{ReadOptions, format_named};
use crate::model::dataset::Dataset;
use crate::model::fault::Fault;
use crate::model::scan::{Recording, Scan};
use crate::service::error::ServiceError;
use crate::service::jobs::Jobs;
use crate::service::types::JobKind;
use anyhow::{Context, bail};
use serde_json::{Map, Value, json};
use std::sync::Arc;
use std::time::Duration;
use tokio::time::Instant;
use uuid::Uuid;

/// How often the recording is played; then the session is closed.
const ROUNDS: u32 = 10;
/// From the last scan of a round to the first of the next.
const PAUSE_S: f64 = 10.0;

/// A recording that is to be played into a session.
pub(super) struct Feed {
    pub session: Uuid,
    /// In order of time.
    scans: Vec<Value>,
}

/// Begins a session with the settings of a job, for the scans of one sensor of a recording.
///
/// # Errors
/// A recording that cannot be read; a session that cannot begin.
pub(super) async fn begin(jobs: &Jobs, job: &Value, detections: &[u8]) -> anyhow::Result<Feed> {
    let mut body = Map::new();
    for name in ["sensors", "associator", "filter", "tracker"] {
        body.insert(name.to_owned(), job[name].clone());
    }
    body.insert("name".to_owned(), json!("autoferry 2, radar, live"));
    body.insert("labels".to_owned(), json!({"tour": "demo"}));
    let scans = scans_of(&read(detections)?, "radar");
    if scans.is_empty() {
        bail!("the recording of the tour has no radar scan");
    }
    let session = jobs.sessions().create(&Value::Object(body)).await;
    let session = session.map_err(|error| anyhow::anyhow!("{error}"))?;
    Ok(Feed {
        session: session.id,
        scans,
    })
}

fn read(detections: &[u8]) -> anyhow::Result<Recording> {
    let format = format_named("autoferry").context("the format of the tour is missing")?;
    let told = |faults: Vec<Fault>| anyhow::anyhow!("{faults:?}");
    let outcome = (format.read)(&mut &detections[..], &ReadOptions::default()).map_err(told)?;
    match outcome.dataset {
        Dataset::Detections(recording) => Ok(recording),
        _ => bail!("the recording of the tour has no detections"),
    }
}

/// The scans of one sensor as they are pushed.
fn scans_of(recording: &Recording, sensor_id: &str) -> Vec<Value> {
    let sensors = &recording.sensors;
    let is_of = |scan: &&Scan| sensors[scan.sensor].sensor_id == sensor_id;
    recording
        .scans
        .iter()
        .filter(is_of)
        .map(|scan| pushed(scan, sensor_id))
        .collect()
}

fn pushed(scan: &Scan, sensor_id: &str) -> Value {
    let from = scan.sensor_place_m(Default::default());
    let places = scan
        .detections
        .iter()
        .filter_map(|detection| detection.measurement.position_seen_from(&from));
    let detections: Vec<Value> = places
        .map(|place| json!({"x_m": place.x, "y_m": place.y}))
        .collect();
    json!({"sensor_id": sensor_id, "time_s": scan.time_s, "detections": detections})
}

impl Feed {
    /// Plays all rounds and closes the session, unless somebody closed it before or the service stops.
    pub async fn play(self, jobs: Arc<Jobs>) {
        match self.push_all(&jobs).await {
            Ok(()) => {}
            // Closed or deleted in the dashboard, or at the end of the service: nobody waits for more.
            Err(ServiceError::Conflict { .. } | ServiceError::Gone(_)) => return,
            Err(ServiceError::ShuttingDown) => return,
            Err(error) => return tracing::warn!(%error, "the live session of the tour ends"),
        }
        let submit = async |body| {
            let submitted = jobs.submit(JobKind::Associate, body, None).await?;
            Ok(submitted.job.id)
        };
        if let Err(error) = jobs.sessions().close(self.session, submit).await {
            tracing::warn!(%error, "the live session of the tour was not closed");
        }
    }

    async fn push_all(&self, jobs: &Jobs) -> Result<(), ServiceError> {
        let times = || self.scans.iter().filter_map(|scan| scan["time_s"].as_f64());
        let first_s = times().next().unwrap_or_default();
        let length_s = times().next_back().unwrap_or_default() - first_s + PAUSE_S;
        let begun = Instant::now();
        for round in 0..ROUNDS {
            let later_s = f64::from(round) * length_s;
            for (scan, time_s) in self.scans.iter().zip(times()) {
                let due_s = (time_s - first_s + later_s).max(0.0);
                tokio::time::sleep_until(begun + Duration::from_secs_f64(due_s)).await;
                let mut scan = scan.clone();
                scan["time_s"] = json!(time_s + later_s);
                let sessions = jobs.sessions();
                sessions.push(self.session, &[(None, scan)], 1).await?;
            }
        }
        Ok(())
    }
}
