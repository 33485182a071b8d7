//! A pushed detection: what it says by name, as a request and the log have it, and as a tracker takes it.

use crate::experiment::request::fields::{
    BEARING, NAME, PLACE, SIGMA, SIGMA_BEARING, SIGMA_RATE, SPEED, VELOCITY,
};
use crate::experiment::session::named;
use crate::formats::degrees;
use crate::geodesy::Stereographic;
use crate::model::fault::Fault;
use crate::model::own::{Own, OwnNoise};
use crate::model::pose::Attitude;
use crate::model::scan::{Detection, Measurement};
use crate::model::space::Frame;
use crate::registry::{Bound, Kind, Object, number, optional};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// Times of pushed scans and detections.
pub const TIME: Kind = number(-1e12, 1e12, "s");
const CORRELATION: Kind = Kind::Number {
    min: Bound::Excluding(-1.0),
    max: Bound::Excluding(1.0),
    unit: "",
};

pub static PUSHED_DETECTION: Object = Object {
    name: "PushedDetection",
    summary: "One detection: a place (x_m, y_m, or lat_deg, lon_deg in a session with an origin; z_m in space), a range and a bearing (elevation_deg in space), or a bearing.",
    fields: &[
        optional(
            "detection_id",
            "Unique within the scan; its number in the scan, from 1, when absent.",
            NAME,
        ),
        optional(
            "time_s",
            "When it was made, where detections of a scan have times of their own: all of them then, and the scan is at their mean.",
            TIME,
        ),
        optional("x_m", "East.", PLACE),
        optional("y_m", "North.", PLACE),
        optional("z_m", "Up.", PLACE),
        optional("lat_deg", "Latitude.", number(-90.0, 90.0, "deg")),
        optional("lon_deg", "Longitude.", number(-180.0, 180.0, "deg")),
        optional("range_m", "From the sensor.", number(0.0, 1e9, "m")),
        optional(
            "bearing_deg",
            "Clockwise from north; from the bow of a sensor whose bearings are relative.",
            BEARING,
        ),
        optional(
            "elevation_deg",
            "Above the horizontal.",
            number(-90.0, 90.0, "deg"),
        ),
        optional(
            "range_rate_mps",
            "How fast the range grows, of a sensor with sigma_range_rate_mps.",
            VELOCITY,
        ),
        optional(
            "vx_mps",
            "Velocity that is reported with a place, east; of a sensor with sigma_speed_mps.",
            VELOCITY,
        ),
        optional("vy_mps", "The same, north.", VELOCITY),
        optional(
            "speed_mps",
            "With course_deg in the place of vx_mps, vy_mps.",
            SPEED,
        ),
        optional("course_deg", "Clockwise from north.", BEARING),
        optional(
            "amplitude",
            "Strength of the echo, in the sensor's unit.",
            number(-1e30, 1e30, ""),
        ),
        optional(
            "sigma_x_m",
            "Standard deviation of this report, where it is not as the sensor's.",
            SIGMA,
        ),
        optional("sigma_y_m", "The same, north.", SIGMA),
        optional(
            "correlation_xy",
            "Correlation of the errors of x and y.",
            CORRELATION,
        ),
        optional("sigma_z_m", "The same, up.", SIGMA),
        optional("sigma_range_m", "The same, of the range.", SIGMA),
        optional(
            "sigma_bearing_deg",
            "The same, of the bearing.",
            SIGMA_BEARING,
        ),
        optional(
            "sigma_elevation_deg",
            "The same, of the elevation.",
            SIGMA_BEARING,
        ),
        optional(
            "sigma_range_rate_mps",
            "The same, of the range rate.",
            SIGMA_RATE,
        ),
        optional("sigma_speed_mps", "The same, of the speed.", SIGMA_RATE),
        optional(
            "sigma_course_deg",
            "The same, of the course.",
            SIGMA_BEARING,
        ),
    ],
};

/// Its numbers, by name.
const NAMES: [&str; 25] = {
    let mut names = [""; 25];
    // The first field is the name of the detection.
    let mut index = 0;
    while index < names.len() {
        names[index] = PUSHED_DETECTION.fields[index + 1].name;
        index += 1;
    }
    names
};

const TIME_S: usize = 0;
const X_M: usize = 1;
const Y_M: usize = 2;
const Z_M: usize = 3;
const LAT_DEG: usize = 4;
const LON_DEG: usize = 5;
const RANGE_M: usize = 6;
const BEARING_DEG: usize = 7;
const ELEVATION_DEG: usize = 8;
const RANGE_RATE_MPS: usize = 9;
const VX_MPS: usize = 10;
const VY_MPS: usize = 11;
const SPEED_MPS: usize = 12;
const COURSE_DEG: usize = 13;
const AMPLITUDE: usize = 14;
/// The first of the noises, in the order of [`OwnNoise::NAMES`].
const NOISES: usize = 15;
/// What a sensor measures.
const MEASURED: [usize; 7] = [
    X_M,
    Y_M,
    Z_M,
    RANGE_M,
    BEARING_DEG,
    ELEVATION_DEG,
    RANGE_RATE_MPS,
];

/// What a sensor of a session takes besides places and directions.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Takes {
    pub range_rates: bool,
    pub velocities: bool,
}

#[derive(Debug, Clone, Default, PartialEq)]
pub struct PushedDetection {
    pub detection_id: Option<String>,
    values: [Option<f64>; NAMES.len()],
}

impl PushedDetection {
    /// What a sensor that tells no range rates pushes of a recorded detection.
    pub fn of(detection_id: String, detection: &Detection) -> Self {
        let measurement = &detection.measurement;
        let place = measurement.position();
        let range_m = match *measurement {
            Measurement::RangeBearing { range_m, .. }
            | Measurement::RangeBearingElevation { range_m, .. } => Some(range_m),
            _ => None,
        };
        let bearing_rad = match *measurement {
            Measurement::RangeBearing { bearing_rad, .. }
            | Measurement::RangeBearingElevation { bearing_rad, .. }
            | Measurement::Bearing { bearing_rad }
            | Measurement::BearingElevation { bearing_rad, .. } => Some(bearing_rad),
            Measurement::Position { .. } | Measurement::Position3 { .. } => None,
        };
        let mut pushed = PushedDetection {
            detection_id: Some(detection_id),
            ..PushedDetection::default()
        };
        let values = &mut pushed.values;
        (values[X_M], values[Y_M]) = (place.map(|place| place.x), place.map(|place| place.y));
        (values[Z_M], values[RANGE_M]) = (measurement.z_m(), range_m);
        values[BEARING_DEG] = bearing_rad.map(degrees);
        values[ELEVATION_DEG] = measurement.elevation_rad().map(degrees);
        values[AMPLITUDE] = detection.amplitude;
        pushed
    }

    /// The same with what a detection has of its own, a time among it where that is given, and what else a sensor takes.
    #[must_use]
    pub fn with_own(
        mut self,
        detection: &Detection,
        (own, time_s): (&Own, Option<f64>),
        takes: Takes,
    ) -> Self {
        let values = &mut self.values;
        values[TIME_S] = time_s;
        if let Some(velocity_mps) = own.velocity_mps.filter(|_| takes.velocities) {
            let [east, north] = velocity_mps.map(Some);
            (values[VX_MPS], values[VY_MPS]) = (east, north);
        }
        if takes.range_rates {
            values[RANGE_RATE_MPS] = range_rate_mps(&detection.measurement);
        }
        for (index, value) in own.noise.values().into_iter().enumerate() {
            let is_angle = OwnNoise::NAMES[index].ends_with("_deg");
            values[NOISES + index] =
                value.map(|value| if is_angle { degrees(value) } else { value });
        }
        self
    }

    /// What was measured alone, without range rate, velocity, time and noises.
    #[must_use]
    pub fn without_own(mut self) -> Self {
        for index in [TIME_S, RANGE_RATE_MPS, VX_MPS, VY_MPS] {
            self.values[index] = None;
        }
        self.values[NOISES..].fill(None);
        self
    }

    /// The measured values that are given.
    pub fn given(&self) -> Vec<&'static str> {
        let is_given = |index: &usize| self.values[*index].is_some();
        let given = MEASURED.into_iter().filter(is_given);
        given.map(|index| NAMES[index]).collect()
    }

    pub fn has_amplitude(&self) -> bool {
        self.values[AMPLITUDE].is_some()
    }

    pub fn has_velocity(&self) -> bool {
        self.values[VX_MPS].is_some()
    }

    /// When it was made, where that is its own.
    pub fn time_s(&self) -> Option<f64> {
        self.values[TIME_S]
    }

    /// Puts east and north in the place of a latitude and longitude, and of a speed and course.
    ///
    /// # Errors
    /// Half of a pair; both in two ways; no origin.
    pub fn put_in_plane(&mut self, frame: Option<Frame>) -> Result<(), Fault> {
        if let Some([lat_deg, lon_deg]) = self.pair_in_place_of([LAT_DEG, LON_DEG], [X_M, Y_M])? {
            let Some(frame) = frame else {
                let detail = "the session has no origin from which latitudes are measured";
                return Err(Fault::new("/lat_deg", "no_frame", detail).allowing("x_m, y_m"));
            };
            let place_m = Stereographic::from(frame).project(lat_deg, lon_deg);
            (self.values[X_M], self.values[Y_M]) = (Some(place_m.x), Some(place_m.y));
        }
        let motion = self.pair_in_place_of([SPEED_MPS, COURSE_DEG], [VX_MPS, VY_MPS])?;
        if let Some([speed_mps, course_deg]) = motion {
            let (east, north) = course_deg.to_radians().sin_cos();
            (self.values[VX_MPS], self.values[VY_MPS]) =
                (Some(speed_mps * east), Some(speed_mps * north));
        }
        if self.values[VX_MPS].is_some() != self.values[VY_MPS].is_some() {
            return Err(half_of([VX_MPS, VY_MPS]));
        }
        Ok(())
    }

    /// Takes two values out, which say the same as two others.
    fn pair_in_place_of(
        &mut self,
        pair: [usize; 2],
        others: [usize; 2],
    ) -> Result<Option<[f64; 2]>, Fault> {
        let values = match pair.map(|index| self.values[index].take()) {
            [None, None] => return Ok(None),
            [Some(first), Some(second)] => [first, second],
            _ => return Err(half_of(pair)),
        };
        if others.iter().any(|&index| self.values[index].is_some()) {
            let [first, second] = pair.map(|index| NAMES[index]);
            let [x, y] = others.map(|index| NAMES[index]);
            let detail = format!("{first}, {second} are given beside {x}, {y}");
            let fault = Fault::new(format!("/{first}"), "conflict", detail);
            return Err(fault.allowing("one of the two"));
        }
        Ok(Some(values))
    }

    /// Puts the bearing from north in the place of that from the bow, and the elevation above the horizon in that above the deck: in
    /// degrees, for a recording has them so.
    pub fn turn(&mut self, attitude: &Attitude) {
        let Some(bearing_rad) = self.values[BEARING_DEG].map(f64::to_radians) else {
            return;
        };
        let turned_rad = match self.values[ELEVATION_DEG].map(f64::to_radians) {
            None => attitude.bearing_of(bearing_rad),
            Some(elevation_rad) => {
                let (bearing_rad, elevation_rad) = attitude.direction(bearing_rad, elevation_rad);
                self.values[ELEVATION_DEG] = Some(elevation_rad.to_degrees());
                bearing_rad
            }
        };
        self.values[BEARING_DEG] = Some(turned_rad.to_degrees());
    }

    /// As a tracker takes it, of a scan at this time.
    pub fn detection(&self, scan_s: f64) -> Option<(Detection, Own)> {
        let detection = Detection {
            measurement: self.measurement()?,
            origin: None,
            amplitude: self.values[AMPLITUDE],
        };
        let noises = std::array::from_fn(|index| self.values[NOISES + index]);
        let own = Own {
            after_s: self.values[TIME_S].map_or(0.0, |time_s| time_s - scan_s),
            noise: OwnNoise::from_named(noises),
            velocity_mps: self.values[VX_MPS]
                .zip(self.values[VY_MPS])
                .map(<[f64; 2]>::from),
        };
        Some((detection, own))
    }

    fn measurement(&self) -> Option<Measurement> {
        let value = |index: usize| self.values[index];
        let bearing_rad = value(BEARING_DEG).map(f64::to_radians);
        let elevation_rad = value(ELEVATION_DEG).map(f64::to_radians);
        let range_rate_mps = value(RANGE_RATE_MPS);
        Some(match (value(X_M), value(RANGE_M), elevation_rad) {
            (Some(x_m), ..) => match (value(Y_M)?, value(Z_M)) {
                (y_m, Some(z_m)) => Measurement::Position3 { x_m, y_m, z_m },
                (y_m, None) => Measurement::Position { x_m, y_m },
            },
            (None, Some(range_m), None) => Measurement::RangeBearing {
                range_m,
                bearing_rad: bearing_rad?,
                range_rate_mps,
            },
            (None, Some(range_m), Some(elevation_rad)) => Measurement::RangeBearingElevation {
                range_m,
                bearing_rad: bearing_rad?,
                elevation_rad,
                range_rate_mps,
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

fn range_rate_mps(measurement: &Measurement) -> Option<f64> {
    match *measurement {
        Measurement::RangeBearing { range_rate_mps, .. }
        | Measurement::RangeBearingElevation { range_rate_mps, .. } => range_rate_mps,
        _ => None,
    }
}

fn half_of(pair: [usize; 2]) -> Fault {
    let [first, second] = pair.map(|index| NAMES[index]);
    let detail = format!("{first} and {second} come together");
    Fault::new("", "missing", detail).allowing(format!("{first}, {second}"))
}

impl Serialize for PushedDetection {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let id = self.detection_id.as_deref();
        named::serialize(
            serializer,
            id.map(|id| ("detection_id", id)),
            &NAMES,
            &self.values,
        )
    }
}

impl<'de> Deserialize<'de> for PushedDetection {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let (detection_id, values) =
            named::deserialize(deserializer, Some("detection_id"), &NAMES)?;
        Ok(PushedDetection {
            detection_id,
            values,
        })
    }
}
