//! Where the gates of a finished job's tracks lay: each track is predicted to each of its scans once more, from the point before.
//!
//! # Symbols
//! ẑ, S expected measurement and innovation covariance; γ threshold of the squared distance; D values of a measurement.

use super::auto_filter::settle;
use super::reports;
use super::track::needs_of;
use crate::experiment::input::sensors;
use crate::experiment::request::methods::TrackingSpec;
use crate::filtering::{Filter, WithFilter};
use crate::gating::ellipsoidal::EllipsoidalGate;
use crate::hypotheses::region;
use crate::model::scan::{Recording, Scan};
use crate::model::sensing::MeasurementModel;
use crate::model::sensor::{Sensor, SensorSettings};
use crate::model::state::{GaussianState, Position, PositionCovariance};
use crate::model::track::{Track, TrackPoint, TrackSet};
use nalgebra::Matrix2;
use serde::Deserialize;
use serde::de::IgnoredAny;
use serde_json::Value;

/// The gates of some tracks.
#[derive(Debug, Clone, PartialEq)]
pub struct Gates<'a> {
    /// γ.
    pub threshold: f64,
    pub gates: Vec<Gate<'a>>,
}

/// A track's gate at one scan.
#[derive(Debug, Clone, PartialEq)]
pub struct Gate<'a> {
    pub track_id: &'a str,
    pub time_s: f64,
    pub sensor_id: &'a str,
    /// Where the track was expected.
    pub place_m: Position,
    pub region: Region,
}

/// What lies within squared distance γ of ẑ, where S is that of the place, or of range and bearing. With range rates it is the
/// shadow of the gate of three values on these two.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Region {
    Plane {
        covariance_m2: PositionCovariance,
    },
    /// Covariance in m², m rad, rad².
    Polar {
        sensor_m: Position,
        range_m: f64,
        bearing_rad: f64,
        covariance: Matrix2<f64>,
    },
}

/// What the request of a finished job says of how it tracked.
#[derive(Deserialize)]
struct Tracked {
    #[serde(flatten)]
    tracking: TrackingSpec,
    /// Of a job that put tracks together.
    correlator: Option<IgnoredAny>,
}

/// The gates of the tracks that are `wanted`. `None` where the job of this spec had none in the plane: it did not track, its
/// tracks were directions or put together from those of several sensors, it chose by origin, or every detection was a candidate.
pub fn compute_gates<'a>(
    spec: &Value,
    (recording, known): (&Recording, &[SensorSettings]),
    tracks: &'a TrackSet,
    wanted: impl Fn(&Track) -> bool,
) -> Option<Gates<'a>> {
    let Tracked {
        tracking,
        correlator: None,
    } = Tracked::deserialize(spec).ok()?
    else {
        return None;
    };
    let named = settle(&tracking, recording).filter;
    let probability = tracking.tracker.lifecycle.gate_probability;
    if needs_of(&tracking.associator).is_by_origin() || probability >= 1.0 {
        return None;
    }
    let sensors = sensors::resolve(recording, known, &named, &mut Vec::new()).ok()?;
    if !named.filter.is_known_by_kinematics() {
        return None;
    }
    let recording = reports::as_taken(recording, known, &named.filter, &mut Vec::new());
    let gate = EllipsoidalGate::new(probability);
    let dimensions = sensors.iter().map(|sensor| sensor.report.dimensions());
    let walk = Walk {
        sensors: &sensors,
        scans: &recording.scans,
        set: tracks,
        threshold: gate.threshold(dimensions.max()?),
        gate,
        wanted,
    };
    named.filter.with(walk)
}

/// What the predictions need besides a filter.
struct Walk<'s, 'a, W> {
    sensors: &'s [Sensor],
    scans: &'s [Scan],
    set: &'a TrackSet,
    gate: EllipsoidalGate,
    /// γ.
    threshold: f64,
    wanted: W,
}

impl<'a, W: Fn(&Track) -> bool> WithFilter for Walk<'_, 'a, W> {
    type Output = Option<Gates<'a>>;

    fn in_plane<F: Filter<4>>(self, filter: F) -> Option<Gates<'a>> {
        Some(self.all(&filter))
    }

    fn in_volume<F: Filter<6>>(self, filter: F) -> Option<Gates<'a>> {
        Some(self.all(&filter))
    }

    fn of_bearings<F: Filter<2>>(self, _filter: F) -> Option<Gates<'a>> {
        None
    }
}

impl<'a, W: Fn(&Track) -> bool> Walk<'_, 'a, W> {
    fn all<F: Filter<K>, const K: usize>(&self, filter: &F) -> Gates<'a> {
        let mut gates = Vec::new();
        for track in self.set.tracks.iter().filter(|track| (self.wanted)(track)) {
            for pair in track.points.windows(2) {
                if self.was_gated(&pair[1]) {
                    gates.extend(self.gate(filter, (track, &pair[0], &pair[1])));
                }
            }
        }
        Gates {
            threshold: self.threshold,
            gates,
        }
    }
}

impl<'a, W> Walk<'_, 'a, W> {
    /// The second of two detections that start a track was not looked for in a gate of the track.
    fn was_gated(&self, point: &TrackPoint) -> bool {
        point.nis.is_some()
            || self
                .set
                .candidates_of(point)
                .iter()
                .all(|candidate| candidate.detection.is_none())
    }

    fn gate<F: Filter<K>, const K: usize>(
        &self,
        filter: &F,
        (track, before, point): (&'a Track, &TrackPoint, &TrackPoint),
    ) -> Option<Gate<'a>> {
        let kinematics = GaussianState {
            mean: before.estimate.mean::<K>(),
            covariance: before.estimate.covariance()?,
        };
        let sensor_id = self.set.sensor_ids[point.sensor? as usize].as_str();
        let sensor = self
            .sensors
            .iter()
            .position(|sensor| sensor.sensor_id == sensor_id)?;
        let mut report = self.report_at(point.time_s, sensor);
        if K > 4 {
            // A slant range is none along the ground: the gate is drawn as that of the place.
            report = report.converted();
        }
        let dt_s = point.time_s - before.time_s;
        let expected = region::expect(filter, &report, &kinematics, dt_s)?;
        let covariance = expected.covariance * self.scale_of(&report);
        let region = match (report.place_m(), expected.angle) {
            (Some(sensor_m), Some(_)) => Region::Polar {
                sensor_m,
                range_m: expected.measurement[0],
                bearing_rad: expected.measurement[1],
                covariance,
            },
            _ => Region::Plane {
                covariance_m2: covariance,
            },
        };
        Some(Gate {
            track_id: &track.track_id,
            time_s: point.time_s,
            sensor_id,
            place_m: expected.place_m,
            region,
        })
    }

    /// What a sensor reports in its scan of this time.
    fn report_at(&self, time_s: f64, sensor: usize) -> MeasurementModel {
        let is_before = |scan: &Scan| (scan.time_s, scan.sensor) < (time_s, sensor);
        let scan = self.scans.get(self.scans.partition_point(is_before));
        let sensor = &self.sensors[sensor];
        scan.map_or(sensor.report, |scan| sensor.report_in(scan))
    }

    /// All gates are told by one threshold: the covariance of a report of fewer values is made smaller instead.
    fn scale_of(&self, report: &MeasurementModel) -> f64 {
        self.gate.threshold(report.dimensions()) / self.threshold
    }
}
