//! trackloom's side of `benches/peers/run.sh`, one scene: simulates it, writes the detections that Stone Soup will read,
//! reads that very file, and times tracking alone — detections in memory to tracks in memory — as Stone Soup is timed.
//!
//! `cargo bench --bench peers -- TARGETS SEED FOLDER` writes detections.csv, truth.csv, METHOD.csv (the tracks) and ours.json.

use serde::Deserialize;
use serde_json::{Map, Value, json};
use std::error::Error;
use std::hint::black_box;
use std::path::Path;
use std::time::Instant;
use trackloom_domain::association::ASSOCIATORS;
use trackloom_domain::experiment::observer::Silent;
use trackloom_domain::experiment::{self, JobKind, Plan, plan, presets};
use trackloom_domain::filtering::kalman;
use trackloom_domain::formats::{self, ReadOptions};
use trackloom_domain::math::rng::Seed;
use trackloom_domain::model::dataset::Dataset;
use trackloom_domain::model::scan::Recording;
use trackloom_domain::model::scenario::Scenario;
use trackloom_domain::model::sensing::MeasurementModel;
use trackloom_domain::model::sensor::Sensor;
use trackloom_domain::model::track::TrackSet;
use trackloom_domain::model::watch::Watch;
use trackloom_domain::tracking::{History, Lifecycle, TRACKERS, TrackerParts};

const METHODS: [&str; 4] = [
    "nearest_neighbour",
    "global_nearest_neighbour",
    "pda",
    "jpda",
];

/// The first runs fill the caches and the allocator's lists; of the others the median counts.
const WARM_UP: usize = 20;
const RUNS: usize = 101;

type Failure = Box<dyn Error>;

fn main() -> Result<(), Failure> {
    let arguments: Vec<String> = std::env::args()
        .skip(1)
        .filter(|argument| !argument.starts_with("--"))
        .collect();
    // `cargo bench` and `cargo test --benches` start it without arguments.
    let [targets, seed, folder] = &arguments[..] else {
        println!("benches/peers/run.sh runs this beside Stone Soup");
        return Ok(());
    };
    compare(targets, seed.parse()?, Path::new(folder))
}

fn compare(targets: &str, seed: u32, folder: &Path) -> Result<(), Failure> {
    let mut seconds = Map::new();
    for method in METHODS {
        let plan = plan_of(targets, seed, method)?;
        let outcome = experiment::run(&plan, Vec::new(), &mut Silent)?;
        let bytes_of = |name: &str| {
            outcome
                .artifacts
                .iter()
                .find(|file| file.name == name)
                .map(|file| &file.bytes[..])
                .unwrap_or_default()
        };
        for name in ["detections.csv", "truth.csv"] {
            std::fs::write(folder.join(name), bytes_of(name))?;
        }
        let recording = read(&folder.join("detections.csv"))?;
        let (tracks, median_s) = timed(&plan.spec, &recording)?;
        let mut file = Vec::new();
        formats::write_csv(&Dataset::Tracks(tracks), &mut file)?;
        assert!(
            file == bytes_of("tracks.csv"),
            "the timed tracker does what a job does"
        );
        std::fs::write(folder.join(format!("{method}.csv")), file)?;
        seconds.insert(method.to_owned(), json!(median_s));
    }
    let spec = plan_of(targets, seed, METHODS[0])?.spec;
    let clutter_per_m2 = scenario_of(&spec)?.sensors[0].clutter_per_m2();
    let ours = json!({"seconds": seconds, "spec": spec, "clutter_per_m2": clutter_per_m2});
    Ok(std::fs::write(
        folder.join("ours.json"),
        serde_json::to_vec_pretty(&ours)?,
    )?)
}

/// The preset with another seed and associator. Stone Soup confirms a track by its third detection however far the three
/// are apart, as long as the track lives; the window is as long as that.
fn plan_of(targets: &str, seed: u32, method: &str) -> Result<Plan, Failure> {
    let mut body = presets::find(&format!("liang2009-{targets}"))
        .ok_or("no preset has so many targets")?
        .body;
    body["seed"] = json!(seed);
    body["associator"] = json!({"method": method});
    let tracker = &mut body["tracker"];
    let (hits, missed) = (
        tracker["confirm_hits"].as_u64().unwrap_or(1),
        tracker["max_missed"].as_u64().unwrap_or(1),
    );
    tracker["confirm_window"] = json!(1 + (hits - 1) * missed);
    plan(JobKind::Evaluate, &body).map_err(|faults| format!("{faults:?}").into())
}

fn scenario_of(spec: &Value) -> Result<Scenario, Failure> {
    Ok(Scenario::deserialize(&spec["input"]["scenario"])?)
}

fn read(path: &Path) -> Result<Recording, Failure> {
    let bytes = std::fs::read(path)?;
    let outcome = formats::csv::read(&mut &bytes[..], &ReadOptions::default())
        .map_err(|faults| format!("{faults:?}"))?;
    match outcome.dataset {
        Dataset::Detections(recording) => Ok(recording),
        _ => Err("the file does not hold detections".into()),
    }
}

/// The tracks, and the median of the seconds.
fn timed(spec: &Value, recording: &Recording) -> Result<(TrackSet, f64), Failure> {
    let mut seconds = Vec::new();
    for index in 0..WARM_UP + RUNS {
        let parts = parts_of(spec)?;
        let start = Instant::now();
        let tracks = track(parts, recording);
        if index >= WARM_UP {
            seconds.push(start.elapsed().as_secs_f64());
        }
        black_box(tracks);
    }
    seconds.sort_by(f64::total_cmp);
    Ok((track(parts_of(spec)?, recording), seconds[RUNS / 2]))
}

fn track(parts: TrackerParts, recording: &Recording) -> TrackSet {
    let mut tracker = (TRACKERS[0].build)(parts);
    let mut history = History::default();
    for scan in &recording.scans {
        tracker
            .step(scan, &mut history, &Watch::never())
            .expect("the scene fits");
    }
    history.into_tracks(recording)
}

fn parts_of(spec: &Value) -> Result<TrackerParts, Failure> {
    let associator = ASSOCIATORS
        .iter()
        .find(|entry| spec["associator"]["method"] == entry.name)
        .ok_or("an unknown associator")?;
    let radar = &scenario_of(spec)?.sensors[0];
    let (sigma_x_m, sigma_y_m) = radar
        .sigma_x_m
        .zip(radar.sigma_y_m)
        .ok_or("the radar does not report positions")?;
    Ok(TrackerParts {
        filter: (kalman::METHOD.build)(&spec["filter"])?,
        associator: (associator.build)(&spec["associator"], Seed { seed: 1, run: 0 })?,
        lifecycle: Lifecycle::deserialize(&spec["tracker"])?,
        sensors: vec![Sensor {
            sensor_id: radar.sensor_id.clone(),
            p_d: radar.p_d,
            clutter_density: radar.clutter_per_m2().unwrap_or_default(),
            may_start: true,
            report: MeasurementModel::Position {
                sigma_x_m,
                sigma_y_m,
            },
            sight: None,
        }],
        undetected: None,
        given: Vec::new(),
    })
}
