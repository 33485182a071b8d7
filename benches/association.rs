//! `cargo bench`: what association costs, as ratios in one run.
//!
//! Prints the yardstick u (one predict and update of a 4-state Kalman filter with nalgebra's fixed sizes), then for
//! scenes of 100 to 100 000 targets of equal density the cost of the whole tracker for each track and scan under `oracle`
//! (the filter alone) and under every other associator, in u, as a ratio to the oracle, and for each detection as a ratio to
//! the smallest scene. Last, what JPDA costs in whole runs and how it found its marginals.
//! `cargo bench --bench association -- 100 5000` runs only these sizes, `-- jpda` only the whole runs of JPDA, `-- imm` only what
//! filters of several motion models cost, `-- space` only what tracks in space cost beside those in the plane, `-- begin` what beginnings over several
//! scans cost, and `-- existence` what trackers with a probability of existence cost: of the sizes and the trackers that are named, else of all.

#[path = "support/flights.rs"]
mod flights;
#[path = "support/yardstick.rs"]
mod yardstick;

use serde::Deserialize;
use serde_json::json;
use std::hint::black_box;
use std::time::Instant;
use trackloom_domain::association::{ASSOCIATORS, Associator};
use trackloom_domain::filtering::{AnyFilter, FILTERS};
use trackloom_domain::math::rng::Seed;
use trackloom_domain::model::scan::{Measurement, Recording};
use trackloom_domain::model::scenario::{
    RandomTargets, ReportNoise, Scenario, ScenarioSensor, TargetPlan,
};
use trackloom_domain::model::sensing::MeasurementModel;
use trackloom_domain::model::sensor::Sensor;
use trackloom_domain::model::space::Space;
use trackloom_domain::model::watch::Watch;
use trackloom_domain::registry;
use trackloom_domain::tracking::{
    Confirmation, History, Initiation, LIFECYCLE, Lifecycle, MultiScan, TRACKERS, TrackerParts,
};
use yardstick::yardstick_ns;

/// Every figure is the least of this many runs, the contenders taking turns: what other programs do only ever adds.
const RUNS: usize = 15;

/// Targets of the scenes.
const SIZES: [u32; 5] = [100, 1_000, 5_000, 10_000, 100_000];

fn main() {
    // `cargo test --benches` only wants to know that it starts.
    if std::env::args().any(|argument| argument == "--test") {
        return;
    }
    let u_ns = yardstick_ns();
    println!(
        "yardstick u = {u_ns:.1} ns (4-state Kalman predict + update, nalgebra, fixed sizes)\n"
    );
    println!(
        "{:>8}  {:<24} {:>12} {:>8} {:>8} {:>9} {:>14} {:>11}",
        "targets",
        "associator",
        "track-scans",
        "ns each",
        "u each",
        "/ oracle",
        "ns a detection",
        "/ smallest"
    );
    let chosen: Vec<u32> = std::env::args()
        .filter_map(|argument| argument.parse().ok())
        .collect();
    if std::env::args().any(|argument| argument == "jpda") {
        jpda_scenes(u_ns);
        return;
    }
    if std::env::args().any(|argument| argument == "imm") {
        imm_scenes(u_ns);
        return;
    }
    if std::env::args().any(|argument| argument == "begin") {
        begin_scenes(u_ns);
        return;
    }
    if std::env::args().any(|argument| argument == "existence") {
        existence_scenes(u_ns);
        return;
    }
    if std::env::args().any(|argument| argument == "space") {
        space_scenes(u_ns);
        return;
    }
    let mut smallest = Vec::new();
    for &targets in if chosen.is_empty() {
        &SIZES[..]
    } else {
        &chosen
    } {
        let found = compare(targets, u_ns, &smallest);
        if smallest.is_empty() {
            smallest = found;
        }
    }
    if chosen.is_empty() {
        jpda_scenes(u_ns);
        imm_scenes(u_ns);
        space_scenes(u_ns);
        begin_scenes(u_ns);
        existence_scenes(u_ns);
    }
}

/// The whole run of trackers with a probability of existence beside that of JPDA with M of N.
fn existence_scenes(u_ns: f64) {
    println!("\nExistence, for each detection");
    println!(
        "{:>8}  {:<24} {:>10} {:>8} {:>8} {:>11}",
        "targets", "tracker", "ns each", "u each", "/ JPDA", "/ smallest"
    );
    let jpda = Contender::new("jpda");
    let apart = json!({"against_coalescence": "best_permutation"});
    let existence = Lifecycle::deserialize(
        registry::check(&json!({"confirmation": {"rule": "existence"}}), &LIFECYCLE)
            .expect("the parameters are right"),
    );
    let confirmation = existence.expect("checked parameters build").confirmation;
    let contenders = [
        ("JPDA", jpda.clone()),
        (
            "JPDA*",
            Contender {
                parameters: apart.clone(),
                ..jpda.clone()
            },
        ),
        (
            "JPDA, existence",
            Contender {
                confirmation,
                ..jpda.clone()
            },
        ),
        (
            "PMB",
            Contender {
                tracker: 1,
                ..jpda.clone()
            },
        ),
        (
            "PMB, GNN",
            Contender {
                tracker: 1,
                ..Contender::new("global_nearest_neighbour")
            },
        ),
        (
            "PMB, JPDA*",
            Contender {
                tracker: 1,
                parameters: apart,
                ..jpda
            },
        ),
    ];
    let (sizes, contenders) = (chosen_sizes(&[100, 1_000]), chosen_contenders(contenders));
    let mut smallest = Vec::new();
    for targets in sizes {
        let (scenario, recording) = scene(targets);
        let detections = recording.detection_count() as f64;
        let mut least_ns = vec![f64::INFINITY; contenders.len()];
        for _ in 0..RUNS {
            for (least_ns, (_, contender)) in least_ns.iter_mut().zip(&contenders) {
                let (seconds, ..) = contender.run(&scenario, &recording);
                *least_ns = least_ns.min(seconds * 1e9 / detections);
            }
        }
        if smallest.is_empty() {
            smallest.clone_from(&least_ns);
        }
        for (index, (name, _)) in contenders.iter().enumerate() {
            let ns = least_ns[index];
            let (u, ratio, growth) = (ns / u_ns, ns / least_ns[0], ns / smallest[index]);
            println!("{targets:>8}  {name:<24} {ns:>10.1} {u:>8.2} {ratio:>8.2} {growth:>11.2}");
        }
    }
}

/// The sizes among the arguments, else all.
fn chosen_sizes(all: &[u32]) -> Vec<u32> {
    let named: Vec<u32> = std::env::args()
        .filter_map(|argument| argument.parse().ok())
        .collect();
    if named.is_empty() {
        all.to_vec()
    } else {
        named
    }
}

/// The contenders whose names are among the arguments, else all.
fn chosen_contenders<const N: usize>(
    all: [(&'static str, Contender); N],
) -> Vec<(&'static str, Contender)> {
    let is_named =
        |(name, _): &&(&'static str, Contender)| std::env::args().any(|one| one == *name);
    let named: Vec<_> = all.iter().filter(is_named).cloned().collect();
    if named.is_empty() {
        all.to_vec()
    } else {
        named
    }
}

/// The whole tracker of positions with heights beside that of the same positions in the plane.
fn space_scenes(u_ns: f64) {
    println!("\nSpace, for each living track and scan");
    println!(
        "{:>8}  {:<24} {:<24} {:>8} {:>8} {:>9}",
        "targets", "associator", "states", "ns each", "u each", "/ plane"
    );
    for targets in [100, 1_000] {
        let (scenario, recording) = scene(targets);
        let lifted = lifted(&recording);
        let plane = AnyFilter::kalman(1.0);
        for method in ["oracle", "global_nearest_neighbour"] {
            let mut least_ns = [f64::INFINITY; 2];
            for _ in 0..RUNS {
                let space = plane.within(Space::Volume);
                for (least_ns, (filter, recording)) in least_ns
                    .iter_mut()
                    .zip([(plane, &recording), (space, &lifted)])
                {
                    let (seconds, scans, _) = tracked_with(filter, method, &scenario, recording);
                    *least_ns = least_ns.min(seconds * 1e9 / scans as f64);
                }
            }
            for (ns, name) in least_ns.iter().zip(["4, plane", "6, space"]) {
                let (u, ratio) = (ns / u_ns, ns / least_ns[0]);
                println!("{targets:>8}  {method:<24} {name:<24} {ns:>8.1} {u:>8.2} {ratio:>9.2}");
            }
        }
    }
}

/// The whole run with tracks that begin over several scans beside those of one point.
fn begin_scenes(u_ns: f64) {
    println!("\nBeginnings, nearest neighbour, for each detection");
    println!(
        "{:>8}  {:<12} {:>10} {:>8} {:>11}",
        "targets", "initiation", "ns each", "u each", "/ one point"
    );
    let multi_scan = Initiation::MultiScan(MultiScan {
        max_speed_mps: Some(1000.0),
        window_scans: 5,
        min_detections: 3,
        max_gap_scans: 2,
        max_nodes: 20_000,
    });
    for targets in [100, 1_000] {
        let (scenario, recording) = scene(targets);
        let detections = recording.detection_count() as f64;
        let mut least_ns = [f64::INFINITY; 2];
        for _ in 0..RUNS {
            for (least_ns, initiation) in
                least_ns.iter_mut().zip([Initiation::OnePoint, multi_scan])
            {
                let (filter, method) = (AnyFilter::kalman(1.0), "nearest_neighbour");
                let (seconds, ..) = tracked_from(initiation, filter, method, &scenario, &recording);
                *least_ns = least_ns.min(seconds * 1e9 / detections);
            }
        }
        for (ns, name) in least_ns.iter().zip(["one point", "multi-scan"]) {
            let (u, ratio) = (ns / u_ns, ns / least_ns[0]);
            println!("{targets:>8}  {name:<12} {ns:>10.1} {u:>8.2} {ratio:>11.2}");
        }
    }
}

/// The same detections, all of them 3 km high.
fn lifted(recording: &Recording) -> Recording {
    let mut parts = recording.clone().into_parts();
    for detection in parts.scans.iter_mut().flat_map(|scan| &mut scan.detections) {
        if let Measurement::Position { x_m, y_m } = detection.measurement {
            detection.measurement = Measurement::Position3 {
                x_m,
                y_m,
                z_m: 3000.0,
            };
        }
    }
    Recording::new(parts).expect("the same detections")
}

/// The whole tracker with filters of several motion models beside the filter of one: under the oracle, which costs the filter
/// alone, and under global nearest neighbour.
fn imm_scenes(u_ns: f64) {
    println!("\nIMM, for each living track and scan");
    println!(
        "{:>8}  {:<24} {:<24} {:>8} {:>8} {:>9}",
        "targets", "associator", "filter", "ns each", "u each", "/ kalman"
    );
    for targets in [100, 1_000] {
        let (scenario, recording) = scene(targets);
        for method in ["oracle", "global_nearest_neighbour"] {
            let filters = imm_filters();
            let mut least_ns = vec![f64::INFINITY; filters.len()];
            for _ in 0..RUNS {
                for (least_ns, (_, filter)) in least_ns.iter_mut().zip(&filters) {
                    let (seconds, scans, _) = tracked_with(*filter, method, &scenario, &recording);
                    *least_ns = least_ns.min(seconds * 1e9 / scans as f64);
                }
            }
            for (ns, (name, _)) in least_ns.iter().zip(&filters) {
                let (u, ratio) = (ns / u_ns, ns / least_ns[0]);
                println!("{targets:>8}  {method:<24} {name:<24} {ns:>8.1} {u:>8.2} {ratio:>9.2}");
            }
        }
    }
}

fn imm_filters() -> [(&'static str, AnyFilter); 4] {
    let straight = json!({"model": "constant_velocity", "process_noise_m2ps3": 1.0});
    let restless = json!({"model": "constant_velocity", "process_noise_m2ps3": 100.0});
    let unknown = json!({"model": "unknown_turn"});
    let accelerating = json!({"model": "constant_acceleration"});
    let imm = |models: serde_json::Value| {
        let method = FILTERS
            .iter()
            .find(|method| method.name == "imm")
            .expect("a name of the table");
        let checked = registry::check(&json!({"models": models}), method.parameters);
        (method.build)(&checked.expect("the parameters are right")).expect("they build")
    };
    [
        ("kalman", AnyFilter::kalman(1.0)),
        ("CV, CV", imm(json!([straight, restless]))),
        ("CV, CT unknown", imm(json!([straight, unknown]))),
        (
            "CV, CA, CT unknown",
            imm(json!([straight, accelerating, unknown])),
        ),
    ]
}

/// One line for each associator at one size; returns what a detection costs under each, given what it cost in the smallest scene.
fn compare(targets: u32, u_ns: f64, smallest: &[f64]) -> Vec<f64> {
    let (scenario, recording) = scene(targets);
    let runs = if targets > 20_000 { RUNS / 3 } else { RUNS };
    let mut least_ns = vec![f64::INFINITY; ASSOCIATORS.len()];
    let mut points = vec![0; ASSOCIATORS.len()];
    for _ in 0..runs {
        for (index, method) in ASSOCIATORS.iter().enumerate() {
            let (seconds, track_scans, _) = tracked(method.name, &scenario, &recording);
            least_ns[index] = least_ns[index].min(seconds * 1e9);
            points[index] = track_scans;
        }
    }
    let oracle = ASSOCIATORS
        .iter()
        .position(|method| method.name == "oracle")
        .expect("the oracle is in the table");
    let each = |index: usize| least_ns[index] / points[index] as f64;
    let detections: Vec<f64> = least_ns
        .iter()
        .map(|ns| ns / recording.detection_count() as f64)
        .collect();
    for (index, method) in ASSOCIATORS.iter().enumerate() {
        let (name, scans, ns) = (method.name, points[index], each(index));
        let (u, ratio, detection) = (ns / u_ns, ns / each(oracle), detections[index]);
        let growth = detection / smallest.get(index).unwrap_or(&detection);
        println!(
            "{targets:>8}  {name:<24} {scans:>12} {ns:>8.1} {u:>8.2} {ratio:>9.2} {detection:>14.1} {growth:>11.2}"
        );
    }
    detections
}

/// Liang's scene up to 100 targets; larger ones have a larger radar of the same target and clutter density.
fn scene(targets: u32) -> (Scenario, Recording) {
    let scale = (f64::from(targets) / 100.0).max(1.0).sqrt();
    let scenario = Scenario {
        origin: None,
        scans: 30,
        scan_period_s: 8.0,
        sensors: vec![ScenarioSensor {
            in_space: Default::default(),
            sight: Default::default(),
            timing: Default::default(),
            lat_deg: None,
            lon_deg: None,
            sensor_id: "radar".into(),
            x_m: 0.0,
            y_m: 0.0,
            course: None,
            max_range_m: Some(50_000.0 * scale),
            p_d: 0.9,
            sigma_x_m: Some(15.0),
            sigma_y_m: Some(5.2),
            sigma_range_m: None,
            sigma_bearing_deg: None,
            sigma_range_rate_mps: None,
            clutter_per_scan: Some(5.0 * scale * scale),
            clutter_dispersion: None,
            clutter_per_deg: None,
            clutter_within_deg: None,
            snr_db: None,
        }],
        targets: TargetPlan::Random(RandomTargets {
            count: targets,
            area_side_m: 100_000.0 * scale,
            speed_min_mps: 100.0,
            speed_max_mps: 1000.0,
        }),
        coverage: None,
        record: None,
    };
    recorded(scenario)
}

fn recorded(scenario: Scenario) -> (Scenario, Recording) {
    let simulated =
        trackloom_domain::simulation::simulate(&scenario, Seed { seed: 1, run: 0 }, &mut |_| {
            std::ops::ControlFlow::Continue(())
        });
    let recording = simulated
        .expect("the scene is valid")
        .expect("nobody stops it")
        .recording;
    (scenario, recording)
}

/// Seconds for the whole tracker, and how many living tracks it carried through a scan, summed over the scans.
fn tracked(
    method: &'static str,
    scenario: &Scenario,
    recording: &Recording,
) -> (f64, u64, Option<serde_json::Value>) {
    tracked_with(AnyFilter::kalman(1.0), method, scenario, recording)
}

fn tracked_with(
    filter: AnyFilter,
    method: &'static str,
    scenario: &Scenario,
    recording: &Recording,
) -> (f64, u64, Option<serde_json::Value>) {
    tracked_from(Initiation::OnePoint, filter, method, scenario, recording)
}

fn tracked_from(
    initiation: Initiation,
    filter: AnyFilter,
    method: &'static str,
    scenario: &Scenario,
    recording: &Recording,
) -> (f64, u64, Option<serde_json::Value>) {
    let contender = Contender {
        initiation,
        filter,
        ..Contender::new(method)
    };
    contender.run(scenario, recording)
}

/// What is timed.
#[derive(Clone)]
struct Contender {
    /// Of the associator, with its parameters.
    method: &'static str,
    parameters: serde_json::Value,
    filter: AnyFilter,
    initiation: Initiation,
    confirmation: Confirmation,
    /// Index into the table of trackers.
    tracker: usize,
}

impl Contender {
    fn new(method: &'static str) -> Self {
        Contender {
            method,
            parameters: json!({}),
            filter: AnyFilter::kalman(1.0),
            initiation: Initiation::OnePoint,
            confirmation: Confirmation::MOfN,
            tracker: 0,
        }
    }

    /// Seconds, track scans and what the associator says.
    fn run(
        &self,
        scenario: &Scenario,
        recording: &Recording,
    ) -> (f64, u64, Option<serde_json::Value>) {
        let sensor = &scenario.sensors[0];
        // A scene of slow targets within 2 km is not tracked with the speeds of aircraft.
        let initial_speed_sigma_mps = if sensor.max_range_m < Some(10_000.0) {
            10.0
        } else {
            430.0
        };
        let Some(ReportNoise::Position {
            sigma_x_m,
            sigma_y_m,
            ..
        }) = sensor.noise()
        else {
            panic!("the scenes have position reports")
        };
        let parts = TrackerParts {
            filter: self.filter,
            associator: associator(self.method, &self.parameters),
            lifecycle: Lifecycle {
                gate_probability: 0.999,
                initiation: self.initiation,
                confirmation: self.confirmation,
                confirm_hits: 3,
                confirm_window: 5,
                max_missed: 5,
                max_missed_s: None,
                max_position_sigma_m: None,
                initial_speed_sigma_mps,
                smoothing: None,
                merging: None,
            },
            sensors: vec![Sensor {
                sensor_id: "radar".into(),
                p_d: sensor.p_d,
                clutter_density: sensor.clutter_per_m2().unwrap_or_default(),
                may_start: true,
                report: match self.filter.space() {
                    Space::Volume => MeasurementModel::Position3 {
                        sigmas_m: [sigma_x_m, sigma_y_m, sigma_x_m],
                        clutter_span: Some(10_000.0),
                    },
                    _ => MeasurementModel::Position {
                        sigma_x_m,
                        sigma_y_m,
                    },
                },
                sight: None,
            }],
            undetected: None,
            given: Vec::new(),
        };
        let start = Instant::now();
        let mut tracker = (TRACKERS[self.tracker].build)(parts);
        let mut history = History::default();
        let mut track_scans = 0;
        for scan in &recording.scans {
            track_scans += u64::from(
                tracker
                    .step(scan, &mut history, &Watch::never())
                    .expect("the scene fits")
                    .tracks,
            );
        }
        let seconds = start.elapsed().as_secs_f64();
        let diagnostics = tracker.diagnostics();
        black_box(history);
        (seconds, track_scans, diagnostics)
    }
}

/// Scenes that decide whether a JPDA is usable: what the whole run costs, and how its marginals were found.
fn jpda_scenes(u_ns: f64) {
    println!("\nJPDA, whole runs");
    report("30 targets", &scene(30), u_ns);
    report("100 targets", &scene(100), u_ns);
    report("dense", &dense_scene(), u_ns);
    for scene in &flights::scenes() {
        report_flights(scene, u_ns);
    }
}

/// 30 targets whose gates hold each other's detections: the exact marginals and JPDA* beside the oracle, which costs the filter
/// alone.
fn report_flights(scene: &flights::Flights, u_ns: f64) {
    let associators = [
        ("oracle", json!({})),
        ("jpda", json!({"marginals": "exact"})),
        (
            "jpda",
            json!({"marginals": "exact", "against_coalescence": "best_permutation"}),
        ),
    ];
    let mut least_s = [f64::INFINITY; 3];
    let mut diagnostics = [None, None, None];
    for _ in 0..RUNS {
        for (place, (name, parameters)) in associators.iter().enumerate() {
            let associator = associator(name, parameters);
            let start = Instant::now();
            let (tracker, history) = scene.tracked(associator);
            least_s[place] = least_s[place].min(start.elapsed().as_secs_f64());
            diagnostics[place] = tracker.diagnostics();
            black_box(history);
        }
    }
    let u = least_s.map(|seconds| seconds * 1e9 / u_ns);
    println!(
        "{:>12}: {:.3} ms = {:.0} u, of which {:.0} u are the oracle's; best_permutation {:.3} ms = {:.0} u",
        scene.name,
        least_s[1] * 1e3,
        u[1],
        u[0],
        least_s[2] * 1e3,
        u[2]
    );
    for said in diagnostics.iter().flatten() {
        println!("{said}");
    }
}

fn associator(method: &str, parameters: &serde_json::Value) -> Box<dyn Associator> {
    let entry = ASSOCIATORS
        .iter()
        .find(|entry| entry.name == method)
        .expect("a name of the table");
    let checked = registry::check(parameters, entry.parameters).expect("the parameters are right");
    (entry.build)(&checked, Seed { seed: 1, run: 0 }).expect("checked parameters build")
}

/// 100 targets that start within 2 km, and 500 false detections a scan in the same 2 km.
fn dense_scene() -> (Scenario, Recording) {
    let sensor = ScenarioSensor {
        in_space: Default::default(),
        sight: Default::default(),
        timing: Default::default(),
        lat_deg: None,
        lon_deg: None,
        sensor_id: "radar".into(),
        x_m: 0.0,
        y_m: 0.0,
        course: None,
        max_range_m: Some(1_500.0),
        p_d: 0.9,
        sigma_x_m: Some(10.0),
        sigma_y_m: Some(10.0),
        sigma_range_m: None,
        sigma_bearing_deg: None,
        sigma_range_rate_mps: None,
        clutter_per_scan: Some(500.0),
        clutter_dispersion: None,
        clutter_per_deg: None,
        clutter_within_deg: None,
        snr_db: None,
    };
    let targets = RandomTargets {
        count: 100,
        area_side_m: 2_000.0,
        speed_min_mps: 1.0,
        speed_max_mps: 15.0,
    };
    recorded(Scenario {
        origin: None,
        scans: 30,
        scan_period_s: 2.0,
        sensors: vec![sensor],
        targets: TargetPlan::Random(targets),
        coverage: None,
        record: None,
    })
}

fn report(name: &str, (scenario, recording): &(Scenario, Recording), u_ns: f64) {
    let runs = if name == "dense" { 1 } else { RUNS };
    let mut least_s = f64::INFINITY;
    let mut diagnostics = None;
    for _ in 0..runs {
        let (seconds, _, said) = tracked("jpda", scenario, recording);
        least_s = least_s.min(seconds);
        diagnostics = said;
    }
    println!(
        "{name:>12}: {:.3} ms = {:.0} u",
        least_s * 1e3,
        least_s * 1e9 / u_ns
    );
    println!(
        "{}",
        diagnostics.map_or_else(String::new, |said| said.to_string())
    );
}
