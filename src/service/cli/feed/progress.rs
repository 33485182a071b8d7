//! What a person is told of a feed: every second on a terminal, and at the end.

use crate::experiment::session::EntryFate;
use crate::model::units::Units;
use jiff::Timestamp;
use std::io::{IsTerminal, Write};
use std::time::{Duration, Instant};

const EVERY: Duration = Duration::from_secs(1);

/// How far a feed is.
pub(super) struct Progress {
    pub scans: u64,
    pub detections: u64,
    /// Scans that the session had.
    pub duplicates: u64,
    pub late_dropped: u64,
    /// Scans that it refused.
    pub refused: u64,
    /// Time of the newest scan that it has.
    pub acknowledged_to_s: Option<f64>,
    /// Behind the clock of the recording.
    pub lag_s: Option<f64>,
    /// Datagrams that came faster than they were read, here and in the kernel.
    pub lost: u64,
    pub lost_in_kernel: u64,
    pub units: Units,
    shown: Instant,
    is_terminal: bool,
}

/// Times after this are taken as UTC (1973).
const UTC_FROM_S: f64 = 1e8;

/// A time as UTC where it is one, else in seconds.
fn clock_text(time_s: f64) -> String {
    match Timestamp::from_millisecond((time_s * 1e3) as i64) {
        Ok(instant) if time_s > UTC_FROM_S => format!("{instant:.1}"),
        _ => format!("{time_s:.1} s"),
    }
}

impl Progress {
    pub fn new() -> Self {
        Progress {
            scans: 0,
            detections: 0,
            duplicates: 0,
            late_dropped: 0,
            refused: 0,
            acknowledged_to_s: None,
            lag_s: None,
            lost: 0,
            lost_in_kernel: 0,
            units: Units::called("unit"),
            shown: Instant::now(),
            is_terminal: std::io::stderr().is_terminal(),
        }
    }

    /// Notes what became of a scan.
    pub fn note(&mut self, fate: EntryFate, detections: usize, time_s: f64) {
        match fate {
            EntryFate::Duplicate => self.duplicates += 1,
            EntryFate::LateDropped => self.late_dropped += 1,
            EntryFate::Taken | EntryFate::Waiting | EntryFate::Replayed => {
                self.scans += 1;
                self.detections += detections as u64;
            }
        }
        let before_s = self.acknowledged_to_s.unwrap_or(time_s);
        self.acknowledged_to_s = Some(before_s.max(time_s));
    }

    /// Shows a line on a terminal, once a second.
    pub fn show(&mut self) {
        if self.is_terminal && self.shown.elapsed() >= EVERY {
            self.shown = Instant::now();
            eprint!("\r\x1b[K{}", self.line());
            // A terminal that is gone is no reason to stop.
            let _ = std::io::stderr().flush();
        }
    }

    fn line(&self) -> String {
        let mut line = format!("{} scans, {} detections", self.scans, self.detections);
        if let Some(time_s) = self.acknowledged_to_s {
            line.push_str(&format!(", acknowledged to {}", clock_text(time_s)));
        }
        if let Some(lag_s) = self.lag_s {
            let side = if lag_s < 0.0 { "ahead" } else { "behind" };
            line.push_str(&format!(", {:.1} s {side}", lag_s.abs()));
        }
        let several = [
            (self.duplicates, "there before"),
            (self.late_dropped, "too late"),
            (self.refused, "refused"),
            (self.lost, "datagrams lost"),
            (self.lost_in_kernel, "datagrams lost by the system"),
        ];
        for (count, what) in several.into_iter().filter(|(count, _)| *count > 0) {
            line.push_str(&format!(", {count} {what}"));
        }
        let rejected = self.units.rejected_count();
        if rejected > 0 {
            line.push_str(&format!(", {rejected} rejected"));
        }
        line
    }

    /// The sums.
    pub fn end(&self) {
        if self.is_terminal {
            eprint!("\r\x1b[K");
        }
        for told in self.units.rejections() {
            eprintln!("rejected: {told}");
        }
        let units = &self.units;
        let (ignored, rejected) = (units.ignored_count(), units.rejected_count());
        eprintln!(
            "{}; read {} {}s = {} used + {ignored} ignored + {rejected} rejected",
            self.line(),
            units.total,
            units.called,
            units.used,
        );
    }
}
