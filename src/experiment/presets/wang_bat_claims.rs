//! What Wang Y., Li Y., Huang H. say of the bat algorithm beside their tables, as campaigns: many targets, much clutter and many
//! crossings; that the objective is largest at the true association; that its constants are chosen in a range.

use super::Preset;
use super::wang_bat::{axis, pair, preset, scenes, six_targets, two_targets, variant};
use serde_json::{Value, json};

const RUNS: u32 = 300;

const TARGETS: &str = "/input/scenario/targets";

pub(super) fn presets() -> Vec<Preset> {
    let six = six_targets(5.0);
    let grid = |name: &str, summary: &str, along: Value| {
        let grid = [along, contenders()];
        let mut preset = preset(name, summary, &six, &grid, RUNS);
        preset.body["compare"]["to"] = json!("JPDA");
        preset
    };
    vec![
        grid(
            "wang-bat-clutter",
            "six targets, no to much clutter",
            clutter(),
        ),
        grid(
            "wang-bat-targets",
            "two to ten targets, each pair with a crossing of its own and those with the others",
            targets(),
        ),
        grid(
            "wang-bat-crossings",
            "six targets that never cross, or three, seven or nine times",
            crossings(),
        ),
        noise(),
        objective(),
        constants(),
    ]
}

/// One of each kind; JPDA by exact marginals, since listed events are too many in the larger scenes.
pub(super) fn contenders() -> Value {
    let nearest = |rule: &str| json!({"method": "nearest_neighbour", "conflicts": rule});
    axis(vec![
        variant("NN, shared", nearest("shared")),
        variant("NN, closest pair", nearest("closest_pair")),
        variant("GNN", json!({"method": "global_nearest_neighbour"})),
        variant("PDA", json!({"method": "pda"})),
        variant("JPDA", json!({"method": "jpda"})),
        variant("BADA, sum", json!({"method": "bat"})),
        variant(
            "BADA, sum, visited",
            json!({"method": "bat", "weights": "visited"}),
        ),
    ])
}

/// More noises than the two of the tables.
fn noise() -> Preset {
    let path = "/input/scenario/sensors/0/sigma_bearing_deg";
    let noises = json!({"by": "values", "name": "sigma_deg", "path": path, "values": [0.15, 0.3, 0.45, 0.6, 0.8, 1.0]});
    let summary = "two targets that cross once, little to much noise";
    let grid = [noises, contenders()];
    let mut preset = preset("wang-bat-noise", summary, &two_targets(), &grid, RUNS);
    preset.body["compare"]["to"] = json!("JPDA");
    preset
}

fn clutter() -> Value {
    let path = "/input/scenario/sensors/0/clutter_per_deg";
    json!({"by": "values", "name": "clutter per degree", "path": path, "values": [0.0, 0.1, 0.2, 0.4, 0.8]})
}

/// Further pairs on either side of the three of the scene of six.
fn targets() -> Value {
    let pairs = [
        (235.0, 55.0),
        (255.0, 70.0),
        (275.0, 85.0),
        (215.0, 60.0),
        (295.0, 80.0),
    ]
    .map(|(centre_deg, time_s)| pair(centre_deg, time_s));
    let of = |count: usize| {
        variant_of_targets(format!("{}", 2 * count), json!(pairs[..count]), json!([]))
    };
    json!({"by": "variants", "name": "targets", "variants": [of(1), of(2), of(3), of(4), of(5)]})
}

/// The three pairs so far from each other that they cross all others, their neighbours or nobody; or six parallel lines.
fn crossings() -> Value {
    let lines: Vec<Value> = (1..=6)
        .map(|number| {
            let bearing_deg = 100.0 + 10.0 * f64::from(number);
            json!({"truth_id": format!("{number}"), "bearing_deg": bearing_deg, "rate_degps": 0.3})
        })
        .collect();
    let never = variant_of_targets("0".to_owned(), json!([]), json!(lines));
    let variants = [
        never,
        pairs_apart(3, 80.0),
        pairs_apart(7, 40.0),
        pairs_apart(9, 20.0),
    ];
    json!({"by": "variants", "name": "crossings", "variants": variants})
}

fn pairs_apart(count: u32, spacing_deg: f64) -> Value {
    let pairs = [(-1.0, 60.0), (0.0, 70.0), (1.0, 80.0)]
        .map(|(side, time_s)| pair(180.0 + side * spacing_deg, time_s));
    variant_of_targets(format!("{count}"), json!(pairs), json!([]))
}

fn variant_of_targets(name: String, crossings: Value, lines: Value) -> Value {
    let targets = json!({"kind": "bearings", "crossings": crossings, "lines": lines});
    json!({"name": name, "set": [{"path": TARGETS, "value": targets}]})
}

/// Tracks that are updated with the detections of their own targets: is J the largest there?
fn objective() -> Preset {
    let summary = "whether the objective is largest at the true association, for clusters of tracks that have had the detections of \
                   their own targets until then";
    let oracle = variant("oracle", json!({"method": "oracle", "objectives": true}));
    let grid = [scenes(), axis(vec![oracle])];
    let mut preset = preset(
        "wang-bat-objective",
        summary,
        &six_targets(5.0),
        &grid,
        RUNS,
    );
    let mut outcomes = Vec::new();
    for (short, objective) in [("sum", "likelihood_sum"), ("ratio", "log_likelihood_ratio")] {
        for group in ["all", "detected", "shared"] {
            let path = format!("association.diagnostics.objectives.{objective}.{group}");
            outcomes.push(json!({"name": format!("{short}, {group}"), "path": format!("{path}.share_largest")}));
            outcomes.push(
                json!({"name": format!("{short}, {group}, lack"), "path": format!("{path}.mean_lack")}),
            );
        }
    }
    preset.body["outcomes"] = json!(outcomes);
    if let Some(body) = preset.body.as_object_mut() {
        body.remove("compare");
    }
    preset
}

/// α and γ, with the swarm of the paper and with one so small that it matters how it is led.
fn constants() -> Preset {
    let swarms = [
        swarm("20 bats, 15 iterations", 20, 15),
        swarm("3 bats, 3 iterations", 3, 3),
    ];
    let pairs = [
        constants_of("0.90", 0.90, 0.90),
        constants_of("0.92", 0.92, 0.92),
        constants_of("0.95", 0.95, 0.95),
        constants_of("0.98", 0.98, 0.98),
        constants_of("0.99", 0.99, 0.99),
        constants_of("α 0.90, γ 0.99", 0.90, 0.99),
        constants_of("α 0.99, γ 0.90", 0.99, 0.90),
    ];
    let grid = [
        json!({"by": "variants", "name": "swarm", "variants": swarms}),
        json!({"by": "variants", "name": "α = γ", "variants": pairs}),
    ];
    let summary = "six targets, the constants of loudness and pulse rate over 0.90 to 0.99";
    let scene = six_targets(5.0);
    let mut preset = preset("wang-bat-alpha-gamma", summary, &scene, &grid, RUNS);
    preset.body["base"]["associator"] =
        json!({"method": "bat", "population": 20, "iterations": 15, "alpha": 0.98, "gamma": 0.98});
    preset.body["compare"] = json!({"axis": "α = γ", "to": "0.98"});
    preset
}

fn swarm(name: &str, population: u32, iterations: u32) -> Value {
    json!({"name": name, "set": [
        {"path": "/associator/population", "value": population}, {"path": "/associator/iterations", "value": iterations}
    ]})
}

fn constants_of(name: &str, alpha: f64, gamma: f64) -> Value {
    json!({"name": name, "set": [{"path": "/associator/alpha", "value": alpha}, {"path": "/associator/gamma", "value": gamma}]})
}
