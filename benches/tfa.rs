//! `cargo bench --bench tfa`: what the temporal automaton costs a symbol.
//!
//! Prints the yardstick u (one predict and update of a 4-state Kalman filter with nalgebra's fixed sizes), then for scenes
//! of 10³ to 10⁷ symbols what a symbol costs: reading the strings from the tracks, the automaton alone (build, and
//! the verdict on every target), and the whole evaluation with its report. A symbol is a scan of a truth string or of
//! an output string, and a figure is the least of several batches in time on the processor. The last line is 100 000 targets over 30 scans. `cargo bench --bench tfa -- 18 1800` measures scenes of so many targets.

#[path = "support/yardstick.rs"]
mod yardstick;

use std::hint::black_box;
use std::time::Instant;
use trackloom_domain::evaluation::credit::Credit;
use trackloom_domain::evaluation::steps::StepSettings;
use trackloom_domain::evaluation::strings::{self, StringRules, Strings};
use trackloom_domain::evaluation::temporal_automaton::births::Births;
use trackloom_domain::evaluation::temporal_automaton::paths::Paths;
use trackloom_domain::evaluation::temporal_automaton::search::{Order, RunSearch};
use trackloom_domain::evaluation::temporal_automaton::verdict::{Sides, judge};
use trackloom_domain::evaluation::{EvaluationInput, TfaSettings, evaluate_temporal_automaton};
use trackloom_domain::model::scan::{Detection, Measurement, Recording, RecordingParts, Scan};
use trackloom_domain::model::sensor::SensorSettings;
use trackloom_domain::model::state::State;
use trackloom_domain::model::track::{
    Candidate, Kinematics, Track, TrackPoint, TrackSet, TrackStatus,
};
use yardstick::yardstick_ns;

const SCANS: usize = 30;
const SETTINGS: TfaSettings = TfaSettings::PAPER;

fn rules() -> StringRules<'static> {
    StringRules {
        symbols: SETTINGS.symbols,
        decision: SETTINGS.decision,
        max_missed: 5,
        sensors: None,
        steps: StepSettings::default(),
        credit: Credit::AtTheTime,
    }
}

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
        "{:>8} {:>10}  {:>16} {:>16} {:>16}",
        "targets", "symbols", "strings ns (u)", "automaton ns (u)", "whole ns (u)"
    );
    let named: Vec<usize> = std::env::args()
        .filter_map(|argument| argument.parse().ok())
        .collect();
    for &targets in if named.is_empty() {
        &[18, 180, 1_800, 18_000, 180_000, 100_000]
    } else {
        &named[..]
    } {
        measure(targets, u_ns);
    }
}

fn measure(targets: usize, u_ns: f64) {
    let (recording, tracks) = scene(targets);
    let input = EvaluationInput {
        recording: Some(&recording),
        truth: None,
        tracks: &tracks,
    };
    let track_ranks: Vec<u32> = (0..tracks.tracks.len() as u32).collect();
    let strings = strings::write_strings(&input, &rules()).expect("the inputs fit");
    let symbols = symbols_of(&strings);
    let totals_ns = [
        least_ns(|| drop(black_box(strings::write_strings(&input, &rules())))),
        least_ns(|| {
            black_box(verdicts(&strings, &track_ranks));
        }),
        least_ns(|| drop(black_box(evaluate_temporal_automaton(&input, &SETTINGS)))),
    ];
    let each = totals_ns.map(|total_ns| {
        let ns = total_ns / symbols as f64;
        format!("{ns:.1} ({:.3})", ns / u_ns)
    });
    println!(
        "{targets:>8} {symbols:>10}  {:>16} {:>16} {:>16}",
        each[0], each[1], each[2]
    );
}

/// What a run costs: the least of several batches, each long enough to be measured, in time on the processor where the
/// system tells it.
fn least_ns(mut run: impl FnMut()) -> f64 {
    let batch = |times: u32, run: &mut dyn FnMut()| {
        let start = (processor_ns(), Instant::now());
        (0..times).for_each(|_| run());
        let wall_ns = start.1.elapsed().as_secs_f64() * 1e9;
        processor_ns()
            .zip(start.0)
            .map_or(wall_ns, |(now, before)| now - before)
    };
    let mut times = 1;
    while batch(times, &mut run) < 100e6 && times < 1 << 20 {
        times *= 2;
    }
    (0..5)
        .map(|_| batch(times, &mut run) / f64::from(times))
        .fold(f64::INFINITY, f64::min)
}

/// Nanoseconds that this thread has spent on a processor, from Linux.
fn processor_ns() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    text.split(' ').next()?.parse().ok()
}

/// Builds the automaton and judges every target by it.
fn verdicts(strings: &Strings, track_ranks: &[u32]) -> usize {
    let outputs = &strings.outputs.strings;
    let births = Births::new(outputs);
    let sides = Sides {
        truth: &strings.truth,
        outputs,
        births: &births,
        track_ranks,
    };
    let judged = judge(
        sides,
        &Paths {
            outputs,
            births: &births,
        },
        &mut RunSearch::new(Order::BreadthFirst),
    );
    judged.iter().map(|target| target.errors).sum()
}

fn symbols_of(strings: &Strings) -> usize {
    let count = |set: &strings::normal_form::StringSet| {
        set.strings()
            .iter()
            .map(|string| string.end() - string.start)
            .sum::<usize>()
    };
    count(&strings.truth) + count(&strings.outputs.strings)
}

/// Targets seen in nine scans of ten, and tracks that take the right detection except where two of them change places or
/// one takes clutter.
fn scene(targets: usize) -> (Recording, TrackSet) {
    let mut dice = 12_345_u64;
    let mut roll = move |sides: u64| {
        dice = dice
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (dice >> 33) % sides
    };
    let mut parts = RecordingParts {
        sensors: vec![SensorSettings::named("radar")],
        origins_known: true,
        ..Default::default()
    };
    parts.targets = (1..=targets).map(|target| target.to_string()).collect();
    let mut tracks = TrackSet {
        sensor_ids: vec!["radar".into()],
        ..Default::default()
    };
    tracks.tracks = (1..=targets)
        .map(|track| Track {
            track_id: track.to_string(),
            points: Vec::with_capacity(SCANS),
        })
        .collect();
    for scan in 0..SCANS {
        let mut detections = Vec::new();
        for target in 0..targets {
            let is_seen = roll(10) > 0;
            let origin = if roll(50) == 0 {
                None
            } else {
                Some(target as u32)
            };
            let detection = is_seen.then_some(parts.detection_ids.len() as u32);
            if is_seen {
                parts
                    .detection_ids
                    .push(parts.detection_ids.len().to_string());
                let measurement = Measurement::Position {
                    x_m: roll(1000) as f64,
                    y_m: roll(1000) as f64,
                };
                detections.push(Detection {
                    measurement,
                    origin,
                    amplitude: None,
                });
            }
            let taker = if roll(100) == 0 {
                (target + 1) % targets
            } else {
                target
            };
            tracks.tracks[taker].points.push(point(
                scan,
                tracks.candidates.len() as u32,
                detection.is_some(),
            ));
            tracks.candidates.push(Candidate {
                detection,
                probability: if detection.is_some() { 0.9 } else { 0.5 },
            });
        }
        let number = scan as u32 + 1;
        parts.scans.push(Scan {
            number,
            time_s: 8.0 * f64::from(number),
            sensor: 0,
            pose: None,
            own: Vec::new(),
            detections,
        });
    }
    tracks.detection_ids = parts.detection_ids.clone();
    (Recording::new(parts).expect("the scene is valid"), tracks)
}

fn point(scan: usize, first_candidate: u32, is_seen: bool) -> TrackPoint {
    let status = Some(if is_seen {
        TrackStatus::Confirmed
    } else {
        TrackStatus::Coasted
    });
    let time_s = 8.0 * (scan + 1) as f64;
    let estimate = Kinematics::of_plane(&State::new(1.0, 2.0, 3.0, 4.0), true, None);
    TrackPoint {
        height_m: None,
        time_s,
        sensor: Some(0),
        estimate,
        nis: None,
        status,
        known_at_s: None,
        existence: None,
        mode_row: None,
        first_candidate,
        candidates: 1,
    }
}
