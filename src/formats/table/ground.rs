//! Latitudes and longitudes of a table, until all of them are known and the plane can be chosen.

use crate::formats::Reading;
use crate::formats::feed::Middle;
use crate::geodesy::{Stereographic, is_on_earth, turned};
use crate::model::fault::Fault;
use crate::model::space::{Frame, Place};
use crate::model::state::Position;

/// What the rows have shown so far.
#[derive(Debug, Default)]
pub struct Ground {
    middle: Middle,
    /// A row that has its place in the plane and on the Earth: what the two say of the origin. The first, and the one farthest out.
    both: Option<[Both; 2]>,
}

/// A place in the plane (m), and its latitude and longitude.
#[derive(Debug, Clone, Copy)]
struct Both {
    place_m: Position,
    lat_deg: f64,
    lon_deg: f64,
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

    /// Notes a row that has its place in the plane and on the Earth.
    pub fn add_both(&mut self, place_m: Position, lat_deg: f64, lon_deg: f64) {
        if !is_on_earth(lat_deg, lon_deg) {
            return;
        }
        let one = Both {
            place_m,
            lat_deg,
            lon_deg,
        };
        let [_, far] = self.both.get_or_insert([one, one]);
        if place_m.norm() > far.place_m.norm() {
            *far = one;
        }
    }

    /// The origin that was told, else that from which rows were measured that have both, else the middle of the places, rounded to a hundredth of a degree.
    ///
    /// # Errors
    /// None of sound places.
    pub fn frame(&self, reading: &Reading) -> Result<Option<Frame>, Vec<Fault>> {
        match reading.origin {
            Some(frame) => Ok(Some(frame)),
            None => match self.both {
                Some(both) => Ok(origin_of(&both)),
                None => self.middle.frame(),
            },
        }
    }
}

/// The origin from which both places were measured, with as few decimals as fit; `None` where there is none.
fn origin_of(both: &[Both; 2]) -> Option<Frame> {
    let (mut lat_deg, mut lon_deg) = (both[1].lat_deg, both[1].lon_deg);
    for _ in 0..20 {
        let plane = Stereographic::about(lat_deg, lon_deg);
        let off_m = both[1].place_m - plane.project(both[1].lat_deg, both[1].lon_deg);
        (lat_deg, lon_deg) = plane.unproject(&-off_m);
    }
    for decimals in 0..=9 {
        let unit = 10_f64.powi(decimals);
        let rounded = |angle_deg: f64| (angle_deg * unit).round() / unit;
        let (lat_deg, lon_deg) = (rounded(lat_deg), rounded(lon_deg));
        if fits(both, &Stereographic::about(lat_deg, lon_deg)) {
            return Frame::new(lat_deg, lon_deg, 0.0).ok();
        }
    }
    None
}

/// Whether both places are where the plane has them.
fn fits(both: &[Both; 2], plane: &Stereographic) -> bool {
    let mut off_m = both
        .iter()
        .map(|one| (one.place_m - plane.project(one.lat_deg, one.lon_deg)).norm());
    off_m.all(|off_m| off_m < FIT_M)
}

/// How well an origin must fit (m): latitudes are written to a tenth of a millimetre.
const FIT_M: f64 = 1e-3;

/// Puts a longitude, latitude and a velocity east and north there into the plane.
pub fn settle(plane: &Stereographic, position: &mut Place, velocity: Option<&mut Place>) {
    let (lon_deg, lat_deg) = (position.x, position.y);
    let place_m = plane.project(lat_deg, lon_deg);
    (position.x, position.y) = (place_m.x, place_m.y);
    if let Some(velocity) = velocity {
        *velocity = turned(velocity, plane.turn_rad(lat_deg, lon_deg));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_origin_is_found_again_from_rows_with_both() {
        for (lat_deg, lon_deg) in [
            (50.77, -1.2),
            (63.4389029, 10.3990828),
            (-17.7, 179.95),
            (0.0, 0.0),
        ] {
            let plane = Stereographic::about(lat_deg, lon_deg);
            let mut ground = Ground::default();
            for place_m in [
                Position::new(100.0, -20.0),
                Position::new(-84_000.0, 210_000.0),
            ] {
                let (lat_deg, lon_deg) = plane.unproject(&place_m);
                let rounded = |angle_deg: f64| (angle_deg * 1e9).round() / 1e9;
                ground.add_both(place_m, rounded(lat_deg), rounded(lon_deg));
            }
            let found = ground.frame(&Reading::default()).unwrap().unwrap();
            assert_eq!(
                (found.latitude_deg(), found.longitude_deg()),
                (lat_deg, lon_deg)
            );
        }
        let mut wrong = Ground::default();
        wrong.add_both(Position::new(5.0, 5.0), 10.0, 10.0);
        wrong.add_both(Position::new(900.0, 5.0), 50.0, 10.0);
        assert_eq!(wrong.frame(&Reading::default()).unwrap(), None);
    }
}
