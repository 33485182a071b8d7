//! Recorded or simulated detections: a list of scans, each one revisit of one sensor.

use super::beside::Beside;
use super::fault::Fault;
use super::own::Own;
use super::pose::Pose;
use super::scan_numbers;
use super::sensor::SensorSettings;
use super::space::Frame;
use super::state::Position;
use super::time::TimeBase;
use std::ops::Range;

/// What a sensor reported for one detection. Bearings are clockwise from north (y), elevations above the horizontal, in radians.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Measurement {
    Position {
        x_m: f64,
        y_m: f64,
    },
    RangeBearing {
        range_m: f64,
        bearing_rad: f64,
        range_rate_mps: Option<f64>,
    },
    Bearing {
        bearing_rad: f64,
    },
    /// A place in space.
    Position3 {
        x_m: f64,
        y_m: f64,
        z_m: f64,
    },
    /// The range is a slant range.
    RangeBearingElevation {
        range_m: f64,
        bearing_rad: f64,
        elevation_rad: f64,
        range_rate_mps: Option<f64>,
    },
    BearingElevation {
        bearing_rad: f64,
        elevation_rad: f64,
    },
}

impl Measurement {
    /// The Cartesian position of a position report in the plane, else `None`.
    pub fn position(&self) -> Option<Position> {
        match *self {
            Measurement::Position { x_m, y_m } | Measurement::Position3 { x_m, y_m, .. } => {
                Some(Position::new(x_m, y_m))
            }
            _ => None,
        }
    }

    /// Whether it says how high its target is, by itself or with the place of its sensor.
    pub fn tells_height(&self) -> bool {
        matches!(
            self,
            Measurement::Position3 { .. } | Measurement::RangeBearingElevation { .. }
        )
    }

    /// Whether it is of directions alone.
    pub fn is_direction(&self) -> bool {
        matches!(
            self,
            Measurement::Bearing { .. } | Measurement::BearingElevation { .. }
        )
    }

    /// The third coordinate of a place in space.
    pub fn z_m(&self) -> Option<f64> {
        match *self {
            Measurement::Position3 { z_m, .. } => Some(z_m),
            _ => None,
        }
    }

    pub fn elevation_rad(&self) -> Option<f64> {
        match *self {
            Measurement::RangeBearingElevation { elevation_rad, .. }
            | Measurement::BearingElevation { elevation_rad, .. } => Some(elevation_rad),
            _ => None,
        }
    }

    /// What it says of the plane: of a slant range what lies along the ground. A range rate along the slant is none along the
    /// ground.
    #[inline]
    #[must_use]
    pub fn flat(&self) -> Self {
        match *self {
            Measurement::Position3 { x_m, y_m, .. } => Measurement::Position { x_m, y_m },
            Measurement::RangeBearingElevation {
                range_m,
                bearing_rad,
                elevation_rad,
                ..
            } => Measurement::RangeBearing {
                range_m: range_m * elevation_rad.cos(),
                bearing_rad,
                range_rate_mps: None,
            },
            Measurement::BearingElevation { bearing_rad, .. } => {
                Measurement::Bearing { bearing_rad }
            }
            other => other,
        }
    }

    /// The Cartesian position of a position report or of a polar one seen from `place_m`; `None` for a bearing alone.
    pub fn position_seen_from(&self, place_m: &Position) -> Option<Position> {
        match self.flat() {
            Measurement::RangeBearing {
                range_m,
                bearing_rad,
                ..
            } => Some(place_m + Position::new(bearing_rad.sin(), bearing_rad.cos()) * range_m),
            _ => self.position(),
        }
    }

    pub fn is_finite(&self) -> bool {
        match *self {
            Measurement::Position { x_m, y_m } => x_m.is_finite() && y_m.is_finite(),
            Measurement::RangeBearing {
                range_m,
                bearing_rad,
                range_rate_mps,
            } => {
                range_m.is_finite()
                    && bearing_rad.is_finite()
                    && range_rate_mps.is_none_or(f64::is_finite)
            }
            Measurement::Bearing { bearing_rad } => bearing_rad.is_finite(),
            Measurement::Position3 { x_m, y_m, z_m } => {
                [x_m, y_m, z_m].into_iter().all(f64::is_finite)
            }
            Measurement::RangeBearingElevation {
                range_m,
                bearing_rad,
                elevation_rad,
                range_rate_mps,
            } => {
                [range_m, bearing_rad, elevation_rad]
                    .into_iter()
                    .all(f64::is_finite)
                    && range_rate_mps.is_none_or(f64::is_finite)
            }
            Measurement::BearingElevation {
                bearing_rad,
                elevation_rad,
            } => bearing_rad.is_finite() && elevation_rad.is_finite(),
        }
    }
}

/// One detection. `origin` is the index of the target it really came from in [`Recording::targets`];
/// `None` is clutter where the recording knows origins, and "unknown" where it does not.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Detection {
    pub measurement: Measurement,
    pub origin: Option<u32>,
    /// Strength of the echo, in whatever unit the sensor reports; only compared with others of the same scan.
    pub amplitude: Option<f64>,
}

/// The time of a scan whose detections have times of their own: their mean (s); 0 of none.
pub fn mean_time_s(times_s: &[f64]) -> f64 {
    let Some(&first_s) = times_s.first() else {
        return 0.0;
    };
    // Equal times stay what they are, to the bit.
    let later_s: f64 = times_s.iter().map(|time_s| time_s - first_s).sum();
    first_s + later_s / times_s.len() as f64
}

/// One revisit of one sensor.
#[derive(Debug, Clone, PartialEq)]
pub struct Scan {
    /// The file's own; without a file 1, 2, … in (time, sensor) order. What is missing among them: [`super::scan_numbers`].
    pub number: u32,
    pub time_s: f64,
    /// Index into [`Recording::sensors`].
    pub sensor: usize,
    /// Of a sensor that moves; else it is where its settings say.
    pub pose: Option<Pose>,
    pub detections: Vec<Detection>,
    /// What they have of their own, one entry each; empty where no detection of the scan has any.
    pub own: Vec<Own>,
}

impl Scan {
    /// What one of its detections has of its own.
    pub fn own_of(&self, detection: usize) -> Own {
        self.own.get(detection).copied().unwrap_or_default()
    }

    /// Where its sensor is in the plane: at `place_m` where it does not move.
    pub fn sensor_place_m(&self, place_m: Position) -> Position {
        self.pose.map_or(place_m, |pose| pose.place.xy())
    }
}

/// The parts of a [`Recording`]; [`Recording::new`] checks that they fit together.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct RecordingParts {
    pub frame: Option<Frame>,
    pub time_base: TimeBase,
    pub sensors: Vec<SensorSettings>,
    /// In order of time, then sensor; scans that saw nothing are here too.
    pub scans: Vec<Scan>,
    /// One identity a detection, in scan order, unique within its scan. Its place in this list is the detection's index in the
    /// recording.
    pub detection_ids: Vec<String>,
    /// What is known of the detections besides, in the same order.
    pub beside: Beside,
    /// Names of the targets that origins refer to.
    pub targets: Vec<String>,
    /// Whether the recording says which target each detection came from.
    pub origins_known: bool,
}

impl RecordingParts {
    /// Whether any detection says how high its target is.
    pub fn is_in_volume(&self) -> bool {
        self.detections()
            .any(|detection| detection.measurement.tells_height())
    }

    /// The third coordinates of the detections; empty where none has one.
    pub fn z_m(&self) -> Vec<Option<f64>> {
        let heights = self.detections().map(|one| one.measurement.z_m());
        let heights: Vec<Option<f64>> = heights.collect();
        if heights.iter().all(Option::is_none) {
            Vec::new()
        } else {
            heights
        }
    }

    /// The detections of all scans.
    pub fn detections(&self) -> impl Iterator<Item = &Detection> {
        self.scans.iter().flat_map(|scan| &scan.detections)
    }

    /// Each scan, with the index of its first detection in the recording.
    pub fn scans_with_firsts(&self) -> impl Iterator<Item = (usize, &Scan)> {
        let mut next = 0;
        self.scans.iter().map(move |scan| {
            let first = next;
            next += scan.detections.len();
            (first, scan)
        })
    }

    /// For those who name detections by their index.
    pub fn index_detections(&self) -> DetectionIndex<'_> {
        let firsts = self.scans_with_firsts().map(|(first, _)| first);
        DetectionIndex {
            firsts: firsts.collect(),
            scans: &self.scans,
        }
    }
}

/// Finds detections by their index in the recording.
pub struct DetectionIndex<'a> {
    /// Of the first detection of each scan.
    firsts: Vec<usize>,
    scans: &'a [Scan],
}

impl<'a> DetectionIndex<'a> {
    /// Indices of a scan's detections.
    pub fn range(&self, scan: usize) -> Range<usize> {
        let first = self.firsts[scan];
        first..first + self.scans[scan].detections.len()
    }

    /// The detection of this index, if there is one.
    pub fn get(&self, index: usize) -> Option<&'a Detection> {
        // Of scans that begin at the same index, all but the last are empty.
        let behind = self.firsts.partition_point(|&first| first <= index);
        let scan = behind.checked_sub(1)?;
        self.scans[scan].detections.get(index - self.firsts[scan])
    }
}

/// A checked recording: scans in time order, values finite, every index in range.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Recording(RecordingParts);

impl std::ops::Deref for Recording {
    type Target = RecordingParts;
    fn deref(&self) -> &RecordingParts {
        &self.0
    }
}

impl Recording {
    /// # Errors
    /// All faults: scans out of order, indices out of range, values that are not finite.
    pub fn new(parts: RecordingParts) -> Result<Self, Vec<Fault>> {
        let mut faults = Vec::new();
        check_scans(&parts, &mut faults);
        check_detections(&parts, &mut faults);
        if faults.is_empty() {
            Ok(Recording(parts))
        } else {
            Err(faults)
        }
    }

    /// The parts, to make a changed recording of.
    pub fn into_parts(self) -> RecordingParts {
        self.0
    }

    /// Says where on the Earth its origin is.
    pub fn place_at(&mut self, frame: Frame) {
        self.0.frame = Some(frame);
    }

    /// Says other things of the same sensors; gives what was said.
    pub fn replace_sensors(&mut self, sensors: Vec<SensorSettings>) -> Vec<SensorSettings> {
        debug_assert_eq!(sensors.len(), self.sensors.len());
        std::mem::replace(&mut self.0.sensors, sensors)
    }

    pub fn set_time_base(&mut self, base: TimeBase) {
        self.0.time_base = base;
    }

    /// How many there are in all scans.
    pub fn detection_count(&self) -> usize {
        self.detection_ids.len()
    }

    /// Only the scans of the named sensors, with everything else kept.
    ///
    /// # Errors
    /// A fault for each name that is not a sensor of this recording.
    pub fn only_sensors(&self, sensor_ids: &[String]) -> Result<Recording, Vec<Fault>> {
        let known: Vec<&str> = self
            .sensors
            .iter()
            .map(|sensor| sensor.sensor_id.as_str())
            .collect();
        check_known("recording has", &known, sensor_ids)?;
        let mut parts = RecordingParts {
            frame: self.frame,
            time_base: self.time_base,
            targets: self.targets.clone(),
            origins_known: self.origins_known,
            ..Default::default()
        };
        let kept: Vec<usize> = (0..self.sensors.len())
            .filter(|&index| sensor_ids.contains(&self.sensors[index].sensor_id))
            .collect();
        parts.sensors = kept
            .iter()
            .map(|&index| self.sensors[index].clone())
            .collect();
        // One sensor of scans that were counted through all sensors would seem to lack those of the others.
        let is_counted_anew =
            kept.len() == 1 && self.sensors.len() > 1 && !scan_numbers::are_by_sensor(&self.scans);
        for (first, scan) in self.scans_with_firsts() {
            let Some(sensor) = kept.iter().position(|&index| index == scan.sensor) else {
                continue;
            };
            let number = if is_counted_anew {
                parts.scans.len() as u32 + 1
            } else {
                scan.number
            };
            parts.scans.push(Scan {
                number,
                sensor,
                ..scan.clone()
            });
            let detections = first..first + scan.detections.len();
            parts.beside.extend(&self.beside, detections.clone());
            let ids = &self.detection_ids[detections];
            parts.detection_ids.extend_from_slice(ids);
        }
        Recording::new(parts)
    }
}

/// A fault for each of the wanted sensors that is not known; `who` as in "the recording has no sensor 'x'".
pub(super) fn check_known(who: &str, known: &[&str], wanted: &[String]) -> Result<(), Vec<Fault>> {
    let fault = |(index, id): (usize, &String)| {
        Fault::new(
            format!("/{index}"),
            "unknown_value",
            format!("the {who} no sensor '{id}'"),
        )
        .allowing(known.join(", "))
    };
    let faults: Vec<Fault> = wanted
        .iter()
        .enumerate()
        .filter(|(_, id)| !known.contains(&id.as_str()))
        .map(fault)
        .collect();
    if faults.is_empty() {
        Ok(())
    } else {
        Err(faults)
    }
}

fn check_scans(parts: &RecordingParts, faults: &mut Vec<Fault>) {
    for (index, scan) in parts.scans.iter().enumerate() {
        let pointer = || format!("/scans/{index}");
        if !scan.time_s.is_finite() {
            faults.push(Fault::new(
                pointer(),
                "not_finite",
                "time_s is not a finite number",
            ));
        }
        if scan.pose.is_some_and(|pose| !pose.is_finite()) {
            faults.push(Fault::new(
                pointer(),
                "not_finite",
                "the sensor's pose is not of finite numbers",
            ));
        }
        if scan.sensor >= parts.sensors.len() {
            faults.push(Fault::new(
                pointer(),
                "out_of_range",
                "the scan's sensor does not exist",
            ));
        }
        if index > 0
            && (parts.scans[index - 1].time_s, parts.scans[index - 1].sensor)
                >= (scan.time_s, scan.sensor)
        {
            faults.push(Fault::new(
                pointer(),
                "unsorted",
                "scans are not in order of time and sensor",
            ));
        }
    }
}

fn check_detections(parts: &RecordingParts, faults: &mut Vec<Fault>) {
    let of_scans = parts
        .scans
        .iter()
        .map(|scan| (&scan.own[..], scan.detections.len()));
    faults.extend(super::own::faults(of_scans));
    if !parts.beside.fits(parts.detection_ids.len()) {
        let detail = "what is known beside the detections is not of all of them";
        faults.push(Fault::new("/beside", "malformed", detail));
    }
    if parts.detection_ids.len() != parts.detections().count() {
        faults.push(Fault::new(
            "/detection_ids",
            "malformed",
            "there is not one identity for each detection",
        ));
    }
    for (index, detection) in parts.detections().enumerate() {
        if !detection.measurement.is_finite()
            || detection
                .amplitude
                .is_some_and(|amplitude| !amplitude.is_finite())
        {
            faults.push(Fault::new(
                format!("/detections/{index}"),
                "not_finite",
                "a measured value is not a finite number",
            ));
        }
        if detection
            .origin
            .is_some_and(|origin| origin as usize >= parts.targets.len())
        {
            faults.push(Fault::new(
                format!("/detections/{index}"),
                "out_of_range",
                "the detection's origin is not a target",
            ));
        }
    }
}
