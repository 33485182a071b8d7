//! Names in a request are names in files.

use crate::model::fault::Fault;
use crate::model::names::name_fault;
use serde_json::Value;

/// What the fields are called whose texts name things in tables. The name of the whole job is in none.
const NAMES: [&str; 3] = ["truth_id", "sensor_id", "name"];

/// Names that a file could not have are refused in requests, too.
pub fn check_names(value: &Value, pointer: &str, faults: &mut Vec<Fault>) {
    let entries: Vec<(String, &Value)> = match value {
        Value::Object(fields) => fields
            .iter()
            .map(|(name, value)| (name.replace('~', "~0").replace('/', "~1"), value))
            .collect(),
        Value::Array(items) => items
            .iter()
            .enumerate()
            .map(|(index, item)| (index.to_string(), item))
            .collect(),
        _ => return,
    };
    for (name, value) in entries {
        let pointer_of_entry = format!("{pointer}/{name}");
        let is_name = NAMES.contains(&name.as_str())
            && pointer_of_entry != "/name"
            && !pointer.ends_with("/labels");
        if let Some(found) = value.as_str().filter(|_| is_name).and_then(name_fault) {
            faults.push(
                Fault::new(pointer_of_entry, found.code, found.detail).allowing(found.allowed),
            );
        } else {
            check_names(value, &pointer_of_entry, faults);
        }
    }
}
