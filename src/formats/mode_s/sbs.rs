//! The text of a BaseStation (port 30003): 22 values a line, of which a message says few.

use super::decoder::{Altitude, Decoder, Sighting};
use crate::formats::Reason;
use crate::formats::feed::{Motion, civil};

const KNOT_MPS: f64 = 1852.0 / 3600.0;

const VALUES: usize = 22;

/// Places of the values.
const ADDRESS: usize = 4;
const DATE: usize = 6;
const TIME: usize = 7;
const CALLSIGN: usize = 10;
const ALTITUDE: usize = 11;
const SPEED: usize = 12;
const TRACK: usize = 13;
const LATITUDE: usize = 14;
const LONGITUDE: usize = 15;
const SQUAWK: usize = 17;
const ON_GROUND: usize = 21;

/// Takes a line; `utc_offset_s` is how far its times are ahead of UTC.
pub(super) fn take(decoder: &mut Decoder, line: &str, unit: u64, utc_offset_s: f64) {
    match read(decoder, line, unit, utc_offset_s) {
        Ok(None) => {}
        Ok(Some(kind)) => decoder.feed.ignore(kind, 1),
        Err(reason) => decoder.feed.reject(reason, unit, 1),
    }
}

/// Pushes a report, or says of what kind the line is.
fn read(
    decoder: &mut Decoder,
    line: &str,
    unit: u64,
    utc_offset_s: f64,
) -> Result<Option<&'static str>, Reason> {
    let mut values = [""; VALUES];
    let mut count = 0;
    for (value, text) in values.iter_mut().zip(line.split(',')) {
        *value = text.trim();
        count += 1;
    }
    match values[0] {
        "MSG" => {}
        "SEL" | "ID" | "AIR" | "STA" | "CLK" => return Ok(Some("other message")),
        _ => return Err(Reason::Malformed),
    }
    if count < VALUES {
        return Err(Reason::Truncated);
    }
    let address = address(values[ADDRESS])?;
    let kind = *KINDS
        .iter()
        .find(|kind| kind.strip_prefix("MSG,") == Some(values[1]))
        .ok_or(Reason::UnknownType)?;
    let time_s = time_s(values[DATE], values[TIME], utc_offset_s);
    tell(decoder, address, &values, time_s)?;
    if values[LATITUDE].is_empty() || values[LONGITUDE].is_empty() {
        return Ok(Some(kind));
    }
    let place = (number(values[LATITUDE])?, number(values[LONGITUDE])?);
    let (Some(lat_deg), Some(lon_deg)) = place else {
        return Ok(Some(kind));
    };
    if lat_deg.abs() > 90.0 || lon_deg.abs() > 180.0 {
        return Err(Reason::OutOfRange);
    }
    let sighting = Sighting {
        time_s: time_s.ok_or(Reason::NoTime)?,
        unit,
        place: (lat_deg, lon_deg),
        altitude: number(values[ALTITUDE])?.map(|feet| Altitude::Pressure(feet.round() as i32)),
        is_on_ground: flag(values[ON_GROUND]),
    };
    decoder.push(address, &sighting);
    Ok(None)
}

const KINDS: [&str; 8] = [
    "MSG,1", "MSG,2", "MSG,3", "MSG,4", "MSG,5", "MSG,6", "MSG,7", "MSG,8",
];

/// What the line says of its aircraft besides a place.
fn tell(
    decoder: &mut Decoder,
    address: u32,
    values: &[&str; VALUES],
    time_s: Option<f64>,
) -> Result<(), Reason> {
    let motion = match (number(values[SPEED])?, number(values[TRACK])?) {
        (Some(speed_kt), Some(track_deg)) => Some(Motion {
            speed_mps: speed_kt * KNOT_MPS,
            course_rad: track_deg.to_radians(),
        }),
        _ => None,
    };
    let aircraft = decoder.aircraft(address);
    if let (Some(time_s), Some(_)) = (time_s, motion) {
        aircraft.moves(time_s, motion);
    }
    if !values[CALLSIGN].is_empty() {
        aircraft.name(values[CALLSIGN].to_owned());
    }
    let is_squawk = (1..=4).contains(&values[SQUAWK].len());
    if let Some(mode_a) = u16::from_str_radix(values[SQUAWK], 8)
        .ok()
        .filter(|_| is_squawk)
    {
        aircraft.mode_a = Some(mode_a);
    }
    Ok(())
}

fn address(text: &str) -> Result<u32, Reason> {
    if text.is_empty() {
        return Err(Reason::NoIdentity);
    }
    let is_address = text.len() == 6 && text.bytes().all(|digit| digit.is_ascii_hexdigit());
    let address = u32::from_str_radix(text, 16).ok().filter(|_| is_address);
    address.ok_or(Reason::Malformed)
}

fn time_s(date: &str, time: &str, utc_offset_s: f64) -> Option<f64> {
    let days = civil::date(date)?;
    let of_day_s = civil::time_of_day_s(time)?;
    Some((days * civil::SECONDS_A_DAY) as f64 + of_day_s - utc_offset_s)
}

fn number(text: &str) -> Result<Option<f64>, Reason> {
    if text.is_empty() {
        return Ok(None);
    }
    let number: f64 = text.parse().map_err(|_| Reason::Malformed)?;
    if number.is_finite() {
        Ok(Some(number))
    } else {
        Err(Reason::NotFinite)
    }
}

fn flag(text: &str) -> Option<bool> {
    match text {
        "" => None,
        text => Some(text != "0"),
    }
}
