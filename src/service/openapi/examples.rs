//! Examples of request bodies. A test gives every one of them to the checks that real requests meet.

use crate::experiment::job_shape::with_kind;
use crate::experiment::{JobKind, presets};
use serde_json::{Value, json};

/// An id as ids look; examples name nothing that exists.
const SOME_ID: &str = "0199e0a4-7c00-7000-8000-000000000001";
const OTHER_ID: &str = "0199e0a4-7c00-7000-8000-000000000002";

/// Examples for jobs of a kind: summary and body.
pub fn job_examples(kind: JobKind) -> Vec<(&'static str, Value)> {
    match kind {
        JobKind::Simulate => simulate(),
        JobKind::Associate => associate(),
        JobKind::Evaluate => evaluate(),
        JobKind::Group => group(),
        JobKind::Correlate => correlate(),
        JobKind::Campaign => campaign(),
    }
}

fn simulate() -> Vec<(&'static str, Value)> {
    let crossing = json!({
        "scans": 20,
        "scan_period_s": 2.0,
        "sensors": [{"sensor_id": "radar", "max_range_m": 20_000.0, "p_d": 0.9, "sigma_x_m": 30.0, "sigma_y_m": 30.0, "clutter_per_scan": 2.0}],
        "targets": {"kind": "listed", "targets": [
            {"truth_id": "A", "x_m": -4000.0, "y_m": 0.0, "vx_mps": 200.0, "vy_mps": 0.0},
            {"truth_id": "B", "x_m": 0.0, "y_m": -4000.0, "vx_mps": 0.0, "vy_mps": 200.0}
        ]}
    });
    vec![(
        "Two crossing targets",
        json!({"name": "crossing", "seed": 7, "scenario": crossing}),
    )]
}

fn associate() -> Vec<(&'static str, Value)> {
    vec![
        (
            "An uploaded recording under the nearest neighbour",
            json!({
                "input": {"source": "dataset", "dataset_id": SOME_ID},
                "sensors": [{"sensor_id": "radar", "p_d": 0.9, "clutter_per_m2": 1e-8, "sigma_x_m": 30.0, "sigma_y_m": 30.0}],
                "associator": {"method": "nearest_neighbour"}
            }),
        ),
        (
            "The output of a simulation",
            json!({"input": {"source": "job", "job_id": SOME_ID}, "labels": {"paper": "figure-3"}}),
        ),
    ]
}

fn evaluate() -> Vec<(&'static str, Value)> {
    let preset = presets::all()
        .into_iter()
        .find(|preset| preset.kind == JobKind::Evaluate);
    let mut examples = vec![
        (
            "The tracks of a job against the truth that it knows",
            json!({"tracks": {"source": "job", "job_id": SOME_ID}}),
        ),
        (
            "Uploaded tracks against uploaded truth",
            json!({
                "tracks": {"source": "dataset", "dataset_id": SOME_ID},
                "truth": {"source": "dataset", "dataset_id": OTHER_ID},
                "tfa": {"symbols": {"kind": "nearest_truth", "gate_m": 50.0}}
            }),
        ),
    ];
    examples.extend(preset.map(|preset| {
        (
            "A preset: simulate, track and judge in one job",
            preset.body,
        )
    }));
    examples
}

fn group() -> Vec<(&'static str, Value)> {
    let preset = presets::all()
        .into_iter()
        .find(|preset| preset.kind == JobKind::Group);
    let uploaded = json!({
        "input": {"source": "dataset", "dataset_id": SOME_ID},
        "grouper": {"method": "sequential_nearest_neighbour", "gate_sigmas": 4.0, "one_per_sensor": true}
    });
    let mut examples = vec![("An uploaded recording of several sensors", uploaded)];
    examples.extend(preset.map(|preset| ("A preset: simulate and group in one job", preset.body)));
    examples
}

/// The preset, where there is a correlator.
fn correlate() -> Vec<(&'static str, Value)> {
    let preset = presets::all()
        .into_iter()
        .find(|preset| preset.kind == JobKind::Correlate);
    preset
        .into_iter()
        .map(|preset| {
            (
                "A preset: draw tracks of three sensors and put them together",
                preset.body,
            )
        })
        .collect()
}

fn campaign() -> Vec<(&'static str, Value)> {
    let base = json!({"kind": "evaluate", "input": {"source": "preset", "preset": "liang2009-30"}});
    let variant = |name: &str, method: &str| json!({"name": name, "set": [{"path": "/associator", "value": {"method": method}}]});
    let methods = [
        variant("NN", "nearest_neighbour"),
        variant("GNN", "global_nearest_neighbour"),
        variant("JPDA", "jpda"),
    ];
    let body = json!({
        "name": "three associators", "base": base, "runs": 50,
        "grid": [
            {"by": "values", "name": "P_D", "path": "/input/scenario/sensors/0/p_d", "values": [0.7, 0.9]},
            {"by": "variants", "name": "associator", "variants": methods}
        ],
        "outcomes": [{"path": "tfa.probability.correct", "name": "correct"}, {"path": "metrics.gospa.quantities.gospa"}]
    });
    vec![("Three associators on the same scenes", body)]
}

pub(super) fn patch() -> Vec<(&'static str, Value)> {
    vec![("A new name", json!({"name": "crossing, second try"}))]
}

pub(super) fn session() -> Vec<(&'static str, Value)> {
    let radar = json!({
        "sensor_id": "radar", "x_m": 0.0, "y_m": 0.0, "sigma_range_m": 30.0, "sigma_bearing_deg": 0.1, "p_d": 0.9,
        "clutter_per_m2": 1e-9
    });
    vec![(
        "A radar, with late scans put in their place",
        json!({
            "name": "harbour", "sensors": [radar], "associator": {"method": "jpda"},
            "tracker": {"initial_speed_sigma_mps": 10.0}, "late": "replay", "window_s": 20.0
        }),
    )]
}

pub(super) fn hand_track() -> Vec<(&'static str, Value)> {
    vec![(
        "A place and a velocity",
        json!({"x_m": 4000.0, "y_m": -250.0, "vx_mps": 12.0, "vy_mps": 3.5, "sigma_m": 50.0, "sigma_mps": 5.0}),
    )]
}

pub(super) fn key() -> Vec<(&'static str, Value)> {
    vec![
        (
            "Of a feed, for a year",
            json!({"name": "radar north", "actions": ["push", "read"], "expires_in_days": 365.0}),
        ),
        (
            "Of a reader",
            json!({"name": "wall display", "actions": ["read"], "requests_per_minute": 600}),
        ),
    ]
}

pub(super) fn login() -> Vec<(&'static str, Value)> {
    vec![("A key", json!({"key": "tlk_0190a1…"}))]
}

pub(super) fn scan() -> Vec<(&'static str, Value)> {
    vec![
        (
            "Two detections",
            json!({
                "sensor_id": "radar", "sequence": 17, "time_s": 1_700_000_000.25,
                "detections": [{"range_m": 4012.5, "bearing_deg": 31.25}, {"range_m": 9810.0, "bearing_deg": 271.5}]
            }),
        ),
        (
            "Of a ship that moves",
            json!({
                "sensor_id": "radar", "time": "2023-11-14T22:13:21.25Z",
                "pose": {"x_m": 120.0, "y_m": 40.0, "heading_deg": 87.5},
                "detections": [{"range_m": 4012.5, "bearing_deg": -31.25}]
            }),
        ),
        (
            "A heartbeat",
            json!({"sensor_id": "radar", "sequence": 19, "time_s": 1_700_000_002.75, "heartbeat": true}),
        ),
    ]
}

/// Jobs of several kinds, each with its kind.
pub(super) fn jobs() -> Vec<(&'static str, Value)> {
    let kinds = [JobKind::Simulate, JobKind::Associate];
    let first = |kind: JobKind| {
        job_examples(kind)
            .into_iter()
            .next()
            .map(|(summary, body)| (summary, with_kind(kind, &body)))
    };
    kinds.into_iter().filter_map(first).collect()
}
