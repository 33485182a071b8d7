//! Tracks: what a tracker says the targets did, with the detections it gave them and how sure it was.

use super::attributes::Attributes;
use super::changes::Changes;
use super::fault::Fault;
use super::modes::{ModeRow, ModeTable};
use super::scan::check_known;
use super::space::{Frame, Place, Space};
use super::state::{Covariance, Packed, Position, State, from_upper_triangle, upper_triangle};
use super::time::TimeBase;
use nalgebra::{SMatrix, SVector};
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

impl Candidate {
    /// The more probable of the two: of equals a detection before ε, else `best`. What is not a number never wins.
    pub fn more_probable(best: Option<Candidate>, next: Candidate) -> Option<Candidate> {
        if next.probability.is_nan() {
            return best;
        }
        let Some(kept) = best else { return Some(next) };
        let is_first_detection = kept.detection.is_none() && next.detection.is_some();
        let wins = next.probability > kept.probability
            || (next.probability == kept.probability && is_first_detection);
        Some(if wins { next } else { kept })
    }
}

/// What a track says of its target at one scan. All points of a set are of its space.
#[derive(Debug, Clone, PartialEq)]
pub struct Kinematics {
    pub position: Place,
    pub velocity: Option<Place>,
    /// Of the coordinates, then their rates, on the axes of the space: 3, 10 or 21 numbers.
    pub covariance: Option<Packed>,
}

impl Kinematics {
    /// In the plane.
    pub fn of_plane(state: &State, has_velocity: bool, covariance: Option<&Covariance>) -> Self {
        Kinematics {
            position: Place::new(state[0], state[1], 0.0),
            velocity: has_velocity.then(|| Place::new(state[2], state[3], 0.0)),
            covariance: covariance.map(upper_triangle),
        }
    }

    /// Of the mean and covariance that [`GaussianState::pack_into`](super::state::GaussianState::pack_into) makes of a state of this space.
    pub fn unpack(space: Space, packed: &[f64]) -> Self {
        let axes = space.axes();
        let (position, rest) = packed.split_at(axes);
        let (velocity, covariance) = rest.split_at(axes);
        Kinematics {
            position: space.normal(place(position)),
            velocity: Some(place(velocity)),
            covariance: Some(covariance.into()),
        }
    }

    /// In the plane.
    pub fn position_m(&self) -> Position {
        self.position.xy()
    }

    /// The same of a set in the plane: without a third axis, with the marginal of its covariance.
    #[must_use]
    pub fn in_plane(&self) -> Kinematics {
        let of_plane = |whole: SMatrix<f64, 6, 6>| {
            let kept = [0, 1, 3, 4];
            Covariance::from_fn(|row, column| whole[(kept[row], kept[column])])
        };
        let marginal = self.covariance().map(of_plane);
        Kinematics {
            position: Space::Plane.cut(self.position),
            velocity: self.velocity.map(|velocity| Space::Plane.cut(velocity)),
            covariance: marginal
                .as_ref()
                .map(upper_triangle)
                .or_else(|| self.covariance.clone()),
        }
    }

    /// In the plane: the velocity is 0 where there is none.
    pub fn state(&self) -> State {
        let (position_m, velocity_mps) = (self.position, self.velocity.unwrap_or_default());
        State::new(position_m.x, position_m.y, velocity_mps.x, velocity_mps.y)
    }

    /// `N` / 2 coordinates, then their rates, which are 0 where there are none.
    pub fn mean<const N: usize>(&self) -> SVector<f64, N> {
        let (position, velocity) = (self.position, self.velocity.unwrap_or_default());
        SVector::from_fn(|row, _| {
            if row < N / 2 {
                position[row]
            } else {
                velocity[row - N / 2]
            }
        })
    }

    /// The covariance of N variables; `None` of what has others.
    pub fn covariance<const N: usize>(&self) -> Option<SMatrix<f64, N, N>> {
        let elements = self.covariance.as_deref()?;
        (elements.len() == N * (N + 1) / 2).then(|| from_upper_triangle(elements))
    }
}

fn place(coordinates: &[f64]) -> Place {
    let mut place = Place::zeros();
    for (axis, coordinate) in coordinates.iter().enumerate() {
        place[axis] = *coordinate;
    }
    place
}

/// A track at one scan. Its candidates are `first_candidate .. first_candidate + candidates` of
/// [`TrackSet::candidates`]; none at all means that the file said nothing about detections.
#[derive(Debug, Clone, PartialEq)]
pub struct TrackPoint {
    pub time_s: f64,
    /// Index into [`TrackSet::sensor_ids`]; `None` where the file does not say.
    pub sensor: Option<u32>,
    pub estimate: Kinematics,
    /// Of a set in the plane: how high the target was, where that is known. No distance reads it.
    pub height_m: Option<f64>,
    pub status: Option<TrackStatus>,
    /// Normalised innovation squared of the update at this scan, the mean over its detections by their weights; `None` where
    /// there was no detection, or one that started the track.
    pub nis: Option<f64>,
    /// When the tracker knew of the point, where that is later than its time: tracks may begin in the past.
    pub known_at_s: Option<f64>,
    /// r: the probability that there was a target, where the tracker said one.
    pub existence: Option<f64>,
    /// Of [`TrackSet::modes`]: how probable each motion model was, where the tracker had several.
    pub mode_row: Option<ModeRow>,
    pub first_candidate: u32,
    pub candidates: u32,
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
    pub space: Space,
    pub frame: Option<Frame>,
    pub time_base: TimeBase,
    pub tracks: Vec<Track>,
    pub attributes: Attributes,
    /// Of attributes that are not the same at all points.
    pub changes: Changes,
    pub candidates: Vec<Candidate>,
    pub modes: ModeTable,
    /// Names of the detections that candidates refer to.
    pub detection_ids: Vec<String>,
    pub sensor_ids: Vec<String>,
}

impl TrackSet {
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
        self.space = self.space.of_points(!self.tracks.is_empty());
        self.sensor_ids = kept.into_iter().cloned().collect();
        Ok(self)
    }

    /// The same tracks in the plane; those of directions stay what they are.
    #[must_use]
    pub fn into_plane(mut self) -> TrackSet {
        if self.space == Space::Volume {
            self.space = Space::Plane;
            for point in self.tracks.iter_mut().flat_map(|track| &mut track.points) {
                point.estimate = point.estimate.in_plane();
            }
        }
        self
    }

    /// How probable each motion model was at one point; nothing where that is not told.
    pub fn modes_of(&self, point: &TrackPoint) -> &[f64] {
        let row = point.mode_row.and_then(|row| self.modes.row(row));
        row.unwrap_or_default()
    }

    /// The candidates of one point.
    pub fn candidates_of(&self, point: &TrackPoint) -> &[Candidate] {
        let first = point.first_candidate as usize;
        &self.candidates[first..first + point.candidates as usize]
    }

    /// The most probable candidate of one point, as [`Candidate::more_probable`] has it.
    pub fn most_probable(&self, point: &TrackPoint) -> Option<Candidate> {
        let candidates = self.candidates_of(point).iter().copied();
        candidates.fold(None, Candidate::more_probable)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::state::GaussianState;

    #[test]
    fn of_equals_the_first_detection_is_the_most_probable() {
        let of = |candidates: &[(Option<u32>, f64)]| {
            let candidates = candidates
                .iter()
                .map(|&(detection, probability)| Candidate {
                    detection,
                    probability,
                });
            let best = candidates.fold(None, Candidate::more_probable);
            best.map(|best| (best.detection, best.probability))
        };
        let tied = [(None, 0.4), (Some(7), 0.4), (Some(3), 0.4)];
        assert_eq!(of(&tied), Some((Some(7), 0.4)));
        assert_eq!(of(&[(Some(1), f64::NAN), (None, 0.0)]), Some((None, 0.0)));
        assert_eq!(of(&[(Some(1), f64::NAN)]), None);
    }

    fn kinematics<const N: usize>() -> Kinematics {
        let state = GaussianState::<N> {
            mean: SVector::from_fn(|row, _| row as f64 - 1.0),
            covariance: SMatrix::identity() * 9.0,
        };
        let mut packed = Vec::new();
        state.pack_into(&mut packed);
        Kinematics::unpack(Space::of_packed(packed.len()), &packed)
    }

    #[test]
    fn a_state_of_any_space_has_its_axes_and_its_covariance() {
        let (plane, volume) = (kinematics::<4>(), kinematics::<6>());
        assert_eq!(plane.state(), State::new(-1.0, 0.0, 1.0, 2.0));
        assert_eq!(plane.covariance(), Some(Covariance::identity() * 9.0));
        assert_eq!(volume.position, Place::new(-1.0, 0.0, 1.0));
        assert_eq!(volume.velocity, Some(Place::new(2.0, 3.0, 4.0)));
        let covariance = volume.covariance::<6>();
        assert_eq!(covariance, Some(SMatrix::identity() * 9.0));
        assert_eq!(volume.covariance::<4>(), None, "it has six variables");
        let bearing = kinematics::<2>();
        assert_eq!(bearing.position.x, std::f64::consts::TAU - 1.0);
    }

    #[test]
    fn a_point_in_the_plane_is_small() {
        assert!(size_of::<TrackPoint>() <= 240);
    }
}
