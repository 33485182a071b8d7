//! The experiments of Wang Y., Li Y., Huang H., multi-target data association by the bat algorithm: bearings of targets that
//! cross, tracked from their true starts by one filter under one associator after another.
//!
//! The paper's numbers are lost and its geometry is told in part: bearings from 250° and 280° that cross near 65 s, P_D 0.95,
//! clutter 0.1 per degree in the gates, noise 0.3° and 0.6°; six targets with several crossings at 0.35°. The rest is chosen so
//! that hard decisions are right most of the time and not always: targets linger near the crossing (power 1.6 and 1.2).

use super::Preset;
use crate::experiment::job::JobKind;
use serde_json::{Value, json};

/// P_G of a gate of five standard deviations in one dimension.
const FIVE_SIGMA: f64 = 0.999_999_426_696_856;

pub(super) struct Scene {
    pub crossings: Value,
    scans: u32,
    sigma_deg: f64,
    /// q², deg²/s³.
    process_noise: f64,
    clutter_within_deg: f64,
}

/// Two targets that cross once.
pub(super) fn two_targets() -> Scene {
    Scene {
        crossings: json!([{"centre_deg": 265.0, "half_width_deg": 15.0, "crossing_time_s": 65.0, "power": 1.6}]),
        scans: 131,
        sigma_deg: 0.3,
        process_noise: 0.015 * 0.015,
        clutter_within_deg: 5.0,
    }
}

/// Two of the targets of the larger scene.
pub(super) fn pair(centre_deg: f64, crossing_time_s: f64) -> Value {
    json!({"centre_deg": centre_deg, "half_width_deg": 30.0, "crossing_time_s": crossing_time_s, "power": 1.2})
}

/// Six targets, each of which crosses several others.
pub(super) fn six_targets(clutter_within_deg: f64) -> Scene {
    Scene {
        crossings: json!([pair(235.0, 55.0), pair(255.0, 70.0), pair(275.0, 85.0)]),
        scans: 141,
        sigma_deg: 0.35,
        process_noise: 0.02 * 0.02,
        clutter_within_deg,
    }
}

pub(super) fn presets() -> Vec<Preset> {
    let (two, six) = (two_targets(), six_targets(5.0));
    let noise = json!({"by": "values", "name": "sigma_deg", "path": "/input/scenario/sensors/0/sigma_bearing_deg", "values": [0.3, 0.6]});
    vec![
        preset(
            "wang-bat-2",
            "two targets that cross once, noise 0.3° and 0.6°",
            &two,
            &[noise, contenders()],
            100,
        ),
        preset(
            "wang-bat-6",
            "six targets with several crossings",
            &six,
            &[contenders()],
            100,
        ),
        preset(
            "wang-bat-6-ungated",
            "six targets, JPDA's events listed with and without gates beside the bats",
            &six_targets(2.5),
            &[ungated()],
            5,
        ),
        preset(
            "wang-bat-tables",
            "two targets with noise 0.3° and 0.6°, and six targets, in one",
            &two,
            &[scenes(), contenders()],
            1000,
        ),
    ]
}

/// The scenes of the tables as an axis.
pub(super) fn scenes() -> Value {
    let (two, six) = (&two_targets(), &six_targets(5.0));
    let variant = |name: &str, scene: &Scene, sigma_deg: f64| {
        let mut scenario = scenario(scene);
        scenario["sensors"][0]["sigma_bearing_deg"] = json!(sigma_deg);
        json!({"name": name, "set": [
            {"path": "/input/scenario", "value": scenario}, {"path": "/filter/process_noise_deg2ps3", "value": scene.process_noise}
        ]})
    };
    let variants = [
        variant("two, 0.3°", two, 0.3),
        variant("two, 0.6°", two, 0.6),
        variant("six, 0.35°", six, six.sigma_deg),
    ];
    json!({"by": "variants", "name": "scene", "variants": variants})
}

fn scenario(scene: &Scene) -> Value {
    json!({
        "scans": scene.scans,
        "scan_period_s": 1.0,
        "sensors": [{
            "sensor_id": "sonar", "p_d": 0.95, "sigma_bearing_deg": scene.sigma_deg, "clutter_per_deg": 0.1,
            "clutter_within_deg": scene.clutter_within_deg
        }],
        "targets": {"kind": "bearings", "crossings": scene.crossings}
    })
}

pub(super) fn preset(
    name: &str,
    summary: &str,
    scene: &Scene,
    grid: &[Value],
    runs: u32,
) -> Preset {
    let base = json!({
        "kind": "evaluate",
        "input": {"source": "scenario", "scenario": scenario(scene)},
        "filter": {"method": "bearing_only", "process_noise_deg2ps3": scene.process_noise},
        "tracker": {"gate_probability": FIVE_SIGMA, "initiation": {"method": "truth", "rate_sigma_degps": 0.1}},
        "profile": "vision",
        "metrics": [{"metric": "track_keeping"}]
    });
    let keeping = |quantity: &str| format!("metrics.track_keeping.quantities.{quantity}");
    Preset {
        name: name.to_owned(),
        summary: format!(
            "Wang, Li & Huang: {summary}. Share of runs in which every track stays with its target, error and time of each associator."
        ),
        kind: JobKind::Campaign,
        body: json!({
            "name": name,
            "seed": 1,
            "base": base,
            "grid": grid,
            "runs": runs,
            "outcomes": [
                {"name": "identity", "path": keeping("identity"), "interval": "wilson"},
                {"name": "stay", "path": keeping("stay"), "interval": "wilson"},
                {"name": "error_deg", "path": keeping("mean_absolute_error")},
                {"name": "error_kept_deg", "path": keeping("mean_absolute_error"), "where": keeping("identity")},
                {"name": "optimum_reached", "path": "association.diagnostics.optimum.share_reached"},
                {"name": "gap", "path": "association.diagnostics.optimum.mean_gap"}
            ],
            "compare": {"axis": "associator", "to": "JPDA, enumerated"}
        }),
    }
}

pub(super) fn axis(variants: Vec<Value>) -> Value {
    json!({"by": "variants", "name": "associator", "variants": variants})
}

pub(super) fn variant(name: &str, associator: Value) -> Value {
    json!({"name": name, "set": [{"path": "/associator", "value": associator}]})
}

fn contenders() -> Value {
    let nearest = |rule: &str| json!({"method": "nearest_neighbour", "conflicts": rule});
    let jpda = |marginals: &str| json!({"method": "jpda", "marginals": marginals});
    let bats = |objective: &str, weights: &str| json!({"method": "bat", "objective": objective, "weights": weights});
    axis(vec![
        variant("NN, shared", nearest("shared")),
        variant("NN, in turn", nearest("in_turn")),
        variant("NN, closest pair", nearest("closest_pair")),
        variant("GNN", json!({"method": "global_nearest_neighbour"})),
        variant("PDA", json!({"method": "pda"})),
        variant("JPDA, enumerated", jpda("enumerate")),
        variant("JPDA, exact", jpda("exact")),
        variant("BADA, sum", bats("likelihood_sum", "best")),
        variant("BADA, ratio", bats("log_likelihood_ratio", "best")),
        variant("BADA, sum, visited", bats("likelihood_sum", "visited")),
        variant(
            "BADA, ratio, visited",
            bats("log_likelihood_ratio", "visited"),
        ),
    ])
}

/// Listing every event of the scan, as a JPDA without gates does, against the bats.
fn ungated() -> Value {
    let enumerated = json!({"method": "jpda", "marginals": "enumerate", "max_events": 5_000_000});
    let without_gate = json!([
        {"path": "/associator", "value": enumerated},
        {"path": "/tracker/gate_probability", "value": 1.0}
    ]);
    axis(vec![
        variant(
            "JPDA, enumerated",
            json!({"method": "jpda", "marginals": "enumerate"}),
        ),
        json!({"name": "JPDA, enumerated without gates", "set": without_gate}),
        variant("BADA, sum", json!({"method": "bat"})),
    ])
}
