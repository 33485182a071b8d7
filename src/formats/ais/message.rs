//! What a message says: a position, a ship's name, or the time of a base station.
//!
//! # Reference
//! Recommendation ITU-R M.1371-5, annex 8.

use super::bits::Bits;
use crate::formats::Reason;
use crate::formats::feed::{Motion, civil};

pub(super) enum Message {
    Position(Position),
    Particulars(Particulars),
    /// Seconds since 1970 of a base station's clock.
    Clock(f64),
    /// Nothing that is asked for, by its kind.
    Ignored(&'static str),
}

/// Where somebody says to be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Position {
    pub mmsi: u32,
    pub lat_deg: f64,
    pub lon_deg: f64,
    pub height_m: Option<f64>,
    pub motion: Option<Motion>,
    pub sigma_m: f64,
    /// Second of the minute of the fix.
    pub second: Option<u8>,
}

/// What a ship is; empty and 0 where it does not say.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Particulars {
    pub mmsi: u32,
    pub name: String,
    pub callsign: String,
    pub ship_type: u8,
}

/// A field: its first bit, and how many.
type Field = (usize, usize);

/// Where the fields of a position stand in messages of a type.
struct Layout {
    shortest: usize,
    speed: Field,
    /// Knots, and the first value that is none.
    speed_unit: f64,
    speed_end: u64,
    accuracy: usize,
    lon: Field,
    lat: Field,
    /// Parts of a degree.
    scale: i64,
    course: Field,
    course_unit: f64,
    second: Option<Field>,
    altitude: Option<Field>,
}

const CLASS_A: Layout = Layout {
    shortest: 168,
    speed: (50, 10),
    speed_unit: 0.1,
    speed_end: 1022,
    accuracy: 60,
    lon: (61, 28),
    lat: (89, 27),
    scale: 600_000,
    course: (116, 12),
    course_unit: 0.1,
    second: Some((137, 6)),
    altitude: None,
};

const CLASS_B: Layout = Layout {
    speed: (46, 10),
    accuracy: 56,
    lon: (57, 28),
    lat: (85, 27),
    course: (112, 12),
    second: Some((133, 6)),
    ..CLASS_A
};

/// The last four bits are spare.
const CLASS_B_EXTENDED: Layout = Layout {
    shortest: 308,
    ..CLASS_B
};

const SEARCH_AIRCRAFT: Layout = Layout {
    speed_unit: 1.0,
    second: Some((128, 6)),
    altitude: Some((38, 12)),
    ..CLASS_A
};

/// The last bit is spare.
const LONG_RANGE: Layout = Layout {
    shortest: 95,
    speed: (79, 6),
    speed_unit: 1.0,
    speed_end: 63,
    accuracy: 38,
    lon: (44, 18),
    lat: (62, 17),
    scale: 600,
    course: (85, 9),
    course_unit: 1.0,
    second: None,
    altitude: None,
};

const KNOT_MPS: f64 = 1852.0 / 3600.0;

/// Of a fix that is within 10 m in 95 % of cases, and of others.
const ACCURATE_SIGMA_M: f64 = 5.0;
const OTHER_SIGMA_M: f64 = 15.0;

/// Metres of a degree of latitude: a minute is a nautical mile.
const DEGREE_M: f64 = 60.0 * 1852.0;

const KINDS: [&str; 29] = [
    "message 0",
    "message 1",
    "message 2",
    "message 3",
    "message 4",
    "message 5",
    "message 6",
    "message 7",
    "message 8",
    "message 9",
    "message 10",
    "message 11",
    "message 12",
    "message 13",
    "message 14",
    "message 15",
    "message 16",
    "message 17",
    "message 18",
    "message 19",
    "message 20",
    "message 21",
    "message 22",
    "message 23",
    "message 24",
    "message 25",
    "message 26",
    "message 27",
    "message 28",
];

/// What a message of this type is called where it is ignored.
pub(super) fn kind(bits: &Bits) -> &'static str {
    KINDS[type_of(bits).min(28)]
}

fn type_of(bits: &Bits) -> usize {
    bits.unsigned(0, 6) as usize
}

/// Decodes a message.
///
/// # Errors
/// The reason for which it is rejected.
pub(super) fn decode(bits: &Bits) -> Result<Message, Reason> {
    if bits.count() < 6 {
        return Err(Reason::Truncated);
    }
    match type_of(bits) {
        1..=3 => position(bits, &CLASS_A),
        9 => position(bits, &SEARCH_AIRCRAFT),
        18 => position(bits, &CLASS_B),
        19 => position(bits, &CLASS_B_EXTENDED),
        27 => position(bits, &LONG_RANGE),
        4 | 11 => Ok(clock_s(bits).map_or(Message::Ignored(kind(bits)), Message::Clock)),
        5 | 24 => Ok(particulars(bits).map_or(Message::Ignored(kind(bits)), Message::Particulars)),
        0 | 29.. => Err(Reason::UnknownType),
        _ => Ok(Message::Ignored(kind(bits))),
    }
}

fn mmsi(bits: &Bits) -> Option<u32> {
    let mmsi = bits.unsigned(8, 30) as u32;
    (1..=999_999_999).contains(&mmsi).then_some(mmsi)
}

fn position(bits: &Bits, layout: &Layout) -> Result<Message, Reason> {
    if bits.count() < layout.shortest {
        return Err(Reason::Truncated);
    }
    let of = |(from, count): Field| bits.unsigned(from, count);
    let lon = bits.signed(layout.lon.0, layout.lon.1);
    let lat = bits.signed(layout.lat.0, layout.lat.1);
    if lon == 181 * layout.scale || lat == 91 * layout.scale {
        return Ok(Message::Ignored("no position"));
    }
    if lon.abs() > 180 * layout.scale || lat.abs() > 90 * layout.scale {
        return Err(Reason::OutOfRange);
    }
    let is_accurate = bits.bit(layout.accuracy);
    Ok(Message::Position(Position {
        mmsi: mmsi(bits).ok_or(Reason::NoIdentity)?,
        lat_deg: lat as f64 / layout.scale as f64,
        lon_deg: lon as f64 / layout.scale as f64,
        height_m: layout
            .altitude
            .map(of)
            .filter(|height| *height < 4094)
            .map(|height| height as f64),
        motion: motion(of(layout.speed), of(layout.course), layout),
        sigma_m: sigma_m(is_accurate, layout),
        second: layout
            .second
            .map(of)
            .filter(|second| *second < 60)
            .map(|second| second as u8),
    }))
}

/// A speed that is only known to be high is none.
fn motion(speed: u64, course: u64, layout: &Layout) -> Option<Motion> {
    let course_deg = course as f64 * layout.course_unit;
    let is_known = speed < layout.speed_end && course_deg < 360.0;
    is_known.then(|| Motion {
        speed_mps: speed as f64 * layout.speed_unit * KNOT_MPS,
        course_rad: course_deg.to_radians(),
    })
}

/// Of the fix, and of what rounding adds where a step is wide.
fn sigma_m(is_accurate: bool, layout: &Layout) -> f64 {
    let of_fix = if is_accurate {
        ACCURATE_SIGMA_M
    } else {
        OTHER_SIGMA_M
    };
    let step_m = DEGREE_M / layout.scale as f64;
    if step_m < 1.0 {
        of_fix
    } else {
        of_fix.hypot(step_m / 12f64.sqrt())
    }
}

/// The clock of a base station, or of a ship that answers for one.
fn clock_s(bits: &Bits) -> Option<f64> {
    if bits.count() < 78 {
        return None;
    }
    let [month, day, hour, minute, second] = [(52, 4), (56, 5), (61, 5), (66, 6), (72, 6)]
        .map(|(from, count)| bits.unsigned(from, count));
    if hour > 23 || minute > 59 || second > 59 {
        return None;
    }
    let days = civil::days_since_1970(bits.signed(38, 14), month as u32, day as u32)?;
    let of_day = (hour * 3600 + minute * 60 + second) as i64;
    Some((days * civil::SECONDS_A_DAY + of_day) as f64)
}

/// Of messages 5 and 24; of what is not in a message, nothing.
fn particulars(bits: &Bits) -> Option<Particulars> {
    let mmsi = mmsi(bits)?;
    let is_static_a = type_of(bits) == 5;
    let (name, callsign, ship_type) = match bits.unsigned(38, 2) {
        _ if is_static_a => (Some(112), Some(70), Some(232)),
        0 => (Some(40), None, None),
        1 => (None, Some(90), Some(40)),
        _ => return None,
    };
    let end = [
        name.map(|from| from + 120),
        callsign.map(|from| from + 42),
        ship_type.map(|from| from + 8),
    ];
    if end.into_iter().flatten().any(|end| end > bits.count()) {
        return None;
    }
    Some(Particulars {
        mmsi,
        name: name.map_or_else(String::new, |from| bits.text(from, 20)),
        callsign: callsign.map_or_else(String::new, |from| bits.text(from, 7)),
        ship_type: ship_type.map_or(0, |from| bits.unsigned(from, 8) as u8),
    })
}

/// What message 19 adds to its position.
pub(super) fn particulars_of_extended(bits: &Bits, mmsi: u32) -> Option<Particulars> {
    (type_of(bits) == 19).then(|| Particulars {
        mmsi,
        name: bits.text(143, 20),
        callsign: String::new(),
        ship_type: bits.unsigned(263, 8) as u8,
    })
}
