//! Reading and writing datasets through the public doors of `formats`: exact faults, exact values, round trips.

mod autoferry;
mod bearing_time;
mod bearings;
#[cfg(feature = "parquet")]
mod columnar;
mod csv_faults;
mod csv_values;
mod cures;
mod hostile;
mod json;
mod mot;
mod outputs;
#[cfg(feature = "parquet")]
pub mod packed_columns;
mod poses;
mod round_trip;
mod scans_from_times;
mod volumes;

use trackloom_domain::formats::{MAX_FAULTS, ReadOptions, ReadOutcome, format_named};
use trackloom_domain::model::dataset::{Dataset, DatasetKind};
use trackloom_domain::model::fault::Fault;
use trackloom_domain::model::scan::Recording;
use trackloom_domain::model::track::TrackSet;
use trackloom_domain::model::truth::TruthSet;

pub fn read_with(
    format: &str,
    bytes: impl AsRef<[u8]>,
    options: &ReadOptions,
) -> Result<ReadOutcome, Vec<Fault>> {
    let format = format_named(format).expect("the format is known");
    (format.read)(&mut bytes.as_ref(), options)
}

fn read(format: &str, bytes: impl AsRef<[u8]>) -> Result<ReadOutcome, Vec<Fault>> {
    read_with(format, bytes, &ReadOptions::default())
}

pub fn of_kind(kind: DatasetKind) -> ReadOptions {
    ReadOptions {
        kind: Some(kind),
        ..Default::default()
    }
}

fn recording(outcome: ReadOutcome) -> Recording {
    match outcome.dataset {
        Dataset::Detections(recording) => recording,
        other => panic!("expected detections, found {}", other.kind().name()),
    }
}

fn truth(outcome: ReadOutcome) -> TruthSet {
    match outcome.dataset {
        Dataset::Truth(truth) => truth,
        other => panic!("expected truth, found {}", other.kind().name()),
    }
}

fn tracks(outcome: ReadOutcome) -> TrackSet {
    match outcome.dataset {
        Dataset::Tracks(set) => set,
        other => panic!("expected tracks, found {}", other.kind().name()),
    }
}

/// A fault in one cell of a file.
fn at(line: u64, column: &str, code: &str, detail: &str) -> Fault {
    Fault::new("/file", code, detail).at(line, column)
}

/// The only fault of a file.
fn fault(format: &str, bytes: impl AsRef<[u8]>) -> Fault {
    let faults = read(format, bytes).expect_err("the file is broken");
    assert_eq!(faults.len(), 1, "{faults:#?}");
    faults[0].clone()
}
