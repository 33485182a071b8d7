//! Parquet and Arrow in a build that has neither: they are listed, and say what to build.

use super::{TABLES, WriteError, Writer, refusal};
use crate::model::dataset::Dataset;
use std::io::Write;

pub const PARQUET: Writer = Writer {
    name: "parquet",
    media_type: "application/vnd.apache.parquet",
    extension: "parquet",
    summary: "Parquet, which this build does not write: it lacks the feature parquet",
    kinds: TABLES,
    feature: Some("parquet"),
    write: refuse,
};

pub const ARROW: Writer = Writer {
    name: "arrow",
    media_type: "application/vnd.apache.arrow.file",
    extension: "arrow",
    summary: "Arrow IPC file, which this build does not write: it lacks the feature parquet",
    kinds: TABLES,
    feature: Some("parquet"),
    write: refuse,
};

fn refuse(_: &Dataset, _: &mut dyn Write) -> Result<(), WriteError> {
    let detail =
        "this program is built without the feature parquet (cargo build --features parquet)";
    Err(refusal("unsupported", detail).into())
}
