//! Bearing-time records as a matrix in CSV: the header is `time_s` and the bearings of the cells in degrees, each row a time
//! and its levels in dB.

use super::ReadOutcome;
use super::table::{self, FaultLog, Rows};
use crate::model::bearing_time::{BearingTimeParts, BearingTimeRecord, MAX_CELLS};
use crate::model::dataset::Dataset;
use crate::model::fault::Fault;
use std::io::{self, Write};

const TIME: &str = "time_s";

/// Whether a header is that of a matrix, upright or lying on its side.
pub(super) fn is_matrix(names: &[String]) -> bool {
    let Some((first, others)) = names.split_first() else {
        return false;
    };
    (first == TIME || first == "bearing_deg")
        && !others.is_empty()
        && others.iter().all(|name| name.parse::<f64>().is_ok())
}

/// Reads the rows under a header.
///
/// # Errors
/// Every fault with line and column: axes that do not rise, ragged rows, values that are not finite numbers.
pub(super) fn read(rows: &mut dyn Rows) -> Result<ReadOutcome, Vec<Fault>> {
    let mut faults = FaultLog::default();
    let bearings_rad = read_bearings(rows, &mut faults);
    let mut parts = BearingTimeParts {
        bearings_rad,
        ..Default::default()
    };
    if !faults.is_full() {
        read_rows(rows, &mut parts, &mut faults);
    }
    faults.finish()?;
    let record = BearingTimeRecord::new(parts).map_err(super::of_file)?;
    Ok(ReadOutcome::all_used(
        Dataset::BearingTime(record),
        Vec::new(),
        "row",
    ))
}

/// The header.
fn read_bearings(rows: &dyn Rows, faults: &mut FaultLog) -> Vec<f64> {
    let names = rows.names();
    let first = names.first().map(String::as_str);
    if first == Some("bearing_deg") {
        let detail =
            "the matrix lies on its side: its header names times, its rows begin with bearings";
        faults.push(
            rows.header_fault(first, "malformed", detail.to_owned())
                .allowing("one row a time, one column a bearing"),
        );
    } else if first != Some(TIME) {
        let detail = "the first column of a bearing-time record is the time";
        faults.push(
            rows.header_fault(first, "missing", detail.to_owned())
                .allowing(TIME),
        );
    }
    let mut bearings_rad: Vec<f64> = Vec::with_capacity(names.len());
    for name in names.iter().skip(1) {
        let bearing_rad = name
            .parse::<f64>()
            .ok()
            .filter(|degrees| degrees.is_finite())
            .map(f64::to_radians);
        let mut refuse = |code: &str, detail: String, allowed: &str| {
            faults.push(
                rows.header_fault(Some(name), code, detail)
                    .allowing(allowed),
            );
        };
        match (bearing_rad, bearings_rad.last()) {
            (None, _) => refuse(
                "wrong_type",
                format!("'{name}' is not a bearing"),
                "a finite number of degrees",
            ),
            (Some(bearing_rad), Some(&last)) if bearing_rad <= last => {
                refuse(
                    "unsorted",
                    format!("the bearing {name} is not above the one before it"),
                    "bearings that rise",
                );
            }
            _ => {}
        }
        bearings_rad.extend(bearing_rad);
    }
    bearings_rad
}

fn read_rows(rows: &mut dyn Rows, parts: &mut BearingTimeParts, faults: &mut FaultLog) {
    let width = rows.names().len() - 1;
    while rows.advance(faults) {
        let line = rows.row();
        match number(rows, 0, "a finite number of seconds") {
            Err(fault) => faults.push(fault),
            Ok(time_s) if parts.times_s.last().is_some_and(|&last| time_s <= last) => {
                let detail = format!("the time {time_s} is not above the one before it");
                faults.push(
                    rows.cell_fault(line, 0, "unsorted", detail)
                        .allowing("times that rise"),
                );
            }
            Ok(time_s) => parts.times_s.push(time_s),
        }
        for column in 1..=width {
            match number(rows, column, "a finite level in dB") {
                Ok(level_db) => parts.levels_db.push(level_db as f32),
                Err(fault) => faults.push(fault),
            }
        }
        if parts.levels_db.len() > MAX_CELLS {
            let detail = format!("the record has more than {MAX_CELLS} cells");
            faults.push(
                rows.cell_fault(line, 0, "too_large", detail)
                    .allowing(format!("<= {MAX_CELLS} cells")),
            );
            return;
        }
    }
}

/// A cell as a number that a level can be, too.
fn number(rows: &dyn Rows, column: usize, allowed: &str) -> Result<f64, Fault> {
    let text = rows.cell(column).trim();
    let value: f64 = text.parse().map_err(|_| {
        let fault = rows.cell_fault(
            rows.row(),
            column,
            "wrong_type",
            format!("'{text}' is not a number"),
        );
        fault.allowing(allowed)
    })?;
    if (value as f32).is_finite() {
        return Ok(value);
    }
    Err(rows
        .cell_fault(
            rows.row(),
            column,
            "not_finite",
            format!("'{text}' is not a finite number"),
        )
        .allowing(allowed))
}

/// Writes a record as [`read`] reads it.
///
/// # Errors
/// What the output says.
pub(super) fn write(record: &BearingTimeRecord, out: &mut dyn Write) -> io::Result<()> {
    let mut line = TIME.to_owned();
    for &bearing_rad in &record.bearings_rad {
        line.push(',');
        table::push_number(&mut line, table::degrees(bearing_rad));
    }
    for (index, &time_s) in record.times_s.iter().enumerate() {
        line.push('\n');
        out.write_all(line.as_bytes())?;
        line.clear();
        table::push_number(&mut line, time_s);
        for level_db in record.row(index) {
            line.push_str(&format!(",{level_db}"));
        }
    }
    line.push('\n');
    out.write_all(line.as_bytes())
}
