//! Runs a preset through the library, without the service, and prints its result; a campaign as its table of cells with the
//! time that deciding took.
//!
//! `cargo run --release --example run_preset -- PRESET [RUNS]`.

use serde_json::json;
use std::ops::ControlFlow;
use std::time::{Duration, Instant};
use trackloom_domain::experiment::observer::{Observer, Step};
use trackloom_domain::experiment::{plan, presets, run};

/// Has a clock, and never stops.
struct Clock(Instant);

impl Observer for Clock {
    fn progress(&mut self, _: Step, _: u64, _: u64) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    fn now(&self) -> Option<Duration> {
        Some(self.0.elapsed())
    }
}

fn main() {
    let mut arguments = std::env::args().skip(1);
    let name = arguments
        .next()
        .unwrap_or_else(|| "liang2009-10".to_owned());
    let Some(mut preset) = presets::find(&name) else {
        let known: Vec<String> = presets::all()
            .into_iter()
            .map(|preset| preset.name)
            .collect();
        panic!(
            "there is no preset '{name}'; there are {}",
            known.join(", ")
        );
    };
    if let Some(runs) = arguments.next() {
        preset.body["runs"] = json!(runs.parse::<u32>().expect("RUNS is a number"));
    }
    let plan = plan(preset.kind, &preset.body).expect("a preset is a plan");
    let outcome = run(&plan, Vec::new(), &mut Clock(Instant::now())).expect("a preset runs");
    match outcome
        .artifacts
        .iter()
        .find(|artifact| artifact.name == "cells.md")
    {
        Some(table) => print!("{}", String::from_utf8_lossy(&table.bytes)),
        None => println!("{:#}", outcome.result),
    }
    for time in &outcome.cell_times {
        let ratio = time.ratio.map_or_else(String::new, |ratio| {
            format!(", {ratio:.3} of what it is compared with")
        });
        println!(
            "{}: {:.2} µs a scan{ratio}",
            time.cell, time.decide_us_per_scan
        );
    }
}
