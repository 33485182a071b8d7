//! Two radars on a curved Earth.

use super::Preset;
use crate::experiment::job::JobKind;
use serde_json::{Value, json};

/// Radars 154 km apart, and an airliner at 11 km that is 309 km from the first one when it begins. Its axes and those of the second
/// radar are turned by 1.4° against the first's: on a flat Earth the two see it 5.3 km apart.
pub(super) fn presets() -> Vec<Preset> {
    let body = json!({
        "name": "an airliner 300 km away, seen by two radars on a curved Earth",
        "seed": 1,
        "input": {"source": "scenario", "scenario": {
            "scans": 100,
            "scan_period_s": 5.0,
            "origin": {"lat_deg": 50.1109, "lon_deg": 8.6821, "height_m": 112.0},
            "sensors": [radar("Frankfurt", [50.1109, 8.6821, 112.0]), radar("Cologne", [50.9, 6.9, 150.0])],
            "targets": {"kind": "listed", "targets": [{
                "truth_id": "1", "x_m": -240_473.3, "y_m": 193_813.5, "z_m": 3_425.9,
                "vx_mps": 180.0, "vy_mps": -120.0, "vz_mps": 6.0
            }]}
        }},
        "associator": {"method": "global_nearest_neighbour"},
        "filter": {"method": "converted", "process_noise_m2ps3": 0.01, "vertical_process_noise_m2ps3": 0.0001},
        "tracker": {"gate_probability": 0.999_99, "initial_speed_sigma_mps": 150.0},
        "metrics": [{"metric": "clear"}, {"metric": "kinematics"}],
        "comparison": {"gate_m": 2000.0, "credit": "afterwards"}
    });
    vec![Preset {
        name: "two-radars".to_owned(),
        summary: "Two radars 154 km apart measure ranges, bearings and elevations of an airliner 309 km away, each on the axes of its own \
                  place on a curved Earth; tracked in space."
            .to_owned(),
        kind: JobKind::Evaluate,
        body,
    }]
}

fn radar(sensor_id: &str, [lat_deg, lon_deg, height_m]: [f64; 3]) -> Value {
    json!({
        "sensor_id": sensor_id, "lat_deg": lat_deg, "lon_deg": lon_deg, "height_m": height_m, "max_range_m": 400_000.0, "p_d": 0.9,
        "sigma_range_m": 50.0, "sigma_bearing_deg": 0.05, "sigma_elevation_deg": 0.05, "clutter_per_scan": 2.0
    })
}
