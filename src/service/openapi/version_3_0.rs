//! The document as OpenAPI 3.0.3, for generators that know no later version: what 3.0 cannot say is said its way, and
//! what those generators choke on is left out.

use serde_json::{Map, Value, json};
use std::collections::{BTreeMap, BTreeSet};

const SCHEMAS: &str = "#/components/schemas/";

/// The 3.0.3 copy of a 3.1 document.
pub fn derive(mut document: Value) -> Value {
    document["openapi"] = json!("3.0.3");
    if let Some(info) = document["info"].as_object_mut() {
        info.shift_remove("summary");
    }
    if let Some(license) = document
        .pointer_mut("/info/license")
        .and_then(Value::as_object_mut)
    {
        license.shift_remove("identifier");
    }
    remove_multipart(&mut document);
    let types = types_of_schemas(&document);
    type_nullable(&mut document, &types);
    plain_json_problems(&mut document["paths"]);
    schemas_below(&mut document["paths"]);
    if let Some(schemas) = document
        .pointer_mut("/components/schemas")
        .and_then(Value::as_object_mut)
    {
        schemas.values_mut().for_each(schema);
    }
    remove_unused(&mut document);
    document
}

fn remove_multipart(document: &mut Value) {
    for path in document["paths"]
        .as_object_mut()
        .into_iter()
        .flat_map(Map::values_mut)
    {
        if let Some(operations) = path.as_object_mut() {
            operations.retain(|_, operation| {
                operation
                    .pointer("/requestBody/content/multipart~1form-data")
                    .is_none()
            });
        }
    }
}

/// The type of each named schema; a union is one of objects.
fn types_of_schemas(document: &Value) -> BTreeMap<String, String> {
    let schemas = document
        .pointer("/components/schemas")
        .and_then(Value::as_object)
        .into_iter()
        .flatten();
    schemas
        .map(|(name, schema)| {
            (
                format!("{SCHEMAS}{name}"),
                schema["type"].as_str().unwrap_or("object").to_owned(),
            )
        })
        .collect()
}

/// `nullable` says nothing in 3.0 without a type beside it.
fn type_nullable(value: &mut Value, types: &BTreeMap<String, String>) {
    let options = value
        .get("oneOf")
        .and_then(Value::as_array)
        .map_or(&[][..], Vec::as_slice);
    if options.iter().any(|option| option["type"] == "null") {
        let found = options
            .iter()
            .find_map(|option| types.get(option["$ref"].as_str()?));
        found
            .into_iter()
            .for_each(|found| value["type"] = json!(found));
    }
    children(value).for_each(|child| type_nullable(child, types));
}

/// One generator types errors only where they are plain JSON.
fn plain_json_problems(value: &mut Value) {
    if let Some(content) = value.get_mut("content").and_then(Value::as_object_mut)
        && let Some(problem) = content.shift_remove("application/problem+json")
    {
        content.insert("application/json".to_owned(), problem);
    }
    children(value).for_each(plain_json_problems);
}

/// Rewrites the schemas of parameters and bodies.
fn schemas_below(value: &mut Value) {
    if let Some(found) = value.get_mut("schema") {
        schema(found);
    }
    let rest = value
        .as_object_mut()
        .into_iter()
        .flat_map(Map::iter_mut)
        .filter(|(name, _)| *name != "schema" && *name != "examples");
    rest.map(|(_, child)| child).for_each(schemas_below);
    value
        .as_array_mut()
        .into_iter()
        .flatten()
        .for_each(schemas_below);
}

/// Rewrites one schema and those inside it. Names of properties are not keywords, so they are stepped over.
fn schema(value: &mut Value) {
    let Some(members) = value.as_object_mut() else {
        return;
    };
    members.shift_remove("propertyNames");
    null_type(members);
    null_member(members);
    exclusive_bound(members, "exclusiveMinimum", "minimum");
    exclusive_bound(members, "exclusiveMaximum", "maximum");
    if let Some(constant) = members.shift_remove("const") {
        members.insert("enum".to_owned(), json!([constant]));
    }
    if let Some(Value::Array(examples)) = members.shift_remove("examples") {
        members.extend(
            examples
                .into_iter()
                .next()
                .map(|example| ("example".to_owned(), example)),
        );
    }
    lone_reference(members);
    for keyword in ["properties", "patternProperties"] {
        members
            .get_mut(keyword)
            .into_iter()
            .flat_map(children)
            .for_each(schema);
    }
    for keyword in ["items", "additionalProperties", "not"] {
        members.get_mut(keyword).into_iter().for_each(schema);
    }
    for keyword in ["oneOf", "anyOf", "allOf"] {
        members
            .get_mut(keyword)
            .into_iter()
            .flat_map(children)
            .for_each(schema);
    }
}

/// `type: [string, null]` → `type: string, nullable: true`.
fn null_type(members: &mut Map<String, Value>) {
    let Some(Value::Array(types)) = members.get("type") else {
        return;
    };
    let kept: Vec<Value> = types
        .iter()
        .filter(|name| *name != "null")
        .cloned()
        .collect();
    let is_nullable = kept.len() < types.len();
    if let [only] = kept.as_slice() {
        members.insert("type".to_owned(), only.clone());
    } else {
        members.shift_remove("type");
    }
    if is_nullable {
        members.insert("nullable".to_owned(), json!(true));
    }
}

/// `oneOf: [null, X]` → X, nullable.
fn null_member(members: &mut Map<String, Value>) {
    for keyword in ["oneOf", "anyOf"] {
        let Some(Value::Array(options)) = members.get(keyword) else {
            continue;
        };
        let kept: Vec<Value> = options
            .iter()
            .filter(|option| option["type"] != "null")
            .cloned()
            .collect();
        if kept.len() == options.len() {
            continue;
        }
        members.shift_remove(keyword);
        let keyword = if kept.len() == 1 { "allOf" } else { keyword };
        members.insert(keyword.to_owned(), Value::Array(kept));
        members.insert("nullable".to_owned(), json!(true));
    }
}

/// A bound is a number with a flag in 3.0.
fn exclusive_bound(members: &mut Map<String, Value>, exclusive: &str, bound: &str) {
    if let Some(limit) = members
        .get(exclusive)
        .filter(|limit| limit.is_number())
        .cloned()
    {
        members.insert(bound.to_owned(), limit);
        members.insert(exclusive.to_owned(), json!(true));
    }
}

/// In 3.0 whatever stands beside a reference is ignored; inside `allOf` it is not.
fn lone_reference(members: &mut Map<String, Value>) {
    if members.len() > 1
        && let Some(target) = members.shift_remove("$ref")
    {
        members.insert("allOf".to_owned(), json!([{"$ref": target}]));
    }
}

/// Schemas that only the removed operations named.
fn remove_unused(document: &mut Value) {
    let mut used = BTreeSet::new();
    let mut open = Vec::new();
    references(&document["paths"], &mut open);
    while let Some(name) = open.pop() {
        if let Some(found) = document.pointer(&format!("/components/schemas/{name}"))
            && used.insert(name)
        {
            references(found, &mut open);
        }
    }
    if let Some(schemas) = document
        .pointer_mut("/components/schemas")
        .and_then(Value::as_object_mut)
    {
        schemas.retain(|name, _| used.contains(name));
    }
}

fn references(value: &Value, found: &mut Vec<String>) {
    match value {
        Value::Object(members) => {
            found.extend(
                members
                    .get("$ref")
                    .and_then(Value::as_str)
                    .and_then(|target| target.strip_prefix(SCHEMAS))
                    .map(str::to_owned),
            );
            members.values().for_each(|child| references(child, found));
        }
        Value::Array(items) => items.iter().for_each(|child| references(child, found)),
        _ => {}
    }
}

/// The values inside an object or a list.
fn children(value: &mut Value) -> Box<dyn Iterator<Item = &mut Value> + '_> {
    match value {
        Value::Object(members) => Box::new(members.values_mut()),
        Value::Array(items) => Box::new(items.iter_mut()),
        _ => Box::new(std::iter::empty()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rewritten(mut value: Value) -> Value {
        schema(&mut value);
        value
    }

    #[test]
    fn null_becomes_nullable() {
        assert_eq!(
            rewritten(json!({"type": ["number", "null"]})),
            json!({"type": "number", "nullable": true})
        );
        let reference = json!({"$ref": "#/components/schemas/A"});
        assert_eq!(
            rewritten(json!({"oneOf": [{"type": "null"}, reference]})),
            json!({"allOf": [reference], "nullable": true})
        );
        let inside = json!({"type": "array", "items": {"type": ["string", "null"]}});
        assert_eq!(
            rewritten(inside),
            json!({"type": "array", "items": {"type": "string", "nullable": true}})
        );
    }

    #[test]
    fn what_may_be_null_has_a_type() {
        let kind = json!({"type": "string", "enum": ["a"]});
        let reference = json!({"$ref": "#/components/schemas/Kind"});
        let document = json!({
            "paths": {"/a": {"get": {"schema": {"oneOf": [{"type": "null"}, reference]}}}},
            "components": {"schemas": {"Kind": kind}}
        });
        let derived = derive(document);
        let expected = json!({"type": "string", "allOf": [reference], "nullable": true});
        assert_eq!(derived["paths"]["/a"]["get"]["schema"], expected);
    }

    #[test]
    fn bounds_constants_and_references_are_said_the_old_way() {
        let bound = json!({"type": "number", "exclusiveMinimum": 0.0});
        assert_eq!(
            rewritten(bound),
            json!({"type": "number", "exclusiveMinimum": true, "minimum": 0.0})
        );
        assert_eq!(
            rewritten(json!({"const": "a", "propertyNames": {}})),
            json!({"enum": ["a"]})
        );
        let described = json!({"$ref": "#/x", "description": "d"});
        assert_eq!(
            rewritten(described),
            json!({"description": "d", "allOf": [{"$ref": "#/x"}]})
        );
    }

    #[test]
    fn a_property_called_like_a_keyword_stays() {
        let value = json!({"type": "object", "properties": {"const": {"type": "string"}, "examples": {"type": "number"}}});
        assert_eq!(rewritten(value.clone()), value);
    }
}
