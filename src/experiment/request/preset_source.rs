//! A preset as the source of a job: its scenario is the job's input, and how it tracks is what the request leaves open.

use super::scenario::SCENARIO;
use crate::experiment::presets::{self, Preset};
use crate::model::fault::Fault;
use crate::registry::{self, Kind, Object};
use serde_json::{Map, Value, json};
use std::borrow::Cow;

/// The settings of a preset that go with its scenario.
const BROUGHT: [&str; 5] = ["detector", "sensors", "associator", "filter", "tracker"];

static SCENARIO_KIND: Kind = Kind::Object(&SCENARIO);

/// The tags of the unions among them.
const TAGS: [&str; 3] = ["method", "rule", "kind"];

/// The body with the settings that its preset brings: those of the fields that a request of this table has. What the body says itself
/// stays, field by field; a method of another name is another method, and takes nothing of the preset's.
pub fn with_settings<'b>(object: &Object, body: &'b Value) -> Cow<'b, Value> {
    let (Some(preset), Some(fields)) = (find_preset(body), body.as_object()) else {
        return Cow::Borrowed(body);
    };
    let settings = preset.body.get("base").unwrap_or(&preset.body);
    let mut filled = fields.clone();
    for name in BROUGHT
        .into_iter()
        .filter(|name| object.fields.iter().any(|field| field.name == *name))
    {
        if let Some(brought) = settings.get(name) {
            let given = filled.get(name).cloned();
            filled.insert(
                name.to_owned(),
                given.map_or_else(|| brought.clone(), |given| merge(given, brought)),
            );
        }
    }
    Cow::Owned(Value::Object(filled))
}

/// What was given, with what it leaves open.
fn merge(given: Value, brought: &Value) -> Value {
    let (Value::Object(mut given), Value::Object(brought)) = (given.clone(), brought) else {
        return given;
    };
    if TAGS.iter().any(|tag| differs(&given, brought, tag)) {
        return Value::Object(given);
    }
    for (name, value) in brought {
        let own = given.get(name).cloned();
        given.insert(
            name.clone(),
            own.map_or_else(|| value.clone(), |own| merge(own, value)),
        );
    }
    Value::Object(given)
}

fn differs(given: &Map<String, Value>, brought: &Map<String, Value>, tag: &str) -> bool {
    given
        .get(tag)
        .is_some_and(|own| brought.get(tag).is_some_and(|other| own != other))
}

fn find_preset(body: &Value) -> Option<Preset> {
    body.pointer("/input/preset")
        .and_then(Value::as_str)
        .and_then(presets::find)
}

/// Replaces `{"source":"preset"}` by the preset's scenario, so that a stored spec says all.
pub fn write_out(spec: &mut Value, faults: &mut Vec<Fault>) {
    let Some(name) = spec.pointer("/input/preset").and_then(Value::as_str) else {
        return;
    };
    // The scenario of a campaign is that of its base.
    let places = ["/input/scenario", "/base/input/scenario"];
    let scenario = presets::find(name).and_then(|preset| {
        places
            .iter()
            .find_map(|place| preset.body.pointer(place).cloned())
    });
    match scenario {
        Some(scenario) => {
            let checked =
                registry::check_field(&scenario, &SCENARIO_KIND, "/input/scenario", faults);
            spec["input"] = json!({"source": "scenario", "scenario": checked});
        }
        None => {
            let known = presets::all()
                .into_iter()
                .map(|preset| preset.name)
                .collect::<Vec<_>>()
                .join(", ");
            faults.push(
                Fault::new(
                    "/input/preset",
                    "unknown_value",
                    format!("unknown preset \"{name}\""),
                )
                .allowing(known),
            );
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::{JobKind, plan};

    fn plan_preset(kind: JobKind, mut body: Value) -> Value {
        body["input"] = json!({"source": "preset", "preset": body["input"]});
        plan(kind, &body).unwrap().spec
    }

    #[test]
    fn a_preset_brings_how_it_tracks() {
        let preset = presets::find("liang2009-30").unwrap();
        let whole = plan(preset.kind, &preset.body).unwrap().spec;
        let brought = plan_preset(JobKind::Evaluate, json!({"input": "liang2009-30"}));
        for part in ["input", "associator", "filter", "tracker"] {
            assert_eq!(brought[part], whole[part], "{part}");
        }
        assert_eq!(brought["tracker"]["initial_speed_sigma_mps"], 430.0);
        let campaign = plan_preset(JobKind::Associate, json!({"input": "wang-bat-6"}));
        assert_eq!(campaign["filter"]["method"], "bearing_only");
        assert_eq!(campaign["tracker"]["initiation"]["method"], "truth");
    }

    #[test]
    fn what_the_request_says_wins_field_by_field() {
        let body = json!({
            "input": "liang2009-polar-30", "filter": {"method": "unscented"}, "associator": {"method": "jpda"},
            "tracker": {"initiation": {"max_wait_scans": 2}, "max_missed": 3}
        });
        let spec = plan_preset(JobKind::Associate, body);
        assert_eq!(
            (&spec["filter"]["method"], &spec["filter"]["kappa"]),
            (&json!("unscented"), &json!(0.0))
        );
        assert_eq!(spec["associator"]["method"], "jpda");
        assert_eq!(
            spec["tracker"]["initiation"],
            json!({"method": "two_point", "max_speed_mps": 1000.0, "max_wait_scans": 2})
        );
        assert_eq!(
            (
                &spec["tracker"]["max_missed"],
                &spec["tracker"]["gate_probability"]
            ),
            (&json!(3), &json!(0.999))
        );
        let own = plan_preset(
            JobKind::Associate,
            json!({"input": "liang2009-polar-30", "tracker": {"initiation": {"method": "one_point"}}}),
        );
        assert_eq!(own["tracker"]["initiation"], json!({"method": "one_point"}));
    }

    #[test]
    fn jobs_without_a_tracker_take_the_scenario_alone() {
        let spec = plan_preset(
            JobKind::Group,
            json!({"input": "cai-fuzzy-cv-10", "grouper": {"method": "nearest_neighbour"}}),
        );
        assert!(spec.get("tracker").is_none());
        // Its sensors say nothing of their places: what is left open is filled in as in a scenario of one's own.
        assert_eq!(
            spec.pointer("/input/scenario/sensors/0/x_m"),
            Some(&json!(0.0))
        );
    }
}
