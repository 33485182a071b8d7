//! What was wrong, when, of whom and where.

use crate::model::space::Place;

/// More are counted, not kept.
const MOST_EVENTS: usize = 1_000_000;

/// One fault of a target or of a track.
#[derive(Debug, Clone, PartialEq)]
pub struct Fault {
    pub time_s: f64,
    /// Indices into truth and tracks.
    pub target: Option<usize>,
    pub track: Option<u32>,
    pub what: &'static str,
    /// How large it is, and in which unit.
    pub size: Option<(f64, &'static str)>,
    pub place: Option<Place>,
}

/// A fault against a requirement in a sector: indices into the findings.
#[derive(Debug, Clone, PartialEq)]
pub struct Event {
    pub finding: usize,
    pub fault: Fault,
}

/// The faults of one requirement in one sector after another.
#[derive(Debug, Default)]
pub struct Log {
    pub finding: usize,
    pub events: Vec<Event>,
    pub left_out: u64,
}

impl Log {
    pub fn add(&mut self, fault: Fault) {
        if self.events.len() < MOST_EVENTS {
            let finding = self.finding;
            self.events.push(Event { finding, fault });
        } else {
            self.left_out += 1;
        }
    }
}
