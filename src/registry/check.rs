//! Checks a JSON value against its description, fills in defaults, and reports every fault with its JSON pointer.

use super::place::Place;
use super::{Bound, Field, Kind, Object, Presence, Union};
use crate::model::fault::Fault;
use serde_json::{Map, Value};

/// More than any identity has, so that what is told of a wrong one is short.
const MAX_ID_LENGTH: usize = 100;

/// The value with defaults filled in and fields in the order of the description.
///
/// # Errors
/// Every fault found.
pub fn check(value: &Value, object: &'static Object) -> Result<Value, Vec<Fault>> {
    let mut faults = Vec::new();
    let checked = check_into(value, object, &mut faults);
    if faults.is_empty() {
        Ok(checked)
    } else {
        Err(faults)
    }
}

/// The same for callers with more to check: what could be read of the value, and every fault added to `faults`.
pub fn check_into(value: &Value, object: &'static Object, faults: &mut Vec<Fault>) -> Value {
    check_object(value, object, None, &Place::Pointer(""), faults)
}

/// The same for one value of the given kind at `pointer`.
pub fn check_field(
    value: &Value,
    kind: &'static Kind,
    pointer: &str,
    faults: &mut Vec<Fault>,
) -> Value {
    check_value(value, kind, &Place::Pointer(pointer), faults)
}

fn check_value(
    value: &Value,
    kind: &'static Kind,
    place: &Place,
    faults: &mut Vec<Fault>,
) -> Value {
    match kind {
        Kind::Number { min, max, unit } => check_number(value, *min, *max, unit, place, faults),
        Kind::Integer { min, max, .. } => check_integer(value, *min, *max, place, faults),
        Kind::Text { max_length } => check_text(value, *max_length, place, faults),
        Kind::Id => check_text(value, MAX_ID_LENGTH, place, faults),
        Kind::Choice(names) => check_choice(value, names, place, faults),
        Kind::Flag => expect_type(value, value.is_boolean(), "true or false", place, faults),
        Kind::Json => value.clone(),
        Kind::Object(object) => check_object(value, object, None, place, faults),
        Kind::Union(union) => check_union(value, union, place, faults),
        Kind::List { item, min, max } => check_list(value, item, (*min, *max), place, faults),
        Kind::TextMap {
            max_entries,
            max_length,
        } => check_text_map(value, *max_entries, *max_length, place, faults),
    }
}

fn check_object(
    value: &Value,
    object: &'static Object,
    tag: Option<&str>,
    place: &Place,
    faults: &mut Vec<Fault>,
) -> Value {
    let Value::Object(given) = value else {
        return expect_type(value, false, "an object", place, faults);
    };
    let mut checked = Map::new();
    for field in object.fields {
        check_member(given.get(field.name), field, place, &mut checked, faults);
    }
    for name in given.keys().filter(|name| {
        tag != Some(name.as_str())
            && !object
                .fields
                .iter()
                .any(|field| field.name == name.as_str())
    }) {
        let allowed = tag
            .into_iter()
            .chain(object.fields.iter().map(|field| field.name))
            .collect::<Vec<_>>()
            .join(", ");
        faults.push(
            Fault::new(
                &Place::Member(place, name),
                "unknown_field",
                format!("unknown field '{name}'"),
            )
            .allowing(allowed),
        );
    }
    Value::Object(checked)
}

fn check_member(
    given: Option<&Value>,
    field: &'static Field,
    place: &Place,
    checked: &mut Map<String, Value>,
    faults: &mut Vec<Fault>,
) {
    let place = &Place::Member(place, field.name);
    match (given, &field.presence) {
        (Some(value), _) => {
            checked.insert(
                field.name.to_owned(),
                check_value(value, &field.kind, place, faults),
            );
        }
        (None, Presence::Default(text)) => {
            let value = serde_json::from_str(text)
                .expect("defaults in the tables are JSON; a test reads them all");
            checked.insert(
                field.name.to_owned(),
                check_value(&value, &field.kind, place, faults),
            );
        }
        (None, Presence::Required) => faults.push(Fault::new(
            place,
            "missing",
            format!("'{}' is required", field.name),
        )),
        (None, Presence::Optional) => {}
    }
}

fn check_union(
    value: &Value,
    union: &'static Union,
    place: &Place,
    faults: &mut Vec<Fault>,
) -> Value {
    if !value.is_object() {
        return expect_type(value, false, "an object", place, faults);
    }
    let variants = (union.variants)();
    let allowed = variants
        .iter()
        .map(|variant| variant.tag)
        .collect::<Vec<_>>()
        .join(", ");
    let tag_place = &Place::Member(place, union.tag);
    let Some(tag) = value.get(union.tag) else {
        faults.push(
            Fault::new(tag_place, "missing", format!("'{}' is required", union.tag))
                .allowing(allowed),
        );
        return Value::Null;
    };
    let Some(variant) = variants
        .iter()
        .find(|variant| tag.as_str() == Some(variant.tag))
    else {
        faults.push(
            Fault::new(
                tag_place,
                "unknown_value",
                format!("unknown {} {tag}", union.tag),
            )
            .allowing(allowed),
        );
        return Value::Null;
    };
    let mut tagged = Map::new();
    tagged.insert(union.tag.to_owned(), tag.clone());
    if let Value::Object(fields) =
        check_object(value, variant.object, Some(union.tag), place, faults)
    {
        tagged.extend(fields);
    }
    Value::Object(tagged)
}

fn check_number(
    value: &Value,
    min: Bound,
    max: Bound,
    unit: &str,
    place: &Place,
    faults: &mut Vec<Fault>,
) -> Value {
    let Some(number) = value.as_f64().filter(|number| number.is_finite()) else {
        return expect_type(value, false, "a number", place, faults);
    };
    let above = match min {
        Bound::None => true,
        Bound::Including(bound) => number >= bound,
        Bound::Excluding(bound) => number > bound,
    };
    let below = match max {
        Bound::None => true,
        Bound::Including(bound) => number <= bound,
        Bound::Excluding(bound) => number < bound,
    };
    if !(above && below) {
        let fault = Fault::new(
            place,
            "out_of_range",
            format!("{number} is outside the allowed range"),
        );
        faults.push(fault.allowing(range_text(min, max, unit)));
    }
    value.clone()
}

/// An interval as people write it: `(0, 1]`, `>= 0 m`.
pub(super) fn range_text(min: Bound, max: Bound, unit: &str) -> String {
    let range = match (min, max) {
        (Bound::None, Bound::None) => "any number".to_owned(),
        (Bound::Including(low), Bound::None) => format!(">= {low}"),
        (Bound::Excluding(low), Bound::None) => format!("> {low}"),
        (Bound::None, Bound::Including(high)) => format!("<= {high}"),
        (Bound::None, Bound::Excluding(high)) => format!("< {high}"),
        (low, high) => format!("{}, {}", open_text(low), close_text(high)),
    };
    if unit.is_empty() {
        range
    } else {
        format!("{range} {unit}")
    }
}

fn open_text(bound: Bound) -> String {
    match bound {
        Bound::Including(value) => format!("[{value}"),
        Bound::Excluding(value) => format!("({value}"),
        Bound::None => String::new(),
    }
}

fn close_text(bound: Bound) -> String {
    match bound {
        Bound::Including(value) => format!("{value}]"),
        Bound::Excluding(value) => format!("{value})"),
        Bound::None => String::new(),
    }
}

fn check_integer(
    value: &Value,
    min: i64,
    max: i64,
    place: &Place,
    faults: &mut Vec<Fault>,
) -> Value {
    let Some(number) = value.as_i64() else {
        return expect_type(value, false, "a whole number", place, faults);
    };
    if !(min..=max).contains(&number) {
        let fault = Fault::new(
            place,
            "out_of_range",
            format!("{number} is outside the allowed range"),
        );
        faults.push(fault.allowing(format!("[{min}, {max}]")));
    }
    value.clone()
}

fn check_text(value: &Value, max_length: usize, place: &Place, faults: &mut Vec<Fault>) -> Value {
    if let Some(text) = value.as_str() {
        check_length(text, max_length, place, faults);
        faults.extend(control_character(text, place));
    }
    expect_type(value, value.is_string(), "a text", place, faults)
}

fn check_length(text: &str, max_length: usize, place: &Place, faults: &mut Vec<Fault>) {
    if text.chars().count() > max_length {
        faults.push(
            Fault::new(place, "too_large", "the text is too long")
                .allowing(format!("at most {max_length} characters")),
        );
    }
}

/// The fault of a text with a character from U+0000 to U+001F: no name needs one, and no database keeps U+0000.
pub fn control_character_fault(text: &str, pointer: &str) -> Option<Fault> {
    control_character(text, &Place::Pointer(pointer))
}

fn control_character(text: &str, place: &Place) -> Option<Fault> {
    let (index, character) = text
        .chars()
        .enumerate()
        .find(|(_, character)| *character < ' ')?;
    let detail = format!(
        "the text has the control character U+{:04X} at character {}",
        u32::from(character),
        index + 1
    );
    Some(
        Fault::new(place, "control_character", detail)
            .allowing("no character from U+0000 to U+001F"),
    )
}

fn check_choice(value: &Value, names: &[&str], place: &Place, faults: &mut Vec<Fault>) -> Value {
    if let Some(text) = value.as_str()
        && !names.contains(&text)
    {
        faults.push(
            Fault::new(place, "unknown_value", format!("unknown value \"{text}\""))
                .allowing(names.join(", ")),
        );
    }
    expect_type(value, value.is_string(), "a text", place, faults)
}

fn check_list(
    value: &Value,
    item: &'static Kind,
    (min, max): (usize, usize),
    place: &Place,
    faults: &mut Vec<Fault>,
) -> Value {
    let Value::Array(items) = value else {
        return expect_type(value, false, "a list", place, faults);
    };
    if !(min..=max).contains(&items.len()) {
        let fault = Fault::new(
            place,
            "out_of_range",
            format!("the list has {} entries", items.len()),
        );
        faults.push(fault.allowing(format!("{min} to {max} entries")));
    }
    let check_item = |(index, entry)| check_value(entry, item, &Place::Item(place, index), faults);
    Value::Array(items.iter().enumerate().map(check_item).collect())
}

fn check_text_map(
    value: &Value,
    max_entries: usize,
    max_length: usize,
    place: &Place,
    faults: &mut Vec<Fault>,
) -> Value {
    let Value::Object(entries) = value else {
        return expect_type(value, false, "an object of texts", place, faults);
    };
    if entries.len() > max_entries {
        faults.push(
            Fault::new(place, "too_large", "too many entries")
                .allowing(format!("at most {max_entries} entries")),
        );
    }
    for (name, entry) in entries {
        let place = &Place::Member(place, name);
        check_length(name, max_length, place, faults);
        faults.extend(control_character(name, place));
        check_text(entry, max_length, place, faults);
    }
    value.clone()
}

/// The value itself, with a fault when it is not of the wanted type.
fn expect_type(
    value: &Value,
    is_right: bool,
    wanted: &str,
    place: &Place,
    faults: &mut Vec<Fault>,
) -> Value {
    if !is_right {
        let found = match value {
            Value::Null => "null",
            Value::Bool(_) => "true or false",
            Value::Number(_) => "a number",
            Value::String(_) => "a text",
            Value::Array(_) => "a list",
            Value::Object(_) => "an object",
        };
        faults.push(
            Fault::new(
                place,
                "wrong_type",
                format!("expected {wanted}, found {found}"),
            )
            .allowing(wanted),
        );
    }
    value.clone()
}

#[cfg(test)]
mod tests;
