//! Tracks: what a tracker says the targets did, with the detections it gave them and how sure it was.

use super::state::{Covariance, State};
use serde::{Deserialize, Serialize};

/// The state of a track's life at one scan.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TrackStatus {
    /// Not yet confirmed.
    Tentative,
    /// Confirmed, and given a detection at this scan.
    Confirmed,
    /// Confirmed, but predicted without a detection at this scan.
    Coasted,
}

impl TrackStatus {
    pub const ALL: [(TrackStatus, &'static str); 3] =
        [(TrackStatus::Tentative, "tentative"), (TrackStatus::Confirmed, "confirmed"), (TrackStatus::Coasted, "coasted")];

    pub fn name(self) -> &'static str {
        Self::ALL[self as usize].1
    }
}

/// One way a track may have been continued at a scan: a detection, or none (ε), with its probability.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Candidate {
    /// Index into [`TrackSet::detection_ids`]; `None` is ε, "no detection".
    pub detection: Option<u32>,
    pub probability: f64,
}

/// A track at one scan. Its candidates are `first_candidate .. first_candidate + candidates` of
/// [`TrackSet::candidates`]; none at all means that the file said nothing about detections.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrackPoint {
    pub time_s: f64,
    /// Index into [`TrackSet::sensor_ids`]; `None` where the file does not say.
    pub sensor: Option<u32>,
    /// `[x_m, y_m, vx_mps, vy_mps]`; velocities are 0 where `has_velocity` is false.
    pub state: State,
    pub has_velocity: bool,
    pub covariance: Option<Covariance>,
    pub status: Option<TrackStatus>,
    /// Normalised innovation squared of the update at this scan, the mean over its detections by their weights; `None` where
    /// there was no detection, or one that started the track.
    pub nis: Option<f64>,
    pub first_candidate: usize,
    pub candidates: usize,
}

/// One track: its name and its points in order of time.
#[derive(Debug, Clone, PartialEq)]
pub struct Track {
    pub track_id: String,
    pub points: Vec<TrackPoint>,
}

/// The tracks of one tracker, or of one file.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TrackSet {
    pub tracks: Vec<Track>,
    pub candidates: Vec<Candidate>,
    /// Names of the detections that candidates refer to.
    pub detection_ids: Vec<String>,
    pub sensor_ids: Vec<String>,
}

impl TrackSet {
    /// The candidates of one point.
    pub fn candidates_of(&self, point: &TrackPoint) -> &[Candidate] {
        &self.candidates[point.first_candidate..point.first_candidate + point.candidates]
    }
}
