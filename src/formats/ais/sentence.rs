//! One line of NMEA 0183: a prefix, tag blocks, the sentence, and what a receiver adds behind it.

use crate::formats::Reason;
use crate::formats::feed::civil;
use std::str;

/// Talkers of AIS: stations of base, ships, aids to navigation, …
const TALKERS: &[&[u8; 2]] = &[
    b"AI", b"AB", b"AD", b"AN", b"AR", b"AS", b"AT", b"AX", b"BS", b"SA",
];

/// Letters of one sentence's payload; NMEA allows 82 in all, five slots of the radio link hold 180.
const MAX_PAYLOAD: usize = 1024;

/// What a line is.
#[derive(Debug, PartialEq)]
pub(super) enum Line<'a> {
    /// Sound, but no part of a message; by its kind.
    Ignored(&'static str),
    Part(Part<'a>),
}

/// A message, or a part of one.
#[derive(Debug, PartialEq)]
pub(super) struct Part<'a> {
    /// Talker and formatter: `AIVDM`.
    pub address: &'a [u8],
    pub total: u8,
    pub number: u8,
    pub sequence: &'a [u8],
    pub channel: &'a [u8],
    /// In its armour: six bits a letter.
    pub payload: &'a [u8],
    /// Bits of the last letter that are no part of it.
    pub fill: u8,
    /// The receiver.
    pub source: &'a [u8],
    /// The group of the tag block, 1604 of `g:1-2-1604`.
    pub group: Option<&'a [u8]>,
    /// Time of the tag block, else of what stands behind the sentence, else before it.
    pub received_s: Option<f64>,
}

/// What the tag blocks of a line say.
#[derive(Default)]
struct Tags<'a> {
    time_s: Option<f64>,
    source: &'a [u8],
    group: Option<&'a [u8]>,
}

/// Takes a line apart; a prefix without a zone is in local time, `utc_offset_s` ahead of UTC.
///
/// # Errors
/// The reason for which the line is rejected.
pub(super) fn parse(line: &[u8], utc_offset_s: Option<f64>) -> Result<Line<'_>, Reason> {
    let line = line.trim_ascii();
    match line.first() {
        None => return Ok(Line::Ignored("blank")),
        Some(b'#') => return Ok(Line::Ignored("comment")),
        Some(_) => {}
    }
    let Some(start) = line.iter().position(|byte| matches!(byte, b'\\' | b'!')) else {
        let is_other = line.contains(&b'$');
        return if is_other {
            Ok(Line::Ignored("other sentence"))
        } else {
            Err(Reason::Malformed)
        };
    };
    let (prefix, mut rest) = line.split_at(start);
    let mut tags = Tags::default();
    while let Some(block) = rest.strip_prefix(b"\\") {
        let end = block
            .iter()
            .position(|byte| *byte == b'\\')
            .ok_or(Reason::Truncated)?;
        tags.read(&block[..end])?;
        rest = &block[end + 1..];
    }
    match rest.first() {
        None => Ok(Line::Ignored("tag block")),
        Some(b'!') => sentence(&rest[1..], prefix, &tags, utc_offset_s),
        Some(b'$') => Ok(Line::Ignored("other sentence")),
        Some(_) => Err(Reason::Malformed),
    }
}

fn sentence<'a>(
    text: &'a [u8],
    prefix: &[u8],
    tags: &Tags<'a>,
    utc_offset_s: Option<f64>,
) -> Result<Line<'a>, Reason> {
    let (body, trailer) = checked(text)?;
    let mut fields = body.split(|byte| *byte == b',');
    let address = fields.next().unwrap_or_default();
    if !is_of_ais(address) {
        return Ok(Line::Ignored("other sentence"));
    }
    let mut next = || fields.next().ok_or(Reason::Malformed);
    let [total, number, sequence, channel, payload, fill] =
        [next()?, next()?, next()?, next()?, next()?, next()?];
    if fields.next().is_some() || payload.len() > MAX_PAYLOAD {
        return Err(Reason::Malformed);
    }
    let (total, number) = (one_digit(total)?, one_digit(number)?);
    if number == 0 || number > total {
        return Err(Reason::Malformed);
    }
    if payload.is_empty() {
        return Err(Reason::EmptyPayload);
    }
    let added = Added::of(trailer);
    let source = if tags.source.is_empty() {
        added.station
    } else {
        tags.source
    };
    Ok(Line::Part(Part {
        address,
        total,
        number,
        sequence,
        channel,
        payload,
        fill: one_digit(fill)
            .ok()
            .filter(|fill| *fill < 6)
            .ok_or(Reason::Malformed)?,
        source,
        group: tags.group,
        received_s: tags
            .time_s
            .or(added.time_s)
            .or_else(|| prefix_time_s(prefix, utc_offset_s)),
    }))
}

fn is_of_ais(address: &[u8]) -> bool {
    let Some((talker, formatter)) = address.split_first_chunk::<2>() else {
        return false;
    };
    matches!(formatter, b"VDM" | b"VDO") && TALKERS.contains(&talker)
}

fn one_digit(text: &[u8]) -> Result<u8, Reason> {
    match text {
        [digit @ b'0'..=b'9'] => Ok(digit - b'0'),
        _ => Err(Reason::Malformed),
    }
}

/// What the checksum is over, and what stands behind it.
fn checked(text: &[u8]) -> Result<(&[u8], &[u8]), Reason> {
    let end = text
        .iter()
        .position(|byte| *byte == b'*')
        .ok_or(Reason::Truncated)?;
    let (body, rest) = (&text[..end], &text[end + 1..]);
    let (said, trailer) = rest.split_at_checked(2).ok_or(Reason::Truncated)?;
    let said = str::from_utf8(said)
        .ok()
        .filter(|said| !said.starts_with('+'));
    let said = said
        .and_then(|said| u8::from_str_radix(said, 16).ok())
        .ok_or(Reason::Malformed)?;
    if body.iter().fold(0, |sum, byte| sum ^ byte) == said {
        Ok((body, trailer))
    } else {
        Err(Reason::Checksum)
    }
}

impl<'a> Tags<'a> {
    fn read(&mut self, block: &'a [u8]) -> Result<(), Reason> {
        let (body, _) = checked(block)?;
        for field in body.split(|byte| *byte == b',') {
            match field.split_at_checked(2) {
                Some((b"c:", time)) => self.time_s = unix_s(time),
                Some((b"s:", source)) => self.source = source,
                Some((b"g:", group)) => self.group = group.splitn(3, |byte| *byte == b'-').nth(2),
                _ => {}
            }
        }
        Ok(())
    }
}

/// What the coast guard's form adds: the last number is the time, `r003669946` or `b003669946` the station.
#[derive(Default)]
struct Added<'a> {
    station: &'a [u8],
    time_s: Option<f64>,
}

impl<'a> Added<'a> {
    fn of(trailer: &'a [u8]) -> Self {
        let mut added = Added::default();
        for field in trailer.split(|byte| *byte == b',').map(<[u8]>::trim_ascii) {
            match field {
                [b'r' | b'b', _, ..] => added.station = field,
                [b'0'..=b'9', ..] => added.time_s = unix_s(field).or(added.time_s),
                _ => {}
            }
        }
        added
    }
}

/// Unix seconds, or milliseconds where there are too many of them for seconds. What is no time of the last decades, or of the
/// next, is none.
fn unix_s(text: &[u8]) -> Option<f64> {
    if text.len() > 20
        || !text
            .iter()
            .all(|byte| byte.is_ascii_digit() || *byte == b'.')
    {
        return None;
    }
    let number: f64 = str::from_utf8(text).ok()?.parse().ok()?;
    let seconds = if number > 1e11 {
        number / 1000.0
    } else {
        number
    };
    (1e8..1e11).contains(&seconds).then_some(seconds)
}

/// The time that a receiver writes in front of a sentence.
fn prefix_time_s(prefix: &[u8], utc_offset_s: Option<f64>) -> Option<f64> {
    let is_edge = |letter: char| letter.is_whitespace() || "[](),;|".contains(letter);
    let text = str::from_utf8(prefix).ok()?.trim_matches(is_edge);
    civil::instant(text, utc_offset_s).or_else(|| unix_s(text.as_bytes()))
}
