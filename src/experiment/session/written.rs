//! A session written down, from which the same one goes on to the bit: a checkpoint. It is of use with the log from its entry on.

use super::book::Book;
use super::events::EventRing;
use super::feeds::Feed;
use super::line::{Kept, Key, Line};
use super::order::{Course, Order};
use super::picture::RecentScans;
use super::scene::Scene;
use super::told::SessionCounts;
use super::trails::Trails;
use super::{LatePolicy, Session};
use crate::model::fault::Fault;
use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;
use std::sync::Arc;

/// Changes whenever older writing is not understood any more.
const VERSION: u32 = 2;

#[derive(Serialize, Deserialize)]
struct Written {
    version: u32,
    feeds: Vec<Feed>,
    counts: SessionCounts,
    is_paused: bool,
    events: EventRing,
    waiting: Vec<Kept>,
    /// Scans that were taken after the tracker was written down.
    window: Vec<WrittenScan>,
    line: WrittenLine,
}

#[derive(Serialize, Deserialize)]
struct WrittenScan {
    kept: Kept,
    /// Whether the tracker before it is kept.
    is_copied: bool,
}

#[derive(Serialize, Deserialize)]
struct WrittenLine {
    tracker: Box<RawValue>,
    book: Book,
    last: Option<Key>,
    scans: u32,
}

impl Session {
    /// All that it knows, but for the trails of its tracks.
    pub fn write_down(&self) -> Vec<u8> {
        // With late replay the tracker before the window: the scans of the window are taken again.
        let oldest = self.order.window.front();
        let line = oldest
            .and_then(|entry| entry.before.as_deref())
            .unwrap_or(&self.line);
        let window = self.order.window.iter().map(|entry| WrittenScan {
            kept: entry.kept.clone(),
            is_copied: entry.before.is_some(),
        });
        let written = Written {
            version: VERSION,
            feeds: self.feeds.clone(),
            counts: self.counts,
            is_paused: self.is_paused,
            events: self.events.clone(),
            waiting: self.order.waiting.iter().cloned().collect(),
            window: window.collect(),
            line: line.write_down(),
        };
        serde_json::to_vec(&written).expect("numbers and names are JSON")
    }

    /// The session that wrote this down.
    ///
    /// # Errors
    /// What no session of this version and these settings wrote.
    pub fn read_back(scene: Arc<Scene>, written: &[u8]) -> Result<Session, Box<Fault>> {
        let written: Written =
            serde_json::from_slice(written).map_err(|error| unread(&error.to_string()))?;
        if written.version != VERSION || written.feeds.len() != scene.sensor_ids().len() {
            return Err(unread("another version wrote it"));
        }
        let mut session = Session {
            line: Line::read_back(&scene, written.line)?,
            feeds: written.feeds,
            order: Order {
                waiting: written.waiting.into(),
                ..Order::default()
            },
            trails: Trails::default(),
            recent: RecentScans::default(),
            events: written.events,
            counts: written.counts,
            is_paused: written.is_paused,
            scene,
        };
        let mut course = Course {
            line: &mut session.line,
            trails: &mut session.trails,
            recent: &mut session.recent,
            scene: &session.scene,
        };
        if session.scene.rules().late == LatePolicy::Replay {
            for WrittenScan { kept, is_copied } in written.window {
                let order = &mut session.order;
                order.append_copied(kept, is_copied, &mut course)?;
            }
        }
        session.line.book.news.clear();
        session.recent = RecentScans::after(session.line.scans.into());
        Ok(session)
    }
}

impl Line {
    fn write_down(&self) -> WrittenLine {
        let tracker = self.tracker.as_ref().map(|tracker| tracker.write_down());
        let text = tracker.and_then(|bytes| String::from_utf8(bytes).ok());
        let text = text.unwrap_or_else(|| "null".to_owned());
        WrittenLine {
            tracker: RawValue::from_string(text).expect("a tracker writes JSON"),
            book: self.book.clone(),
            last: self.last,
            scans: self.scans,
        }
    }

    fn read_back(scene: &Scene, written: WrittenLine) -> Result<Line, Box<Fault>> {
        let mut line = Line {
            book: written.book,
            last: written.last,
            scans: written.scans,
            ..Line::new(scene)
        };
        if let Some(tracker) = &mut line.tracker {
            tracker.read_back(written.tracker.get().as_bytes())?;
        }
        Ok(line)
    }
}

fn unread(why: &str) -> Box<Fault> {
    let detail = format!("the checkpoint cannot be read: {why}");
    Box::new(Fault::new("", "malformed", detail))
}
