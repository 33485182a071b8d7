//! Frames as text, one a line: with Unix times (the CSV of rs1090), and between `*` or `@` and `;` (AVR).

use super::beast::HEAD;
use crate::formats::Reason;
use std::str;

/// A line that holds a frame, or says what it holds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Line<'a> {
    /// Octets of a frame.
    Frame(&'a [u8]),
    /// Nothing that is asked for, by its kind.
    Ignored(&'static str),
}

/// `1698140962.119813,1a32000023b1dda011210000bd6b441a`: Unix seconds, and what Beast writes, without doubled octets. The time
/// comes first; the frame lies in `octets`.
pub(super) fn timed<'a>(
    line: &str,
    octets: &'a mut [u8; MAX_OCTETS],
) -> Result<(Option<f64>, Line<'a>), Reason> {
    let (time, hex) = line.split_once(',').ok_or(Reason::Malformed)?;
    let time_s = match time.trim() {
        "" => None,
        time => Some(time.parse().map_err(|_| Reason::Malformed)?),
    };
    if time_s.is_some_and(|time_s: f64| !time_s.is_finite()) {
        return Err(Reason::NotFinite);
    }
    let (kind, body) = match read_hex(hex.trim(), octets)? {
        [0x1a, kind, body @ ..] => (*kind, body),
        _ => return Err(Reason::Malformed),
    };
    let frame = body.get(HEAD..).ok_or(Reason::Truncated)?;
    let length = match kind {
        b'1' => return Ok((time_s, Line::Ignored("mode A/C"))),
        b'2' => 7,
        b'3' => 14,
        b'4' => return Ok((time_s, Line::Ignored("status"))),
        _ => return Err(Reason::Malformed),
    };
    match frame.len() {
        found if found < length => Err(Reason::Truncated),
        found if found > length => Err(Reason::Malformed),
        _ => Ok((time_s, Line::Frame(frame))),
    }
}

/// `*8D40621D58C382D690C8AC2863A7;`, or `@`, twelve digits of a clock, and the frame.
pub(super) fn avr<'a>(
    line: &str,
    octets: &'a mut [u8; MAX_OCTETS],
) -> Result<(Option<u64>, Line<'a>), Reason> {
    const CLOCK: usize = 6;
    let Some(hex) = line.strip_suffix(';') else {
        return Err(Reason::Truncated);
    };
    let has_clock = match hex.as_bytes().first() {
        Some(b'*') => false,
        Some(b'@') => true,
        _ => return Err(Reason::Malformed),
    };
    let octets = read_hex(&hex[1..], octets)?;
    let (clock, frame) = match has_clock {
        true => octets.split_at_checked(CLOCK).ok_or(Reason::Truncated)?,
        false => (&[][..], octets),
    };
    let shown = has_clock.then(|| {
        clock
            .iter()
            .fold(0, |value, octet| value << 8 | u64::from(*octet))
    });
    match frame.len() {
        2 => Ok((shown, Line::Ignored("mode A/C"))),
        7 | 14 => Ok((shown, Line::Frame(frame))),
        0..14 => Err(Reason::Truncated),
        _ => Err(Reason::Malformed),
    }
}

/// No line that holds a frame has more.
pub(super) const MAX_OCTETS: usize = 64;

fn read_hex<'a>(hex: &str, octets: &'a mut [u8; MAX_OCTETS]) -> Result<&'a [u8], Reason> {
    let (pairs, rest) = hex.as_bytes().as_chunks::<2>();
    if pairs.len() > MAX_OCTETS {
        return Err(Reason::Malformed);
    }
    for ([high, low], octet) in pairs.iter().zip(octets.iter_mut()) {
        *octet = digit(*high)? << 4 | digit(*low)?;
    }
    if rest.is_empty() {
        Ok(&octets[..pairs.len()])
    } else {
        Err(Reason::Truncated)
    }
}

fn digit(letter: u8) -> Result<u8, Reason> {
    match letter {
        b'0'..=b'9' => Ok(letter - b'0'),
        b'a'..=b'f' => Ok(letter - b'a' + 10),
        b'A'..=b'F' => Ok(letter - b'A' + 10),
        _ => Err(Reason::Malformed),
    }
}
