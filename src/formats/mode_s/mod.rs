//! ADS-B and Mode S as receivers write them: raw frames of Beast, of rs1090 or of AVR, and the text of a BaseStation.
//!
//! A frame, or a line, is a unit. Positions (type codes 5 to 18 and 20 to 22 of downlink formats 17 and 18) become reports; what
//! other frames say of an aircraft (callsign, velocity, identity code, accuracy) goes with the reports after them.
//!
//! # Reference
//! ICAO Annex 10, volume IV; RTCA DO-260B; J. Sun, The 1090 Megahertz Riddle, 2021.

mod aircraft;
mod beast;
mod clock;
mod cpr;
mod decoder;
mod fields;
mod frame;
mod sbs;
mod text;

pub use self::clock::Ticks;

use self::beast::{Beast, Found, HEAD};
use self::clock::Clock;
pub(super) use self::decoder::Decoder;
use super::feed::Feed;
use super::{Reason, lines};
use crate::model::fault::Fault;
use std::io::BufRead;
use std::str;

/// Where a receiver stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Receiver {
    pub lat_deg: f64,
    pub lon_deg: f64,
}

/// What a file does not say itself.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Told {
    /// Unix seconds (UTC) of the first frame of Beast or AVR. With a clock that shows the time of day, any time within half a
    /// day of it.
    pub start_s: Option<f64>,
    /// What the clock in front of frames counts.
    pub ticks: Ticks,
    /// Positions on the surface need it, and those more than 400 NM away are not believed.
    pub receiver: Option<Receiver>,
    /// How far the times of a BaseStation are ahead of UTC.
    pub utc_offset_s: Option<f64>,
}

/// How frames are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Framing {
    Beast,
    Rs1090,
    Avr,
    Sbs,
}

/// Reads a file in whichever of the framings it is.
///
/// # Errors
/// A framing that is none of these; AVR without clocks; `start`, or `utc_offset_s`, where the framing has no times without it; a line that is too
/// long, and a file that cannot be read.
pub fn decode(input: &mut dyn BufRead, told: &Told) -> Result<Feed, Vec<Fault>> {
    match framing(input)? {
        Framing::Beast => beast(input, told),
        Framing::Avr if !has_clocks(input) => Err(vec![no_clocks()]),
        framing => texts(input, told, LineReader::new(framing, told)?),
    }
}

/// Tells the framing from what comes first.
fn framing(input: &mut dyn BufRead) -> Result<Framing, Vec<Fault>> {
    let first = input
        .fill_buf()
        .map_err(|error| vec![lines::unreadable_at(&error, 1)])?;
    // No text holds the octet that begins a frame of Beast.
    if first.contains(&0x1a) {
        return Ok(Framing::Beast);
    }
    let text = first
        .strip_prefix(b"\xef\xbb\xbf")
        .unwrap_or(first)
        .trim_ascii_start();
    match text.first() {
        Some(b'0'..=b'9') => Ok(Framing::Rs1090),
        Some(b'*' | b'@') => Ok(Framing::Avr),
        Some(b'M' | b'S' | b'I' | b'A' | b'C') => Ok(Framing::Sbs),
        _ => {
            let detail = "the file begins like no framing of Mode S";
            let allowed =
                "Beast (1A 31 to 1A 34), rs1090 CSV (a Unix time), AVR (* or @), SBS (MSG)";
            Err(vec![
                Fault::new("/file", "unsupported", detail).allowing(allowed),
            ])
        }
    }
}

/// Whether AVR lines have a clock in front of their frames, as far as the first lines show.
fn has_clocks(input: &mut dyn BufRead) -> bool {
    input.fill_buf().is_ok_and(|first| first.contains(&b'@'))
}

fn no_clocks() -> Fault {
    let detail = "the lines begin with * and have no times: when each frame came is not in this file, and `start` cannot say it";
    let allowed = "lines that begin with @ and a clock, Beast or rs1090 of the same receiver; `trackloom feed` takes the times at which lines arrive";
    Fault::new("/file", "missing", detail).allowing(allowed)
}

fn missing(option: &str, detail: &str) -> Vec<Fault> {
    vec![Fault::new(format!("/meta/{option}"), "missing", detail)]
}

fn clock(told: &Told) -> Result<Clock, Vec<Fault>> {
    let detail = "frames of Beast and AVR say no date";
    let start_s = told.start_s.ok_or_else(|| missing("start", detail))?;
    Ok(Clock::new(told.ticks, start_s))
}

fn beast(input: &mut dyn BufRead, told: &Told) -> Result<Feed, Vec<Fault>> {
    let mut clock = clock(told)?;
    let mut decoder = Decoder::new("frame", told);
    let mut stream = Beast::new(input);
    let mut body = Vec::new();
    for unit in 1.. {
        let found = stream
            .read(&mut body)
            .map_err(|error| vec![lines::unreadable_at(&error, unit)])?;
        match found {
            None => break,
            Some(Found::Frame) => {
                let (head, frame) = body.split_at(HEAD);
                let shown = head[..HEAD - 1].iter();
                let shown = shown.fold(0, |value, octet| value << 8 | u64::from(*octet));
                decoder.frame(frame, clock.time_s(shown), unit);
            }
            Some(Found::ModeAc) => decoder.feed.ignore("mode A/C", 1),
            Some(Found::Status) => decoder.feed.ignore("status", 1),
            Some(Found::Cut) => decoder.feed.reject(Reason::Truncated, unit, 1),
            Some(Found::Junk) => decoder.feed.reject(Reason::Malformed, unit, 1),
        }
    }
    Ok(decoder.finish())
}

/// Reads all lines of a text.
fn texts(input: &mut dyn BufRead, told: &Told, mut reader: LineReader) -> Result<Feed, Vec<Fault>> {
    let mut decoder = Decoder::new("line", told);
    lines::each_line(input, &mut |line, unit| {
        reader.take(&mut decoder, line, unit)
    })?;
    Ok(decoder.finish())
}

/// Takes the lines of a text one by one.
pub(super) struct LineReader {
    framing: Framing,
    /// Of AVR, where a start is given.
    clock: Option<Clock>,
    /// Of a BaseStation.
    offset_s: f64,
    /// When the line came, of a feed that is read as it comes.
    pub arrived_s: Option<f64>,
}

impl LineReader {
    fn new(framing: Framing, told: &Told) -> Result<Self, Vec<Fault>> {
        let reader = LineReader::of_arrivals(framing, told)?;
        match framing {
            Framing::Avr => Ok(LineReader {
                clock: Some(clock(told)?),
                ..reader
            }),
            _ => Ok(reader),
        }
    }

    /// Where the times of arrival are known no start is needed.
    fn of_arrivals(framing: Framing, told: &Told) -> Result<Self, Vec<Fault>> {
        let detail = "the times of a BaseStation are local and name no zone";
        let is_local = framing == Framing::Sbs && told.utc_offset_s.is_none();
        if is_local {
            return Err(missing("utc_offset_s", detail));
        }
        let start_s = told.start_s;
        Ok(LineReader {
            framing,
            clock: start_s.map(|start_s| Clock::new(told.ticks, start_s)),
            offset_s: told.utc_offset_s.unwrap_or_default(),
            arrived_s: None,
        })
    }

    /// Of a feed that is read as it comes, by its first lines.
    ///
    /// # Errors
    /// As of [`decode`]; frames of Beast, which are no lines.
    pub fn live(first: &[u8], told: &Told) -> Result<Self, Vec<Fault>> {
        match framing(&mut &first[..])? {
            Framing::Beast => {
                let detail = "frames of Beast are read as a whole file only";
                let fault = Fault::new("/file", "unsupported", detail);
                Err(vec![fault.allowing("BaseStation, rs1090, AVR")])
            }
            framing => LineReader::of_arrivals(framing, told),
        }
    }

    /// Lines that are blank or comments are passed over.
    pub fn take(&mut self, decoder: &mut Decoder, line: &[u8], unit: u64) {
        match line.trim_ascii() {
            [] => decoder.feed.ignore("blank", 1),
            [b'#', ..] => decoder.feed.ignore("comment", 1),
            line => match str::from_utf8(line) {
                Ok(line) => self.take_text(decoder, line, unit),
                Err(_) => decoder.feed.reject(Reason::Malformed, unit, 1),
            },
        }
    }

    fn take_text(&mut self, decoder: &mut Decoder, line: &str, unit: u64) {
        match self.framing {
            Framing::Sbs => sbs::take(decoder, line, unit, self.offset_s),
            Framing::Avr => avr_line(decoder, self, line, unit),
            Framing::Rs1090 | Framing::Beast => timed_line(decoder, line, unit),
        }
    }

    fn time_s(&mut self, shown: Option<u64>) -> Option<f64> {
        match &mut self.clock {
            Some(clock) => clock.time_s(shown?),
            None => self.arrived_s,
        }
    }
}

fn timed_line(decoder: &mut Decoder, line: &str, unit: u64) {
    let mut octets = [0; text::MAX_OCTETS];
    match text::timed(line, &mut octets) {
        Ok((time_s, text::Line::Frame(frame))) => decoder.frame(frame, time_s, unit),
        Ok((_, text::Line::Ignored(kind))) => decoder.feed.ignore(kind, 1),
        Err(reason) => decoder.feed.reject(reason, unit, 1),
    }
}

fn avr_line(decoder: &mut Decoder, reader: &mut LineReader, line: &str, unit: u64) {
    let mut octets = [0; text::MAX_OCTETS];
    match text::avr(line, &mut octets) {
        Ok((shown, text::Line::Frame(frame))) => {
            decoder.frame(frame, reader.time_s(shown), unit);
        }
        Ok((_, text::Line::Ignored(kind))) => decoder.feed.ignore(kind, 1),
        Err(reason) => decoder.feed.reject(reason, unit, 1),
    }
}
