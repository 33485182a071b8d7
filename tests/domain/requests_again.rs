//! The normalised spec of every request that is accepted is accepted again, as the same spec: what is stored of a job can
//! be posted. Over the presets, changed at random places.

use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use serde_json::{Value, json};
use std::cell::Cell;
use trackloom_domain::experiment::{JobKind, plan, presets};

/// Requests to change: every preset as it is, normalised, and normalised without what the plan fills in again.
fn bases() -> Vec<(JobKind, Value)> {
    let mut bases = Vec::new();
    for preset in presets::all() {
        let spec = plan(preset.kind, &preset.body)
            .unwrap_or_else(|faults| panic!("{}: {faults:?}", preset.name))
            .spec;
        let mut bare = spec.clone();
        if let Some(members) = bare.as_object_mut() {
            members.retain(|name, _| !["metrics", "tfa"].contains(&name.as_str()));
        }
        bases.extend([preset.body, spec, bare].map(|body| (preset.kind, body)));
    }
    bases.push((JobKind::Evaluate, json!({"input": {"source": "preset", "preset": "liang2009-10"}, "comparison": {"gate_m": 100.0}})));
    bases
}

/// Every place of a value.
fn places(value: &Value, pointer: String, found: &mut Vec<String>) {
    match value {
        Value::Object(members) => members
            .iter()
            .for_each(|(name, child)| places(child, format!("{pointer}/{name}"), found)),
        Value::Array(items) => items
            .iter()
            .enumerate()
            .for_each(|(index, child)| places(child, format!("{pointer}/{index}"), found)),
        _ => {}
    }
    found.push(pointer);
}

/// What may stand at a place instead; `None` takes it away.
fn replacement(old: &Value, choice: usize) -> Option<Value> {
    let number = old.as_f64().unwrap_or(1.0);
    let others = [
        Some(json!(number * 1e9)),
        Some(json!(number * 1e-12)),
        Some(json!(-number)),
        Some(json!(number + 0.5)),
        Some(json!(2 * number as i64)),
        Some(json!(0)),
        Some(json!(1)),
        Some(json!(1e7)),
        Some(json!(1e-3)),
        Some(json!({})),
        Some(json!([])),
        None,
    ];
    others[choice % others.len()].clone()
}

fn change(body: &mut Value, place: usize, choice: usize) {
    let mut found = Vec::new();
    places(body, String::new(), &mut found);
    let pointer = &found[place % found.len()];
    let Some(old) = body.pointer(pointer) else {
        return;
    };
    match (replacement(old, choice), pointer.rsplit_once('/')) {
        (Some(value), _) => *body.pointer_mut(pointer).unwrap() = value,
        (None, Some((parent, name))) => {
            if let Some(members) = body.pointer_mut(parent).and_then(Value::as_object_mut) {
                members.shift_remove(name);
            }
        }
        (None, None) => {}
    }
}

/// Plans changed requests, and again what comes of those that are accepted. Returns how many were.
fn check(cases: u32, bases: &[(JobKind, Value)]) -> u32 {
    let accepted = Cell::new(0);
    let config = ProptestConfig {
        cases,
        rng_seed: RngSeed::Fixed(1),
        failure_persistence: None,
        ..ProptestConfig::default()
    };
    let changes = prop::collection::vec((any::<usize>(), any::<usize>()), 0..3);
    proptest!(config, |(base in 0..bases.len(), changes in changes)| {
        let (kind, mut body) = bases[base].clone();
        for (place, choice) in changes {
            change(&mut body, place, choice);
        }
        if let Ok(first) = plan(kind, &body) {
            accepted.set(accepted.get() + 1);
            match plan(kind, &first.spec) {
                Ok(again) => prop_assert_eq!(again.spec, first.spec),
                Err(faults) => prop_assert!(false, "{}: accepted {}, but not its spec: {:?}", kind.name(), body, faults),
            }
        }
    });
    accepted.get()
}

#[test]
fn a_stored_request_is_accepted_again_as_it_is() {
    // A campaign is planned cell by cell, which takes long.
    let (campaigns, jobs): (Vec<_>, Vec<_>) = bases()
        .into_iter()
        .partition(|(kind, _)| *kind == JobKind::Campaign);
    for (cases, bases) in [(3000, jobs), (30, campaigns)] {
        let accepted = check(cases, &bases);
        assert!(accepted > cases / 4, "{accepted} of {cases} were accepted");
    }
}

#[test]
fn the_gate_of_a_comparison_has_the_range_of_the_cutoff_that_it_becomes() {
    let body = |gate_m: f64| json!({"input": {"source": "preset", "preset": "liang2009-10"}, "comparison": {"gate_m": gate_m}});
    for gate_m in [1e9, 1.0001e7, 1e-12, 0.0009] {
        let faults = plan(JobKind::Evaluate, &body(gate_m)).unwrap_err();
        assert_eq!(faults.len(), 1, "{faults:?}");
        assert_eq!(
            (faults[0].pointer.as_str(), faults[0].code.as_str()),
            ("/comparison/gate_m", "out_of_range")
        );
        assert_eq!(faults[0].allowed.as_deref(), Some("[0.001, 10000000] m"));
    }
    for gate_m in [1e-3, 1e7] {
        assert_eq!(
            plan(JobKind::Evaluate, &body(gate_m)).unwrap().spec["metrics"][0]["cutoff_m"],
            gate_m
        );
    }
}
