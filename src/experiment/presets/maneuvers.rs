//! Scenes of one target that manoeuvres: an airliner under surveillance and an agile one at ten fixes a second.

use super::Preset;
use crate::experiment::job::JobKind;
use serde_json::{Value, json};

/// Section 11.7 of Bar-Shalom, Li & Kirubarajan 2001: 120 m/s, two turns of 90°, a fix of 100 m every 5 s. The rates are not
/// told: the second model estimates them.
pub(super) fn atc() -> Vec<Preset> {
    let segments = json!([
        {"move": "straight", "duration_s": 125.0},
        {"move": "turn", "duration_s": 90.0, "rate_degps": 1.0},
        {"move": "straight", "duration_s": 125.0},
        {"move": "turn", "duration_s": 30.0, "rate_degps": -3.0},
        {"move": "straight", "duration_s": 125.0}
    ]);
    let target = json!({
        "truth_id": "1", "x_m": 25_000.0, "y_m": 10_000.0, "vx_mps": -120.0, "vy_mps": 0.0, "start_s": 0.0, "segments": segments
    });
    let filter = json!({"method": "imm", "models": [
        {"model": "constant_velocity", "process_noise_m2ps3": 0.05, "sojourn_s": 200.0},
        {"model": "unknown_turn", "process_noise_m2ps3": 0.05, "turn_noise_deg2ps3": 0.2, "sojourn_s": 25.0}
    ]});
    vec![preset(
        "atc-maneuver",
        "Bar-Shalom, Li & Kirubarajan 2001, section 11.7: an airliner that turns twice, 100 fixes of 100 m; IMM of straight flight and a \
         turn of unknown rate.",
        &Scene {
            scans: 100,
            period_s: 5.0,
            range_m: 60_000.0,
            sigma_m: 100.0,
            speed_sigma_mps: 300.0,
        },
        &target,
        filter,
    )]
}

/// The scene of the MathWorks example Tracking Maneuvering Targets, in the plane: 200 m/s, ten fixes of 1 m a second, a turn of
/// 10°/s, then 3 m/s² along the heading.
pub(super) fn ten_hertz() -> Vec<Preset> {
    let segments = json!([
        {"move": "straight", "duration_s": 33.2},
        {"move": "turn", "duration_s": 33.4, "rate_degps": 10.0},
        {"move": "accelerate", "duration_s": 33.4, "acceleration_mps2": 3.0}
    ]);
    let target = json!({
        "truth_id": "1", "x_m": 0.0, "y_m": 0.0, "vx_mps": 200.0, "vy_mps": 0.0, "start_s": 0.0, "segments": segments
    });
    let filter = json!({"method": "imm", "models": [
        {"model": "constant_velocity", "process_noise_m2ps3": 0.1},
        {"model": "constant_velocity", "process_noise_m2ps3": 122.5}
    ]});
    vec![preset(
        "maneuver-10hz",
        "MathWorks, Tracking Maneuvering Targets, in the plane: straight, a turn of 10°/s and an acceleration, ten fixes of 1 m a second; \
         IMM of two constant velocities.",
        &Scene {
            scans: 1001,
            period_s: 0.1,
            range_m: 60_000.0,
            sigma_m: 1.0,
            speed_sigma_mps: 300.0,
        },
        &target,
        filter,
    )]
}

struct Scene {
    scans: u32,
    period_s: f64,
    range_m: f64,
    sigma_m: f64,
    speed_sigma_mps: f64,
}

/// One sensor of positions without misses or false detections; every fix continues the track.
fn preset(name: &str, summary: &str, scene: &Scene, target: &Value, filter: Value) -> Preset {
    let sensor = json!({
        "sensor_id": "radar", "x_m": 0.0, "y_m": 0.0, "max_range_m": scene.range_m, "p_d": 1.0,
        "sigma_x_m": scene.sigma_m, "sigma_y_m": scene.sigma_m
    });
    let body = json!({
        "name": name,
        "seed": 1,
        "input": {"source": "scenario", "scenario": {
            "scans": scene.scans,
            "scan_period_s": scene.period_s,
            "sensors": [sensor],
            "targets": {"kind": "maneuvering", "targets": [target]}
        }},
        "associator": {"method": "global_nearest_neighbour"},
        "filter": filter,
        "tracker": {
            "gate_probability": 0.999_999, "confirm_hits": 1, "confirm_window": 1,
            "initial_speed_sigma_mps": scene.speed_sigma_mps
        },
        "comparison": {"gate_m": 10.0 * scene.sigma_m, "credit": "afterwards"}
    });
    Preset {
        name: name.to_owned(),
        summary: summary.to_owned(),
        kind: JobKind::Evaluate,
        body,
    }
}
