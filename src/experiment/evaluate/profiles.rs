//! Profiles: the metrics that a kind of user expects, when the request does not list any.

use super::metrics as judge;
use crate::evaluation::metrics::METRIC;
use crate::experiment::associate;
use crate::experiment::plan::{self, InputRequest};
use crate::model::fault::Fault;
use crate::registry::{self, Kind};
use serde_json::{Value, json};

/// Fills `metrics` from the profile where truth will be there, and refuses metrics that are asked for without truth or of
/// tracks that will be directions.
pub fn fill_metrics(spec: &mut Value, inputs: &[InputRequest], faults: &mut Vec<Fault>) {
    let has_truth = plan::knows_truth(spec, inputs);
    let is_of_bearings =
        associate::filter_of(spec).is_ok_and(|(filter, _)| filter.is_of_bearings());
    match spec.get("metrics").and_then(Value::as_array).map(Vec::len) {
        Some(listed) if listed > 0 && !has_truth && !inputs.is_empty() => {
            faults.push(Fault::new(
                "/truth",
                "missing",
                "'truth' is required when metrics are asked for",
            ));
        }
        Some(_)
            if is_of_bearings
                && !spec["metrics"]
                    .as_array()
                    .is_some_and(|bodies| bodies.iter().all(judge::accepts_bearings)) =>
        {
            let detail = "most metrics compare places in metres; this filter makes directions, which the automaton judges";
            faults
                .push(Fault::new("/metrics", "unsupported", detail).allowing(judge::FOR_BEARINGS));
        }
        None if spec.get("metrics").is_none() => {
            let metrics = match (has_truth, is_of_bearings) {
                (false, _) => Vec::new(),
                (true, false) => metrics_of(spec),
                (true, true) => metrics_of_bearings(spec),
            };
            spec["metrics"] = Value::Array(metrics);
        }
        _ => {}
    }
}

/// Tracks that begin at the truth carry the names of their targets.
fn metrics_of_bearings(spec: &Value) -> Vec<Value> {
    let is_named = spec.pointer("/tracker/initiation/method") == Some(&json!("truth"))
        && spec["profile"] == "tracking";
    let body = json!({"metric": "track_keeping"});
    if is_named {
        vec![registry::check_field(&body, &ENTRY, "", &mut Vec::new())]
    } else {
        Vec::new()
    }
}

static ENTRY: Kind = Kind::Union(&METRIC);

fn metrics_of(spec: &Value) -> Vec<Value> {
    let gate_m = &spec["comparison"]["gate_m"];
    let bodies = match spec["profile"].as_str() {
        Some("tracking") => vec![
            json!({"metric": "gospa", "cutoff_m": gate_m}),
            json!({"metric": "ospa", "cutoff_m": gate_m}),
            json!({"metric": "siap"}),
            json!({"metric": "clear"}),
            json!({"metric": "assignment"}),
            json!({"metric": "kinematics"}),
        ],
        Some("vision") => vec![
            json!({"metric": "hota"}),
            json!({"metric": "clear"}),
            json!({"metric": "identity"}),
        ],
        _ => Vec::new(),
    };
    // The gate was checked where the request gave it.
    bodies
        .iter()
        .map(|body| registry::check_field(body, &ENTRY, "", &mut Vec::new()))
        .collect()
}

/// What boxes are judged by where the plan, which has not seen them, took the metrics of `tracking`.
pub fn metrics_of_boxes(spec: &Value) -> Option<Value> {
    let is_default =
        spec["profile"] == "tracking" && spec["metrics"] == Value::Array(metrics_of(spec));
    let mut of_boxes = json!({"profile": "vision"});
    of_boxes["comparison"] = spec["comparison"].clone();
    is_default.then(|| Value::Array(metrics_of(&of_boxes)))
}

/// Whether the automaton is part of the job.
pub fn wants_automaton(spec: &Value) -> bool {
    spec.get("sequences").is_none() && (spec.get("tfa").is_some() || spec["profile"] != "vision")
}
