//! The scenes of J. Liang, Y. Liu, 2009, Table 1: one radar of 50 km range at the centre, 10 to 100 targets with constant
//! velocity, 30 scans 8 s apart, five false detections a scan on average.

use super::Preset;
use crate::experiment::plan::JobKind;
use serde_json::{Value, json};

const TARGETS: [u32; 5] = [10, 30, 50, 80, 100];

pub(super) fn presets() -> Vec<Preset> {
    TARGETS.iter().map(|&count| preset(count)).collect()
}

fn preset(count: u32) -> Preset {
    let name = format!("liang2009-{count}");
    Preset {
        summary: format!(
            "Liang & Liu 2009: {count} targets, one radar, 30 scans; tracked by nearest neighbour and judged by the automaton."
        ),
        kind: JobKind::Evaluate,
        body: json!({
            "name": name,
            "seed": 1,
            "input": {"source": "scenario", "scenario": scenario(count)},
            "associator": {"method": "nearest_neighbour"},
            "filter": {"method": "kalman", "process_noise_m2ps3": 1.0},
            "tracker": {
                "gate_probability": 0.999, "confirm_hits": 3, "confirm_window": 5, "max_missed": 5, "initial_speed_sigma_mps": 430.0
            },
            "tfa": {"symbols": {"kind": "detection_id"}, "decision": {"policy": "most_probable"}, "max_missed": 5}
        }),
        name,
    }
}

/// The paper's noise is 0.015 km and 0.0052 km on the abscissa and the ordinate; speeds are 0.1 to 1 km/s, of which
/// each component has a standard deviation of 430 m/s.
fn scenario(count: u32) -> Value {
    json!({
        "scans": 30,
        "scan_period_s": 8.0,
        "sensors": [{
            "sensor_id": "radar", "x_m": 0.0, "y_m": 0.0, "max_range_m": 50_000.0, "p_d": 0.9,
            "sigma_x_m": 15.0, "sigma_y_m": 5.2, "clutter_per_scan": 5.0
        }],
        "targets": {"kind": "random", "count": count, "area_side_m": 100_000.0, "speed_min_mps": 100.0, "speed_max_mps": 1000.0}
    })
}
