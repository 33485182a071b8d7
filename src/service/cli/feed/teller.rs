//! The thread that reads a stream, and what it tells.

use super::arrivals::{Head, Kind};
use super::ready::{Ready, read_scan};
use crate::formats::ReadOptions;
use crate::formats::live::{Arrivals, Listener, LiveReport, Piece, follow};
use crate::model::fault::Fault;
use crate::model::units::{Reason, Units};
use std::sync::{Arc, Mutex, PoisonError};
use tokio::sync::mpsc;

/// What the thread that reads tells.
pub(super) enum Told {
    Report(LiveReport),
    Scan(Box<Ready>),
    Warning(String),
    /// Lines that are no scans.
    Faults(Vec<Fault>),
    End(Result<Units, Vec<Fault>>),
}

/// Tells what the reader reads, on the reader's thread.
pub(super) struct Teller {
    pub sender: mpsc::Sender<Told>,
    pub units: Arc<Mutex<Units>>,
}

impl Teller {
    pub fn read(mut self, mut head: Head, said: Option<Kind>, options: &ReadOptions) {
        let Some(kind) = said.or_else(|| head.tell()) else {
            let detail = "the format could not be told from what came first; --format says it";
            let fault = Fault::new("/format", "unknown_value", detail);
            return self.tell(Told::End(Err(vec![fault])));
        };
        let mut arrivals = head.arrivals(kind);
        let done = match kind {
            Kind::Scans => Ok(self.scans(&mut arrivals)),
            Kind::Of(format) => follow(format, &mut arrivals, options, &mut self),
        };
        self.tell(Told::End(done));
    }

    /// Where nobody hears any more, nothing more comes either.
    fn tell(&self, told: Told) {
        let _ = self.sender.blocking_send(told);
    }

    /// Lines that are scans.
    fn scans(&mut self, arrivals: &mut dyn Arrivals) -> Units {
        let (mut units, mut number) = (Units::called("line"), 0);
        while let Some(piece) = arrivals.next() {
            let lines = match piece {
                Piece::Whole(lines) => lines,
                Piece::Broken(reason) => {
                    units.reject(reason, number + 1, 1);
                    continue;
                }
            };
            for line in lines.split_inclusive(|byte| *byte == b'\n') {
                number += 1;
                if line.trim_ascii().is_empty() {
                    units.ignore("blank", 1);
                    continue;
                }
                match read_scan(line, number) {
                    Ok(ready) => {
                        units.use_up(1);
                        self.tell(Told::Scan(Box::new(ready)));
                    }
                    Err(faults) => {
                        units.reject(Reason::Malformed, number, 1);
                        self.tell(Told::Faults(faults));
                    }
                }
            }
            self.units(&units);
        }
        units
    }
}

impl Listener for Teller {
    fn report(&mut self, report: LiveReport) {
        self.tell(Told::Report(report));
    }

    fn units(&mut self, units: &Units) {
        let mut known = self.units.lock().unwrap_or_else(PoisonError::into_inner);
        if known.total != units.total {
            known.clone_from(units);
        }
    }

    fn warn(&mut self, warning: String) {
        self.tell(Told::Warning(warning));
    }
}
