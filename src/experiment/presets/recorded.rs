//! Radars that see recorded targets.

use super::Preset;
use crate::experiment::job::JobKind;
use serde_json::json;

/// A coastal radar in the Solent: P_D 0.9, 15 m and 0.1°, a scan each 3 s, 25 km, 5 false detections a scan.
pub fn presets() -> Vec<Preset> {
    let body = json!({
        "name": "ships of the Solent as a coastal radar sees them",
        "seed": 1,
        "input": {
            "source": "scenario",
            "scenario": {
                "scans": 390,
                "scan_period_s": 3.0,
                "sensors": [{
                    "sensor_id": "radar", "lat_deg": 50.77, "lon_deg": -1.2, "max_range_m": 25000.0, "p_d": 0.9,
                    "sigma_range_m": 15.0, "sigma_bearing_deg": 0.1, "clutter_per_scan": 5.0
                }],
                "targets": {"kind": "recorded", "recording": "solent", "max_gap_s": 180.0}
            }
        },
        "associator": {"method": "global_nearest_neighbour"},
        "filter": {"method": "unscented", "process_noise_m2ps3": 0.01},
        "tracker": {"initial_speed_sigma_mps": 6.0, "confirm_hits": 4, "confirm_window": 6, "max_missed": 10},
        "comparison": {"gate_m": 300.0, "credit": "afterwards"}
    });
    vec![Preset {
        name: "solent-radar".to_owned(),
        summary: "Ships of the Solent (AIS) as a coastal radar sees them, tracked and judged"
            .to_owned(),
        kind: JobKind::Evaluate,
        body,
    }]
}
