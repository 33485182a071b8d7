//! AIS as receivers write it: `!AIVDM` sentences of NMEA 0183, one a line, with tag blocks, times of receivers, or neither.
//!
//! Every line is a unit: comments and blank lines are ignored. Positions (messages 1, 2, 3, 9, 18, 19 and 27) become reports,
//! names and callsigns (5, 19 and 24) are told of their ships, base stations (4 and 11) say the time where nothing else does.
//!
//! # Reference
//! Recommendation ITU-R M.1371-5; IEC 61162-1 and NMEA 0183 4.0 for sentences and tag blocks.

mod bits;
mod clock;
mod message;
mod parts;
mod sentence;

use self::bits::Bits;
use self::clock::{Clock, with_second};
use self::message::{Message, Particulars, Position};
use self::parts::{Fate, Lines, Parts};
use self::sentence::{Line, Part};
use super::feed::{Attribute, Feed, Report, Spot};
use super::table::Interner;
use super::{Reason, lines};
use crate::model::fault::Fault;
use std::collections::HashMap;
use std::io::BufRead;

/// What a file does not say itself.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Told {
    /// Unix seconds (UTC) at which a feed without times begins; the seconds of its messages carry it on.
    pub start_s: Option<f64>,
    /// How far the times in front of sentences are ahead of UTC, where they name no zone.
    pub utc_offset_s: Option<f64>,
}

/// The same payload within this time is what another receiver heard.
const REPEATED_S: f64 = 5.0;

/// Reads a feed, line by line. Its times rise and fall as receivers report them.
///
/// # Errors
/// A line that is too long, and a file that cannot be read.
pub fn decode(input: &mut dyn BufRead, told: &Told) -> Result<Feed, Vec<Fault>> {
    let mut decoder = Decoder::new(told);
    lines::each_line(input, &mut |line, number| decoder.take(line, number))?;
    Ok(decoder.finish())
}

/// Takes lines one by one.
pub(super) struct Decoder {
    told: Told,
    pub feed: Feed,
    /// When the line came, of a feed that is read as it comes.
    pub arrived_s: Option<f64>,
    clock: Clock,
    parts: Parts,
    bits: Bits,
    ships: HashMap<u32, Ship>,
    /// Reports whose times are those of the clock.
    by_clock: u64,
}

/// Who sends.
struct Ship {
    identity: u32,
    /// Time and sum of the messages before, in turns.
    recent: [(f64, u64); 4],
    next: usize,
}

impl Decoder {
    pub fn new(told: &Told) -> Self {
        let mut feed = Feed::of("line");
        feed.sensors.number("ais");
        Decoder {
            told: *told,
            feed,
            arrived_s: None,
            clock: Clock::new(told.start_s),
            parts: Parts::default(),
            bits: Bits::default(),
            ships: HashMap::new(),
            by_clock: 0,
        }
    }

    pub fn take(&mut self, line: &[u8], number: u64) {
        match sentence::parse(line, self.told.utc_offset_s) {
            Err(reason) => self.feed.reject(reason, number, 1),
            Ok(Line::Ignored(kind)) => self.feed.ignore(kind, 1),
            Ok(Line::Part(part)) if part.total == 1 => {
                let lines = Lines {
                    first: number,
                    count: 1,
                    received_s: part.received_s,
                };
                self.message(&[part.payload], part.fill, &lines);
            }
            Ok(Line::Part(part)) => self.part(&part, number),
        }
    }

    fn part(&mut self, part: &Part<'_>, number: u64) {
        match self.parts.take(part, number) {
            Fate::Waits => {}
            Fate::Repeated => self.feed.ignore("duplicate", 1),
            Fate::Whole(lines, payloads, fill) => {
                let payloads: Vec<&[u8]> = payloads.iter().map(Vec::as_slice).collect();
                self.message(&payloads, fill, &lines);
            }
        }
        self.give_up();
    }

    fn give_up(&mut self) {
        for lost in self.parts.lost.drain(..) {
            self.feed
                .reject(Reason::IncompleteMessage, lost.first, lost.count.into());
        }
    }

    /// A whole message.
    fn message(&mut self, payloads: &[&[u8]], fill: u8, lines: &Lines) {
        self.bits.clear();
        if !payloads.iter().all(|payload| self.bits.add(payload)) {
            return self
                .feed
                .reject(Reason::Malformed, lines.first, lines.count.into());
        }
        self.bits.drop_last(fill);
        match message::decode(&self.bits) {
            Err(reason) => self.feed.reject(reason, lines.first, lines.count.into()),
            Ok(Message::Position(position)) => self.position(&position, lines),
            Ok(Message::Ignored(kind)) => self.feed.ignore(kind, lines.count.into()),
            Ok(Message::Clock(time_s)) => {
                self.clock.set(time_s);
                self.feed
                    .ignore(message::kind(&self.bits), lines.count.into());
            }
            Ok(Message::Particulars(particulars)) => {
                self.describe(&particulars);
                self.feed
                    .ignore(message::kind(&self.bits), lines.count.into());
            }
        }
    }

    fn position(&mut self, position: &Position, lines: &Lines) {
        let count = lines.count.into();
        let Some(time_s) = self.time_s(lines.received_s, position.second) else {
            return self.feed.reject(Reason::NoTime, lines.first, count);
        };
        let sum = self.bits.sum();
        let ship = self.ship(position.mmsi);
        if ship.is_repeated(time_s, sum) {
            return self.feed.ignore("duplicate", count);
        }
        let identity = ship.identity;
        self.feed.push(Report {
            time_s,
            unit: lines.first,
            units: lines.count,
            sensor: 0,
            identity: Some(identity),
            spot: Spot::Geographic {
                lat_deg: position.lat_deg,
                lon_deg: position.lon_deg,
            },
            height_m: position.height_m,
            motion: position.motion,
            sigma_m: Some(position.sigma_m),
            status: None,
            begins: false,
            ends: false,
        });
        if let Some(particulars) = message::particulars_of_extended(&self.bits, position.mmsi) {
            self.describe(&particulars);
        }
    }

    /// Of the fix, as near as the receiver's time, or a clock without one, tells.
    fn time_s(&mut self, received_s: Option<f64>, second: Option<u8>) -> Option<f64> {
        if let Some(received_s) = received_s.or(self.arrived_s) {
            return Some(with_second(received_s, second));
        }
        let time_s = self.clock.time_s(second)?;
        self.by_clock += 1;
        Some(time_s)
    }

    fn ship(&mut self, mmsi: u32) -> &mut Ship {
        let feed = &mut self.feed;
        self.ships
            .entry(mmsi)
            .or_insert_with(|| Ship::new(mmsi, feed))
    }

    fn describe(&mut self, particulars: &Particulars) {
        let identity = self.ship(particulars.mmsi).identity;
        let ship_type = match particulars.ship_type {
            0 => String::new(),
            number => number.to_string(),
        };
        let said = [
            (Attribute::ShipName, &particulars.name),
            (Attribute::Callsign, &particulars.callsign),
            (Attribute::ShipType, &ship_type),
        ];
        for (attribute, text) in said.into_iter().filter(|(_, text)| !text.is_empty()) {
            self.feed.describe_identity(identity, attribute, text);
        }
    }

    /// Forgets all ships where they are more.
    pub fn forget_beyond(&mut self, most: usize) {
        if self.ships.len() > most {
            self.ships.clear();
            self.feed.identities = Interner::default();
        }
    }

    pub fn finish(mut self) -> Feed {
        self.parts.end();
        self.give_up();
        if self.by_clock > 0 {
            let clock = match self.told.start_s {
                Some(_) => "the start that was given",
                None => "the clocks of base stations",
            };
            self.feed.warnings.push(format!(
                "{} positions have no time of a receiver: the seconds of their messages carry on {clock}",
                self.by_clock
            ));
        }
        self.feed
    }
}

impl Ship {
    fn new(mmsi: u32, feed: &mut Feed) -> Self {
        let text = format!("{mmsi:09}");
        let identity = feed.identities.number(&text);
        feed.describe_identity(identity, Attribute::Mmsi, &text);
        feed.describe_identity(identity, Attribute::ReportKind, "ais");
        Ship {
            identity,
            recent: [(f64::NEG_INFINITY, 0); 4],
            next: 0,
        }
    }

    /// Whether the message came just before; it is remembered.
    fn is_repeated(&mut self, time_s: f64, sum: u64) -> bool {
        let is_same =
            |&(other_s, other): &(f64, u64)| other == sum && (time_s - other_s).abs() <= REPEATED_S;
        if self.recent.iter().any(is_same) {
            return true;
        }
        self.recent[self.next] = (time_s, sum);
        self.next = (self.next + 1) % self.recent.len();
        false
    }
}
