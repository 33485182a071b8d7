//! Parquet and Arrow IPC of the columns of [`super::columnar`].
//!
//! Parquet: snappy, row groups of 131 072 rows, dictionaries kept. Arrow: the file format (Feather 2), one batch a row group.

use super::columnar::{METADATA_KEY, batch};
use super::{TABLES, WriteError, Writer};
use crate::model::dataset::Dataset;
use arrow_array::RecordBatch;
use arrow_ipc::writer::FileWriter;
use parquet::arrow::ArrowWriter;
use parquet::basic::Compression;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use std::io::{self, Write};

pub const PARQUET: Writer = Writer {
    name: "parquet",
    media_type: "application/vnd.apache.parquet",
    extension: "parquet",
    summary: "Parquet: typed columns, for pandas, Polars, DuckDB and Spark; trackloom reads it",
    kinds: TABLES,
    feature: Some("parquet"),
    write: write_parquet,
};

pub const ARROW: Writer = Writer {
    name: "arrow",
    media_type: "application/vnd.apache.arrow.file",
    extension: "arrow",
    summary: "Arrow IPC file (Feather 2): the columns of Parquet, as they lie in memory; trackloom reads it",
    kinds: TABLES,
    feature: Some("parquet"),
    write: write_arrow,
};

const GROUP_ROWS: usize = 1 << 17;

fn write_parquet(dataset: &Dataset, out: &mut dyn Write) -> Result<(), WriteError> {
    let batch = batch(dataset, PARQUET.name)?;
    let metadata = batch.schema().metadata().get(METADATA_KEY).cloned();
    let properties = WriterProperties::builder()
        .set_compression(Compression::SNAPPY)
        .set_max_row_group_row_count(Some(GROUP_ROWS))
        .set_key_value_metadata(Some(vec![KeyValue::new(METADATA_KEY.to_owned(), metadata)]))
        .build();
    // The writer of the crate wants to be sent between threads, which `out` may not be: it writes groups into memory.
    let mut writer = ArrowWriter::try_new(Vec::new(), batch.schema(), Some(properties))
        .map_err(io::Error::other)?;
    for part in parts(&batch) {
        writer.write(&part).map_err(io::Error::other)?;
        out.write_all(&std::mem::take(writer.inner_mut()))?;
    }
    let rest = writer.into_inner().map_err(io::Error::other)?;
    out.write_all(&rest)?;
    Ok(())
}

fn write_arrow(dataset: &Dataset, out: &mut dyn Write) -> Result<(), WriteError> {
    let batch = batch(dataset, ARROW.name)?;
    let mut writer = FileWriter::try_new(out, &batch.schema()).map_err(io::Error::other)?;
    for part in parts(&batch) {
        writer.write(&part).map_err(io::Error::other)?;
    }
    writer.finish().map_err(io::Error::other)?;
    Ok(())
}

fn parts(batch: &RecordBatch) -> impl Iterator<Item = RecordBatch> {
    let firsts = (0..batch.num_rows()).step_by(GROUP_ROWS);
    firsts.map(|first| batch.slice(first, GROUP_ROWS.min(batch.num_rows() - first)))
}
