//! What an associator writes down step by step: rows of a table, up to a limit. What is beyond it is counted.

use serde::{Deserialize, Serialize};
use std::fmt::{self, Write};

/// Rows that are kept.
const MAX_ROWS: u64 = 500_000;

/// A table as CSV text.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Trace {
    text: String,
    rows: u64,
    left_out: u64,
}

impl Trace {
    /// `header` names the columns, divided by commas.
    pub fn new(header: &str) -> Self {
        Trace {
            text: format!("{header}\n"),
            rows: 0,
            left_out: 0,
        }
    }

    /// Adds a row, values divided by commas.
    pub fn push(&mut self, row: fmt::Arguments) {
        if self.rows == MAX_ROWS {
            self.left_out += 1;
            return;
        }
        self.rows += 1;
        self.text
            .write_fmt(row)
            .and_then(|()| self.text.write_char('\n'))
            .expect("a string takes all text");
    }

    pub fn text(&self) -> &str {
        &self.text
    }

    /// Rows that were not kept.
    pub fn left_out(&self) -> u64 {
        self.left_out
    }
}
