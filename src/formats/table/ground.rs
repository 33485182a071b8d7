//! Latitudes and longitudes of a table, until all of them are known and the plane can be chosen.

use crate::formats::Reading;
use crate::formats::feed::Middle;
use crate::geodesy::{Stereographic, is_on_earth};
use crate::model::fault::Fault;
use crate::model::space::{Frame, Place};

/// What the rows have shown so far.
#[derive(Debug, Default)]
pub struct Ground {
    middle: Middle,
}

impl Ground {
    /// Whether there is such a place.
    pub fn add(&mut self, lat_deg: f64, lon_deg: f64) -> bool {
        let is_sound = is_on_earth(lat_deg, lon_deg);
        if is_sound {
            self.middle.add(lat_deg, lon_deg);
        }
        is_sound
    }

    /// The origin that was told, else the middle of the places, rounded to a hundredth of a degree.
    ///
    /// # Errors
    /// None of sound places.
    pub fn frame(&self, reading: &Reading) -> Result<Option<Frame>, Vec<Fault>> {
        match reading.origin {
            Some(frame) => Ok(Some(frame)),
            None => self.middle.frame(),
        }
    }

    /// The plane of a frame.
    pub fn plane(&self, frame: Option<Frame>) -> Option<Stereographic> {
        frame.map(|frame| Stereographic::about(frame.latitude_deg(), frame.longitude_deg()))
    }
}

/// Puts a longitude, latitude and a velocity east and north there into the plane.
pub fn settle(plane: &Stereographic, position: &mut Place, velocity: Option<&mut Place>) {
    let (lon_deg, lat_deg) = (position.x, position.y);
    let place_m = plane.project(lat_deg, lon_deg);
    (position.x, position.y) = (place_m.x, place_m.y);
    if let Some(velocity) = velocity {
        let (sin, cos) = plane.turn_rad(lat_deg, lon_deg).sin_cos();
        let (east, north) = (velocity.x, velocity.y);
        (velocity.x, velocity.y) = (east * cos + north * sin, north * cos - east * sin);
    }
}
