//! What no campaign of groups can say: mean squared errors of genetic fuzzy c-means, on scenes and on images, and ratios of times.
//! Rows are those of `docs/data/cai-fuzzy-errors.csv` and `cai-fuzzy-times.csv`.

use super::{SCENES, base_of};
use crate::segmentation::{Found, compare, image};
use rustix::time::{ClockId, clock_gettime};
use serde_json::{Value, json};
use std::ops::ControlFlow;
use trackloom_domain::experiment::observer::{Observer, Step};
use trackloom_domain::experiment::{JobKind, plan, presets, run};
use trackloom_domain::math::fuzzy_c_means::{Metric, Objects};
use trackloom_domain::math::rng::Seed;
use trackloom_domain::math::stats::{mean, t_interval};
use trackloom_domain::model::scenario::Scenario;
use trackloom_domain::simulation::simulate;

pub const HEADER: &str = "preset,cell,quantity,value,low,high,runs,seed";

/// As [`compare`] gives what they found.
const METHODS: [&str; 4] = [
    "FCM",
    "genetic FCM",
    "plain genetic",
    "plain genetic, ten times the distances",
];

fn row(preset: &str, cell: &str, quantity: &str, values: &[f64]) {
    let value = mean(values).expect("there are runs");
    let interval = t_interval(values, 0.95).map_or_else(String::new, |interval| {
        format!("{:.6},{:.6}", interval.low, interval.high)
    });
    let runs = values.len();
    println!("{preset},\"{cell}\",{quantity},{value:.6},{interval},{runs},1");
}

const IMAGES: [(&str, f64, usize); 2] = [
    ("image of even classes", 12.0, 20),
    ("image of uneven classes", 15.0, 6),
];

/// Genetic fuzzy c-means on ten images of each kind, and on one instant of each of ten runs of each scene.
pub fn genetic() {
    for (name, disc, square) in IMAGES {
        let found: Vec<[Found; 4]> = (1..=10)
            .map(|seed| {
                let seed = Seed { seed, run: 0 };
                let pixels = image(seed, disc, square);
                let objects =
                    Objects::new(&pixels, &[false], Metric::Scaled(&[1.0])).expect("grey levels");
                compare(&objects, 3, seed)
            })
            .collect();
        tell(name, &found);
    }
    for scene in SCENES {
        let mut scenario = base_of(scene)["input"]["scenario"].take();
        for sensor in scenario["sensors"]
            .as_array_mut()
            .expect("there are sensors")
        {
            (sensor["x_m"], sensor["y_m"]) = (json!(0.0), json!(0.0));
        }
        let scenario: Scenario = serde_json::from_value(scenario).expect("a scenario");
        let found: Vec<[Found; 4]> = (1..=10)
            .map(|seed| of_scene(&scenario, Seed { seed, run: 0 }))
            .collect();
        tell(scene, &found);
    }
}

/// The tenth instant: places in units of σ.
fn of_scene(scenario: &Scenario, seed: Seed) -> [Found; 4] {
    let simulated = simulate(scenario, seed, &mut |_| ControlFlow::Continue(()));
    let recording = simulated
        .expect("a sound scenario")
        .expect("nobody stops it");
    let recording = recording.recording;
    let scans = recording.scans.iter().filter(|scan| scan.time_s == 20.0);
    let values: Vec<f64> = scans
        .flat_map(|scan| &scan.detections)
        .filter_map(|detection| detection.measurement.position())
        .flat_map(|place| [place[0], place[1]])
        .collect();
    let sigmas = [200.0, 200.0];
    let objects = Objects::new(&values, &[false, false], Metric::Scaled(&sigmas)).expect("places");
    compare(&objects, 25, seed)
}

type Quantity = fn(&Found) -> f64;

fn tell(cell: &str, found: &[[Found; 4]]) {
    let preset = "cai-fuzzy-errors";
    let column = |method: usize, of: Quantity| -> Vec<f64> {
        found.iter().map(|found| of(&found[method])).collect()
    };
    let quantities: [(&str, Quantity); 3] = [
        ("mean squared error", |found| found.mean_squared_error),
        ("J", |found| found.cost),
        ("rounds of distances", |found| found.rounds as f64),
    ];
    for (method, name) in METHODS.iter().enumerate() {
        let cell = format!("{cell} | {name}");
        for (quantity, of) in quantities {
            row(preset, &cell, quantity, &column(method, of));
        }
        for (quantity, of) in &quantities[..2] {
            for (reference, other) in METHODS.iter().enumerate().take(method.min(2)) {
                let pairs = column(method, *of).into_iter().zip(column(reference, *of));
                let ratios: Vec<f64> = pairs.map(|(over, under)| over / under).collect();
                let quantity = format!("{quantity} over that of {other}");
                row(preset, &cell, &quantity, &ratios);
            }
        }
    }
}

/// Time of this thread on a processor.
fn processor_s() -> f64 {
    let spent = clock_gettime(ClockId::ThreadCPUTime);
    spent.tv_sec as f64 + spent.tv_nsec as f64 * 1e-9
}

/// From the end of what comes before to the last instant, or scan, that is associated.
#[derive(Default)]
pub struct Watch {
    begun_s: f64,
    pub spent_s: f64,
}

impl Observer for Watch {
    fn progress(&mut self, step: Step, done: u64, total: u64) -> ControlFlow<()> {
        if step != Step::Associate || done == 0 {
            self.begun_s = processor_s();
        } else if done == total {
            self.spent_s = processor_s() - self.begun_s;
        }
        ControlFlow::Continue(())
    }
}

/// Of each job, for each seed the least of five. Jobs take turns, so that what slows the machine for a while slows all of them.
fn times_of(kind: JobKind, bodies: &[Value], runs: u32) -> Vec<Vec<f64>> {
    let mut spent = vec![Vec::new(); bodies.len()];
    for seed in 1..=runs {
        let mut least_s = vec![f64::INFINITY; bodies.len()];
        for _ in 0..5 {
            for (body, least_s) in bodies.iter().zip(&mut least_s) {
                *least_s = least_s.min(time_of(kind, body, seed));
            }
        }
        for (spent, least_s) in spent.iter_mut().zip(least_s) {
            spent.push(least_s);
        }
    }
    spent
}

fn time_of(kind: JobKind, body: &Value, seed: u32) -> f64 {
    let mut body = body.clone();
    body["seed"] = json!(seed);
    let plan = plan(kind, &body).expect("the body is right");
    let mut watch = Watch::default();
    run(&plan, Vec::new(), &mut watch).expect("the job succeeds");
    watch.spent_s
}

/// Ratios of times on the processor, run by run in one process.
pub fn times(runs: u32) {
    let mut bodies = Vec::new();
    for scene in SCENES {
        let mut body = base_of(scene);
        bodies.push(body.clone());
        body["grouper"] = json!({"method": "nearest_neighbour", "gate_sigmas": 3.0});
        bodies.push(body);
    }
    let found = times_of(JobKind::Group, &bodies, runs);
    for (scene, pair) in SCENES.iter().zip(found.chunks(2)) {
        row_of_ratio(scene, "FCM over NN", &pair[0], &pair[1]);
        row("cai-fuzzy-times", scene, "FCM of a scene (s)", &pair[0]);
        row("cai-fuzzy-times", scene, "NN of a scene (s)", &pair[1]);
    }
    for (name, of_motion) in ["cv", "weave"].iter().zip(found.chunks(4)) {
        row_of_ratio(
            name,
            "NN of 15 duplicates over 10",
            &of_motion[3],
            &of_motion[1],
        );
        row_of_ratio(
            name,
            "FCM of 15 duplicates over 10",
            &of_motion[2],
            &of_motion[0],
        );
    }
    groupers(runs);
    trackers(runs);
}

fn row_of_ratio(cell: &str, quantity: &str, over: &[f64], under: &[f64]) {
    let pairs = over.iter().zip(under);
    let ratios: Vec<f64> = pairs.map(|(over, under)| over / under).collect();
    row("cai-fuzzy-times", cell, quantity, &ratios);
}

/// The job that a preset's campaign runs, without its kind.
fn base_of_claim(name: &str) -> Value {
    let mut body = presets::find(name).expect("a preset").body["base"].take();
    body.as_object_mut().expect("an object").remove("kind");
    body
}

/// Groupers by one attribute and by several.
fn groupers(runs: u32) {
    let sets = [
        json!(["range"]),
        json!(["range", "bearing"]),
        json!(["range", "bearing", "range_rate"]),
        json!(["position", "range", "bearing", "range_rate"]),
    ];
    let mut body = base_of_claim("cai-fuzzy-attributes");
    let mut bodies = Vec::new();
    for method in ["nearest_neighbour", "fuzzy_c_means"] {
        body["grouper"] = json!({"method": method});
        for set in &sets {
            body["attributes"] = set.clone();
            bodies.push(body.clone());
        }
    }
    let found = times_of(JobKind::Group, &bodies, runs);
    for (name, of_method) in ["NN", "FCM"].iter().zip(found.chunks(4)) {
        for count in 2..=4 {
            let quantity = format!("{count} attributes over one");
            row_of_ratio(name, &quantity, &of_method[count - 1], &of_method[0]);
        }
    }
    row_of_ratio("four attributes", "FCM over NN", &found[7], &found[3]);
}

/// Trackers of one sensor with and without range rates.
fn trackers(runs: u32) {
    let mut body = base_of_claim("cai-fuzzy-strongest");
    body["filter"]["method"] = json!("extended");
    let sensor = json!({
        "sensor_id": "radar", "y_m": -40_000.0, "max_range_m": 80_000.0, "p_d": 0.9, "sigma_range_m": 200.0,
        "sigma_bearing_deg": 0.3, "clutter_per_scan": 500.0
    });
    for (name, associator) in [
        ("NN", json!({"method": "nearest_neighbour"})),
        ("PDA", json!({"method": "pda"})),
        (
            "FCM",
            json!({"method": "fuzzy_c_means", "weights": "weighted"}),
        ),
    ] {
        body["associator"] = associator;
        body["input"]["scenario"]["sensors"][0] = sensor.clone();
        let mut three = body.clone();
        three["input"]["scenario"]["sensors"][0]["sigma_range_rate_mps"] = json!(10.0);
        let found = times_of(JobKind::Evaluate, &[body.clone(), three], runs);
        let cell = format!("{name} as associator");
        row_of_ratio(&cell, "three values over two", &found[1], &found[0]);
    }
}
