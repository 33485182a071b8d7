//! JSON: the columns of CSV as arrays, `null` where a cell is empty:
//! `{"kind": "truth", "columns": {"time_s": [0, 1], "truth_id": ["1", "1"], …}, "sensors": […]}`.
//! `kind` may be left out; `sensors` says what is known of the sensors of detections, `frame` where the origin is, `time_base` what
//! times are counted from. Columns alone, arrays of records, a record a line and the states of OpenSky are read, too.

use super::json_document::{Column, Columns, Document, MAX_SENSORS, document};
use super::json_lines::LineRows;
use super::json_records::Records;
use super::lines::read_line;
use super::live::{Arrivals, Incoming, Listener};
use super::table::{self, FaultLog, Rows, Sink, pointer_token};
use super::{Format, MAX_COLUMNS, MAX_HEADER_BYTES, ReadOptions, ReadOutcome, TABLES, Units};
use crate::model::dataset::{Dataset, DatasetKind};
use crate::model::fault::Fault;
use crate::model::names::name_fault;
use crate::model::sensor::SensorSettings;
use serde::de::DeserializeSeed;
use std::collections::BTreeSet;
use std::io::{self, BufRead, Write};

pub const FORMAT: Format = Format {
    name: "json",
    summary: "Canonical JSON: the columns of canonical CSV as arrays",
    media_type: "application/json",
    kinds: TABLES,
    options: &[],
    read,
};

/// Reads one dataset.
///
/// # Errors
/// Every fault: of the JSON text with its line, of a value with its pointer, such as `/file/columns/x_m/17`.
pub fn read(input: &mut dyn BufRead, options: &ReadOptions) -> Result<ReadOutcome, Vec<Fault>> {
    let mut document = if is_lines(input) {
        read_lines(input)?
    } else {
        document(input)?
    };
    let mut faults = FaultLog::default();
    let kind = options.kind.or(document.kind);
    if let (Some(asked), Some(said)) = (options.kind, document.kind)
        && asked != said
    {
        let detail = format!(
            "the file says it holds {}, the upload says {}",
            said.name(),
            asked.name()
        );
        faults.push(Fault::new("/file/kind", "conflict", detail));
    }
    check_counts(&document, &mut faults);
    check_lengths(&document.columns, &mut faults);
    check_sensors(&document.sensors.described, &mut faults);
    faults.finish()?;
    let mut rows = JsonRows {
        names: document.columns.names,
        columns: document.columns.columns,
        next: 0,
    };
    let described = std::mem::take(&mut document.sensors.described);
    let mut options = ReadOptions {
        kind,
        ..options.clone()
    };
    options.options.add("origin", &document.frame);
    options.options.add("time_base", &document.time_base);
    let mut outcome = table::read(&mut rows, &options, described)?;
    if document.sensors.count > 0 && outcome.dataset.kind() != DatasetKind::Detections {
        outcome
            .warnings
            .push("'sensors' is used for detections only".to_owned());
    }
    Ok(outcome)
}

/// Whether the text is a record a line: the first line is a whole object, and another follows.
fn is_lines(input: &mut dyn BufRead) -> bool {
    let Ok(head) = input.fill_buf() else {
        return false;
    };
    let text = head.trim_ascii_start();
    let mut lines = text.split(|&byte| byte == b'\n').map(<[u8]>::trim_ascii);
    let (first, second) = (lines.next(), lines.next());
    let is_whole = |line: &[u8]| line.starts_with(b"{") && line.ends_with(b"}");
    first.is_some_and(is_whole) && second.is_some_and(|line| line.starts_with(b"{"))
}

/// A record a line.
fn read_lines(input: &mut dyn BufRead) -> Result<Document, Vec<Fault>> {
    let mut records = Records::default();
    let mut faults = FaultLog::default();
    let (mut line, mut number) = (Vec::new(), 0);
    while !faults.is_full() {
        number += 1;
        match read_line(input, &mut line) {
            Ok(true) if line.trim_ascii().is_empty() => continue,
            Ok(true) => {}
            Ok(false) => break,
            Err(error) => {
                let fault = Fault::new(
                    "/file",
                    "malformed",
                    format!("the file cannot be read: {error}"),
                );
                faults.push(Fault {
                    line: Some(number),
                    ..fault
                });
                break;
            }
        }
        let mut deserializer = serde_json::Deserializer::from_slice(&line);
        let read = (&mut records).deserialize(&mut deserializer);
        if let Err(error) = read.and_then(|()| deserializer.end()) {
            let fault = Fault::new("/file", "malformed", error.to_string());
            faults.push(Fault {
                line: Some(number),
                ..fault
            });
        }
    }
    faults.finish()?;
    Ok(Document {
        columns: records.finish(),
        ..Document::default()
    })
}

/// Reads detections as they come, a record a line.
///
/// # Errors
/// A first line that is no record; faults of its names.
pub(super) fn follow(
    arrivals: &mut dyn Arrivals,
    options: &ReadOptions,
    listener: &mut dyn Listener,
) -> Result<Units, Vec<Fault>> {
    let mut incoming = Incoming::begin(arrivals);
    let broken = incoming.broken();
    let mut rows = LineRows::open(&mut incoming, &broken)?;
    table::follow(&mut rows, options, &broken, listener)
}

fn check_counts(document: &Document, faults: &mut FaultLog) {
    let name_bytes = document.columns.names.iter().map(String::len).sum();
    for (place, what, found, most) in [
        ("columns", "columns", document.columns.count, MAX_COLUMNS),
        (
            "columns",
            "bytes of column names",
            name_bytes,
            MAX_HEADER_BYTES,
        ),
        ("sensors", "sensors", document.sensors.count, MAX_SENSORS),
    ] {
        if found > most {
            let fault = Fault::new(
                format!("/file/{place}"),
                "too_large",
                format!("there are {found} {what}"),
            );
            faults.push(fault.allowing(format!("<= {most} {what}")));
        }
    }
}

fn check_lengths(columns: &Columns, faults: &mut FaultLog) {
    let Some((first, rest)) = columns.columns.split_first() else {
        return;
    };
    for (name, column) in columns.names[1..]
        .iter()
        .zip(rest)
        .filter(|(_, column)| column.ends.len() != first.ends.len())
    {
        let detail = format!(
            "the column has {} values, '{}' has {}",
            column.ends.len(),
            columns.names[0],
            first.ends.len()
        );
        faults.push(Fault::new(
            format!("/file/columns/{}", pointer_token(name)),
            "malformed",
            detail,
        ));
    }
}

fn check_sensors(sensors: &[SensorSettings], faults: &mut FaultLog) {
    let mut seen = BTreeSet::new();
    for (index, sensor) in sensors.iter().enumerate() {
        let mut report = |code, detail| {
            faults.push(Fault::new(
                format!("/file/sensors/{index}/sensor_id"),
                code,
                detail,
            ))
        };
        if sensor.sensor_id.is_empty() {
            report("missing", "'sensor_id' is empty".to_owned());
        } else if let Some(found) = name_fault(&sensor.sensor_id) {
            report(found.code, found.detail);
        } else if !seen.insert(sensor.sensor_id.as_str()) {
            report(
                "duplicate",
                format!("sensor '{}' is described twice", sensor.sensor_id),
            );
        }
        for misfit in sensor.misfits() {
            let detail = format!("{} is out of range", misfit.value);
            faults.push(
                Fault::new(
                    format!("/file/sensors/{index}/{}", misfit.field),
                    "out_of_range",
                    detail,
                )
                .allowing(misfit.allowed),
            );
        }
    }
}

struct JsonRows {
    names: Vec<String>,
    columns: Vec<Column>,
    /// The row after the current one.
    next: usize,
}

impl Rows for JsonRows {
    fn names(&self) -> &[String] {
        &self.names
    }

    fn advance(&mut self, _faults: &mut FaultLog) -> bool {
        self.next += 1;
        self.columns
            .first()
            .is_some_and(|column| self.next <= column.ends.len())
    }

    fn cell(&self, column: usize) -> &str {
        self.columns[column].cell(self.next - 1)
    }

    fn row(&self) -> u64 {
        self.next as u64 - 1
    }

    fn row_word(&self) -> &'static str {
        "row"
    }

    fn cell_fault(&self, row: u64, column: usize, code: &str, detail: String) -> Fault {
        Fault::new(
            format!("/file/columns/{}/{row}", pointer_token(&self.names[column])),
            code,
            detail,
        )
    }

    fn header_fault(&self, name: Option<&str>, code: &str, detail: String) -> Fault {
        let token = name
            .map(|name| format!("/{}", pointer_token(name)))
            .unwrap_or_default();
        Fault::new(format!("/file/columns{token}"), code, detail)
    }
}

/// Writes one dataset; [`read`] of it gives the same dataset.
///
/// # Errors
/// What the output says.
pub fn write_json(dataset: &Dataset, out: &mut dyn Write) -> io::Result<()> {
    let mut sink = JsonSink::default();
    table::write(dataset, &mut sink)?;
    write!(
        out,
        "{{\"kind\":\"{}\",\"columns\":{{",
        dataset.kind().name()
    )?;
    for (index, (name, cells)) in sink.names.iter().zip(&sink.columns).enumerate() {
        write!(
            out,
            "{}\"{name}\":[{cells}]",
            if index > 0 { "," } else { "" }
        )?;
    }
    out.write_all(b"}")?;
    if let Dataset::Detections(recording) = dataset {
        write!(
            out,
            ",\"sensors\":{}",
            serde_json::to_string(&recording.sensors)?
        )?;
    }
    if let Some(frame) = dataset.frame() {
        write!(out, ",\"frame\":{}", serde_json::to_string(&frame)?)?;
    }
    if dataset.time_base().is_utc() {
        let base = serde_json::to_string(&dataset.time_base())?;
        write!(out, ",\"time_base\":{base}")?;
    }
    out.write_all(b"}\n")
}

/// Collects the text of each column.
#[derive(Default)]
struct JsonSink {
    names: Vec<&'static str>,
    columns: Vec<String>,
    column: usize,
}

impl JsonSink {
    /// The text of the next cell's column, ready for the cell.
    fn next_cell(&mut self) -> &mut String {
        let column = &mut self.columns[self.column];
        self.column += 1;
        if !column.is_empty() {
            column.push(',');
        }
        column
    }
}

impl Sink for JsonSink {
    fn begin(&mut self, columns: &[&'static str]) -> io::Result<()> {
        self.names = columns.to_vec();
        self.columns = vec![String::new(); columns.len()];
        Ok(())
    }

    fn number(&mut self, value: Option<f64>) -> io::Result<()> {
        let cell = self.next_cell();
        match value.filter(|value| value.is_finite()) {
            Some(value) => table::push_number(cell, value),
            None => cell.push_str("null"),
        }
        Ok(())
    }

    fn text(&mut self, value: Option<&str>) -> io::Result<()> {
        let text = serde_json::to_string(&value)?;
        self.next_cell().push_str(&text);
        Ok(())
    }

    fn end_row(&mut self) -> io::Result<()> {
        self.column = 0;
        Ok(())
    }
}
