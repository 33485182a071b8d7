//! What a session tells when it is asked.

use super::Session;
use super::events::{SessionEvent, serial_of, track_id};
use super::feeds::newest_s;
use super::trails::TrailPoint;
use crate::geodesy::{Geodetic, Stereographic};
use crate::model::space::{Frame, Place, Space};
use crate::model::track::{Kinematics, TrackStatus};
use crate::tracking::TrackEstimate;
use serde::{Deserialize, Serialize};

/// How much a session took.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema))]
pub struct SessionCounts {
    /// Entries of the log.
    pub entries: u64,
    /// Scans, late ones included.
    pub scans: u64,
    pub heartbeats: u64,
    pub detections: u64,
    /// Scans that came too late and were dropped.
    pub late_dropped: u64,
    /// Scans that came late and had others processed again.
    pub replayed: u64,
    /// Numbers that senders left out.
    pub missing: u64,
    /// Tracks that were begun or ended by hand.
    pub by_hand: u64,
}

/// What a session heard of a sensor: a sender goes on from there.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema))]
pub struct SensorHeard {
    pub sensor_id: String,
    /// The greatest number of its scans and heartbeats.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub last_sequence: Option<u64>,
    /// The latest time of them.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub last_time_s: Option<f64>,
}

/// A track as it is believed to be.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema))]
pub struct LiveTrack {
    /// Its number in order of initiation, from 1.
    pub track_id: String,
    #[cfg_attr(feature = "service", schema(value_type = String, examples("confirmed")))]
    pub status: TrackStatus,
    /// Time of its first point.
    pub started_s: f64,
    /// Time of its latest detection.
    pub detected_s: f64,
    /// Scans at which it had one.
    pub detections: u32,
    #[serde(flatten)]
    pub point: LivePoint,
}

/// A track at one time.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema))]
pub struct LivePoint {
    pub time_s: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub existence: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub x_m: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub y_m: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub z_m: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub vx_mps: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub vy_mps: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub vz_mps: Option<f64>,
    /// Of a session that tracks directions.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub bearing_deg: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub bearing_rate_degps: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub lat_deg: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub lon_deg: Option<f64>,
    /// Upper triangle row by row, of the coordinates and then their rates (m, m/s; rad, rad/s).
    pub covariance: Vec<f64>,
}

/// The latest points of a track.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema))]
pub struct TrackHistory {
    pub track: LiveTrack,
    /// Oldest first, as they were when the scans came.
    pub points: Vec<HistoryPoint>,
}

/// A track at one scan.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema))]
pub struct HistoryPoint {
    #[cfg_attr(feature = "service", schema(value_type = String, examples("coasted")))]
    pub status: TrackStatus,
    #[serde(flatten)]
    pub point: LivePoint,
}

impl Session {
    /// The living tracks, predicted to a time where one is given that lies ahead.
    pub fn tracks(&self, at_s: Option<f64>) -> Vec<LiveTrack> {
        let estimates = self.estimates(at_s);
        estimates
            .iter()
            .filter_map(|one| self.track_of(one))
            .collect()
    }

    fn estimates(&self, at_s: Option<f64>) -> Vec<TrackEstimate> {
        let tracker = self.line.tracker.as_ref();
        tracker
            .map(|tracker| tracker.tracks_at(at_s))
            .unwrap_or_default()
    }

    fn track_of(&self, estimate: &TrackEstimate) -> Option<LiveTrack> {
        let line = self.line.book.lines.get(&estimate.serial)?;
        let time_and_existence = (estimate.time_s, line.existence);
        Some(LiveTrack {
            track_id: track_id(estimate.serial),
            status: estimate.status,
            started_s: line.started_s,
            detected_s: line.detected_s,
            detections: line.detections,
            point: self.point_of(time_and_existence, &estimate.kinematics),
        })
    }

    fn point_of(&self, (time_s, existence): (f64, Option<f64>), packed: &[f64]) -> LivePoint {
        let space = self.scene.space();
        let kinematics = Kinematics::unpack(space, packed);
        let (place, rate) = (kinematics.position, kinematics.velocity.unwrap_or_default());
        let has_places = space.has_places();
        let is_raised = space == Space::Volume;
        let earth = self.scene.frame().filter(|_| has_places);
        let earth = earth.map(|frame| on_earth(frame, space, &place));
        LivePoint {
            time_s,
            existence,
            x_m: has_places.then_some(place.x),
            y_m: has_places.then_some(place.y),
            z_m: is_raised.then_some(place.z),
            vx_mps: has_places.then_some(rate.x),
            vy_mps: has_places.then_some(rate.y),
            vz_mps: is_raised.then_some(rate.z),
            bearing_deg: (!has_places).then_some(place.x.to_degrees()),
            bearing_rate_degps: (!has_places).then_some(rate.x.to_degrees()),
            lat_deg: earth.map(|(lat_deg, _)| lat_deg),
            lon_deg: earth.map(|(_, lon_deg)| lon_deg),
            covariance: kinematics
                .covariance
                .as_deref()
                .unwrap_or_default()
                .to_vec(),
        }
    }

    /// Where a track is.
    pub(super) fn place_of(&self, packed: &[f64]) -> Place {
        Kinematics::unpack(self.scene.space(), packed).position
    }

    /// A living track with its latest points.
    pub fn history(&self, track_id: &str) -> Option<TrackHistory> {
        let serial = serial_of(track_id)?;
        let estimates = self.estimates(None);
        let estimate = estimates.iter().find(|one| one.serial == serial)?;
        let point = |point: &TrailPoint| HistoryPoint {
            status: point.status,
            point: self.point_of((point.time_s, point.existence), &point.kinematics),
        };
        Some(TrackHistory {
            track: self.track_of(estimate)?,
            points: self.trails.of(serial).map(point).collect(),
        })
    }

    /// Tracks that live, and those of them that are confirmed.
    pub fn count_tracks(&self) -> (usize, usize) {
        self.line.book.count()
    }

    /// Events after a number, oldest first, at most so many; `None` where some of them are no longer kept.
    pub fn events_after(&self, id: u64, most: usize) -> Option<Vec<SessionEvent>> {
        self.events.after(id, most)
    }

    /// Number of the latest event.
    pub fn last_event(&self) -> u64 {
        self.events.last()
    }

    pub fn counts(&self) -> SessionCounts {
        self.counts
    }

    /// What was heard of each sensor, as listed.
    pub fn heard(&self) -> Vec<SensorHeard> {
        let listed = self.scene.sensor_ids().iter().zip(&self.feeds);
        let heard = listed.map(|(sensor_id, feed)| SensorHeard {
            sensor_id: sensor_id.clone(),
            last_sequence: feed.last(),
            last_time_s: feed.newest_s,
        });
        heard.collect()
    }

    /// Time of the last scan that the tracker took.
    pub fn processed_to_s(&self) -> Option<f64> {
        self.line.last.map(|last| last.time_s)
    }

    /// Scans that the tracker has not taken yet.
    pub fn waiting(&self) -> usize {
        self.order.waiting.len()
    }

    /// How far the tracker is behind what was heard of the sensors (s).
    pub fn lag_s(&self) -> Option<f64> {
        let newest_s = newest_s(&self.feeds)?;
        Some((newest_s - self.processed_to_s()?).max(0.0))
    }

    /// Whether a job on the recorded session has its tracks: nobody did anything by hand, and none were too many.
    pub fn is_by_rule(&self) -> bool {
        self.counts.by_hand == 0 && self.line.book.limited == 0
    }

    /// What the tracks that were confirmed are called by a job on the recorded session: the n-th of these is its track n.
    pub fn confirmed_track_ids(&self) -> Vec<String> {
        let mut serials = self.line.book.confirmed.clone();
        serials.sort_unstable();
        serials.into_iter().map(track_id).collect()
    }
}

/// Latitude and longitude (degrees).
fn on_earth(frame: Frame, space: Space, place: &Place) -> (f64, f64) {
    if space == Space::Volume {
        let origin = Geodetic::from(&frame);
        let there = origin.at_enu(place);
        return (there.lat_deg, there.lon_deg);
    }
    Stereographic::from(frame).unproject(&place.xy())
}
