//! Bytes to datasets and back, one file a format. A new format is one file and one line of [`FORMATS`].

use crate::model::dataset::{Dataset, DatasetKind};
use crate::model::fault::Fault;
use std::collections::BTreeMap;
use std::io::BufRead;

/// What the uploader said about a file.
#[derive(Debug, Clone, Default)]
pub struct ReadOptions {
    /// `None`: told from the content.
    pub kind: Option<DatasetKind>,
    /// The file's column name → the canonical one.
    pub columns: BTreeMap<String, String>,
}

/// A dataset, and what the reader had to say about it.
#[derive(Debug, Clone)]
pub struct ReadOutcome {
    pub dataset: Dataset,
    pub warnings: Vec<String>,
}

/// A way to read datasets. Faults carry line and column; at most [`MAX_FAULTS`] are kept.
pub struct Format {
    pub name: &'static str,
    pub summary: &'static str,
    pub media_type: &'static str,
    pub kinds: &'static [DatasetKind],
    pub read: fn(&mut dyn BufRead, &ReadOptions) -> Result<ReadOutcome, Vec<Fault>>,
}

/// A reader stops collecting faults here.
pub const MAX_FAULTS: usize = 100;

/// Every format that trackloom reads.
pub const FORMATS: &[Format] = &[];
