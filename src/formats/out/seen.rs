//! Detections as places over the Earth, with what is known of each.

use super::earth::{Earth, Spot};
use super::{WriteError, refusal};
use crate::geodesy::{Geodetic, Stereographic};
use crate::model::dataset::Dataset;
use crate::model::fault::Fault;
use crate::model::scan::{Detection, Measurement, Recording, Scan};
use crate::model::space::{Frame, Place};
use crate::model::state::Position;

/// One detection.
pub struct Seen<'a> {
    pub time_s: f64,
    pub id: &'a str,
    pub sensor_id: &'a str,
    pub scan: u32,
    pub detection: &'a Detection,
    /// `None` of a bearing alone.
    pub spot: Option<Spot>,
    /// The target that it came from, where the recording knows.
    pub truth_id: Option<&'a str>,
    /// By the names of attributes, those that there are.
    pub attributes: Vec<(&'static str, &'a str)>,
}

/// Calls `use_one` with each detection. A range and a bearing become the place that trackers see: in the plane, the slant of the
/// range neglected.
///
/// # Errors
/// A sensor that reports ranges and has no place; a place that is not on the Earth; what `use_one` says.
pub fn for_each(
    dataset: &Dataset,
    earth: &Earth,
    mut use_one: impl FnMut(Seen) -> Result<(), WriteError>,
) -> Result<(), WriteError> {
    let Dataset::Detections(recording) = dataset else {
        return Ok(());
    };
    let places_m = sensor_places(recording);
    for (first, scan) in recording.scans_with_firsts() {
        for (index, detection) in (first..).zip(&scan.detections) {
            let time_s = time_of(recording, scan, index);
            let place_m = place_of(recording, scan, detection, places_m[scan.sensor])?;
            let z_m = detection.measurement.z_m().unwrap_or_default();
            let height_m = recording.beside.heights_m.get(index).copied().flatten();
            let place_m = place_m.map(|place_m| {
                place_in_space(recording, scan, detection).unwrap_or(place_m.push(z_m))
            });
            let spot = place_m
                .map(|place_m| earth.spot(time_s, &place_m, height_m))
                .transpose()?;
            let labels = recording.beside.attributes.iter();
            use_one(Seen {
                time_s,
                id: &recording.detection_ids[index],
                sensor_id: &recording.sensors[scan.sensor].sensor_id,
                scan: scan.number,
                detection,
                spot,
                truth_id: truth_of(recording, detection),
                attributes: labels
                    .filter_map(|(name, labels)| Some((*name, labels.get(index)?)))
                    .collect(),
            })?;
        }
    }
    Ok(())
}

/// When a detection was made: its own time where the recording has it, else that of its scan.
pub fn time_of(recording: &Recording, scan: &Scan, index: usize) -> f64 {
    let own_s = recording.beside.times_s.get(index);
    own_s.copied().unwrap_or(scan.time_s)
}

pub fn truth_of<'a>(recording: &'a Recording, detection: &Detection) -> Option<&'a str> {
    let origin = detection.origin?;
    Some(recording.targets[origin as usize].as_str())
}

/// Of sensors whose place is known.
fn sensor_places(recording: &Recording) -> Vec<Option<Position>> {
    let frame = recording.frame.as_ref();
    let place =
        |frame: &Frame, lat_deg, lon_deg| Stereographic::from(*frame).project(lat_deg, lon_deg);
    recording
        .sensors
        .iter()
        .map(|sensor| match (sensor.x_m, sensor.y_m) {
            (Some(x_m), Some(y_m)) => Some(Position::new(x_m, y_m)),
            _ => Some(place(frame?, sensor.lat_deg?, sensor.lon_deg?)),
        })
        .collect()
}

fn place_of(
    recording: &Recording,
    scan: &Scan,
    detection: &Detection,
    sensor_m: Option<Position>,
) -> Result<Option<Position>, Box<Fault>> {
    let from_m = scan.pose.map(|pose| pose.place.xy()).or(sensor_m);
    match (detection.measurement.flat(), from_m) {
        (Measurement::RangeBearing { .. }, None) => {
            let name = &recording.sensors[scan.sensor].sensor_id;
            let detail =
                format!("sensor '{name}' reports ranges, and the dataset does not say where it is");
            Err(Box::new(refusal("missing", detail)
                .allowing("`sensors` of the upload with x_m, y_m or lat_deg, lon_deg; or csv, json, stonesoup_polar")))
        }
        (measurement, from_m) => Ok(measurement.position_seen_from(&from_m.unwrap_or_default())),
    }
}

/// Where a slant range with its bearing and elevation is, seen on the axes of its sensor's own place.
fn place_in_space(recording: &Recording, scan: &Scan, detection: &Detection) -> Option<Place> {
    let Measurement::RangeBearingElevation {
        range_m,
        bearing_rad,
        elevation_rad,
        ..
    } = detection.measurement
    else {
        return None;
    };
    let (rise, level) = elevation_rad.sin_cos();
    let (east, north) = bearing_rad.sin_cos();
    let offset_m = Place::new(east * level, north * level, rise) * range_m;
    let sensor = &recording.sensors[scan.sensor];
    let (up_m, known) = (sensor.z_m, sensor.lat_deg.zip(sensor.lon_deg));
    if let (None, Some(frame), Some((lat_deg, lon_deg))) = (scan.pose, recording.frame, known) {
        let (origin, height_m) = (Geodetic::from(&frame), sensor.height_m.unwrap_or(0.0));
        let own = Geodetic {
            lat_deg,
            lon_deg,
            height_m,
        };
        return Some(origin.enu_of(&own) + own.turn_to(&origin) * offset_m);
    }
    let stands_m = Place::new(
        sensor.x_m.unwrap_or(0.0),
        sensor.y_m.unwrap_or(0.0),
        up_m.or(sensor.height_m).unwrap_or(0.0),
    );
    Some(scan.pose.map_or(stands_m, |pose| pose.place) + offset_m)
}

/// What a detection measured besides a position.
pub fn numbers(detection: &Detection) -> Vec<(&'static str, f64)> {
    let measurement = detection.measurement;
    let (range_m, bearing_rad, range_rate_mps) = match measurement {
        Measurement::Position { .. } | Measurement::Position3 { .. } => (None, None, None),
        Measurement::RangeBearing {
            range_m,
            bearing_rad,
            range_rate_mps,
        }
        | Measurement::RangeBearingElevation {
            range_m,
            bearing_rad,
            range_rate_mps,
            ..
        } => (Some(range_m), Some(bearing_rad), range_rate_mps),
        Measurement::Bearing { bearing_rad }
        | Measurement::BearingElevation { bearing_rad, .. } => (None, Some(bearing_rad), None),
    };
    let elevation_rad = measurement.elevation_rad();
    [
        ("range_m", range_m),
        ("bearing_deg", bearing_rad.map(f64::to_degrees)),
        ("elevation_deg", elevation_rad.map(f64::to_degrees)),
        ("range_rate_mps", range_rate_mps),
        ("amplitude", detection.amplitude),
    ]
    .into_iter()
    .filter_map(|(name, value)| Some((name, value?)))
    .collect()
}
