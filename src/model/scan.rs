//! Recorded or simulated detections: a list of scans, each one revisit of one sensor.

use super::fault::Fault;
use super::scan_numbers;
use super::sensor::SensorSettings;
use super::space::Frame;
use super::state::Position;

/// What a sensor reported for one detection. Bearings are clockwise from north (y), in radians.
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
}

impl Measurement {
    /// The Cartesian position of a position report, else `None`.
    pub fn position(&self) -> Option<Position> {
        match *self {
            Measurement::Position { x_m, y_m } => Some(Position::new(x_m, y_m)),
            _ => None,
        }
    }

    /// The Cartesian position of a position report or of a polar one seen from `place_m`; `None` for a bearing alone.
    pub fn position_seen_from(&self, place_m: &Position) -> Option<Position> {
        match *self {
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

/// One revisit of one sensor. Its detections are `first .. first + count` of [`Recording::detections`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scan {
    /// The file's own; without a file 1, 2, … in (time, sensor) order. What is missing among them: [`super::scan_numbers`].
    pub number: u32,
    pub time_s: f64,
    /// Index into [`Recording::sensors`].
    pub sensor: usize,
    pub first: usize,
    pub count: usize,
}

impl Scan {
    /// Indices of this scan's detections in the recording.
    pub fn range(&self) -> std::ops::Range<usize> {
        self.first..self.first + self.count
    }
}

/// The parts of a [`Recording`]; [`Recording::new`] checks that they fit together.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct RecordingParts {
    pub frame: Option<Frame>,
    pub sensors: Vec<SensorSettings>,
    /// In order of time, then sensor; scans that saw nothing are here too.
    pub scans: Vec<Scan>,
    /// In scan order.
    pub detections: Vec<Detection>,
    /// One identity a detection, unique within its scan.
    pub detection_ids: Vec<String>,
    /// Names of the targets that origins refer to.
    pub targets: Vec<String>,
    /// Whether the recording says which target each detection came from.
    pub origins_known: bool,
}

/// A checked recording: scans in time order, detections finite, every index in range.
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
    /// All faults: scans out of order or not contiguous, indices out of range, values that are not finite.
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

    /// The detections of one scan.
    pub fn detections_of(&self, scan: &Scan) -> &[Detection] {
        &self.0.detections[scan.range()]
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
        for scan in &self.scans {
            let Some(sensor) = kept.iter().position(|&index| index == scan.sensor) else {
                continue;
            };
            let first = parts.detections.len();
            let number = if is_counted_anew {
                parts.scans.len() as u32 + 1
            } else {
                scan.number
            };
            parts.scans.push(Scan {
                number,
                sensor,
                first,
                ..*scan
            });
            parts
                .detections
                .extend_from_slice(&self.detections[scan.range()]);
            parts
                .detection_ids
                .extend_from_slice(&self.detection_ids[scan.range()]);
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
    let mut next = 0;
    for (index, scan) in parts.scans.iter().enumerate() {
        let pointer = || format!("/scans/{index}");
        if !scan.time_s.is_finite() {
            faults.push(Fault::new(
                pointer(),
                "not_finite",
                "time_s is not a finite number",
            ));
        }
        if scan.sensor >= parts.sensors.len() {
            faults.push(Fault::new(
                pointer(),
                "out_of_range",
                "the scan's sensor does not exist",
            ));
        }
        if scan.first != next {
            faults.push(Fault::new(
                pointer(),
                "malformed",
                "the scan's detections do not follow those of the scan before",
            ));
        }
        next = scan.first + scan.count;
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
    if next != parts.detections.len() {
        faults.push(Fault::new(
            "/detections",
            "malformed",
            "there are detections outside every scan",
        ));
    }
}

fn check_detections(parts: &RecordingParts, faults: &mut Vec<Fault>) {
    if parts.detection_ids.len() != parts.detections.len() {
        faults.push(Fault::new(
            "/detection_ids",
            "malformed",
            "there is not one identity for each detection",
        ));
    }
    for (index, detection) in parts.detections.iter().enumerate() {
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
