//! Looking at entries before they are in the log: as if those before them had been taken, but nothing is.

use super::Session;
use super::entry::{Entry, PushedScan};
use super::feeds::{Admission, Feed, newest_s};
use crate::model::fault::Fault;

/// What becomes of an entry before it is in the log.
#[derive(Debug, Clone, PartialEq)]
pub enum Checked {
    /// It is to be written to the log, then taken.
    New(Entry),
    /// It has come before.
    Duplicate,
}

/// A session, and what was heard of its sensors with the entries so far.
pub struct Checking<'s> {
    pub(super) session: &'s Session,
    pub(super) feeds: Vec<Feed>,
}

impl Checking<'_> {
    /// Looks at the next entry, and gives its scan a number.
    ///
    /// # Errors
    /// A time too far ahead; a track that does not live.
    pub fn check(&mut self, entry: Entry) -> Result<Checked, Fault> {
        match entry {
            Entry::Scan(scan) => self.check_scan(scan),
            Entry::End { track_id } if self.session.lives(&track_id) => {
                Ok(Checked::New(Entry::End { track_id }))
            }
            Entry::End { track_id } => {
                let detail = format!("no track '{track_id}' lives");
                Err(Fault::new("", "not_found", detail))
            }
            Entry::Begin(_) if self.session.processed_to_s().is_none() => {
                let detail = "before the first scan there is no time at which a track could begin";
                Err(Fault::new("", "conflict", detail))
            }
            Entry::Begin(_) | Entry::Pause | Entry::Resume => Ok(Checked::New(entry)),
        }
    }

    fn check_scan(&mut self, scan: PushedScan) -> Result<Checked, Fault> {
        let scene = &self.session.scene;
        let Some(sensor) = scene.sensor_index(&scan.sensor_id) else {
            let detail = format!("the session has no sensor '{}'", scan.sensor_id);
            return Err(Fault::new("/sensor_id", "unknown_value", detail));
        };
        let ahead_s = newest_s(&self.feeds).map_or(0.0, |newest_s| scan.time_s - newest_s);
        let most_s = scene.rules().max_gap_s;
        if ahead_s > most_s {
            let detail = format!("the scan is {ahead_s} s later than the last");
            let allowed = format!("at most {most_s} s (max_gap_s)");
            return Err(Fault::new("/time_s", "out_of_range", detail).allowing(allowed));
        }
        let feed = &mut self.feeds[sensor];
        let Admission::New { sequence, .. } = feed.admit(scan.sequence) else {
            return Ok(Checked::Duplicate);
        };
        feed.hear(scan.time_s);
        Ok(Checked::New(Entry::Scan(PushedScan {
            sequence: Some(sequence),
            ..scan
        })))
    }
}
