//! A session as a recording: the scans that its tracker took, in their order, piece by piece.

use super::entry::Entry;
use super::line::{Kept, Key, Line};
use super::scene::Scene;
use super::{EntryFate, LatePolicy, Session};
use crate::model::beside::Beside;
use crate::model::fault::Fault;
use crate::model::scan::{Recording, RecordingParts};
use crate::model::sensor::SensorSettings;
use std::cmp::Ordering;
use std::sync::Arc;

/// Scans after which it is looked which of them have their place.
const PIECE: usize = 1024;

/// Reads a session's log anew, without tracking, to find which scans count.
pub struct SessionRecording {
    session: Session,
    /// Scans before which others may still come.
    open: Vec<Kept>,
    /// Scans that have their place.
    scans: u32,
}

impl SessionRecording {
    pub fn new(scene: Arc<Scene>) -> Self {
        let mut session = Session::new(scene);
        session.line = Line::untracked();
        SessionRecording {
            session,
            open: Vec::new(),
            scans: 0,
        }
    }

    /// Takes the next entry of the log, and gives now and then the scans that have their place.
    ///
    /// # Errors
    /// None that a session that took it did not have.
    pub fn add(&mut self, entry: Entry) -> Result<Option<Recording>, Vec<Fault>> {
        let kept = match &entry {
            Entry::Scan(scan) if !scan.heartbeat => {
                let sensor = self.session.scene.sensor_index(&scan.sensor_id);
                let scan = scan.clone();
                sensor.map(|sensor| Kept { sensor, scan })
            }
            _ => None,
        };
        let fate = self.session.take(entry).map_err(|fault| vec![*fault])?;
        let counts = !matches!(fate, EntryFate::LateDropped | EntryFate::Duplicate);
        self.open.extend(kept.filter(|_| counts));
        if self.open.len() < PIECE {
            return Ok(None);
        }
        self.sort();
        let placed = self.open.partition_point(|kept| self.is_placed(kept.key()));
        let rest = self.open.split_off(placed);
        let placed = std::mem::replace(&mut self.open, rest);
        (!placed.is_empty())
            .then(|| self.piece(&placed))
            .transpose()
    }

    /// The last scans: no entry follows.
    ///
    /// # Errors
    /// What no recording has, which a session refused before.
    pub fn end(&mut self) -> Result<Recording, Vec<Fault>> {
        self.sort();
        let rest = std::mem::take(&mut self.open);
        self.piece(&rest)
    }

    /// Scans that have their place so far.
    pub fn scans(&self) -> u32 {
        self.scans
    }

    fn sort(&mut self) {
        self.open.sort_by(|one, other| {
            one.key()
                .partial_cmp(&other.key())
                .unwrap_or(Ordering::Equal)
        });
    }

    /// Whether no scan comes before it any more.
    fn is_placed(&self, key: Key) -> bool {
        let (rules, last) = (self.session.scene.rules(), self.session.line.last);
        match rules.late {
            LatePolicy::Drop => true,
            LatePolicy::Wait => self.session.line.is_late(key),
            LatePolicy::Replay => {
                last.is_some_and(|last| last.time_s - key.time_s > rules.window_s)
            }
        }
    }

    fn piece(&mut self, placed: &[Kept]) -> Result<Recording, Vec<Fault>> {
        let scene = &self.session.scene;
        let mut parts = RecordingParts {
            frame: scene.frame(),
            sensors: scene
                .sensor_ids()
                .iter()
                .map(SensorSettings::named)
                .collect(),
            beside: times_of(placed),
            ..RecordingParts::default()
        };
        for Kept { sensor, scan } in placed {
            self.scans += 1;
            let ids = 0..scan.detections.len();
            parts
                .detection_ids
                .extend(ids.map(|index| scan.detection_id(index)));
            parts.scans.push(scan.scan(self.scans, *sensor));
        }
        Recording::new(parts)
    }
}

/// The times of detections, where any has one of its own.
fn times_of(taken: &[Kept]) -> Beside {
    let mut beside = Beside::default();
    let detections = || taken.iter().flat_map(|kept| &kept.scan.detections);
    if detections().all(|one| one.time_s().is_none()) {
        return beside;
    }
    for Kept { scan, .. } in taken {
        let times_s = scan
            .detections
            .iter()
            .map(|one| one.time_s().unwrap_or(scan.time_s));
        beside.times_s.extend(times_s);
    }
    beside
}
