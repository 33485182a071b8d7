//! Names in a request are names in files.

use crate::model::fault::Fault;
use crate::model::names::name_fault;
use crate::registry::Place;
use serde_json::Value;

/// What the fields are called whose texts name things in tables. The name of the whole job is in none.
const NAMES: [&str; 3] = ["truth_id", "sensor_id", "name"];

/// Names that a file could not have are refused in requests, too.
pub fn check_names(value: &Value, faults: &mut Vec<Fault>) {
    check_inside(value, &Place::Pointer(""), faults);
}

fn check_inside(value: &Value, place: &Place, faults: &mut Vec<Fault>) {
    match value {
        Value::Object(fields) => {
            for (name, value) in fields {
                check_one(value, &Place::Member(place, name), faults);
            }
        }
        Value::Array(items) => {
            for (index, item) in items.iter().enumerate() {
                check_one(item, &Place::Item(place, index), faults);
            }
        }
        _ => {}
    }
}

fn check_one(value: &Value, place: &Place, faults: &mut Vec<Fault>) {
    let text = value.as_str().filter(|_| is_name(place));
    match text.and_then(name_fault) {
        Some(found) => {
            faults.push(Fault::new(place, found.code, found.detail).allowing(found.allowed));
        }
        None => check_inside(value, place, faults),
    }
}

fn is_name(place: &Place) -> bool {
    match place {
        Place::Member(Place::Pointer(""), "name")
        | Place::Member(Place::Member(_, "labels"), _) => false,
        Place::Member(_, name) => NAMES.contains(name),
        _ => false,
    }
}
