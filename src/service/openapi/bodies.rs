//! What requests carry: bodies, and the query of a raw upload. Their schemas come from the tables that check requests.

use super::{examples, reference};
use crate::experiment::session::{HAND_TRACK, PUSHED_SCAN, SESSION};
use crate::experiment::{self, JobKind};
use crate::registry::{Components, Object, json_schema, tagged_schema};
use crate::service::http;
use crate::service::jobs::JOB_PATCH;
use crate::service::keys::KEY;
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;

/// Operation → its request body. The schemas that they name are added to `components`, in the place of what the handlers
/// say of the same name.
pub fn request_bodies(components: &mut Components) -> BTreeMap<String, Value> {
    let mut tables = Components::new();
    let mut bodies = BTreeMap::new();
    for kind in JobKind::ALL {
        let schema = request_schema(kind, &mut tables);
        bodies.insert(
            format!("create{}Job", capital(kind)),
            with_examples(&schema, &examples::job_examples(kind)),
        );
    }
    add_specs(&mut tables);
    bodies.insert(
        "createJob".to_owned(),
        with_examples(&reference("JobSpec"), &examples::jobs()),
    );
    bodies.insert(
        "validateJob".to_owned(),
        with_examples(&reference("JobSpec"), &examples::jobs()),
    );
    bodies.insert(
        "updateJob".to_owned(),
        with_examples(&json_schema(&JOB_PATCH, &mut tables), &examples::patch()),
    );
    bodies.insert(
        "createSession".to_owned(),
        with_examples(&json_schema(&SESSION, &mut tables), &examples::session()),
    );
    bodies.insert(
        "beginSessionTrack".to_owned(),
        with_examples(
            &json_schema(&HAND_TRACK, &mut tables),
            &examples::hand_track(),
        ),
    );
    // Several scans in lines are told in words: generators leave out an operation whose body has a type that they do not know.
    bodies.insert(
        "pushScans".to_owned(),
        with_examples(&json_schema(&PUSHED_SCAN, &mut tables), &examples::scan()),
    );
    for (operation, table, example) in [
        ("createKey", &KEY, examples::key()),
        ("login", &http::LOGIN, examples::login()),
    ] {
        let schema = json_schema(table, &mut tables);
        bodies.insert(operation.to_owned(), with_examples(&schema, &example));
    }
    bodies.insert("uploadDataset".to_owned(), upload_body(&mut tables));
    bodies.insert("uploadRawDataset".to_owned(), raw_body());
    tables.values_mut().for_each(tell_defaults);
    components.append(&mut tables);
    bodies
}

/// `Simulate` of `simulate`.
pub fn capital(kind: JobKind) -> String {
    let (first, rest) = kind.name().split_at(1);
    format!("{}{rest}", first.to_uppercase())
}

/// The body at the path of a kind, where the kind need not be said again.
fn request_schema(kind: JobKind, tables: &mut Components) -> Value {
    let object = experiment::request_object(kind);
    let schema = json_schema(object, tables);
    if let Some(properties) = tables
        .get_mut(object.name)
        .and_then(|request| request["properties"].as_object_mut())
    {
        let description = "Need not be said here; a job file has it.";
        properties.insert(
            "kind".to_owned(),
            json!({"type": "string", "enum": [kind.name()], "description": description}),
        );
    }
    schema
}

/// `JobSpec`: a job of any kind, with its kind.
fn add_specs(tables: &mut Components) {
    let mut add = |kind: JobKind| {
        let object: &'static Object = experiment::request_object(kind);
        tagged_schema(
            object,
            format!("{}Spec", capital(kind)),
            ("kind", kind.name()),
            tables,
        )
    };
    let variants: Vec<Value> = JobKind::ALL.into_iter().map(&mut add).collect();
    let description = "A job: the body of a request with its kind. The same text is a job file of `trackloom run`.";
    tables.insert(
        "JobSpec".to_owned(),
        json!({"description": description, "oneOf": variants}),
    );
}

/// A default becomes part of the description: generators take a property with the keyword `default` for one that is always
/// there, and one of a union they do not understand.
fn tell_defaults(schema: &mut Value) {
    for property in schema
        .get_mut("properties")
        .and_then(Value::as_object_mut)
        .into_iter()
        .flat_map(Map::values_mut)
    {
        if let Some(default) = property
            .as_object_mut()
            .and_then(|members| members.shift_remove("default"))
        {
            let description = property["description"].as_str().unwrap_or_default();
            property["description"] = json!(format!("{description} Default: `{default}`."));
        }
    }
}

fn with_examples(schema: &Value, examples: &[(&str, Value)]) -> Value {
    let named: Map<String, Value> = examples
        .iter()
        .enumerate()
        .map(|(index, (summary, value))| {
            (
                format!("example{}", index + 1),
                json!({"summary": summary, "value": value}),
            )
        })
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

/// The types of the formats are taken too; clients are generated for one.
fn raw_body() -> Value {
    let file = json!({"type": "string", "format": "binary"});
    json!({"required": true, "description": "The file.", "content": {"application/octet-stream": {"schema": file}}})
}

/// The query of a raw upload: members of the meta, and what the file was called.
pub fn raw_upload_query() -> Value {
    let mut components = Components::new();
    json_schema(&http::META, &mut components);
    let meta = &components[http::META.name]["properties"];
    let mut parameters = Vec::new();
    for name in http::TEXTS {
        let mut schema = meta[name].clone();
        let description = schema
            .as_object_mut()
            .and_then(|members| members.shift_remove("description"));
        parameters.push(query_parameter(
            name,
            description.unwrap_or_default(),
            schema,
        ));
    }
    for name in http::json_texts() {
        let description = format!(
            "{} Written as JSON, as `{name}` of DatasetMeta.",
            meta[name]["description"].as_str().unwrap_or_default()
        );
        parameters.push(query_parameter(
            name,
            json!(description),
            json!({"type": "string"}),
        ));
    }
    let file_name = json!({"type": "string", "maxLength": http::MAX_FILE_NAME});
    parameters.push(query_parameter(
        "file_name",
        json!("What the file is called where it comes from."),
        file_name,
    ));
    parameters.push(query_parameter(
        "dry_run",
        json!("Only look at the file: the answer is an `Inspection`."),
        json!({"type": "boolean"}),
    ));
    Value::Array(parameters)
}

fn query_parameter(name: &str, description: Value, schema: Value) -> Value {
    json!({"name": name, "in": "query", "description": description, "required": false, "schema": schema})
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_default_is_told_and_no_keyword() {
        let mut schema = json!({"properties": {"default": {"type": "number", "description": "Ratio.", "default": 0.5}, "a": {"type": "string"}}});
        tell_defaults(&mut schema);
        let expected = json!({"properties": {"default": {"type": "number", "description": "Ratio. Default: `0.5`."}, "a": {"type": "string"}}});
        assert_eq!(schema, expected);
    }
}
