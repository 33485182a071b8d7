//! What is known of one aircraft, and where it is by the frames that it sends.

use super::cpr::{self, Coded, Place};
use crate::formats::feed::Motion;

/// An even and an odd frame make a place when they are this close: in the air, standing, and moving on the ground.
const PAIR_AIR_S: f64 = 10.0;
const PAIR_STANDING_S: f64 = 50.0;
const PAIR_TAXIING_S: f64 = 25.0;

/// How long a place leads to the next: nobody leaves half a zone in that time.
const KNOWN_S: f64 = 300.0;

/// Faster is nobody, but for the coarseness of places and times.
const FASTEST_AIR_MPS: f64 = 1000.0;
const FASTEST_SURFACE_MPS: f64 = 150.0;
const COARSENESS_S: f64 = 1.0;

/// How far a receiver hears.
const RANGE_M: f64 = 400.0 * 1852.0;

/// The same frame within this time is what another receiver heard.
const REPEATED_S: f64 = 0.1;

/// What an aircraft said last is believed for so long.
const BELIEVED_S: f64 = 10.0;

#[derive(Debug, Default)]
pub(super) struct Aircraft {
    /// Its number in the feed, once it has a place.
    pub identity: Option<u32>,
    /// Time of the last frame that names it.
    pub heard_s: Option<f64>,
    pub callsign: Option<String>,
    /// Whether another callsign was said since the last report.
    pub is_renamed: bool,
    pub mode_a: Option<u16>,
    pub nac_p: Option<u32>,
    motion: Option<(f64, Motion)>,
    altitude_ft: Option<(f64, i32)>,
    /// The last even and the last odd frame.
    frames: [Option<Heard>; 2],
    known: Option<(f64, Place)>,
}

/// A frame with a position.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Heard {
    pub time_s: f64,
    pub coded: Coded,
    pub is_standing: bool,
    /// All bits of its message.
    pub message: u64,
}

/// What a frame with a position comes to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Found {
    Place(Place),
    /// It needs another frame.
    Unpaired,
    /// Another receiver heard it.
    Repeated,
    /// Nobody gets there, or the receiver does not hear so far: everything begins anew.
    Jump,
    Far,
}

impl Aircraft {
    pub fn name(&mut self, callsign: String) {
        let is_other = self
            .callsign
            .as_ref()
            .is_some_and(|known| *known != callsign);
        self.is_renamed |= is_other;
        self.callsign = Some(callsign);
    }

    pub fn moves(&mut self, time_s: f64, motion: Option<Motion>) {
        self.motion = motion.map(|motion| (time_s, motion));
    }

    pub fn motion(&self, time_s: f64) -> Option<Motion> {
        let (said_s, motion) = self.motion?;
        ((time_s - said_s).abs() <= BELIEVED_S).then_some(motion)
    }

    pub fn climbs(&mut self, time_s: f64, altitude_ft: Option<i32>) {
        self.altitude_ft = altitude_ft.map(|altitude_ft| (time_s, altitude_ft));
    }

    pub fn altitude_ft(&self, time_s: f64) -> Option<i32> {
        let (said_s, altitude_ft) = self.altitude_ft?;
        ((time_s - said_s).abs() <= BELIEVED_S).then_some(altitude_ft)
    }

    /// Where it is by this frame, those before it, and the place of the receiver.
    pub fn locate(&mut self, heard: Heard, receiver: Option<Place>) -> Found {
        let own = usize::from(heard.coded.is_odd);
        let is_repeated = self.frames[own].is_some_and(|before| {
            before.message == heard.message && (heard.time_s - before.time_s).abs() <= REPEATED_S
        });
        if is_repeated {
            return Found::Repeated;
        }
        self.frames[own] = Some(heard);
        let known = self
            .known
            .filter(|known| (heard.time_s - known.0).abs() <= KNOWN_S);
        let place = match known {
            Some((_, place)) => cpr::near(&heard.coded, place),
            None => self.paired(&heard, receiver),
        };
        let Some(place) = place else {
            return Found::Unpaired;
        };
        let is_reached = is_reached(known, &heard, place);
        if is_reached && is_in_range(receiver, place) {
            self.known = Some((heard.time_s, place));
            return Found::Place(place);
        }
        self.frames = [None; 2];
        self.known = None;
        if is_reached { Found::Far } else { Found::Jump }
    }

    fn paired(&self, heard: &Heard, receiver: Option<Place>) -> Option<Place> {
        let other = self.frames[usize::from(!heard.coded.is_odd)]?;
        let longest_s = match heard.coded.is_surface {
            false => PAIR_AIR_S,
            true if heard.is_standing && other.is_standing => PAIR_STANDING_S,
            true => PAIR_TAXIING_S,
        };
        let is_pair = other.coded.is_surface == heard.coded.is_surface
            && (heard.time_s - other.time_s).abs() <= longest_s;
        if is_pair {
            cpr::from_pair(&other.coded, &heard.coded, receiver)
        } else {
            None
        }
    }
}

fn is_reached(known: Option<(f64, Place)>, heard: &Heard, place: Place) -> bool {
    let fastest_mps = if heard.coded.is_surface {
        FASTEST_SURFACE_MPS
    } else {
        FASTEST_AIR_MPS
    };
    known.is_none_or(|(known_s, from)| {
        let took_s = (heard.time_s - known_s).abs() + COARSENESS_S;
        cpr::distance_m(from, place) <= fastest_mps * took_s
    })
}

fn is_in_range(receiver: Option<Place>, place: Place) -> bool {
    receiver.is_none_or(|receiver| cpr::distance_m(receiver, place) <= RANGE_M)
}
