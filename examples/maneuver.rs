//! Filters on an airliner that turns twice: prints the tables of `docs/maneuver.md`.
//!
//! `cargo run --release -p trackloom-domain --example maneuver [RUNS]`

#[path = "../benches/support/maneuver.rs"]
mod maneuver;

use maneuver::{
    Fixes, Named, NamedAndSmoothed, PUBLISHED, beliefs_of, filter_of, published, row, truth,
    truth_of,
};
use serde_json::{Value, json};
use std::ops::Range;
use trackloom_domain::filtering::{Filter, WithFilter};

fn main() {
    let runs = std::env::args().nth(1).and_then(|text| text.parse().ok());
    let runs: u32 = runs.unwrap_or(1000);
    let truth = truth();
    head();
    for (name, expected, of_runs) in PUBLISHED {
        let errors = published(name, &truth, runs);
        line(&format!("{name}, numpy ({of_runs} runs)"), &expected, None);
        let deviation = errors.largest_deviation(&expected, of_runs);
        line(name, &row(&errors), Some(deviation));
    }
    println!();
    head();
    for (name, filter) in presets() {
        let errors = filter_of(&filter).with(Named {
            truth: &truth,
            runs,
        });
        line(name, &row(&errors), None);
        let smoothed = filter_of(&filter).with(NamedAndSmoothed(Named {
            truth: &truth,
            runs,
        }));
        line(&format!("{name}, smoothed"), &row(&smoothed), None);
    }
    agile(runs.min(300));
}

/// The parts of the agile target's course, without its first second.
const AGILE: [Range<usize>; 3] = [10..332, 332..666, 666..1001];

/// Root mean squares (m) of the errors of place of the agile target: straight, in the turn, while it accelerates.
fn agile(runs: u32) {
    let truth = truth_of("maneuver-10hz");
    println!("\n| filter | straight | turn 10°/s | acceleration 3 m/s² |");
    println!("|---|---|---|---|");
    let straight = |q: f64| json!({"model": "constant_velocity", "process_noise_m2ps3": q});
    let alone = |q: f64| json!({"method": "kalman", "process_noise_m2ps3": q});
    let turn =
        json!({"model": "coordinated_turn", "turn_rate_degps": 10.0, "process_noise_m2ps3": 0.1});
    let imm = |models: Value| json!({"method": "imm", "models": models});
    for (name, filter) in [
        ("kalman, q = 0.1", alone(0.1)),
        ("kalman, q = 122.5", alone(122.5)),
        (
            "maneuver-10hz: imm of both",
            imm(json!([straight(0.1), straight(122.5)])),
        ),
        (
            "imm of q = 0.1 and a turn of 10°/s: told",
            imm(json!([straight(0.1), turn])),
        ),
    ] {
        let fixes = Fixes {
            truth: &truth,
            sigma_m: 1.0,
            speed_sigma_mps: 200.0,
        };
        let [a, b, c] = filter_of(&filter).with(Agile { fixes, runs });
        println!("| {name} | {a:.2} | {b:.2} | {c:.2} |");
    }
}

struct Agile<'a> {
    fixes: Fixes<'a>,
    runs: u32,
}

impl WithFilter for Agile<'_> {
    type Output = [f64; 3];

    fn in_plane<F: Filter<4>>(self, filter: F) -> [f64; 3] {
        let step = filter.step(0.1);
        let mut squares = vec![0.0; self.fixes.truth.len()];
        for run in 0..self.runs {
            let beliefs = beliefs_of(&filter, &step, self.fixes, run);
            for (fix, belief) in beliefs.iter().enumerate() {
                let error = F::kinematics(belief).mean - self.fixes.truth[fix];
                squares[fix] += error.fixed_rows::<2>(0).norm_squared();
            }
        }
        AGILE.map(|part| {
            let count = part.len() as f64 * f64::from(self.runs);
            (squares[part].iter().sum::<f64>() / count).sqrt()
        })
    }

    fn in_volume<F: Filter<6>>(self, _filter: F) -> [f64; 3] {
        panic!("the scene is of the plane")
    }

    fn of_bearings<F: Filter<2>>(self, _filter: F) -> [f64; 3] {
        panic!("the scene has places")
    }
}

fn head() {
    println!(
        "| filter | all | straight 1 | turn 1°/s | straight 2 | turn 3°/s | straight 3 | peak | velocity m/s | NEES (4) | largest deviation |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|");
}

fn line(name: &str, row: &[f64; 9], deviation: Option<f64>) {
    let cells: Vec<String> = row.iter().map(|value| format!("{value:.1}")).collect();
    let deviation = deviation.map_or_else(String::new, |deviation| format!("{deviation:.1}"));
    println!("| {name} | {} | {deviation} |", cells.join(" | "));
}

/// Filters as requests name them; none of them is told the rates of the turns but the last.
fn presets() -> Vec<(&'static str, Value)> {
    let straight = |q: f64, sojourn_s: f64| json!({"model": "constant_velocity", "process_noise_m2ps3": q, "sojourn_s": sojourn_s});
    let turn = |rate: f64, sojourn_s: f64| {
        json!({
            "model": "coordinated_turn", "turn_rate_degps": rate, "process_noise_m2ps3": 0.05, "sojourn_s": sojourn_s
        })
    };
    let unknown = |q: f64, wander: f64| {
        json!({
            "model": "unknown_turn", "process_noise_m2ps3": q, "turn_noise_deg2ps3": wander, "sojourn_s": 25.0
        })
    };
    let imm = |models: Value| json!({"method": "imm", "models": models});
    vec![
        (
            "kalman, q = 20",
            json!({"method": "kalman", "process_noise_m2ps3": 20.0}),
        ),
        (
            "imm_cv_cv: q = 0.05 and 20",
            imm(json!([straight(0.05, 200.0), straight(20.0, 25.0)])),
        ),
        (
            "imm_cv_ca: q = 0.05 m²/s³ and 0.1 m²/s⁵",
            imm(
                json!([straight(0.05, 200.0), {"model": "constant_acceleration", "sojourn_s": 25.0}]),
            ),
        ),
        (
            "atc-maneuver: straight, and a turn of unknown rate, 0.2 deg²/s³",
            imm(json!([straight(0.05, 200.0), unknown(0.05, 0.2)])),
        ),
        (
            "the same with q = 1 in the turn",
            imm(json!([straight(0.05, 200.0), unknown(1.0, 0.2)])),
        ),
        (
            "imm_cv_ct: straight, and ± 2°/s",
            imm(json!([
                straight(0.05, 200.0),
                turn(2.0, 25.0),
                turn(-2.0, 25.0)
            ])),
        ),
        (
            "straight, + 1°/s and − 3°/s: told",
            imm(json!([
                straight(0.05, 200.0),
                turn(1.0, 100.0),
                turn(-3.0, 100.0)
            ])),
        ),
    ]
}
