//! The API document: the files agree with the program, names are frozen, references resolve, examples are accepted.
//! `TRACKLOOM_WRITE_OPENAPI=1 cargo test --test openapi` writes the files.
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::path::Path;
use trackloom::experiment::{JobKind, plan};
use trackloom::service::openapi;

/// Clients have these names in their code: one may be added, none may change.
const OPERATIONS: [&str; 65] = [
    "beginSessionTrack",
    "cancelJob",
    "closeSession",
    "compareJobs",
    "createAssociateJob",
    "createCampaignJob",
    "createCorrelateJob",
    "createEvaluateJob",
    "createGroupJob",
    "createJob",
    "createKey",
    "createSession",
    "createSimulateJob",
    "deleteDataset",
    "deleteJob",
    "deleteSession",
    "downloadDataset",
    "downloadJobArtifact",
    "endSessionTrack",
    "getAccess",
    "getCampaignCells",
    "getDataset",
    "getHealth",
    "getJob",
    "getJobHistory",
    "getJobPlan",
    "getJobReport",
    "getJobReportPage",
    "getJobSeries",
    "getJobSpec",
    "getMethod",
    "getMetrics",
    "getPreset",
    "getProblemType",
    "getReadiness",
    "getSession",
    "getSessionHistory",
    "getSessionPicture",
    "getSessionTrack",
    "getUsage",
    "getVersion",
    "listDatasets",
    "listJobArtifacts",
    "listJobs",
    "listKeys",
    "listMethods",
    "listPresets",
    "listProblemTypes",
    "listSessionTracks",
    "listSessions",
    "login",
    "logout",
    "pauseSession",
    "previewDataset",
    "pushScans",
    "recordSession",
    "rerunJob",
    "resumeSession",
    "revokeKey",
    "streamJobEvents",
    "streamSessionEvents",
    "updateJob",
    "uploadDataset",
    "uploadRawDataset",
    "validateJob",
];

fn operations(document: &Value) -> Vec<&Value> {
    let paths = document["paths"].as_object().unwrap().values();
    paths
        .flat_map(|path| path.as_object().unwrap().values())
        .filter(|operation| operation.get("operationId").is_some())
        .collect()
}

fn ids(document: &Value) -> Vec<&str> {
    let mut ids: Vec<&str> = operations(document)
        .iter()
        .map(|operation| operation["operationId"].as_str().unwrap())
        .collect();
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
    for (name, document) in [
        ("openapi.json", openapi::document()),
        ("openapi-3.0.json", openapi::document_3_0()),
    ] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("openapi")
            .join(name);
        let text = format!("{}\n", serde_json::to_string_pretty(&document).unwrap());
        if std::env::var_os("TRACKLOOM_WRITE_OPENAPI").is_some() {
            std::fs::write(&path, &text).unwrap();
        }
        let stored = std::fs::read_to_string(&path).unwrap();
        assert!(
            stored == text,
            "openapi/{name} is not what the program says; write it with TRACKLOOM_WRITE_OPENAPI=1"
        );
    }
}

#[test]
fn the_names_of_operations_are_frozen() {
    let document = openapi::document();
    assert_eq!(ids(&document), OPERATIONS);
    let without_form: Vec<&str> = OPERATIONS
        .into_iter()
        .filter(|id| *id != "uploadDataset")
        .collect();
    assert_eq!(
        ids(&openapi::document_3_0()),
        without_form,
        "3.0 has all but the upload in parts"
    );
}

/// The second answer of an upload, which generators would not take for one.
const NAMED_IN_WORDS: &str = "Inspection";

#[test]
fn every_reference_resolves_and_every_schema_is_used() {
    for document in [openapi::document(), openapi::document_3_0()] {
        let mut references = Vec::new();
        every(&document, "$ref", &mut references);
        let targets: BTreeSet<&str> = references
            .iter()
            .map(|target| target.as_str().unwrap())
            .collect();
        assert!(targets.len() > 50);
        for target in &targets {
            let pointer = target.strip_prefix('#').unwrap();
            assert!(
                document
                    .pointer(pointer)
                    .is_some_and(|schema| !schema.is_null()),
                "{target}"
            );
        }
        for name in document["components"]["schemas"]
            .as_object()
            .unwrap()
            .keys()
            .filter(|name| *name != NAMED_IN_WORDS)
        {
            assert!(
                targets.contains(format!("#/components/schemas/{name}").as_str()),
                "{name} is not used"
            );
        }
    }
}

#[test]
fn operations_are_what_generators_understand() {
    for document in [openapi::document(), openapi::document_3_0()] {
        for operation in operations(&document) {
            let id = &operation["operationId"];
            assert_eq!(operation["tags"].as_array().map(Vec::len), Some(1), "{id}");
            assert!(
                operation["summary"]
                    .as_str()
                    .is_some_and(|text| text.len() > 5),
                "{id} has no summary"
            );
            assert!(
                operation["description"]
                    .as_str()
                    .is_some_and(|text| text.len() > 5),
                "{id} has no description"
            );
            let responses = operation["responses"].as_object().unwrap();
            assert!(
                responses.contains_key("4XX")
                    && responses.contains_key("5XX")
                    && !responses.contains_key("default"),
                "{id}"
            );
            let successes = responses
                .iter()
                .filter(|(status, _)| status.starts_with('2'));
            let media: BTreeSet<&String> = successes
                .filter_map(|(_, response)| response["content"].as_object())
                .flat_map(|content| content.keys())
                .collect();
            // Several types are one file: the type of any bytes stands first, which is the one that generators take.
            let is_file = operation
                .pointer("/responses/200/content")
                .and_then(Value::as_object)
                .and_then(|content| content.keys().next());
            assert!(
                media.len() <= 1 || is_file.unwrap() == "application/octet-stream",
                "{id} has several media types: {media:?}"
            );
            assert!(
                operation.get("parameters").is_none_or(Value::is_array),
                "{id}"
            );
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
        let is_request = name.ends_with("Request")
            || ["JobPatch", "DatasetMeta", "Scenario", "SensorSettings"].contains(&name.as_str());
        assert!(
            !is_request || schema["additionalProperties"] == false,
            "{name} takes unknown fields"
        );
        for option in schema["oneOf"].as_array().into_iter().flatten() {
            assert!(
                option.get("$ref").is_some(),
                "{name} has an option without a name"
            );
        }
    }
}

#[test]
fn the_older_copy_uses_no_newer_words() {
    let document = openapi::document_3_0();
    let text = document.to_string();
    for banned in [
        "multipart/form-data",
        "application/problem+json",
        "\"propertyNames\"",
        "\"identifier\"",
        "\"const\":",
        "\"null\"",
    ] {
        assert!(!text.contains(banned), "{banned}");
    }
    let mut types = Vec::new();
    every(&document["components"]["schemas"], "type", &mut types);
    assert!(types.iter().all(|found| !found.is_array()));
}

/// The statuses below 4XX and 5XX that an operation lists.
fn statuses<'a>(document: &'a Value, id: &str) -> Vec<&'a str> {
    let operation = operations(document)
        .into_iter()
        .find(|operation| operation["operationId"] == id)
        .unwrap();
    operation["responses"]
        .as_object()
        .unwrap()
        .keys()
        .map(String::as_str)
        .collect()
}

#[test]
fn an_operation_lists_every_status_that_it_may_answer() {
    let document = openapi::document();
    for (id, expected) in [
        (
            "createAssociateJob",
            &[
                "200", "202", "400", "401", "403", "406", "413", "415", "422", "429", "503", "507",
                "4XX", "5XX",
            ][..],
        ),
        (
            "uploadRawDataset",
            &[
                "200", "201", "401", "403", "406", "413", "415", "422", "429", "503", "507", "4XX",
                "5XX",
            ],
        ),
        (
            "deleteDataset",
            &[
                "204", "401", "403", "404", "406", "409", "410", "422", "429", "503", "4XX", "5XX",
            ],
        ),
        (
            "downloadJobArtifact",
            &[
                "200", "401", "403", "404", "406", "409", "410", "416", "422", "429", "503", "4XX",
                "5XX",
            ],
        ),
        (
            "getJobReport",
            &[
                "200", "401", "403", "404", "406", "409", "410", "416", "422", "429", "503", "4XX",
                "5XX",
            ],
        ),
        (
            "listJobs",
            &[
                "200", "400", "401", "403", "406", "422", "429", "503", "4XX", "5XX",
            ],
        ),
        (
            "getVersion",
            &["200", "401", "403", "406", "422", "429", "4XX", "5XX"],
        ),
    ] {
        assert_eq!(statuses(&document, id), expected, "{id}");
    }
    let conflict =
        &document["paths"]["/v1/jobs/{id}/report"]["get"]["responses"]["409"]["description"];
    assert_eq!(
        conflict,
        "`result_not_ready`: The job has no result yet. `job_failed`: The job ended without a result."
    );
}

#[test]
fn ids_are_of_one_type() {
    let document = openapi::document();
    let id = json!({"type": "string", "format": "uuid"});
    for place in [
        "DatasetInfo/properties/id",
        "DatasetSource/properties/dataset_id",
        "Job/properties/id",
        "JobSource/properties/job_id",
        "ArtifactInfo/properties/dataset_id",
        "ReportInput/properties/dataset_id",
        "Job/properties/depends_on/items",
    ] {
        let schema = document
            .pointer(&format!("/components/schemas/{place}"))
            .unwrap();
        assert_eq!(
            json!({"type": schema["type"], "format": schema["format"]}),
            id,
            "{place}"
        );
    }
}

#[test]
fn a_job_is_one_of_its_kinds_told_apart_by_kind() {
    for document in [openapi::document(), openapi::document_3_0()] {
        let schemas = &document["components"]["schemas"];
        let variants = schemas["JobSpec"]["oneOf"].as_array().unwrap();
        assert_eq!(variants.len(), JobKind::ALL.len());
        for (variant, kind) in variants.iter().zip(JobKind::ALL) {
            let spec = document
                .pointer(variant["$ref"].as_str().unwrap().trim_start_matches('#'))
                .unwrap();
            assert_eq!(
                spec["properties"]["kind"],
                json!({"type": "string", "enum": [kind.name()]})
            );
            assert!(
                spec["required"]
                    .as_array()
                    .unwrap()
                    .contains(&json!("kind"))
            );
            let report = format!(
                "{}Report",
                variant["$ref"]
                    .as_str()
                    .unwrap()
                    .rsplit('/')
                    .next()
                    .unwrap()
                    .trim_end_matches("Spec")
            );
            assert_eq!(&schemas[report]["properties"]["spec"], variant);
        }
        for path in ["/v1/jobs", "/v1/validate"] {
            let body = &document["paths"][path]["post"]["requestBody"]["content"]["application/json"]
                ["schema"];
            assert_eq!(
                body,
                &json!({"$ref": "#/components/schemas/JobSpec"}),
                "{path}"
            );
        }
    }
}

#[test]
fn the_members_of_a_union_say_in_themselves_which_they_are() {
    let document = openapi::document();
    let schemas = document["components"]["schemas"].as_object().unwrap();
    let mut seen = 0;
    for (name, union) in schemas {
        let members: Vec<&str> = union["oneOf"]
            .as_array()
            .into_iter()
            .flatten()
            .map(|member| member["$ref"].as_str().unwrap().rsplit('/').next().unwrap())
            .collect();
        let tag_of = |member: &str| {
            let properties = schemas[member]["properties"].as_object().unwrap();
            let is_tag = |property: &Value| {
                property["enum"]
                    .as_array()
                    .is_some_and(|values| values.len() == 1)
            };
            let tag = properties.iter().find(|(_, property)| is_tag(property));
            let (tag, property) = tag.unwrap_or_else(|| panic!("{member} of {name} has no tag"));
            assert!(
                schemas[member]["required"]
                    .as_array()
                    .unwrap()
                    .contains(&json!(tag)),
                "{member} of {name}"
            );
            (
                tag.clone(),
                property["enum"][0].as_str().unwrap().to_owned(),
            )
        };
        let tags: BTreeSet<(String, String)> =
            members.iter().map(|member| tag_of(member)).collect();
        assert_eq!(tags.len(), members.len(), "{name}: {tags:?}");
        seen += usize::from(!members.is_empty());
    }
    assert!(seen > 20, "only {seen} unions seen");
}

#[test]
fn a_default_is_told_and_makes_no_field_required() {
    let document = openapi::document();
    let mut found = Vec::new();
    every(&document, "default", &mut found);
    assert_eq!(found, [&Value::Null; 0]);
    let schemas = &document["components"]["schemas"];
    let told = |pointer: &str| {
        schemas.pointer(pointer).unwrap()["description"]
            .as_str()
            .unwrap()
            .to_owned()
    };
    assert_eq!(
        told("/AssociateRequest/properties/seed"),
        "Seed of every random number of the job. Default: `1`."
    );
    let associator =
        "How detections are given to tracks. Default: `{\"method\":\"nearest_neighbour\"}`.";
    assert_eq!(told("/AssociateSpec/properties/associator"), associator);
}

#[test]
fn the_names_of_problems_and_faults_are_told() {
    let document = openapi::document();
    let told = |schema: &str| {
        document["components"]["schemas"][schema]["properties"]["code"]["description"]
            .as_str()
            .unwrap()
            .to_owned()
    };
    for name in [
        "`malformed_json` (400)",
        "`validation` (422)",
        "`queue_full` (503)",
    ] {
        assert!(told("Problem").contains(name), "{name}");
    }
    for name in [
        "`missing`: something required is absent",
        "`disjoint`: times or places of two inputs do not meet",
    ] {
        assert!(told("FaultItem").contains(name), "{name}");
    }
}

#[test]
fn every_example_of_a_job_passes_the_checks() {
    let document = openapi::document();
    for kind in JobKind::ALL {
        let examples = &document["paths"][format!("/v1/jobs/{}", kind.name())]["post"]["requestBody"]
            ["content"]["application/json"]["examples"];
        let examples = examples.as_object().unwrap();
        assert!(!examples.is_empty());
        for (name, example) in examples {
            assert!(
                plan(kind, &example["value"]).is_ok(),
                "{} {name}: {:?}",
                kind.name(),
                plan(kind, &example["value"]).err()
            );
        }
    }
}
