//! From when on a tracker is credited with a track.
//!
//! A tracker that confirms a track after some scans, or that begins it over several, knew nothing of its first points when they were:
//! an operator saw no track. They count only for whoever judges afterwards.

use crate::model::track::{TrackPoint, TrackStatus};
use serde::Deserialize;

/// Which points of a track count.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Credit {
    /// What was known at the time: no tentative point, none of a beginning that was chosen later.
    #[default]
    AtTheTime,
    /// All points of a track that was confirmed at last.
    Afterwards,
}

impl Credit {
    pub fn counts(self, point: &TrackPoint) -> bool {
        let is_later = point
            .known_at_s
            .is_some_and(|known_at_s| known_at_s > point.time_s);
        self == Credit::Afterwards || (point.status != Some(TrackStatus::Tentative) && !is_later)
    }
}
