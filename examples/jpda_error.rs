//! How far belief propagation is from the exact marginals: prints the table of `docs/jpda.md`.
//!
//! `cargo run --release -p trackloom-domain --example jpda_error`

use rand::{Rng, RngExt};
use serde_json::json;
use trackloom_domain::association::problem::{Edge, ScanProblem, Weights};
use trackloom_domain::association::{ASSOCIATORS, Associator};
use trackloom_domain::math::rng::{Purpose, Seed};
use trackloom_domain::registry::check;

const CLUSTERS: u32 = 300;
/// Log-likelihood ratios are drawn from −spread to +spread.
const SPREADS: [f64; 3] = [2.0, 5.0, 10.0];
/// The share of all pairs of a track and a detection that are candidates.
const DENSITIES: [f64; 3] = [0.3, 0.6, 1.0];

fn main() {
    println!(
        "| tracks × detections | pairs | mean, ±2 | largest, ±2 | mean, ±5 | largest, ±5 | mean, ±10 | largest, ±10 |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    for size in [
        (2, 2),
        (3, 3),
        (4, 4),
        (6, 6),
        (8, 8),
        (10, 10),
        (12, 12),
        (10, 4),
        (4, 10),
    ] {
        for density in DENSITIES {
            let cells = SPREADS
                .map(|spread| errors(size, density, spread))
                .map(|(mean, largest)| format!("{mean:.4} | {largest:.3}"));
            println!(
                "| {} × {} | {:.0} % | {} |",
                size.0,
                size.1,
                density * 100.0,
                cells.join(" | ")
            );
        }
    }
}

/// Mean and largest difference of a marginal.
fn errors((tracks, detections): (u32, u32), density: f64, spread: f64) -> (f64, f64) {
    let mut random =
        Seed { seed: 1, run: 0 }.stream(Purpose::Clutter, u64::from(tracks), u64::from(detections));
    let (mut exact, mut approximate) = (associator("exact"), associator("belief_propagation"));
    let (mut sum, mut count, mut largest) = (0.0, 0, 0.0f64);
    for _ in 0..CLUSTERS {
        let mut problem = random_problem(&mut random, tracks, detections, density, spread);
        let truth = solve(exact.as_mut(), &mut problem);
        for (true_beta, beta) in truth.iter().zip(solve(approximate.as_mut(), &mut problem)) {
            let error = (true_beta - beta).abs();
            (sum, count, largest) = (sum + error, count + 1, largest.max(error));
        }
    }
    (sum / f64::from(count), largest)
}

fn associator(marginals: &str) -> Box<dyn Associator> {
    let jpda = ASSOCIATORS
        .iter()
        .find(|method| method.name == "jpda")
        .expect("jpda is in the table");
    let parameters =
        check(&json!({"marginals": marginals}), jpda.parameters).expect("the parameters are right");
    (jpda.build)(&parameters, Seed { seed: 0, run: 0 }).expect("checked parameters build")
}

fn random_problem(
    random: &mut impl Rng,
    tracks: u32,
    detections: u32,
    density: f64,
    spread: f64,
) -> ScanProblem {
    let mut problem = ScanProblem::default();
    problem.begin(0, detections as usize);
    for _ in 0..tracks {
        for detection in 0..detections {
            if random.random_bool(density) {
                problem.push_edge(Edge {
                    detection,
                    squared_distance: 0.0,
                    log_likelihood: random.random_range(-spread..spread),
                });
            }
        }
        problem.end_row(0.0, 0.0);
    }
    problem
}

fn solve(associator: &mut dyn Associator, problem: &mut ScanProblem) -> Vec<f64> {
    let mut weights = Weights::default();
    weights.reset(problem);
    problem.for_each_cluster(|cluster| associator.associate(cluster, &mut weights));
    weights.edges.into_iter().chain(weights.missed).collect()
}
