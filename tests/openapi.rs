//! The API document: the files agree with the program, names are frozen, references resolve, examples are accepted.
//! `TRACKLOOM_WRITE_OPENAPI=1 cargo test --test openapi` writes the files.
use serde_json::Value;
use std::collections::BTreeSet;
use std::path::Path;
use trackloom::experiment::plan::{JobKind, plan};
use trackloom::service::openapi;

/// Clients have these names in their code: one may be added, none may change.
const OPERATIONS: [&str; 38] = [
    "cancelJob",
    "compareJobs",
    "createAssociateJob",
    "createCampaignJob",
    "createCorrelateJob",
    "createEvaluateJob",
    "createGroupJob",
    "createSimulateJob",
    "deleteDataset",
    "deleteJob",
    "downloadDataset",
    "downloadJobArtifact",
    "getCampaignCells",
    "getDataset",
    "getHealth",
    "getJob",
    "getJobHistory",
    "getJobPlan",
    "getJobReport",
    "getJobSeries",
    "getJobSpec",
    "getMethod",
    "getMetrics",
    "getPreset",
    "getProblemType",
    "getReadiness",
    "getVersion",
    "listDatasets",
    "listJobArtifacts",
    "listJobs",
    "listMethods",
    "listPresets",
    "listProblemTypes",
    "previewDataset",
    "rerunJob",
    "streamJobEvents",
    "updateJob",
    "uploadDataset",
];

fn operations(document: &Value) -> Vec<&Value> {
    let paths = document["paths"].as_object().unwrap().values();
    paths.flat_map(|path| path.as_object().unwrap().values()).filter(|operation| operation.get("operationId").is_some()).collect()
}

fn ids(document: &Value) -> Vec<&str> {
    let mut ids: Vec<&str> = operations(document).iter().map(|operation| operation["operationId"].as_str().unwrap()).collect();
    ids.sort_unstable();
    ids
}

/// Every value of a member with this name, at any depth.
fn every<'a>(value: &'a Value, name: &str, found: &mut Vec<&'a Value>) {
    match value {
        Value::Object(members) => {
            found.extend(members.get(name));
            members.values().for_each(|child| every(child, name, found));
        }
        Value::Array(items) => items.iter().for_each(|child| every(child, name, found)),
        _ => {}
    }
}

#[test]
fn the_files_are_what_the_program_says() {
    for (name, document) in [("openapi.json", openapi::document()), ("openapi-3.0.json", openapi::document_3_0())] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("openapi").join(name);
        let text = format!("{}\n", serde_json::to_string_pretty(&document).unwrap());
        if std::env::var_os("TRACKLOOM_WRITE_OPENAPI").is_some() {
            std::fs::write(&path, &text).unwrap();
        }
        let stored = std::fs::read_to_string(&path).unwrap();
        assert!(stored == text, "openapi/{name} is not what the program says; write it with TRACKLOOM_WRITE_OPENAPI=1");
    }
}

#[test]
fn the_names_of_operations_are_frozen() {
    let document = openapi::document();
    let mut expected: Vec<&str> = OPERATIONS.into_iter().chain(["validateJob"]).collect();
    expected.sort_unstable();
    assert_eq!(ids(&document), expected);
    let without_upload: Vec<&str> = expected.into_iter().filter(|id| *id != "uploadDataset").collect();
    assert_eq!(ids(&openapi::document_3_0()), without_upload, "3.0 has all but the upload");
}

#[test]
fn every_reference_resolves_and_every_schema_is_used() {
    for document in [openapi::document(), openapi::document_3_0()] {
        let mut references = Vec::new();
        every(&document, "$ref", &mut references);
        let targets: BTreeSet<&str> = references.iter().map(|target| target.as_str().unwrap()).collect();
        assert!(targets.len() > 50);
        for target in &targets {
            let pointer = target.strip_prefix('#').unwrap();
            assert!(document.pointer(pointer).is_some_and(|schema| !schema.is_null()), "{target}");
        }
        for name in document["components"]["schemas"].as_object().unwrap().keys() {
            assert!(targets.contains(format!("#/components/schemas/{name}").as_str()), "{name} is not used");
        }
    }
}

#[test]
fn operations_are_what_generators_understand() {
    for document in [openapi::document(), openapi::document_3_0()] {
        for operation in operations(&document) {
            let id = &operation["operationId"];
            assert_eq!(operation["tags"].as_array().map(Vec::len), Some(1), "{id}");
            assert!(operation["summary"].as_str().is_some_and(|text| text.len() > 5), "{id} has no summary");
            assert!(operation["description"].as_str().is_some_and(|text| text.len() > 5), "{id} has no description");
            let responses = operation["responses"].as_object().unwrap();
            assert!(responses.contains_key("4XX") && responses.contains_key("5XX") && !responses.contains_key("default"), "{id}");
            let successes = responses.iter().filter(|(status, _)| status.starts_with('2'));
            let media: BTreeSet<&String> =
                successes.filter_map(|(_, response)| response["content"].as_object()).flat_map(|content| content.keys()).collect();
            assert!(media.len() <= 1, "{id} has several media types: {media:?}");
        }
    }
}

#[test]
fn schemas_avoid_what_generators_do_not_understand() {
    let document = openapi::document();
    for banned in ["discriminator", "prefixItems"] {
        let mut found = Vec::new();
        every(&document, banned, &mut found);
        assert_eq!(found, [&Value::Null; 0], "{banned}");
    }
    for (name, schema) in document["components"]["schemas"].as_object().unwrap() {
        let is_request = name.ends_with("Request") || ["JobPatch", "DatasetMeta", "Scenario", "SensorSettings"].contains(&name.as_str());
        assert!(!is_request || schema["additionalProperties"] == false, "{name} takes unknown fields");
        for option in schema["oneOf"].as_array().into_iter().flatten() {
            assert!(option.get("$ref").is_some(), "{name} has an option without a name");
        }
    }
}

#[test]
fn the_older_copy_uses_no_newer_words() {
    let document = openapi::document_3_0();
    let text = document.to_string();
    for banned in ["multipart/form-data", "application/problem+json", "\"propertyNames\"", "\"identifier\"", "\"const\":", "\"null\""] {
        assert!(!text.contains(banned), "{banned}");
    }
    let mut types = Vec::new();
    every(&document["components"]["schemas"], "type", &mut types);
    assert!(types.iter().all(|found| !found.is_array()));
}

#[test]
fn every_example_of_a_job_passes_the_checks() {
    let document = openapi::document();
    for kind in JobKind::ALL {
        let examples =
            &document["paths"][format!("/v1/jobs/{}", kind.name())]["post"]["requestBody"]["content"]["application/json"]["examples"];
        let examples = examples.as_object().unwrap();
        assert!(!examples.is_empty());
        for (name, example) in examples {
            assert!(plan(kind, &example["value"]).is_ok(), "{} {name}: {:?}", kind.name(), plan(kind, &example["value"]).err());
        }
    }
}
