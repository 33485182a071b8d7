//! The report of a job for the terminal.

use crate::experiment::text::{campaign, cell, correlation, metrics, table};
use serde_json::Value;

/// The lines of a report that people read first.
pub(super) fn summary(report: &Value) -> String {
    let result = &report["result"];
    let mut rows = Vec::new();
    let mut add = |name: String, unit: &str, value: &Value| {
        if !value.is_array() && !value.is_object() {
            rows.push(vec![name, unit.to_owned(), cell(value)]);
        }
    };
    for (part, name) in [
        ("/counts", if result.get("tuples").is_some() { "correlation" } else { "simulation" }),
        ("/truth", "truth"),
        ("/association/counts", "association"),
        ("/tfa/counts", "tfa"),
        ("/tfa/probability", "tfa probability"),
        ("/events/counts", "event"),
    ] {
        for (key, value) in result.pointer(part).and_then(Value::as_object).into_iter().flatten() {
            add(format!("{name} {}", key.replace('_', " ")), "", value);
        }
    }
    for (key, value) in report["timing"].as_object().into_iter().flatten() {
        add(format!("time {}", key.trim_end_matches("_s")), "s", value);
    }
    let mut text = table(&["quantity", "unit", "value"], &rows);
    if let Some(metrics) = metrics(result) {
        text = format!("{text}\n\n{metrics}");
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
