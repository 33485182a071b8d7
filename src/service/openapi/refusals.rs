//! With which problems each operation may refuse: from what it takes, and from what it does.

use super::reference;
use crate::service::keys::OPEN;
use crate::service::types::PROBLEMS;
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;

/// Operations that ask no database.
const FIXED: [&str; 7] = [
    "getHealth",
    "getVersion",
    "getProblemType",
    "listMethods",
    "getMethod",
    "listPresets",
    "getPreset",
];

/// What the work of an operation is refused for, besides what its parameters and its body are refused for.
const OF_WORK: [(&str, &[&str]); 38] = [
    ("beginSessionTrack", SESSION),
    ("cancelJob", &["job_terminal"]),
    (
        "compareJobs",
        &["not_found", "gone", "result_not_ready", "job_failed"],
    ),
    ("createAssociateJob", NEW_JOB),
    ("createCampaignJob", NEW_JOB),
    ("createCorrelateJob", NEW_JOB),
    ("createEvaluateJob", NEW_JOB),
    ("createGroupJob", NEW_JOB),
    ("createJob", NEW_JOB),
    (
        "closeSession",
        &[
            "session_closed",
            "session_elsewhere",
            "shutting_down",
            "insufficient_storage",
        ],
    ),
    ("createSession", &["shutting_down", "insufficient_storage"]),
    ("createSimulateJob", NEW_JOB),
    ("deleteDataset", &["in_use"]),
    ("deleteJob", &["job_active", "in_use"]),
    ("deleteSession", &["session_elsewhere"]),
    ("endSessionTrack", SESSION),
    ("getSessionHistory", SESSION),
    ("getSessionPicture", SESSION),
    ("getSessionTrack", SESSION),
    ("listSessionTracks", SESSION),
    ("pauseSession", SESSION),
    ("pushScans", SESSION_PUSH),
    ("resumeSession", SESSION),
    (
        "recordSession",
        &["session_closed", "shutting_down", "insufficient_storage"],
    ),
    ("streamJobEvents", &["too_many_streams"]),
    ("streamSessionEvents", SESSION),
    ("streamSessionEvents", &["too_many_streams"]),
    ("downloadDataset", &["range_not_satisfiable"]),
    (
        "downloadJobArtifact",
        &["result_not_ready", "job_failed", "range_not_satisfiable"],
    ),
    ("getCampaignCells", RESULT),
    ("getJobPlan", RESULT),
    (
        "getJobReport",
        &["result_not_ready", "job_failed", "range_not_satisfiable"],
    ),
    ("getJobReportPage", RESULT),
    ("getJobSeries", RESULT),
    ("getReadiness", &["shutting_down"]),
    ("listJobArtifacts", RESULT),
    ("login", &["unauthenticated", "too_many_requests"]),
    (
        "rerunJob",
        &["queue_full", "shutting_down", "insufficient_storage"],
    ),
];

const NEW_JOB: &[&str] = &[
    "idempotency_mismatch",
    "queue_full",
    "shutting_down",
    "insufficient_storage",
];
const SESSION: &[&str] = &["session_closed", "session_elsewhere", "session_full"];
const SESSION_PUSH: &[&str] = &[
    "insufficient_storage",
    "session_closed",
    "session_paused",
    "session_elsewhere",
    "session_full",
    "unsupported_media_type",
    "payload_too_large",
];
const RESULT: &[&str] = &["result_not_ready", "job_failed"];

/// Adds the problems of an operation to its answers: each status with the codes it may have, then the ranges, for what a
/// proxy or a later version answers. Pages of other sites may read, and change nothing.
pub fn add(operation: &mut Value, is_change: bool) {
    let mut by_status: BTreeMap<u16, Vec<String>> = BTreeMap::new();
    let mut codes = codes(operation);
    if is_change {
        codes.push("cross_site");
    }
    for (code, status, title) in PROBLEMS.iter().filter(|(code, ..)| codes.contains(code)) {
        by_status
            .entry(*status)
            .or_default()
            .push(format!("`{code}`: {title}."));
    }
    let content = json!({"application/problem+json": {"schema": reference("Problem")}});
    let Some(responses) = operation["responses"].as_object_mut() else {
        return;
    };
    for (status, titles) in by_status {
        responses.insert(
            status.to_string(),
            json!({"description": titles.join(" "), "content": content}),
        );
    }
    for (range, description) in [
        ("4XX", "The request is refused."),
        ("5XX", "The service cannot do it."),
    ] {
        responses.insert(
            range.to_owned(),
            json!({"description": description, "content": content}),
        );
    }
}

fn codes(operation: &Value) -> Vec<&'static str> {
    let id = operation["operationId"].as_str().unwrap_or_default();
    // Every route refuses a query that it does not know, a host that it is not, and a client that cannot read the answer.
    let mut codes = vec!["validation", "foreign_host", "not_acceptable"];
    codes.extend(of_parameters(
        operation["parameters"]
            .as_array()
            .map_or(&[], Vec::as_slice),
    ));
    codes.extend(
        operation
            .pointer("/requestBody/content")
            .and_then(Value::as_object)
            .map_or(&[][..], of_body),
    );
    codes.extend(
        OF_WORK
            .iter()
            .filter(|(name, _)| *name == id)
            .flat_map(|(_, codes)| *codes),
    );
    if !OPEN.contains(&id) {
        codes.extend(["unauthenticated", "forbidden", "too_many_requests"]);
    }
    if !FIXED.contains(&id) {
        codes.push("unavailable");
    }
    codes
}

fn of_parameters(parameters: &[Value]) -> Vec<&'static str> {
    let is_there = |place: &str, name: Option<&str>| {
        parameters.iter().any(|parameter| {
            parameter["in"] == place && name.is_none_or(|name| parameter["name"] == name)
        })
    };
    let mut codes = Vec::new();
    if is_there("path", None) {
        codes.push("not_found");
    }
    if is_there("path", Some("id")) {
        codes.push("gone");
    }
    if is_there("query", Some("cursor")) {
        codes.push("invalid_cursor");
    }
    codes
}

fn of_body(content: &Map<String, Value>) -> &'static [&'static str] {
    const FILE: &[&str] = &[
        "payload_too_large",
        "unsupported_media_type",
        "shutting_down",
        "insufficient_storage",
    ];
    const FORM: &[&str] = &[
        "malformed_json",
        "payload_too_large",
        "unsupported_media_type",
        "shutting_down",
        "insufficient_storage",
    ];
    const JSON: &[&str] = &[
        "malformed_json",
        "payload_too_large",
        "unsupported_media_type",
    ];
    match content.keys().next().map(String::as_str) {
        Some("application/json") => JSON,
        Some("multipart/form-data") => FORM,
        _ => FILE,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_code_is_a_problem_that_there_is() {
        let codes = OF_WORK.iter().flat_map(|(_, codes)| *codes);
        for code in codes.chain(of_body(&Map::new())).chain(&of_parameters(&[])) {
            assert!(PROBLEMS.iter().any(|(known, ..)| known == code), "{code}");
        }
    }
}
