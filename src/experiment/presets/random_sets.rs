//! Scenes in which trackers with a probability of existence show their worth.

use super::Preset;
use crate::experiment::job::JobKind;
use serde_json::{Value, json};

/// The density of 10 false detections a scan in 300 m by 300 m, in a circle of the same area.
const RANGE_M: f64 = 169.256_875;
/// A target survives a scan of 1 s with probability 0.99.
const LIFETIME_S: f64 = 99.499_162;

/// The scene of Williams 2015: four targets that meet at scan 41, where one is gone. Births as there.
pub(super) fn williams() -> Vec<Preset> {
    let alone = Preset {
        name: "williams2015-pmb".to_owned(),
        summary: "Williams 2015: four targets within a metre of each other at scan 41, P_D 0.9, 10 false detections a scan; tracked by \
                  the Poisson multi-Bernoulli filter, judged by GOSPA."
            .to_owned(),
        kind: JobKind::Evaluate,
        body: body("williams2015-pmb"),
    };
    vec![alone, campaign()]
}

/// P_D by trackers.
fn campaign() -> Preset {
    let mut base = body("");
    base["kind"] = json!("evaluate");
    let pmb = poisson_multi_bernoulli();
    let mut apart = variant("PMB, JPDA*", "jpda", &pmb);
    apart["set"][0]["value"]["against_coalescence"] = json!("best_permutation");
    let variants = [
        variant(
            "GNN 2/3, 3 misses",
            "global_nearest_neighbour",
            &m_of_n(2, 3, 3),
        ),
        variant(
            "GNN 3/5, 3 misses",
            "global_nearest_neighbour",
            &m_of_n(3, 5, 3),
        ),
        variant(
            "GNN 3/5, 5 misses",
            "global_nearest_neighbour",
            &m_of_n(3, 5, 5),
        ),
        variant("JPDA 3/5, 5 misses", "jpda", &m_of_n(3, 5, 5)),
        variant("JIPDA, one point", "jpda", &existence("one_point")),
        variant("JIPDA, multi-scan", "jpda", &existence("multi_scan")),
        variant("PMB, GNN", "global_nearest_neighbour", &pmb),
        variant("PMB", "jpda", &pmb),
        apart,
    ];
    Preset {
        name: "williams2015".to_owned(),
        summary: "Williams 2015, trackers with M of N, with a probability of existence and with undetected targets on the same scenes: \
                  GOSPA with c = 10 m and p = 2 and its parts, whose means add up to the mean of its square."
            .to_owned(),
        kind: JobKind::Campaign,
        body: json!({
            "name": "williams2015",
            "seed": 1,
            "runs": 100,
            "base": base,
            "grid": [
                {"by": "values", "name": "P_D", "path": "/input/scenario/sensors/0/p_d", "values": [0.9, 0.7]},
                {"by": "variants", "name": "tracker", "variants": variants}
            ],
            "outcomes": [
                quantity("GOSPA m", "gospa.quantities.gospa"),
                quantity("localisation m²", "gospa.quantities.localisation_mean"),
                quantity("missed m²", "gospa.quantities.missed_mean"),
                quantity("false m²", "gospa.quantities.false_mean"),
                quantity("trajectory GOSPA", "t_gospa.quantities.t_gospa")
            ]
        }),
    }
}

pub(super) fn quantity(name: &str, path: &str) -> Value {
    json!({"name": name, "path": format!("metrics.{path}")})
}

fn m_of_n(hits: u32, window: u32, missed: u32) -> Value {
    settings(json!({"confirm_hits": hits, "confirm_window": window, "max_missed": missed}))
}

fn variant(name: &str, associator: &str, tracker: &Value) -> Value {
    json!({"name": name, "set": [
        {"path": "/associator", "value": {"method": associator}},
        {"path": "/tracker", "value": tracker}
    ]})
}

/// What all trackers have alike.
fn settings(more: Value) -> Value {
    let mut settings = json!({"gate_probability": 0.9999, "initial_speed_sigma_mps": 1.0});
    if let (Some(settings), Some(more)) = (settings.as_object_mut(), more.as_object()) {
        settings.extend(more.clone());
    }
    settings
}

fn existence(initiation: &str) -> Value {
    settings(json!({
        "initiation": {"method": initiation},
        "confirmation": {"rule": "existence", "lifetime_s": LIFETIME_S}
    }))
}

/// With the births of the scene.
fn poisson_multi_bernoulli() -> Value {
    let birth = json!({
        "expected_per_s": 0.005, "expected_at_start": 3.0, "x_m": 100.0, "y_m": 100.0, "sigma_m": 150.0, "speed_sigma_mps": 1.0
    });
    settings(json!({"method": "poisson_multi_bernoulli", "undetected": {
        "births": {"method": "gaussian", "components": [birth]},
        "lifetime_s": LIFETIME_S
    }}))
}

/// Tracked by the Poisson multi-Bernoulli filter.
fn body(name: &str) -> Value {
    json!({
        "name": name,
        "seed": 1,
        "input": {"source": "scenario", "scenario": {
            "scans": 81,
            "scan_period_s": 1.0,
            "sensors": [{
                "sensor_id": "radar", "x_m": 150.0, "y_m": 150.0, "max_range_m": RANGE_M, "p_d": 0.9, "sigma_x_m": 1.0, "sigma_y_m": 1.0,
                "clutter_per_scan": 10.0
            }],
            "targets": {
                "kind": "meeting", "count": 4, "leaving": 1, "meeting_s": 40.0, "x_m": 150.0, "y_m": 150.0,
                "sigma_m": 0.1f64.sqrt(), "speed_sigma_mps": 0.1f64.sqrt(), "process_noise_m2ps3": 0.02
            }
        }},
        "associator": {"method": "jpda"},
        "filter": {"method": "kalman", "process_noise_m2ps3": 0.02},
        "tracker": poisson_multi_bernoulli(),
        "comparison": {"gate_m": 10.0, "credit": "afterwards"},
        "metrics": [{"metric": "gospa", "cutoff_m": 10.0}, {"metric": "t_gospa", "cutoff_m": 10.0}]
    })
}
