//! CSV as it comes, line by line: no cell goes over a line, so that one quote too many spoils one row alone.

use super::Reason;
use super::dialect::{self, Dialect};
use super::lines::{read_line, unreadable_at};
use super::live::Broken;
use super::table::{FaultLog, Rows};
use crate::model::fault::Fault;
use csv::{ReaderBuilder, StringRecord};
use std::io::BufRead;

/// Bytes that one line is read in at first.
const BUFFER: usize = 512;

pub(super) struct CsvLines<'a> {
    input: &'a mut dyn BufRead,
    broken: Broken,
    dialect: Dialect,
    names: Vec<String>,
    record: StringRecord,
    text: Vec<u8>,
    line: u64,
}

impl<'a> CsvLines<'a> {
    /// Reads the header.
    ///
    /// # Errors
    /// A stream that is empty, or a header that is no text.
    pub fn open(input: &'a mut dyn BufRead, broken: &Broken) -> Result<Self, Vec<Fault>> {
        let dialect = Dialect::of(input.fill_buf().unwrap_or_default());
        let mut rows = CsvLines {
            input,
            broken: broken.clone(),
            dialect,
            names: Vec::new(),
            record: StringRecord::new(),
            text: Vec::new(),
            line: 0,
        };
        while rows.next_line().map_err(|fault| vec![*fault])? {
            if rows.parse() == Some(true) {
                let names = rows.record.iter().map(|name| name.trim().to_owned());
                rows.names = names.collect();
                return Ok(rows);
            }
        }
        let detail = "the stream is empty; its first line must name the columns";
        Err(vec![Fault::new("/file", "empty", detail)])
    }

    fn next_line(&mut self) -> Result<bool, Box<Fault>> {
        self.line += 1;
        let read = read_line(self.input, &mut self.text);
        read.map_err(|error| Box::new(unreadable_at(&error, self.line)))
    }

    /// Whether the line is a row; `None` where it is no text.
    fn parse(&mut self) -> Option<bool> {
        let line = self.text.trim_ascii_end();
        let is_marked = self.line == 1 && line.starts_with(b"\xef\xbb\xbf");
        let line = if is_marked { &line[3..] } else { line };
        let mut reader = ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .delimiter(self.dialect.delimiter)
            .comment(self.dialect.comment)
            .buffer_capacity(BUFFER)
            .from_reader(line);
        let is_row = reader.read_record(&mut self.record).ok()?;
        if is_row && self.dialect.has_decimal_commas {
            self.record = dialect::with_points(&self.record);
        }
        Some(is_row)
    }
}

impl Rows for CsvLines<'_> {
    fn names(&self) -> &[String] {
        &self.names
    }

    /// Lines that are no rows are counted as broken: a stream goes on however many there are.
    fn advance(&mut self, _faults: &mut FaultLog) -> bool {
        while self.next_line().unwrap_or(false) {
            match self.parse() {
                Some(true) if self.record.len() == self.names.len() => return true,
                // Blank, or a comment.
                Some(false) => {}
                _ => self
                    .broken
                    .borrow_mut()
                    .reject(Reason::Malformed, self.line, 1),
            }
        }
        false
    }

    fn cell(&self, column: usize) -> &str {
        self.record.get(column).unwrap_or_default()
    }

    fn row(&self) -> u64 {
        self.line
    }

    fn row_word(&self) -> &'static str {
        "line"
    }

    fn cell_fault(&self, row: u64, column: usize, code: &str, detail: String) -> Fault {
        Fault::new("/file", code, detail).at(row, self.names[column].clone())
    }
}
