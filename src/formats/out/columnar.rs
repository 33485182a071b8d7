//! A dataset as typed columns, for Parquet and Arrow: the canonical table, a number as a double, a name as a dictionary. Times of
//! absolute data are instants (`time`, microseconds, UTC), others seconds (`time_s`); where the data have a frame, latitude and
//! longitude stand beside x and y. What the columns do not say is JSON under the key `trackloom`, and makes the file read as the
//! same dataset.

use super::earth::Earth;
use super::{WriteError, refusal};
use crate::formats::table::{self, Interner, Sink};
use crate::model::dataset::{Dataset, DatasetKind};
use crate::model::space::{Frame, Place};
use crate::model::time::TimeBase;
use arrow_array::{
    ArrayRef, DictionaryArray, Float64Array, Int32Array, RecordBatch, StringArray,
    TimestampMicrosecondArray, UInt32Array,
};
use arrow_schema::{Field, Schema};
use serde::{Deserialize, Serialize};
use std::collections::HashMap;
use std::io;
use std::sync::Arc;

/// The key of what the columns do not say.
pub const METADATA_KEY: &str = "trackloom";

/// What the columns of a file do not say.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Metadata {
    pub kind: DatasetKind,
    pub frame: Option<Frame>,
    pub time_base: TimeBase,
    /// Of this description.
    pub version: u32,
}

/// The dataset as one batch, with its metadata in the schema.
///
/// # Errors
/// A fault of what is no table, and of a time or place that the columns cannot say.
pub fn batch(dataset: &Dataset, format: &str) -> Result<RecordBatch, WriteError> {
    let mut columns = Columns::default();
    match dataset {
        Dataset::BearingTime(_) => return Err(refuse(format)),
        _ => table::write(dataset, &mut columns)?,
    }
    let mut fields = Vec::new();
    let mut arrays: Vec<ArrayRef> = Vec::new();
    let places = columns.places(dataset, format)?;
    for (name, column) in columns.names.iter().zip(columns.columns) {
        let is_instant = *name == "time_s" && dataset.time_base().is_utc();
        let name = if is_instant { "time" } else { *name };
        let array = match column {
            Column::Numbers(values) if is_instant => instants(&values)?,
            Column::Numbers(values) if WHOLE.contains(&name) => whole(&values),
            Column::Numbers(values) => Arc::new(Float64Array::from(values)),
            Column::Names { names, of } => dictionary(names, of)?,
        };
        fields.push(field(name, &array));
        arrays.push(array);
    }
    for (name, values) in places
        .into_iter()
        .flat_map(|(lat, lon)| [("lat_deg", lat), ("lon_deg", lon)])
    {
        let array: ArrayRef = Arc::new(Float64Array::from(values));
        fields.push(field(name, &array));
        arrays.push(array);
    }
    let metadata = Metadata {
        kind: dataset.kind(),
        frame: dataset.frame(),
        time_base: dataset.time_base(),
        version: 1,
    };
    let metadata = serde_json::to_string(&metadata).map_err(io::Error::from)?;
    let metadata = HashMap::from([(METADATA_KEY.to_owned(), metadata)]);
    let schema = Schema::new_with_metadata(fields, metadata);
    Ok(RecordBatch::try_new(Arc::new(schema), arrays).map_err(io::Error::other)?)
}

/// Columns of whole numbers.
const WHOLE: &[&str] = &["scan"];

fn refuse(format: &str) -> WriteError {
    let detail =
        format!("a bearing-time record is a matrix, '{format}' holds tables of named columns");
    refusal("unsupported", detail).allowing("csv").into()
}

fn field(name: &str, array: &ArrayRef) -> Field {
    let is_null = array.null_count() > 0;
    Field::new(name, array.data_type().clone(), is_null || name != "time")
}

fn instants(times_s: &[Option<f64>]) -> Result<ArrayRef, WriteError> {
    // 0.1 microseconds below the end of what 64 bits hold.
    const MOST_S: f64 = 9.2e12;
    let mut micros = Vec::with_capacity(times_s.len());
    for time_s in times_s.iter().copied().flatten() {
        if time_s.abs() > MOST_S {
            let detail = format!("{time_s} s after 1970 is no instant that the format can say");
            return Err(refusal("out_of_range", detail).into());
        }
        micros.push((time_s * 1e6).round() as i64);
    }
    Ok(Arc::new(
        TimestampMicrosecondArray::from(micros).with_timezone("UTC"),
    ))
}

fn whole(values: &[Option<f64>]) -> ArrayRef {
    let values = values.iter().map(|value| value.map(|value| value as u32));
    Arc::new(UInt32Array::from_iter(values))
}

fn dictionary(names: Interner, of: Vec<Option<i32>>) -> Result<ArrayRef, WriteError> {
    let values = StringArray::from(names.into_names());
    let array = DictionaryArray::try_new(Int32Array::from(of), Arc::new(values));
    Ok(Arc::new(array.map_err(io::Error::other)?))
}

/// Collects cells by column.
#[derive(Default)]
struct Columns {
    names: Vec<&'static str>,
    columns: Vec<Column>,
    column: usize,
}

/// The first cell of a column says what it is.
enum Column {
    Numbers(Vec<Option<f64>>),
    Names {
        names: Interner,
        of: Vec<Option<i32>>,
    },
}

impl Columns {
    fn numbers(&self, name: &str) -> Option<&[Option<f64>]> {
        let place = self.names.iter().position(|known| *known == name)?;
        match self.columns.get(place)? {
            Column::Numbers(values) => Some(values),
            Column::Names { .. } => None,
        }
    }

    /// Latitude and longitude of each row, of data with a frame whose table has x and y alone.
    #[expect(clippy::type_complexity, reason = "two columns, used once")]
    fn places(
        &self,
        dataset: &Dataset,
        format: &str,
    ) -> Result<Option<(Vec<Option<f64>>, Vec<Option<f64>>)>, WriteError> {
        let (Some(x), Some(y), None, Some(_)) = (
            self.numbers("x_m"),
            self.numbers("y_m"),
            self.numbers("lat_deg"),
            dataset.frame(),
        ) else {
            return Ok(None);
        };
        let earth = Earth::of(dataset, format)?;
        let z = self.numbers("z_m");
        let (mut lat, mut lon) = (Vec::new(), Vec::new());
        for (row, (x_m, y_m)) in x.iter().zip(y).enumerate() {
            let z_m = z.and_then(|z| z[row]).unwrap_or_default();
            let place = x_m.zip(*y_m).map(|(x_m, y_m)| Place::new(x_m, y_m, z_m));
            let spot = place
                .map(|place| earth.spot(0.0, &place, None))
                .transpose()?;
            lat.push(spot.map(|spot| spot.lat_deg));
            lon.push(spot.map(|spot| spot.lon_deg));
        }
        Ok(Some((lat, lon)))
    }

    fn next(&mut self, empty: fn() -> Column) -> &mut Column {
        if self.columns.len() <= self.column {
            self.columns.push(empty());
        }
        self.column += 1;
        &mut self.columns[self.column - 1]
    }
}

impl Sink for Columns {
    fn begin(&mut self, columns: &[&'static str]) -> io::Result<()> {
        self.names = columns.to_vec();
        Ok(())
    }

    fn number(&mut self, value: Option<f64>) -> io::Result<()> {
        if let Column::Numbers(values) = self.next(|| Column::Numbers(Vec::new())) {
            values.push(value);
        }
        Ok(())
    }

    fn text(&mut self, value: Option<&str>) -> io::Result<()> {
        let empty = || Column::Names {
            names: Interner::default(),
            of: Vec::new(),
        };
        if let Column::Names { names, of } = self.next(empty) {
            of.push(value.map(|value| names.number(value) as i32));
        }
        Ok(())
    }

    fn end_row(&mut self) -> io::Result<()> {
        self.column = 0;
        Ok(())
    }
}
