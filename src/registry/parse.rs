//! Reads JSON without losing anything: a member that is given twice is a fault, where other readers keep the last one.

use super::place::Place;
use crate::model::fault::Fault;
use serde::de::{DeserializeSeed, Deserializer, Error, MapAccess, SeqAccess, Visitor};
use serde_json::{Map, Number, Value};
use std::fmt;

/// The value, and a fault for every member that is given again.
///
/// # Errors
/// With line and column, of bytes that are not JSON.
pub fn parse(bytes: &[u8]) -> serde_json::Result<(Value, Vec<Fault>)> {
    let mut faults = Vec::new();
    let mut deserializer = serde_json::Deserializer::from_slice(bytes);
    let value = Reader {
        place: Place::Pointer(""),
        faults: &mut faults,
    }
    .deserialize(&mut deserializer)?;
    deserializer.end()?;
    Ok((value, faults))
}

/// Faults are collected up to here.
const MAX_FAULTS: usize = 20;

/// Reads the value at a place.
struct Reader<'a> {
    place: Place<'a>,
    faults: &'a mut Vec<Fault>,
}

impl Reader<'_> {
    fn note_duplicate(&mut self, name: &str) {
        if self.faults.len() < MAX_FAULTS {
            let detail = format!("the member '{name}' is given more than once");
            let fault = Fault::new(&Place::Member(&self.place, name), "duplicate", detail);
            self.faults.push(fault.allowing("each member once"));
        }
    }
}

impl<'de> DeserializeSeed<'de> for Reader<'_> {
    type Value = Value;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Value, D::Error> {
        deserializer.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for Reader<'_> {
    type Value = Value;

    fn expecting(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        formatter.write_str("a JSON value")
    }

    fn visit_unit<E: Error>(self) -> Result<Value, E> {
        Ok(Value::Null)
    }

    fn visit_bool<E: Error>(self, flag: bool) -> Result<Value, E> {
        Ok(flag.into())
    }

    fn visit_i64<E: Error>(self, number: i64) -> Result<Value, E> {
        Ok(number.into())
    }

    fn visit_u64<E: Error>(self, number: u64) -> Result<Value, E> {
        Ok(number.into())
    }

    fn visit_f64<E: Error>(self, number: f64) -> Result<Value, E> {
        Ok(Number::from_f64(number).map_or(Value::Null, Value::Number))
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<Value, E> {
        Ok(text.into())
    }

    fn visit_string<E: Error>(self, text: String) -> Result<Value, E> {
        Ok(text.into())
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut entries: A) -> Result<Value, A::Error> {
        let mut items = Vec::new();
        while let Some(item) = entries.next_element_seed(Reader {
            place: Place::Item(&self.place, items.len()),
            faults: self.faults,
        })? {
            items.push(item);
        }
        Ok(Value::Array(items))
    }

    fn visit_map<A: MapAccess<'de>>(mut self, mut entries: A) -> Result<Value, A::Error> {
        let mut members = Map::new();
        while let Some(name) = entries.next_key::<String>()? {
            if members.contains_key(&name) {
                self.note_duplicate(&name);
            }
            let value = entries.next_value_seed(Reader {
                place: Place::Member(&self.place, &name),
                faults: self.faults,
            })?;
            members.insert(name, value);
        }
        Ok(Value::Object(members))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_member_that_is_given_again_is_a_fault_at_its_place() {
        let text =
            r#"{"a": 1, "b": [{"c/d": 1}, {"c/d": 1, "e": {"a": 2}, "c/d": 2}], "a": 3, "a": 4}"#;
        let (_, faults) = parse(text.as_bytes()).unwrap();
        let found: Vec<_> = faults
            .iter()
            .map(|fault| (fault.pointer.as_str(), fault.code.as_str()))
            .collect();
        assert_eq!(
            found,
            [
                ("/b/1/c~1d", "duplicate"),
                ("/a", "duplicate"),
                ("/a", "duplicate")
            ]
        );
        assert_eq!(faults[0].detail, "the member 'c/d' is given more than once");
    }

    #[test]
    fn what_is_no_json_is_told_as_serde_tells_it() {
        for text in [
            "",
            "{",
            "[1,]",
            "{\"a\":1}x",
            "nul",
            "\"\u{0}\"",
            "1e999",
            "{\"a\"}",
        ] {
            let wanted = serde_json::from_str::<Value>(text).unwrap_err().to_string();
            assert_eq!(
                parse(text.as_bytes()).unwrap_err().to_string(),
                wanted,
                "{text}"
            );
        }
        let deep = "[".repeat(100_000);
        assert!(
            parse(deep.as_bytes())
                .unwrap_err()
                .to_string()
                .starts_with("recursion limit exceeded")
        );
    }

    fn json() -> impl Strategy<Value = Value> {
        let leaf = prop_oneof![
            Just(Value::Null),
            any::<bool>().prop_map(Value::from),
            any::<i64>().prop_map(Value::from),
            any::<u64>().prop_map(Value::from),
            any::<f64>().prop_map(Value::from),
            ".*".prop_map(Value::from),
        ];
        leaf.prop_recursive(4, 32, 6, |inner| {
            prop_oneof![
                prop::collection::vec(inner.clone(), 0..6).prop_map(Value::from),
                prop::collection::btree_map(".*", inner, 0..6)
                    .prop_map(|members| Value::Object(members.into_iter().collect())),
            ]
        })
    }

    proptest! {
        #[test]
        fn values_are_read_as_serde_reads_them(value in json()) {
            let text = value.to_string();
            let (read, faults) = parse(text.as_bytes()).unwrap();
            prop_assert_eq!(read, serde_json::from_str::<Value>(&text).unwrap());
            prop_assert_eq!(faults, vec![]);
        }
    }
}
