//! A session as a recording: the scans that its tracker took, in their order.

use super::entry::Entry;
use super::line::{Kept, Line};
use super::scene::Scene;
use super::{EntryFate, Session};
use crate::formats::write_csv;
use crate::model::beside::Beside;
use crate::model::dataset::Dataset;
use crate::model::fault::Fault;
use crate::model::scan::{Recording, RecordingParts};
use crate::model::sensor::SensorSettings;
use std::sync::Arc;

/// Reads a session's log anew, without tracking, to find which scans count.
pub struct SessionRecording {
    session: Session,
    taken: Vec<Kept>,
}

impl SessionRecording {
    pub fn new(scene: Arc<Scene>) -> Self {
        let mut session = Session::new(scene);
        session.line = Line::untracked();
        SessionRecording {
            session,
            taken: Vec::new(),
        }
    }

    /// Takes the next entry of the log.
    ///
    /// # Errors
    /// None that a session that took it did not have.
    pub fn add(&mut self, entry: Entry) -> Result<(), Box<Fault>> {
        let kept = match &entry {
            Entry::Scan(scan) if !scan.heartbeat => {
                let sensor = self.session.scene.sensor_index(&scan.sensor_id);
                let scan = scan.clone();
                sensor.map(|sensor| Kept { sensor, scan })
            }
            _ => None,
        };
        let fate = self.session.take(entry)?;
        let counts = !matches!(fate, EntryFate::LateDropped | EntryFate::Duplicate);
        self.taken.extend(kept.filter(|_| counts));
        Ok(())
    }

    /// Scans that count so far.
    pub fn scans(&self) -> usize {
        self.taken.len()
    }

    /// The recording as canonical CSV.
    ///
    /// # Errors
    /// What no recording has, which a session refused before.
    pub fn into_csv(self) -> Result<Vec<u8>, Vec<Fault>> {
        let recording = Dataset::Detections(self.into_recording()?);
        let mut text = Vec::new();
        write_csv(&recording, &mut text).map_err(|error| {
            let detail = format!("the recording cannot be written: {error}");
            vec![Fault::new("", "malformed", detail)]
        })?;
        Ok(text)
    }

    fn into_recording(mut self) -> Result<Recording, Vec<Fault>> {
        self.taken.sort_by(|one, other| {
            one.key()
                .partial_cmp(&other.key())
                .unwrap_or(std::cmp::Ordering::Equal)
        });
        let scene = &self.session.scene;
        let mut parts = RecordingParts {
            frame: scene.frame(),
            sensors: scene
                .sensor_ids()
                .iter()
                .map(SensorSettings::named)
                .collect(),
            ..RecordingParts::default()
        };
        for (kept, number) in self.taken.iter().zip(1..) {
            let scan = &kept.scan;
            let ids = 0..scan.detections.len();
            parts
                .detection_ids
                .extend(ids.map(|index| scan.detection_id(index)));
            parts.scans.push(scan.scan(number, kept.sensor));
        }
        parts.beside = times_of(&self.taken);
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
