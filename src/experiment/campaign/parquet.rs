//! `runs.parquet`: the table of `runs.csv`, column by column and with its types, for programs that read many runs.

use super::outcomes::Rows;
use crate::experiment::job::Artifact;
use parquet::basic::{LogicalType, Repetition, Type as Physical};
use parquet::data_type::{ByteArray, ByteArrayType, DataType, DoubleType, Int64Type};
use parquet::errors::Result;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::types::{Type, TypePtr};
use std::io::Error;
use std::sync::Arc;

/// A row a cell and run: the cell as text, run and seed as whole numbers, then a column an outcome, null where a run has no
/// such number. `cells` are the names, `rows` stand in their order, `names` are those of the outcomes.
pub(super) fn runs(
    cells: &[&str],
    names: &[&str],
    rows: &[Rows],
    seed: u32,
) -> std::result::Result<Artifact, Error> {
    let bytes = write_table(cells, names, rows, seed).map_err(Error::other)?;
    Ok(Artifact::file(
        "runs.parquet",
        "application/vnd.apache.parquet",
        bytes,
    ))
}

fn write_table(cells: &[&str], names: &[&str], rows: &[Rows], seed: u32) -> Result<Vec<u8>> {
    let mut file = SerializedFileWriter::new(
        Vec::new(),
        schema(names)?,
        Arc::new(WriterProperties::default()),
    )?;
    let mut group = file.next_row_group()?;
    let counts: Vec<usize> = rows
        .iter()
        .map(|columns| columns.first().map_or(0, Vec::len))
        .collect();
    let of_cells = cells
        .iter()
        .zip(&counts)
        .flat_map(|(name, &count)| std::iter::repeat_n(ByteArray::from(*name), count));
    add::<ByteArrayType>(&mut group, &of_cells.collect::<Vec<_>>(), None)?;
    let numbers = counts.iter().flat_map(|&count| 0..count as i64);
    add::<Int64Type>(&mut group, &numbers.collect::<Vec<_>>(), None)?;
    add::<Int64Type>(
        &mut group,
        &vec![i64::from(seed); counts.iter().sum()],
        None,
    )?;
    for outcome in 0..names.len() {
        let values: Vec<Option<f64>> = rows
            .iter()
            .filter_map(|columns| columns.get(outcome))
            .flatten()
            .copied()
            .collect();
        let is_there: Vec<i16> = values
            .iter()
            .map(|value| i16::from(value.is_some()))
            .collect();
        add::<DoubleType>(
            &mut group,
            &values.into_iter().flatten().collect::<Vec<_>>(),
            Some(&is_there),
        )?;
    }
    group.close()?;
    file.into_inner()
}

fn schema(names: &[&str]) -> Result<TypePtr> {
    let column = |name: &str, physical, repetition, logical| {
        Type::primitive_type_builder(name, physical)
            .with_repetition(repetition)
            .with_logical_type(logical)
            .build()
            .map(Arc::new)
    };
    let mut columns = vec![
        column(
            "cell",
            Physical::BYTE_ARRAY,
            Repetition::REQUIRED,
            Some(LogicalType::String),
        )?,
        column("run", Physical::INT64, Repetition::REQUIRED, None)?,
        column("seed", Physical::INT64, Repetition::REQUIRED, None)?,
    ];
    for name in names {
        columns.push(column(name, Physical::DOUBLE, Repetition::OPTIONAL, None)?);
    }
    Type::group_type_builder("runs")
        .with_fields(columns)
        .build()
        .map(Arc::new)
}

/// Writes the next column; `is_there` is 1 for a row that has a value and 0 for one that has none.
fn add<T: DataType>(
    group: &mut SerializedRowGroupWriter<Vec<u8>>,
    values: &[T::T],
    is_there: Option<&[i16]>,
) -> Result<()> {
    let Some(mut column) = group.next_column()? else {
        return Ok(());
    };
    column.typed::<T>().write_batch(values, is_there, None)?;
    column.close()
}
