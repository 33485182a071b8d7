//! `cargo bench --bench correlation`: what each correlator costs, how far its answer is from the optimum or the best bound
//! known, and what it takes, in u.
//!
//! Prints the yardstick u (one predict and update of a 4-state Kalman filter), then for chain, all-pairs and fused costs and
//! problems of 3 × 10, 5 × 50 and 10 × 200 sensors × targets (P_D 0.9, one false track to twenty targets) the mean cost J,
//! the mean and the largest gap, the share of optima where the optimum is known, and the time of one call.

#[path = "support/random_tracks.rs"]
mod random_tracks;
#[path = "support/yardstick.rs"]
mod yardstick;

use random_tracks::Scene;
use serde_json::{Value, json};
use std::time::Instant;
use trackloom_domain::correlation::problem::CorrelationProblem;
use trackloom_domain::correlation::{CORRELATORS, Solution};
use trackloom_domain::math::rng::Seed;
use trackloom_domain::registry;
use yardstick::yardstick_ns;

/// Sensors, targets, problems.
const SIZES: [(usize, usize, u32); 3] = [(3, 10, 1000), (5, 50, 20), (10, 200, 3)];

/// Mean distances of targets, in standard deviations of a track.
const SPACINGS: [f64; 2] = [6.0, 3.0];

fn main() {
    // `cargo test --benches` only wants to know that it starts.
    if std::env::args().any(|argument| argument == "--test") {
        return;
    }
    let u_ns = yardstick_ns();
    println!("yardstick u = {u_ns:.1} ns (4-state Kalman predict + update, nalgebra, fixed sizes)");
    for statistic in ["chain", "all_pairs", "fused"] {
        for spacing in SPACINGS {
            for (sensors, targets, count) in SIZES {
                // Joint costs take long.
                let count = if statistic == "fused" {
                    count.div_ceil(20)
                } else {
                    count
                };
                let scene = Scene {
                    sensors,
                    targets,
                    spacing,
                    detection_probability: 0.9,
                    false_share: 0.05,
                };
                let problem = |number| match statistic {
                    "chain" => scene.chain(number),
                    "all_pairs" => scene.all_pairs(number),
                    _ => scene.fused(number),
                };
                println!(
                    "\n{statistic}, {sensors} x {targets}, spacing {spacing} sigma, {count} problems"
                );
                compare(&(0..count).map(problem).collect::<Vec<_>>(), u_ns);
            }
        }
    }
}

/// The correlators with their parameters.
fn contenders() -> Vec<(&'static str, Value)> {
    let name = |method: &trackloom_domain::registry::Method<_>| (method.name, json!({}));
    let mut contenders: Vec<_> = CORRELATORS.iter().map(name).collect();
    contenders.push(("genetic", json!({"variant": "unseeded"})));
    contenders.push((
        "genetic",
        json!({"variant": "paper", "population": 100, "generations": 500, "stop_after": 100}),
    ));
    contenders
}

struct Figures {
    label: String,
    solutions: Vec<Option<Solution>>,
    seconds: Vec<f64>,
}

fn compare(problems: &[CorrelationProblem], u_ns: f64) {
    let figures: Vec<Figures> = contenders()
        .iter()
        .map(|(name, parameters)| run(name, parameters, problems))
        .collect();
    let bound_of = |number: usize| {
        let bounds = figures
            .iter()
            .filter_map(|of| of.solutions[number].as_ref()?.dual_bound);
        bounds.fold(f64::NEG_INFINITY, f64::max)
    };
    let bounds: Vec<f64> = (0..problems.len()).map(bound_of).collect();
    println!(
        "{:<18} {:>12} {:>9} {:>9} {:>8} {:>12} {:>12}",
        "correlator", "mean J", "gap", "largest", "at bound", "median u", "largest u"
    );
    for of in &figures {
        print_line(of, &bounds, u_ns);
    }
}

fn run(name: &str, parameters: &Value, problems: &[CorrelationProblem]) -> Figures {
    let method = CORRELATORS
        .iter()
        .find(|method| method.name == name)
        .expect("contenders are in the table");
    let checked =
        registry::check(parameters, method.parameters).expect("the parameters are in range");
    let (mut solutions, mut seconds) = (Vec::new(), Vec::new());
    for (number, problem) in problems.iter().enumerate() {
        let mut correlator = (method.build)(
            &checked,
            Seed {
                seed: 1,
                run: number as u32,
            },
        )
        .expect("checked parameters build");
        let start = Instant::now();
        solutions.push(correlator.correlate(problem).ok());
        seconds.push(start.elapsed().as_secs_f64());
    }
    let label = parameters["variant"]
        .as_str()
        .map_or(name.to_owned(), |variant| format!("{name}, {variant}"));
    Figures {
        label,
        solutions,
        seconds,
    }
}

fn print_line(of: &Figures, bounds: &[f64], u_ns: f64) {
    let solved: Vec<(f64, f64)> = of
        .solutions
        .iter()
        .zip(bounds)
        .filter_map(|(solution, bound)| Some((solution.as_ref()?.cost, *bound)))
        .collect();
    if solved.len() < of.solutions.len() {
        println!(
            "{:<18} refused {} of {}",
            of.label,
            of.solutions.len() - solved.len(),
            of.solutions.len()
        );
        return;
    }
    let gaps: Vec<f64> = solved
        .iter()
        .map(|(cost, bound)| (cost - bound) / bound.abs().max(1e-9))
        .collect();
    let at_bound = gaps.iter().filter(|gap| **gap < 1e-9).count();
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let share = |gap: f64| {
        if gap.is_finite() {
            format!("{:.4}%", 100.0 * gap)
        } else {
            "–".to_owned()
        }
    };
    let mut times: Vec<f64> = of
        .seconds
        .iter()
        .map(|seconds| seconds * 1e9 / u_ns)
        .collect();
    times.sort_by(f64::total_cmp);
    println!(
        "{:<18} {:>12.3} {:>9} {:>9} {:>8} {:>12.0} {:>12.0}",
        of.label,
        mean(&solved.iter().map(|(cost, _)| *cost).collect::<Vec<_>>()),
        share(mean(&gaps)),
        share(
            gaps.iter()
                .fold(0.0, |largest: f64, gap| if gap.is_finite() {
                    largest.max(*gap)
                } else {
                    f64::INFINITY
                })
        ),
        at_bound,
        times[times.len() / 2],
        times[times.len() - 1],
    );
}
