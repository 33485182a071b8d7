//! A live session: a tracker that is fed scan by scan, and tells what it believes at once. It is pure: whoever keeps its log and
//! writes it down now and then can make it again, to the bit.

mod book;
mod checking;
mod detection;
mod entry;
mod events;
mod feeds;
mod hand;
mod line;
mod named;
mod order;
mod picture;
mod pose;
mod reading;
mod recording;
mod reports;
mod scene;
mod spec;
mod told;
mod trails;
mod written;

pub use checking::{Checked, Checking};
pub use detection::{PushedDetection, Takes};
pub use entry::{Entry, PUSHED_SCAN, PushedScan};
pub use events::{SessionEvent, SessionEventKind};
pub use hand::{HAND_TRACK, HandTrack, read_track};
pub use picture::{SeenScan, SensorPlace, SessionPicture, TrackWay};
pub use pose::PushedPose;
pub use reading::{checked_scan, read_scan};
pub use recording::SessionRecording;
pub use scene::Scene;
pub use spec::{LatePolicy, SESSION, is_over};
pub use told::{LiveTrack, SensorHeard, SessionCounts, TrackHistory};

use crate::model::fault::Fault;
use events::{EventRing, serial_of};
use feeds::{Admission, Feed};
use line::{Kept, Line};
use order::{Course, Fate, Order};
use picture::RecentScans;
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
    recent: RecentScans,
    events: EventRing,
    counts: SessionCounts,
    /// Whether scans are refused for the time being.
    is_paused: bool,
}

/// What became of an entry.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
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
            recent: RecentScans::default(),
            events: EventRing::default(),
            counts: SessionCounts::default(),
            is_paused: false,
            scene,
        }
    }

    /// For looking at entries that are not in the log yet, in their order.
    pub fn checking(&self) -> Checking<'_> {
        Checking {
            session: self,
            feeds: self.feeds.clone(),
        }
    }

    /// Whether a track lives.
    pub fn lives(&self, track_id: &str) -> bool {
        let lines = &self.line.book.lines;
        serial_of(track_id).is_some_and(|serial| lines.contains_key(&serial))
    }

    /// Takes an entry that is in the log.
    ///
    /// # Errors
    /// The tracker is of no use any more: it would hold more than it may.
    pub fn take(&mut self, entry: Entry) -> Result<EntryFate, Box<Fault>> {
        self.counts.entries += 1;
        let fate = match entry {
            Entry::Scan(scan) => self.take_scan(scan)?,
            Entry::Begin(track) => {
                self.counts.by_hand += 1;
                self.order.decide();
                self.line.begin(&track.kinematics, &mut self.trails);
                EntryFate::Taken
            }
            Entry::End { track_id } => {
                self.counts.by_hand += 1;
                self.order.decide();
                if let Some(serial) = serial_of(&track_id) {
                    self.line.forget(&[serial], &mut self.trails);
                }
                EntryFate::Taken
            }
            Entry::Pause => self.pause(true),
            Entry::Resume => self.pause(false),
        };
        self.tell();
        Ok(fate)
    }

    fn pause(&mut self, is_paused: bool) -> EntryFate {
        self.is_paused = is_paused;
        EntryFate::Taken
    }

    /// Whether scans are refused for the time being.
    pub fn is_paused(&self) -> bool {
        self.is_paused
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
            recent: &mut self.recent,
            scene: &self.scene,
        };
        if is_heartbeat {
            self.counts.heartbeats += 1;
            self.order.release(&self.feeds, &mut course)?;
            return Ok(EntryFate::Taken);
        }
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
            Fate::Replayed { again, before } => {
                self.counts.replayed += 1;
                let kind = SessionEventKind::Revised;
                self.tell_of_feed(kind, time_s, sensor, Some(again as u64));
                let now_s = self.line.last.map_or(time_s, |last| last.time_s);
                // In the place of what was told of these scans once more.
                self.line.book.news = self.line.book.differences(&before, now_s);
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
            recent: &mut self.recent,
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
        let sensor_id = self.scene.sensor_ids()[sensor].clone();
        self.events.push(SessionEvent {
            sensor_id: Some(sensor_id),
            count,
            ..SessionEvent::plain(kind, time_s)
        });
    }

    pub fn scene(&self) -> &Arc<Scene> {
        &self.scene
    }
}
