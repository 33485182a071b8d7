//! Checks of a request that no table holds: what does not go together.

use crate::association::bat;
use crate::experiment::associate;
use crate::experiment::plan::{InputRequest, knows_truth};
use crate::model::fault::Fault;
use crate::model::names::name_fault;
use crate::tracking::{Initiation, Lifecycle};
use serde::Deserialize;
use serde_json::{Value, json};

/// What the fields are called whose texts name things in tables. The name of the whole job is in none.
const NAMES: [&str; 3] = ["truth_id", "sensor_id", "name"];

/// Names that a file could not have are refused in requests, too.
pub fn check_names(value: &Value, pointer: &str, faults: &mut Vec<Fault>) {
    let entries: Vec<(String, &Value)> = match value {
        Value::Object(fields) => fields
            .iter()
            .map(|(name, value)| (name.replace('~', "~0").replace('/', "~1"), value))
            .collect(),
        Value::Array(items) => items
            .iter()
            .enumerate()
            .map(|(index, item)| (index.to_string(), item))
            .collect(),
        _ => return,
    };
    for (name, value) in entries {
        let pointer_of_entry = format!("{pointer}/{name}");
        let is_name = NAMES.contains(&name.as_str())
            && pointer_of_entry != "/name"
            && !pointer.ends_with("/labels");
        if let Some(found) = value.as_str().filter(|_| is_name).and_then(name_fault) {
            faults.push(
                Fault::new(pointer_of_entry, found.code, found.detail).allowing(found.allowed),
            );
        } else {
            check_names(value, &pointer_of_entry, faults);
        }
    }
}

/// Settings of one sensor stand in one place.
pub fn check_sensors(spec: &Value, faults: &mut Vec<Fault>) {
    let names: Vec<Option<&str>> = spec
        .get("sensors")
        .and_then(Value::as_array)
        .into_iter()
        .flatten()
        .map(|sensor| sensor["sensor_id"].as_str())
        .collect();
    for (index, name) in names.iter().enumerate() {
        if let Some(name) = name.filter(|_| names[..index].contains(name)) {
            let fault = Fault::new(
                format!("/sensors/{index}/sensor_id"),
                "duplicate",
                format!("sensor '{name}' is set twice"),
            );
            faults.push(fault.allowing("each sensor_id once"));
        }
    }
}

pub fn check_lifecycle(spec: &Value, faults: &mut Vec<Fault>) {
    let Some(Ok(lifecycle)) = spec.get("tracker").map(Lifecycle::deserialize) else {
        return;
    };
    check_directions(spec, &lifecycle, faults);
    if lifecycle.gate_probability == 1.0 {
        check_without_gate(spec, &lifecycle, faults);
    }
    check_budget(spec, faults);
    if lifecycle.confirm_hits > lifecycle.confirm_window {
        let detail = format!(
            "{} detections cannot be found in {} scans",
            lifecycle.confirm_hits, lifecycle.confirm_window
        );
        let fault = Fault::new("/tracker/confirm_hits", "out_of_range", detail);
        faults.push(fault.allowing(format!(
            "[1, {}] (confirm_window)",
            lifecycle.confirm_window
        )));
    }
}

/// Without a gate nothing is counted in it and no pair is out of its reach.
fn check_without_gate(spec: &Value, lifecycle: &Lifecycle, faults: &mut Vec<Fault>) {
    let mut refuse = |pointer: &str, detail: &str, allowed: &str| {
        faults.push(Fault::new(pointer, "unsupported", detail).allowing(allowed))
    };
    if spec.pointer("/associator/clutter") == Some(&json!("nonparametric")) {
        refuse(
            "/associator/clutter",
            "the detections of a gate are counted, and gate_probability 1 is no gate",
            "parametric",
        );
    }
    if let Initiation::TwoPoint { .. } = lifecycle.initiation {
        refuse(
            "/tracker/initiation/method",
            "two points are paired within a gate, and gate_probability 1 is no gate",
            "one_point, truth",
        );
    }
}

/// A search that would never end in a tracker is refused.
fn check_budget(spec: &Value, faults: &mut Vec<Fault>) {
    let number = |name: &str| spec["associator"][name].as_u64().unwrap_or(1);
    let (population, iterations) = (number("population"), number("iterations"));
    if spec["associator"]["method"] == "bat" && population * iterations > bat::MAX_MOVES {
        let detail = format!(
            "{population} bats that move {iterations} times are {} moves a cluster",
            population * iterations
        );
        faults.push(
            Fault::new("/associator/iterations", "too_large", detail)
                .allowing(format!("population × iterations up to {}", bat::MAX_MOVES)),
        );
    }
}

/// Tracks that begin at the truth need it.
pub fn check_start(spec: &Value, inputs: &[InputRequest], faults: &mut Vec<Fault>) {
    if spec.pointer("/tracker/initiation/method") == Some(&json!("truth"))
        && !inputs.is_empty()
        && !knows_truth(spec, inputs)
    {
        faults.push(
            Fault::new(
                "/truth",
                "missing",
                "'truth' is required where tracks begin at it",
            )
            .allowing("truth, or an input that knows it"),
        );
    }
}

/// A filter of directions knows neither speeds nor positions.
fn check_directions(spec: &Value, lifecycle: &Lifecycle, faults: &mut Vec<Fault>) {
    let Some(name) = spec.pointer("/filter/method").and_then(Value::as_str) else {
        return;
    };
    if !associate::filter_of(spec).is_ok_and(|(filter, _)| filter.is_of_bearings()) {
        return;
    }
    let mut refuse = |pointer: &str, needs: &str, allowed: &str| {
        let detail = format!("this needs {needs}, which the filter '{name}' does not know");
        faults.push(Fault::new(pointer, "unsupported", detail).allowing(allowed));
    };
    if let Initiation::TwoPoint { .. } = lifecycle.initiation {
        refuse("/tracker/initiation/method", "speeds", "one_point, truth");
    }
    if lifecycle.max_position_sigma_m.is_some() {
        refuse("/tracker/max_position_sigma_m", "positions", "no value");
    }
}
