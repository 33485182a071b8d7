//! The API document (OpenAPI 3.1): routes and answers from the handlers, request bodies from the same tables that check
//! them. A copy in OpenAPI 3.0.3 is derived for generators that know no other.

mod examples;
mod version_3_0;

use super::http;
use super::types::Problem;
use crate::experiment::catalogue;
use crate::experiment::plan::JobKind;
use crate::registry::{Components, Object, json_schema};
use crate::service::storage::blobs::sha256_hex;
use axum::body::Bytes;
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;
use utoipa::PartialSchema;

pub use examples::job_examples;

/// Both documents as they are served.
pub struct Documents {
    pub v3_1: Document,
    pub v3_0: Document,
}

pub struct Document {
    pub bytes: Bytes,
    pub sha256: String,
}

impl Documents {
    pub fn new() -> Self {
        Documents { v3_1: Document::new(&document()), v3_0: Document::new(&document_3_0()) }
    }
}

impl Default for Documents {
    fn default() -> Self {
        Documents::new()
    }
}

impl Document {
    fn new(value: &Value) -> Self {
        let bytes = Bytes::from(value.to_string());
        Document { sha256: sha256_hex(&bytes), bytes }
    }
}

const TAGS: [(&str, &str); 5] = [
    ("jobs", "Ask for work, follow it, cancel it, run it again."),
    ("results", "What a job found: report, series, plan view, files."),
    ("datasets", "Recordings, truth and tracks: upload, look into, download."),
    ("catalogue", "Methods with their parameters, and presets."),
    ("system", "Health, numbers, version, problems."),
];

/// The document in OpenAPI 3.1.
pub fn document() -> Value {
    let routes = http::routes().into_openapi();
    let mut document = serde_json::to_value(&routes).expect("the document is JSON");
    document["openapi"] = json!("3.1.0");
    document["info"] = info();
    document["servers"] = json!([{"url": "/", "description": "This service."}]);
    document["tags"] = TAGS.iter().map(|(name, description)| json!({"name": name, "description": description})).collect();
    let mut components = components(&document);
    let bodies = request_bodies(&mut components);
    for report in JobKind::ALL {
        refer_to_spec(report, &mut components);
    }
    document["components"] = json!({"schemas": components});
    each_operation(&mut document, &mut |operation| complete(operation, &bodies));
    in_order(document)
}

/// The copy in OpenAPI 3.0.3.
pub fn document_3_0() -> Value {
    version_3_0::derive(document())
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

/// The schemas that the handlers name, with `Problem`, which every operation may answer.
fn components(document: &Value) -> Components {
    let named = document.pointer("/components/schemas").and_then(Value::as_object).cloned().unwrap_or_default();
    let mut components: Components = named.into_iter().collect();
    components.insert("Problem".to_owned(), json!(Problem::schema()));
    components.insert("FaultItem".to_owned(), json!(super::types::FaultItem::schema()));
    components
}

/// Operation → its request body. Their schemas come from the tables that check requests, and go before what the
/// handlers say of the same name.
fn request_bodies(components: &mut Components) -> BTreeMap<String, Value> {
    let mut tables = Components::new();
    let mut bodies = BTreeMap::new();
    for kind in JobKind::ALL {
        let name = kind.name();
        let operation = format!("create{}{}Job", name[..1].to_uppercase(), &name[1..]);
        bodies.insert(operation, json_body(catalogue::request_object(kind), &job_examples(kind), &mut tables));
    }
    bodies.insert("updateJob".to_owned(), json_body(&http::PATCH, &examples::patch(), &mut tables));
    bodies.insert("uploadDataset".to_owned(), upload_body(&mut tables));
    components.append(&mut tables);
    components.insert("ValidateRequest".to_owned(), validate_request());
    bodies.insert("validateJob".to_owned(), with_examples(&reference("ValidateRequest"), &examples::validate()));
    bodies
}

fn json_body(object: &'static Object, examples: &[(&str, Value)], components: &mut Components) -> Value {
    with_examples(&json_schema(object, components), examples)
}

fn with_examples(schema: &Value, examples: &[(&str, Value)]) -> Value {
    let named: Map<String, Value> = examples
        .iter()
        .enumerate()
        .map(|(index, (summary, value))| (format!("example{}", index + 1), json!({"summary": summary, "value": value})))
        .collect();
    json!({"required": true, "content": {"application/json": {"schema": schema, "examples": named}}})
}

fn upload_body(components: &mut Components) -> Value {
    let meta = json_schema(&http::META, components);
    let upload = json!({
        "type": "object",
        "description": "Two parts.",
        "properties": {
            "meta": meta,
            "file": {"type": "string", "format": "binary", "description": "The file."}
        },
        "required": ["file"]
    });
    components.insert("DatasetUpload".to_owned(), upload);
    let encoding = json!({"meta": {"contentType": "application/json"}});
    json!({"required": true, "content": {"multipart/form-data": {"schema": reference("DatasetUpload"), "encoding": encoding}}})
}

/// Its `spec` is any object: what is wrong with it is what the caller wants to hear.
fn validate_request() -> Value {
    json!({
        "type": "object",
        "description": "A request to check.",
        "properties": {
            "kind": reference("JobKind"),
            "spec": {"type": "object", "additionalProperties": true, "description": "The body that a job of this kind would get."}
        },
        "required": ["kind", "spec"],
        "additionalProperties": false
    })
}

/// The `spec` of a report is the request of its kind.
fn refer_to_spec(kind: JobKind, components: &mut Components) {
    let request = catalogue::request_object(kind).name;
    let report = request.replace("Request", "Report");
    if let Some(spec) = components.get_mut(&report).and_then(|schema| schema.pointer_mut("/properties/spec")) {
        *spec = reference(request);
    }
}

/// Adds what all operations share, and the request body.
fn complete(operation: &mut Value, bodies: &BTreeMap<String, Value>) {
    let id = operation["operationId"].as_str().unwrap_or_default().to_owned();
    if let Some(body) = bodies.get(&id) {
        operation["requestBody"] = body.clone();
    }
    for parameter in operation["parameters"].as_array_mut().into_iter().flatten() {
        never_null(&mut parameter["schema"]);
    }
    for (range, description) in [("4XX", "The request is refused."), ("5XX", "The service cannot do it.")] {
        let content = json!({"application/problem+json": {"schema": reference("Problem")}});
        operation["responses"][range] = json!({"description": description, "content": content});
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

fn reference(name: &str) -> Value {
    json!({"$ref": format!("#/components/schemas/{name}")})
}

/// Calls `change` for every operation of the document.
fn each_operation(document: &mut Value, change: &mut dyn FnMut(&mut Value)) {
    let paths = document["paths"].as_object_mut().into_iter().flat_map(Map::values_mut);
    let operations = paths.filter_map(Value::as_object_mut).flat_map(Map::values_mut);
    operations.filter(|operation| operation.get("operationId").is_some()).for_each(change);
}

/// The document with its parts in the usual order, whatever order they were made in.
fn in_order(mut document: Value) -> Value {
    let mut ordered = Map::new();
    for name in ["openapi", "info", "servers", "tags", "paths", "components"] {
        ordered.insert(name.to_owned(), document[name].take());
    }
    if let Some(paths) = ordered.get_mut("paths").and_then(Value::as_object_mut) {
        paths.sort_keys();
    }
    Value::Object(ordered)
}
