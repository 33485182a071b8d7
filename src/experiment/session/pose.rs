//! Where a sensor that moves is at a pushed scan, and how it is turned.

use super::named;
use crate::experiment::request::fields::{BEARING, PLACE, VELOCITY};
use crate::formats::named_pose;
use crate::geodesy::Stereographic;
use crate::model::fault::Fault;
use crate::model::pose::Pose;
use crate::model::space::Frame;
use crate::registry::{Bound, Kind, Object, number, optional};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// Of a body that sees a horizon.
const TILT: Kind = Kind::Number {
    min: Bound::Excluding(-90.0),
    max: Bound::Excluding(90.0),
    unit: "deg",
};
const SIGMA_M: Kind = number(0.0, 1e6, "m");
const SIGMA_MPS: Kind = number(0.0, 1e5, "m/s");
const SIGMA_DEG: Kind = number(0.0, 180.0, "deg");

/// Its numbers are those of [`Pose::NAMES`], or a latitude and longitude.
pub static PUSHED_POSE: Object = Object {
    name: "PushedPose",
    summary: "Where the sensor is at this scan (x_m, y_m, or lat_deg, lon_deg in a session with an origin), how it moves and how it is turned. What is absent is 0.",
    fields: &[
        optional("x_m", "East.", PLACE),
        optional("y_m", "North.", PLACE),
        optional("z_m", "Up.", PLACE),
        optional(
            "vx_mps",
            "Velocity, east; absent where range rates are over ground already.",
            VELOCITY,
        ),
        optional("vy_mps", "The same, north.", VELOCITY),
        optional("vz_mps", "The same, up.", VELOCITY),
        optional(
            "heading_deg",
            "Of the bow, clockwise from north; needed where bearings are relative.",
            BEARING,
        ),
        optional("pitch_deg", "Bow up.", TILT),
        optional("roll_deg", "Starboard side down.", TILT),
        optional("sigma_x_m", "Standard deviation of x_m.", SIGMA_M),
        optional("sigma_y_m", "Standard deviation of y_m.", SIGMA_M),
        optional("sigma_z_m", "Standard deviation of z_m.", SIGMA_M),
        optional("sigma_vx_mps", "Standard deviation of vx_mps.", SIGMA_MPS),
        optional("sigma_vy_mps", "Standard deviation of vy_mps.", SIGMA_MPS),
        optional("sigma_vz_mps", "Standard deviation of vz_mps.", SIGMA_MPS),
        optional(
            "sigma_heading_deg",
            "Standard deviation of heading_deg.",
            SIGMA_DEG,
        ),
        optional(
            "sigma_pitch_deg",
            "Standard deviation of pitch_deg.",
            SIGMA_DEG,
        ),
        optional(
            "sigma_roll_deg",
            "Standard deviation of roll_deg.",
            SIGMA_DEG,
        ),
        optional("lat_deg", "Latitude.", number(-90.0, 90.0, "deg")),
        optional("lon_deg", "Longitude.", number(-180.0, 180.0, "deg")),
    ],
};

const NAMES: [&str; 20] = {
    let mut names = [""; 20];
    let mut index = 0;
    while index < names.len() {
        names[index] = PUSHED_POSE.fields[index].name;
        index += 1;
    }
    names
};

const HEADING: usize = 6;
const LAT_DEG: usize = 18;
const LON_DEG: usize = 19;

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PushedPose([Option<f64>; NAMES.len()]);

impl PushedPose {
    pub fn has_heading(&self) -> bool {
        self.0[HEADING].is_some()
    }

    /// Puts east and north in the place of a latitude and longitude.
    ///
    /// # Errors
    /// No place, or one in two ways; no origin.
    pub fn put_in_plane(&mut self, frame: Option<Frame>) -> Result<(), Fault> {
        let earth = [LAT_DEG, LON_DEG].map(|index| self.0[index].take());
        let missing = || {
            let detail = "a pose needs a place";
            Fault::new("/pose", "missing", detail).allowing("x_m, y_m; or lat_deg, lon_deg")
        };
        match (earth, &self.0[..2]) {
            ([None, None], [Some(_), Some(_)]) => Ok(()),
            ([Some(lat_deg), Some(lon_deg)], [None, None]) => {
                let Some(frame) = frame else {
                    let detail = "the session has no origin from which latitudes are measured";
                    let fault = Fault::new("/pose/lat_deg", "no_frame", detail);
                    return Err(fault.allowing("x_m, y_m"));
                };
                let place_m = Stereographic::from(frame).project(lat_deg, lon_deg);
                (self.0[0], self.0[1]) = (Some(place_m.x), Some(place_m.y));
                Ok(())
            }
            _ => Err(missing()),
        }
    }

    /// As a recording has it.
    pub fn of(pose: &Pose) -> Self {
        let mut values = [None; NAMES.len()];
        values[..Pose::NAMES.len()].copy_from_slice(&named_pose(pose));
        PushedPose(values)
    }

    pub fn pose(&self) -> Pose {
        let mut values = [None; Pose::NAMES.len()];
        values.copy_from_slice(&self.0[..Pose::NAMES.len()]);
        Pose::from_named(&values)
    }
}

impl Serialize for PushedPose {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        named::serialize(serializer, None, &NAMES, &self.0)
    }
}

impl<'de> Deserialize<'de> for PushedPose {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        named::deserialize(deserializer, None, &NAMES).map(|(_, values)| PushedPose(values))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_numbers_are_those_of_a_pose() {
        assert_eq!(NAMES[..18], Pose::NAMES);
        assert_eq!([NAMES[LAT_DEG], NAMES[LON_DEG]], ["lat_deg", "lon_deg"]);
    }

    #[test]
    fn a_pose_survives_being_written() {
        let text = r#"{"x_m":1.5,"heading_deg":30.0,"lon_deg":7.25}"#;
        let pose: PushedPose = serde_json::from_str(text).unwrap();
        assert!(pose.has_heading());
        assert_eq!(serde_json::to_string(&pose).unwrap(), text);
        assert!(serde_json::from_str::<PushedPose>(r#"{"x":1.5}"#).is_err());
    }
}
