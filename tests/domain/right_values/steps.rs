//! Whose times count: cases of practice with their right values, and what must hold of any scene.

use super::{judged, metrics, quantity, table};
use crate::origins::jobs::Texts;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde_json::{Value, json};
use trackloom_domain::experiment::Outcome;

const TRUTH: &str = "time_s,truth_id,x_m,y_m";
const TRACKS: &str = "time_s,track_id,x_m,y_m";

fn clear(outcome: &Outcome) -> [f64; 3] {
    ["tp", "fn", "fp"].map(|name| quantity(outcome, "clear", name))
}

#[test]
fn truth_each_ten_seconds_and_a_perfect_track_each_four() {
    let row = |(id, time): (char, u32)| format!("{time},{id},{},0", 100 * time);
    let truth = table(TRUTH, (0..=12).map(|step| row(('A', 10 * step))));
    let tracks = table(TRACKS, (0..=30).map(|step| row(('1', 4 * step))));
    let of = |steps: &str| {
        let comparison = json!({"gate_m": 100.0, "steps": steps});
        judged(
            &truth,
            &tracks,
            json!({"comparison": comparison, "metrics": [{"metric": "clear"}]}),
        )
    };
    assert_eq!(clear(&of("auto")), [13.0, 0.0, 0.0]);
    assert_eq!(of("auto").result["comparison"]["points_between_steps"], 18);
    let flattering = of("tracks");
    assert_eq!(clear(&flattering), [31.0, 0.0, 0.0]);
    super::warning(&flattering, "which flatters those that say little");
}

#[test]
fn a_false_point_in_a_frame_without_truth_hides_no_miss() {
    // TrackEval 1.3.0 on the same frames: 6, 5, 1; MOTA 5 / 11; HOTA 0.495.
    let times = [0, 1, 2, 4, 5, 6, 7, 8, 9, 10, 11];
    let truth = table(TRUTH, times.map(|time| format!("{time},A,0,0")));
    let seen = [0, 2, 4, 6, 8, 10].map(|time| format!("{time},1,1,0"));
    let patchy = table(TRACKS, seen.clone());
    let with_false = table(TRACKS, seen.into_iter().chain(["3,F,90,0".to_owned()]));
    let of = |tracks: &str| {
        let comparison =
            json!({"gate_m": 7.0, "alignment": {"method": "nearest", "max_gap_s": 0.0}});
        let metrics = ["clear", "hota", "gospa"].map(|metric| json!({"metric": metric}));
        judged(
            &truth,
            tracks,
            json!({"comparison": comparison, "metrics": metrics}),
        )
    };
    assert_eq!(clear(&of(&patchy)), [6.0, 5.0, 0.0]);
    let outcome = of(&with_false);
    assert_eq!(clear(&outcome), [6.0, 5.0, 1.0]);
    assert!((quantity(&outcome, "clear", "mota") - 5.0 / 11.0).abs() < 1e-12);
    assert!((quantity(&outcome, "hota", "hota") - 0.495).abs() < 5e-4);
    assert!(quantity(&outcome, "gospa", "gospa") > quantity(&of(&patchy), "gospa", "gospa"));
}

/// A radar that says nothing from 5 to 18 s, and what it sees otherwise.
fn silent_radar() -> (String, String) {
    let seen = (0..24_u32).filter(|time| !(5..19).contains(time));
    let detections = table(
        "time_s,scan,sensor_id,detection_id,x_m,y_m",
        seen.map(|time| format!("{time},{time},r,a{time},{},0", 10 * time)),
    );
    let truth = table(
        TRUTH,
        (0..24).map(|time| format!("{time},A,{},0", 10 * time)),
    );
    (detections, truth)
}

#[test]
fn the_same_tracks_are_judged_alike_tracked_here_or_uploaded() {
    let (detections, truth) = silent_radar();
    let mut texts = Texts::of("csv");
    let mut body = json!({
        "input": texts.dataset(&detections), "truth": texts.dataset(&truth),
        "sensors": [{"sensor_id": "r", "p_d": 0.9, "clutter_per_m2": 1e-8, "sigma_x_m": 5.0, "sigma_y_m": 5.0}],
        "associator": {"method": "global_nearest_neighbour"},
        "filter": {"method": "kalman", "process_noise_m2ps3": 1.0},
        "metrics": metrics(&["clear", "siap", "gospa", "identity", "hota", "t_gospa"]),
        "tfa": {"symbols": {"kind": "nearest_truth", "gate_m": 30.0}},
        "comparison": {"gate_m": 30.0, "credit": "afterwards"}
    });
    let here = texts.judge(&body).unwrap();
    assert_eq!(clear(&here), [10.0, 14.0, 0.0]);
    assert!((quantity(&here, "clear", "mota") - 10.0 / 24.0).abs() < 1e-12);
    assert_eq!(here.result["comparison"]["filled_steps"], 14);
    let file = here
        .artifacts
        .iter()
        .find(|file| file.name == "tracks.csv")
        .unwrap();
    let tracks = String::from_utf8(file.bytes.clone()).unwrap();
    for name in ["input", "sensors", "associator", "filter"] {
        body.as_object_mut().unwrap().remove(name);
    }
    body["tracks"] = texts.dataset(&tracks);
    let alone = texts.judge(&body).unwrap();
    body["detections"] = texts.dataset(&detections);
    let beside = texts.judge(&body).unwrap();
    for other in [&alone, &beside] {
        for metric in ["clear", "gospa", "identity", "hota", "t_gospa", "siap"] {
            let of = |outcome: &Outcome| outcome.result["metrics"][metric]["quantities"].clone();
            assert_eq!(of(&here), of(other), "{metric}");
        }
        for part in ["counts", "probability"] {
            assert_eq!(
                here.result["tfa"][part], other.result["tfa"][part],
                "{part}"
            );
        }
    }
    let as_recorded = json!({"gate_m": 30.0, "credit": "afterwards", "steps": "as_recorded"});
    body["comparison"] = as_recorded;
    assert_eq!(clear(&texts.judge(&body).unwrap()), [10.0, 0.0, 0.0]);
}

/// Points on a line of 10 m a second, from a time on, so far apart.
fn line(id: &str, from_s: f64, gap_s: f64, count: u32, y_m: f64) -> Vec<String> {
    let time_s = |step: u32| from_s + gap_s * f64::from(step);
    (0..count)
        .map(|step| format!("{},{id},{},{y_m}", time_s(step), 10.0 * time_s(step)))
        .collect()
}

#[test]
fn tracks_that_are_the_truth_miss_nothing_and_are_never_false() {
    // Two clocks that take turns; and three that are fast, of which one begins and ends between the steps asked for.
    let in_turns = [
        line("A", 0.0, 10.0, 11, 0.0),
        line("B", 5.0, 10.0, 11, 500.0),
    ]
    .concat();
    let born = [
        line("A", 0.0, 1.0, 101, 0.0),
        line("B", 11.0, 1.0, 87, 500.0),
    ]
    .concat();
    for (rows, comparison, due) in [
        (&in_turns, json!({"gate_m": 5.0}), 21.0),
        (
            &born,
            json!({"gate_m": 5.0, "steps": "every_s", "every_s": 10.0}),
            19.0,
        ),
        (
            &born,
            json!({"gate_m": 5.0, "alignment": {"method": "nearest"}}),
            188.0,
        ),
    ] {
        let (truth, tracks) = (table(TRUTH, rows.clone()), table(TRACKS, rows.clone()));
        let outcome = judged(
            &truth,
            &tracks,
            json!({"comparison": comparison, "metrics": [{"metric": "clear"}]}),
        );
        assert_eq!(clear(&outcome), [due, 0.0, 0.0], "{comparison}");
    }
}

#[test]
fn a_recording_that_ends_before_the_truth_says_so() {
    let rows = |id: &str, count: u32| {
        (0..count)
            .map(|step| format!("{},{id},{},0", 4 * step, 40 * step))
            .collect::<Vec<_>>()
    };
    let scans = (0..10).map(|step| format!("{},{step},r,d{step},{},0", 4 * step, 40 * step));
    let mut texts = Texts::of("csv");
    let body = json!({
        "truth": texts.dataset(&table(TRUTH, rows("A", 20))), "tracks": texts.dataset(&table(TRACKS, rows("1", 10))),
        "detections": texts.dataset(&table("time_s,scan,sensor_id,detection_id,x_m,y_m", scans)),
        "tfa": {"symbols": {"kind": "nearest_truth", "gate_m": 5.0}}, "metrics": [{"metric": "clear"}]
    });
    let outcome = texts.judge(&body).unwrap();
    assert_eq!(clear(&outcome), [10.0, 0.0, 0.0]);
    super::warning(&outcome, "40.0 s behind its last scan of the recording");
}

#[test]
fn tracks_that_are_rarer_than_the_truth_are_told_how_to_be_judged() {
    let truth = table(
        TRUTH,
        (0..=600).map(|tenth| format!("{},A,{tenth},0", f64::from(tenth) / 10.0)),
    );
    let tracks = table(
        TRACKS,
        (0..=24).map(|step| format!("{},1,{},0", 2.5 * f64::from(step), 25 * step)),
    );
    let of = |comparison: Value| {
        judged(
            &truth,
            &tracks,
            json!({"comparison": comparison, "metrics": [{"metric": "clear"}]}),
        )
    };
    let outcome = of(json!({"gate_m": 5.0}));
    assert_eq!(clear(&outcome), [25.0, 576.0, 0.0]);
    let told = super::warning(&outcome, "judges at the rate of the tracks");
    assert!(
        told.contains("every 2.500 s") && told.contains("0.100 s apart"),
        "{told}"
    );
    let outcome = of(json!({"gate_m": 5.0, "steps": "every_s", "every_s": 2.5}));
    assert_eq!(clear(&outcome), [25.0, 0.0, 0.0]);
    assert!(outcome.warnings.is_empty(), "{:?}", outcome.warnings);
}

#[test]
fn a_grid_needs_its_spacing_and_nothing_else_has_one() {
    let fault = |comparison: Value| {
        let mut texts = Texts::of("csv");
        let truth = texts.dataset(&table(TRUTH, ["0,A,0,0".to_owned()]));
        let tracks = texts.dataset(&table(TRACKS, ["0,1,0,0".to_owned()]));
        let faults = texts
            .judge(&json!({"truth": truth, "tracks": tracks, "comparison": comparison}))
            .unwrap_err();
        faults
            .into_iter()
            .map(|fault| (fault.pointer, fault.code))
            .collect::<Vec<_>>()
    };
    let at = |pointer: &str, code: &str| vec![(pointer.to_owned(), code.to_owned())];
    assert_eq!(
        fault(json!({"steps": "every_s"})),
        at("/comparison/every_s", "missing")
    );
    assert_eq!(
        fault(json!({"every_s": 2.0})),
        at("/comparison/every_s", "conflict")
    );
    assert_eq!(
        fault(json!({"steps": "often"})),
        at("/comparison/steps", "unknown_value")
    );
}

/// Two targets and two tracks in noise, some points absent, tracks on a clock of their own.
struct Scene {
    truth: Vec<(f64, String, f64, f64)>,
    tracks: Vec<(f64, String, f64, f64)>,
}

fn random(rng: &mut ChaCha8Rng) -> Scene {
    let mut scene = Scene {
        truth: Vec::new(),
        tracks: Vec::new(),
    };
    let (shift_s, rate_s) = (rng.random_range(0.0..1.0), rng.random_range(0.4..3.0));
    for (target, y_m) in [("A", 0.0), ("B", 300.0)] {
        for step in 0..20 {
            if rng.random_bool(0.9) {
                let time_s = f64::from(step);
                scene
                    .truth
                    .push((time_s, target.to_owned(), 10.0 * time_s, y_m));
            }
        }
        let mut time_s: f64 = shift_s;
        while time_s < 19.0 {
            let (x_m, y_m) = (
                10.0 * time_s + rng.random_range(-6.0..6.0),
                y_m + rng.random_range(-6.0..6.0),
            );
            if rng.random_bool(0.8) {
                scene.tracks.push((time_s, format!("t{target}"), x_m, y_m));
            }
            time_s += rate_s;
        }
    }
    scene
}

const METRICS: [&str; 6] = ["clear", "gospa", "ospa", "t_gospa", "hota", "identity"];
/// Of each metric the headline; higher is better of the first three.
const HEADLINES: [(&str, &str); 6] = [
    ("clear", "mota"),
    ("hota", "hota"),
    ("identity", "idf1"),
    ("gospa", "gospa"),
    ("ospa", "ospa"),
    ("t_gospa", "t_gospa"),
];

impl Scene {
    fn judge(&self) -> Vec<f64> {
        let line =
            |(time_s, id, x_m, y_m): &(f64, String, f64, f64)| format!("{time_s},{id},{x_m},{y_m}");
        let settings = json!({"comparison": {"gate_m": 20.0}, "metrics": metrics(&METRICS)});
        let (truth, tracks) = (
            table(TRUTH, self.truth.iter().map(line)),
            table(TRACKS, self.tracks.iter().map(line)),
        );
        let outcome = judged(&truth, &tracks, settings);
        let mut found: Vec<f64> = HEADLINES
            .iter()
            .map(|(metric, name)| quantity(&outcome, metric, name))
            .collect();
        found.extend(clear(&outcome));
        found.push(quantity(&outcome, "clear", "recall"));
        found
    }
}

/// Whether no score is better than before.
fn is_no_better(before: &[f64], after: &[f64]) -> bool {
    let pairs = before.iter().zip(after).take(6).enumerate();
    pairs.into_iter().all(|(place, (before, after))| {
        if place < 3 {
            *after <= before + 1e-9
        } else {
            *after >= before - 1e-9
        }
    })
}

#[test]
fn false_points_never_improve_a_score_and_silence_never_raises_recall() {
    let mut rng = ChaCha8Rng::seed_from_u64(23);
    for case in 0..300 {
        let mut scene = random(&mut rng);
        if scene.truth.is_empty() || scene.tracks.is_empty() {
            continue;
        }
        let before = scene.judge();
        let kept = scene.tracks.clone();
        let step = f64::from(rng.random_range(0..19_i32));
        scene
            .tracks
            .retain(|(time_s, ..)| (time_s - step).abs() > 0.5);
        if !scene.tracks.is_empty() {
            let (recall, after) = (before[9], scene.judge()[9]);
            assert!(
                after <= recall + 1e-12,
                "case {case}: {recall} to {after} without {step} s"
            );
        }
        scene.tracks = kept;
        for point in 0..rng.random_range(1..6) {
            let time_s = rng.random_range(-3.0..23.0);
            // Beyond the gate and the cutoff of anything, by itself.
            scene.tracks.push((
                time_s,
                format!("false{point}"),
                1e5,
                1e5 + 1e4 * f64::from(point),
            ));
        }
        let after = scene.judge();
        assert!(
            is_no_better(&before, &after),
            "case {case}: {before:?} to {after:?}"
        );
    }
}

#[test]
fn names_origins_clocks_and_orders_change_nothing() {
    let mut rng = ChaCha8Rng::seed_from_u64(24);
    for case in 0..60 {
        let scene = random(&mut rng);
        let moved = |points: &[(f64, String, f64, f64)], prefix: &str| {
            let mut points: Vec<_> = points
                .iter()
                .map(|(time_s, id, x_m, y_m)| {
                    (
                        time_s + 1000.0,
                        format!("{prefix}{id}"),
                        x_m + 500.0,
                        y_m - 250.0,
                    )
                })
                .collect();
            points.reverse();
            points.sort_by(|a, b| a.0.total_cmp(&b.0));
            points
        };
        let other = Scene {
            truth: moved(&scene.truth, "z"),
            tracks: moved(&scene.tracks, "q"),
        };
        let (before, after) = (scene.judge(), other.judge());
        for (before, after) in before.iter().zip(&after) {
            assert!(
                (before - after).abs() < 1e-6,
                "case {case}: {before} and {after}"
            );
        }
    }
}

#[test]
fn what_belongs_to_no_step_is_not_said_to_belong_to_no_scan() {
    let row = |(id, time): (char, u32)| format!("{time},{id},{},0", 10 * time);
    let truth = table(TRUTH, (0..=20).map(|time| row(('A', time))));
    let tracks = table(TRACKS, (0..=22).map(|time| row(('1', time))));
    let outcome = judged(&truth, &tracks, json!({}));
    super::warning(
        &outcome,
        "2 track point(s) belong to no step and were left out",
    );
}
