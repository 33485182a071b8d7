//! The experiment of Cai Yubao et al., Application of fuzzy data association algorithm on multitarget tracking, tables 1 and 2:
//! six sensors, 25 targets, straight or weaving, 10 or 15 of them reported by every sensor and the others by one.
//!
//! The paper gives neither noise nor spacing. Those here are chosen so that its nearest neighbour comes out near its table
//! (95, 93, 85, 76 %): five by five targets 2 500 m ± 10 % apart at 250 m/s, σ 200 m, a scan every 2 s.

use super::Preset;
use crate::experiment::job::JobKind;
use serde_json::{Value, json};

/// Targets of the scene.
pub(super) const TARGETS: u32 = 25;

pub(super) fn presets() -> Vec<Preset> {
    let scenes = [("cv", "straight"), ("weave", "weaving")]
        .into_iter()
        .flat_map(|scene| [10, 15].map(|count| (scene, count)));
    let preset = |((name, motion), duplicates): ((&str, &str), u32)| {
        let summary = format!(
            "Cai et al.: six sensors, 25 {motion} targets, {duplicates} of them reported by every sensor; grouped by fuzzy c-means, \
             nearest neighbours and others. The paper gives no noise and no spacing: they are chosen for its nearest-neighbour column."
        );
        campaign(
            format!("cai-fuzzy-{name}-{duplicates}"),
            summary,
            scenario(motion, duplicates),
            &[axis()],
            5,
        )
    };
    scenes
        .clone()
        .map(preset)
        .chain([tables(scenes.collect())])
        .collect()
}

/// Both tables in one: four scenes by contenders.
fn tables(scenes: Vec<((&str, &str), u32)>) -> Preset {
    let variant = |&((name, motion), duplicates): &((&str, &str), u32)| {
        let scene = scenario(motion, duplicates);
        json!({"name": format!("{name}, {duplicates}"), "set": [
            {"path": "/input/scenario/targets/motion", "value": scene["targets"]["motion"]},
            {"path": "/input/scenario/coverage/count", "value": duplicates}
        ]})
    };
    let summary = "Cai et al., Tables 1 and 2: the scenes of cai-fuzzy-{cv,weave}-{10,15} in one, every contender on each.".to_owned();
    let scenes = json!({"by": "variants", "name": "scene", "variants": scenes.iter().map(variant).collect::<Vec<_>>()});
    campaign(
        "cai-fuzzy-tables".to_owned(),
        summary,
        scenario("straight", 10),
        &[scenes, axis()],
        25,
    )
}

/// Of groups, with what every such campaign keeps.
pub(super) fn campaign(
    name: String,
    summary: String,
    scenario: Value,
    grid: &[Value],
    runs: u32,
) -> Preset {
    Preset {
        summary,
        kind: JobKind::Campaign,
        body: json!({
            "name": name,
            "seed": 1,
            "base": {
                "kind": "group",
                "input": {"source": "scenario", "scenario": scenario},
                "grouper": {"method": "fuzzy_c_means", "initial": {"from": "predictions"}},
                "predictions": {"start": "truth", "loop": "open", "process_noise_m2ps3": 100.0}
            },
            "grid": grid,
            "runs": runs,
            "timed_runs": 1000,
            "outcomes": [
                {"name": "accuracy", "path": "grouping.accuracy"},
                {"name": "precision", "path": "grouping.precision"},
                {"name": "recall", "path": "grouping.recall"},
                {"name": "iterations", "path": "grouping.search.mean_iterations"}
            ],
            "compare": {"axis": "grouper", "to": "NN, 3 σ"}
        }),
        name,
    }
}

/// The contenders as an axis. The genetic search takes thousands of times as long as the others: it is in the table of the
/// examples only.
fn axis() -> Value {
    let changes = |parts: &Value| {
        let parts = parts.as_object().into_iter().flatten();
        parts
            .map(|(name, value)| json!({"path": format!("/{name}"), "value": value}))
            .collect::<Vec<_>>()
    };
    let variant =
        |(name, parts): (&'static str, Value)| json!({"name": name, "set": changes(&parts)});
    let variants = contenders()
        .into_iter()
        .filter(|(name, _)| !name.starts_with("FCM genetic"))
        .map(variant)
        .collect::<Vec<_>>();
    json!({"by": "variants", "name": "grouper", "variants": variants})
}

/// What is compared: a name, and the parts of a preset's body that differ.
pub fn contenders() -> Vec<(&'static str, Value)> {
    let clusters = json!({"by": "count", "count": TARGETS});
    let sensor = json!({"from": "sensor", "clusters": clusters});
    let random = json!({"from": "random", "clusters": clusters});
    let genetic =
        json!({"from": "genetic", "clusters": clusters, "population": 6, "generations": 6});
    let nearest = json!({"method": "nearest_neighbour", "gate_sigmas": 3.0});
    let fuzzy = json!({"method": "fuzzy_c_means"});
    let from = |initial: Value, one_per_sensor: bool| json!({"grouper": {"method": "fuzzy_c_means", "initial": initial, "one_per_sensor": one_per_sensor}});
    let predictions = || json!({"from": "predictions"});
    let closed = json!({"start": "truth", "loop": "closed", "process_noise_m2ps3": 100.0});
    vec![
        ("NN, 3 σ", json!({"grouper": nearest})),
        (
            "NN, 3 σ, closed loop",
            json!({"grouper": nearest, "predictions": closed}),
        ),
        (
            "NN, no gate",
            json!({"grouper": {"method": "nearest_neighbour"}}),
        ),
        (
            "NN, no gate, one per sensor",
            json!({"grouper": {"method": "nearest_neighbour", "one_per_sensor": true}}),
        ),
        (
            "sequential NN, 3 σ",
            json!({"grouper": {"method": "sequential_nearest_neighbour", "gate_sigmas": 3.0}}),
        ),
        (
            "sequential NN, 4 σ, one per sensor",
            json!({"grouper": {"method": "sequential_nearest_neighbour", "gate_sigmas": 4.0, "one_per_sensor": true}}),
        ),
        ("FCM from predictions", from(predictions(), false)),
        (
            "FCM from predictions, closed loop",
            json!({"grouper": fuzzy, "predictions": closed}),
        ),
        (
            "FCM from predictions, one per sensor",
            from(predictions(), true),
        ),
        ("FCM from one sensor", from(sensor.clone(), false)),
        ("FCM from one sensor, one per sensor", from(sensor, true)),
        ("FCM from random reports", from(random, false)),
        ("FCM genetic, 6 × 6", from(genetic, false)),
        (
            "constrained hard c-means",
            json!({"grouper": {"method": "constrained_hard_c_means"}}),
        ),
    ]
}

pub(super) fn scenario(motion: &str, duplicates: u32) -> Value {
    let sensor = |number: u32| json!({"sensor_id": format!("S{number}"), "max_range_m": 100_000.0, "p_d": 1.0, "sigma_x_m": 200.0, "sigma_y_m": 200.0, "clutter_per_scan": 0.0});
    let motion = match motion {
        "weaving" => json!({"kind": "weaving", "heading_amplitude_deg": 30.0, "period_s": 60.0}),
        _ => json!({"kind": "constant_velocity"}),
    };
    json!({
        "scans": 30,
        "scan_period_s": 2.0,
        "sensors": (1..=6).map(sensor).collect::<Vec<_>>(),
        "targets": {"kind": "formation", "rows": 5, "columns": 5, "spacing_m": 2500.0, "displacement": 0.1, "speed_mps": 250.0, "motion": motion},
        "coverage": {"kind": "duplicates", "count": duplicates}
    })
}
