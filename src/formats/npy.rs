//! NumPy arrays (`.npy`): a bearing-time record without its axes, one row a time. Versions 1 to 3; floats of four and eight
//! bytes and whole numbers of two and four, in both orders of bytes; row by row (C) or column by column (Fortran).
//!
//! # Reference
//! NumPy, "The .npy format", numpy.lib.format.

use super::{Format, ReadOptions, ReadOutcome, of_file, refuse_columns};
use crate::model::bearing_time::{BearingTimeParts, BearingTimeRecord, MAX_CELLS};
use crate::model::dataset::{Dataset, DatasetKind};
use crate::model::fault::Fault;
use crate::registry::{Kind, Object, above, default, number, optional, required};
use serde::{Deserialize, Serialize};
use std::io::{BufRead, Read};

pub const FORMAT: Format = Format {
    name: "npy",
    summary: "A NumPy array of levels in dB, one row a time, one column a bearing; its axes are told beside it",
    media_type: "application/octet-stream",
    kinds: &[DatasetKind::BearingTime],
    options: &[optional(
        "bearing_time",
        "The axes of a bearing-time record in a file that does not have them, such as a NumPy array.",
        Kind::Object(&AXES),
    )],
    read,
};

/// What every such file begins with.
pub(super) const MAGIC: &[u8] = b"\x93NUMPY";
/// Longer headers are no description of a matrix.
const LONGEST_HEADER: usize = 65_536;

/// The axes of a record whose file does not have them.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct BearingTimeAxes {
    pub first_time_s: f64,
    pub time_step_s: f64,
    pub first_bearing_deg: f64,
    pub bearing_step_deg: f64,
}

const TIME: Kind = number(-1e12, 1e12, "s");
const BEARING: Kind = number(-360.0, 360.0, "deg");

/// [`BearingTimeAxes`] in a request.
pub static AXES: Object = Object {
    name: "BearingTimeAxes",
    summary: "The axes of a bearing-time record whose file does not have them.",
    fields: &[
        default("first_time_s", "Time of the first row.", TIME, "0.0"),
        required("time_step_s", "Time from row to row.", above(0.0, 1e6, "s")),
        required("first_bearing_deg", "Centre of the first column.", BEARING),
        required(
            "bearing_step_deg",
            "From the centre of a column to that of the next.",
            above(0.0, 180.0, "deg"),
        ),
    ],
};

#[derive(Debug, Clone, Copy, PartialEq)]
enum Number {
    Float4,
    Float8,
    Whole2,
    Whole4,
}

/// What the header says.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Layout {
    number: Number,
    is_big_endian: bool,
    is_fortran: bool,
    rows: usize,
    columns: usize,
}

/// Reads one record.
///
/// # Errors
/// Every fault of the header and of the values.
pub fn read(input: &mut dyn BufRead, options: &ReadOptions) -> Result<ReadOutcome, Vec<Fault>> {
    refuse_columns(options)?;
    let header = read_header(input).map_err(|fault| vec![fault])?;
    let layout = Layout::of(&header)?;
    let Some(axes) = options.options.get::<BearingTimeAxes>("bearing_time") else {
        let detail = "an array has no axes: 'bearing_time' must tell them";
        let allowed = "first_time_s, time_step_s, first_bearing_deg, bearing_step_deg";
        return Err(vec![
            Fault::new("/meta/bearing_time", "missing", detail).allowing(allowed),
        ]);
    };
    let cells = layout.cells().map_err(|fault| vec![fault])?;
    let levels_db = layout.levels(input, cells).map_err(|fault| vec![fault])?;
    let bearing_deg =
        |column: usize| axes.first_bearing_deg + column as f64 * axes.bearing_step_deg;
    let parts = BearingTimeParts {
        times_s: (0..layout.rows)
            .map(|row| axes.first_time_s + row as f64 * axes.time_step_s)
            .collect(),
        bearings_rad: (0..layout.columns)
            .map(|column| bearing_deg(column).to_radians())
            .collect(),
        levels_db,
    };
    let record = BearingTimeRecord::new(parts).map_err(of_file)?;
    Ok(ReadOutcome::all_used(
        Dataset::BearingTime(record),
        Vec::new(),
        "row",
    ))
}

fn malformed(detail: impl Into<String>) -> Fault {
    Fault::new("/file", "malformed", detail)
}

/// The text that describes the array. The length of it has two bytes in version 1 and four later.
fn read_header(input: &mut dyn BufRead) -> Result<String, Fault> {
    let mut take = |count: usize| {
        let mut bytes = vec![0; count];
        input
            .read_exact(&mut bytes)
            .map_err(|_| malformed("the file ends before its header does"))
            .map(|()| bytes)
    };
    if take(MAGIC.len())? != MAGIC {
        return Err(
            malformed("the file is no NumPy array").allowing("a file written by numpy.save")
        );
    }
    let length = match take(2)?[0] {
        1 => take(2)?
            .iter()
            .rev()
            .fold(0, |sum, &byte| sum << 8 | usize::from(byte)),
        2 | 3 => take(4)?
            .iter()
            .rev()
            .fold(0, |sum, &byte| sum << 8 | usize::from(byte)),
        version => {
            let fault = Fault::new(
                "/file",
                "unsupported",
                format!("version {version} of the format is not known"),
            );
            return Err(fault.allowing("1, 2, 3"));
        }
    };
    if length > LONGEST_HEADER {
        return Err(malformed(format!("the header has {length} bytes"))
            .allowing(format!("<= {LONGEST_HEADER}")));
    }
    String::from_utf8(take(length)?).map_err(|_| malformed("the header is no text"))
}

/// What follows `'name':` in the header.
fn value_of<'a>(header: &'a str, name: &str) -> Option<&'a str> {
    let quoted = [format!("'{name}'"), format!("\"{name}\"")];
    let after = quoted
        .iter()
        .find_map(|name| header.split_once(name.as_str()))?
        .1;
    after.trim_start().strip_prefix(':').map(str::trim_start)
}

impl Layout {
    fn of(header: &str) -> Result<Layout, Vec<Fault>> {
        let mut faults = Vec::new();
        let text = value_of(header, "descr").and_then(|text| {
            text.trim_start_matches(['\'', '"'])
                .split(['\'', '"', ','])
                .next()
        });
        let text = text.unwrap_or_default();
        let number = match text.trim_start_matches(['<', '>', '=', '|']) {
            "f4" => Some(Number::Float4),
            "f8" => Some(Number::Float8),
            "i2" => Some(Number::Whole2),
            "i4" => Some(Number::Whole4),
            _ => None,
        };
        if number.is_none() {
            let fault = Fault::new(
                "/file",
                "unsupported",
                format!("values of the type '{text}' cannot be levels"),
            );
            faults.push(fault.allowing("f4, f8, i2, i4"));
        }
        let order = value_of(header, "fortran_order").unwrap_or_default();
        if !order.starts_with("True") && !order.starts_with("False") {
            faults.push(malformed(
                "the header does not say the order of the values: fortran_order",
            ));
        }
        let shape = value_of(header, "shape").and_then(shape_of);
        if shape.is_none() {
            faults.push(
                malformed("the array is no matrix").allowing("two dimensions: times, bearings"),
            );
        }
        match (number, shape) {
            (Some(number), Some([rows, columns])) if faults.is_empty() => Ok(Layout {
                number,
                is_big_endian: text.starts_with('>'),
                is_fortran: order.starts_with("True"),
                rows,
                columns,
            }),
            _ => Err(faults),
        }
    }

    /// How many values there are. Axes that no record can have are refused before anything is made of them: the header is
    /// a claim that a few bytes can make.
    fn cells(&self) -> Result<usize, Fault> {
        let Layout { rows, columns, .. } = *self;
        if rows < 1 || columns < 2 {
            let detail = format!("the array has {rows} rows and {columns} columns");
            return Err(Fault::new("/file", "out_of_range", detail)
                .allowing("at least 1 time and 2 bearings"));
        }
        rows.checked_mul(columns)
            .filter(|&cells| cells <= MAX_CELLS)
            .ok_or_else(|| {
                let detail = format!("the record has {rows} x {columns} cells");
                Fault::new("/file", "too_large", detail).allowing(format!("<= {MAX_CELLS} cells"))
            })
    }

    /// The values, in the order of rows.
    fn levels(&self, input: &mut dyn BufRead, cells: usize) -> Result<Vec<f32>, Fault> {
        let size = match self.number {
            Number::Whole2 => 2,
            Number::Float4 | Number::Whole4 => 4,
            Number::Float8 => 8,
        };
        let mut bytes = Vec::new();
        let wanted = (cells * size) as u64;
        input
            .take(wanted + 1)
            .read_to_end(&mut bytes)
            .map_err(|error| malformed(error.to_string()))?;
        if bytes.len() as u64 != wanted {
            let found = if bytes.len() as u64 > wanted {
                "more".to_owned()
            } else {
                bytes.len().to_string()
            };
            let detail = format!(
                "{} x {} values need {wanted} bytes; there are {found}",
                self.rows, self.columns
            );
            return Err(malformed(detail));
        }
        let mut levels_db = vec![0.0; cells];
        for (index, value) in bytes.chunks_exact(size).enumerate() {
            let (row, column) = if self.is_fortran {
                (index % self.rows, index / self.rows)
            } else {
                (index / self.columns, index % self.columns)
            };
            let level_db = self.level(value);
            if !level_db.is_finite() {
                let detail =
                    format!("the level at row {row}, column {column} is not a finite number");
                return Err(
                    Fault::new("/file", "not_finite", detail).allowing("finite levels in dB")
                );
            }
            levels_db[row * self.columns + column] = level_db;
        }
        Ok(levels_db)
    }

    fn level(&self, value: &[u8]) -> f32 {
        let mut bytes = [0; 8];
        let bytes = &mut bytes[..value.len()];
        bytes.copy_from_slice(value);
        if self.is_big_endian {
            bytes.reverse();
        }
        let whole = bytes
            .iter()
            .rev()
            .fold(0u64, |sum, &byte| sum << 8 | u64::from(byte));
        match self.number {
            Number::Float4 => f32::from_bits(whole as u32),
            Number::Float8 => f64::from_bits(whole) as f32,
            Number::Whole2 => f32::from(whole as u16 as i16),
            Number::Whole4 => whole as u32 as i32 as f32,
        }
    }
}

/// `(3, 4)` as numbers.
fn shape_of(text: &str) -> Option<[usize; 2]> {
    let inside = text.strip_prefix('(')?.split_once(')')?.0;
    let numbers: Option<Vec<usize>> = inside
        .split(',')
        .map(str::trim)
        .filter(|part| !part.is_empty())
        .map(|part| part.parse().ok())
        .collect();
    numbers?.try_into().ok()
}
