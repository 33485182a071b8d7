//! The space that truth, tracks or detections lie in, and where on the Earth its origin is.

use super::fault::Fault;
use super::state::packed_len;
use nalgebra::SVector;
use serde::{Deserialize, Serialize};
use std::f64::consts::{PI, TAU};

/// East, north, up (m), or their rates; of a direction the bearing clockwise from north (rad) in the first place. Axes that a
/// space lacks are 0.
pub type Place = SVector<f64, 3>;

/// What the places of a set are: all of them are of one space.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Space {
    /// Directions alone, clockwise from north.
    Bearing,
    #[default]
    Plane,
    Volume,
}

impl Space {
    /// The space of states that are packed into so many numbers.
    pub fn of_packed(numbers: usize) -> Space {
        let spaces = [Space::Bearing, Space::Plane];
        let found = spaces
            .into_iter()
            .find(|space| packed_len(2 * space.axes()) == numbers);
        found.unwrap_or(Space::Volume)
    }

    /// This space, or the plane for a set without a point: nothing there needs a space of its own.
    pub fn of_points(self, has_points: bool) -> Space {
        if has_points { self } else { Space::default() }
    }

    pub fn axes(self) -> usize {
        match self {
            Space::Bearing => 1,
            Space::Plane => 2,
            Space::Volume => 3,
        }
    }

    /// Whether its points are places in metres instead of directions.
    pub fn has_places(self) -> bool {
        self != Space::Bearing
    }

    /// The same place without what this space does not have: its height in the plane.
    pub fn cut(self, mut place: Place) -> Place {
        if self == Space::Plane {
            place.z = 0.0;
        }
        place
    }

    /// What leads from one place to another: of directions the shorter way, between −π and π.
    pub fn difference(self, from: &Place, to: &Place) -> Place {
        let mut difference = to - from;
        if self == Space::Bearing {
            difference.x = (difference.x + PI).rem_euclid(TAU) - PI;
        }
        difference
    }

    /// The same place with a bearing from 0 to 2π.
    pub fn normal(self, mut place: Place) -> Place {
        if self == Space::Bearing {
            place.x = place.x.rem_euclid(TAU);
        }
        place
    }
}

/// Where the origin of a set is on the Earth (WGS 84). In the plane x and y are those of the oblique stereographic projection
/// about it, in a volume axes point east, north and up there. Angles stay as they were given, so that they are written so.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema))]
#[serde(try_from = "RawFrame")]
pub struct Frame {
    #[serde(rename = "lat_deg")]
    latitude_deg: f64,
    #[serde(rename = "lon_deg")]
    longitude_deg: f64,
    height_m: f64,
}

/// A frame that nobody has checked yet.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawFrame {
    lat_deg: f64,
    lon_deg: f64,
    #[serde(default)]
    height_m: f64,
}

impl TryFrom<RawFrame> for Frame {
    type Error = String;

    fn try_from(raw: RawFrame) -> Result<Self, String> {
        Frame::new(raw.lat_deg, raw.lon_deg, raw.height_m).map_err(|faults| {
            let details: Vec<String> = faults.into_iter().map(|fault| fault.detail).collect();
            details.join("; ")
        })
    }
}

impl Frame {
    /// `height_m` above the ellipsoid.
    ///
    /// # Errors
    /// A fault for each value that is not on the Earth.
    pub fn new(latitude_deg: f64, longitude_deg: f64, height_m: f64) -> Result<Self, Vec<Fault>> {
        let mut faults = Vec::new();
        for (name, value, most) in [
            ("latitude_deg", latitude_deg, 90.0),
            ("longitude_deg", longitude_deg, 180.0),
            ("height_m", height_m, f64::MAX),
        ] {
            if value.is_nan() || value.abs() > most {
                let detail = format!("{value} is no {name} of an origin");
                faults.push(
                    Fault::new(format!("/{name}"), "out_of_range", detail)
                        .allowing(format!("-{most} to {most}")),
                );
            }
        }
        if faults.is_empty() {
            Ok(Frame {
                latitude_deg,
                longitude_deg,
                height_m,
            })
        } else {
            Err(faults)
        }
    }

    pub fn latitude_deg(&self) -> f64 {
        self.latitude_deg
    }

    pub fn longitude_deg(&self) -> f64 {
        self.longitude_deg
    }

    pub fn height_m(&self) -> f64 {
        self.height_m
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn from_one_direction_to_another_is_the_shorter_way() {
        let bearing = |degrees: f64| Place::new(degrees.to_radians(), 0.0, 0.0);
        for (from, to, wanted) in [(350.0, 10.0, 20.0), (10.0, 350.0, -20.0), (0.0, 90.0, 90.0)] {
            let found = Space::Bearing.difference(&bearing(from), &bearing(to));
            assert!((found.x.to_degrees() - wanted).abs() < 1e-12, "{found}");
        }
        let (from, to) = (Place::new(1.0, 2.0, 3.0), Place::new(5.0, 0.0, 9.0));
        assert_eq!(
            Space::Volume.difference(&from, &to),
            Place::new(4.0, -2.0, 6.0)
        );
        assert!((Space::Bearing.normal(bearing(-90.0)).x - 1.5 * PI).abs() < 1e-15);
    }

    #[test]
    fn an_origin_is_on_the_earth() {
        assert_eq!(Frame::new(-90.0, 180.0, -400.0).unwrap().height_m(), -400.0);
        let faults = Frame::new(90.5, f64::NAN, f64::INFINITY).unwrap_err();
        let pointers: Vec<&str> = faults.iter().map(|fault| fault.pointer.as_str()).collect();
        assert_eq!(pointers, ["/latitude_deg", "/longitude_deg", "/height_m"]);
    }
}
