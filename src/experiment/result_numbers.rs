//! Numbers in the result of a job, by their paths: `metrics.gospa.quantities.gospa`, `tfa.probability.correct`.

use crate::registry::nearest_of;
use serde_json::Value;

pub fn place_of<'a>(result: &'a Value, path: &str) -> Option<&'a Value> {
    path.split('.')
        .try_fold(result, |place, step| place.get(step))
}

pub fn fields_at<'a>(
    result: &'a Value,
    path: &str,
) -> impl Iterator<Item = (&'a String, &'a Value)> {
    let fields = place_of(result, path).and_then(Value::as_object);
    fields.into_iter().flatten()
}

/// `; the nearest path is 'tfa.probability.correct'`.
pub fn nearest_to(path: &str, result: &Value) -> String {
    let mut known = Vec::new();
    number_paths(result, String::new(), &mut known);
    nearest_of(path, known).map_or_else(String::new, |nearest| {
        format!("; the nearest path is '{nearest}'")
    })
}

/// The same of what a limit names: quantities of metrics by their short names, too (`clear.recall`).
pub fn nearest_quantity(path: &str, result: &Value) -> String {
    let mut known = Vec::new();
    number_paths(result, String::new(), &mut known);
    let mut short = Vec::new();
    for long in &known {
        let quantity = long
            .strip_prefix("metrics.")
            .and_then(|long| long.split_once(".quantities."));
        short.extend(quantity.map(|(metric, name)| format!("{metric}.{name}")));
    }
    short.append(&mut known);
    nearest_of(path, short).map_or_else(String::new, |nearest| {
        format!("; the nearest path is '{nearest}'")
    })
}

/// The paths of all numbers, flags and quantities of a result, those that are null too; lists have none.
fn number_paths(place: &Value, path: String, known: &mut Vec<String>) {
    match place {
        Value::Object(fields) if !path.is_empty() && fields.contains_key("value") => {
            known.push(path.clone());
            fields
                .iter()
                .filter(|(name, _)| *name != "value")
                .for_each(|(name, part)| number_paths(part, format!("{path}.{name}"), known));
        }
        Value::Object(fields) => {
            for (name, part) in fields {
                number_paths(
                    part,
                    if path.is_empty() {
                        name.clone()
                    } else {
                        format!("{path}.{name}")
                    },
                    known,
                );
            }
        }
        Value::Null | Value::Bool(_) | Value::Number(_) => known.push(path),
        Value::String(_) | Value::Array(_) => {}
    }
}

/// A path ends at a number or a flag, or at a quantity, whose number is its `value`.
pub fn number_at(result: &Value, path: &str) -> Option<f64> {
    let found = place_of(result, path)?;
    match found {
        Value::Bool(flag) => Some(f64::from(u8::from(*flag))),
        Value::Object(fields) => fields.get("value").and_then(Value::as_f64),
        other => other.as_f64(),
    }
}

/// Why a quantity has no number, as the result says it; `None` where there is no such place.
pub fn reason_at<'a>(result: &'a Value, path: &str) -> Option<&'a str> {
    let told = place_of(result, path)?.get("reason");
    Some(
        told.and_then(Value::as_str)
            .unwrap_or("it is null or no number"),
    )
}

/// Whether this is a number with its unit, or the reason why there is none.
pub fn is_quantity(found: &Value) -> bool {
    found.get("value").is_some()
}
