//! The document of canonical JSON, read as it comes: columns as one text each, and what is too many only counted.

use super::MAX_COLUMNS;
use super::json_records::{Records, States};
use super::json_text::parse;
use super::loose::{own_seed, read_by, visit_scalars, visit_texts};
use super::table;
use crate::model::dataset::DatasetKind;
use crate::model::fault::Fault;
use crate::model::sensor::SensorSettings;
use crate::model::space::Frame;
use crate::model::time::TimeBase;
use serde::de::{Error, IgnoredAny, MapAccess, SeqAccess, Visitor};
use std::fmt::{self, Write as _};
use std::io::BufRead;

/// A table as JSON: `{"columns": {…}}` with what else is known, columns alone, an array of records, or the states of OpenSky.
#[derive(Default)]
pub(super) struct Document {
    pub kind: Option<DatasetKind>,
    pub columns: Columns,
    pub sensors: Sensors,
    pub frame: Option<Frame>,
    pub time_base: Option<TimeBase>,
}

/// Sensors that a file may describe.
pub(super) const MAX_SENSORS: usize = 4096;

/// The first sensors, and how many there are.
#[derive(Default)]
pub(super) struct Sensors {
    pub described: Vec<SensorSettings>,
    pub count: usize,
}

/// The document.
///
/// # Errors
/// One fault, where the text is no JSON or not one of these shapes.
pub(super) fn document(input: &mut dyn BufRead) -> Result<Document, Vec<Fault>> {
    parse(input, DocumentSeed)
}

struct DocumentSeed;

own_seed!(DocumentSeed => Document);

impl<'de> Visitor<'de> for DocumentSeed {
    type Value = Document;

    fn expecting(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        formatter.write_str("an object of columns, or an array of records")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Document, A::Error> {
        let mut document = Document::default();
        let mut plain = Columns::default();
        let mut has_columns = false;
        while let Some(name) = map.next_key::<String>()? {
            match name.as_str() {
                "columns" => (document.columns, has_columns) = (map.next_value()?, true),
                "kind" => document.kind = map.next_value()?,
                "sensors" => document.sensors = map.next_value()?,
                "frame" => document.frame = map.next_value()?,
                "time_base" => document.time_base = map.next_value()?,
                "states" => document.columns = map.next_value::<States>()?.0.finish(),
                _ => plain.add(name, map.next_value::<Member>()?),
            }
        }
        if has_columns && plain.count > 0 {
            let unknown = plain.names.join(", ");
            return Err(A::Error::custom(format!(
                "unknown member {unknown}, expected one of {MEMBERS}"
            )));
        }
        if document.columns.count == 0 && !has_columns {
            if plain.columns.is_empty() {
                return Err(A::Error::custom(format!(
                    "no columns, expected one of {MEMBERS}"
                )));
            }
            document.columns = plain;
        }
        Ok(document)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<Document, A::Error> {
        let mut records = Records::default();
        while items.next_element_seed(&mut records)?.is_some() {}
        Ok(Document {
            columns: records.finish(),
            ..Document::default()
        })
    }
}

/// What an object may have.
const MEMBERS: &str = "columns, kind, sensors, frame, time_base; or columns alone, by their names";

/// A member that has no name of its own: a column, or a single value, which says nothing of rows.
enum Member {
    Column(Column),
    Single,
}

read_by!(Member => deserialize_any(MemberVisitor));

struct MemberVisitor;

impl<'de> Visitor<'de> for MemberVisitor {
    type Value = Member;

    fn expecting(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        formatter.write_str("a column")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, cells: A) -> Result<Member, A::Error> {
        ColumnVisitor.visit_seq(cells).map(Member::Column)
    }

    fn visit_map<A: MapAccess<'de>>(self, cells: A) -> Result<Member, A::Error> {
        ColumnVisitor.visit_map(cells).map(Member::Column)
    }

    visit_scalars!(self => Ok(Member::Single));
}

/// The first columns in the order of the file, and how many there are.
#[derive(Default)]
pub(super) struct Columns {
    pub names: Vec<String>,
    pub columns: Vec<Column>,
    pub count: usize,
}

impl Columns {
    fn add(&mut self, name: String, member: Member) {
        self.count += 1;
        if self.count > MAX_COLUMNS {
            return;
        }
        self.names.push(name);
        if let Member::Column(column) = member {
            self.columns.push(column);
        } else {
            self.names.pop();
        }
    }
}

/// The cells of one column as one text.
#[derive(Default)]
pub(super) struct Column {
    pub text: String,
    /// Where each cell ends in `text`.
    pub ends: Vec<usize>,
}

impl Column {
    /// Fills up with empty cells until there are so many.
    pub fn fill(&mut self, cells: usize) {
        self.ends.resize(cells, self.text.len());
    }

    pub fn cell(&self, row: usize) -> &str {
        let start = row.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.text[start..self.ends[row]]
    }
}

read_by!(Columns => deserialize_any(ColumnsVisitor));

struct ColumnsVisitor;

impl<'de> Visitor<'de> for ColumnsVisitor {
    type Value = Columns;

    fn expecting(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        formatter.write_str("an object of columns, each an array")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut names: A) -> Result<Columns, A::Error> {
        while names.next_element::<IgnoredAny>()?.is_some() {}
        Err(A::Error::custom(
            "columns are a list of names, as pandas writes with orient='split': write orient='columns' or 'records'",
        ))
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

read_by!(Column => deserialize_any(ColumnVisitor));

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

    /// As pandas writes it: each cell under its index.
    fn visit_map<A: MapAccess<'de>>(self, mut cells: A) -> Result<Column, A::Error> {
        let mut column = Column::default();
        while cells.next_key::<IgnoredAny>()?.is_some() {
            cells.next_value_seed(CellSeed(&mut column.text))?;
            column.ends.push(column.text.len());
        }
        Ok(column)
    }
}

/// Appends one cell to the text of its column.
pub(super) struct CellSeed<'a>(pub &'a mut String);

own_seed!(CellSeed<'_> => ());

impl Visitor<'_> for CellSeed<'_> {
    type Value = ();

    fn expecting(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        formatter.write_str("a number, a text or null")
    }

    fn visit_unit<E: Error>(self) -> Result<(), E> {
        Ok(())
    }

    fn visit_bool<E: Error>(self, value: bool) -> Result<(), E> {
        write!(self.0, "{value}").map_err(E::custom)
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
