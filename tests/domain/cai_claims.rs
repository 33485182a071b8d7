//! What Cai et al. and the page on genetic c-means claim, in small: amplitudes in experiments, several attributes, a start from
//! memberships, and the genetic search on images.

use super::segmentation::{compare, image};
use serde_json::{Value, json};
use trackloom_domain::experiment::observer::Silent;
use trackloom_domain::experiment::{JobKind, Outcome, RunError, plan, presets, run};
use trackloom_domain::math::fuzzy_c_means::{Metric, Objects};
use trackloom_domain::math::rng::Seed;
use trackloom_domain::model::fault::Fault;

/// The job that a preset's campaign runs, and its kind.
fn base_of(name: &str) -> Value {
    let mut body = presets::find(name).unwrap().body["base"].take();
    body.as_object_mut().unwrap().remove("kind");
    body
}

fn done(kind: JobKind, body: &Value) -> Result<Outcome, Vec<Fault>> {
    run(&plan(kind, body)?, Vec::new(), &mut Silent).map_err(|error| match error {
        RunError::Faults(faults) => faults,
        RunError::Stopped => panic!("nobody stops it"),
    })
}

fn accuracy(body: &Value) -> f64 {
    let result = done(JobKind::Group, body).unwrap().result;
    result["grouping"]["accuracy"].as_f64().unwrap()
}

/// Identity score of a job like those of `cai-fuzzy-strongest`.
fn identity(associator: &str, snr_db: Option<f64>) -> Result<f64, Vec<Fault>> {
    let mut body = base_of("cai-fuzzy-strongest");
    body["associator"] = json!({"method": associator});
    let sensor = &mut body["input"]["scenario"]["sensors"][0];
    sensor["snr_db"] = json!(snr_db);
    if snr_db.is_none() {
        sensor.as_object_mut().unwrap().remove("snr_db");
    }
    let result = done(JobKind::Evaluate, &body)?.result;
    Ok(result["metrics"]["identity"]["value"].as_f64().unwrap())
}

#[test]
fn the_strongest_neighbour_follows_strong_echoes_and_loses_weak_ones() {
    // At 40 dB a false detection in the gate is stronger once in ten thousand times; at −10 dB nearly every second time.
    let (strong, weak) = (
        identity("strongest_neighbour", Some(40.0)).unwrap(),
        identity("strongest_neighbour", Some(-10.0)).unwrap(),
    );
    let nearest = identity("nearest_neighbour", Some(40.0)).unwrap();
    assert!(strong > nearest, "{strong} {nearest}");
    assert!(weak < nearest - 0.05, "{weak} {nearest}");
    assert_eq!(
        nearest,
        identity("nearest_neighbour", None).unwrap(),
        "amplitudes change nothing for those who do not look at them"
    );
    let faults = identity("strongest_neighbour", None).unwrap_err();
    assert_eq!(faults[0].pointer, "/associator/method");
}

#[test]
fn several_attributes_are_better_than_one_of_them() {
    let with = |attributes: Value| {
        let mut body = base_of("cai-fuzzy-attributes");
        body["grouper"] = json!({"method": "nearest_neighbour"});
        body["attributes"] = attributes;
        accuracy(&body)
    };
    let (range, bearing) = (with(json!(["range"])), with(json!(["bearing"])));
    let both = with(json!(["bearing", "range"]));
    assert!(
        range < 0.5 && bearing < 0.5 && both > 0.99,
        "{range} {bearing} {both}"
    );
    // Positions made of both are as good as both.
    let position = with(json!(["position"]));
    assert!((position - both).abs() < 0.01, "{position} {both}");
}

#[test]
fn what_cannot_be_compared_is_named() {
    let refused = |change: &dyn Fn(&mut Value)| {
        let mut body = base_of("cai-fuzzy-attributes");
        body["attributes"] = json!(["range", "range_rate"]);
        change(&mut body);
        let faults = done(JobKind::Group, &body).unwrap_err();
        (faults[0].pointer.clone(), faults[0].code.clone())
    };
    let unsupported = ("/attributes".to_owned(), "unsupported".to_owned());
    assert_eq!(
        refused(&|body| body["grouper"] = json!({"method": "constrained_hard_c_means"})),
        unsupported
    );
    assert_eq!(
        refused(&|body| body["input"]["scenario"]["sensors"][0]["x_m"] = json!(1.0)),
        unsupported
    );
    let sensors = base_of("cai-fuzzy-tables")["input"]["scenario"]["sensors"].take();
    assert_eq!(
        refused(&|body| body["input"]["scenario"]["sensors"] = sensors.clone()),
        unsupported
    );
    let without_rates = |body: &mut Value| {
        for sensor in body["input"]["scenario"]["sensors"].as_array_mut().unwrap() {
            sensor
                .as_object_mut()
                .unwrap()
                .remove("sigma_range_rate_mps");
        }
    };
    assert_eq!(refused(&without_rates), unsupported);
}

#[test]
fn memberships_at_random_are_no_place_to_begin() {
    let mut body = base_of("cai-fuzzy-cv-15");
    body["input"]["scenario"]["scans"] = json!(4);
    let clusters = json!({"by": "count", "count": 25});
    body["grouper"] = json!({"method": "fuzzy_c_means", "initial": {"from": "memberships", "clusters": clusters}});
    let found = accuracy(&body);
    assert!(found < 0.7, "{found}");
    assert_eq!(found, accuracy(&body), "the draws are those of the seed");
}

#[test]
fn the_genetic_search_is_never_above_fuzzy_c_means_and_images_leave_it_nothing_to_gain() {
    for seed in 1..=3 {
        let seed = Seed { seed, run: 0 };
        let pixels = image(seed, 12.0, 20);
        let objects = Objects::new(&pixels, &[false], Metric::Scaled(&[1.0])).unwrap();
        let [plain, genetic, without, longer] = compare(&objects, 3, seed);
        assert!(genetic.cost <= plain.cost * (1.0 + 1e-12));
        // Three classes of grey levels have one optimum: both are there, to what the tolerance leaves.
        let ratio = genetic.mean_squared_error / plain.mean_squared_error;
        assert!((ratio - 1.0).abs() < 0.002, "{ratio}");
        assert!(genetic.rounds > 10 * plain.rounds);
        // Without c-means the search comes near, and not nearer.
        assert!(without.cost >= genetic.cost && longer.cost >= genetic.cost);
    }
}
