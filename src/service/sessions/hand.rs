//! What people do to a session by hand: tracks begun and ended, scans refused for a while.

use super::Sessions;
use crate::experiment::session::{Entry, SessionEventKind, read_track};
use crate::service::error::ServiceError;
use crate::service::types::{LiveTrack, Pushed, SessionInfo};
use serde_json::Value;
use uuid::Uuid;

impl Sessions {
    async fn act(&self, id: Uuid, entry: Entry) -> Result<Pushed, ServiceError> {
        let live = self.live(id).await?;
        let entries = vec![(None, entry)];
        live.push(entries, 1, (&self.log, &self.storage)).await
    }

    /// Begins a confirmed track at the last scan.
    pub async fn begin_track(&self, id: Uuid, body: &Value) -> Result<LiveTrack, ServiceError> {
        let live = self.live(id).await?;
        let scene = live.session().scene().clone();
        let track = read_track(body, &scene).map_err(ServiceError::Invalid)?;
        let pushed = self.act(id, Entry::Begin(track)).await?;
        let started = pushed
            .events
            .into_iter()
            .find(|event| event.kind == SessionEventKind::Started);
        let track_id = started.and_then(|event| event.track_id);
        let history = track_id.and_then(|track_id| live.session().history(&track_id));
        let history = history.ok_or(ServiceError::NotFound("living track"))?;
        Ok(history.track)
    }

    /// Ends a track.
    pub async fn end_track(&self, id: Uuid, track_id: &str) -> Result<(), ServiceError> {
        let live = self.live(id).await?;
        if !live.session().lives(track_id) {
            return Err(ServiceError::NotFound("living track"));
        }
        let track_id = track_id.to_owned();
        self.act(id, Entry::End { track_id }).await?;
        Ok(())
    }

    /// Refuses scans, or takes them again.
    pub async fn pause(&self, id: Uuid, is_paused: bool) -> Result<SessionInfo, ServiceError> {
        let live = self.live(id).await?;
        let is_so = live.session().is_paused();
        if is_so != is_paused {
            let entry = if is_paused {
                Entry::Pause
            } else {
                Entry::Resume
            };
            self.act(id, entry).await?;
        }
        self.get(id).await
    }
}
