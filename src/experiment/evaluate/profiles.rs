//! Profiles: the metrics that a kind of user expects, when the request does not list any.

use super::spec::METRICS_OF_BEARINGS;
use crate::evaluation::metrics::{BuildMetric, METRIC};
use crate::experiment::associate::check::named_filter;
use crate::experiment::job::InputRequest;
use crate::experiment::request::draft::{Draft, parse};
use crate::experiment::request::methods::Choice;
use crate::model::fault::Fault;
use crate::model::space::Space;
use crate::registry::{self, Kind};
use serde_json::{Value, json};

static ENTRY: Kind = Kind::Union(&METRIC);

/// Fills `metrics` from the profile where truth will be there, and refuses metrics that are asked for without truth or of
/// tracks that will be directions.
pub fn fill_metrics(draft: &mut Draft, inputs: &[InputRequest]) {
    let has_truth = draft.knows_truth(inputs);
    let are_places = named_filter(draft).is_none_or(|named| named.filter.space().has_places());
    match draft.length_of("metrics") {
        Some(listed) if listed > 0 && !has_truth && !inputs.is_empty() => {
            let detail = "'truth' is required when metrics are asked for";
            draft.add([Fault::new("/truth", "missing", detail)]);
        }
        Some(listed) if !are_places && !all_accept_bearings(draft, listed) => {
            let detail = "this metric compares places in metres, and this filter makes directions";
            draft
                .add([Fault::new("/metrics", "unsupported", detail).allowing(METRICS_OF_BEARINGS)]);
        }
        None if !draft.has("metrics") => {
            let metrics = match (has_truth, are_places) {
                (false, _) => Vec::new(),
                (true, true) => metrics_of(draft.text_at("/profile"), gate_m(draft)),
                (true, false) => metrics_of_bearings(draft),
            };
            draft.put("metrics", Value::Array(metrics));
        }
        _ => {}
    }
}

fn all_accept_bearings(draft: &Draft, listed: usize) -> bool {
    (0..listed).all(|index| {
        draft
            .read::<Choice<BuildMetric>>(&format!("/metrics/{index}"))
            .is_some_and(|metric| accepts_bearings(&metric))
    })
}

/// Whether this metric is one of [`METRICS_OF_BEARINGS`].
pub fn accepts_bearings(metric: &Choice<BuildMetric>) -> bool {
    metric.build().accepts(Some(Space::Bearing))
}

/// Tracks that begin at the truth carry the names of their targets.
fn metrics_of_bearings(draft: &Draft) -> Vec<Value> {
    let is_named = draft.text_at("/tracker/initiation/method") == Some("truth");
    match draft.text_at("/profile") {
        Some("tracking") if is_named => check_all(&[json!({"metric": "track_keeping"})]),
        Some("tracking") => check_all(&[json!({"metric": "clear"})]),
        Some("vision") => metrics_of(Some("vision"), &Value::Null),
        _ => Vec::new(),
    }
}

/// As the request gives it, for the numbers of a stored spec are those of the request.
fn gate_m(draft: &Draft) -> &Value {
    draft.at("/comparison/gate_m").unwrap_or(&Value::Null)
}

fn metrics_of(profile: Option<&str>, gate_m: &Value) -> Vec<Value> {
    match profile {
        Some("tracking") => check_all(&[
            json!({"metric": "gospa", "cutoff_m": gate_m}),
            json!({"metric": "ospa", "cutoff_m": gate_m}),
            json!({"metric": "siap"}),
            json!({"metric": "clear"}),
            json!({"metric": "assignment"}),
            json!({"metric": "kinematics"}),
        ]),
        Some("vision") => check_all(&[
            json!({"metric": "hota"}),
            json!({"metric": "clear"}),
            json!({"metric": "identity"}),
        ]),
        _ => Vec::new(),
    }
}

/// With their defaults. The gate was checked where the request gave it.
fn check_all(bodies: &[Value]) -> Vec<Value> {
    bodies
        .iter()
        .map(|body| registry::check_field(body, &ENTRY, "", &mut Vec::new()))
        .collect()
}

/// What boxes are judged by where the plan, which has not seen them, took the metrics of `tracking`.
pub fn metrics_of_boxes(draft: &Draft) -> Option<Vec<Choice<BuildMetric>>> {
    let profile = draft
        .text_at("/profile")
        .filter(|name| *name == "tracking")?;
    let taken = Value::Array(metrics_of(Some(profile), gate_m(draft)));
    let is_default = draft.at("/metrics") == Some(&taken);
    is_default.then(|| parse(&Value::Array(metrics_of(Some("vision"), &Value::Null))))
}
