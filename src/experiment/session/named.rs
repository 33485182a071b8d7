//! Numbers by name, most of which are absent: an object on the wire, an array in memory.

use serde::de::{DeserializeSeed, Deserializer, MapAccess, Visitor};
use serde::ser::{SerializeMap, Serializer};
use std::fmt;

/// Writes a text, if there is one, and the numbers that are there.
///
/// # Errors
/// What the serializer says.
pub fn serialize<S: Serializer>(
    serializer: S,
    text: Option<(&str, &str)>,
    names: &[&str],
    values: &[Option<f64>],
) -> Result<S::Ok, S::Error> {
    let mut map = serializer.serialize_map(None)?;
    if let Some((name, text)) = text {
        map.serialize_entry(name, text)?;
    }
    for (name, value) in names.iter().zip(values) {
        if let Some(value) = value {
            map.serialize_entry(name, value)?;
        }
    }
    map.end()
}

/// The text, and the numbers by their place among the names.
pub type TextAndNumbers<const N: usize> = (Option<String>, [Option<f64>; N]);

/// Reads what [`serialize`] wrote: the text of this name, and the numbers.
///
/// # Errors
/// Other names, and what the deserializer says.
pub fn deserialize<'de, D: Deserializer<'de>, const N: usize>(
    deserializer: D,
    text: Option<&'static str>,
    names: &'static [&'static str; N],
) -> Result<TextAndNumbers<N>, D::Error> {
    deserializer.deserialize_map(Named { text, names })
}

struct Named<const N: usize> {
    text: Option<&'static str>,
    names: &'static [&'static str; N],
}

/// What a key names.
enum Place {
    Text,
    Number(usize),
}

impl<'de, const N: usize> Visitor<'de> for Named<N> {
    type Value = TextAndNumbers<N>;

    fn expecting(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        write!(formatter, "an object with {}", self.names.join(", "))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
        let (mut text, mut values) = (None, [None; N]);
        while let Some(place) = map.next_key_seed(Key(&self))? {
            match place {
                Place::Text => text = map.next_value()?,
                Place::Number(index) => values[index] = map.next_value()?,
            }
        }
        Ok((text, values))
    }
}

struct Key<'k, const N: usize>(&'k Named<N>);

impl<'de, const N: usize> DeserializeSeed<'de> for Key<'_, N> {
    type Value = Place;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Place, D::Error> {
        deserializer.deserialize_identifier(self)
    }
}

impl<const N: usize> Visitor<'_> for Key<'_, N> {
    type Value = Place;

    fn expecting(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        self.0.expecting(formatter)
    }

    fn visit_str<E: serde::de::Error>(self, name: &str) -> Result<Place, E> {
        if self.0.text == Some(name) {
            return Ok(Place::Text);
        }
        let index = self.0.names.iter().position(|other| *other == name);
        index
            .map(Place::Number)
            .ok_or_else(|| E::unknown_field(name, self.0.names))
    }
}
