//! How the run time of Liang's experiment grows with the targets: times of tracking and of the automaton, medians over runs with seeds
//! 1, 2, … of the least of five tries each, and the slope of log time over log targets with its 95 % interval (1 is linear).
//!
//! `cargo run --release -p trackloom-domain --example liang_growth [-- RUNS [TARGETS …]]`; 20 runs of 10, 30, 50, 80 and 100 targets
//! unless said otherwise. Times of more than 100 targets are those on the processor, where Linux tells them. Up to 100 targets
//! share the square of the paper; more have a larger square, radar and clutter, of the density of 100.

use serde_json::json;
use std::ops::ControlFlow;
use std::time::Instant;
use trackloom_domain::experiment::observer::{Observer, Step};
use trackloom_domain::experiment::{JobKind, Plan, plan, presets, run};
use trackloom_domain::math::stats::{quantile, slope};

const ASSOCIATORS: [(&str, &str); 3] = [
    ("NN", "nearest_neighbour"),
    ("PDA", "pda"),
    ("JPDA", "jpda"),
];

/// Books the time between two calls on the step of the second, or on that of the first where the second only begins.
struct Watch {
    clock_s: fn(Instant) -> f64,
    start: Instant,
    last: (f64, Step),
    track_s: f64,
    judge_s: f64,
}

fn wall_s(start: Instant) -> f64 {
    start.elapsed().as_secs_f64()
}

/// Of this thread on a processor, which is booked up to now when the thread offers to step aside; asking takes some microseconds, so for
/// long steps only.
fn processor_s(start: Instant) -> f64 {
    std::thread::yield_now();
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok();
    let spent_ns = text.and_then(|text| text.split(' ').next()?.parse::<f64>().ok());
    spent_ns.map_or_else(|| wall_s(start), |spent_ns| spent_ns * 1e-9)
}

impl Observer for Watch {
    fn progress(&mut self, step: Step, done: u64, _: u64) -> ControlFlow<()> {
        let now_s = (self.clock_s)(self.start);
        match if done == 0 { self.last.1 } else { step } {
            Step::Associate => self.track_s += now_s - self.last.0,
            Step::Evaluate => self.judge_s += now_s - self.last.0,
            _ => {}
        }
        self.last = (now_s, step);
        ControlFlow::Continue(())
    }
}

/// The job of the campaign's runs, with so many targets.
fn job(targets: f64, method: &str) -> Plan {
    let mut body = presets::find("liang2009-table1")
        .expect("the preset exists")
        .body["base"]
        .take();
    body.as_object_mut()
        .expect("a base is an object")
        .remove("kind");
    body["associator"] = json!({"method": method});
    let scenario = &mut body["input"]["scenario"];
    scenario["targets"]["count"] = json!(targets as u64);
    let scale = (targets / 100.0).max(1.0);
    let mut grow = |pointer: &str, factor: f64| {
        let value = scenario.pointer_mut(pointer).expect("the preset has it");
        *value = json!(value.as_f64().expect("it is a number") * factor);
    };
    grow("/targets/area_side_m", scale.sqrt());
    grow("/sensors/0/max_range_m", scale.sqrt());
    grow("/sensors/0/clutter_per_scan", scale);
    let job = plan(JobKind::Evaluate, &body).expect("the job is right");
    Plan {
        wants_files: false,
        ..job
    }
}

/// Other programs only ever add time to a try.
const TRIES: u32 = 5;

/// Milliseconds of tracking, of judging and of both: medians over the runs.
fn times_ms(targets: f64, method: &str, runs: u32) -> [f64; 3] {
    let (job, clock_s) = (
        job(targets, method),
        if targets > 100.0 {
            processor_s as fn(Instant) -> f64
        } else {
            wall_s
        },
    );
    let mut columns = [Vec::new(), Vec::new(), Vec::new()];
    for seed in 1..=runs {
        let tries = (0..TRIES).map(|_| {
            try_s(
                &Plan {
                    seed,
                    ..job.clone()
                },
                clock_s,
            )
        });
        let least_s = tries
            .reduce(|[track, judge], next| [track.min(next[0]), judge.min(next[1])])
            .expect("there are tries");
        for (column, spent_s) in
            columns
                .iter_mut()
                .zip([least_s[0], least_s[1], least_s[0] + least_s[1]])
        {
            column.push(spent_s * 1e3);
        }
    }
    columns.map(|mut column| {
        column.sort_by(f64::total_cmp);
        quantile(&column, 0.5).expect("there are runs")
    })
}

/// Seconds of tracking and of judging.
fn try_s(job: &Plan, clock_s: fn(Instant) -> f64) -> [f64; 2] {
    let start = Instant::now();
    let mut watch = Watch {
        clock_s,
        start,
        last: (clock_s(start), Step::Load),
        track_s: 0.0,
        judge_s: 0.0,
    };
    run(job, Vec::new(), &mut watch).expect("the job succeeds");
    [watch.track_s, watch.judge_s]
}

fn grown(targets: &[f64], times_ms: impl Iterator<Item = f64>) -> String {
    let points: Vec<(f64, f64)> = targets
        .iter()
        .zip(times_ms)
        .map(|(targets, ms)| (targets.ln(), ms.ln()))
        .collect();
    slope(&points, 0.95).map_or_else(String::new, |found| {
        format!(
            "{:.2} ({:.2} to {:.2})",
            found.slope, found.interval.low, found.interval.high
        )
    })
}

fn main() {
    let numbers: Vec<f64> = std::env::args()
        .skip(1)
        .filter_map(|word| word.parse().ok())
        .collect();
    let (runs, targets) = match numbers.as_slice() {
        [] => (20, vec![10.0, 30.0, 50.0, 80.0, 100.0]),
        [runs] => (*runs as u32, vec![10.0, 30.0, 50.0, 80.0, 100.0]),
        [runs, targets @ ..] => (*runs as u32, targets.to_vec()),
    };
    println!(
        "| targets |{}\n|---|---|---|---|",
        ASSOCIATORS
            .map(|(name, _)| format!(" {name}: tracking + automaton (ms) |"))
            .concat()
    );
    let times: Vec<[[f64; 3]; 3]> = targets
        .iter()
        .map(|&targets| ASSOCIATORS.map(|(_, method)| times_ms(targets, method, runs)))
        .collect();
    for (targets, line) in targets.iter().zip(&times) {
        println!(
            "| {targets} |{}",
            line.map(|[track, judge, _]| format!(" {track:.3} + {judge:.3} |"))
                .concat()
        );
    }
    for (part, name) in ["tracking", "automaton", "both"].iter().enumerate() {
        let column = |(associator, _): (usize, &(&str, &str))| {
            format!(
                " {} |",
                grown(&targets, times.iter().map(|line| line[associator][part]))
            )
        };
        println!(
            "| slope of {name} |{}",
            ASSOCIATORS
                .iter()
                .enumerate()
                .map(column)
                .collect::<String>()
        );
    }
}
