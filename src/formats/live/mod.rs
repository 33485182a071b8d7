//! Feeds as they come: the readers of files, fed piece by piece, tell each report at once. What comes is cut into whole lines or
//! blocks ([`Cutter`]); reports are gathered in scans as in datasets ([`Gatherer`]).

mod ais;
mod asterix;
mod cutter;
mod gatherer;
mod incoming;
mod mode_s;
mod reports;
mod turns;

pub use cutter::{Cut, Cutter, Piece};
pub use gatherer::{GatheredScan, Gatherer};
pub(super) use incoming::{Broken, Incoming};
pub(super) use reports::Reports;

use super::{Format, ReadOptions, Reading, Units};
use crate::model::fault::Fault;
use crate::model::scan::Detection;
use std::sync::Arc;

/// Pieces of a stream as they come.
pub trait Arrivals {
    /// The next piece; `None` at the end. It may wait.
    fn next(&mut self) -> Option<Piece>;
    /// When it came (Unix seconds).
    fn arrived_s(&self) -> f64;
}

/// Who is told what a stream says.
pub trait Listener {
    fn report(&mut self, report: LiveReport);
    /// How the units fared so far.
    fn units(&mut self, units: &Units);
    fn warn(&mut self, warning: String);
}

/// Which scan of its sensor a report is of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct ScanKey {
    /// It rises with the scans of a sensor.
    pub number: i64,
    pub kind: ScanKind,
}

/// What makes a scan.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum ScanKind {
    /// One time.
    Instant,
    /// A multiple of the period of frames.
    Frame,
    /// A turn of an antenna.
    Turn,
    /// The file's own number.
    Numbered,
}

/// What one unit of a stream says of a scan.
#[derive(Debug, Clone, PartialEq)]
pub struct LiveReport {
    /// As the stream calls it.
    pub sensor: Arc<str>,
    pub scan: ScanKey,
    pub time_s: f64,
    /// `None`: the scan is declared.
    pub detection: Option<Detection>,
    pub detection_id: String,
    /// Of its reports in one scan the last is kept.
    pub identity: Option<u32>,
    /// Number of its first unit (from 1), and of how many units it is made.
    pub unit: u64,
    pub units: u32,
}

/// Period of frames where nothing else is said (s).
pub const FRAME_S: f64 = super::feed::FRAME_S;

/// How the units of a format are told apart; `None` of what is read as a whole file only.
pub fn cut_of(format: &Format) -> Option<Cut> {
    match format.name {
        "asterix" => Some(Cut::Blocks),
        "ais" | "mode_s" | "csv" | "json" => Some(Cut::Lines),
        _ => None,
    }
}

/// Reads a stream to its end and tells what it says as it comes; places are in the plane about `origin` of the options.
///
/// # Errors
/// What is wrong with the options or the header; a format that is read as a whole file only. What is wrong with single units is
/// counted.
pub fn follow(
    format: &Format,
    arrivals: &mut dyn Arrivals,
    options: &ReadOptions,
    listener: &mut dyn Listener,
) -> Result<Units, Vec<Fault>> {
    let reading = Reading::of(&options.options)?;
    match format.name {
        "ais" => ais::follow(arrivals, &reading, listener),
        "mode_s" => mode_s::follow(arrivals, &reading, listener),
        "asterix" => asterix::follow(arrivals, &reading, listener),
        "csv" => super::csv::follow(arrivals, options, listener),
        "json" => super::json::follow(arrivals, options, listener),
        name => {
            let detail = format!("'{name}' is read as a whole file only");
            let allowed = "ais, mode_s, asterix, csv, json";
            Err(vec![
                Fault::new("/meta/format", "unsupported", detail).allowing(allowed),
            ])
        }
    }
}

/// The fault of latitudes where nothing says which plane they are to be in.
pub(super) fn no_origin() -> Vec<Fault> {
    let detail =
        "the feed gives latitudes and longitudes, and nothing says the origin of the plane";
    vec![Fault::new("/meta/origin", "no_frame", detail).allowing("an origin of the session")]
}
