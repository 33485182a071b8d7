//! The report of a job for the terminal.

use crate::experiment::text::{
    campaign, cell, correlation, judged, metrics, requirements, shares, table,
};
use serde_json::Value;

/// The lines of a report that people read first.
pub(super) fn summary(report: &Value) -> String {
    let result = &report["result"];
    let head = head_line(report);
    let mut rows = Vec::new();
    let mut add = |name: String, unit: &str, value: &Value| {
        if !value.is_array() && !value.is_object() {
            rows.push(vec![name, unit.to_owned(), cell(value)]);
        }
    };
    for (part, name) in [
        (
            "/counts",
            if result.get("tuples").is_some() {
                "correlation"
            } else {
                "simulation"
            },
        ),
        ("/truth", "truth"),
        ("/association/counts", "association"),
        ("/tfa/counts", "tfa"),
        ("/events/counts", "event"),
    ] {
        for (key, value) in result
            .pointer(part)
            .and_then(Value::as_object)
            .into_iter()
            .flatten()
        {
            add(format!("{name} {}", key.replace('_', " ")), "", value);
        }
    }
    for (name, value) in shares(result) {
        add(name, "", value);
    }
    for (key, value) in report["timing"].as_object().into_iter().flatten() {
        // A step that the job does not have took no time.
        if value.as_f64() != Some(0.0) {
            add(format!("time {}", key.trim_end_matches("_s")), "s", value);
        }
    }
    let head = match judged(result) {
        Some(judged) => format!("{head}\n{judged}"),
        None => head,
    };
    let mut text = format!(
        "{head}

{}",
        table(&["quantity", "unit", "value"], &rows)
    );
    if let Some(metrics) = metrics(result) {
        text = format!("{text}\n\n{metrics}");
    }
    if let Some(requirements) = requirements(result) {
        text = format!("{text}\n\n{requirements}");
    }
    if let Some(correlation) = correlation(result) {
        text = format!("{text}\n\n{correlation}");
    }
    if let Some(campaign) = campaign(report) {
        text = format!("{text}\n\n{campaign}");
    }
    for warning in report["warnings"].as_array().into_iter().flatten() {
        text.push_str(&format!("\nwarning: {}", cell(warning)));
    }
    text
}

/// What the figures are of: `evaluate, seed 1: preset liang2009-10; nearest_neighbour, kalman; trackloom 0.1.0`.
fn head_line(report: &Value) -> String {
    let spec = &report["spec"];
    // A campaign's job stands in its base.
    let job = spec.get("base").unwrap_or(spec);
    let sources = ["input", "detections", "truth", "tracks"]
        .iter()
        .filter_map(|role| source(&job[*role]))
        .collect::<Vec<_>>();
    let methods = ["associator", "filter", "grouper", "correlator"]
        .iter()
        .filter_map(|family| job[*family]["method"].as_str());
    let parts = [
        sources.join(" and "),
        methods.collect::<Vec<_>>().join(", "),
        format!("trackloom {}", cell(&report["engine_version"])),
    ];
    let parts: Vec<_> = parts.into_iter().filter(|part| !part.is_empty()).collect();
    format!(
        "{}, seed {}: {}",
        cell(&report["kind"]),
        cell(&report["seed"]),
        parts.join("; ")
    )
}

fn source(source: &Value) -> Option<String> {
    match source["source"].as_str()? {
        "file" => source["path"].as_str().map(str::to_owned),
        "preset" => source["preset"]
            .as_str()
            .map(|name| format!("preset {name}")),
        other => Some(other.to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn the_head_line_names_job_input_methods_and_program() {
        let report = json!({
            "kind": "evaluate", "seed": 7, "engine_version": "0.1.0",
            "spec": {
                "input": {"source": "file", "path": "radar.csv"},
                "truth": {"source": "file", "path": "truth.csv"},
                "associator": {"method": "jpda"},
                "filter": {"method": "kalman"}
            }
        });
        assert_eq!(
            head_line(&report),
            "evaluate, seed 7: radar.csv and truth.csv; jpda, kalman; trackloom 0.1.0"
        );
        let campaign = json!({
            "kind": "campaign", "seed": 1, "engine_version": "0.1.0",
            "spec": {"base": {"input": {"source": "preset", "preset": "liang2009-10"}, "associator": {"method": "pda"}}}
        });
        assert_eq!(
            head_line(&campaign),
            "campaign, seed 1: preset liang2009-10; pda; trackloom 0.1.0"
        );
    }
}
