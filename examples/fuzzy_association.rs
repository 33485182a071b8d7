//! `cargo run --release -p trackloom-domain --example fuzzy_association`: the table of `docs/fuzzy.md`. Liang's scene of 30 targets as
//! published, and 100 targets that start within 20 km, under fuzzy c-means and the associators beside it; twenty seeds each.

use serde_json::{Value, json};
use trackloom_domain::experiment::observer::Silent;
use trackloom_domain::experiment::{self, presets};

/// Scene, targets, and the side of the square in which they start.
const SCENES: [(&str, u32, f64); 2] = [
    ("30 targets, 100 km", 30, 100_000.0),
    ("100 targets, 20 km", 100, 20_000.0),
];

const SEEDS: u32 = 20;

fn contenders() -> Vec<Value> {
    vec![
        json!({"method": "nearest_neighbour"}),
        json!({"method": "global_nearest_neighbour"}),
        json!({"method": "jpda"}),
        json!({"method": "fuzzy_c_means"}),
        json!({"method": "fuzzy_c_means", "max_iterations": 1}),
        json!({"method": "fuzzy_c_means", "fuzzifier": 1.5}),
        json!({"method": "fuzzy_c_means", "weights": "weighted"}),
    ]
}

fn main() {
    for (name, targets, side_m) in SCENES {
        println!(
            "{name}: targets correct / missed / false, of {}",
            SEEDS * targets
        );
        for associator in contenders() {
            let mut counts = [0; 3];
            let mut said = Value::Null;
            for seed in 1..=SEEDS {
                let outcome = judged(targets, side_m, seed, &associator);
                for (sum, verdict) in counts.iter_mut().zip(["correct", "missed", "false"]) {
                    *sum += outcome.result["tfa"]["counts"][verdict]
                        .as_u64()
                        .expect("a count");
                }
                said = outcome.result["association"]["diagnostics"].clone();
            }
            println!(
                "  {associator}: {} / {} / {}; seed {SEEDS}: {said}",
                counts[0], counts[1], counts[2]
            );
        }
    }
}

fn judged(targets: u32, side_m: f64, seed: u32, associator: &Value) -> experiment::Outcome {
    let mut preset = presets::find(&format!("liang2009-{targets}")).expect("a preset");
    preset.body["associator"] = associator.clone();
    preset.body["seed"] = json!(seed);
    preset.body["input"]["scenario"]["targets"]["area_side_m"] = json!(side_m);
    let plan = experiment::plan(preset.kind, &preset.body).expect("presets are valid");
    experiment::run(&plan, vec![], &mut Silent).expect("the job runs")
}
