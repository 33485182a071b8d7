//! The sea trial of Wang Y., Li Y., Huang H., multi-target data association by the bat algorithm, simulated: no recording is
//! public. The paper shows six strong targets whose courses cross, run in parallel or close; how near they come it does not say, so
//! there are three records: two in which a beam tells them apart but for some scans, and a hard one.

use super::Preset;
use super::wang_bat_claims::contenders;
use crate::experiment::job::JobKind;
use serde_json::{Value, json};

const RUNS: u32 = 100;

pub(super) fn presets() -> Vec<Preset> {
    vec![sea_trial(), record(), sea_trials()]
}

/// Two that cross, two that close and cross so slowly that the beam has both in it for seven minutes, two in parallel.
fn record() -> Preset {
    Preset {
        name: "wang-bat-record".to_owned(),
        summary: "Wang, Li & Huang, a hard record: six targets in a bearing-time record with noise and interference, two of them \
                  crossing, two closing until they cross slowly, two in parallel through a noisy sector; thresholded every 10 s and \
                  tracked by the bat algorithm."
            .to_owned(),
        kind: JobKind::Evaluate,
        body: body("wang-bat-record", &slow_crossing(), 10.0),
    }
}

/// Two that cross, two that close to four beam widths, two in parallel through a noisy sector; 15 dB.
fn sea_trial() -> Preset {
    Preset {
        name: "wang-bat-sea-trial".to_owned(),
        summary: "Wang, Li & Huang, the sea trial, simulated: six strong targets in a bearing-time record with noise and \
                  interference, crossing, closing and in parallel; thresholded every 10 s and tracked by the bat algorithm."
            .to_owned(),
        kind: JobKind::Evaluate,
        body: body("wang-bat-sea-trial", &one_crossing(), STRONG_DB),
    }
}

const STRONG_DB: f64 = 15.0;

/// The records by contenders.
fn sea_trials() -> Preset {
    let name = "wang-bat-sea-trials";
    let records = [
        record_variant("sea trial", one_crossing(), STRONG_DB),
        record_variant("three crossings", three_crossings(), STRONG_DB),
        record_variant("hard", slow_crossing(), 10.0),
    ];
    let mut base = body(name, &one_crossing(), STRONG_DB);
    (base["kind"], base["profile"]) = (json!("evaluate"), json!("vision"));
    base["metrics"] = json!([{"metric": "track_keeping"}]);
    let keeping = |quantity: &str| format!("metrics.track_keeping.quantities.{quantity}");
    Preset {
        name: name.to_owned(),
        summary: "Wang, Li & Huang, the sea trial, simulated: how often each associator keeps all six targets, in records with \
                  one crossing, with three, and with a slow one."
            .to_owned(),
        kind: JobKind::Campaign,
        body: json!({
            "name": name,
            "seed": 1,
            "base": base,
            "grid": [{"by": "variants", "name": "record", "variants": records}, contenders()],
            "runs": RUNS,
            "outcomes": [
                {"name": "identity", "path": keeping("identity"), "interval": "wilson"},
                {"name": "stay", "path": keeping("stay"), "interval": "wilson"},
                {"name": "targets kept", "path": keeping("targets_identity")},
                {"name": "error_deg", "path": keeping("mean_absolute_error")},
                {"name": "p_d", "path": "detection.p_d"},
                {"name": "false alarms", "path": "detection.false_alarms_per_scan"}
            ],
            "compare": {"axis": "associator", "to": "JPDA"}
        }),
    }
}

fn record_variant(name: &str, targets: Value, level_db: f64) -> Value {
    json!({"name": name, "set": [
        {"path": "/input/scenario/targets", "value": targets}, {"path": "/input/scenario/record/levels_db", "value": [level_db]}
    ]})
}

fn one_crossing() -> Value {
    bearings(
        vec![fast_crossing()],
        vec![line("3", 140.0, 0.01), line("4", 176.0, -0.01)],
    )
}

/// The fourth crosses the two in parallel, one soon after the other, and the third closes with the second.
fn three_crossings() -> Value {
    bearings(
        vec![fast_crossing()],
        vec![line("3", 356.0, 0.02), line("4", 345.0, -0.12)],
    )
}

fn slow_crossing() -> Value {
    let slow = json!({"centre_deg": 165.0, "half_width_deg": 12.0, "crossing_time_s": 800.0, "power": 1.6});
    bearings(vec![fast_crossing(), slow], Vec::new())
}

/// Six targets: two in parallel, and what differs between the records.
fn bearings(crossings: Vec<Value>, mut lines: Vec<Value>) -> Value {
    lines.extend([line("5", 250.0, 0.06), line("6", 260.0, 0.06)]);
    json!({"kind": "bearings", "crossings": crossings, "lines": lines})
}

fn fast_crossing() -> Value {
    json!({"centre_deg": 60.0, "half_width_deg": 30.0, "crossing_time_s": 600.0, "power": 1.0})
}

fn line(truth_id: &str, bearing_deg: f64, rate_degps: f64) -> Value {
    json!({"truth_id": truth_id, "bearing_deg": bearing_deg, "rate_degps": rate_degps})
}

fn body(name: &str, targets: &Value, level_db: f64) -> Value {
    json!({
        "name": name,
        "seed": 1,
        "input": {"source": "scenario", "scenario": {
            "scans": 120,
            "scan_period_s": 10.0,
            "sensors": [{"sensor_id": "sonar", "p_d": 0.95}],
            "targets": targets,
            "record": {
                "time_step_s": 1.0, "bearing_step_deg": 1.0, "beam_width_deg": 3.0, "noise_averages": 4,
                "levels_db": [level_db], "fluctuation_db": 2.0, "fluctuation_time_s": 30.0,
                "sectors": [{"centre_deg": 290.0, "width_deg": 50.0, "level_db": 4.0}],
                "transients": {"per_minute": 2.0, "duration_s": 3.0, "level_db": 12.0}
            }
        }},
        "detector": {"threshold": {"kind": "cell_averaging"}, "every_s": 10.0},
        "associator": {"method": "bat"},
        "filter": {"method": "bearing_only", "process_noise_deg2ps3": 1e-6},
        "tracker": {"gate_probability": 0.999_999, "initiation": {"method": "truth", "rate_sigma_degps": 0.02}}
    })
}
