//! Frames to reports: what each aircraft said of itself, and its places.

use super::Told;
use super::aircraft::{Aircraft, Found, Heard};
use super::cpr::{Coded, Place};
use super::fields::{self, FOOT_M};
use super::frame::{Frame, NoFrame};
use crate::formats::Reason;
use crate::formats::feed::{Attribute, Feed, Report, Spot};
use crate::formats::table::Interner;
use std::collections::HashMap;

/// Replies name their aircraft by parity alone, so they are believed of those that were heard this long ago.
const HEARD_S: f64 = 60.0;

/// Addresses that are none of ICAO's have this bit.
const ANONYMOUS: u32 = 1 << 24;

/// Formats of which nothing is asked for, or only what is told of an aircraft.
const FORMATS: [&str; 25] = [
    "DF0", "DF1", "DF2", "DF3", "DF4", "DF5", "DF6", "DF7", "DF8", "DF9", "DF10", "DF11", "DF12",
    "DF13", "DF14", "DF15", "DF16", "DF17", "DF18", "DF19", "DF20", "DF21", "DF22", "DF23", "DF24",
];

/// Type codes of squitters, likewise.
const TYPE_CODES: [&str; 32] = [
    "TC0", "TC1", "TC2", "TC3", "TC4", "TC5", "TC6", "TC7", "TC8", "TC9", "TC10", "TC11", "TC12",
    "TC13", "TC14", "TC15", "TC16", "TC17", "TC18", "TC19", "TC20", "TC21", "TC22", "TC23", "TC24",
    "TC25", "TC26", "TC27", "TC28", "TC29", "TC30", "TC31",
];

/// An altitude of a report.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Altitude {
    /// Feet of the standard atmosphere.
    Pressure(i32),
    /// Feet above the ellipsoid.
    Geometric(i32),
}

/// A report before it has an identity.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sighting {
    pub time_s: f64,
    pub unit: u64,
    pub place: Place,
    pub altitude: Option<Altitude>,
    pub is_on_ground: Option<bool>,
}

pub struct Decoder {
    pub feed: Feed,
    receiver: Option<Place>,
    /// By address, and [`ANONYMOUS`].
    aircraft: HashMap<u32, Aircraft>,
    pressure_altitudes: u64,
    geometric_heights: u64,
}

impl Decoder {
    pub fn new(unit: &str, told: &Told) -> Self {
        let mut feed = Feed::of(unit);
        feed.sensors.number("adsb");
        Decoder {
            feed,
            receiver: told
                .receiver
                .map(|receiver| (receiver.lat_deg, receiver.lon_deg)),
            aircraft: HashMap::new(),
            pressure_altitudes: 0,
            geometric_heights: 0,
        }
    }

    pub(super) fn aircraft(&mut self, address: u32) -> &mut Aircraft {
        self.aircraft.entry(address).or_default()
    }

    /// Takes one frame, which is the unit of that number.
    pub fn frame(&mut self, octets: &[u8], time_s: Option<f64>, unit: u64) {
        let frame = match Frame::of(octets) {
            Ok(frame) => frame,
            Err(NoFrame::Short) => return self.feed.reject(Reason::Truncated, unit, 1),
            Err(NoFrame::Malformed) => return self.feed.reject(Reason::Malformed, unit, 1),
        };
        match frame.format() {
            // The last seven bits may be the code of the interrogator.
            11 if frame.remainder() >= 1 << 7 => {
                return self.feed.reject(Reason::Checksum, unit, 1);
            }
            17 | 18 if frame.remainder() != 0 => {
                return self.feed.reject(Reason::Checksum, unit, 1);
            }
            17 | 18 => return self.squitter(&frame, time_s, unit),
            11 => self.aircraft(frame.address()).heard_s = time_s,
            4 | 5 | 20 | 21 => self.reply(&frame, time_s),
            _ => {}
        }
        self.feed.ignore(FORMATS[frame.format()], 1);
    }

    /// The altitude, or the identity code, that an interrogation asked for.
    fn reply(&mut self, frame: &Frame, time_s: Option<f64>) {
        let aircraft = self.aircraft.get_mut(&frame.remainder());
        let (Some(aircraft), Some(time_s)) = (aircraft, time_s) else {
            return;
        };
        let is_near = |heard_s: f64| (time_s - heard_s).abs() <= HEARD_S;
        if !aircraft.heard_s.is_some_and(is_near) {
            return;
        }
        let code = frame.field(19, 13);
        match frame.format() {
            4 | 20 => aircraft.climbs(time_s, fields::altitude_ft(code)),
            _ => aircraft.mode_a = Some(fields::identity_code(code)),
        }
    }

    fn squitter(&mut self, frame: &Frame, time_s: Option<f64>, unit: u64) {
        let address = match (frame.format(), frame.field(5, 3)) {
            (17, _) | (_, 0 | 2 | 6) => frame.address(),
            (_, 1 | 5) => frame.address() | ANONYMOUS,
            (_, 3) => return self.feed.ignore("DF18 CF3", 1),
            (_, 4) => return self.feed.ignore("DF18 CF4", 1),
            _ => return self.feed.ignore("DF18 CF7", 1),
        };
        let type_code = frame.message(0, 5) as usize;
        let has_position = matches!(type_code, 5..=18 | 20..=22);
        match time_s {
            Some(time_s) if has_position => self.position(frame, address, time_s, unit),
            None if has_position => self.feed.reject(Reason::NoTime, unit, 1),
            Some(time_s) => {
                self.tell(frame, address, time_s);
                self.feed.ignore(TYPE_CODES[type_code], 1);
            }
            None => self.feed.ignore(TYPE_CODES[type_code], 1),
        }
    }

    /// What a squitter without a position says.
    fn tell(&mut self, frame: &Frame, address: u32, time_s: f64) {
        let aircraft = self.aircraft(address);
        aircraft.heard_s = Some(time_s);
        let subtype = frame.message(5, 3);
        match frame.message(0, 5) {
            1..=4 => {
                if let Some(callsign) = fields::callsign(frame) {
                    aircraft.name(callsign);
                }
            }
            19 => aircraft.moves(time_s, fields::velocity(frame)),
            28 if subtype == 1 => {
                aircraft.mode_a = Some(fields::identity_code(frame.message(11, 13)));
            }
            // The first version has no such accuracy.
            31 if subtype < 2 => {
                let version = frame.message(40, 3);
                aircraft.nac_p = (version > 0).then(|| frame.message(44, 4));
            }
            _ => {}
        }
    }

    fn position(&mut self, frame: &Frame, address: u32, time_s: f64, unit: u64) {
        let receiver = self.receiver;
        let type_code = frame.message(0, 5);
        let is_surface = type_code < 9;
        let aircraft = self.aircraft(address);
        aircraft.heard_s = Some(time_s);
        if is_surface && receiver.is_none() {
            return self
                .feed
                .ignore("surface position without receiver place", 1);
        }
        let heard = Heard {
            time_s,
            coded: Coded::of(
                frame.message(21, 1) == 1,
                is_surface,
                frame.message(22, 17),
                frame.message(39, 17),
            ),
            is_standing: is_surface && frame.message(5, 7) == 1,
            message: frame.whole_message(),
        };
        if is_surface {
            aircraft.moves(time_s, fields::surface_motion(frame));
        }
        let altitude_ft = fields::squitter_altitude_ft(frame.message(8, 12));
        let altitude = match type_code {
            ..9 => None,
            9..19 => altitude_ft
                .or(aircraft.altitude_ft(time_s))
                .map(Altitude::Pressure),
            _ => altitude_ft.map(Altitude::Geometric),
        };
        match aircraft.locate(heard, receiver) {
            Found::Place(place) => {
                let sighting = Sighting {
                    time_s,
                    unit,
                    place,
                    altitude,
                    is_on_ground: Some(is_surface),
                };
                self.push(address, &sighting);
            }
            Found::Unpaired => self.feed.ignore("position without its pair", 1),
            Found::Repeated => self.feed.ignore("duplicate", 1),
            Found::Jump => self.feed.reject(Reason::PositionJump, unit, 1),
            Found::Far => self.feed.reject(Reason::OutOfRange, unit, 1),
        }
    }

    /// A report of an aircraft, with what else it said.
    pub(super) fn push(&mut self, address: u32, sighting: &Sighting) {
        let (feed, time_s) = (&mut self.feed, sighting.time_s);
        let aircraft = self.aircraft.entry(address).or_default();
        let identity = *aircraft
            .identity
            .get_or_insert_with(|| identity_of(feed, address));
        let (height_ft, mode_c_ft) = match sighting.altitude {
            Some(Altitude::Pressure(feet)) => (Some(feet), Some(feet)),
            Some(Altitude::Geometric(feet)) => (Some(feet), aircraft.altitude_ft(time_s)),
            None => (None, None),
        };
        feed.push(Report {
            time_s,
            unit: sighting.unit,
            units: 1,
            sensor: 0,
            identity: Some(identity),
            spot: Spot::Geographic {
                lat_deg: sighting.place.0,
                lon_deg: sighting.place.1,
            },
            height_m: height_ft.map(|feet| f64::from(feet) * FOOT_M),
            motion: aircraft.motion(time_s),
            sigma_m: Some(fields::sigma_m(aircraft.nac_p)),
            status: None,
            begins: std::mem::take(&mut aircraft.is_renamed),
            ends: false,
        });
        if let Some(feet) = mode_c_ft {
            feed.describe(Attribute::ModeC, &feet.to_string());
        }
        if let Some(mode_a) = aircraft.mode_a {
            feed.describe(Attribute::ModeA, &format!("{mode_a:04o}"));
        }
        if let Some(callsign) = &aircraft.callsign {
            feed.describe(Attribute::Callsign, callsign);
        }
        if let Some(is_on_ground) = sighting.is_on_ground {
            feed.describe(
                Attribute::OnGround,
                if is_on_ground { "true" } else { "false" },
            );
        }
        match sighting.altitude {
            Some(Altitude::Pressure(_)) => self.pressure_altitudes += 1,
            Some(Altitude::Geometric(_)) => self.geometric_heights += 1,
            None => {}
        }
    }

    /// Forgets all aircraft where they are more.
    pub fn forget_beyond(&mut self, most: usize) {
        if self.aircraft.len() > most {
            self.aircraft.clear();
            self.feed.identities = Interner::default();
        }
    }

    pub fn finish(mut self) -> Feed {
        for aircraft in self.aircraft.values() {
            if let (Some(identity), Some(callsign)) = (aircraft.identity, &aircraft.callsign) {
                self.feed
                    .describe_identity(identity, Attribute::Callsign, callsign);
            }
        }
        let references = [
            (
                self.pressure_altitudes,
                "pressure altitudes, above 1013.25 hPa in the standard atmosphere",
            ),
            (self.geometric_heights, "above the ellipsoid"),
        ];
        for (count, reference) in references.into_iter().filter(|(count, _)| *count > 0) {
            self.feed
                .warnings
                .push(format!("the heights of {count} positions are {reference}"));
        }
        self.feed
    }
}

fn identity_of(feed: &mut Feed, address: u32) -> u32 {
    let is_anonymous = address & ANONYMOUS != 0;
    let text = format!("{:06X}", address & !ANONYMOUS);
    let name = if is_anonymous {
        format!("~{text}")
    } else {
        text
    };
    let identity = feed.identities.number(&name);
    if !is_anonymous {
        feed.describe_identity(identity, Attribute::Address, &name);
    }
    feed.describe_identity(identity, Attribute::ReportKind, "adsb");
    identity
}
