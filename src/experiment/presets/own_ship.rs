//! A ship that hears another one and turns, so that its bearings tell how far that is.

use super::Preset;
use crate::experiment::job::JobKind;
use serde_json::json;

/// Sixty bearings of half a degree in twenty minutes, at 5 m/s first east, then north: without the turn the range would stay unknown.
pub(super) fn presets() -> Vec<Preset> {
    let course = json!({"vx_mps": 5.0, "vy_mps": 0.0, "segments": [
        {"move": "straight", "duration_s": 595.0},
        {"move": "turn", "duration_s": 10.0, "rate_degps": 9.0}
    ]});
    let sensor = json!({
        "sensor_id": "sonar", "x_m": 0.0, "y_m": 0.0, "course": course, "max_range_m": 40_000.0, "p_d": 1.0,
        "sigma_bearing_deg": 0.5
    });
    let target =
        json!({"truth_id": "1", "x_m": 4000.0, "y_m": 8000.0, "vx_mps": -3.0, "vy_mps": -2.0});
    let body = json!({
        "name": "own-ship-bearings",
        "seed": 1,
        "input": {"source": "scenario", "scenario": {
            "scans": 60,
            "scan_period_s": 20.0,
            "sensors": [sensor],
            "targets": {"kind": "listed", "targets": [target]}
        }},
        "sensors": [{
            "sensor_id": "sonar", "range_min_m": 1000.0, "range_max_m": 32_000.0, "range_filters": 5
        }],
        "associator": {"method": "global_nearest_neighbour"},
        "filter": {"method": "extended", "process_noise_m2ps3": 0.0},
        "tracker": {
            "gate_probability": 0.999_999, "confirm_hits": 1, "confirm_window": 1, "initial_speed_sigma_mps": 5.0
        },
        "comparison": {"gate_m": 40_000.0, "credit": "afterwards"},
        "metrics": [{"metric": "kinematics"}]
    });
    vec![Preset {
        name: "own-ship-bearings".to_owned(),
        summary: "Bearings alone from a ship that turns half way, 60 of 0.5° in 20 minutes: the track starts at five ranges from 1 to 32 km."
            .to_owned(),
        kind: JobKind::Evaluate,
        body,
    }]
}
