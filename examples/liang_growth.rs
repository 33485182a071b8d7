//! How the run time of Liang's experiment grows with targets and with scans, as rows of `docs/data/liang2009-growth.csv`: times of tracking
//! and of the automaton on the processor, medians over runs with seeds 1, 2, … of the least of five tries each (three above 100
//! targets); ratios to nearest neighbour seed by seed; the slope of log time over log targets, and over log scans, with its 95 %
//! interval (1 is linear).
//!
//! `cargo run --release -p trackloom-domain --example liang_growth`. Up to 100 targets share the square of the paper; more have a
//! larger square, radar and clutter, of the density of 100.

use rustix::time::{ClockId, clock_gettime};
use serde_json::json;
use std::collections::BTreeMap;
use std::ops::ControlFlow;
use trackloom_domain::experiment::observer::{Observer, Step};
use trackloom_domain::experiment::{JobKind, Plan, plan, presets, run};
use trackloom_domain::math::stats::{mean, quantile, slope, t_interval};

const ASSOCIATORS: [(&str, &str); 3] = [
    ("NN", "nearest_neighbour"),
    ("PDA", "pda"),
    ("JPDA", "jpda"),
];

/// For each associator, milliseconds of tracking and of judging in each run.
type Times = [Vec<[f64; 2]>; 3];

type Part = fn(&[f64; 2]) -> f64;

/// The parts of a run's time that are told.
const PARTS: [(&str, Part); 3] = [
    ("tracking", |times| times[0]),
    ("automaton", |times| times[1]),
    ("both", both),
];

/// Books the time between two looks at the clock on the step of the second, or on that of the first where the second only begins.
/// It does not look within the steps that it times.
struct Watch {
    last: (f64, Step),
    track_s: f64,
    judge_s: f64,
}

/// Of this thread on a processor.
fn now_s() -> f64 {
    let spent = clock_gettime(ClockId::ThreadCPUTime);
    spent.tv_sec as f64 + spent.tv_nsec as f64 * 1e-9
}

impl Observer for Watch {
    fn progress(&mut self, step: Step, done: u64, total: u64) -> ControlFlow<()> {
        let is_timed = matches!(step, Step::Associate | Step::Evaluate);
        if is_timed && done > 0 && done < total {
            return ControlFlow::Continue(());
        }
        let now_s = now_s();
        match if done == 0 { self.last.1 } else { step } {
            Step::Associate => self.track_s += now_s - self.last.0,
            Step::Evaluate => self.judge_s += now_s - self.last.0,
            _ => {}
        }
        self.last = (now_s, step);
        ControlFlow::Continue(())
    }
}

/// The job of the campaign's runs, with so many targets and scans.
fn job(targets: f64, scans: f64, method: &str) -> Plan {
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
    scenario["scans"] = json!(scans as u64);
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
/// Of more than 100 targets.
const LONG_TRIES: u32 = 3;

/// For each associator and seed the least milliseconds of tracking and of judging. Associators take turns, so that what slows the
/// machine for a while slows all of them.
fn times_ms(targets: f64, scans: f64, runs: u32) -> Times {
    let tries = if targets > 100.0 { LONG_TRIES } else { TRIES };
    let mut found = [const { Vec::new() }; 3];
    let mut jobs = ASSOCIATORS.map(|(_, method)| job(targets, scans, method));
    for seed in 1..=runs {
        let mut least_ms = [[f64::INFINITY; 2]; 3];
        for _ in 0..tries {
            for (job, least_ms) in jobs.iter_mut().zip(&mut least_ms) {
                job.seed = seed;
                let spent_ms = try_s(job).map(|spent_s| spent_s * 1e3);
                *least_ms = [least_ms[0].min(spent_ms[0]), least_ms[1].min(spent_ms[1])];
            }
        }
        for (found, least_ms) in found.iter_mut().zip(least_ms) {
            found.push(least_ms);
        }
    }
    found
}

/// Seconds of tracking and of judging.
fn try_s(job: &Plan) -> [f64; 2] {
    let mut watch = Watch {
        last: (now_s(), Step::Load),
        track_s: 0.0,
        judge_s: 0.0,
    };
    run(job, Vec::new(), &mut watch).expect("the job succeeds");
    [watch.track_s, watch.judge_s]
}

/// A row of the table; without an interval where there is none.
fn tell(cell: &str, quantity: &str, value: f64, interval: Option<[f64; 2]>, runs: usize) {
    let interval = interval.map_or_else(
        || ",".to_owned(),
        |[low, high]| format!("{low:.6},{high:.6}"),
    );
    println!("liang2009-growth,\"{cell}\",{quantity},{value:.6},{interval},{runs},1");
}

fn tell_mean(cell: &str, quantity: &str, values: &[f64]) {
    let interval = t_interval(values, 0.95).map(|found| [found.low, found.high]);
    tell(
        cell,
        quantity,
        mean(values).expect("there are runs"),
        interval,
        values.len(),
    );
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut sorted: Vec<f64> = values.collect();
    sorted.sort_by(f64::total_cmp);
    quantile(&sorted, 0.5).expect("there are runs")
}

fn both(times: &[f64; 2]) -> f64 {
    times[0] + times[1]
}

/// Medians of the parts, what both are to nearest neighbour's, and the automaton's share of both.
fn tell_times(targets: f64, found: &Times) {
    for ((name, _), times) in ASSOCIATORS.iter().zip(found) {
        let (cell, runs) = (format!("{targets}, {name}"), times.len());
        for (part_name, part) in PARTS {
            tell(
                &cell,
                &format!("{part_name} ms"),
                median(times.iter().map(part)),
                None,
                runs,
            );
        }
        let pairs = times.iter().zip(&found[0]);
        let ratios: Vec<f64> = pairs
            .map(|(one, nearest)| both(one) / both(nearest))
            .collect();
        tell_mean(&cell, "to NN", &ratios);
        let share = median(times.iter().map(|times| times[1] / both(times)));
        tell(&cell, "automaton to both", share, None, runs);
    }
}

/// Of the medians at some of the counts.
fn tell_slopes(name: &str, counts: &[f64], found: &BTreeMap<u32, Times>) {
    for (associator, (method, _)) in ASSOCIATORS.iter().enumerate() {
        for (part_name, part) in PARTS {
            let mut points = Vec::new();
            for count in counts {
                let times = &found[&(*count as u32)][associator];
                points.push((count.ln(), median(times.iter().map(part)).ln()));
            }
            let found = slope(&points, 0.95).expect("there are three counts");
            let interval = Some([found.interval.low, found.interval.high]);
            tell(
                &format!("{name}, {method}"),
                &format!("slope of {part_name}"),
                found.slope,
                interval,
                counts.len(),
            );
        }
    }
}

/// Over the length of tracks: the mean over seeds of each seed's slope.
fn tell_length() {
    let (lengths, runs) = ([15.0, 30.0, 60.0, 120.0, 240.0], 5);
    let found = lengths.map(|scans: f64| times_ms(1000.0, scans, runs));
    for (associator, (method, _)) in ASSOCIATORS.iter().enumerate() {
        for (part_name, part) in PARTS {
            let mut slopes = Vec::new();
            for run in 0..runs as usize {
                let mut points = Vec::new();
                for (scans, found) in lengths.iter().zip(&found) {
                    points.push((scans.ln(), part(&found[associator][run]).ln()));
                }
                slopes.push(slope(&points, 0.95).expect("there are five lengths").slope);
            }
            tell_mean(
                &format!("15 to 240 scans, {method}"),
                &format!("slope of {part_name}"),
                &slopes,
            );
        }
    }
}

fn main() {
    println!("preset,cell,quantity,value,low,high,runs,seed");
    let mut found = BTreeMap::new();
    for (count, runs) in [
        (10, 20),
        (30, 20),
        (50, 20),
        (80, 20),
        (100, 20),
        (1000, 1),
        (3000, 1),
        (10_000, 1),
        (30_000, 1),
        (100_000, 1),
    ] {
        let times = times_ms(f64::from(count), 30.0, runs);
        tell_times(f64::from(count), &times);
        found.insert(count, times);
    }
    tell_slopes("10 to 100", &[10.0, 30.0, 50.0, 80.0, 100.0], &found);
    tell_slopes(
        "10 to 100000",
        &[10.0, 30.0, 100.0, 1e3, 3e3, 1e4, 3e4, 1e5],
        &found,
    );
    tell_length();
}
