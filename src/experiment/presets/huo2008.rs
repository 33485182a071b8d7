//! The setting of Huo Liang et al. 2008, three sensors and ten targets, and grids around it: spacing, missing tracks, false tracks,
//! errors in common, costs, bias and size, every correlator on the same tracks.
//!
//! The paper gives the coding of three sensors and ten targets and no numbers: spacing, noise and times are chosen here.

use super::Preset;
use crate::correlation::CORRELATORS;
use crate::experiment::job::JobKind;
use serde_json::{Value, json};

pub(super) fn presets() -> Vec<Preset> {
    // Without a correlator there is nothing to preset.
    let Some(first) = CORRELATORS
        .iter()
        .find(|method| method.name == "genetic")
        .or(CORRELATORS.first())
    else {
        return Vec::new();
    };
    let body = json!({
        "name": "huo2008",
        "seed": 1,
        "input": {"source": "local_tracks", "tracks": {"sensors": 3, "targets": 10}},
        "correlator": {"method": first.name}
    });
    let mut presets = vec![Preset {
        name: "huo2008".to_owned(),
        summary: "Huo et al. 2008: tracks of three sensors and ten targets, put together by the genetic algorithm.".to_owned(),
        kind: JobKind::Correlate,
        body: body.clone(),
    }];
    let path = |field: &str| format!("/input/tracks/{field}");
    let values = |name: &str, field: &str, values: Value| json!({"by": "values", "name": name, "path": path(field), "values": values});
    let size = |sensors: u32, targets: u32| {
        json!({"name": format!("{sensors} × {targets}"), "set": [
            {"path": path("sensors"), "value": sensors}, {"path": path("targets"), "value": targets}, {"path": path("p_d"), "value": 0.9}
        ]})
    };
    let sizes = [(3, 10), (3, 50), (5, 50), (10, 50), (10, 200)]
        .map(|(sensors, targets)| size(sensors, targets));
    let grids = [
        (
            "spacing",
            20,
            values("spacing (m)", "spacing_m", json!([150.0, 250.0, 500.0])),
        ),
        ("p-d", 20, values("P_D", "p_d", json!([0.7, 0.9, 1.0]))),
        (
            "false-tracks",
            20,
            values("false tracks", "false_tracks", json!([0.0, 2.0, 5.0])),
        ),
        ("cross-correlation", 20, cross_correlations()),
        ("statistic", 20, statistics()),
        (
            "bias",
            20,
            values("bias (m)", "bias_m", json!([0.0, 100.0, 200.0])),
        ),
        (
            "size",
            1,
            json!({"by": "variants", "name": "sensors × targets", "variants": sizes}),
        ),
    ];
    presets.extend(
        grids
            .into_iter()
            .map(|(name, runs, axis)| grid(&body, name, runs, &axis)),
    );
    presets.push(study(&body));
    presets
}

/// The setting of the paper and one change of it at a time, every correlator and the paper's own coding, all against the optimum.
fn study(body: &Value) -> Preset {
    let setting = |name: &str, tracks: Value, more: &[(&str, Value)]| {
        let of_tracks = tracks
            .as_object()
            .into_iter()
            .flatten()
            .map(|(field, value)| (format!("/input/tracks/{field}"), value.clone()));
        let of_job = more
            .iter()
            .map(|(path, value)| ((*path).to_owned(), value.clone()));
        let set: Vec<Value> = of_tracks
            .chain(of_job)
            .map(|(path, value)| json!({"path": path, "value": value}))
            .collect();
        json!({"name": name, "set": set})
    };
    let in_common = [(
        "/cross_covariance",
        json!({"kind": "coefficient", "coefficient": 0.5}),
    )];
    let settings = [
        setting("3 × 10", json!({}), &[]),
        setting("spacing 250 m", json!({"spacing_m": 250.0}), &[]),
        setting("spacing 150 m", json!({"spacing_m": 150.0}), &[]),
        setting("P_D 0.9", json!({"p_d": 0.9}), &[]),
        setting("P_D 0.7", json!({"p_d": 0.7}), &[]),
        setting("2 false tracks", json!({"false_tracks": 2.0}), &[]),
        setting("5 false tracks", json!({"false_tracks": 5.0}), &[]),
        setting("bias 100 m", json!({"bias_m": 100.0}), &[]),
        setting("bias 200 m", json!({"bias_m": 200.0}), &[]),
        setting(
            "errors in common, 250 m",
            json!({"cross_correlation": 0.5, "spacing_m": 250.0}),
            &in_common,
        ),
        setting(
            "all pairs, 250 m, P_D 0.9",
            json!({"spacing_m": 250.0, "p_d": 0.9}),
            &[("/statistic", json!({"kind": "all_pairs"}))],
        ),
        setting("3 × 50, P_D 0.9", json!({"targets": 50, "p_d": 0.9}), &[]),
        setting(
            "5 × 50, P_D 0.9",
            json!({"sensors": 5, "targets": 50, "p_d": 0.9}),
            &[],
        ),
    ];
    let mut preset = grid(
        body,
        "study",
        20,
        &json!({"by": "variants", "name": "setting", "variants": settings}),
    );
    let published = json!({"method": "genetic", "variant": "paper", "population": 100, "generations": 500, "stop_after": 100});
    if let Some(variants) = preset.body["grid"][1]["variants"].as_array_mut() {
        variants.push(json!({"name": "genetic, the paper's coding", "set": [{"path": "/correlator", "value": published}]}));
    }
    preset.body["compare"] = json!({"axis": "correlator", "to": "exact"});
    preset.summary = "Huo et al. 2008: three sensors and ten targets and one change of that at a time, every correlator and the genetic \
                      algorithm with the paper's coding, against the optimum."
        .to_owned();
    preset
}

/// Errors that the sensors have in common, and costs that know of them.
fn cross_correlations() -> Value {
    let variant = |coefficient: f64| {
        json!({"name": coefficient.to_string(), "set": [
            {"path": "/input/tracks/cross_correlation", "value": coefficient},
            {"path": "/input/tracks/spacing_m", "value": 250.0},
            {"path": "/cross_covariance", "value": {"kind": "coefficient", "coefficient": coefficient}}
        ]})
    };
    let variants = [0.25, 0.5, 0.75].map(variant);
    json!({"by": "variants", "name": "cross-correlation", "variants": variants})
}

/// Close targets, missing and false tracks under every cost of a tuple.
fn statistics() -> Value {
    let variant = |kind: &str| {
        json!({"name": kind, "set": [
            {"path": "/statistic", "value": {"kind": kind}},
            {"path": "/input/tracks/spacing_m", "value": 250.0},
            {"path": "/input/tracks/p_d", "value": 0.9},
            {"path": "/input/tracks/false_tracks", "value": 1.0}
        ]})
    };
    let variants = ["chain", "all_pairs", "fused", "likelihood_ratio"].map(variant);
    json!({"by": "variants", "name": "statistic", "variants": variants})
}

fn grid(body: &Value, name: &str, runs: u32, axis: &Value) -> Preset {
    let mut base = body.clone();
    base["kind"] = json!("correlate");
    let methods: Vec<Value> = CORRELATORS
        .iter()
        .map(|method| json!({"name": method.name, "set": [{"path": "/correlator", "value": {"method": method.name}}]}))
        .collect();
    let outcome = |name: &str, path: &str| json!({"name": name, "path": path});
    Preset {
        name: format!("huo2008-{name}"),
        summary: format!("Every correlator on the tracks of huo2008 over a grid: {name}."),
        kind: JobKind::Campaign,
        body: json!({
            "name": format!("huo2008-{name}"),
            "seed": 1,
            "base": base,
            "grid": [axis, {"by": "variants", "name": "correlator", "variants": methods}],
            "runs": runs,
            "outcomes": [
                outcome("tuples right", "truth.share_right"),
                outcome("precision", "truth.pairwise_precision"),
                outcome("recall", "truth.pairwise_recall"),
                outcome("J", "cost"),
                outcome("gap", "gap")
            ]
        }),
    }
}
