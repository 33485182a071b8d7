//! Two scenes in which fixed counts of hits and fixed densities of clutter fail.

use super::Preset;
use super::random_sets::quantity;
use crate::experiment::job::JobKind;
use serde_json::{Value, json};
use std::f64::consts::PI;

/// Of both scenes.
const GATE_PROBABILITY: f64 = 0.9999;

/// Two targets that cross at right angles, rarely detected, among clutter as dense as in Stone Soup's demonstration of
/// multi-frame assignment: 5 on 35 m by 35 m.
pub(super) fn crossing() -> Vec<Preset> {
    const RANGE_M: f64 = 35.0;
    let clutter_per_scan = 5.0 / (35.0 * 35.0) * PI * RANGE_M * RANGE_M;
    let target = |truth_id: &str, side: f64| json!({"truth_id": truth_id, "x_m": 0.0, "y_m": -20.0 * side, "vx_mps": 1.0, "vy_mps": side});
    let scenario = json!({
        "scans": 41,
        "scan_period_s": 1.0,
        "sensors": [{
            "sensor_id": "radar", "x_m": 20.0, "y_m": 0.0, "max_range_m": RANGE_M, "p_d": 0.7, "sigma_x_m": 0.7, "sigma_y_m": 0.7,
            "clutter_per_scan": clutter_per_scan
        }],
        "targets": {"kind": "listed", "targets": [target("up", 1.0), target("down", -1.0)]}
    });
    let scene = Scene {
        name: "crossing-low-pd",
        summary: "Two targets that cross at right angles and are missed in three scans of ten, or in half of them, among 16 false detections a scan.",
        scenario,
        process_noise_m2ps3: 0.005,
        speed_sigma_mps: 1.5,
        births: json!({"expected_per_s": 0.001, "expected_at_start": 2.0, "x_m": 20.0, "y_m": 0.0, "sigma_m": 20.0, "speed_sigma_mps": 1.5}),
        cutoff_m: 5.0,
    };
    let grid = json!({"by": "values", "name": "P_D", "path": "/input/scenario/sensors/0/p_d", "values": [0.7, 0.5]});
    vec![scene.campaign(grid)]
}

/// Ten targets that appear one after the other around the middle; the number of false detections of a scan is negative binomial
/// with mean 10 and variance 200, half of all scans have fewer than 5.
pub(super) fn clumped() -> Vec<Preset> {
    const RANGE_M: f64 = 169.256_875;
    let targets: Vec<Value> = (0..10).map(appearing).collect();
    let scenario = json!({
        "scans": 81,
        "scan_period_s": 1.0,
        "sensors": [{
            "sensor_id": "radar", "x_m": 150.0, "y_m": 150.0, "max_range_m": RANGE_M, "p_d": 0.9, "sigma_x_m": 2.0, "sigma_y_m": 2.0,
            "clutter_per_scan": 10.0
        }],
        "targets": {"kind": "maneuvering", "targets": targets}
    });
    let scene = Scene {
        name: "clumped-clutter",
        summary: "Ten targets that appear one by one, with a Poisson number of 10 false detections a scan and with a negative binomial one of the \
                  same mean and twenty times its variance.",
        scenario,
        process_noise_m2ps3: 0.01,
        speed_sigma_mps: 1.0,
        births: json!({"expected_per_s": 0.1, "expected_at_start": 0.1, "x_m": 150.0, "y_m": 150.0, "sigma_m": 50.0, "speed_sigma_mps": 1.0}),
        cutoff_m: 10.0,
    };
    let grid = json!({
        "by": "values", "name": "variance over mean", "path": "/input/scenario/sensors/0/clutter_dispersion", "values": [1.0, 20.0]
    });
    vec![scene.campaign(grid)]
}

/// The k-th appears 5 + 7 k s after the start, on a circle around the middle, and goes 1 m/s across the line from there.
fn appearing(number: u32) -> Value {
    let turn_rad = 2.399_963 * f64::from(number);
    let distance_m = 15.0 * f64::from(number + 1).sqrt();
    json!({
        "truth_id": number.to_string(),
        "x_m": 150.0 + distance_m * turn_rad.cos(), "y_m": 150.0 + distance_m * turn_rad.sin(),
        "vx_mps": -turn_rad.sin(), "vy_mps": turn_rad.cos(),
        "start_s": 5.0 + 7.0 * f64::from(number)
    })
}

struct Scene {
    name: &'static str,
    summary: &'static str,
    scenario: Value,
    process_noise_m2ps3: f64,
    speed_sigma_mps: f64,
    /// Of targets that the Poisson multi-Bernoulli filter expects.
    births: Value,
    cutoff_m: f64,
}

impl Scene {
    /// Trackers on the same scenes, over this axis.
    fn campaign(&self, axis: Value) -> Preset {
        let base = json!({
            "kind": "evaluate",
            "input": {"source": "scenario", "scenario": self.scenario},
            "filter": {"method": "kalman", "process_noise_m2ps3": self.process_noise_m2ps3},
            "comparison": {"gate_m": self.cutoff_m, "credit": "afterwards"},
            "metrics": [{"metric": "gospa", "cutoff_m": self.cutoff_m}, {"metric": "t_gospa", "cutoff_m": self.cutoff_m}],
            "tfa": {"symbols": {"kind": "detection_id"}, "decision": {"policy": "most_probable"}, "max_missed": 5}
        });
        Preset {
            name: self.name.to_owned(),
            summary: self.summary.to_owned(),
            kind: JobKind::Campaign,
            body: json!({
                "name": self.name,
                "seed": 1,
                "runs": 100,
                "timed_runs": 5,
                "base": base,
                "grid": [axis, {"by": "variants", "name": "tracker", "variants": self.trackers()}],
                "outcomes": [
                    quantity("GOSPA m", "gospa.quantities.gospa"),
                    quantity("missed m²", "gospa.quantities.missed_mean"),
                    quantity("false m²", "gospa.quantities.false_mean"),
                    quantity("trajectory GOSPA", "t_gospa.quantities.t_gospa"),
                    {"name": "correct per target", "path": "tfa.ratios.correct_per_target"}
                ]
            }),
        }
    }

    fn trackers(&self) -> Vec<Value> {
        let m_of_n = |hits: u32, window: u32, missed: u32| json!({"confirm_hits": hits, "confirm_window": window, "max_missed": missed});
        let exist = json!({"initiation": {"method": "multi_scan"}, "confirmation": {"rule": "existence", "lifetime_s": 200.0}});
        let undetected = json!({"births": {"method": "gaussian", "components": [self.births]}, "lifetime_s": 200.0});
        let pmb = json!({"method": "poisson_multi_bernoulli", "undetected": undetected});
        vec![
            self.tracker(
                "GNN 3/5, 3 misses",
                "global_nearest_neighbour",
                m_of_n(3, 5, 3),
            ),
            self.tracker(
                "GNN 4/6, 5 misses",
                "global_nearest_neighbour",
                m_of_n(4, 6, 5),
            ),
            self.tracker("JPDA 4/6, 5 misses", "jpda", m_of_n(4, 6, 5)),
            self.tracker("JPDA, existence", "jpda", exist),
            self.tracker("PMB", "jpda", pmb),
        ]
    }

    fn tracker(&self, name: &str, associator: &str, mut tracker: Value) -> Value {
        tracker["gate_probability"] = json!(GATE_PROBABILITY);
        tracker["initial_speed_sigma_mps"] = json!(self.speed_sigma_mps);
        json!({"name": name, "set": [
            {"path": "/associator", "value": {"method": associator}},
            {"path": "/tracker", "value": tracker}
        ]})
    }
}
