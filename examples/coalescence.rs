//! Two targets that fly side by side and part, under associators that average and others that decide: prints the table of
//! `docs/jpda.md`.
//!
//! `cargo run --release -p trackloom-domain --example coalescence [RUNS]`

#[path = "../benches/support/coalescence.rs"]
mod coalescence;

use coalescence::{OUTCOMES, PUBLISHED, associators, found};

fn main() {
    let runs = std::env::args().nth(1).and_then(|text| text.parse().ok());
    let runs: u32 = runs.unwrap_or(300);
    println!(
        "| associator | RMS in parallel, m | after, m | median square in parallel, m² | {} |",
        OUTCOMES.join(" | ")
    );
    println!("|---|---|---|---|---|---|---|---|");
    for (name, associator) in associators() {
        if let Some((_, rms_m, median_m2, shares)) = PUBLISHED.iter().find(|line| line.0 == name) {
            let numbers = [rms_m[0], rms_m[1], *median_m2];
            line(&format!("{name}, numpy"), numbers.map(told), *shares);
        }
        let found = found(&associator, runs);
        let [parallel, after] = found.rms_m();
        let numbers = [parallel, after, found.median_m2()];
        line(&name, numbers.map(told_with_error), found.shares());
    }
}

fn told(number: f64) -> String {
    format!("{number:.3}")
}

fn told_with_error((number, error): (f64, f64)) -> String {
    format!("{number:.3} ± {error:.3}")
}

fn line(name: &str, numbers: [String; 3], shares: [f64; 4]) {
    let shares = shares.map(|share| format!("{:.1} %", 100.0 * share));
    println!(
        "| {name} | {} | {} |",
        numbers.join(" | "),
        shares.join(" | ")
    );
}
