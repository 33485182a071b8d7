//! The scenes that decide what Wang, Li, Huang say beside their tables: what they contain, and what comes out of them.

use serde_json::{Value, json};
use std::collections::BTreeMap;
use trackloom_domain::experiment::observer::Silent;
use trackloom_domain::experiment::{self, JobKind, Outcome, plan, presets};

fn outcome(kind: JobKind, body: &Value) -> Outcome {
    let plan = plan(kind, body).unwrap_or_else(|faults| panic!("{faults:?}"));
    experiment::run(&plan, vec![], &mut Silent).unwrap_or_else(|error| panic!("{error:?}"))
}

fn text<'a>(outcome: &'a Outcome, name: &str) -> &'a str {
    let found = outcome.artifacts.iter().find(|file| file.name == name);
    std::str::from_utf8(&found.unwrap().bytes).unwrap()
}

/// Bearings (deg) of each target at each of its times, from 0 to 360.
fn truth_of(scenario: &Value) -> BTreeMap<String, Vec<f64>> {
    let found = outcome(JobKind::Simulate, &json!({"scenario": scenario}));
    let mut bearings: BTreeMap<String, Vec<f64>> = BTreeMap::new();
    for line in text(&found, "truth.csv").lines().skip(1) {
        let fields: Vec<&str> = line.split(',').collect();
        let of = bearings.entry(fields[1].to_owned()).or_default();
        of.push(fields[2].parse().unwrap());
    }
    bearings
}

/// How often one of two targets passes the other.
fn passes(one: &[f64], other: &[f64]) -> usize {
    let difference = |(a, b): (&f64, &f64)| (a - b + 180.0).rem_euclid(360.0) - 180.0;
    let differences: Vec<f64> = one.iter().zip(other).map(difference).collect();
    let met = |pair: &&[f64]| pair[0] * pair[1] <= 0.0 && (pair[0] - pair[1]).abs() < 90.0;
    differences
        .iter()
        .copied()
        .filter(|difference| *difference != 0.0)
        .collect::<Vec<_>>()
        .windows(2)
        .filter(met)
        .count()
}

fn crossings_of(scenario: &Value) -> usize {
    let bearings: Vec<Vec<f64>> = truth_of(scenario).into_values().collect();
    let mut count = 0;
    for (index, one) in bearings.iter().enumerate() {
        for other in &bearings[index + 1..] {
            count += passes(one, other);
        }
    }
    count
}

/// The scenario of each variant of a campaign's first axis.
fn variants(campaign: &str) -> Vec<(String, Value)> {
    let body = presets::find(campaign).unwrap().body;
    let of = |variant: &Value| {
        let mut scenario = body["base"]["input"]["scenario"].clone();
        scenario["targets"] = variant["set"][0]["value"].clone();
        (variant["name"].as_str().unwrap().to_owned(), scenario)
    };
    let axis = body["grid"][0]["variants"].as_array().unwrap();
    axis.iter().map(of).collect()
}

#[test]
fn the_scenes_of_many_crossings_have_as_many_as_they_are_called_by() {
    for (name, scenario) in variants("wang-bat-crossings") {
        assert_eq!(truth_of(&scenario).len(), 6);
        assert_eq!(crossings_of(&scenario).to_string(), name);
    }
}

#[test]
fn the_scenes_of_many_targets_have_as_many_as_they_are_called_by() {
    for (name, scenario) in variants("wang-bat-targets") {
        assert_eq!(truth_of(&scenario).len().to_string(), name);
    }
}

/// Runs a campaign with only these associators.
fn cells(campaign: &str, runs: u32, names: &[&str]) -> Vec<(String, Value)> {
    let mut body = presets::find(campaign).unwrap().body;
    body["runs"] = json!(runs);
    let axes = body["grid"].as_array_mut().unwrap();
    let associators = axes.last_mut().unwrap()["variants"].as_array_mut().unwrap();
    associators.retain(|variant| names.iter().any(|name| variant["name"] == *name));
    body.as_object_mut().unwrap().remove("compare");
    let found = outcome(JobKind::Campaign, &body);
    let of = |cell: &Value| {
        (
            cell["name"].as_str().unwrap().to_owned(),
            cell["outcomes"].clone(),
        )
    };
    found.result["cells"]
        .as_array()
        .unwrap()
        .iter()
        .map(of)
        .collect()
}

#[test]
fn a_beam_tells_the_targets_of_the_sea_trial_apart_but_where_they_cross() {
    let records = variants("wang-bat-sea-trials");
    let crossings: Vec<usize> = records
        .iter()
        .map(|(_, record)| crossings_of(record))
        .collect();
    assert_eq!(crossings, [1, 3, 2]);
    let truths: Vec<_> = records.iter().map(|(_, record)| truth_of(record)).collect();
    // Seconds within a beam of 3 degrees: 3 over the difference of the rates (0.1, 0.18 degrees a second) either way.
    let near = |truth: &BTreeMap<String, Vec<f64>>, one: &str, other: &str| {
        let pairs = truth[one].iter().zip(&truth[other]);
        let is_near =
            |(a, b): &(&f64, &f64)| ((*a - *b + 180.0).rem_euclid(360.0) - 180.0).abs() < 3.0;
        pairs.filter(is_near).count()
    };
    let together = |record: usize, pairs: [(&str, &str); 3]| {
        pairs.map(|(one, other)| near(&truths[record], one, other))
    };
    assert_eq!(
        together(0, [("1", "2"), ("3", "4"), ("5", "6")]),
        [59, 0, 0]
    );
    assert_eq!(
        together(1, [("4", "5"), ("4", "6"), ("2", "3")]),
        [33, 33, 0]
    );
    assert_eq!(
        together(2, [("1", "2"), ("3", "4"), ("5", "6")]),
        [59, 437, 0]
    );
}

#[test]
fn the_bats_hold_the_sea_trial_and_nobody_soft_holds_the_hard_record() {
    let found = cells("wang-bat-sea-trials", 6, &["JPDA", "BADA, sum"]);
    let mean = |name: &str, outcome: &str| {
        let cell = found.iter().find(|cell| cell.0 == name).unwrap();
        cell.1[outcome]["mean"].as_f64().unwrap()
    };
    assert_eq!(mean("sea trial, BADA, sum", "identity"), 1.0);
    assert_eq!(mean("sea trial, BADA, sum", "targets kept"), 6.0);
    assert!(mean("sea trial, BADA, sum", "p_d") > 0.97);
    assert_eq!(mean("hard, JPDA", "identity"), 0.0);
    assert!(mean("hard, BADA, sum", "identity") < 0.75);
}

#[test]
fn the_oracle_that_looks_at_objectives_tracks_as_the_other_does() {
    for name in ["wang-bat-6", "liang2009-clutter"] {
        let mut body = presets::find(name).unwrap().body["base"].take();
        body.as_object_mut().unwrap().remove("kind");
        let tracks = [false, true].map(|objectives| {
            body["associator"] = json!({"method": "oracle", "objectives": objectives});
            text(&outcome(JobKind::Evaluate, &body), "tracks.csv").to_owned()
        });
        assert!(tracks[0].lines().count() > 100);
        assert_eq!(tracks[0], tracks[1], "{name}");
    }
}

#[test]
fn the_objectives_are_largest_at_the_truth_in_nine_clusters_of_ten() {
    for (name, outcomes) in cells("wang-bat-objective", 20, &["oracle"]) {
        let mean = |outcome: &str| outcomes[outcome]["mean"].as_f64().unwrap();
        for objective in ["sum", "ratio"] {
            let [all, detected, shared] =
                ["all", "detected", "shared"].map(|group| mean(&format!("{objective}, {group}")));
            assert!((0.82..0.93).contains(&all), "{name}, {objective}: {all}");
            assert!(
                all < detected && detected < 0.95,
                "{name}, {objective}: {detected}"
            );
            assert!(
                (0.6..0.8).contains(&shared),
                "{name}, {objective}: {shared}"
            );
        }
        // The largest likelihood of a cluster is some part above that of the truth, never all of it.
        assert!((0.1..0.5).contains(&mean("sum, detected, lack")), "{name}");
    }
}

#[test]
fn the_constants_lead_a_swarm_that_is_large_enough_to_the_same_tracks() {
    let mut body = presets::find("wang-bat-alpha-gamma").unwrap().body["base"].take();
    body.as_object_mut().unwrap().remove("kind");
    let tracks = [0.90, 0.98, 0.99].map(|constant| {
        (body["associator"]["alpha"], body["associator"]["gamma"]) =
            (json!(constant), json!(constant));
        text(&outcome(JobKind::Evaluate, &body), "tracks.csv").to_owned()
    });
    assert!(tracks[0] == tracks[1] && tracks[1] == tracks[2]);
}
