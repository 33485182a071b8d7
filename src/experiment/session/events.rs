//! What a session tells of its tracks as it goes, each event with a number.

use serde::{Deserialize, Serialize};
use std::collections::VecDeque;

/// Events that are kept; who asks for older ones is told that they are gone.
pub const KEPT_EVENTS: usize = 2048;

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum SessionEventKind {
    /// A track began.
    Started,
    /// It is believed to be a target.
    Confirmed,
    /// A confirmed track was not detected.
    Coasted,
    /// It is detected again.
    Resumed,
    /// It ended, for another one follows the same target.
    Merged,
    Ended,
    /// Earlier scans were processed again after a late one.
    Revised,
    /// A scan came too late and was dropped.
    LateDropped,
    /// Numbers of a sender were left out.
    Gap,
    /// Tentative tracks were dropped, for there were too many.
    Limited,
}

/// One thing that happened in a session.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema))]
pub struct SessionEvent {
    /// Counts up from 1 without gaps.
    pub id: u64,
    pub kind: SessionEventKind,
    /// Time of the scan at which it happened, or from which it counts.
    pub time_s: f64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub track_id: Option<String>,
    /// Of a merged track the one that goes on.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub into_track_id: Option<String>,
    /// Of what happened to a sensor's feed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub sensor_id: Option<String>,
    /// Scans or tracks that it is about, where it is about several.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub count: Option<u64>,
}

impl SessionEvent {
    /// Of a track; it has its number later.
    pub fn of_track(kind: SessionEventKind, time_s: f64, serial: u32) -> Self {
        SessionEvent {
            track_id: Some(track_id(serial)),
            ..SessionEvent::plain(kind, time_s)
        }
    }

    pub fn plain(kind: SessionEventKind, time_s: f64) -> Self {
        SessionEvent {
            id: 0,
            kind,
            time_s,
            track_id: None,
            into_track_id: None,
            sensor_id: None,
            count: None,
        }
    }
}

/// How a session names a track: by its number in order of initiation, from 1, tentative ones counted too.
pub fn track_id(serial: u32) -> String {
    (u64::from(serial) + 1).to_string()
}

/// Undoes [`track_id`].
pub fn serial_of(track_id: &str) -> Option<u32> {
    track_id.parse::<u32>().ok()?.checked_sub(1)
}

/// The latest events.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct EventRing {
    /// Number of the latest event.
    last: u64,
    kept: VecDeque<SessionEvent>,
}

impl EventRing {
    pub fn push(&mut self, event: SessionEvent) {
        self.last += 1;
        self.kept.push_back(SessionEvent {
            id: self.last,
            ..event
        });
        if self.kept.len() > KEPT_EVENTS {
            self.kept.pop_front();
        }
    }

    /// Number of the latest event; 0 when there was none.
    pub fn last(&self) -> u64 {
        self.last
    }

    /// The events after this number, oldest first, at most so many; `None` where some of them are no longer kept.
    pub fn after(&self, id: u64, most: usize) -> Option<Vec<SessionEvent>> {
        let oldest = self.last + 1 - self.kept.len() as u64;
        if id + 1 < oldest {
            return None;
        }
        let skipped = (id + 1 - oldest) as usize;
        Some(self.kept.iter().skip(skipped).take(most).cloned().collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn events_are_numbered_without_gaps_and_old_ones_go() {
        let mut ring = EventRing::default();
        assert_eq!(ring.after(0, 9), Some(Vec::new()));
        for serial in 0..KEPT_EVENTS as u32 + 5 {
            ring.push(SessionEvent::of_track(
                SessionEventKind::Started,
                1.0,
                serial,
            ));
        }
        assert_eq!(ring.after(4, 9), None);
        let found = ring.after(5, 2).unwrap();
        let ids: Vec<u64> = found.iter().map(|event| event.id).collect();
        assert_eq!(ids, [6, 7]);
        assert_eq!(found[0].track_id.as_deref(), Some("6"));
        assert_eq!(ring.after(ring.last(), 9), Some(Vec::new()));
    }
}
