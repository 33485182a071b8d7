//! What is pushed into a session: scans, heartbeats, and what people do by hand. An entry is what the log keeps.

use super::reports::Reports;
use super::scene::Scene;
use crate::experiment::request::draft::parse;
use crate::experiment::request::fields::{BEARING, NAME, PLACE};
use crate::experiment::request::names::check_names;
use crate::model::fault::Fault;
use crate::model::scan::{Detection, Measurement, Scan};
use crate::model::space::Frame;
use crate::registry::{self, Kind, Object, default, list, number, optional, required, whole};
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// Numbers that every program reads exactly.
const MAX_SEQUENCE: i64 = 1 << 53;

static PUSHED_DETECTION: Object = Object {
    name: "PushedDetection",
    summary: "One detection: a place (x_m, y_m, or lat_deg, lon_deg in a session with an origin; z_m in space), a range and a bearing (elevation_deg in space), or a bearing.",
    fields: &[
        optional(
            "detection_id",
            "Unique within the scan; its number in the scan, from 1, when absent.",
            NAME,
        ),
        optional("x_m", "East.", PLACE),
        optional("y_m", "North.", PLACE),
        optional("z_m", "Up.", PLACE),
        optional("lat_deg", "Latitude.", number(-90.0, 90.0, "deg")),
        optional("lon_deg", "Longitude.", number(-180.0, 180.0, "deg")),
        optional("range_m", "From the sensor.", number(0.0, 1e9, "m")),
        optional("bearing_deg", "Clockwise from north.", BEARING),
        optional(
            "elevation_deg",
            "Above the horizontal.",
            number(-90.0, 90.0, "deg"),
        ),
        optional(
            "amplitude",
            "Strength of the echo, in the sensor's unit.",
            number(-1e30, 1e30, ""),
        ),
    ],
};

pub static PUSHED_SCAN: Object = Object {
    name: "PushedScan",
    summary: "One scan of one sensor. A scan that saw nothing is pushed as well: that a target was not detected is news.",
    fields: &[
        required("sensor_id", "Which of the session's sensors.", NAME),
        optional(
            "sequence",
            "Number of the scan with its sender, one more than the one before: what comes twice is taken once, and what is left out is told. The next number when absent.",
            whole(0, MAX_SEQUENCE, ""),
        ),
        required(
            "time_s",
            "When the scan was made; UTC epoch seconds, or seconds from whatever the feed chose.",
            number(-1e12, 1e12, "s"),
        ),
        optional(
            "heartbeat",
            "True: the sensor is alive at this time but made no scan, so nothing is missed.",
            Kind::Flag,
        ),
        default(
            "detections",
            "What was detected.",
            list(&Kind::Object(&PUSHED_DETECTION), 0, 50_000),
            "[]",
        ),
    ],
};

/// One entry of a session's log.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "entry", rename_all = "snake_case")]
pub enum Entry {
    Scan(PushedScan),
    /// A track is ended by hand.
    End {
        track_id: String,
    },
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PushedScan {
    pub sensor_id: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sequence: Option<u64>,
    pub time_s: f64,
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub heartbeat: bool,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub detections: Vec<PushedDetection>,
}

#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct PushedDetection {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub detection_id: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub x_m: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub y_m: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub z_m: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lat_deg: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lon_deg: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub range_m: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bearing_deg: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub elevation_deg: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub amplitude: Option<f64>,
}

/// Reads a pushed scan, with its places in the plane.
///
/// # Errors
/// All its faults.
pub fn read_scan(value: &Value, scene: &Scene) -> Result<PushedScan, Vec<Fault>> {
    let mut faults = Vec::new();
    let checked = registry::check_into(value, &PUSHED_SCAN, &mut faults);
    check_names(&checked, "", &mut faults);
    if !faults.is_empty() {
        return Err(faults);
    }
    let mut scan: PushedScan = parse(&checked);
    let Some(sensor) = scene.sensor_index(&scan.sensor_id) else {
        let detail = format!("the session has no sensor '{}'", scan.sensor_id);
        let fault = Fault::new("/sensor_id", "unknown_value", detail);
        return Err(vec![fault.allowing(scene.sensor_ids().join(", "))]);
    };
    if scan.heartbeat && !scan.detections.is_empty() {
        let detail = "a heartbeat has no detections";
        faults.push(Fault::new("/detections", "conflict", detail).allowing("no detections"));
    }
    if scan.detections.len() > scene.max_detections() {
        let detail = format!("a scan of {} detections", scan.detections.len());
        let most = format!("at most {} (max_detections)", scene.max_detections());
        faults.push(Fault::new("/detections", "too_large", detail).allowing(most));
    }
    let reports = scene.reports(sensor);
    for (index, detection) in scan.detections.iter_mut().enumerate() {
        let fault = detection.place_with(scene.frame()).err().or_else(|| {
            let given = detection.given();
            (given != reports.fields()).then(|| misfit(&scan.sensor_id, reports, &given))
        });
        let found = fault.into_iter().collect();
        faults.extend(registry::placed(&format!("/detections/{index}"), found));
    }
    faults.extend(repeated_ids(&scan.detections));
    if scene.needs_amplitudes() && scan.detections.iter().any(|one| one.amplitude.is_none()) {
        let detail = "the associator needs the amplitude of every detection";
        faults.push(Fault::new("/detections", "missing", detail).allowing("amplitude"));
    }
    if faults.is_empty() {
        Ok(scan)
    } else {
        Err(faults)
    }
}

fn misfit(sensor_id: &str, reports: Reports, given: &[&str]) -> Fault {
    let given = if given.is_empty() {
        "no measurement".to_owned()
    } else {
        given.join(", ")
    };
    let detail = format!(
        "{given} given; sensor '{sensor_id}' reports {}",
        reports.name()
    );
    Fault::new("", "conflict", detail).allowing(reports.fields().join(", "))
}

fn repeated_ids(detections: &[PushedDetection]) -> Option<Fault> {
    let mut ids: Vec<&str> = detections
        .iter()
        .filter_map(|one| one.detection_id.as_deref())
        .collect();
    ids.sort_unstable();
    let twice = ids.windows(2).find(|pair| pair[0] == pair[1])?;
    let detail = format!("detection '{}' is in the scan more than once", twice[0]);
    Some(Fault::new("/detections", "duplicate", detail))
}

impl PushedDetection {
    /// The measured values that are given, in the order of [`Reports::fields`].
    fn given(&self) -> Vec<&'static str> {
        [
            ("x_m", self.x_m),
            ("y_m", self.y_m),
            ("z_m", self.z_m),
            ("range_m", self.range_m),
            ("bearing_deg", self.bearing_deg),
            ("elevation_deg", self.elevation_deg),
        ]
        .into_iter()
        .filter(|(_, value)| value.is_some())
        .map(|(name, _)| name)
        .collect()
    }

    /// Puts east and north in the place of a latitude and longitude.
    fn place_with(&mut self, frame: Option<Frame>) -> Result<(), Fault> {
        let (lat_deg, lon_deg) = match (self.lat_deg.take(), self.lon_deg.take()) {
            (None, None) => return Ok(()),
            (Some(lat_deg), Some(lon_deg)) => (lat_deg, lon_deg),
            _ => {
                let detail = "a latitude needs a longitude";
                return Err(Fault::new("", "missing", detail).allowing("lat_deg, lon_deg"));
            }
        };
        if self.x_m.is_some() || self.y_m.is_some() {
            let detail = "lat_deg, lon_deg are given beside x_m, y_m";
            return Err(Fault::new("", "conflict", detail).allowing("one of both"));
        }
        let Some(frame) = frame else {
            let detail = "the session has no origin from which latitudes are measured";
            return Err(Fault::new("/lat_deg", "no_frame", detail).allowing("x_m, y_m"));
        };
        let place_m = crate::geodesy::Stereographic::from(frame).project(lat_deg, lon_deg);
        (self.x_m, self.y_m) = (Some(place_m.x), Some(place_m.y));
        Ok(())
    }

    fn measurement(&self) -> Option<Measurement> {
        let bearing_rad = self.bearing_deg.map(f64::to_radians);
        let elevation_rad = self.elevation_deg.map(f64::to_radians);
        Some(match (self.x_m, self.range_m, elevation_rad) {
            (Some(x_m), ..) => match (self.y_m?, self.z_m) {
                (y_m, Some(z_m)) => Measurement::Position3 { x_m, y_m, z_m },
                (y_m, None) => Measurement::Position { x_m, y_m },
            },
            (None, Some(range_m), None) => Measurement::RangeBearing {
                range_m,
                bearing_rad: bearing_rad?,
                range_rate_mps: None,
            },
            (None, Some(range_m), Some(elevation_rad)) => Measurement::RangeBearingElevation {
                range_m,
                bearing_rad: bearing_rad?,
                elevation_rad,
                range_rate_mps: None,
            },
            (None, None, None) => Measurement::Bearing {
                bearing_rad: bearing_rad?,
            },
            (None, None, Some(elevation_rad)) => Measurement::BearingElevation {
                bearing_rad: bearing_rad?,
                elevation_rad,
            },
        })
    }
}

impl PushedScan {
    /// The scan as a tracker takes it.
    pub fn scan(&self, number: u32, sensor: usize) -> Scan {
        let detection = |one: &PushedDetection| {
            Some(Detection {
                measurement: one.measurement()?,
                origin: None,
                amplitude: one.amplitude,
            })
        };
        Scan {
            number,
            time_s: self.time_s,
            sensor,
            pose: None,
            detections: self.detections.iter().filter_map(detection).collect(),
            own: Vec::new(),
        }
    }
}
