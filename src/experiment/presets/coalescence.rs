//! Two targets that come together, fly side by side and part again: the scene in which averages draw tracks together.

use super::Preset;
use crate::experiment::job::JobKind;
use serde_json::{Value, json};

/// The angle between the slanted legs and the others: of 10 m/s, 0.48 m/s are across.
const SLANT_DEG: f64 = 2.751_254_588_9;

/// A corner of the course is a turn as short as this, and cut by 6 mm.
const CORNER_S: f64 = 0.1;

/// False detections per m² and scan.
const CLUTTER_PER_M2: f64 = 1e-4;

const RANGE_M: f64 = 105.0;

/// 10 m/s east, 20 m apart until scan 10, 0.8 m from scan 30 to 70, then apart again; the sensor goes along, so that its false
/// detections are around the targets.
pub(super) fn presets() -> Vec<Preset> {
    let clutter_per_scan = CLUTTER_PER_M2 * std::f64::consts::PI * RANGE_M * RANGE_M;
    let sensor = json!({
        "sensor_id": "radar", "x_m": 0.0, "y_m": 0.0, "course": {"vx_mps": 10.0, "vy_mps": 0.0, "segments": []}, "max_range_m": RANGE_M,
        "p_d": 0.9, "sigma_x_m": 1.0, "sigma_y_m": 1.0, "clutter_per_scan": clutter_per_scan
    });
    let base = json!({
        "kind": "evaluate",
        "input": {"source": "scenario", "scenario": {
            "scans": 100,
            "scan_period_s": 1.0,
            "sensors": [sensor],
            "targets": {"kind": "maneuvering", "targets": [target("left", 1.0), target("right", -1.0)]}
        }},
        "associator": {"method": "jpda"},
        "filter": {"method": "kalman", "process_noise_m2ps3": 0.05},
        "tracker": {"gate_probability": 0.999, "initiation": {"method": "truth", "speed_sigma_mps": 1.0}},
        "metrics": [{"metric": "ospa", "cutoff_m": 10.0, "p": 2.0}, {"metric": "clear"}],
        "comparison": {"gate_m": 4.0, "credit": "afterwards"}
    });
    let outcomes = [
        ("OSPA m", "metrics.ospa.quantities.ospa"),
        ("MOTA", "metrics.clear.quantities.mota"),
        ("identity switches", "metrics.clear.quantities.idsw"),
    ]
    .map(|(name, path)| json!({"name": name, "path": path}));
    let body = json!({
        "name": "coalescence",
        "seed": 1,
        "base": base,
        "grid": [{"by": "variants", "name": "associator", "variants": associators()}],
        "runs": 300,
        "outcomes": outcomes,
        "compare": {"axis": "associator", "to": "JPDA"}
    });
    vec![Preset {
        name: "coalescence".to_owned(),
        summary: "Two targets that fly 0.8 m apart for 40 scans of 1 m noise and part again: global nearest neighbour, JPDA, JPDA* and NN-JPDA."
            .to_owned(),
        kind: JobKind::Campaign,
        body,
    }]
}

fn associators() -> Vec<Value> {
    let variant = |(name, associator): (&str, Value)| json!({"name": name, "set": [{"path": "/associator", "value": associator}]});
    [
        ("GNN", json!({"method": "global_nearest_neighbour"})),
        ("JPDA", jpda("none")),
        ("JPDA*", jpda("best_permutation")),
        ("NN-JPDA", jpda("nearest_neighbour")),
    ]
    .map(variant)
    .to_vec()
}

fn jpda(against_coalescence: &str) -> Value {
    json!({"method": "jpda", "against_coalescence": against_coalescence})
}

/// The target to the left (side 1) or to the right (side −1) of the line between both.
fn target(truth_id: &str, side: f64) -> Value {
    let corner = |sign: f64| json!({"move": "turn", "duration_s": CORNER_S, "rate_degps": sign * side * SLANT_DEG / CORNER_S});
    // The middle of each corner is at the scan.
    let segments = [
        straight(10.0 - CORNER_S / 2.0),
        corner(-1.0),
        straight(20.0 - CORNER_S),
        corner(1.0),
        straight(40.0 - CORNER_S),
        corner(1.0),
    ];
    json!({
        "truth_id": truth_id, "x_m": 0.0, "y_m": 10.0 * side, "vx_mps": 10.0, "vy_mps": 0.0, "start_s": 0.0, "segments": segments
    })
}

fn straight(duration_s: f64) -> Value {
    json!({"move": "straight", "duration_s": duration_s})
}
