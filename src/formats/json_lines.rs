//! Records of JSON as they come, one a line. The first names the columns.

use super::Reason;
use super::json_document::Columns;
use super::json_records::Records;
use super::lines::{read_line, unreadable_at};
use super::live::Broken;
use super::table::{FaultLog, Rows};
use crate::model::fault::Fault;
use serde::de::DeserializeSeed;
use std::io::BufRead;

pub(super) struct LineRows<'a> {
    input: &'a mut dyn BufRead,
    broken: Broken,
    names: Vec<String>,
    /// Of the current record, in the order of the names.
    cells: Vec<String>,
    line: u64,
    /// Records so far.
    records: u64,
    /// Whether the current record is still to be handed on.
    is_next: bool,
}

impl<'a> LineRows<'a> {
    /// # Errors
    /// A first line that is no record.
    pub fn open(input: &'a mut dyn BufRead, broken: &Broken) -> Result<Self, Vec<Fault>> {
        let mut rows = LineRows {
            input,
            broken: broken.clone(),
            names: Vec::new(),
            cells: Vec::new(),
            line: 0,
            records: 0,
            is_next: false,
        };
        let first = rows.record().map_err(|fault| vec![*fault])?;
        let Some(first) = first else {
            return Err(vec![Fault::new("/file", "empty", "the stream is empty")]);
        };
        rows.names.clone_from(&first.names);
        rows.keep(&first);
        rows.is_next = true;
        Ok(rows)
    }

    /// The next line that is not empty; `None` at the end.
    fn record(&mut self) -> Result<Option<Columns>, Box<Fault>> {
        let mut line = Vec::new();
        loop {
            self.line += 1;
            let read = read_line(self.input, &mut line);
            if !read.map_err(|error| Box::new(unreadable_at(&error, self.line)))? {
                return Ok(None);
            }
            if !line.trim_ascii().is_empty() {
                break;
            }
        }
        let mut records = Records::default();
        let mut deserializer = serde_json::Deserializer::from_slice(&line);
        let read = (&mut records).deserialize(&mut deserializer);
        match read.and_then(|()| deserializer.end()) {
            Ok(()) => Ok(Some(records.finish())),
            Err(error) => Err(Box::new(Fault {
                line: Some(self.line),
                ..Fault::new("/file", "malformed", error.to_string())
            })),
        }
    }

    /// Keeps the cells of a record; names that the first had not are passed over.
    fn keep(&mut self, record: &Columns) {
        self.records += 1;
        self.cells.clear();
        for name in &self.names {
            let place = record.names.iter().position(|known| known == name);
            let column = place.and_then(|place| record.columns.get(place));
            let cell = column.map_or("", |column| column.cell(0));
            self.cells.push(cell.to_owned());
        }
    }
}

impl Rows for LineRows<'_> {
    fn names(&self) -> &[String] {
        &self.names
    }

    /// Lines that are no records are counted as broken: a stream goes on however many there are.
    fn advance(&mut self, _faults: &mut FaultLog) -> bool {
        if std::mem::take(&mut self.is_next) {
            return true;
        }
        loop {
            match self.record() {
                Ok(Some(record)) => {
                    self.keep(&record);
                    return true;
                }
                Ok(None) => return false,
                Err(_) => self
                    .broken
                    .borrow_mut()
                    .reject(Reason::Malformed, self.line, 1),
            }
        }
    }

    fn cell(&self, column: usize) -> &str {
        &self.cells[column]
    }

    /// Counted as in files of JSON.
    fn row(&self) -> u64 {
        self.records - 1
    }

    fn row_word(&self) -> &'static str {
        "row"
    }

    fn cell_fault(&self, row: u64, column: usize, code: &str, detail: String) -> Fault {
        Fault::new("/file", code, detail).at(row, self.names[column].clone())
    }
}
