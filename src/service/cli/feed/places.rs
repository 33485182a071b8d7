//! Where in a file a detection stands that a session refuses: the file is read once more, unit by unit.

use crate::experiment::session::PushedDetection;
use crate::formats::live::{Arrivals, Listener, LiveReport, Piece, follow};
use crate::formats::{Format, ReadOptions};
use crate::model::units::Units;

/// A file that was read as a dataset.
pub(super) struct Places {
    pub bytes: Vec<u8>,
    pub format: &'static Format,
    pub options: ReadOptions,
}

impl Places {
    /// Number of the line or record of a detection; `None` of formats that are read as a whole only.
    pub fn unit_of(&self, wanted: &PushedDetection) -> Option<u64> {
        let mut search = Search {
            // Pieces are read without what a detection has of its own.
            wanted: wanted.clone().without_own(),
            found: None,
        };
        let mut arrivals = Whole(Some(self.bytes.clone()));
        // What is wrong with the file was told before.
        let _ = follow(self.format, &mut arrivals, &self.options, &mut search);
        search.found
    }
}

/// A file as one piece.
struct Whole(Option<Vec<u8>>);

impl Arrivals for Whole {
    fn next(&mut self) -> Option<Piece> {
        self.0.take().map(Piece::Whole)
    }

    fn arrived_s(&self) -> f64 {
        0.0
    }
}

struct Search {
    wanted: PushedDetection,
    found: Option<u64>,
}

impl Listener for Search {
    fn report(&mut self, report: LiveReport) {
        let Some(detection) = report.detection.filter(|_| self.found.is_none()) else {
            return;
        };
        if PushedDetection::of(report.detection_id, &detection) == self.wanted {
            self.found = Some(report.unit);
        }
    }

    fn units(&mut self, _units: &Units) {}

    fn warn(&mut self, _warning: String) {}
}
