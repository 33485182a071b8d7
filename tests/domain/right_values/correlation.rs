//! Jobs that put tracks together: what they leave behind makes the same numbers again.

use serde_json::{Value, json};
use trackloom_domain::experiment::observer::Silent;
use trackloom_domain::experiment::{Input, JobKind, Outcome, plan, presets, run};
use trackloom_domain::formats::{ReadOptions, format_named};
use trackloom_domain::model::dataset::Dataset;

fn done(body: &Value, inputs: Vec<Option<Input>>) -> Outcome {
    run(
        &plan(JobKind::Correlate, body).unwrap(),
        inputs,
        &mut Silent,
    )
    .unwrap()
}

fn local_tracks(outcome: &Outcome) -> Dataset {
    let file = outcome
        .artifacts
        .iter()
        .find(|file| file.name == "local_tracks.csv")
        .unwrap();
    (format_named("csv").unwrap().read)(&mut file.bytes.as_slice(), &ReadOptions::default())
        .unwrap()
        .dataset
}

/// The job with the tracks that another one left as its sets, a set a sensor.
fn again(body: &Value, first: &Outcome) -> Outcome {
    let sensors: Vec<String> = first.result["sensors"]
        .as_array()
        .unwrap()
        .iter()
        .map(|sensor| sensor["sensor_id"].as_str().unwrap().to_owned())
        .collect();
    let mut body = body.clone();
    body.as_object_mut().unwrap().remove("input");
    body["sets"] = sensors
        .iter()
        .map(|_| json!({"source": "dataset", "dataset_id": "local_tracks"}))
        .collect();
    let all = local_tracks(first);
    let input = |sensor: &String| {
        let dataset = all
            .clone()
            .only_sensors(std::slice::from_ref(sensor))
            .unwrap();
        Some(Input {
            dataset,
            sensors: Vec::new(),
            sha256: String::new(),
        })
    };
    done(&body, sensors.iter().map(input).collect())
}

#[test]
fn local_tracks_make_the_same_tuples_and_costs_again() {
    let mut preset = presets::find("huo2008").unwrap();
    preset.body["input"]["tracks"] = json!({"spacing_m": 150.0, "false_tracks": 3.0, "p_d": 0.8});
    for statistic in ["chain", "all_pairs", "fused", "likelihood_ratio"] {
        preset.body["statistic"] = json!({"kind": statistic});
        let first = done(&preset.body, Vec::new());
        let second = again(&preset.body, &first);
        assert!(first.result["tuples"].as_array().unwrap().len() > 3);
        // J, its bound, the search; of each tuple its tracks, λ summed as Q, b, cost, p-value: all equal to the last digit.
        for part in [
            "cost",
            "dual_bound",
            "gap",
            "sensors",
            "unassociated",
            "search",
        ] {
            assert_eq!(
                first.result[part], second.result[part],
                "{statistic} {part}"
            );
        }
        for (one, other) in first.result["tuples"]
            .as_array()
            .unwrap()
            .iter()
            .zip(second.result["tuples"].as_array().unwrap())
        {
            for part in [
                "tracks",
                "cost",
                "b",
                "statistic",
                "degrees_of_freedom",
                "p_value",
                "found",
            ] {
                assert_eq!(one[part], other[part], "{statistic} {part}");
            }
        }
        assert_eq!(local_tracks(&first), local_tracks(&second));
    }
}

#[test]
fn only_sensors_that_tracks_have_can_be_asked_for() {
    let faults = local_tracks(&done(&presets::find("huo2008").unwrap().body, Vec::new()))
        .only_sensors(&["sonar".to_owned()])
        .unwrap_err();
    assert_eq!(
        (faults[0].pointer.as_str(), faults[0].detail.as_str()),
        ("/0", "the tracks have no sensor 'sonar'")
    );
}

#[test]
fn a_gap_that_rounding_leaves_is_none() {
    let mut body = presets::find("huo2008").unwrap().body;
    body["correlator"] = json!({"method": "exact"});
    body["input"]["tracks"] = json!({"spacing_m": 250.0, "p_d": 0.9});
    for seed in 1..=20 {
        body["seed"] = json!(seed);
        let gap = done(&body, Vec::new()).result["gap"].as_f64().unwrap();
        assert!(gap == 0.0 || gap.abs() >= 1e-12, "seed {seed}: {gap}");
    }
}
