//! Jobs that leave settings open still track, and say what was taken.

use crate::origins::jobs::Texts;
use serde_json::{Value, json};
use trackloom_domain::experiment::observer::Silent;
use trackloom_domain::experiment::{self, Input, JobKind, Outcome, plan, presets};
use trackloom_domain::formats::{ReadOptions, format_named};
use trackloom_domain::model::dataset::DatasetKind;

fn done(kind: JobKind, body: &Value) -> Outcome {
    experiment::run(
        &plan(kind, body).unwrap_or_else(|faults| panic!("{faults:?}")),
        Vec::new(),
        &mut Silent,
    )
    .unwrap()
}

fn counts(outcome: &Outcome) -> (u64, u64) {
    let number = |pointer: &str| outcome.result.pointer(pointer).unwrap().as_u64().unwrap();
    (
        number("/tfa/counts/correct"),
        number("/association/counts/tracks"),
    )
}

/// The artefact of a simulation as an input of a job.
fn input_of(simulated: &Outcome, kind: DatasetKind) -> Option<Input> {
    let file = simulated
        .artifacts
        .iter()
        .find(|file| file.name == format!("{}.csv", kind.name()))
        .unwrap();
    let options = ReadOptions {
        kind: Some(kind),
        ..ReadOptions::default()
    };
    let read = (format_named("csv").unwrap().read)(&mut file.bytes.as_slice(), &options).unwrap();
    Some(Input {
        dataset: read.dataset,
        sensors: file.sensors.clone(),
        sha256: String::new(),
    })
}

/// The scenario simulated, and tracked as a recording with truth that is only for judging.
fn tracked_as_data(scenario: &Value, more: &Value) -> Outcome {
    let simulated = done(JobKind::Simulate, &json!({"scenario": scenario}));
    let mut body = json!({
        "input": {"source": "dataset", "dataset_id": "detections"}, "truth": {"source": "dataset", "dataset_id": "truth"},
        "comparison": {"gate_m": 1000.0}
    });
    body.as_object_mut()
        .unwrap()
        .extend(more.as_object().unwrap().clone());
    let inputs = vec![
        input_of(&simulated, DatasetKind::Detections),
        input_of(&simulated, DatasetKind::Truth),
    ];
    experiment::run(
        &plan(JobKind::Evaluate, &body).unwrap(),
        inputs,
        &mut Silent,
    )
    .unwrap()
}

#[test]
fn a_preset_as_a_source_tracks_as_the_preset_does() {
    for name in ["liang2009-10", "liang2009-30", "liang2009-polar-10"] {
        let whole = done(JobKind::Evaluate, &presets::find(name).unwrap().body);
        let brought = done(
            JobKind::Evaluate,
            &json!({"input": {"source": "preset", "preset": name}}),
        );
        assert_eq!(
            brought.result["association"], whole.result["association"],
            "{name}"
        );
        assert!(counts(&brought).0 > 4, "{name}");
    }
}

#[test]
fn the_scenes_of_liang_are_tracked_as_well_when_the_speed_is_left_open() {
    // Ten targets in 10 000 km² show too few straight courses to tell the fastest of them from chance.
    for name in ["liang2009-30", "liang2009-50"] {
        let preset = presets::find(name).unwrap().body;
        let expected = counts(&done(JobKind::Evaluate, &preset));
        let tracker = json!({"gate_probability": 0.999});
        let of_scenario = done(
            JobKind::Evaluate,
            &json!({"input": preset["input"], "tracker": tracker}),
        );
        assert_eq!(counts(&of_scenario), expected, "{name}");
        assert_eq!(
            of_scenario.result["association"]["taken"],
            json!({"initial_speed_sigma_mps": 430.0})
        );
        let of_data = tracked_as_data(&preset["input"]["scenario"], &json!({"tracker": tracker}));
        let taken = &of_data.result["association"]["taken"];
        assert_eq!(
            counts(&of_data),
            expected,
            "{name}: {taken} {:?}",
            of_data.warnings
        );
        assert_eq!(
            taken["filter"],
            json!({"method": "kalman", "process_noise_m2ps3": 1.0})
        );
        let speed = taken["initial_speed_sigma_mps"].as_f64().unwrap();
        assert!((380.0..=480.0).contains(&speed), "{name}: {speed}");
        let told = format!(
            "initial_speed_sigma_mps {speed} m/s was estimated from the detections of radar; give it in /tracker/initial_speed_sigma_mps to fix it"
        );
        assert!(of_data.warnings.contains(&told), "{:?}", of_data.warnings);
    }
}

#[test]
fn what_is_given_is_told_nowhere() {
    let preset = presets::find("liang2009-10").unwrap().body;
    let outcome = done(JobKind::Evaluate, &preset);
    assert!(outcome.result["association"].get("taken").is_none());
    assert!(
        !outcome
            .warnings
            .iter()
            .any(|warning| warning.contains("speed")),
        "{:?}",
        outcome.warnings
    );
}

fn radar(name: &str, x_m: f64) -> Value {
    json!({
        "sensor_id": name, "x_m": x_m, "y_m": 0.0, "max_range_m": 20_000.0, "p_d": 0.9, "sigma_range_m": 20.0, "sigma_bearing_deg": 0.3,
        "clutter_per_scan": 3.0
    })
}

#[test]
fn two_radars_find_three_targets_of_seventy_metres_a_second() {
    let target = |name: &str, [x_m, y_m, vx_mps, vy_mps]: [f64; 4]| json!({"truth_id": name, "x_m": x_m, "y_m": y_m, "vx_mps": vx_mps, "vy_mps": vy_mps});
    let scenario = json!({
        "scans": 40, "scan_period_s": 2.0, "sensors": [radar("A", -5000.0), radar("B", 5000.0)],
        "targets": {"kind": "listed", "targets": [
            target("1", [-3000.0, 4000.0, 70.0, 5.0]), target("2", [3000.0, 6000.0, -60.0, -35.0]), target("3", [0.0, -4000.0, 20.0, 67.0])
        ]}
    });
    for outcome in [
        tracked_as_data(&scenario, &json!({})),
        tracked_as_data(
            &scenario,
            &json!({"tracker": {"initiation": {"method": "two_point"}}}),
        ),
        done(
            JobKind::Evaluate,
            &json!({"input": {"source": "scenario", "scenario": scenario}}),
        ),
    ] {
        let recall = outcome.result["metrics"]["clear"]["quantities"]["recall"]["value"]
            .as_f64()
            .unwrap();
        assert!(recall > 0.9, "recall {recall}: {:?}", outcome.warnings);
    }
}

fn recorded(content: &str, sensor: &Value, tracker: &Value) -> Outcome {
    let mut texts = Texts::of("csv");
    let body = json!({"input": texts.dataset(content), "sensors": [sensor], "tracker": tracker});
    texts.run(JobKind::Associate, &body).unwrap()
}

/// A target of 250 m/s, seen every 4 s.
fn fast(scans: usize) -> String {
    let rows = (0..scans)
        .map(|scan| format!("{},{scan},r,a{scan},{},0\n", 4 * scan, 1000 * scan))
        .collect::<String>();
    format!("time_s,scan,sensor_id,detection_id,x_m,y_m\n{rows}")
}

#[test]
fn a_fast_target_is_tracked_with_defaults_and_explained_where_settings_lose_it() {
    let sensor = json!({"sensor_id": "r", "p_d": 0.9, "clutter_per_m2": 1e-8, "sigma_x_m": 50.0, "sigma_y_m": 50.0});
    let open = recorded(&fast(10), &sensor, &json!({}));
    assert_eq!(
        open.result["association"]["counts"]["tracks"], 1,
        "{:?}",
        open.warnings
    );
    let slow = recorded(
        &fast(10),
        &sensor,
        &json!({"initial_speed_sigma_mps": 10.0}),
    );
    assert_eq!(slow.result["association"]["counts"]["tracks"], 0);
    let told = slow
        .warnings
        .iter()
        .find(|warning| warning.starts_with("no track was confirmed"))
        .unwrap();
    let expected = "with 10 detections in 10 scans (gate_probability 0.99, initial_speed_sigma_mps 10, confirmed by 3 detections of 5 \
                    scans); detections of three scans in a row follow each other at 250 m/s: initial_speed_sigma_mps 140 or more lets them in";
    assert!(told.ends_with(expected), "{told}");
    let short = recorded(&fast(2), &sensor, &json!({}));
    assert!(
        short.warnings.iter().any(|warning| warning
            .ends_with("only 2 scans have detections: confirm_hits 2 or less could confirm one")),
        "{:?}",
        short.warnings
    );
}

#[test]
fn a_campaign_says_why_an_outcome_is_never_there() {
    let base = json!({"kind": "evaluate", "input": {"source": "preset", "preset": "liang2009-10"}});
    let outcomes = json!([{"path": "tfa.probability.corect"}, {"path": "tfa.probability.correct"}, {"path": "metrics.gospa.quantities.gospa"}]);
    let told = |base: &Value| {
        done(
            JobKind::Campaign,
            &json!({"base": base, "runs": 2, "outcomes": outcomes}),
        )
        .warnings
    };
    let typo = "no run has the outcome 'tfa.probability.corect': there is no number at 'tfa.probability.corect' in any result; the nearest path \
                is 'tfa.probability.correct'";
    assert_eq!(told(&base), [typo]);
    let mut slow = base;
    slow["tracker"] = json!({"initial_speed_sigma_mps": 1.0});
    let warnings = told(&slow);
    assert!(warnings[1].starts_with("no run has the outcome 'tfa.probability.correct': 'tfa.probability.correct' is null, as a share or a mean of nothing is; the run says: no track was confirmed"), "{warnings:?}");
}

#[test]
fn the_campaign_of_the_manual_has_four_different_cells() {
    let page =
        std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/campaigns.md"))
            .unwrap();
    let block = page
        .split("```json\n")
        .nth(1)
        .unwrap()
        .split("```")
        .next()
        .unwrap();
    let mut body: Value = serde_json::from_str(block).unwrap();
    body.as_object_mut().unwrap().remove("kind");
    body["runs"] = json!(10);
    let outcome = done(JobKind::Campaign, &body);
    assert_eq!(outcome.warnings, [""; 0]);
    let means = |name: &str| {
        outcome.result["cells"]
            .as_array()
            .unwrap()
            .iter()
            .map(|cell| cell["outcomes"][name]["mean"].as_f64().unwrap())
            .collect::<Vec<_>>()
    };
    for name in ["correct", "GOSPA"] {
        let mut means = means(name);
        means.sort_by(f64::total_cmp);
        assert!(
            means.windows(2).all(|pair| pair[0] < pair[1]),
            "{name}: {means:?}"
        );
    }
    assert!(means("correct").iter().all(|&mean| mean > 0.1));
}
