//! CSV: a header line with the column names, then one row a line. Written with commas and quotes where needed; read with commas,
//! semicolons, tabs or bars, decimal commas, lines of comment, a byte order mark and Windows line ends, too. Row by row.

use super::csv_lines::CsvLines;
use super::dialect::{self, Dialect};
use super::lines::{self, BoundedLines};
use super::live::{Arrivals, Incoming, Listener};
use super::table::{self, FaultLog, Rows, Sink};
use super::{
    Format, MAX_COLUMNS, MAX_HEADER_BYTES, ReadOptions, ReadOutcome, Units, bearing_time,
    refuse_columns,
};
use crate::model::dataset::{Dataset, DatasetKind};
use crate::model::fault::Fault;
use crate::model::time::TimeBase;
use csv::{ErrorKind, ReaderBuilder, StringRecord, Terminator};
use std::io::{self, BufRead, Write};

/// Bytes of the header of a record, and how many bearings it may have.
const MAX_BEARING_BYTES: usize = 1 << 20;
const MAX_BEARINGS: usize = 1 << 16;

pub const FORMAT: Format = Format {
    name: "csv",
    summary: "Canonical CSV: detections, truth or tracks, one row a line under a header; or a bearing-time record as a matrix",
    media_type: "text/csv",
    kinds: &DatasetKind::ALL,
    options: &[],
    read,
};

/// Reads one dataset.
///
/// # Errors
/// Every fault, with line and column name.
pub fn read(input: &mut dyn BufRead, options: &ReadOptions) -> Result<ReadOutcome, Vec<Fault>> {
    let mut rows = CsvRows::open(input)?;
    let is_record = match options.kind {
        Some(kind) => kind == DatasetKind::BearingTime,
        None => bearing_time::is_matrix(rows.names()),
    };
    if is_record {
        refuse_columns(options)?;
        return bearing_time::read(&mut rows);
    }
    check_header(&rows.names, MAX_COLUMNS, MAX_HEADER_BYTES)?;
    table::read(&mut rows, options, Vec::new())
}

/// Reads detections as they come.
///
/// # Errors
/// Faults of the header.
pub(super) fn follow(
    arrivals: &mut dyn Arrivals,
    options: &ReadOptions,
    listener: &mut dyn Listener,
) -> Result<Units, Vec<Fault>> {
    let mut incoming = Incoming::begin(arrivals);
    let broken = incoming.broken();
    let mut rows = CsvLines::open(&mut incoming, &broken)?;
    check_header(rows.names(), MAX_COLUMNS, MAX_HEADER_BYTES)?;
    table::follow(&mut rows, options, &broken, listener)
}

/// Writes one dataset; [`read`] of it gives the same dataset.
///
/// # Errors
/// What the output says.
pub fn write_csv(dataset: &Dataset, out: &mut dyn Write) -> io::Result<()> {
    if let Dataset::BearingTime(record) = dataset {
        return bearing_time::write(record, out);
    }
    let base = Some(dataset.time_base()).filter(|base| base.is_utc());
    let mut sink = CsvSink {
        time_base: base.map(TimeBase::name),
        ..CsvSink::new(out)
    };
    table::write(dataset, &mut sink)?;
    sink.flush()
}

struct CsvRows<'a> {
    reader: csv::Reader<BoundedLines<'a>>,
    names: Vec<String>,
    record: StringRecord,
    line: u64,
    has_decimal_commas: bool,
}

impl<'a> CsvRows<'a> {
    /// Reads the header.
    fn open(input: &'a mut dyn BufRead) -> Result<Self, Vec<Fault>> {
        // Records end at '\n' so that lines can be counted; the '\r' of a Windows line end is cut off by us.
        let dialect = Dialect::of(input.fill_buf().unwrap_or_default());
        let (lines, newline) = (BoundedLines::new(input), Terminator::Any(b'\n'));
        let reader = ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .delimiter(dialect.delimiter)
            .comment(dialect.comment)
            .terminator(newline)
            .from_reader(lines);
        let mut rows = CsvRows {
            reader,
            names: Vec::new(),
            record: StringRecord::new(),
            line: 1,
            has_decimal_commas: dialect.has_decimal_commas,
        };
        let mut faults = FaultLog::default();
        let found = rows.next_record(&mut faults);
        faults.finish()?;
        if !found {
            let fault = Fault::new(
                "/file",
                "empty",
                "the file is empty; its first line must name the columns",
            );
            return Err(vec![Fault {
                line: Some(1),
                ..fault
            }]);
        }
        if rows.record.len() > MAX_BEARINGS || rows.record.as_slice().len() > MAX_BEARING_BYTES {
            return Err(vec![wide_header(
                rows.record.len(),
                rows.record.as_slice().len(),
                MAX_BEARINGS,
                MAX_BEARING_BYTES,
            )]);
        }
        rows.names = (0..rows.record.len())
            .map(|column| rows.cell(column).trim().to_owned())
            .collect();
        Ok(rows)
    }

    /// Reads the next record that is text; reports those that are not.
    fn next_record(&mut self, faults: &mut FaultLog) -> bool {
        while !faults.is_full() {
            let before = self.reader.position().line();
            let read = self.reader.read_record(&mut self.record);
            let after = self.reader.position().line();
            match read {
                Ok(false) => return false,
                Ok(true) => {
                    // Blank lines were skipped without being counted in `before`; lines inside quotes are in the record.
                    let inside = self
                        .record
                        .as_slice()
                        .bytes()
                        .filter(|&byte| byte == b'\n')
                        .count() as u64;
                    self.line = before.max(after.saturating_sub(1 + inside));
                    if self.record.as_slice() != "\r" || self.record.len() != 1 {
                        if self.has_decimal_commas {
                            self.record = dialect::with_points(&self.record);
                        }
                        return true;
                    }
                }
                Err(error) => {
                    let (fault, goes_on) = self.unreadable(&error, before);
                    faults.push(fault);
                    if !goes_on {
                        return false;
                    }
                }
            }
        }
        false
    }

    /// The fault of a record that cannot be read, and whether the next one may be.
    fn unreadable(&self, error: &csv::Error, line: u64) -> (Fault, bool) {
        let fault = |detail: String| Fault {
            line: Some(line),
            ..Fault::new("/file", "malformed", detail)
        };
        match error.kind() {
            ErrorKind::Utf8 { err, .. } => {
                let column = self.names.get(err.field()).map(|name| name.as_str().into());
                (
                    Fault {
                        column,
                        ..fault("the text is not UTF-8".to_owned())
                    },
                    true,
                )
            }
            ErrorKind::Io(error) if error.kind() == io::ErrorKind::FileTooLarge => {
                (lines::too_long(line), false)
            }
            _ => (
                fault(format!("the file cannot be read further: {error}")),
                false,
            ),
        }
    }

    fn count_fault(&self) -> Option<Fault> {
        let (cells, columns) = (self.record.len(), self.names.len());
        let detail = || format!("the row has {cells} values, the header names {columns} columns");
        let fault = (cells != columns).then(|| Fault::new("/file", "malformed", detail()))?;
        Some(Fault {
            line: Some(self.line),
            column: self.names.get(cells).map(|name| name.as_str().into()),
            ..fault
        })
    }
}

/// Refuses a header that no sound table has.
fn check_header(names: &[String], columns: usize, bytes: usize) -> Result<(), Vec<Fault>> {
    let found = names.iter().map(String::len).sum();
    if names.len() > columns || found > bytes {
        Err(vec![wide_header(names.len(), found, columns, bytes)])
    } else {
        Ok(())
    }
}

fn wide_header(found: usize, found_bytes: usize, columns: usize, bytes: usize) -> Fault {
    let detail = format!("the header names {found} columns in {found_bytes} bytes");
    let fault = Fault::new("/file", "too_large", detail)
        .allowing(format!("<= {columns} columns in <= {bytes} bytes"));
    Fault {
        line: Some(1),
        ..fault
    }
}

impl Rows for CsvRows<'_> {
    fn names(&self) -> &[String] {
        &self.names
    }

    fn advance(&mut self, faults: &mut FaultLog) -> bool {
        while self.next_record(faults) {
            match self.count_fault() {
                None => return true,
                Some(fault) => faults.push(fault),
            }
        }
        false
    }

    fn cell(&self, column: usize) -> &str {
        let cell = self.record.get(column).unwrap_or_default();
        if column + 1 == self.record.len() {
            cell.strip_suffix('\r').unwrap_or(cell)
        } else {
            cell
        }
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

pub(super) struct CsvSink<'a> {
    writer: csv::Writer<&'a mut dyn Write>,
    /// Reused for each number.
    number: String,
    /// What a last column says that times are counted from.
    time_base: Option<&'static str>,
}

impl<'a> CsvSink<'a> {
    pub fn new(out: &'a mut dyn Write) -> Self {
        CsvSink {
            writer: csv::Writer::from_writer(out),
            number: String::new(),
            time_base: None,
        }
    }

    pub fn flush(&mut self) -> io::Result<()> {
        self.writer.flush()
    }
}

impl Sink for CsvSink<'_> {
    fn begin(&mut self, columns: &[&'static str]) -> io::Result<()> {
        let base = self.time_base.map(|_| table::TIME_BASE);
        Ok(self
            .writer
            .write_record(columns.iter().copied().chain(base))?)
    }

    fn number(&mut self, value: Option<f64>) -> io::Result<()> {
        self.number.clear();
        if let Some(value) = value {
            table::push_number(&mut self.number, value);
        }
        Ok(self.writer.write_field(&self.number)?)
    }

    fn text(&mut self, value: Option<&str>) -> io::Result<()> {
        Ok(self.writer.write_field(value.unwrap_or_default())?)
    }

    fn end_row(&mut self) -> io::Result<()> {
        if let Some(base) = self.time_base {
            self.writer.write_field(base)?;
        }
        Ok(self.writer.write_record(None::<&[u8]>)?)
    }
}
