//! Tracks: what a tracker says the targets did, with the detections it gave them and how sure it was.

use super::fault::Fault;
use super::scan::check_known;
use super::state::{Covariance, GaussianState, Position, State};
use nalgebra::Matrix2;
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
    pub const ALL: [(TrackStatus, &'static str); 3] = [
        (TrackStatus::Tentative, "tentative"),
        (TrackStatus::Confirmed, "confirmed"),
        (TrackStatus::Coasted, "coasted"),
    ];

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

/// What a track says of its target at one scan. All points of a set say the same kind of thing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Estimate {
    Plane(PlaneEstimate),
    /// Of a tracker that knows directions only.
    Bearing(BearingEstimate),
}

/// A place in the plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlaneEstimate {
    /// `[x_m, y_m, vx_mps, vy_mps]`; velocities are 0 where `has_velocity` is false.
    pub state: State,
    pub has_velocity: bool,
    pub covariance: Option<Covariance>,
}

/// A direction, clockwise from north.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BearingEstimate {
    pub bearing_rad: f64,
    pub rate_radps: Option<f64>,
    /// Of the bearing and its rate (rad², rad²/s, rad²/s²).
    pub covariance: Option<Matrix2<f64>>,
}

impl Estimate {
    /// The place, if it says one.
    pub fn plane(&self) -> Option<&PlaneEstimate> {
        match self {
            Estimate::Plane(plane) => Some(plane),
            Estimate::Bearing(_) => None,
        }
    }

    /// The direction, if it says no more than that.
    pub fn bearing(&self) -> Option<&BearingEstimate> {
        match self {
            Estimate::Bearing(bearing) => Some(bearing),
            Estimate::Plane(_) => None,
        }
    }
}

impl PlaneEstimate {
    pub fn position_m(&self) -> Position {
        self.state.fixed_rows::<2>(0).into_owned()
    }

    pub fn velocity_mps(&self) -> Option<Position> {
        self.has_velocity
            .then(|| self.state.fixed_rows::<2>(2).into_owned())
    }
}

impl From<GaussianState<4>> for Estimate {
    fn from(state: GaussianState<4>) -> Self {
        Estimate::Plane(PlaneEstimate {
            state: state.mean,
            has_velocity: true,
            covariance: Some(state.covariance),
        })
    }
}

impl From<GaussianState<2>> for Estimate {
    fn from(state: GaussianState<2>) -> Self {
        let bearing_rad = state.mean[0].rem_euclid(std::f64::consts::TAU);
        Estimate::Bearing(BearingEstimate {
            bearing_rad,
            rate_radps: Some(state.mean[1]),
            covariance: Some(state.covariance),
        })
    }
}

/// A track at one scan. Its candidates are `first_candidate .. first_candidate + candidates` of
/// [`TrackSet::candidates`]; none at all means that the file said nothing about detections.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrackPoint {
    pub time_s: f64,
    /// Index into [`TrackSet::sensor_ids`]; `None` where the file does not say.
    pub sensor: Option<u32>,
    pub estimate: Estimate,
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
    /// Whether its points are directions instead of places.
    pub fn is_of_bearings(&self) -> bool {
        self.tracks
            .iter()
            .find_map(|track| track.points.first())
            .is_some_and(|point| point.estimate.bearing().is_some())
    }

    /// Only the points of the named sensors; tracks without any are left out. Candidates keep their places.
    ///
    /// # Errors
    /// A fault for each name that is not a sensor of these tracks.
    pub fn only_sensors(mut self, sensor_ids: &[String]) -> Result<TrackSet, Vec<Fault>> {
        let known: Vec<&str> = self.sensor_ids.iter().map(String::as_str).collect();
        check_known("tracks have", &known, sensor_ids)?;
        let kept: Vec<&String> = self
            .sensor_ids
            .iter()
            .filter(|id| sensor_ids.contains(id))
            .collect();
        let place_of = |sensor: u32| {
            kept.iter()
                .position(|id| **id == self.sensor_ids[sensor as usize])
        };
        for track in &mut self.tracks {
            track.points.retain_mut(|point| {
                let place = point.sensor.and_then(place_of);
                point.sensor = place.map(|place| place as u32);
                place.is_some()
            });
        }
        self.tracks.retain(|track| !track.points.is_empty());
        self.sensor_ids = kept.into_iter().cloned().collect();
        Ok(self)
    }

    /// The candidates of one point.
    pub fn candidates_of(&self, point: &TrackPoint) -> &[Candidate] {
        &self.candidates[point.first_candidate..point.first_candidate + point.candidates]
    }
}
