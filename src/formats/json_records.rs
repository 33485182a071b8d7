//! Tables that JSON writes row by row: an array of records, a record a line, or rows without names.

use super::MAX_COLUMNS;
use super::json_document::{CellSeed, Column, Columns};
use super::loose::{own_seed, read_by};
use serde::de::{DeserializeSeed, Deserializer, Error, IgnoredAny, MapAccess, SeqAccess, Visitor};
use std::collections::HashMap;
use std::fmt;

/// Records read so far, as columns; a field that a record lacks is an empty cell.
#[derive(Default)]
pub(super) struct Records {
    columns: Columns,
    /// By name; only looked up, never walked.
    places: HashMap<String, usize>,
    rows: usize,
}

impl Records {
    /// The columns, each as long as there are records.
    pub fn finish(mut self) -> Columns {
        for column in &mut self.columns.columns {
            column.fill(self.rows);
        }
        self.columns
    }

    /// The column of a name, filled up to the current row; `None` beyond the most that are kept.
    fn column(&mut self, name: &str) -> Option<&mut Column> {
        let place = match self.places.get(name) {
            Some(&place) => place,
            None => {
                let place = self.columns.columns.len();
                self.columns.count += 1;
                if place >= MAX_COLUMNS {
                    return None;
                }
                self.places.insert(name.to_owned(), place);
                self.columns.names.push(name.to_owned());
                self.columns.columns.push(Column::default());
                place
            }
        };
        let column = &mut self.columns.columns[place];
        column.fill(self.rows);
        Some(column)
    }
}

/// Reads one record.
impl<'de> DeserializeSeed<'de> for &mut Records {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_map(self)
    }
}

impl<'de> Visitor<'de> for &mut Records {
    type Value = ();

    fn expecting(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        formatter.write_str("a record: names with numbers, texts, true, false or null")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut record: A) -> Result<(), A::Error> {
        while let Some(name) = record.next_key::<String>()? {
            let row = self.rows;
            let Some(column) = self.column(&name) else {
                record.next_value::<IgnoredAny>()?;
                continue;
            };
            if column.ends.len() > row {
                return Err(A::Error::custom(format!("the record has '{name}' twice")));
            }
            record.next_value_seed(CellSeed(&mut column.text))?;
            column.ends.push(column.text.len());
        }
        self.rows += 1;
        Ok(())
    }
}

/// The states of OpenSky's `/states`: rows of 17 values or more, in an order of their own.
pub(super) struct States(pub Records);

/// Names of the values, those of OpenSky's tables.
const STATE: [&str; 17] = [
    "icao24",
    "callsign",
    "origin_country",
    "lastposupdate",
    "lastcontact",
    "lon",
    "lat",
    "baroaltitude",
    "onground",
    "velocity",
    "heading",
    "vertrate",
    "sensors",
    "geoaltitude",
    "squawk",
    "spi",
    "position_source",
];

read_by!(States => deserialize_seq(StatesVisitor));

struct StatesVisitor;

impl<'de> Visitor<'de> for StatesVisitor {
    type Value = States;

    fn expecting(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        formatter.write_str("an array of states")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut states: A) -> Result<States, A::Error> {
        let mut records = Records::default();
        while states.next_element_seed(StateSeed(&mut records))?.is_some() {}
        Ok(States(records))
    }
}

struct StateSeed<'a>(&'a mut Records);

own_seed!(StateSeed<'_> => ());

impl<'de> Visitor<'de> for StateSeed<'_> {
    type Value = ();

    fn expecting(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        formatter.write_str("a state: an array of 17 values")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut values: A) -> Result<(), A::Error> {
        for name in STATE {
            // Receivers' serials are a list, which nothing here needs.
            if name == "sensors" {
                values.next_element::<IgnoredAny>()?;
                continue;
            }
            let Some(column) = self.0.column(name) else {
                continue;
            };
            if values
                .next_element_seed(CellSeed(&mut column.text))?
                .is_none()
            {
                return Err(A::Error::custom("a state of fewer than 17 values"));
            }
            column.ends.push(column.text.len());
        }
        while values.next_element::<IgnoredAny>()?.is_some() {}
        self.0.rows += 1;
        Ok(())
    }
}
