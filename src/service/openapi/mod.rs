//! The API document (OpenAPI 3.1): routes and answers from the handlers, request bodies from the same tables that check
//! them. A copy in OpenAPI 3.0.3 is derived for generators that know no other.

mod bodies;
mod examples;
mod refusals;
mod version_3_0;

use super::http;
use super::keys::Need;
use super::types::{PROBLEMS, Problem};
use crate::experiment::inspect::Inspection;
use crate::experiment::{ARTIFACT_TYPES, JobKind};
use crate::formats::{FORMATS, WRITERS};
use crate::model::fault::FAULT_CODES;
use crate::registry::Components;
use bodies::{capital, request_bodies};
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;
use utoipa::{PartialSchema, ToSchema};

pub use examples::job_examples;

const TAGS: [(&str, &str); 7] = [
    ("jobs", "Ask for work, follow it, cancel it, run it again."),
    (
        "results",
        "What a job found: report, series, plan view, files.",
    ),
    (
        "datasets",
        "Recordings, truth and tracks: upload, look into, download.",
    ),
    (
        "sessions",
        "Trackers of live feeds: push scans, read tracks, follow events.",
    ),
    ("catalogue", "Methods with their parameters, and presets."),
    ("keys", "Who may do what, where the service asks for keys."),
    ("system", "Health, numbers, version, problems."),
];

/// The document in OpenAPI 3.1.
pub fn document() -> Value {
    let routes = http::routes().into_openapi();
    let mut document = serde_json::to_value(&routes).expect("the document is JSON");
    document["openapi"] = json!("3.1.0");
    document["info"] = info();
    document["servers"] = json!([{"url": "/", "description": "This service."}]);
    document["tags"] = TAGS
        .iter()
        .map(|(name, description)| json!({"name": name, "description": description}))
        .collect();
    let mut components = components(&document);
    let bodies = request_bodies(&mut components);
    JobKind::ALL
        .into_iter()
        .for_each(|kind| refer_to_spec(kind, &mut components));
    tell_codes(&mut components);
    let tags = take_tags(&mut components);
    document["components"] = json!({"schemas": components, "securitySchemes": security_schemes()});
    // None is needed where the service has no master key.
    document["security"] = json!([{}, {"key": []}, {"cookie": []}]);
    inline_tags(&mut document, &tags);
    let needs = http::needs();
    each_operation(&mut document, &mut |method, operation| {
        tell_need(operation, &needs);
        complete(operation, &bodies);
        refusals::add(operation, method != "get");
    });
    in_order(document)
}

/// The copy in OpenAPI 3.0.3.
pub fn document_3_0() -> Value {
    version_3_0::derive(document())
}

fn security_schemes() -> Value {
    json!({
        "key": {"type": "http", "scheme": "bearer", "description": "A key, or the master key."},
        "cookie": {"type": "apiKey", "in": "cookie", "name": http::COOKIE, "description": "Set by `login`, for pages."}
    })
}

fn info() -> Value {
    json!({
        "title": "trackloom",
        "version": env!("CARGO_PKG_VERSION"),
        "summary": env!("CARGO_PKG_DESCRIPTION"),
        "description": "Multi-target data association and its evaluation as queued jobs. Errors are problems (RFC 9457) that name every \
            fault at once. Times are RFC 3339 in UTC; quantities carry their unit in the name; x points east, y north.",
        "license": {"name": "MIT OR Apache-2.0", "identifier": "MIT OR Apache-2.0"}
    })
}

/// The schemas that the handlers name, with `Problem`, which every operation may answer, and `Inspection`, which no response names:
/// generators take one type for the success of an operation.
fn components(document: &Value) -> Components {
    let named = document
        .pointer("/components/schemas")
        .and_then(Value::as_object)
        .cloned()
        .unwrap_or_default();
    let mut components: Components = named.into_iter().collect();
    components.insert("Problem".to_owned(), json!(Problem::schema()));
    let mut inspected = vec![(Inspection::name().into_owned(), Inspection::schema())];
    Inspection::schemas(&mut inspected);
    for (name, schema) in inspected {
        components.insert(name, json!(schema));
    }
    components.insert(
        "FaultItem".to_owned(),
        json!(super::types::FaultItem::schema()),
    );
    components
}

/// The `spec` of a report is a job of its kind.
fn refer_to_spec(kind: JobKind, components: &mut Components) {
    let name = capital(kind);
    if let Some(spec) = components
        .get_mut(&format!("{name}Report"))
        .and_then(|schema| schema.pointer_mut("/properties/spec"))
    {
        *spec = reference(&format!("{name}Spec"));
    }
}

/// The schemas of one text: what tells the members of a union apart. Taken out, by the reference that names them.
fn take_tags(components: &mut Components) -> BTreeMap<String, Value> {
    let is_tag = |schema: &Value| {
        schema["type"] == "string"
            && schema["enum"]
                .as_array()
                .is_some_and(|values| values.len() == 1)
    };
    let (tags, rest): (Components, Components) = std::mem::take(components)
        .into_iter()
        .partition(|(_, schema)| is_tag(schema));
    *components = rest;
    tags.into_iter()
        .map(|(name, schema)| {
            (
                format!("#/components/schemas/{name}"),
                schema["enum"].clone(),
            )
        })
        .collect()
}

/// A tag stands in the member itself: behind a reference one generator does not look at its value, and takes the first
/// member for all.
fn inline_tags(value: &mut Value, tags: &BTreeMap<String, Value>) {
    match value {
        Value::Object(members) => {
            if let Some(tag) = members
                .get("$ref")
                .and_then(Value::as_str)
                .and_then(|target| tags.get(target))
            {
                members.shift_remove("$ref");
                members.insert("type".to_owned(), json!("string"));
                members.insert("enum".to_owned(), tag.clone());
            }
            members
                .values_mut()
                .for_each(|child| inline_tags(child, tags));
        }
        Value::Array(items) => items.iter_mut().for_each(|item| inline_tags(item, tags)),
        _ => {}
    }
}

/// The names of problems and of faults are told, and are no closed list: a later version may have more, and a client of an
/// earlier one still has to read its answers.
fn tell_codes(components: &mut Components) {
    let problems: Vec<String> = PROBLEMS
        .iter()
        .map(|(code, status, _)| format!("`{code}` ({status})"))
        .collect();
    let faults: Vec<String> = FAULT_CODES
        .iter()
        .map(|(code, meaning)| format!("`{code}`: {meaning}"))
        .collect();
    for (schema, codes) in [("Problem", problems), ("FaultItem", faults)] {
        if let Some(description) = components
            .get_mut(schema)
            .and_then(|schema| schema.pointer_mut("/properties/code/description"))
        {
            *description = json!(format!(
                "{} One of {}; there may be more.",
                description.as_str().unwrap_or_default(),
                codes.join(", ")
            ));
        }
    }
}

/// Adds what handlers do not say of an operation.
/// Which key an operation needs, in words: a scheme of keys has no scopes.
fn tell_need(operation: &mut Value, needs: &BTreeMap<String, Need>) {
    let id = operation["operationId"].as_str().unwrap_or_default();
    let words = match needs.get(id) {
        None | Some(Need::Nothing) => "Answers everybody.".to_owned(),
        Some(Need::AnyKey) => "Any key opens it, where keys are asked for.".to_owned(),
        Some(Need::Action(action)) => format!(
            "Needs a key that allows `{}`, where keys are asked for.",
            action.name()
        ),
    };
    let before = operation["description"].as_str().unwrap_or_default();
    let told = format!("{before}\n\n{words}");
    operation["description"] = json!(told.trim());
}

fn complete(operation: &mut Value, bodies: &BTreeMap<String, Value>) {
    let id = operation["operationId"]
        .as_str()
        .unwrap_or_default()
        .to_owned();
    if let Some(body) = bodies.get(&id) {
        operation["requestBody"] = body.clone();
    }
    if id == "uploadRawDataset" {
        operation["parameters"] = bodies::raw_upload_query();
    }
    for parameter in operation
        .get_mut("parameters")
        .and_then(Value::as_array_mut)
        .into_iter()
        .flatten()
    {
        never_null(&mut parameter["schema"]);
        refine(parameter);
    }
    name_file_types(operation);
}

/// A download answers in the type of its file. The type of any bytes stands first: generators take the first.
fn name_file_types(operation: &mut Value) {
    let written = WRITERS.iter().map(|writer| writer.media_type);
    let types: Vec<&str> = match operation["operationId"].as_str() {
        Some("downloadDataset") => {
            let read = FORMATS.iter().map(|format| format.media_type);
            read.chain(written).collect()
        }
        Some("downloadJobArtifact") => ARTIFACT_TYPES.into_iter().chain(written).collect(),
        _ => return,
    };
    let Some(content) = operation
        .pointer_mut("/responses/200/content")
        .and_then(Value::as_object_mut)
    else {
        return;
    };
    if let Some(file) = content.get("application/octet-stream").cloned() {
        content.extend(
            types
                .into_iter()
                .map(|media_type| (media_type.to_owned(), file.clone())),
        );
    }
}

/// A parameter that may be left out is still never null.
fn never_null(schema: &mut Value) {
    if let Some(types) = schema["type"].as_array_mut() {
        types.retain(|name| name != "null");
        if let [only] = types.as_slice() {
            schema["type"] = only.clone();
        }
    }
}

/// What a text of a parameter has to be.
fn refine(parameter: &mut Value) {
    let schema = match parameter["name"].as_str() {
        Some("created_after" | "created_before") => {
            json!({"type": "string", "format": "date-time"})
        }
        Some("Idempotency-Key") => json!({"type": "string", "minLength": 1, "maxLength": 255}),
        Some("Last-Event-ID") => {
            json!({"type": "integer", "format": "int64", "minimum": 0, "maximum": i64::MAX})
        }
        _ => return,
    };
    parameter["schema"] = schema;
}

fn reference(name: &str) -> Value {
    json!({"$ref": format!("#/components/schemas/{name}")})
}

/// Calls `change` for every operation of the document.
fn each_operation(document: &mut Value, change: &mut dyn FnMut(&str, &mut Value)) {
    let paths = document["paths"]
        .as_object_mut()
        .into_iter()
        .flat_map(Map::values_mut);
    let operations = paths.filter_map(Value::as_object_mut).flatten();
    operations
        .filter(|(_, operation)| operation.get("operationId").is_some())
        .for_each(|(method, operation)| change(method, operation));
}

/// The document with its parts in the usual order, whatever order they were made in.
fn in_order(mut document: Value) -> Value {
    let mut ordered = Map::new();
    for name in [
        "openapi",
        "info",
        "servers",
        "tags",
        "security",
        "paths",
        "components",
    ] {
        ordered.insert(name.to_owned(), document[name].take());
    }
    if let Some(paths) = ordered.get_mut("paths").and_then(Value::as_object_mut) {
        paths.sort_keys();
    }
    Value::Object(ordered)
}
