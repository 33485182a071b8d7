//! Symbols for tracks that do not say which detections they took: the detection of the same scan nearest to the track.
//!
//! A position report is where it says; a polar one is converted with the place of its sensor; a bearing alone is nowhere
//! and no symbol. The symbol of a track point is the nearest detection with a distance of at most `gate_m`, ties to the one
//! listed first, ε when there is none. Distances are along three axes where the tracks are of a volume and every detection has a
//! third coordinate. It is not one to one: two tracks may take the same detection.

use super::nearest_point::{Place, PlaceTree};
use crate::model::fault::Fault;
use crate::model::scan::{Measurement, Recording, Scan};
use crate::model::sensor::SensorSettings;
use crate::model::space::{self, Space};
use crate::model::state::Position;

pub struct NearestDetection {
    /// Detections without a position.
    pub bearings_alone: usize,
    /// Of the distances.
    pub space: Space,
    gate_m: f64,
    trees: Vec<PlaceTree>,
}

impl NearestDetection {
    /// `sensors` are those of the recording, in its order; the tracks are of `space`.
    ///
    /// # Errors
    /// A fault for each sensor that reports ranges and bearings and whose place is not known.
    pub fn new(
        recording: &Recording,
        sensors: &[SensorSettings],
        space: Space,
        gate_m: f64,
    ) -> Result<Self, Vec<Fault>> {
        let places = places_of(recording, sensors)?;
        let mut seen = recording.detections();
        let is_high = recording.is_in_volume() && seen.all(|one| one.measurement.z_m().is_some());
        let space = if is_high { space } else { Space::Plane };
        let mut bearings_alone = 0;
        let mut tree = |(first, scan): (usize, &Scan)| {
            let place_m = scan.sensor_place_m(places[scan.sensor]);
            let seen = (first..).zip(&scan.detections);
            let seen = seen.filter_map(|(index, detection)| {
                let position_m = detection.measurement.position_seen_from(&place_m)?;
                let z_m = detection.measurement.z_m();
                Some(Place {
                    position_m: space.cut(position_m.push(z_m.unwrap_or_default())),
                    index: index as u32,
                    rank: index as u32,
                })
            });
            let seen: Vec<Place> = seen.collect();
            bearings_alone += scan.detections.len() - seen.len();
            PlaceTree::new(seen)
        };
        let trees = recording.scans_with_firsts().map(&mut tree).collect();
        Ok(NearestDetection {
            bearings_alone,
            space,
            gate_m,
            trees,
        })
    }

    /// The detection of a scan that is nearest to a position.
    pub fn nearest(&self, scan: usize, position_m: &space::Place) -> Option<u32> {
        self.trees[scan].nearest(&self.space.cut(*position_m), self.gate_m)
    }
}

/// Where each sensor is; where nobody knows and no report needs it, (0, 0).
fn places_of(
    recording: &Recording,
    sensors: &[SensorSettings],
) -> Result<Vec<Position>, Vec<Fault>> {
    let mut is_polar = vec![false; sensors.len()];
    for scan in &recording.scans {
        let reports = scan.detections.iter();
        is_polar[scan.sensor] |= reports
            .map(|detection| detection.measurement.flat())
            .any(|it| matches!(it, Measurement::RangeBearing { .. }));
    }
    let (mut places, mut faults) = (Vec::new(), Vec::new());
    for (sensor, is_polar) in sensors.iter().zip(is_polar) {
        let place = sensor.x_m.zip(sensor.y_m);
        if is_polar && place.is_none() {
            let detail = format!(
                "the nearest detection to a track is found with the place of sensor '{}': x_m and y_m",
                sensor.sensor_id
            );
            faults.push(Fault::new("/sensors", "missing", detail));
        }
        places.push(place.map_or_else(Position::zeros, |(x_m, y_m)| Position::new(x_m, y_m)));
    }
    if faults.is_empty() {
        Ok(places)
    } else {
        Err(faults)
    }
}
