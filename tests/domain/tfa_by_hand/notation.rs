//! Scenes written as text, one line a target or track and one word a scan, and reports written back as text.
//!
//! - `A: a1 a2 . a4` in the truth: target A, seen at scans 1, 2 and 4. `.` is ε.
//! - `. c2 c2b+c2c` as clutter: detections that come from no target; `+` joins several at one scan.
//! - `1: a1 _ . c2` as a track: `_` is no track point at all. `a1=0.7|c1=0.2|.=0.1` are weighted candidates,
//!   `a1?` is a tentative point.
//!
//! Scans are numbered from 1 and 8 s apart.

use trackloom_domain::evaluation::{
    EvaluationInput, TfaReport, TfaSettings, evaluate_temporal_automaton,
};
use trackloom_domain::model::scan::{Detection, Measurement, Recording, RecordingParts, Scan};
use trackloom_domain::model::sensor::SensorSettings;
use trackloom_domain::model::space::Space;
use trackloom_domain::model::state::{Position, State};
use trackloom_domain::model::track::{
    Candidate, Kinematics, Track, TrackPoint, TrackSet, TrackStatus,
};
use trackloom_domain::model::truth::{Target, TruthPoint, TruthSet};

pub const BY_DETECTION: TfaSettings = TfaSettings::PAPER;

/// The report on a scene, by detection ids and with strings that end after 5 ε.
pub fn evaluate(truth: &[&str], clutter: &[&str], tracks: &[&str]) -> TfaReport {
    let (recording, tracks) = (recording(truth, clutter), track_set(tracks));
    let input = EvaluationInput {
        recording: Some(&recording),
        truth: None,
        tracks: &tracks,
    };
    evaluate_temporal_automaton(&input, &BY_DETECTION).unwrap()
}

pub fn recording(truth: &[&str], clutter: &[&str]) -> Recording {
    let lines: Vec<(Option<u32>, Vec<&str>)> = (truth.iter().enumerate())
        .map(|(target, line)| (Some(target as u32), words(line).1))
        .chain(
            clutter
                .iter()
                .map(|line| (None, line.split_whitespace().collect())),
        )
        .collect();
    let targets = truth.iter().map(|line| words(line).0.to_owned()).collect();
    let mut parts = RecordingParts {
        sensors: vec![SensorSettings::named("radar")],
        targets,
        origins_known: true,
        ..Default::default()
    };
    for index in 0..lines
        .iter()
        .map(|(_, words)| words.len())
        .max()
        .unwrap_or(0)
    {
        let mut detections = Vec::new();
        for (origin, words) in &lines {
            for name in words
                .get(index)
                .into_iter()
                .flat_map(|word| word.split('+'))
                .filter(|name| *name != ".")
            {
                parts.detection_ids.push(name.to_owned());
                detections.push(Detection {
                    measurement: Measurement::Position { x_m: 0.0, y_m: 0.0 },
                    origin: *origin,
                    amplitude: None,
                });
            }
        }
        let number = index as u32 + 1;
        parts.scans.push(Scan {
            number,
            time_s: 8.0 * f64::from(number),
            sensor: 0,
            pose: None,
            own: Vec::new(),
            detections,
        });
    }
    Recording::new(parts).unwrap()
}

pub fn track_set(lines: &[&str]) -> TrackSet {
    let mut set = TrackSet::default();
    for line in lines {
        let (name, words) = words(line);
        let mut points = Vec::new();
        for (index, word) in words
            .into_iter()
            .enumerate()
            .filter(|(_, word)| *word != "_")
        {
            points.push(point(&mut set, 8.0 * (index + 1) as f64, word));
        }
        set.tracks.push(Track {
            track_id: name.to_owned(),
            points,
        });
    }
    set
}

fn point(set: &mut TrackSet, time_s: f64, word: &str) -> TrackPoint {
    let (word, tentative) = word
        .strip_suffix('?')
        .map_or((word, false), |word| (word, true));
    let first_candidate = set.candidates.len();
    for part in word.split('|') {
        let (name, probability) = part.split_once('=').map_or((part, 1.0), |(name, weight)| {
            (name, weight.parse().unwrap())
        });
        let detection = (name != ".").then(|| {
            set.detection_ids.push(name.to_owned());
            set.detection_ids.len() as u32 - 1
        });
        set.candidates.push(Candidate {
            detection,
            probability,
        });
    }
    let status = tentative.then_some(TrackStatus::Tentative);
    let candidates = set.candidates.len() - first_candidate;
    TrackPoint {
        height_m: None,
        status,
        known_at_s: None,
        existence: None,
        mode_row: None,
        first_candidate: first_candidate as u32,
        candidates: candidates as u32,
        ..bare_point(time_s, 0.0, 0.0)
    }
}

fn bare_point(time_s: f64, x_m: f64, y_m: f64) -> TrackPoint {
    let state = State::new(x_m, y_m, 0.0, 0.0);
    let estimate = Kinematics::of_plane(&state, false, None);
    TrackPoint {
        height_m: None,
        time_s,
        sensor: None,
        estimate,
        status: None,
        nis: None,
        known_at_s: None,
        existence: None,
        mode_row: None,
        first_candidate: 0,
        candidates: 0,
    }
}

/// `A: a1 a2` → (`A`, [`a1`, `a2`]).
fn words(line: &str) -> (&str, Vec<&str>) {
    let (name, rest) = line.split_once(':').unwrap();
    (name, rest.split_whitespace().collect())
}

/// [(time_s, x_m, y_m)]
type Path<'a> = &'a [(f64, f64, f64)];

/// Truth from names and paths.
pub fn truth_set(targets: &[(&str, Path)]) -> TruthSet {
    let point = |&(time_s, x_m, y_m): &(f64, f64, f64)| {
        TruthPoint::in_plane(time_s, Position::new(x_m, y_m), None)
    };
    let target = |(name, path): &(&str, Path)| Target {
        truth_id: (*name).to_owned(),
        points: path.iter().map(point).collect(),
    };
    TruthSet::new(Space::Plane, targets.iter().map(target).collect()).unwrap()
}

/// Tracks without detections from names and paths.
pub fn tracks_at(tracks: &[(&str, Path)]) -> TrackSet {
    let track = |(name, path): &(&str, Path)| Track {
        track_id: (*name).to_owned(),
        points: path
            .iter()
            .map(|&(time_s, x_m, y_m)| bare_point(time_s, x_m, y_m))
            .collect(),
    };
    TrackSet {
        tracks: tracks.iter().map(track).collect(),
        ..Default::default()
    }
}

/// One target of a report, as `A false at 3: expected a3, took c3 (clutter), track 1; errors 1`.
pub fn target(report: &TfaReport, name: &str) -> String {
    let target = report
        .targets
        .iter()
        .find(|target| target.truth_id == name)
        .unwrap();
    let verdict = word(&target.verdict);
    let Some(scan) = target.at_scan else {
        let record = (
            &target.at_time_s,
            &target.expected,
            &target.took,
            &target.took_kind,
            &target.took_truth_id,
            &target.track_id,
        );
        assert_eq!(
            record,
            (&None, &None, &None, &None, &None, &None),
            "no record without a scan"
        );
        return format!("{name} {verdict}; errors {}", target.errors);
    };
    let text = |value: &Option<String>| value.clone().unwrap_or("null".to_owned());
    let kind = word(&target.took_kind);
    let whose = target
        .took_truth_id
        .as_ref()
        .map_or(String::new(), |truth_id| format!(" {truth_id}"));
    format!(
        "{name} {verdict} at {scan}: expected {}, took {} ({kind}{whose}), track {}; errors {}",
        text(&target.expected),
        text(&target.took),
        text(&target.track_id),
        target.errors
    )
}

/// The output tracks of a report, each as `1 matched A, scans 1..4, symbols 3, errors 0`.
pub fn tracks(report: &TfaReport) -> Vec<String> {
    let line =
        |track: &trackloom_domain::evaluation::temporal_automaton::report::OutputTrackReport| {
            let class = word(&track.class);
            let (Some(start), Some(end)) = (track.start_scan, track.end_scan) else {
                return format!("{} {class}, empty", track.track_id);
            };
            let follows = track
                .follows
                .as_ref()
                .map_or(String::new(), |target| format!(" {target}"));
            let errors = track
                .errors
                .map_or(String::new(), |errors| format!(", errors {errors}"));
            format!(
                "{} {class}{follows}, scans {start}..{end}, symbols {}{errors}",
                track.track_id, track.symbols
            )
        };
    report.output_tracks.iter().map(line).collect()
}

/// Asserts the three sets and their probabilities.
pub fn assert_sets(
    report: &TfaReport,
    [correct, missed, wrong]: [usize; 3],
    probabilities: [Option<f64>; 3],
) {
    assert_eq!(
        [
            report.counts.correct,
            report.counts.missed,
            report.counts.wrong
        ],
        [correct, missed, wrong],
        "correct, missed, false"
    );
    assert_eq!(report.counts.targets, correct + missed + wrong);
    assert_eq!(report.counts.output_tracks, report.output_tracks.len());
    let found = report.probability;
    assert_eq!(
        [found.correct, found.missed, found.wrong],
        probabilities,
        "probabilities of correct, missed, false"
    );
}

/// How many targets are correct for each error budget.
pub fn tolerance(report: &TfaReport) -> Vec<usize> {
    assert!(
        report
            .tolerance
            .iter()
            .enumerate()
            .all(|(k, line)| line.k == k)
    );
    report.tolerance.iter().map(|line| line.correct).collect()
}

/// How a value is written in JSON, without quotes.
pub fn word(value: &impl serde::Serialize) -> String {
    serde_json::to_value(value)
        .unwrap()
        .as_str()
        .unwrap_or("null")
        .to_owned()
}
