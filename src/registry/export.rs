//! Descriptions as JSON Schema (draft 2020-12, the dialect of OpenAPI 3.1). Unions become a plain `oneOf` of named
//! schemas, each with its tag as a one-value enum: the one shape that every client generator we tried understands.

use super::check::range_text;
use super::{Bound, Field, Kind, Object, Presence, Union};
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;

/// Named schemas, as they stand under `components/schemas`.
pub type Components = BTreeMap<String, Value>;

/// Adds the schema of `object`, and of everything it names, to `components`; returns a reference to it.
pub fn json_schema(object: &'static Object, components: &mut Components) -> Value {
    add_object(object, object.name.to_owned(), None, components)
}

/// The same of an object that a union tells apart by `tag`, a required field with one value, under a name of its own.
pub fn tagged_schema(
    object: &'static Object,
    name: String,
    tag: (&str, &str),
    components: &mut Components,
) -> Value {
    add_object(object, name, Some(tag), components)
}

/// The schema of `object` by itself: what it names stands under `$defs`.
pub fn standalone_schema(object: &'static Object) -> Value {
    let mut components = Components::new();
    json_schema(object, &mut components);
    let mut schema = components.remove(object.name).unwrap_or_default();
    schema["$schema"] = json!("https://json-schema.org/draft/2020-12/schema");
    schema["title"] = json!(object.name);
    if !components.is_empty() {
        schema["$defs"] = json!(components);
    }
    point_to_definitions(&mut schema);
    schema
}

/// Turns references into a document's components into references into `$defs`.
fn point_to_definitions(schema: &mut Value) {
    match schema {
        Value::Object(members) => {
            if let Some(Value::String(target)) = members.get_mut("$ref") {
                *target = target.replace("#/components/schemas/", "#/$defs/");
            }
            members.values_mut().for_each(point_to_definitions);
        }
        Value::Array(items) => items.iter_mut().for_each(point_to_definitions),
        _ => {}
    }
}

fn add_object(
    object: &'static Object,
    name: String,
    tag: Option<(&str, &str)>,
    components: &mut Components,
) -> Value {
    if !components.contains_key(&name) {
        components.insert(name.clone(), Value::Null);
        let schema = object_schema(object, tag, components);
        components.insert(name.clone(), schema);
    }
    json!({"$ref": format!("#/components/schemas/{name}")})
}

fn object_schema(
    object: &'static Object,
    tag: Option<(&str, &str)>,
    components: &mut Components,
) -> Value {
    let mut properties = Map::new();
    let mut required = Vec::new();
    if let Some((tag, value)) = tag {
        properties.insert(tag.to_owned(), json!({"type": "string", "enum": [value]}));
        required.push(tag);
    }
    for field in object.fields {
        properties.insert(field.name.to_owned(), field_schema(field, components));
        if matches!(field.presence, Presence::Required) {
            required.push(field.name);
        }
    }
    let mut schema = json!({"type": "object", "description": object.summary, "properties": properties, "additionalProperties": false});
    if !required.is_empty() {
        schema["required"] = json!(required);
    }
    schema
}

fn field_schema(field: &'static Field, components: &mut Components) -> Value {
    let mut schema = kind_schema(&field.kind, components);
    schema["description"] = json!(field.summary);
    if let Presence::Default(text) = field.presence {
        schema["default"] = serde_json::from_str(text)
            .expect("defaults in the tables are JSON; a test reads them all");
    }
    schema
}

fn kind_schema(kind: &'static Kind, components: &mut Components) -> Value {
    match kind {
        Kind::Number { min, max, unit } => number_schema(*min, *max, unit),
        Kind::Integer { min, max, unit } => with_unit(
            json!({"type": "integer", "format": "int64", "minimum": min, "maximum": max}),
            unit,
        ),
        Kind::Text { max_length } => json!({"type": "string", "maxLength": max_length}),
        Kind::Id => json!({"type": "string", "format": "uuid"}),
        Kind::Choice(names) => json!({"type": "string", "enum": names}),
        Kind::Json => json!({}),
        Kind::Flag => json!({"type": "boolean"}),
        Kind::Object(object) => json_schema(object, components),
        Kind::Union(union) => add_union(union, components),
        Kind::List { item, min, max } => {
            json!({"type": "array", "items": kind_schema(item, components), "minItems": min, "maxItems": max})
        }
        Kind::TextMap {
            max_entries,
            max_length,
        } => {
            json!({"type": "object", "additionalProperties": {"type": "string", "maxLength": max_length}, "maxProperties": max_entries})
        }
    }
}

fn add_union(union: &'static Union, components: &mut Components) -> Value {
    if !components.contains_key(union.name) {
        components.insert(union.name.to_owned(), Value::Null);
        let mut member = |variant: &super::Variant| {
            add_object(
                variant.object,
                variant.object.name.to_owned(),
                Some((union.tag, variant.tag)),
                components,
            )
        };
        let members: Vec<Value> = (union.variants)().iter().map(&mut member).collect();
        components.insert(
            union.name.to_owned(),
            json!({"description": union.summary, "oneOf": members}),
        );
    }
    json!({"$ref": format!("#/components/schemas/{}", union.name)})
}

fn number_schema(min: Bound, max: Bound, unit: &str) -> Value {
    let mut schema = json!({"type": "number", "format": "double"});
    for (bound, including, excluding) in [
        (min, "minimum", "exclusiveMinimum"),
        (max, "maximum", "exclusiveMaximum"),
    ] {
        match bound {
            Bound::None => {}
            Bound::Including(value) => schema[including] = json!(value),
            Bound::Excluding(value) => schema[excluding] = json!(value),
        }
    }
    schema["x-allowed"] = json!(range_text(min, max, unit));
    with_unit(schema, unit)
}

fn with_unit(mut schema: Value, unit: &str) -> Value {
    if !unit.is_empty() {
        schema["x-unit"] = json!(unit);
    }
    schema
}

#[cfg(test)]
mod tests {
    use super::super::Variant;
    use super::*;

    static LIMIT: Object = Object {
        name: "Limit",
        summary: "A limit.",
        fields: &[Field {
            name: "range_m",
            summary: "Range.",
            kind: Kind::Number {
                min: Bound::Excluding(0.0),
                max: Bound::Including(9.0),
                unit: "m",
            },
            presence: Presence::Required,
        }],
    };
    static CHOICE: Union = Union {
        name: "Choice",
        summary: "",
        tag: "by",
        variants: || {
            vec![Variant {
                tag: "limit",
                object: &LIMIT,
            }]
        },
    };
    static JOB: Object = Object {
        name: "Job",
        summary: "A job.",
        fields: &[Field {
            name: "choice",
            summary: "How.",
            kind: Kind::Union(&CHOICE),
            presence: Presence::Optional,
        }],
    };

    #[test]
    fn a_union_is_one_of_named_objects_with_their_tag_as_a_one_value_enum() {
        let mut components = Components::new();
        assert_eq!(
            json_schema(&JOB, &mut components),
            json!({"$ref": "#/components/schemas/Job"})
        );
        assert_eq!(
            components["Choice"]["oneOf"],
            json!([{"$ref": "#/components/schemas/Limit"}])
        );
        let limit = &components["Limit"];
        assert_eq!(limit["required"], json!(["by", "range_m"]));
        assert_eq!(
            limit["properties"]["by"],
            json!({"type": "string", "enum": ["limit"]})
        );
        assert_eq!(
            limit["properties"]["range_m"]["exclusiveMinimum"],
            json!(0.0)
        );
        assert_eq!(limit["properties"]["range_m"]["maximum"], json!(9.0));
        assert_eq!(limit["additionalProperties"], json!(false));
    }

    #[test]
    fn a_standalone_schema_refers_to_its_own_definitions() {
        let schema = standalone_schema(&JOB);
        assert_eq!(schema["properties"]["choice"]["$ref"], "#/$defs/Choice");
        assert_eq!(
            schema["$defs"]["Choice"]["oneOf"][0]["$ref"],
            "#/$defs/Limit"
        );
    }
}
