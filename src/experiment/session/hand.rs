//! A track that somebody begins by hand.

use super::scene::Scene;
use crate::experiment::request::draft::parse;
use crate::experiment::request::fields::{BEARING, PLACE, VELOCITY};
use crate::geodesy::Stereographic;
use crate::model::fault::Fault;
use crate::model::space::Space;
use crate::registry::{self, Kind, Object, above, number, optional};
use serde::{Deserialize, Serialize};
use serde_json::Value;

const RATE: Kind = number(-360.0, 360.0, "deg/s");

pub static HAND_TRACK: Object = Object {
    name: "HandTrack",
    summary: "A confirmed track at the time of the last scan: a place (x_m, y_m, or lat_deg, lon_deg in a session with an origin; z_m in space) with sigma_m and sigma_mps; in a session that tracks directions bearing_deg with sigma_deg and sigma_degps. Velocities are 0 when absent.",
    fields: &[
        optional("x_m", "East.", PLACE),
        optional("y_m", "North.", PLACE),
        optional("z_m", "Up.", PLACE),
        optional("lat_deg", "Latitude.", number(-90.0, 90.0, "deg")),
        optional("lon_deg", "Longitude.", number(-180.0, 180.0, "deg")),
        optional("vx_mps", "Velocity, east.", VELOCITY),
        optional("vy_mps", "Velocity, north.", VELOCITY),
        optional("vz_mps", "Velocity, up.", VELOCITY),
        optional(
            "sigma_m",
            "Standard deviation of the place, on each axis.",
            above(0.0, 1e6, "m"),
        ),
        optional(
            "sigma_mps",
            "Standard deviation of the velocity, on each axis.",
            above(0.0, 1e5, "m/s"),
        ),
        optional("bearing_deg", "Clockwise from north.", BEARING),
        optional("bearing_rate_degps", "How fast it grows.", RATE),
        optional(
            "sigma_deg",
            "Standard deviation of the bearing.",
            above(0.0, 180.0, "deg"),
        ),
        optional(
            "sigma_degps",
            "Standard deviation of its rate.",
            above(0.0, 360.0, "deg/s"),
        ),
    ],
};

/// As the log keeps it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct HandTrack {
    /// Mean, then the upper triangle of the covariance row by row.
    pub kinematics: Vec<f64>,
}

#[derive(Debug, Clone, Copy, Default, Deserialize)]
#[serde(default)]
struct Given {
    x_m: Option<f64>,
    y_m: Option<f64>,
    z_m: Option<f64>,
    lat_deg: Option<f64>,
    lon_deg: Option<f64>,
    vx_mps: f64,
    vy_mps: f64,
    vz_mps: f64,
    sigma_m: Option<f64>,
    sigma_mps: Option<f64>,
    bearing_deg: Option<f64>,
    bearing_rate_degps: f64,
    sigma_deg: Option<f64>,
    sigma_degps: Option<f64>,
}

/// Reads a track, with its place in the space of the session.
///
/// # Errors
/// All its faults.
pub fn read_track(value: &Value, scene: &Scene) -> Result<HandTrack, Vec<Fault>> {
    let mut faults = Vec::new();
    let checked = registry::check_into(value, &HAND_TRACK, &mut faults);
    if !faults.is_empty() {
        return Err(faults);
    }
    let mut given: Given = parse(&checked);
    let needed: &[&str] = match scene.space() {
        Space::Bearing => &["bearing_deg", "sigma_deg", "sigma_degps"],
        Space::Plane => &["x_m", "y_m", "sigma_m", "sigma_mps"],
        Space::Volume => &["x_m", "y_m", "z_m", "sigma_m", "sigma_mps"],
    };
    if let (Some(lat_deg), Some(lon_deg), Some(frame)) =
        (given.lat_deg, given.lon_deg, scene.frame())
    {
        let place_m = Stereographic::from(frame).project(lat_deg, lon_deg);
        (given.x_m, given.y_m) = (Some(place_m.x), Some(place_m.y));
    }
    for name in needed {
        if given.value(name).is_none() {
            let detail = format!("a track of this session needs {}", needed.join(", "));
            faults.push(Fault::new(format!("/{name}"), "missing", detail));
        }
    }
    if !faults.is_empty() {
        return Err(faults);
    }
    Ok(HandTrack {
        kinematics: given.packed(scene.space()),
    })
}

impl Given {
    fn value(&self, name: &str) -> Option<f64> {
        match name {
            "x_m" => self.x_m,
            "y_m" => self.y_m,
            "z_m" => self.z_m,
            "sigma_m" => self.sigma_m,
            "sigma_mps" => self.sigma_mps,
            "bearing_deg" => self.bearing_deg,
            "sigma_deg" => self.sigma_deg,
            _ => self.sigma_degps,
        }
    }

    /// Mean, and a covariance without correlations.
    fn packed(&self, space: Space) -> Vec<f64> {
        let place = [self.x_m, self.y_m, self.z_m].map(Option::unwrap_or_default);
        let velocity = [self.vx_mps, self.vy_mps, self.vz_mps];
        let (mut mean, sigmas, axes) = match space {
            Space::Bearing => {
                let bearing_deg = self.bearing_deg.unwrap_or_default();
                let mean = vec![
                    bearing_deg.to_radians(),
                    self.bearing_rate_degps.to_radians(),
                ];
                let sigmas = [self.sigma_deg, self.sigma_degps];
                (mean, sigmas.map(|sigma| sigma.map(f64::to_radians)), 1)
            }
            Space::Plane | Space::Volume => {
                let axes = if space == Space::Plane { 2 } else { 3 };
                let mean = [&place[..axes], &velocity[..axes]].concat();
                (mean, [self.sigma_m, self.sigma_mps], axes)
            }
        };
        for row in 0..2 * axes {
            let sigma = sigmas[row / axes].unwrap_or_default();
            mean.push(sigma * sigma);
            mean.extend(std::iter::repeat_n(0.0, 2 * axes - 1 - row));
        }
        mean
    }
}
