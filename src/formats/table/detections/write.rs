//! Detections as rows, with the columns that their recording needs.

use super::own::OwnLayout;
use super::poses::PoseLayout;
use crate::formats::table::Sink;
use crate::formats::table::degrees::degrees;
use crate::formats::table::estimate::rounded_deg;
use crate::geodesy::Stereographic;
use crate::model::own::Own;
use crate::model::scan::{Detection, Measurement, Recording, Scan};
use crate::model::state::Position;
use std::io;

/// Writes every detection, and a row without one for each scan that saw nothing.
///
/// # Errors
/// What the output says.
pub fn write(recording: &Recording, sink: &mut dyn Sink) -> io::Result<()> {
    let layout = Layout::for_recording(recording);
    let mut columns = layout.columns();
    columns.extend(recording.beside.attributes.keys());
    sink.begin(&columns)?;
    write_rows(recording, layout, sink)
}

/// Writes the rows under a header of these columns.
///
/// # Errors
/// What the output says.
pub fn write_rows(recording: &Recording, layout: Layout, sink: &mut dyn Sink) -> io::Result<()> {
    let plane = recording.frame.map(Stereographic::from);
    for (first, scan) in recording.scans_with_firsts() {
        if scan.detections.is_empty() {
            write_row(recording, scan, None, layout, sink)?;
            let nothing = Own::default();
            write_beside(
                (recording, scan, plane.as_ref()),
                (None, &nothing),
                layout,
                sink,
            )?;
        }
        for (index, detection) in scan.detections.iter().enumerate() {
            let (found, own) = (Some((first + index, detection)), scan.own_of(index));
            write_row(recording, scan, found, layout, sink)?;
            write_beside(
                (recording, scan, plane.as_ref()),
                (found, &own),
                layout,
                sink,
            )?;
        }
    }
    Ok(())
}

/// Which optional columns a recording needs.
#[derive(Clone, Copy)]
pub struct Layout {
    position: bool,
    range: bool,
    bearing: bool,
    elevation: bool,
    range_rate: bool,
    amplitude: bool,
    origin: bool,
    z: bool,
    /// Latitude and longitude.
    earth: bool,
    height: bool,
    own: OwnLayout,
    pose: PoseLayout,
}

impl Layout {
    /// Needs what another needs, too.
    pub fn join(&mut self, other: &Layout) {
        self.position |= other.position;
        self.range |= other.range;
        self.bearing |= other.bearing;
        self.elevation |= other.elevation;
        self.range_rate |= other.range_rate;
        self.amplitude |= other.amplitude;
        self.origin |= other.origin;
        self.z |= other.z;
        self.earth |= other.earth;
        self.height |= other.height;
        self.own.join(&other.own);
        self.pose.join(&other.pose);
    }

    pub fn for_recording(recording: &Recording) -> Self {
        let has = |wanted: fn(&Measurement) -> bool| {
            recording
                .detections()
                .any(|detection| wanted(&detection.measurement))
        };
        let range =
            has(|measurement| matches!(measurement.flat(), Measurement::RangeBearing { .. }));
        let bearing = range || has(Measurement::is_direction);
        let range_rate = has(|measurement| polar_of(measurement).3.is_some());
        let amplitude = recording
            .detections()
            .any(|detection| detection.amplitude.is_some());
        let position = !bearing || has(|measurement| measurement.position().is_some());
        Layout {
            position,
            range,
            bearing,
            elevation: has(|measurement| measurement.elevation_rad().is_some()),
            range_rate,
            amplitude,
            origin: recording.origins_known,
            z: has(|measurement| measurement.z_m().is_some()),
            earth: recording.frame.is_some(),
            height: !recording.beside.heights_m.is_empty(),
            own: OwnLayout::for_recording(recording),
            pose: PoseLayout::for_recording(recording),
        }
    }

    /// Attributes not among them.
    pub fn columns(self) -> Vec<&'static str> {
        let mut columns = vec!["time_s", "scan", "sensor_id", "detection_id"];
        columns.extend(
            self.position
                .then_some(["x_m", "y_m"])
                .into_iter()
                .flatten(),
        );
        columns.extend(self.z.then_some("z_m"));
        columns.extend(self.range.then_some("range_m"));
        columns.extend(self.bearing.then_some("bearing_deg"));
        columns.extend(self.elevation.then_some("elevation_deg"));
        columns.extend(self.range_rate.then_some("range_rate_mps"));
        columns.extend(self.amplitude.then_some("amplitude"));
        columns.extend(self.origin.then_some("truth_id"));
        columns.extend(
            self.earth
                .then_some(["lat_deg", "lon_deg"])
                .into_iter()
                .flatten(),
        );
        columns.extend(self.height.then_some("height_m"));
        columns.extend(self.own.columns());
        columns.extend(self.pose.columns());
        columns
    }
}

fn write_row(
    recording: &Recording,
    scan: &Scan,
    found: Option<(usize, &Detection)>,
    layout: Layout,
    sink: &mut dyn Sink,
) -> io::Result<()> {
    let detection = found.map(|(_, detection)| detection);
    let own_time_s = found.and_then(|(index, _)| recording.beside.times_s.get(index));
    sink.number(Some(own_time_s.copied().unwrap_or(scan.time_s)))?;
    sink.number(Some(f64::from(scan.number)))?;
    sink.text(Some(&recording.sensors[scan.sensor].sensor_id))?;
    sink.text(found.map(|(index, _)| recording.detection_ids[index].as_str()))?;
    let measurement = detection.map(|detection| detection.measurement);
    let position = measurement.and_then(|measurement| measurement.position());
    let (range_m, bearing_rad, elevation_rad, range_rate_mps) = measurement
        .as_ref()
        .map_or((None, None, None, None), polar_of);
    if layout.position {
        sink.number(position.map(|place_m| place_m.x))?;
        sink.number(position.map(|place_m| place_m.y))?;
    }
    if layout.z {
        sink.number(measurement.and_then(|measurement| measurement.z_m()))?;
    }
    if layout.range {
        sink.number(range_m)?;
    }
    if layout.bearing {
        sink.number(bearing_rad.map(degrees))?;
    }
    if layout.elevation {
        sink.number(elevation_rad.map(degrees))?;
    }
    if layout.range_rate {
        sink.number(range_rate_mps)?;
    }
    if layout.amplitude {
        sink.number(detection.and_then(|detection| detection.amplitude))?;
    }
    if layout.origin {
        let origin = detection.and_then(|detection| detection.origin);
        sink.text(origin.map(|origin| recording.targets[origin as usize].as_str()))?;
    }
    Ok(())
}

/// Range, bearing, elevation and range rate, as far as they were measured.
fn polar_of(measurement: &Measurement) -> (Option<f64>, Option<f64>, Option<f64>, Option<f64>) {
    match *measurement {
        Measurement::Position { .. } | Measurement::Position3 { .. } => (None, None, None, None),
        Measurement::RangeBearing {
            range_m,
            bearing_rad,
            range_rate_mps,
        } => (Some(range_m), Some(bearing_rad), None, range_rate_mps),
        Measurement::RangeBearingElevation {
            range_m,
            bearing_rad,
            elevation_rad,
            range_rate_mps,
        } => (
            Some(range_m),
            Some(bearing_rad),
            Some(elevation_rad),
            range_rate_mps,
        ),
        Measurement::Bearing { bearing_rad } => (None, Some(bearing_rad), None, None),
        Measurement::BearingElevation {
            bearing_rad,
            elevation_rad,
        } => (None, Some(bearing_rad), Some(elevation_rad), None),
    }
}

/// Where it is on the Earth, how high, where its sensor is, and its attributes; ends the row.
fn write_beside(
    (recording, scan, plane): (&Recording, &Scan, Option<&Stereographic>),
    (found, own): (Option<(usize, &Detection)>, &Own),
    layout: Layout,
    sink: &mut dyn Sink,
) -> io::Result<()> {
    let beside = &recording.beside;
    if layout.earth {
        let place_m = found.and_then(|(_, detection)| place_m(recording, scan, detection));
        let earth = plane
            .zip(place_m)
            .map(|(plane, place_m)| plane.unproject(&place_m));
        sink.number(earth.map(|(lat_deg, _)| rounded_deg(lat_deg)))?;
        sink.number(earth.map(|(_, lon_deg)| rounded_deg(lon_deg)))?;
    }
    if layout.height {
        let height_m = found.and_then(|(index, _)| beside.heights_m.get(index).copied());
        sink.number(height_m.flatten())?;
    }
    layout.own.write(own, sink)?;
    layout.pose.write(scan.pose.as_ref(), sink)?;
    for labels in beside.attributes.values() {
        sink.text(found.and_then(|(index, _)| labels.get(index)))?;
    }
    sink.end_row()
}

/// Where a detection is in the plane; of a range and bearing that needs the place of the sensor.
fn place_m(recording: &Recording, scan: &Scan, detection: &Detection) -> Option<Position> {
    let settings = &recording.sensors[scan.sensor];
    let known_m = settings
        .x_m
        .zip(settings.y_m)
        .map(|(x_m, y_m)| Position::new(x_m, y_m));
    let moved_m = scan.pose.map(|pose| pose.place.xy());
    match moved_m.or(known_m) {
        Some(place_m) => detection.measurement.position_seen_from(&place_m),
        None => detection.measurement.position(),
    }
}
