//! From the plane or the volume of a dataset to latitude and longitude.

use super::refusal;
use crate::geodesy::{Geodetic, Stereographic, is_on_earth};
use crate::model::dataset::Dataset;
use crate::model::fault::Fault;
use crate::model::space::{Frame, Place, Space};

/// A place on the Earth; its height is above the ellipsoid where the dataset is a volume, else as it was given.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spot {
    pub time_s: f64,
    pub lat_deg: f64,
    pub lon_deg: f64,
    pub height_m: Option<f64>,
}

/// Nothing is farther from the origin: beyond, the plane is of the other side of the Earth (m).
const FARTHEST_M: f64 = 1e9;

/// Where the places of a dataset are.
pub struct Earth {
    origin: Geodetic,
    plane: Stereographic,
    space: Space,
}

impl Earth {
    /// # Errors
    /// `no_frame` of a dataset that does not know where its origin is.
    pub fn of(dataset: &Dataset, format: &str) -> Result<Earth, Box<Fault>> {
        let space = match dataset {
            Dataset::Detections(recording) if recording.is_in_volume() => Space::Volume,
            Dataset::Detections(_) => Space::Plane,
            Dataset::Truth(truth) => truth.space(),
            Dataset::Tracks(set) => set.space,
            _ => return Err(super::no_places(format).into()),
        };
        if !space.has_places() {
            return Err(super::no_places(format).into());
        }
        let frame = dataset.frame().ok_or_else(|| no_frame(format))?;
        Ok(Earth::about(&frame, space))
    }

    /// What heights count from: of a volume the ellipsoid, else nobody said.
    pub fn altitude_reference(&self) -> &'static str {
        match self.space {
            Space::Volume => "ellipsoid",
            _ => "unknown",
        }
    }

    pub fn about(frame: &Frame, space: Space) -> Earth {
        Earth {
            origin: Geodetic::from(frame),
            plane: Stereographic::from(*frame),
            space,
        }
    }

    /// # Errors
    /// A fault of a place so far from the origin that it is nowhere on the Earth.
    pub fn spot(
        &self,
        time_s: f64,
        place_m: &Place,
        height_m: Option<f64>,
    ) -> Result<Spot, Box<Fault>> {
        let (lat_deg, lon_deg, height_m) = match self.space {
            Space::Volume => {
                let there = self.origin.at_enu(place_m);
                (there.lat_deg, there.lon_deg, Some(there.height_m))
            }
            _ => {
                let (lat_deg, lon_deg) = self.plane.unproject(&place_m.xy());
                (lat_deg, lon_deg, height_m)
            }
        };
        let is_sound = is_on_earth(lat_deg, lon_deg)
            && height_m.is_none_or(f64::is_finite)
            && place_m.norm() < FARTHEST_M;
        is_sound
            .then_some(Spot {
                time_s,
                lat_deg,
                lon_deg,
                height_m,
            })
            .ok_or_else(|| {
                let detail = format!(
                    "the place ({} m, {} m) at {time_s} s is not on the Earth",
                    place_m.x, place_m.y
                );
                refusal("out_of_range", detail).into()
            })
    }
}

fn no_frame(format: &str) -> Fault {
    let detail = format!(
        "the dataset does not say where its origin is on the Earth, and '{format}' holds latitudes and longitudes"
    );
    refusal("no_frame", detail)
        .allowing("data read with `origin`: {\"lat_deg\": …, \"lon_deg\": …}; without it csv, json, stonesoup, parquet, arrow")
}
