//! A live session: a tracker that is fed scan by scan, and tells what it believes at once. It is pure: whoever keeps its log and
//! writes it down now and then can make it again, to the bit.

mod book;
mod entry;
mod events;
mod feeds;
mod line;
mod order;
mod recording;
mod reports;
mod scene;
mod spec;
mod told;
mod trails;
mod written;

pub use entry::{Entry, PUSHED_SCAN, PushedScan, read_scan};
pub use events::{SessionEvent, SessionEventKind};
pub use recording::SessionRecording;
pub use scene::Scene;
pub use spec::{LatePolicy, SESSION};
pub use told::{LiveTrack, SessionCounts, TrackHistory};

use crate::model::fault::Fault;
use events::{EventRing, serial_of};
use feeds::{Admission, Feed};
use line::{Kept, Line};
use order::{Course, Fate, Order};
use std::sync::Arc;
use trails::Trails;

/// A session as it stands after the entries that it took.
pub struct Session {
    scene: Arc<Scene>,
    /// Of each sensor.
    feeds: Vec<Feed>,
    line: Line,
    order: Order,
    trails: Trails,
    events: EventRing,
    counts: SessionCounts,
}

/// What becomes of an entry before it is in the log.
#[derive(Debug, Clone, PartialEq)]
pub enum Checked {
    /// It is to be written to the log, then taken.
    New(Entry),
    /// It has come before.
    Duplicate,
}

/// What became of an entry.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum EntryFate {
    /// Taken by the tracker.
    Taken,
    /// Kept until others have come.
    Waiting,
    /// Too late, and dropped.
    LateDropped,
    /// Late, and earlier scans were processed again.
    Replayed,
    /// It came before and was not taken again.
    Duplicate,
}

impl Session {
    pub fn new(scene: Arc<Scene>) -> Self {
        Session {
            feeds: vec![Feed::default(); scene.sensor_ids().len()],
            line: Line::new(&scene),
            order: Order::default(),
            trails: Trails::default(),
            events: EventRing::default(),
            counts: SessionCounts::default(),
            scene,
        }
    }

    /// Looks at an entry that is not in the log yet, and gives its scan a number. `before` are entries that were looked at and will
    /// be taken first.
    ///
    /// # Errors
    /// A time too far ahead; a track that does not live.
    pub fn check(&self, entry: Entry, before: &[Entry]) -> Result<Checked, Fault> {
        let scan = match entry {
            Entry::End { track_id } => {
                let lives =
                    serial_of(&track_id).is_some_and(|it| self.line.book.lines.contains_key(&it));
                if !lives {
                    let detail = format!("no track '{track_id}' lives");
                    return Err(Fault::new("", "not_found", detail));
                }
                return Ok(Checked::New(Entry::End { track_id }));
            }
            Entry::Scan(scan) => scan,
        };
        let Some(sensor) = self.scene.sensor_index(&scan.sensor_id) else {
            let detail = format!("the session has no sensor '{}'", scan.sensor_id);
            return Err(Fault::new("/sensor_id", "unknown_value", detail));
        };
        let mut feed = self.feeds[sensor].clone();
        let mut newest_s = self.newest_s();
        for entry in before {
            if let Entry::Scan(other) = entry {
                newest_s =
                    Some(newest_s.map_or(other.time_s, |newest_s| newest_s.max(other.time_s)));
                if other.sensor_id == scan.sensor_id {
                    feed.admit(other.sequence);
                }
            }
        }
        let ahead_s = newest_s.map_or(0.0, |newest_s| scan.time_s - newest_s);
        let most_s = self.scene.rules().max_gap_s;
        if ahead_s > most_s {
            let detail = format!("the scan is {ahead_s} s later than the last");
            let allowed = format!("at most {most_s} s (max_gap_s)");
            return Err(Fault::new("/time_s", "out_of_range", detail).allowing(allowed));
        }
        match feed.admit(scan.sequence) {
            Admission::Duplicate => Ok(Checked::Duplicate),
            Admission::New { sequence, .. } => Ok(Checked::New(Entry::Scan(PushedScan {
                sequence: Some(sequence),
                ..scan
            }))),
        }
    }

    /// Takes an entry that is in the log.
    ///
    /// # Errors
    /// The tracker is of no use any more: it would hold more than it may.
    pub fn take(&mut self, entry: Entry) -> Result<EntryFate, Box<Fault>> {
        self.counts.entries += 1;
        let fate = match entry {
            Entry::End { track_id } => {
                if let Some(serial) = serial_of(&track_id) {
                    self.line.forget(&[serial], &mut self.trails);
                }
                EntryFate::Taken
            }
            Entry::Scan(scan) => self.take_scan(scan)?,
        };
        self.tell();
        Ok(fate)
    }

    fn take_scan(&mut self, scan: PushedScan) -> Result<EntryFate, Box<Fault>> {
        let Some(sensor) = self.scene.sensor_index(&scan.sensor_id) else {
            return Ok(EntryFate::LateDropped);
        };
        let Admission::New { missing, .. } = self.feeds[sensor].admit(scan.sequence) else {
            return Ok(EntryFate::Duplicate);
        };
        let time_s = scan.time_s;
        if missing > 0 {
            self.counts.missing += missing;
            self.tell_of_feed(SessionEventKind::Gap, time_s, sensor, Some(missing));
        }
        self.feeds[sensor].hear(time_s);
        let detections = scan.detections.len() as u64;
        let is_heartbeat = scan.heartbeat;
        let mut course = Course {
            line: &mut self.line,
            trails: &mut self.trails,
            scene: &self.scene,
        };
        if is_heartbeat {
            self.counts.heartbeats += 1;
            self.order.release(&self.feeds, &mut course)?;
            return Ok(EntryFate::Taken);
        }
        let before = (self.scene.rules().late == LatePolicy::Replay
            && course.line.last.is_some_and(|last| time_s <= last.time_s))
        .then(|| course.line.book.clone());
        let fate = self
            .order
            .take(Kept { sensor, scan }, &self.feeds, course)?;
        self.counts.scans += 1;
        self.counts.detections += detections;
        match fate {
            Fate::Taken => Ok(EntryFate::Taken),
            Fate::Waiting => Ok(EntryFate::Waiting),
            Fate::Dropped => {
                self.counts.late_dropped += 1;
                self.tell_of_feed(SessionEventKind::LateDropped, time_s, sensor, None);
                Ok(EntryFate::LateDropped)
            }
            Fate::Replayed(again) => {
                self.counts.replayed += 1;
                self.tell_of_feed(
                    SessionEventKind::Revised,
                    time_s,
                    sensor,
                    Some(again as u64),
                );
                self.line.book.news.clear();
                let now_s = self.line.last.map_or(time_s, |last| last.time_s);
                for event in self
                    .line
                    .book
                    .differences(&before.unwrap_or_default(), now_s)
                {
                    self.events.push(event);
                }
                Ok(EntryFate::Replayed)
            }
        }
    }

    /// No entry follows: what waits is taken, and what is open is decided.
    ///
    /// # Errors
    /// As [`Session::take`].
    pub fn finish(&mut self) -> Result<(), Box<Fault>> {
        let mut course = Course {
            line: &mut self.line,
            trails: &mut self.trails,
            scene: &self.scene,
        };
        self.order.flush(&mut course)?;
        self.line.finish(&mut self.trails);
        self.tell();
        Ok(())
    }

    fn tell(&mut self) {
        for event in std::mem::take(&mut self.line.book.news) {
            self.events.push(event);
        }
    }

    fn tell_of_feed(
        &mut self,
        kind: SessionEventKind,
        time_s: f64,
        sensor: usize,
        count: Option<u64>,
    ) {
        let sensor_id = self.scene.sensor_ids()[sensor].to_owned();
        self.events.push(SessionEvent {
            sensor_id: Some(sensor_id),
            count,
            ..SessionEvent::plain(kind, time_s)
        });
    }

    /// Of everything that was heard.
    fn newest_s(&self) -> Option<f64> {
        let heard = self.feeds.iter().filter_map(|feed| feed.newest_s);
        heard.fold(None, |newest: Option<f64>, time_s| {
            Some(newest.map_or(time_s, |newest_s| newest_s.max(time_s)))
        })
    }

    pub fn scene(&self) -> &Arc<Scene> {
        &self.scene
    }
}
