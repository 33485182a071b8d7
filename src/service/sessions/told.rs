//! What is told of a session.

use crate::experiment::session::Session;
use crate::service::storage::StoredSession;
use crate::service::types::{SessionInfo, SessionLive};

pub(super) fn info(stored: StoredSession) -> SessionInfo {
    SessionInfo {
        id: stored.id,
        name: stored.name,
        labels: stored.labels,
        state: stored.state,
        entries: stored.entries,
        log_bytes: stored.log_bytes,
        created_at: stored.created_at,
        closed_at: stored.closed_at,
        dataset_id: stored.dataset_id,
        job_id: stored.job_id,
        track_ids: stored.track_ids,
        fault: stored.fault,
        request: stored.spec,
        live: None,
    }
}

pub(super) fn told_of(session: &Session) -> SessionLive {
    let (tracks, confirmed) = session.count_tracks();
    SessionLive {
        counts: session.counts(),
        is_paused: session.is_paused(),
        processed_to_s: session.processed_to_s(),
        lag_s: session.lag_s(),
        waiting: session.waiting() as u64,
        tracks: tracks as u64,
        confirmed: confirmed as u64,
        last_event: session.last_event(),
        sensors: session.heard(),
        warnings: session.scene().warnings.clone(),
    }
}
