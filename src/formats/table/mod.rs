//! Datasets as tables of named columns, and the checks on them. CSV and JSON are two spellings of the same table:
//! each only knows how to read rows ([`Rows`]) and write them ([`Sink`]); what the columns mean stands here, once.

mod boxes;
mod codes;
mod degrees;
mod detections;
mod estimate;
mod fault_log;
mod ground;
mod header;
mod interner;
mod live;
mod rejects;
mod repeats;
mod row;
mod tracks;
mod truth;
mod units;

pub use degrees::degrees;
pub use detections::{Layout, named_pose, write_rows};
pub use fault_log::FaultLog;
pub use header::{TIME_BASE, pointer_token};
pub use interner::Interner;
pub use live::follow;
pub use repeats::Repeats;

use super::{ReadOptions, ReadOutcome, Reading, layouts};
use crate::model::dataset::{Dataset, DatasetKind};
use crate::model::fault::Fault;
use crate::model::sensor::SensorSettings;
use std::io;

/// A table being read, row by row. Cells are text; an empty text is an empty cell.
pub trait Rows {
    /// The file's column names.
    fn names(&self) -> &[String];
    /// Goes to the next row that has a cell for every column; reports those that do not. `false` at the end.
    fn advance(&mut self, faults: &mut FaultLog) -> bool;
    fn cell(&self, column: usize) -> &str;
    /// Number of the current row, as [`Rows::row_word`] counts.
    fn row(&self) -> u64;
    /// What a row is called: "line" or "row".
    fn row_word(&self) -> &'static str;
    /// A fault in one cell.
    fn cell_fault(&self, row: u64, column: usize, code: &str, detail: String) -> Fault;
    /// A fault in the header, about one name or about all: in the first line, unless the format has no lines.
    fn header_fault(&self, name: Option<&str>, code: &str, detail: String) -> Fault {
        Fault {
            line: Some(1),
            column: name.map(Into::into),
            ..Fault::new("/file", code, detail)
        }
    }
}

/// A table being read, and what was told of it.
pub struct Table<'a> {
    pub rows: &'a mut dyn Rows,
    pub reading: &'a Reading,
}

/// A table being written, cell by cell in the order of its columns.
pub trait Sink {
    fn begin(&mut self, columns: &[&'static str]) -> io::Result<()>;
    fn number(&mut self, value: Option<f64>) -> io::Result<()>;
    fn text(&mut self, value: Option<&str>) -> io::Result<()>;
    fn end_row(&mut self) -> io::Result<()>;
}

/// Reads a whole table. `sensors` is what the file says about its sensors besides the rows.
///
/// # Errors
/// Every fault found, up to the limit of [`FaultLog`].
pub fn read(
    rows: &mut dyn Rows,
    options: &ReadOptions,
    sensors: Vec<SensorSettings>,
) -> Result<ReadOutcome, Vec<Fault>> {
    if options.columns.is_empty()
        && let Some(layout) = layouts::find(rows.names())
    {
        return layouts::read(rows, layout, options);
    }
    let reading = Reading::of(&options.options)?;
    let (kind, header, mut warnings) = header::resolve(rows, options)?;
    let table = Table {
        rows,
        reading: &reading,
    };
    let (dataset, units) = match kind {
        DatasetKind::Detections => detections::read(table, &header, sensors, &mut warnings)?,
        DatasetKind::Truth => truth::read(table, &header, &mut warnings)?,
        DatasetKind::Tracks => tracks::read(table, &header, &mut warnings)?,
        DatasetKind::BearingTime => return Err(vec![no_table()]),
    };
    warnings.extend(units.rejections());
    if units.total == 0 {
        warnings.push(format!(
            "there are columns of {} but no rows: the dataset is empty",
            kind.name()
        ));
    }
    Ok(ReadOutcome {
        dataset,
        warnings,
        units,
    })
}

fn no_table() -> Fault {
    Fault::new(
        "/meta/kind",
        "unsupported",
        "a bearing-time record is a matrix, not a table of named columns",
    )
    .allowing("csv, npy")
}

/// Writes a whole table.
///
/// # Errors
/// What the sink's output says.
pub fn write(dataset: &Dataset, sink: &mut dyn Sink) -> io::Result<()> {
    match dataset {
        Dataset::Detections(recording) => detections::write(recording, sink),
        Dataset::Truth(truth) => truth::write(truth, sink),
        Dataset::Tracks(set) => tracks::write(set, sink),
        Dataset::TruthBoxes(set) => boxes::write(set, "truth_id", sink),
        Dataset::TrackBoxes(set) => boxes::write(set, "track_id", sink),
        Dataset::BearingTime(_) => Err(io::Error::new(
            io::ErrorKind::Unsupported,
            no_table().detail,
        )),
    }
}

/// A number as the shortest text that reads back as the same number; zero has no sign.
pub fn push_number(text: &mut String, value: f64) {
    use std::fmt::Write;
    let value = value + 0.0;
    let size = value.abs();
    let plain = value == 0.0 || (1e-5..1e16).contains(&size);
    let written = if plain {
        write!(text, "{value}")
    } else {
        write!(text, "{value:e}")
    };
    debug_assert!(written.is_ok(), "a String takes any text");
}
