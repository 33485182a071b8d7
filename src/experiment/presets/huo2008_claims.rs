//! Campaigns that decide single claims of Huo et al. 2008, on drawn tracks as in [`super::huo2008`].

use super::Preset;
use crate::correlation::CORRELATORS;
use crate::experiment::job::JobKind;
use serde_json::{Value, json};

pub(super) fn presets() -> Vec<Preset> {
    // Each of them looks at several correlators; a program without one has none of them.
    if CORRELATORS.len() < 7 {
        return Vec::new();
    }
    vec![
        printed(),
        confirmation(),
        integer_programming(),
        nodes(),
        relaxation(),
        alpha(),
    ]
}

/// The coding, the rates and the problem of the paper beside its coding with absences and the optimum of the same tracks.
fn printed() -> Preset {
    let settings = [
        ("3 × 10", json!({})),
        ("3 × 10, 250 m", json!({"spacing_m": 250.0})),
        ("5 × 50", json!({"sensors": 5, "targets": 50})),
    ]
    .map(|(name, tracks)| variant(name, &[("/input/tracks", tracks)]));
    let contenders = [
        ("exact", json!({"method": "exact"})),
        ("as printed", published(true)),
        ("with absences", published(false)),
    ];
    campaign(
        "printed",
        "the problem as printed, complete tuples and b, by the genetic algorithm as printed",
        15,
        &base(json!({})),
        &[
            axis("setting", &settings),
            axis("correlator", &contenders.map(by_correlator)),
        ],
    )
}

/// The N/M rule on decisions of all times so far and of one time each, by the optimum and by the algorithm as printed.
fn confirmation() -> Preset {
    let deciders = [
        ("optimum, all times", "all", json!({"method": "exact"})),
        ("optimum, one time", "latest", json!({"method": "exact"})),
        ("as printed, all times", "all", published(true)),
        ("as printed, one time", "latest", published(true)),
    ]
    .map(|(name, k, correlator)| {
        let statistic = json!({"kind": "chain", "k": k});
        variant(
            name,
            &[("/statistic", statistic), ("/correlator", correlator)],
        )
    });
    let missing = [
        ("optimum, P_D 0.9, all times", "all"),
        ("optimum, P_D 0.9, one time", "latest"),
    ]
    .map(|(name, k)| {
        variant(
            name,
            &[
                ("/statistic", json!({"kind": "chain", "k": k})),
                ("/correlator", json!({"method": "exact"})),
                ("/input/tracks/p_d", json!(0.9)),
                ("/input/tracks/false_tracks", json!(1.0)),
            ],
        )
    });
    let rules = [(1, 1), (2, 3), (3, 4), (4, 5), (6, 8)].map(|(found, of)| {
        let name = if of == 1 {
            "none".to_owned()
        } else {
            format!("{found}/{of}")
        };
        variant(&name, &[("/confirm", json!({"found": found, "of": of}))])
    });
    campaign(
        "confirmation",
        "what N/M confirmation gains over its four rules",
        100,
        &base(json!({"spacing_m": 250.0, "times": 8})),
        &[
            axis("decisions", &[&deciders[..], &missing].concat()),
            axis("rule", &rules),
        ],
    )
}

/// Exact answers over sensors and targets, targets 3 σ apart, with the share that is proven and times.
fn integer_programming() -> Preset {
    let mut sizes = Vec::new();
    for sensors in 3..=6 {
        for targets in [5, 10, 20, 50] {
            sizes.push(variant(
                &format!("{sensors} × {targets}"),
                &[
                    ("/input/tracks/sensors", json!(sensors)),
                    ("/input/tracks/targets", json!(targets)),
                    (
                        "/input/tracks/false_tracks",
                        json!(f64::from(targets) / 20.0),
                    ),
                ],
            ));
        }
    }
    let exact = exact_if_cheap();
    let contenders = [
        ("exact, chain", "chain", exact.clone()),
        ("exact, all pairs", "all_pairs", exact.clone()),
        ("exact, likelihood ratio", "likelihood_ratio", exact),
        (
            "genetic, all pairs",
            "all_pairs",
            json!({"method": "genetic"}),
        ),
    ]
    .map(|(name, kind, correlator)| {
        variant(
            name,
            &[
                ("/statistic", json!({"kind": kind})),
                ("/correlator", correlator),
            ],
        )
    });
    campaign(
        "integer-programming",
        "exact answers over numbers of sensors and targets",
        10,
        &base(json!({"spacing_m": 300.0, "p_d": 0.9})),
        &[
            axis("sensors × targets", &sizes),
            axis("correlator", &contenders),
        ],
    )
}

/// The three basic methods from two sensors to six, errors in common, against the optimum.
fn nodes() -> Preset {
    let contenders = [
        ("exact", json!({"method": "exact"})),
        ("nearest", json!({"method": "nearest"})),
        ("weighted", json!({"method": "weighted"})),
        ("modified", json!({"method": "modified"})),
        ("genetic", json!({"method": "genetic"})),
    ];
    let mut base = base(json!({
        "spacing_m": 250.0, "p_d": 0.9, "false_tracks": 1.0, "cross_correlation": 0.5
    }));
    base["statistic"] = json!({"kind": "all_pairs"});
    base["cross_covariance"] = json!({"kind": "coefficient", "coefficient": 0.5});
    let sensors = json!({"by": "values", "name": "sensors", "path": "/input/tracks/sensors", "values": [2, 3, 4, 5, 6]});
    campaign(
        "nodes",
        "the three basic methods from two sensors to six",
        40,
        &base,
        &[sensors, axis("correlator", &contenders.map(by_correlator))],
    )
}

/// The genetic answer beside that of the relaxation, under costs that are hard.
fn relaxation() -> Preset {
    let mut problems = Vec::new();
    for kind in ["all_pairs", "likelihood_ratio", "fused"] {
        for (sensors, targets) in [(3, 10), (5, 20)] {
            problems.push(variant(
                &format!("{kind}, {sensors} × {targets}"),
                &[
                    ("/statistic", json!({"kind": kind})),
                    ("/input/tracks/sensors", json!(sensors)),
                    ("/input/tracks/targets", json!(targets)),
                ],
            ));
        }
    }
    let contenders = [
        ("lagrangian", json!({"method": "lagrangian"})),
        ("genetic", json!({"method": "genetic"})),
        (
            "genetic, alone",
            json!({"method": "genetic", "variant": "unseeded"}),
        ),
        ("exact", exact_if_cheap()),
    ];
    campaign(
        "relaxation",
        "the genetic answer beside the relaxation's",
        20,
        &base(json!({"spacing_m": 300.0, "p_d": 0.9, "false_tracks": 1.0})),
        &[
            axis("problem", &problems),
            axis("correlator", &contenders.map(by_correlator)),
        ],
    )
}

/// True pairs of two sensors, too far apart to be mistaken, over α.
fn alpha() -> Preset {
    let mut tests = Vec::new();
    for (name, k, correlation) in [
        ("all times, white errors", "all", 0.0),
        ("one time, white errors", "latest", 0.0),
        ("all times, errors that last", "all", 0.9),
        ("one time, errors that last", "latest", 0.9),
    ] {
        tests.push(variant(
            name,
            &[
                ("/statistic", json!({"kind": "chain", "k": k})),
                ("/input/tracks/correlation", json!(correlation)),
            ],
        ));
    }
    let alphas = json!({"by": "values", "name": "α", "path": "/statistic/alpha", "values": [0.01, 0.05, 0.1]});
    let mut preset = campaign(
        "alpha",
        "whether α is the share of true pairs that are taken apart",
        40,
        &base(json!({"sensors": 2, "targets": 100, "spacing_m": 5000.0})),
        &[axis("test", &tests), alphas],
    );
    preset.body["base"]["correlator"] = json!({"method": "exact"});
    preset
}

/// The optimum where a cluster has it within 300 000 nodes, else an answer without a proof.
fn exact_if_cheap() -> Value {
    json!({"method": "exact", "max_nodes": 300_000, "may_be_unproven": true})
}

/// The rates of the paper, 100 individuals and 500 generations.
fn published(is_complete: bool) -> Value {
    json!({
        "method": "genetic", "variant": "paper", "complete": is_complete, "population": 100, "generations": 500, "stop_after": 500
    })
}

fn base(tracks: Value) -> Value {
    json!({"kind": "correlate", "input": {"source": "local_tracks", "tracks": tracks}, "correlator": {"method": "genetic"}})
}

fn variant(name: &str, set: &[(&str, Value)]) -> Value {
    let set: Vec<Value> = set
        .iter()
        .map(|(path, value)| json!({"path": path, "value": value}))
        .collect();
    json!({"name": name, "set": set})
}

fn by_correlator((name, correlator): (&str, Value)) -> Value {
    variant(name, &[("/correlator", correlator)])
}

fn axis(name: &str, variants: &[Value]) -> Value {
    json!({"by": "variants", "name": name, "variants": variants})
}

/// Compared with the first point of the last axis.
fn campaign(name: &str, what: &str, runs: u32, base: &Value, grid: &[Value]) -> Preset {
    let name = format!("huo2008-{name}");
    let outcome = |name: &str, path: &str| json!({"name": name, "path": path});
    Preset {
        summary: format!("Huo et al. 2008: {what}."),
        kind: JobKind::Campaign,
        body: json!({
            "name": name,
            "seed": 1,
            "base": base,
            "grid": grid,
            "runs": runs,
            "outcomes": [
                outcome("tuples right", "truth.share_right"),
                outcome("precision", "truth.pairwise_precision"),
                outcome("recall", "truth.pairwise_recall"),
                outcome("targets", "truth.tuples"),
                outcome("true tuples", "truth.tuples_right"),
                outcome("tuples", "counts.tuples"),
                outcome("J", "cost"),
                outcome("gap", "gap")
            ]
        }),
        name,
    }
}
