//! Numbers and texts in items: most significant octet first, signed ones in two's complement.

use crate::formats::feed::{Motion, Spot};
use std::f64::consts::TAU;

pub const NM: f64 = 1852.0;
pub const FOOT: f64 = 0.3048;
/// What a quarter of a flight level is (ft).
pub const QUARTER_LEVEL_FT: f64 = 25.0;
/// NM/s times 2⁻¹⁴ (m/s).
pub const SPEED_STEP: f64 = NM / 16_384.0;
/// A turn in 2¹⁶ parts (rad).
pub const ANGLE_STEP: f64 = TAU / 65_536.0;

pub fn unsigned(octets: &[u8]) -> u64 {
    let add = |sum: u64, octet: &u8| sum << 8 | u64::from(*octet);
    octets.iter().fold(0, add)
}

/// Of at most 8 octets.
pub fn signed(octets: &[u8]) -> i64 {
    let unused = 64 - 8 * octets.len().clamp(1, 8) as u32;
    (unsigned(octets) << unused) as i64 >> unused
}

/// An octet of an extended item; 0 where it ends before.
pub fn octet(item: &[u8], number: usize) -> u8 {
    item.get(number).copied().unwrap_or(0)
}

fn halves(item: &[u8]) -> (&[u8], &[u8]) {
    item.split_at(item.len() / 2)
}

/// Two signed numbers of one length.
pub fn signed_pair(item: &[u8], step: f64) -> (f64, f64) {
    let (first, second) = halves(item);
    (signed(first) as f64 * step, signed(second) as f64 * step)
}

/// Two numbers of one length that have no sign.
pub fn unsigned_pair(item: &[u8], step: f64) -> (f64, f64) {
    let (first, second) = halves(item);
    (
        unsigned(first) as f64 * step,
        unsigned(second) as f64 * step,
    )
}

/// Latitude and longitude in 180° times 2^-`power`.
pub fn geographic(item: &[u8], power: i32) -> Spot {
    let (lat_deg, lon_deg) = signed_pair(item, 180.0 / 2f64.powi(power));
    Spot::Geographic { lat_deg, lon_deg }
}

/// Range and azimuth, of two octets each.
pub fn polar(item: &[u8], range_step_m: f64) -> Spot {
    let (range, bearing) = halves(item);
    Spot::Polar {
        range_m: unsigned(range) as f64 * range_step_m,
        bearing_rad: unsigned(bearing) as f64 * ANGLE_STEP,
    }
}

/// East and north of a sensor as range and bearing.
pub fn polar_of_plane(item: &[u8], step_m: f64) -> Spot {
    let (east, north) = signed_pair(item, step_m);
    Spot::Polar {
        range_m: east.hypot(north),
        bearing_rad: east.atan2(north).rem_euclid(TAU),
    }
}

pub fn plane(item: &[u8], step_m: f64) -> Spot {
    let (x_m, y_m) = signed_pair(item, step_m);
    Spot::Plane { x_m, y_m }
}

/// Speed in NM/s times 2⁻¹⁴, and course.
pub fn polar_motion(item: &[u8]) -> Motion {
    let (speed, course) = halves(item);
    Motion {
        speed_mps: unsigned(speed) as f64 * SPEED_STEP,
        course_rad: unsigned(course) as f64 * ANGLE_STEP,
    }
}

/// Speeds east and north.
pub fn plane_motion(item: &[u8], step_mps: f64) -> Motion {
    let (east, north) = signed_pair(item, step_mps);
    Motion {
        speed_mps: east.hypot(north),
        course_rad: east.atan2(north).rem_euclid(TAU),
    }
}

/// Time of day in 1/128 s.
pub fn time_of_day(item: &[u8]) -> f64 {
    unsigned(item) as f64 / 128.0
}

/// A code that is validated and not garbled.
pub fn mode_a(item: &[u8]) -> Option<u16> {
    let code = unsigned(item) as u16;
    (code & 0xc000 == 0).then_some(code & 0x0fff)
}

/// Quarters of a flight level behind two bits that say whether they are validated and garbled (ft).
pub fn flight_level_ft(item: &[u8]) -> Option<f64> {
    let level = unsigned(item) as u16;
    let quarters = (level << 2) as i16 >> 2;
    (level & 0xc000 == 0).then_some(f64::from(quarters) * QUARTER_LEVEL_FT)
}

/// A name of up to eight letters and digits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Callsign {
    letters: [u8; 8],
    length: usize,
}

impl Callsign {
    /// Of six octets: eight letters of 6 bits in the alphabet of ICAO Annex 10. `None` where nothing is said, or a letter is
    /// none.
    pub fn of(octets: &[u8]) -> Option<Self> {
        let bits = unsigned(octets);
        let mut letters = [b' '; 8];
        for (place, letter) in letters.iter_mut().enumerate() {
            *letter = match (bits >> (42 - 6 * place)) as u8 & 0x3f {
                code @ 1..=26 => b'A' + code - 1,
                0 | 32 => b' ',
                code @ 48..=57 => code,
                _ => return None,
            };
        }
        let length = letters.trim_ascii_end().len();
        (length > 0).then_some(Callsign { letters, length })
    }

    /// A number that no other one has.
    pub fn code(&self) -> u64 {
        u64::from_be_bytes(self.letters)
    }

    pub fn as_str(&self) -> &str {
        // They are ASCII.
        std::str::from_utf8(&self.letters[..self.length]).unwrap_or_default()
    }
}
