//! What a session remembers of its living tracks besides what the tracker believes.

use super::events::{SessionEvent, SessionEventKind, track_id};
use super::trails::Trails;
use crate::model::track::TrackStatus;
use crate::tracking::Recorder;
use crate::tracking::recorder::RecordedPoint;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Of one living track.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Line {
    pub status: TrackStatus,
    /// Time of its first point.
    pub started_s: f64,
    /// Time of its latest detection.
    pub detected_s: f64,
    /// Scans at which it had one.
    pub detections: u32,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub existence: Option<f64>,
}

/// Of all living tracks, by serial.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Book {
    pub lines: BTreeMap<u32, Line>,
    /// Serials of all tracks that were ever confirmed, in the order in which they were.
    pub confirmed: Vec<u32>,
    /// Tracks that were dropped, for there were too many.
    #[serde(default)]
    pub limited: u64,
    /// What happened since somebody took it.
    #[serde(skip)]
    pub news: Vec<SessionEvent>,
}

impl Line {
    fn is_confirmed(&self) -> bool {
        self.status != TrackStatus::Tentative
    }
}

/// Takes down one scan.
pub struct Taking<'a> {
    pub book: &'a mut Book,
    pub trails: &'a mut Trails,
    pub time_s: f64,
}

impl Recorder for Taking<'_> {
    fn given(&mut self, _serial: u32, _name: &str) {}

    fn point(&mut self, point: &RecordedPoint) {
        self.trails.push(point);
        let is_detected = point
            .candidates
            .iter()
            .any(|candidate| candidate.detection.is_some())
            && point.status != TrackStatus::Coasted;
        self.book.note(point, is_detected, self.time_s);
    }

    fn end(&mut self, serial: u32) {
        self.trails.end(serial);
        // A track that was merged has been told.
        if self.book.lines.remove(&serial).is_some() {
            self.book.tell(SessionEventKind::Ended, self.time_s, serial);
        }
    }

    fn merged(&mut self, serial: u32, into: u32, time_s: f64) {
        if self.book.lines.remove(&serial).is_some() {
            self.book.news.push(SessionEvent {
                into_track_id: Some(track_id(into)),
                ..SessionEvent::of_track(SessionEventKind::Merged, time_s, serial)
            });
        }
    }
}

impl Book {
    fn tell(&mut self, kind: SessionEventKind, time_s: f64, serial: u32) {
        self.news.push(SessionEvent::of_track(kind, time_s, serial));
    }

    fn note(&mut self, point: &RecordedPoint, is_detected: bool, time_s: f64) {
        let serial = point.serial;
        let before = self.lines.get(&serial).map(|line| line.status);
        let line = self.lines.entry(serial).or_insert(Line {
            status: TrackStatus::Tentative,
            started_s: point.time_s,
            detected_s: point.time_s,
            detections: 0,
            existence: None,
        });
        line.status = point.status;
        line.existence = point.existence;
        if is_detected {
            line.detected_s = line.detected_s.max(point.time_s);
            line.detections += 1;
        }
        if before.is_none() {
            self.tell(SessionEventKind::Started, point.time_s, serial);
        }
        let was_confirmed = before.is_some_and(|status| status != TrackStatus::Tentative);
        let is_confirmed = point.status != TrackStatus::Tentative;
        let kind = match (before, point.status) {
            _ if is_confirmed && !was_confirmed => {
                self.confirmed.push(serial);
                SessionEventKind::Confirmed
            }
            (Some(TrackStatus::Confirmed), TrackStatus::Coasted) => SessionEventKind::Coasted,
            (Some(TrackStatus::Coasted), TrackStatus::Confirmed) => SessionEventKind::Resumed,
            _ => return,
        };
        self.tell(kind, time_s, serial);
    }

    /// What is otherwise than in an earlier book, as events.
    pub fn differences(&self, earlier: &Book, time_s: f64) -> Vec<SessionEvent> {
        let mut events = Vec::new();
        for (&serial, line) in &self.lines {
            let before = earlier.lines.get(&serial);
            if before.is_none() {
                let started = SessionEventKind::Started;
                events.push(SessionEvent::of_track(started, line.started_s, serial));
            }
            if line.is_confirmed() && !before.is_some_and(Line::is_confirmed) {
                let confirmed = SessionEventKind::Confirmed;
                events.push(SessionEvent::of_track(confirmed, time_s, serial));
            }
        }
        for &serial in earlier.lines.keys() {
            if !self.lines.contains_key(&serial) {
                events.push(SessionEvent::of_track(
                    SessionEventKind::Ended,
                    time_s,
                    serial,
                ));
            }
        }
        events
    }

    /// Tracks that live, and those of them that are confirmed.
    pub fn count(&self) -> (usize, usize) {
        let lines = self.lines.values();
        let confirmed = lines.filter(|line| line.is_confirmed()).count();
        (self.lines.len(), confirmed)
    }

    /// The youngest tentative tracks, as many as are too many.
    pub fn surplus(&self, most: usize) -> Vec<u32> {
        let surplus = self.lines.len().saturating_sub(most);
        let tentative = self.lines.iter().rev();
        tentative
            .filter(|(_, line)| !line.is_confirmed())
            .take(surplus)
            .map(|(&serial, _)| serial)
            .collect()
    }
}
