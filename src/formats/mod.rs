//! Bytes to datasets and back, one file a format. A new format is one file and one line of [`FORMATS`].

pub mod ais;
pub mod asterix;
pub mod autoferry;
mod autoferry_items;
mod autoferry_sensors;
mod bearing_time;
mod clock;
#[cfg(feature = "parquet")]
mod columnar;
pub mod csv;
mod csv_lines;
mod csv_pieces;
mod dialect;
mod disorder;
pub mod feed;
pub mod gpx;
pub mod json;
mod json_document;
mod json_lines;
mod json_records;
mod json_text;
mod layouts;
mod lines;
pub mod live;
mod loose;
pub mod mode_s;
pub mod mot;
mod mot_detections;
pub mod npy;
mod options;
pub mod out;
mod packed;
mod reading;
mod streams;
mod table;
mod told;

pub use self::csv::write_csv;
pub use clock::read_instant;
pub use csv_pieces::DetectionsCsv;
pub use json::write_json;
pub use mot::write_mot;
pub use options::{FormatOptions, OPTION_FIELDS};
pub use out::{WRITERS, WriteError, Writer, writer_named};
pub use reading::{Identity, Reading, SensorSite};
pub use table::{degrees, named_pose};
pub use told::detect_format;

use crate::model::dataset::{Dataset, DatasetKind};
use crate::model::fault::Fault;
pub use crate::model::units::{Reason, Rejected, Units};
use crate::registry::Field;
use std::collections::BTreeMap;
use std::io::BufRead;

/// What the uploader said about a file.
#[derive(Debug, Clone, Default)]
pub struct ReadOptions {
    /// `None`: told from the content.
    pub kind: Option<DatasetKind>,
    /// The file's column name → the canonical one.
    pub columns: BTreeMap<String, String>,
    /// What the format has to be told.
    pub options: FormatOptions,
}

/// A dataset, and what the reader had to say about it.
#[derive(Debug, Clone)]
pub struct ReadOutcome {
    pub dataset: Dataset,
    pub warnings: Vec<String>,
    pub units: Units,
}

impl ReadOutcome {
    /// Of a format that uses every unit or refuses the file.
    fn all_used(dataset: Dataset, warnings: Vec<String>, unit: &str) -> Self {
        let mut counted = Units::called(unit);
        counted.use_up(dataset.row_count() as u64);
        ReadOutcome {
            dataset,
            warnings,
            units: counted,
        }
    }
}

/// A way to read datasets. Faults carry line and column; of more than [`MAX_FAULTS`] the first are kept, and one more
/// says so.
pub struct Format {
    pub name: &'static str,
    pub summary: &'static str,
    pub media_type: &'static str,
    pub kinds: &'static [DatasetKind],
    /// What it has to be told of a file besides its content.
    pub options: &'static [Field],
    pub read: fn(&mut dyn BufRead, &ReadOptions) -> Result<ReadOutcome, Vec<Fault>>,
}

/// A reader stops collecting faults here.
pub const MAX_FAULTS: usize = 100;

/// Columns of a table; more are refused before anything is made of them.
pub const MAX_COLUMNS: usize = 4096;

/// Bytes of the names of a table's columns together: faults and warnings repeat them.
pub const MAX_HEADER_BYTES: usize = 1 << 16;

/// Reads a file that may be packed, in the format that is named, else in the one that its first bytes tell.
///
/// # Errors
/// No format fits, or the file does not; a kind that the format cannot hold.
pub fn read_file(
    file_name: &str,
    input: &mut dyn BufRead,
    format: Option<&'static Format>,
    options: &ReadOptions,
) -> Result<(ReadOutcome, &'static Format), Vec<Fault>> {
    let mut opened = packed::open(input, &options.options)?;
    let format = match format {
        Some(format) => format,
        None => {
            let head = opened
                .fill_buf()
                .map_err(|error| vec![lines::unreadable(&error)])?;
            let name = file_name.trim_end_matches(".gz").trim_end_matches(".zst");
            detect_format(name, head).ok_or_else(|| vec![untold_format()])?
        }
    };
    check_kind(format, options)?;
    Ok(((format.read)(&mut *opened, options)?, format))
}

fn untold_format() -> Fault {
    let known: Vec<&str> = FORMATS.iter().map(|format| format.name).collect();
    let detail = "the format could not be told from the file; say which it is";
    Fault::new("/meta/format", "unknown_value", detail).allowing(known.join(", "))
}

fn check_kind(format: &Format, options: &ReadOptions) -> Result<(), Vec<Fault>> {
    let Some(kind) = options.kind.filter(|kind| !format.kinds.contains(kind)) else {
        return Ok(());
    };
    let (name, kind) = (format.name, kind.name());
    let detail = format!("files in the format '{name}' cannot hold {kind}");
    let allowed: Vec<&str> = format.kinds.iter().map(|kind| kind.name()).collect();
    Err(vec![
        Fault::new("/meta/kind", "unsupported", detail).allowing(allowed.join(", ")),
    ])
}

/// Every format that trackloom reads.
pub const FORMATS: &[Format] = &[
    csv::FORMAT,
    json::FORMAT,
    autoferry::FORMAT,
    mot::FORMAT,
    npy::FORMAT,
    streams::AIS,
    streams::MODE_S,
    streams::GPX,
    streams::ASTERIX,
    #[cfg(feature = "parquet")]
    columnar::PARQUET,
    #[cfg(feature = "parquet")]
    columnar::ARROW,
];

/// The format of that name.
pub fn format_named(name: &str) -> Option<&'static Format> {
    FORMATS.iter().find(|format| format.name == name)
}

/// Kinds of datasets that are tables of named columns.
const TABLES: &[DatasetKind] = &[
    DatasetKind::Detections,
    DatasetKind::Truth,
    DatasetKind::Tracks,
];

/// Faults of a record as those of the file that it was read from.
fn of_file(faults: Vec<Fault>) -> Vec<Fault> {
    faults
        .into_iter()
        .map(|fault| Fault {
            pointer: "/file".to_owned(),
            ..fault
        })
        .collect()
}

/// The fault of renaming columns where there are none.
fn refuse_columns(options: &ReadOptions) -> Result<(), Vec<Fault>> {
    if options.columns.is_empty() {
        return Ok(());
    }
    Err(vec![Fault::new(
        "/meta/columns",
        "unsupported",
        "files of this format have no columns to rename",
    )])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique_and_found() {
        for format in FORMATS {
            assert_eq!(
                format_named(format.name).map(|found| found.summary),
                Some(format.summary)
            );
            assert_eq!(
                FORMATS
                    .iter()
                    .filter(|other| other.name == format.name)
                    .count(),
                1
            );
        }
        assert!(format_named("xml").is_none());
    }

    #[test]
    fn formats_are_told_from_the_first_bytes() {
        let detect =
            |name: &str, bytes: &[u8]| detect_format(name, bytes).map(|format| format.name);
        assert_eq!(detect("a.csv", b"time_s,truth_id"), Some("csv"));
        assert_eq!(detect("a.txt", b"\xef\xbb\xbf\n{\"columns\""), Some("json"));
        assert_eq!(detect("a.csv", b" [{\"sensorID\""), Some("autoferry"));
        assert_eq!(detect("a.json", b"[\n[], [{\"time\""), Some("autoferry"));
        assert_eq!(
            detect("a.json", b"[{\"time\": 1, \"ownshipPosition\""),
            Some("autoferry")
        );
        assert_eq!(
            detect("a.json", b"[{\"time\": 1, \"x_m\": 2}]"),
            Some("json")
        );
        assert_eq!(detect("a.json", b"[1,1,1"), Some("json"));
        assert_eq!(detect("a.txt", b"1\t1\t0\t0\t10\t20"), Some("mot"));
        assert_eq!(detect("A.JSON", b""), Some("json"));
        assert_eq!(
            detect("gt.txt", b"1,1,399,182,121,229,1,-1,-1,-1"),
            Some("mot")
        );
        assert_eq!(detect("a", b""), Some("csv"));
        assert_eq!(detect("a", b"\x93NUMPY\x01\x00"), Some("npy"));
        let built = cfg!(feature = "parquet");
        assert_eq!(detect("a", b"PAR1\x15\x04"), built.then_some("parquet"));
        assert_eq!(detect("a", b"ARROW1\0\0\xff"), built.then_some("arrow"));
        assert_eq!(
            detect("a", b"\xff\xff\xff\xff\x80\x01"),
            built.then_some("arrow")
        );
        assert_eq!(detect("a.csv", b"PK\x03\x04\x00\x00"), None);
    }
}
