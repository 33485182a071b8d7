//! JSON in one order, for hashes: the order of members does not count.

use serde_json::{Map, Value};
use std::collections::BTreeMap;

/// The same value with the members of all objects in the order of their names.
pub fn sorted(value: &Value) -> Value {
    match value {
        Value::Array(items) => items.iter().map(sorted).collect(),
        Value::Object(members) => {
            let in_order: BTreeMap<&String, Value> = members
                .iter()
                .map(|(name, value)| (name, sorted(value)))
                .collect();
            Value::Object(
                in_order
                    .into_iter()
                    .map(|(name, value)| (name.clone(), value))
                    .collect::<Map<_, _>>(),
            )
        }
        other => other.clone(),
    }
}
