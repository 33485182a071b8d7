//! The sea trial of Wang Y., Li Y., Huang H., multi-target data association by the bat algorithm, simulated: no recording is
//! public.

use super::Preset;
use crate::experiment::job::JobKind;
use serde_json::json;

/// The record of six strong targets: a pair that crosses, one that closes and meets, one that runs in parallel.
pub(super) fn presets() -> Vec<Preset> {
    vec![record()]
}

fn record() -> Preset {
    let name = "wang-bat-record".to_owned();
    Preset {
        summary: "Wang, Li & Huang, sea trial, simulated: six targets in a bearing-time record with noise and interference, two of them \
                  crossing, two closing until they cross slowly, two in parallel through a noisy sector; thresholded every 10 s and \
                  tracked by the bat algorithm."
            .to_owned(),
        kind: JobKind::Evaluate,
        body: json!({
            "name": name,
            "seed": 1,
            "input": {"source": "scenario", "scenario": {
                "scans": 120,
                "scan_period_s": 10.0,
                "sensors": [{"sensor_id": "sonar", "p_d": 0.95}],
                "targets": {
                    "kind": "bearings",
                    "crossings": [
                        {"centre_deg": 60.0, "half_width_deg": 30.0, "crossing_time_s": 600.0, "power": 1.0},
                        {"centre_deg": 165.0, "half_width_deg": 12.0, "crossing_time_s": 800.0, "power": 1.6}
                    ],
                    "lines": [
                        {"truth_id": "5", "bearing_deg": 250.0, "rate_degps": 0.06},
                        {"truth_id": "6", "bearing_deg": 260.0, "rate_degps": 0.06}
                    ]
                },
                "record": {
                    "time_step_s": 1.0, "bearing_step_deg": 1.0, "beam_width_deg": 3.0, "noise_averages": 4,
                    "levels_db": [10.0], "fluctuation_db": 2.0, "fluctuation_time_s": 30.0,
                    "sectors": [{"centre_deg": 290.0, "width_deg": 50.0, "level_db": 4.0}],
                    "transients": {"per_minute": 2.0, "duration_s": 3.0, "level_db": 12.0}
                }
            }},
            "detector": {"threshold": {"kind": "cell_averaging"}, "every_s": 10.0},
            "associator": {"method": "bat"},
            "filter": {"method": "bearing_only", "process_noise_deg2ps3": 1e-6},
            "tracker": {"gate_probability": 0.999_999, "initiation": {"method": "truth", "rate_sigma_degps": 0.02}}
        }),
        name,
    }
}
