//! Canonical CSV of detections that are too many to hold: looked at piece by piece for the columns that they need, then written.

use super::csv::CsvSink;
use super::table::{Layout, Sink, write_rows};
use crate::model::scan::Recording;
use std::io::{self, Write};

/// A table of detections in pieces.
#[derive(Clone, Copy, Default)]
pub struct DetectionsCsv {
    /// Of the pieces that were looked at.
    layout: Option<Layout>,
}

impl DetectionsCsv {
    /// Looks at a piece. One without detections needs nothing.
    pub fn look(&mut self, piece: &Recording) {
        if piece.detections().next().is_none() {
            return;
        }
        let layout = Layout::for_recording(piece);
        self.layout.get_or_insert(layout).join(&layout);
    }

    fn layout(&self) -> Layout {
        let of_nothing = || Layout::for_recording(&Recording::default());
        self.layout.unwrap_or_else(of_nothing)
    }

    /// Writes the header.
    ///
    /// # Errors
    /// What the output says.
    pub fn begin(&self, out: &mut dyn Write) -> io::Result<()> {
        let mut sink = CsvSink::new(out);
        sink.begin(&self.layout().columns())?;
        sink.flush()
    }

    /// Writes the rows of a piece that was looked at.
    ///
    /// # Errors
    /// What the output says.
    pub fn write(&self, piece: &Recording, out: &mut dyn Write) -> io::Result<()> {
        let mut sink = CsvSink::new(out);
        write_rows(piece, self.layout(), &mut sink)?;
        sink.flush()
    }
}
