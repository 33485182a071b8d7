//! Every miss, break, switch and track without a target has a cause that the scene was made with.

use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use trackloom_domain::evaluation::EvaluationInput;
use trackloom_domain::evaluation::causes::{Cause, Episode, Fate, Part, explain};
use trackloom_domain::evaluation::comparison::{Comparison, PointSettings};
use trackloom_domain::evaluation::credit::Credit;
use trackloom_domain::evaluation::events::{EventKind, EventLog};
use trackloom_domain::evaluation::paths::Alignment;
use trackloom_domain::evaluation::steps::StepSettings;
use trackloom_domain::formats::{ReadOptions, format_named};
use trackloom_domain::model::dataset::Dataset;
use trackloom_domain::model::scan::Recording;
use trackloom_domain::model::sight::ViewSettings;
use trackloom_domain::model::track::TrackSet;
use trackloom_domain::model::truth::TruthSet;
use trackloom_domain::model::watch::Watch;

fn read(text: &str) -> Dataset {
    let format = format_named("csv").unwrap();
    let read = (format.read)(&mut text.as_bytes(), &ReadOptions::default());
    read.unwrap().dataset
}

fn truth(rows: &str) -> TruthSet {
    match read(&format!("time_s,truth_id,x_m,y_m\n{rows}")) {
        Dataset::Truth(truth) => truth,
        _ => panic!("not truth"),
    }
}

/// Rows of time, scan, detection, x, y, and the target that it is of; none is clutter.
fn recording(rows: &str) -> Recording {
    match read(&format!(
        "time_s,scan,sensor_id,detection_id,x_m,y_m,truth_id\n{rows}"
    )) {
        Dataset::Detections(recording) => recording,
        _ => panic!("not detections"),
    }
}

fn tracks(rows: &str) -> TrackSet {
    match read(&format!(
        "time_s,track_id,x_m,y_m,detection_id,status\n{rows}"
    )) {
        Dataset::Tracks(tracks) => tracks,
        _ => panic!("not tracks"),
    }
}

struct Told {
    comparison: Comparison,
    log: EventLog,
    episodes: Vec<Episode>,
}

fn tell(recording: Option<&Recording>, truth: &TruthSet, tracks: &TrackSet) -> Told {
    let input = EvaluationInput {
        recording,
        truth: Some(truth),
        tracks,
    };
    let settings = PointSettings {
        alignment: Alignment::Interpolate {
            max_gap_s: Some(1.0),
        },
        gate_m: 10.0,
        reach_m: 10.0,
        steps: StepSettings::default(),
        credit: Credit::AtTheTime,
    };
    let comparison = Comparison::of_points(&input, truth, &settings);
    let log = EventLog::new(&comparison);
    let episodes = explain(
        &comparison,
        &log,
        Some(&input),
        settings.credit,
        &Watch::never(),
    );
    Told {
        comparison,
        log,
        episodes,
    }
}

impl Told {
    /// `event cause from_step..to_step: sentence`.
    fn lines(&self) -> Vec<String> {
        let line = |episode: &Episode| {
            format!(
                "{} {} {}..{}: {}",
                episode.event.name(),
                episode.cause.name(),
                episode.from_step,
                episode.to_step,
                episode.sentence(&self.comparison)
            )
        };
        self.episodes.iter().map(line).collect()
    }
}

/// A stands at (0, 0) and B at (100, 0) for five scans. Track 1 leaves A at t = 2 for B, whose own track 2 ends there;
/// track 3 takes A at t = 3 and is drawn away by clutter at t = 4. A is not detected from t = 1 to 2.
#[test]
fn a_lost_target_is_explained_by_what_its_track_took() {
    let truth = truth(
        &(0..5)
            .map(|t| format!("{t},A,0,0\n{t},B,100,0\n"))
            .collect::<String>(),
    );
    let recording = recording(
        "0,1,r,a,1,0,A\n0,1,r,b,99,0,B\n1,2,r,c,99,0,B\n2,3,r,d,98,0,B\n3,4,r,e,0,1,A\n4,5,r,f,0,2,A\n4,5,r,g,50,0,\n",
    );
    let tracks = tracks(
        "0,1,0,0,a,\n1,1,5,0,,\n2,1,98,0,d,\n3,1,98,0,,\n4,1,98,0,,\n0,2,99,0,b,\n1,2,99,0,c,\n3,3,0,1,e,\n4,3,50,0,g,\n",
    );
    let told = tell(Some(&recording), &truth, &tracks);
    assert_eq!(
        told.lines(),
        [
            "miss took_target 2..2: target A is missed between two stretches, for 1 step: track 1 took 1 detection of target B.",
            "break took_target 2..2: track 1 loses target A: track 1 took 1 detection of target B.",
            "switch ended 2..2: target B goes from track 2 to track 1: track 2 ended by the rule of its tracker.",
            "switch took_target 3..3: target A goes from track 1 to track 3: track 1 took 1 detection of target B.",
            "miss took_clutter 4..4: target A is missed until its end, for 1 step: track 3 took 1 detection of no target.",
            "break took_clutter 4..4: track 3 loses target A: track 3 took 1 detection of no target.",
            "divergence took_clutter 4..4: track 3 is away from target A, which it followed, for 1 step: track 3 took 1 detection of no target.",
        ]
    );
    let breaks: Vec<&Episode> = told
        .episodes
        .iter()
        .filter(|episode| episode.event == EventKind::Break)
        .collect();
    let facts: Vec<_> = breaks
        .iter()
        .map(|one| (one.fate, one.unseen_scans, one.last_detection_time_s))
        .collect();
    assert_eq!(
        facts,
        [
            (Some(Fate::TookOtherTarget), Some(2), Some(2.0)),
            (Some(Fate::LeftGate), Some(0), Some(4.0))
        ]
    );
}

/// A is detected from the second scan on; track 1 is confirmed at the fourth, and given up when two scans do not see A.
/// Clutter stands far away, and track 2 is made of it.
#[test]
fn beginnings_and_ends_are_explained_by_what_was_seen() {
    let truth = truth(&(0..8).map(|t| format!("{t},A,0,0\n")).collect::<String>());
    let recording = recording(
        "0,1,r,n,500,0,\n1,2,r,a,0,0,A\n2,3,r,b,0,0,A\n3,4,r,c,0,0,A\n3,4,r,o,500,0,\n4,5,r,p,500,0,\n5,6,r,q,300,0,\n6,7,r,d,0,0,A\n7,8,r,e,0,0,A\n",
    );
    let tracks = tracks(
        "2,1,0,0,b,tentative\n3,1,0,0,c,confirmed\n4,1,0,0,,coasted\n3,2,500,0,o,confirmed\n4,2,500,0,p,confirmed\n5,2,500,0,,coasted\n",
    );
    let told = tell(Some(&recording), &truth, &tracks);
    assert_eq!(
        told.lines(),
        [
            "miss not_confirmed 0..2: target A is missed before any track follows it, for 3 steps: track 1 is near it and was not known at the time.",
            "false_alarm took_clutter 3..5: track 2 follows no target for 3 steps: track 2 took 2 detections of no target.",
            "miss no_detection 5..7: target A is missed until its end, for 3 steps: track 1 was lost after 2 scans without a detection within the gate.",
            "break no_detection 5..5: track 1 loses target A: track 1 was lost after 2 scans without a detection within the gate.",
        ]
    );
    let miss = &told.episodes[0];
    let seen = miss.seen.unwrap();
    assert_eq!(
        (seen.seen, seen.scans),
        (2, 3),
        "of the scans at 0, 1 and 2 s"
    );
    assert_eq!(miss.part, Some(Part::Beginning));
}

/// B is never detected, C always and never tracked, D is outside the field of view; track 9 is beside A's, track 8 goes on
/// when E is no more.
#[test]
fn what_nobody_follows_is_unseen_or_outside_or_without_a_track() {
    let mut rows: String = (0..4)
        .map(|t| format!("{t},A,0,0\n{t},B,200,0\n{t},C,300,0\n{t},D,900,0\n"))
        .collect();
    rows += "0,E,400,0\n1,E,400,0\n";
    let truth = truth(&rows);
    let seen: String = (0..4)
        .map(|t| format!("{t},{},r,a{t},0,0,A\n{t},{0},r,c{t},301,0,C\n", t + 1))
        .collect();
    let mut parts = recording(&seen).into_parts();
    parts.sensors[0].field_of_view = Some(ViewSettings {
        range_to_m: Some(500.0),
        ..ViewSettings::default()
    });
    let recording = Recording::new(parts).unwrap();
    let rows: String = (0..4)
        .map(|t| format!("{t},1,0,0,a{t},\n{t},8,400,0,,\n{t},9,3,0,,\n"))
        .collect();
    let told = tell(Some(&recording), &truth, &tracks(&rows));
    assert_eq!(
        told.lines(),
        [
            "miss no_detection 0..3: target B is missed in all its life, for 4 steps: no detection is within the gate in 4 scans.",
            "miss no_track 0..3: target C is missed in all its life, for 4 steps: no track is near it, and 4 of 4 scans have a detection within the gate.",
            "miss outside_coverage 0..3: target D is missed in all its life, for 4 steps: it is outside the field of view of every sensor.",
            "redundant second_track 0..3: track 9 is beside target A for 4 steps: track 1 follows it.",
            "false_alarm target_gone 2..3: track 8 follows no target for 2 steps: target E, which it followed, is no more.",
        ]
    );
}

/// Without origins a detection is of the target within whose gate it is.
#[test]
fn without_origins_places_say_whose_a_detection_is() {
    let truth = truth(
        &(0..3)
            .map(|t| format!("{t},A,0,0\n{t},B,100,0\n"))
            .collect::<String>(),
    );
    let rows = "0,1,r,a,1,0\n1,2,r,b,97,0\n2,3,r,c,50,0\n";
    let Dataset::Detections(recording) = read(&format!(
        "time_s,scan,sensor_id,detection_id,x_m,y_m\n{rows}"
    )) else {
        panic!("not detections")
    };
    for (row, cause) in [
        ("1,1,60,0,b,\n", Cause::TookTarget),
        ("1,1,60,0,,\n2,1,50,0,c,\n", Cause::NoDetection),
    ] {
        let tracks = tracks(&format!("0,1,0,0,a,\n{row}"));
        let told = tell(Some(&recording), &truth, &tracks);
        let lost = told
            .episodes
            .iter()
            .find(|episode| episode.event == EventKind::Break)
            .unwrap();
        assert_eq!(lost.cause, cause, "{row}");
    }
}

/// A stands at (0, 0, 5) and its track ends after t = 0. What is seen 50 m above it at t = 1 is something else, unless the
/// sensor says no height.
#[test]
fn in_a_volume_a_detection_above_the_target_is_not_of_it() {
    let truth = "time_s,truth_id,x_m,y_m,z_m\n0,A,0,0,5\n1,A,0,0,5\n";
    let tracks = "time_s,track_id,x_m,y_m,z_m\n0,1,0,0,5\n";
    for (height, unseen, cause) in [
        ("55", Some(1), Cause::NoDetection),
        ("6", Some(0), Cause::Ended),
        ("", Some(0), Cause::Ended),
    ] {
        let seen = format!(
            "time_s,scan,sensor_id,detection_id,x_m,y_m,z_m\n0,1,r,a,0,0,5\n1,2,r,b,0,0,{height}\n"
        );
        let (Dataset::Truth(truth), Dataset::Tracks(tracks), Dataset::Detections(recording)) =
            (read(truth), read(tracks), read(&seen))
        else {
            panic!("other kinds")
        };
        let told = tell(Some(&recording), &truth, &tracks);
        let breaks: Vec<&Episode> = told
            .episodes
            .iter()
            .filter(|episode| episode.event == EventKind::Break)
            .collect();
        assert_eq!(breaks.len(), 1);
        assert_eq!(breaks[0].unseen_scans, unseen, "height {height}");
        assert_eq!(breaks[0].cause, cause, "height {height}");
    }
}

/// A scene of up to four targets and five tracks that come, go, jump and are silent.
fn random_scene(seed: u64) -> (TruthSet, Recording, TrackSet) {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let (mut truth_rows, mut seen, mut track_rows) = Default::default();
    let (targets, heads) = (rng.random_range(1..5), rng.random_range(0..6));
    let add = |rows: &mut String, row: String| rows.push_str(&row);
    for t in 0..12 {
        for target in 0..targets {
            if rng.random_bool(0.9) || t == 0 {
                add(&mut truth_rows, format!("{t},{target},{},0\n", 30 * target));
            }
            if rng.random_bool(0.6) {
                let x_m = 30.0 * f64::from(target) + rng.random_range(-3.0..3.0);
                add(
                    &mut seen,
                    format!("{t},{},r,d{target},{x_m},0,{target}\n", t + 1),
                );
            }
        }
        let x_m = rng.random_range(-50.0..200.0);
        add(&mut seen, format!("{t},{},r,c,{x_m},0,\n", t + 1));
        for head in 0..heads {
            if rng.random_bool(0.7) {
                let place = 30.0 * f64::from(rng.random_range(0..5)) + rng.random_range(-9.0..9.0);
                let took = ["", "c", "d0", "d1"][rng.random_range(0..4)];
                let status = ["tentative", "confirmed"][usize::from(rng.random_bool(0.7))];
                add(
                    &mut track_rows,
                    format!("{t},{head},{place},0,{took},{status}\n"),
                );
            }
        }
    }
    (truth(&truth_rows), recording(&seen), tracks(&track_rows))
}

/// Each event of the log, counted by kind and by target or track, is in exactly one episode.
#[test]
fn the_steps_of_the_episodes_add_up_to_the_events() {
    let mut seen_causes = [0; Cause::ALL.len()];
    for seed in 0..400 {
        let (truth, recording, tracks) = random_scene(seed);
        for recording in [Some(&recording), None] {
            let told = tell(recording, &truth, &tracks);
            for (kind, name) in EventKind::ALL {
                if matches!(kind, EventKind::Match | EventKind::Reacquisition) {
                    continue;
                }
                let of_kind = told.episodes.iter().filter(|one| one.event == kind);
                let steps: u32 = of_kind.map(|one| one.steps).sum();
                assert_eq!(steps as usize, told.log.count(kind), "{name}, scene {seed}");
            }
            for one in &told.episodes {
                assert!(one.from_step <= one.to_step && one.steps > 0);
                seen_causes[one.cause as usize] += 1;
                let sentence = one.sentence(&told.comparison);
                assert!(
                    sentence.ends_with('.') && !sentence.contains("no track loses"),
                    "{sentence}"
                );
            }
        }
    }
    for (cause, name) in Cause::ALL {
        // No sensor of these scenes says where it looks.
        let is_possible = cause != Cause::OutsideCoverage;
        assert_eq!(seen_causes[cause as usize] > 0, is_possible, "{name}");
    }
}
