//! Changes of a request before it is checked: a value for one of its places.

use crate::model::fault::Fault;
use serde_json::{Map, Value};

/// Puts a value at a JSON pointer; objects on the way that are absent are made, for a field may have been left to its default.
///
/// # Errors
/// A pointer that leads nowhere.
pub fn put_at(body: &mut Value, path: &str, value: &Value) -> Result<(), Box<Fault>> {
    let Some(steps) = path.strip_prefix('/') else {
        let allowed = "a JSON pointer such as /associator".to_owned();
        return Err(unknown_path(
            path,
            "a path begins with '/'".to_owned(),
            allowed,
        ));
    };
    let mut place = body;
    for step in steps
        .split('/')
        .map(|step| step.replace("~1", "/").replace("~0", "~"))
    {
        place = match place {
            Value::Object(fields) => fields
                .entry(step)
                .or_insert_with(|| Value::Object(Map::new())),
            Value::Array(items) => {
                let allowed = format!("an index below {}", items.len());
                let item = step
                    .parse::<usize>()
                    .ok()
                    .and_then(|index| items.get_mut(index));
                item.ok_or_else(|| {
                    unknown_path(path, format!("there is no item '{step}'"), allowed)
                })?
            }
            _ => {
                let detail = format!("'{step}' is inside of a plain value");
                let allowed = "a path to a field of the base".to_owned();
                return Err(unknown_path(path, detail, allowed));
            }
        };
    }
    *place = value.clone();
    Ok(())
}

pub fn unknown_path(path: &str, detail: String, allowed: String) -> Box<Fault> {
    Box::new(Fault::new(path, "unknown_path", detail).allowing(allowed))
}

/// Puts the value of a field of a request.
pub fn put_field(body: &mut Value, name: &str, value: Value) {
    body[name] = value;
}
