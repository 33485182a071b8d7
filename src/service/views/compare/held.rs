//! Limits and requirements of two results: which are met in one and not in the other, and which way a requirement is better.

use super::Side;
use crate::evaluation::metrics::direction::higher_is_better;
use serde_json::Value;
use std::collections::BTreeMap;

const VALUES: &str = "requirements.values";

/// Of each limit and threshold that the baseline meets, its name, and whether the other result, which holds it too, meets it.
pub fn kept_limits(baseline: &Side, other: &Side) -> Vec<(String, bool)> {
    let ours = checks(other);
    let kept = |check: &Value| Some((name_of(check), *ours.get(&name_of(check))?));
    let theirs = baseline.result.pointer("/limits/checks");
    let theirs = theirs.and_then(Value::as_array).into_iter().flatten();
    theirs
        .filter(|check| check["met"] == true)
        .filter_map(kept)
        .collect()
}

fn checks(side: &Side) -> BTreeMap<String, bool> {
    let checks = side.result.pointer("/limits/checks");
    let checks = checks.and_then(Value::as_array).into_iter().flatten();
    checks
        .map(|check| (name_of(check), check["met"] == true))
        .collect()
}

/// `clear.recall, at least 0.8 in JPDA`: limits of one number with other bounds are others.
fn name_of(check: &Value) -> String {
    let mut name = check["quantity"].as_str().unwrap_or_default().to_owned();
    for (bound, words) in [("at_least", "at least"), ("at_most", "at most")] {
        if let Some(value) = check[bound].as_f64() {
            name.push_str(&format!(", {words} {value}"));
        }
    }
    if let Some(cell) = check["cell"].as_str() {
        name.push_str(&format!(" in {cell}"));
    }
    name
}

/// Values of requirements by their paths.
pub(super) fn values_of(result: &Value) -> impl Iterator<Item = (String, f64)> {
    let sectors = result
        .pointer("/requirements/values")
        .and_then(Value::as_object);
    sectors.into_iter().flatten().flat_map(|(sector, values)| {
        let values = values.as_object().into_iter().flatten();
        values.filter_map(move |(name, value)| {
            Some((
                format!("{VALUES}.{sector}.{name}"),
                value["value"].as_f64()?,
            ))
        })
    })
}

/// Which way a number at a path of the result is better: of a requirement as its threshold says, else as its name does.
pub(super) fn better(path: &str, spec: &Value) -> Option<bool> {
    let Some(rest) = path.strip_prefix(VALUES) else {
        return higher_is_better(path);
    };
    if rest.ends_with(".met") {
        return Some(true);
    }
    let name = rest.strip_suffix(".value").unwrap_or(rest);
    let name = name.rsplit('.').next().unwrap_or(name);
    let counted = name
        .rsplit_once('_')
        .filter(|(_, count)| count.parse::<u32>().is_ok());
    let name = counted.map_or(name, |(plain, _)| plain);
    let items = spec
        .get("base")
        .unwrap_or(spec)
        .pointer("/requirements/items");
    let mut items = items.and_then(Value::as_array).into_iter().flatten();
    let item = items.find(|item| item["name"] == name || item["requirement"] == name);
    let has = |item: &Value, bounds: [&str; 2]| bounds.iter().any(|bound| item[*bound].is_number());
    match item {
        Some(item) if has(item, ["at_least", "above"]) => Some(true),
        Some(item) if has(item, ["at_most", "below"]) => Some(false),
        Some(item) => requirement_is_better_high(item["requirement"].as_str()?),
        None => requirement_is_better_high(name),
    }
}

/// By the kind of a requirement, or by the name that a preset gave it (`mode_a_correct`).
fn requirement_is_better_high(kind: &str) -> Option<bool> {
    const HIGH: [&str; 12] = [
        "detection",
        "position_within",
        "along",
        "across",
        "latency",
        "radar_range",
        "radar_azimuth",
        "code_present",
        "speed",
        "course",
        "longest_track",
        "initiation_delay",
    ];
    const LOW: [&str; 9] = [
        "long_gaps",
        "position_beyond",
        "position_rms",
        "position_percentile",
        "extra_data",
        "extra_track",
        "false_updates",
        "false_tracks",
        "dubious_tracks",
    ];
    let ends = |endings: &[&str]| endings.iter().any(|ending| kind.ends_with(ending));
    if HIGH.contains(&kind) || ends(&["_correct", "_update"]) {
        return Some(true);
    }
    let is_low = LOW.contains(&kind) || kind == "continuity" || ends(&["_false"]);
    is_low.then_some(false)
}
