//! What a format has to be told of a file besides its content: fields of the format's own table.

use super::FORMATS;
use crate::registry::{Field, Kind, optional};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;

const COUNT: usize = {
    let (mut count, mut format) = (0, 0);
    while format < FORMATS.len() {
        count += FORMATS[format].options.len();
        format += 1;
    }
    count
};

/// The options of every format, for whoever takes files of any.
pub const OPTION_FIELDS: [Field; COUNT] = {
    let mut fields = [optional("", "", Kind::Json); COUNT];
    let (mut count, mut format) = (0, 0);
    while format < FORMATS.len() {
        let mut option = 0;
        while option < FORMATS[format].options.len() {
            fields[count] = FORMATS[format].options[option];
            (count, option) = (count + 1, option + 1);
        }
        format += 1;
    }
    fields
};

/// Options by name, as the tables checked them.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct FormatOptions(BTreeMap<String, Value>);

impl FormatOptions {
    /// The option, where it is given and is what its format takes.
    pub fn get<T: DeserializeOwned>(&self, name: &str) -> Option<T> {
        T::deserialize(self.0.get(name)?).ok()
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
