//! Datasets as files that other programs open. A new one is one file and one line of [`WRITERS`].
//!
//! Formats with places need a frame; formats with instants count relative times from 1970-01-01T00:00:00Z, and say so.

mod asterix;
#[cfg(feature = "parquet")]
pub(super) mod columnar;
mod czml;
mod earth;
mod geojson;
mod gpx;
mod kml;
#[cfg(not(feature = "parquet"))]
#[path = "no_parquet.rs"]
mod parquet;
#[cfg(feature = "parquet")]
mod parquet;
mod paths;
mod seen;
mod stonesoup;
mod text;

use super::{csv, json, mot};
use crate::model::dataset::{Dataset, DatasetKind};
use crate::model::fault::Fault;
use std::io::{self, Write};

/// A way to write datasets.
pub struct Writer {
    pub name: &'static str,
    pub media_type: &'static str,
    /// Of a file's name, without the dot.
    pub extension: &'static str,
    pub summary: &'static str,
    pub kinds: &'static [DatasetKind],
    /// The feature that a build needs for it.
    pub feature: Option<&'static str>,
    pub write: fn(&Dataset, &mut dyn Write) -> Result<(), WriteError>,
}

/// Why nothing, or not all, was written.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// The dataset lacks what the format needs, or has what it cannot say.
    #[error("{}", .0.first().map_or("", |fault| fault.detail.as_str()))]
    Faults(Vec<Fault>),
    #[error(transparent)]
    Output(#[from] io::Error),
}

impl From<Box<Fault>> for WriteError {
    fn from(fault: Box<Fault>) -> Self {
        WriteError::Faults(vec![*fault])
    }
}

impl From<Fault> for WriteError {
    fn from(fault: Fault) -> Self {
        WriteError::Faults(vec![fault])
    }
}

const TABLES: &[DatasetKind] = super::TABLES;
const PATHS: &[DatasetKind] = &[DatasetKind::Truth, DatasetKind::Tracks];

/// Every format that trackloom writes.
pub const WRITERS: &[Writer] = &[
    Writer {
        name: "csv",
        media_type: "text/csv",
        extension: "csv",
        summary: "Canonical CSV, which trackloom reads; or a bearing-time record as a matrix",
        kinds: &DatasetKind::ALL,
        feature: None,
        write: |dataset, out| Ok(csv::write_csv(dataset, out)?),
    },
    Writer {
        name: "json",
        media_type: "application/json",
        extension: "json",
        summary: "Canonical JSON, which trackloom reads: columns as arrays",
        kinds: TABLES,
        feature: None,
        write: |dataset, out| Ok(json::write_json(dataset, out)?),
    },
    geojson::WRITER,
    geojson::TRIPS,
    kml::WRITER,
    czml::WRITER,
    gpx::WRITER,
    asterix::WRITER,
    Writer {
        name: "mot",
        media_type: "text/plain",
        extension: "txt",
        summary: "MOTChallenge text: boxes of truth or tracks in the frames of a video",
        kinds: PATHS,
        feature: None,
        write: write_boxes,
    },
    parquet::PARQUET,
    parquet::ARROW,
    stonesoup::WRITER,
    stonesoup::POLAR,
    stonesoup::BEARINGS,
];

/// The writer of that name.
pub fn writer_named(name: &str) -> Option<&'static Writer> {
    WRITERS.iter().find(|writer| writer.name == name)
}

impl Writer {
    /// Writes the dataset.
    ///
    /// # Errors
    /// A fault where the format cannot hold the dataset, with the formats that can; what the output says.
    pub fn put(&self, dataset: &Dataset, out: &mut dyn Write) -> Result<(), WriteError> {
        if !self.kinds.contains(&dataset.kind()) {
            let kind = dataset.kind().name();
            let detail = format!("files in the format '{}' cannot hold {kind}", self.name);
            return Err(refusal("unsupported", detail)
                .allowing(names_for(dataset.kind()))
                .into());
        }
        (self.write)(dataset, out)
    }
}

/// Names of the writers of a kind, as people list them.
pub fn names_for(kind: DatasetKind) -> String {
    let names = WRITERS
        .iter()
        .filter(|writer| writer.kinds.contains(&kind))
        .map(|writer| writer.name);
    names.collect::<Vec<_>>().join(", ")
}

/// A fault of the choice of the format.
fn refusal(code: &str, detail: impl Into<String>) -> Fault {
    Fault::new("/format", code, detail)
}

/// The fault of boxes where places are wanted.
fn no_places(format: &str) -> Fault {
    let detail =
        format!("the dataset has boxes in a picture or directions, '{format}' holds places");
    refusal("unsupported", detail).allowing("csv, json, mot")
}

fn write_boxes(dataset: &Dataset, out: &mut dyn Write) -> Result<(), WriteError> {
    match dataset {
        Dataset::TruthBoxes(set) | Dataset::TrackBoxes(set) => Ok(mot::write_mot(set, out)?),
        other => {
            let detail = "the dataset has places, 'mot' holds boxes in the frames of a video";
            Err(refusal("unsupported", detail)
                .allowing(names_for(other.kind()))
                .into())
        }
    }
}

/// What files say of times that count from nothing in particular.
const RELATIVE_TIMES: &str =
    "The times of the data are relative: here they count from 1970-01-01T00:00:00Z.";
