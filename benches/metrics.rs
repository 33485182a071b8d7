//! `cargo bench --bench metrics -- [FOLDER] [COPIES…]`: what CLEAR, Identity and HOTA cost, and whether it grows in
//! proportion.
//!
//! FOLDER holds `gt.txt` and `test.txt` in MOTChallenge text; default: `$TRACKLOOM_DATA/mot-tud/TUD-Campus`. Each number
//! of copies (default 1 to 100) is a scene in which the sequence is repeated so often, one after the other in time and
//! with fresh names each time. Every figure starts from boxes in memory: overlaps, log of events, then the metrics, and
//! giving the memory back. Each part is the best of many runs, the total is their sum.

use serde_json::json;
use std::hint::black_box;
use std::path::{Path, PathBuf};
use std::time::Instant;
use trackloom_domain::evaluation::comparison::Comparison;
use trackloom_domain::evaluation::events::EventLog;
use trackloom_domain::evaluation::metrics::{METRICS, Metric, Sequence};
use trackloom_domain::formats::{ReadOptions, format_named};
use trackloom_domain::model::boxes::{BoxSet, ObjectBox};
use trackloom_domain::model::dataset::{Dataset, DatasetKind};
use trackloom_domain::registry;

const NAMES: [&str; 3] = ["clear", "identity", "hota"];
/// As many runs as fit this time, but at least a few.
const SECONDS_EACH: f64 = 1.0;
const FEWEST_RUNS: usize = 9;

fn main() {
    let arguments: Vec<String> = std::env::args()
        .skip(1)
        .filter(|argument| !argument.starts_with("--bench"))
        .collect();
    // `cargo test --benches` only wants to know that it starts.
    if arguments.iter().any(|argument| argument == "--test") {
        return;
    }
    let named = arguments
        .first()
        .filter(|argument| argument.parse::<u32>().is_err())
        .map(PathBuf::from);
    let folder = named.or_else(|| {
        std::env::var_os("TRACKLOOM_DATA")
            .map(|folder| PathBuf::from(folder).join("mot-tud/TUD-Campus"))
    });
    let Some(folder) = folder.filter(|folder| folder.join("gt.txt").exists()) else {
        println!("skipped: name a folder with gt.txt and test.txt, or set TRACKLOOM_DATA");
        return;
    };
    let (truth, tracks) = (
        read(&folder.join("gt.txt"), DatasetKind::Truth),
        read(&folder.join("test.txt"), DatasetKind::Tracks),
    );
    let mut copies: Vec<u32> = arguments
        .iter()
        .filter_map(|argument| argument.parse().ok())
        .collect();
    if copies.is_empty() {
        copies = vec![1, 2, 5, 10, 20, 50, 100];
    }
    println!(
        "{:>6} {:>8} {:>10} {:>9} {:>9} {:>9} {:>9} {:>9} {:>11}",
        "copies",
        "points",
        "overlaps",
        "events",
        NAMES[0],
        NAMES[1],
        NAMES[2],
        "us/copy",
        "total ms"
    );
    for count in copies {
        report(count, &repeated(&truth, count), &repeated(&tracks, count));
    }
}

fn read(path: &Path, kind: DatasetKind) -> BoxSet {
    let bytes = std::fs::read(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let format = format_named("mot").expect("the format is known");
    let options = ReadOptions {
        kind: Some(kind),
        ..ReadOptions::default()
    };
    match (format.read)(&mut bytes.as_slice(), &options)
        .expect("the file is sound")
        .dataset
    {
        Dataset::TruthBoxes(set) | Dataset::TrackBoxes(set) => set,
        other => panic!("expected boxes, found {}", other.kind().name()),
    }
}

/// Copies follow each other in time, and no name occurs in two.
fn repeated(set: &BoxSet, copies: u32) -> BoxSet {
    let (frames, objects) = (
        set.boxes().last().map_or(0, |one| one.frame),
        set.object_ids().len() as u32,
    );
    let ids = (0..copies)
        .flat_map(|copy| {
            set.object_ids()
                .iter()
                .map(move |id| format!("{copy}-{id}"))
        })
        .collect();
    let shifted = |copy| {
        let shift = move |one: &ObjectBox| ObjectBox {
            frame: one.frame + copy * frames,
            object: one.object + copy * objects,
            ..*one
        };
        set.boxes().iter().map(shift)
    };
    BoxSet::new(ids, (0..copies).flat_map(shifted).collect())
        .expect("copies of sound boxes are sound")
}

/// One line: the parts in milliseconds, then all.
fn report(copies: u32, truth: &BoxSet, tracks: &BoxSet) {
    let metrics: Vec<Box<dyn Metric>> = NAMES.iter().map(|name| metric(name)).collect();
    let mut best = [f64::INFINITY; 6];
    let (start, mut runs) = (Instant::now(), 0);
    while runs < FEWEST_RUNS || start.elapsed().as_secs_f64() < SECONDS_EACH {
        let times = measure(truth, tracks, &metrics);
        best.iter_mut()
            .zip(times)
            .for_each(|(best, time)| *best = best.min(time));
        runs += 1;
    }
    let [overlaps, events, clear, identity, hota, _] = best.map(|seconds| seconds * 1e3);
    let total = best.iter().sum::<f64>() * 1e3;
    let points = truth.boxes().len() + tracks.boxes().len();
    let each = total * 1e3 / f64::from(copies);
    println!(
        "{copies:>6} {points:>8} {overlaps:>10.4} {events:>9.4} {clear:>9.4} {identity:>9.4} {hota:>9.4} {each:>9.1} {total:>11.4}"
    );
}

fn metric(name: &str) -> Box<dyn Metric> {
    let method = METRICS
        .iter()
        .find(|method| method.name == name)
        .expect("a name of the table");
    let defaults =
        registry::check(&json!({}), method.parameters).expect("every parameter has a default");
    (method.build)(&defaults).expect("defaults build")
}

/// Seconds of each part, the last giving the memory back.
fn measure(truth: &BoxSet, tracks: &BoxSet, metrics: &[Box<dyn Metric>]) -> [f64; 6] {
    let mut times = [0.0; 6];
    let start = Instant::now();
    let comparison = Comparison::of_boxes(black_box(truth), black_box(tracks), 0.5);
    times[0] = start.elapsed().as_secs_f64();
    let events = EventLog::new(&comparison);
    times[1] = start.elapsed().as_secs_f64() - times[0];
    for (index, metric) in metrics.iter().enumerate() {
        let before = start.elapsed().as_secs_f64();
        black_box(metric.evaluate(&[Sequence {
            comparison: &comparison,
            events: &events,
            input: None,
        }]));
        times[index + 2] = start.elapsed().as_secs_f64() - before;
    }
    let before = start.elapsed().as_secs_f64();
    drop((comparison, events));
    times[5] = start.elapsed().as_secs_f64() - before;
    times
}
