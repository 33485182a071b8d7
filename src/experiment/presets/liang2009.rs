//! The scenes of J. Liang, Y. Liu, 2009, Table 1: one radar of 50 km range at the centre, 10 to 100 targets with constant
//! velocity, 30 scans 8 s apart, five false detections a scan on average; and the campaign over all of them that answers what
//! the paper says of its figures.

use super::Preset;
use crate::experiment::job::JobKind;
use serde_json::{Value, json};

const TARGETS: [u32; 5] = [10, 30, 50, 80, 100];

const MAX_SPEED_MPS: f64 = 1000.0;

/// Each component of a velocity of 0.1 to 1 km/s in any direction has this standard deviation.
const SPEED_SIGMA_MPS: f64 = 430.0;

pub(super) fn presets() -> Vec<Preset> {
    let cartesian = TARGETS.iter().map(|&count| {
        let summary =
            format!("Liang & Liu 2009: {count} targets, one radar, 30 scans; tracked by nearest neighbour from single detections on (one_point), as in the paper, and judged by the automaton.");
        preset(format!("liang2009-{count}"), summary, "kalman", json!({"method": "one_point"}), scenario_of_paper(count))
    });
    let polar = TARGETS.iter().map(|&count| {
        let summary = format!(
            "Liang & Liu 2009 with a radar that reports ranges and bearings: {count} targets, 30 scans; tracked by nearest neighbour \
             from two points on (two_point), with unbiased converted measurements, and judged by the automaton."
        );
        let noise = json!({"sigma_range_m": 15.0, "sigma_bearing_deg": 0.0052_f64.to_degrees()});
        let initiation = json!({"method": "two_point", "max_speed_mps": MAX_SPEED_MPS});
        preset(format!("liang2009-polar-{count}"), summary, "converted", initiation, scenario(count, noise))
    });
    cartesian
        .chain(polar)
        .chain([table1(), clutter(), beginnings()])
        .chain([over_scans()])
        .collect()
}

/// Targets by associators, judged by the automaton alone.
fn table1() -> Preset {
    let summary = "Liang & Liu 2009, Table 1 and Figures 1 and 2: nearest neighbour, PDA and JPDA with 10 to 100 targets, tracks begun by single \
                   detections (one_point), judged by the automaton; means with intervals, and JPDA and PDA against nearest neighbour on the same scenes.";
    let targets = json!({"by": "values", "name": "targets", "path": "/input/scenario/targets/count", "values": TARGETS});
    campaign("table1", summary, TARGETS[0], vec![targets], 200)
}

/// Clutter by associators.
fn clutter() -> Preset {
    let summary = "Liang & Liu 2009, what clutter does to each associator: 50 targets with no to 200 false detections a scan, tracks begun \
                   by single detections (one_point).";
    let path = "/input/scenario/sensors/0/clutter_per_scan";
    let clutter = json!({"by": "values", "name": "clutter", "path": path, "values": [0.0, 5.0, 20.0, 50.0, 100.0, 200.0]});
    campaign("clutter", summary, 50, vec![clutter], 100)
}

/// Tracks that begin as in the paper, and at the truth.
fn beginnings() -> Preset {
    let summary = "Liang & Liu 2009, how much the beginnings of tracks decide: from single detections (one_point), and at the true states \
                   of the first scan (truth).";
    let axes = vec![
        few_targets(),
        beginnings_by(&[("one point", "one_point"), ("truth", "truth")]),
    ];
    campaign("beginnings", summary, TARGETS[0], axes, 100)
}

/// Beginnings over several scans beside those from one detection and at the truth.
fn over_scans() -> Preset {
    let summary = "Liang & Liu 2009 with tracks that begin over several scans (multi_scan), beside beginnings from single detections and at \
                   the true states of the first scan: 10, 50 and 100 targets under four associators, with GOSPA.";
    let beginnings = beginnings_by(&[
        ("one point", "one_point"),
        ("multi-scan", "multi_scan"),
        ("truth", "truth"),
    ]);
    let axes = vec![few_targets(), beginnings];
    with_gospa(campaign("multi-scan", summary, TARGETS[0], axes, 20))
}

fn few_targets() -> Value {
    json!({"by": "values", "name": "targets", "path": "/input/scenario/targets/count", "values": [10, 50, 100]})
}

/// Names of beginnings, and their methods.
fn beginnings_by(methods: &[(&str, &str)]) -> Value {
    let variant = |(name, method): &(&str, &str)| json!({"name": name, "set": [{"path": "/tracker/initiation", "value": {"method": method}}]});
    let variants: Vec<Value> = methods.iter().map(variant).collect();
    json!({"by": "variants", "name": "beginnings", "variants": variants})
}

/// The same with global nearest neighbour and the mean GOSPA.
fn with_gospa(mut preset: Preset) -> Preset {
    let body = &mut preset.body;
    body["base"]["metrics"] = json!([{"metric": "gospa"}]);
    if let Some(base) = body["base"].as_object_mut() {
        base.shift_remove("profile");
    }
    if let Some(outcomes) = body["outcomes"].as_array_mut() {
        outcomes.push(json!({"name": "GOSPA m", "path": "metrics.gospa.quantities.gospa"}));
    }
    if let Some(variants) = body
        .pointer_mut("/grid/2/variants")
        .and_then(Value::as_array_mut)
    {
        variants.insert(1, associator(("GNN", "global_nearest_neighbour")));
    }
    preset
}

const ASSOCIATORS: [(&str, &str); 3] = [
    ("NN", "nearest_neighbour"),
    ("PDA", "pda"),
    ("JPDA", "jpda"),
];

fn associator((name, method): (&str, &str)) -> Value {
    json!({"name": name, "set": [{"path": "/associator", "value": {"method": method}}]})
}

/// Axes by associators in the paper's scene.
fn campaign(name: &str, summary: &str, targets: u32, mut axes: Vec<Value>, runs: u32) -> Preset {
    let name = format!("liang2009-{name}");
    let mut base = preset(
        String::new(),
        String::new(),
        "kalman",
        json!({"method": "one_point"}),
        scenario_of_paper(targets),
    )
    .body;
    (base["kind"], base["profile"]) = (json!("evaluate"), json!("tfa"));
    axes.push(
        json!({"by": "variants", "name": "associator", "variants": ASSOCIATORS.map(associator)}),
    );
    let outcome = |(name, path): (&str, &str)| json!({"name": name, "path": format!("tfa.{path}")});
    let outcomes = [
        ("P correct", "probability.correct"),
        ("P missed", "probability.missed"),
        ("correct per target", "ratios.correct_per_target"),
        ("tracks per target", "ratios.output_tracks_per_target"),
        ("targets", "counts.targets"),
        ("targets with a track", "counts.matched_tracks"),
        ("false tracks", "counts.false_tracks"),
        ("redundant tracks", "counts.redundant_tracks"),
    ]
    .map(outcome);
    Preset {
        summary: summary.to_owned(),
        kind: JobKind::Campaign,
        body: json!({
            "name": name,
            "seed": 1,
            "base": base,
            "grid": axes,
            "runs": runs,
            "outcomes": outcomes,
            "compare": {"axis": "associator", "to": "NN"}
        }),
        name,
    }
}

fn scenario_of_paper(count: u32) -> Value {
    scenario(count, json!({"sigma_x_m": 15.0, "sigma_y_m": 5.2}))
}

fn preset(
    name: String,
    summary: String,
    filter: &str,
    initiation: Value,
    scenario: Value,
) -> Preset {
    Preset {
        summary,
        kind: JobKind::Evaluate,
        body: json!({
            "name": name,
            "seed": 1,
            "input": {"source": "scenario", "scenario": scenario},
            "associator": {"method": "nearest_neighbour"},
            "filter": {"method": filter, "process_noise_m2ps3": 1.0},
            "tracker": {
                "gate_probability": 0.999, "initiation": initiation, "confirm_hits": 3, "confirm_window": 5, "max_missed": 5,
                "initial_speed_sigma_mps": SPEED_SIGMA_MPS
            },
            "comparison": {"gate_m": 1000.0, "credit": "afterwards"},
            "tfa": {"symbols": {"kind": "detection_id"}, "decision": {"policy": "most_probable"}, "max_missed": 5}
        }),
        name,
    }
}

/// The paper's noise is 0.015 km and 0.0052 km on the abscissa and the ordinate; its symbols suggest 0.015 km in range and
/// 0.0052 rad in bearing.
fn scenario(count: u32, noise: Value) -> Value {
    let mut sensor = json!({
        "sensor_id": "radar", "x_m": 0.0, "y_m": 0.0, "max_range_m": 50_000.0, "p_d": 0.9
    });
    for (name, value) in noise.as_object().into_iter().flatten() {
        sensor[name] = value.clone();
    }
    sensor["clutter_per_scan"] = json!(5.0);
    json!({
        "scans": 30,
        "scan_period_s": 8.0,
        "sensors": [sensor],
        "targets": {"kind": "random", "count": count, "area_side_m": 100_000.0, "speed_min_mps": 100.0, "speed_max_mps": MAX_SPEED_MPS}
    })
}
