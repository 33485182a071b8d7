//! `cargo bench -p trackloom-domain --bench sonar`: what deciding a scan costs on the scenes of bearings, in the yardstick u (one predict
//! and update of a 4-state Kalman filter) measured in the same run, as a share of the sensor's scan period, and as a ratio to JPDA. Each
//! associator meets all problems of a run once more, alone between two looks at the processor's clock; the figure is the median of
//! the timed runs. The rows are those of `docs/data/wang-bat-times.csv`.

#[path = "support/yardstick.rs"]
mod yardstick;

use rustix::time::{ClockId, clock_gettime};
use serde_json::json;
use std::ops::ControlFlow;
use std::time::Duration;
use trackloom_domain::experiment::observer::{Observer, Step};
use trackloom_domain::experiment::{plan, presets, run};
use yardstick::yardstick_ns;

/// Presets, and runs of each cell.
const SCENES: [(&str, u32); 4] = [
    ("wang-bat-2", 20),
    ("wang-bat-6", 20),
    ("wang-bat-6-ungated", 3),
    ("wang-bat-sea-trials", 10),
];

/// Of this thread on a processor.
struct Clock;

impl Observer for Clock {
    fn progress(&mut self, _: Step, _: u64, _: u64) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    fn now(&self) -> Option<Duration> {
        clock_gettime(ClockId::ThreadCPUTime).try_into().ok()
    }
}

fn main() {
    // `cargo test --benches` only wants to know that it starts.
    if std::env::args().any(|argument| argument == "--test") {
        return;
    }
    println!("preset,cell,quantity,value,low,high,runs,seed");
    let u_us = yardstick_ns() / 1e3;
    tell("yardstick", "µs", u_us, 1);
    for (name, runs) in SCENES {
        let mut preset = presets::find(name).expect("the preset exists");
        preset.body["runs"] = json!(runs);
        let plan = plan(preset.kind, &preset.body).expect("a preset is a plan");
        let outcome = run(&plan, Vec::new(), &mut Clock).expect("a preset runs");
        let period = &preset.body["base"]["input"]["scenario"]["scan_period_s"];
        let period_us = period.as_f64().expect("scans have a period") * 1e6;
        for time in outcome.cell_times {
            let (cell, us) = (format!("{name}, {}", time.cell), time.decide_us_per_scan);
            tell(&cell, "u a scan", us / u_us, runs);
            tell(&cell, "share of the period", us / period_us, runs);
            tell(&cell, "to JPDA", time.ratio.unwrap_or(1.0), runs);
        }
    }
}

fn tell(cell: &str, quantity: &str, value: f64, runs: u32) {
    println!("wang-bat-times,\"{cell}\",{quantity},{value:.4e},,,{runs},1");
}
