//! The tracker of a session with what goes along with it: what can be copied and gone back to.

use super::book::{Book, Taking};
use super::entry::PushedScan;
use super::events::{SessionEvent, SessionEventKind};
use super::scene::Scene;
use super::trails::Trails;
use crate::model::fault::Fault;
use crate::model::watch::{Halt, Watch};
use crate::tracking::Tracker;
use serde::{Deserialize, Serialize};
use std::cmp::Ordering;

/// A scan with what places it in the order of all: scans are taken in order of time, then sensor.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Kept {
    pub sensor: usize,
    pub scan: PushedScan,
}

impl Kept {
    pub fn key(&self) -> Key {
        Key {
            time_s: self.scan.time_s,
            sensor: self.sensor,
        }
    }
}

/// Time (finite) and sensor of a scan.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Key {
    pub time_s: f64,
    pub sensor: usize,
}

impl PartialOrd for Key {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        let by_time = self.time_s.total_cmp(&other.time_s);
        Some(by_time.then(self.sensor.cmp(&other.sensor)))
    }
}

/// A tracker after some scans.
pub struct Line {
    /// Absent where scans are only put in order.
    pub tracker: Option<Box<dyn Tracker>>,
    pub book: Book,
    /// Of the last scan.
    pub last: Option<Key>,
    /// Scans taken.
    pub scans: u32,
}

impl Line {
    pub fn new(scene: &Scene) -> Self {
        Line {
            tracker: Some(scene.new_tracker()),
            ..Line::untracked()
        }
    }

    /// Follows the scans, and nothing else.
    pub fn untracked() -> Self {
        Line {
            tracker: None,
            book: Book::default(),
            last: None,
            scans: 0,
        }
    }

    /// The same once more.
    pub fn fork(&self) -> Self {
        Line {
            tracker: self.tracker.as_ref().map(|tracker| tracker.fork()),
            book: self.book.clone(),
            last: self.last,
            scans: self.scans,
        }
    }

    /// Whether a scan comes too late to be taken.
    pub fn is_late(&self, key: Key) -> bool {
        self.last.is_some_and(|last| key <= last)
    }

    /// Takes the next scan.
    ///
    /// # Errors
    /// More candidates than a tracker may hold; then this is of no use any more.
    pub fn step(
        &mut self,
        kept: &Kept,
        scene: &Scene,
        trails: &mut Trails,
    ) -> Result<(), Box<Fault>> {
        let time_s = kept.scan.time_s;
        if let Some(tracker) = &mut self.tracker {
            let scan = kept.scan.scan(self.scans + 1, kept.sensor);
            let mut taking = Taking {
                book: &mut self.book,
                trails,
                time_s,
            };
            let outcome = tracker.step(&scan, &mut taking, &Watch::never());
            outcome.map_err(fault_of)?;
        }
        (self.last, self.scans) = (Some(kept.key()), self.scans + 1);
        let surplus = self.book.surplus(scene.rules().max_tracks);
        if !surplus.is_empty() {
            self.forget(&surplus, trails);
            self.book.limited += surplus.len() as u64;
            self.book.news.push(SessionEvent {
                count: Some(surplus.len() as u64),
                ..SessionEvent::plain(SessionEventKind::Limited, time_s)
            });
        }
        Ok(())
    }

    /// Begins a confirmed track at the last scan, and gives its serial; `None` of kinematics of another space.
    pub fn begin(&mut self, kinematics: &[f64], trails: &mut Trails) -> Option<u32> {
        let mut taking = Taking {
            time_s: self.last.map_or(0.0, |last| last.time_s),
            book: &mut self.book,
            trails,
        };
        let tracker = self.tracker.as_mut()?;
        tracker.begin(kinematics, &mut taking)
    }

    /// Ends tracks, by serial.
    pub fn forget(&mut self, serials: &[u32], trails: &mut Trails) {
        let mut taking = Taking {
            time_s: self.last.map_or(0.0, |last| last.time_s),
            book: &mut self.book,
            trails,
        };
        if let Some(tracker) = &mut self.tracker {
            tracker.forget(serials, &mut taking);
        }
    }

    /// What is still open is decided: no scan follows.
    pub fn finish(&mut self, trails: &mut Trails) {
        let mut taking = Taking {
            time_s: self.last.map_or(0.0, |last| last.time_s),
            book: &mut self.book,
            trails,
        };
        if let Some(tracker) = &mut self.tracker {
            tracker.finish(&mut taking);
        }
    }
}

fn fault_of(halt: Halt) -> Box<Fault> {
    match halt {
        Halt::TooLarge(fault) => fault,
        other => Box::new(Fault::new("", "conflict", other.to_string())),
    }
}
