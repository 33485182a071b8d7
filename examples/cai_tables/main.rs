//! The tables of Cai et al. with every contender: accuracy over the runs, and the time on the processor that grouping took against the
//! nearest neighbour in the same process.
//!
//! `cargo run --example cai_tables [-- RUNS [FIRST_SEED]]`; 25 runs from seed 1 unless said otherwise. With `--calibrate` the
//! nearest neighbour and fuzzy c-means alone, over noises and spacings around those of the presets. `--only=WORD` restricts the
//! table to contenders whose names hold the word; `--search` shows the genetic search with more and more runs. `--genetic` and `--times`
//! print the rows of `docs/data/cai-fuzzy-errors.csv` and `cai-fuzzy-times.csv`: errors and J of genetic fuzzy c-means, and times.

mod claims;
#[path = "../../tests/domain/segmentation.rs"]
mod segmentation;

use serde_json::{Value, json};
use std::collections::BTreeMap;
use trackloom_domain::experiment::presets::cai_fuzzy;
use trackloom_domain::experiment::{JobKind, plan, presets, run};

const SCENES: [&str; 4] = [
    "cai-fuzzy-cv-10",
    "cai-fuzzy-cv-15",
    "cai-fuzzy-weave-10",
    "cai-fuzzy-weave-15",
];

/// Of one run.
struct Found {
    accuracy_percent: f64,
    /// Of an instant, on average.
    iterations: f64,
    /// J of fuzzy c-means, on average.
    cost: f64,
    grouping_s: f64,
}

/// The job that a preset's campaign runs.
fn base_of(scene: &str) -> Value {
    let mut body = presets::find(scene).expect("the preset exists").body["base"].take();
    body.as_object_mut()
        .expect("a base is an object")
        .remove("kind");
    body
}

fn one(body: &Value, change: &Value, seed: u32) -> Found {
    let mut body = body.clone();
    body["seed"] = json!(seed);
    for (name, value) in change.as_object().expect("a change is an object") {
        body[name] = value.clone();
    }
    let plan = plan(JobKind::Group, &body).expect("the body is right");
    let mut watch = claims::Watch::default();
    let result = run(&plan, Vec::new(), &mut watch)
        .expect("the job succeeds")
        .result;
    let number = |pointer: &str| result.pointer(pointer).and_then(Value::as_f64);
    let accuracy = number("/grouping/accuracy").expect("origins are known");
    Found {
        accuracy_percent: 100.0 * accuracy,
        iterations: number("/grouping/search/mean_iterations").unwrap_or(0.0),
        cost: number("/grouping/search/mean_cost").unwrap_or(0.0),
        grouping_s: watch.spent_s,
    }
}

/// Mean and its standard error.
fn summary(values: &[f64]) -> (f64, f64) {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let variance = values
        .iter()
        .map(|value| (value - mean).powi(2))
        .sum::<f64>()
        / (count - 1.0).max(1.0);
    (mean, (variance / count).sqrt())
}

fn table(runs: u32, first_seed: u32, only: Option<&str>) {
    println!(
        "| contender | {} | iterations | J | time against NN 3 σ |",
        SCENES.join(" | ")
    );
    println!("|---|{}---|---|---|", "---|".repeat(SCENES.len()));
    let mut reference_s: BTreeMap<&str, f64> = BTreeMap::new();
    let is_wanted = |(place, contender): &(usize, (&str, Value))| {
        *place == 0 || only.is_none_or(|word| contender.0.contains(word))
    };
    for (_, (name, change)) in cai_fuzzy::contenders()
        .into_iter()
        .enumerate()
        .filter(is_wanted)
    {
        let (mut cells, mut ratios, mut rounds, mut costs) =
            (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        for scene in SCENES {
            let body = base_of(scene);
            let found: Vec<Found> = (0..runs)
                .map(|run| one(&body, &change, first_seed + run))
                .collect();
            let (mean, error) = summary(
                &found
                    .iter()
                    .map(|run| run.accuracy_percent)
                    .collect::<Vec<_>>(),
            );
            let spent_s: f64 = found.iter().map(|run| run.grouping_s).sum();
            cells.push(format!("{mean:.1} ± {error:.1}"));
            ratios.push(format!(
                "{:.1}",
                spent_s / *reference_s.entry(scene).or_insert(spent_s)
            ));
            let mean = |value: fn(&Found) -> f64| {
                format!(
                    "{:.0}",
                    found.iter().map(value).sum::<f64>() / f64::from(runs)
                )
            };
            rounds.push(mean(|run| run.iterations));
            costs.push(mean(|run| run.cost));
        }
        println!(
            "| {name} | {} | {} | {} | {} |",
            cells.join(" | "),
            rounds.join(" / "),
            costs.join(" / "),
            ratios.join(" / ")
        );
    }
}

/// The paper's nearest-neighbour column is 95, 93, 85, 76.
fn calibrate(runs: u32, first_seed: u32) {
    println!("| σ (m) | spacing (m) | NN 3 σ | FCM from predictions |\n|---|---|---|---|");
    for (sigma_m, spacing_m) in [
        (150.0, 2500.0),
        (200.0, 2000.0),
        (200.0, 2500.0),
        (200.0, 3000.0),
        (250.0, 2500.0),
    ] {
        let mut columns = [Vec::new(), Vec::new()];
        for scene in SCENES {
            let mut body = base_of(scene);
            let scenario = &mut body["input"]["scenario"];
            scenario["targets"]["spacing_m"] = json!(spacing_m);
            for sensor in scenario["sensors"]
                .as_array_mut()
                .expect("there are sensors")
            {
                (sensor["sigma_x_m"], sensor["sigma_y_m"]) = (json!(sigma_m), json!(sigma_m));
            }
            let nearest = json!({"grouper": {"method": "nearest_neighbour", "gate_sigmas": 3.0}});
            for (column, change) in columns.iter_mut().zip([nearest, json!({})]) {
                let values: Vec<f64> = (0..runs)
                    .map(|run| one(&body, &change, first_seed + run).accuracy_percent)
                    .collect();
                column.push(format!("{:.1}", summary(&values).0));
            }
        }
        println!(
            "| {sigma_m} | {spacing_m} | {} | {} |",
            columns[0].join(" / "),
            columns[1].join(" / ")
        );
    }
}

/// The genetic search with more and more runs of fuzzy c-means, on the first four instants.
fn search(runs: u32, first_seed: u32) {
    println!(
        "| population × generations | {} | J | iterations |\n|---|{}---|---|",
        SCENES.join(" | "),
        "---|".repeat(SCENES.len())
    );
    for (population, generations) in [(6, 6), (12, 24), (24, 48)] {
        let (mut cells, mut costs, mut rounds) = (Vec::new(), Vec::new(), Vec::new());
        for scene in SCENES {
            let mut body = base_of(scene);
            body["input"]["scenario"]["scans"] = json!(4);
            let initial = json!({"from": "genetic", "clusters": {"by": "count", "count": 25}, "population": population, "generations": generations});
            let change = json!({"grouper": {"method": "fuzzy_c_means", "initial": initial}});
            let found: Vec<Found> = (0..runs)
                .map(|run| one(&body, &change, first_seed + run))
                .collect();
            let mean =
                |value: fn(&Found) -> f64| found.iter().map(value).sum::<f64>() / f64::from(runs);
            cells.push(format!("{:.1}", mean(|run| run.accuracy_percent)));
            costs.push(format!("{:.0}", mean(|run| run.cost)));
            rounds.push(format!("{:.0}", mean(|run| run.iterations)));
        }
        println!(
            "| {population} × {generations} | {} | {} | {} |",
            cells.join(" | "),
            costs.join(" / "),
            rounds.join(" / ")
        );
    }
}

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let numbers: Vec<u32> = words.iter().filter_map(|word| word.parse().ok()).collect();
    let (runs, first_seed) = (
        numbers.first().copied().unwrap_or(25),
        numbers.get(1).copied().unwrap_or(1),
    );
    let only = words.iter().find_map(|word| word.strip_prefix("--only="));
    let mode = words
        .iter()
        .find_map(|word| word.strip_prefix("--").filter(|word| !word.contains('=')));
    match mode {
        Some("calibrate") => calibrate(runs, first_seed),
        Some("search") => search(runs, first_seed),
        Some("genetic") => {
            println!("{}", claims::HEADER);
            claims::genetic();
        }
        Some("times") => {
            println!("{}", claims::HEADER);
            claims::times(runs);
        }
        _ => table(runs, first_seed, only),
    }
}
