//! The document of canonical JSON, read as it comes: columns as one text each, and what is too many only counted.

use super::MAX_COLUMNS;
use super::json_text::{FieldNames, READABLE, parse};
use super::loose::{own_seed, read_by, visit_scalars, visit_texts};
use super::table;
use crate::model::dataset::DatasetKind;
use crate::model::fault::Fault;
use crate::model::sensor::SensorSettings;
use serde::Deserialize;
use serde::de::value::MapAccessDeserializer;
use serde::de::{Error, IgnoredAny, MapAccess, SeqAccess, Visitor};
use std::fmt::{self, Write as _};
use std::io::BufRead;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Document {
    pub kind: Option<DatasetKind>,
    pub columns: Columns,
    #[serde(default)]
    pub sensors: Sensors,
}

/// Sensors that a file may describe.
pub(super) const MAX_SENSORS: usize = 4096;

/// The first sensors, and how many there are.
#[derive(Default)]
pub(super) struct Sensors {
    pub described: Vec<SensorSettings>,
    pub count: usize,
}

/// The document, which is no array.
pub(super) fn document(input: &mut dyn BufRead) -> Result<Document, Vec<Fault>> {
    let mut array = None;
    let read = parse(input, DocumentSeed(&mut array));
    match array {
        Some(fault) => Err(vec![fault]),
        None => read,
    }
}

/// Reads the document; of an array it tells the fault, and reads no further than the first item.
struct DocumentSeed<'a>(&'a mut Option<Fault>);

own_seed!(DocumentSeed<'_> => Document);

impl<'de> Visitor<'de> for DocumentSeed<'_> {
    type Value = Document;

    fn expecting(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        formatter.write_str("an object of columns")
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Document, A::Error> {
        Document::deserialize(MapAccessDeserializer::new(map))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<Document, A::Error> {
        let array = Fault::new("/file", "wrong_type", "the file is an array").allowing(READABLE);
        let first: Option<Option<Fault>> = items.next_element_seed(FirstItem)?;
        *self.0 = Some(first.flatten().unwrap_or(array));
        Err(A::Error::custom("an array"))
    }
}

/// The first item of an array: a fault where it is a record.
struct FirstItem;

own_seed!(FirstItem => Option<Fault>);

impl<'de> Visitor<'de> for FirstItem {
    type Value = Option<Fault>;

    fn expecting(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        formatter.write_str("a record")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut record: A) -> Result<Option<Fault>, A::Error> {
        let mut names = FieldNames::default();
        while let Some((name, IgnoredAny)) = record.next_entry()? {
            names.push(name);
        }
        Ok(Some(names.records_fault()))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<Option<Fault>, A::Error> {
        while items.next_element::<IgnoredAny>()?.is_some() {}
        Ok(None)
    }

    visit_scalars!(self => Ok(None));
}

/// The first columns in the order of the file, and how many there are.
#[derive(Default)]
pub(super) struct Columns {
    pub names: Vec<String>,
    pub columns: Vec<Column>,
    pub count: usize,
}

/// The cells of one column as one text.
#[derive(Default)]
pub(super) struct Column {
    text: String,
    /// Where each cell ends in `text`.
    pub ends: Vec<usize>,
}

impl Column {
    pub fn cell(&self, row: usize) -> &str {
        let start = row.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.text[start..self.ends[row]]
    }
}

read_by!(Columns => deserialize_map(ColumnsVisitor));

struct ColumnsVisitor;

impl<'de> Visitor<'de> for ColumnsVisitor {
    type Value = Columns;

    fn expecting(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        formatter.write_str("an object of columns, each an array")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Columns, A::Error> {
        let mut columns = Columns::default();
        while let Some(name) = map.next_key::<String>()? {
            columns.count += 1;
            if columns.count > MAX_COLUMNS {
                map.next_value::<IgnoredAny>()?;
                continue;
            }
            columns.names.push(name);
            columns.columns.push(map.next_value()?);
        }
        Ok(columns)
    }
}

read_by!(Sensors => deserialize_seq(SensorsVisitor));

struct SensorsVisitor;

impl<'de> Visitor<'de> for SensorsVisitor {
    type Value = Sensors;

    fn expecting(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        formatter.write_str("an array of sensors")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<Sensors, A::Error> {
        let mut sensors = Sensors::default();
        while let Some(sensor) = items.next_element()? {
            sensors.count += 1;
            if sensors.count <= MAX_SENSORS {
                sensors.described.push(sensor);
            }
        }
        Ok(sensors)
    }
}

read_by!(Column => deserialize_seq(ColumnVisitor));

struct ColumnVisitor;

impl<'de> Visitor<'de> for ColumnVisitor {
    type Value = Column;

    fn expecting(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        formatter.write_str("a column: an array of numbers, texts and nulls")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut cells: A) -> Result<Column, A::Error> {
        let mut column = Column::default();
        while cells
            .next_element_seed(CellSeed(&mut column.text))?
            .is_some()
        {
            column.ends.push(column.text.len());
        }
        Ok(column)
    }
}

/// Appends one cell to the text of its column.
struct CellSeed<'a>(&'a mut String);

own_seed!(CellSeed<'_> => ());

impl Visitor<'_> for CellSeed<'_> {
    type Value = ();

    fn expecting(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        formatter.write_str("a number, a text or null")
    }

    fn visit_unit<E: Error>(self) -> Result<(), E> {
        Ok(())
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<(), E> {
        self.0.push_str(text);
        Ok(())
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<(), E> {
        table::push_number(self.0, value);
        Ok(())
    }

    fn visit_u64<E: Error>(self, value: u64) -> Result<(), E> {
        write!(self.0, "{value}").map_err(E::custom)
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<(), E> {
        write!(self.0, "{value}").map_err(E::custom)
    }
}
