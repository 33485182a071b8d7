//! What a format has to be told of a file besides its content: fields of the format's own table.

use super::FORMATS;
use super::reading::READING;
use crate::registry::{Field, count_fields, joined};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;

const TABLES: [&[Field]; FORMATS.len() + 1] = {
    let mut tables: [&[Field]; FORMATS.len() + 1] = [&[]; FORMATS.len() + 1];
    let mut format = 0;
    while format < FORMATS.len() {
        tables[format] = FORMATS[format].options;
        format += 1;
    }
    tables[FORMATS.len()] = READING;
    tables
};

/// The options of every format, for whoever takes files of any.
pub const OPTION_FIELDS: [Field; count_fields(&TABLES)] = joined(&TABLES);

/// Options by name, as the tables checked them.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct FormatOptions(BTreeMap<String, Value>);

impl FormatOptions {
    /// The option, where it is given and is what its format takes.
    pub fn get<T: DeserializeOwned>(&self, name: &str) -> Option<T> {
        T::deserialize(self.0.get(name)?).ok()
    }

    /// All options as one value that says what it takes of them.
    ///
    /// # Errors
    /// An option that is not of the type that the value wants.
    pub fn parse<T: DeserializeOwned>(&self) -> serde_json::Result<T> {
        let fields = self
            .0
            .iter()
            .map(|(name, value)| (name.clone(), value.clone()));
        T::deserialize(Value::Object(fields.collect()))
    }

    /// Adds what a file says of itself, where nothing else was told.
    pub fn add<T: Serialize>(&mut self, name: &str, value: &Option<T>) {
        if let Some(Ok(value)) = value.as_ref().map(serde_json::to_value) {
            self.0.entry(name.to_owned()).or_insert(value);
        }
    }

    pub fn iter(&self) -> impl Iterator<Item = (&String, &Value)> {
        self.0.iter()
    }
}

impl FromIterator<(String, Value)> for FormatOptions {
    fn from_iter<Options: IntoIterator<Item = (String, Value)>>(options: Options) -> Self {
        FormatOptions(options.into_iter().collect())
    }
}
