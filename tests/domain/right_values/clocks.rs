//! Where a clock begins changes nothing: what is midway between two steps, or exactly as long as a limit, is decided alike at all times.

use super::{metrics, quantity, table};
use crate::origins::jobs::Texts;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde_json::{Value, json};
use trackloom_domain::experiment::Outcome;

/// In twentieths of a second, the last two of some years.
const BEGINNINGS: [i64; 7] = [0, 1, 3, 146, 20_001, 1_727_999, 34_000_000_001];

/// A time of so many twentieths of a second, as a file has it.
fn time(twentieths: i64) -> String {
    format!("{}.{:02}", twentieths / 20, twentieths % 20 * 5)
}

/// Id, twentieths of a second since the beginning, and what y is.
type Points = Vec<(String, i64, f64)>;

fn rows(header: &str, points: &Points, beginning: i64) -> String {
    let row =
        |(id, at, y_m): &(String, i64, f64)| format!("{},{id},{at},{y_m}", time(beginning + at));
    table(header, points.iter().map(row))
}

fn try_judge(
    truth: &Points,
    tracks: &Points,
    beginning: i64,
    comparison: &Value,
) -> Option<Outcome> {
    let mut texts = Texts::of("csv");
    let names = ["clear", "identity", "siap", "gospa", "assignment"];
    let body = json!({
        "truth": texts.dataset(&rows("time_s,truth_id,x_m,y_m", truth, beginning)),
        "tracks": texts.dataset(&rows("time_s,track_id,x_m,y_m", tracks, beginning)),
        "comparison": comparison, "metrics": metrics(&names)
    });
    texts.judge(&body).ok()
}

fn judge(truth: &Points, tracks: &Points, beginning: i64, comparison: &Value) -> Outcome {
    try_judge(truth, tracks, beginning, comparison).unwrap()
}

/// What must not depend on the beginning.
fn told(outcome: &Outcome) -> Vec<(String, f64)> {
    let mut told = Vec::new();
    for (metric, report) in outcome.result["metrics"].as_object().unwrap() {
        for (name, quantity) in report["quantities"].as_object().unwrap() {
            let value = quantity["value"].as_f64().unwrap_or(-1e9);
            told.push((format!("{metric}.{name}"), value));
        }
    }
    for part in ["/comparison", "/tfa/counts"] {
        for (name, value) in outcome.result.pointer(part).unwrap().as_object().unwrap() {
            told.extend(value.as_f64().map(|value| (name.clone(), value)));
        }
    }
    told
}

/// Times of years have digits for a quarter of a microsecond.
fn assert_alike(found: &[(String, f64)], expected: &[(String, f64)], what: &str) {
    assert_eq!(found.len(), expected.len(), "{what}");
    for ((name, found), (_, expected)) in found.iter().zip(expected) {
        let is_alike = (found - expected).abs() < 1e-3;
        assert!(is_alike, "{what}: {name} is {found}, not {expected}");
    }
}

fn path(id: &str, first: i64, gap: i64, count: i64, y_m: f64) -> Points {
    let point = |step: i64| (id.to_owned(), first + gap * step, y_m);
    (0..count).map(point).collect()
}

#[test]
fn a_point_midway_between_two_steps_is_of_the_later_one() {
    // Truth every 0.3 s, a track 0.15 s later: the first step has no point.
    let (truth, tracks) = (path("A", 0, 6, 20, 0.0), path("1", 3, 6, 20, 1.0));
    for beginning in BEGINNINGS {
        let outcome = judge(&truth, &tracks, beginning, &json!({"gate_m": 20.0}));
        let recall = quantity(&outcome, "clear", "recall");
        assert_eq!(recall, 0.95, "{}", time(beginning));
    }
}

#[test]
fn a_gap_of_exactly_the_limit_is_bridged_at_any_time() {
    let (truth, tracks) = (path("A", 0, 6, 20, 0.0), path("1", 0, 2, 58, 1.0));
    for beginning in BEGINNINGS {
        let alignment = json!({"method": "interpolate", "max_gap_s": 0.3});
        let comparison = json!({"gate_m": 20.0, "alignment": alignment, "steps": "tracks"});
        let outcome = judge(&truth, &tracks, beginning, &comparison);
        assert_eq!(
            quantity(&outcome, "clear", "tp"),
            58.0,
            "{}",
            time(beginning)
        );
    }
}

/// Paths whose clocks meet midway, with holes of whole and half periods.
fn random(rng: &mut ChaCha8Rng, id: &str) -> Points {
    let mut points = Points::new();
    for target in 0..2 {
        let gap = [2, 4, 6, 10][rng.random_range(0..4)];
        let mut at = [0, gap / 2, gap, 3][rng.random_range(0..4)];
        while at < 100 {
            points.push((format!("{id}{target}"), at, 300.0 * f64::from(target)));
            at += [gap, gap, gap, gap, gap + gap / 2, 2 * gap + gap / 2][rng.random_range(0..6)];
        }
    }
    points
}

#[test]
fn the_beginning_of_the_clock_changes_nothing() {
    let mut rng = ChaCha8Rng::seed_from_u64(25);
    let alignments = [
        json!({"method": "interpolate"}),
        json!({"method": "interpolate", "max_gap_s": 0.3}),
        json!({"method": "nearest", "max_gap_s": 0.1}),
    ];
    let mut judged_cases = 0;
    for case in 0..150 {
        let (truth, tracks) = (random(&mut rng, "T"), random(&mut rng, "k"));
        let mut comparison = json!({"gate_m": 30.0, "alignment": alignments[case % 3]});
        match case % 5 {
            0 => comparison["steps"] = json!("union"),
            1 => {
                comparison["steps"] = json!("every_s");
                comparison["every_s"] = json!(0.3);
            }
            2 => comparison["alignment"]["time_tolerance_s"] = json!(0.05),
            _ => {}
        }
        // Refused is refused at all times, too.
        let of = |beginning| {
            let outcome = try_judge(&truth, &tracks, beginning, &comparison);
            outcome.map_or(Vec::new(), |outcome| told(&outcome))
        };
        let expected = of(0);
        judged_cases += usize::from(!expected.is_empty());
        for beginning in BEGINNINGS {
            let what = format!("case {case} from {}: {comparison}", time(beginning));
            assert_alike(&of(beginning), &expected, &what);
        }
    }
    assert!(judged_cases > 120, "{judged_cases}");
}

#[test]
fn holes_of_a_recording_are_filled_alike_at_any_time() {
    let mut rng = ChaCha8Rng::seed_from_u64(26);
    for case in 0..60 {
        let (truth, tracks) = (path("A", 0, 6, 30, 0.0), random(&mut rng, "k"));
        let mut scans: Vec<(i64, &str)> = Vec::new();
        for (sensor, first) in [("r", 0), ("s", 3)] {
            let mut at = first;
            while at < 180 {
                scans.push((at, sensor));
                at += [6, 6, 6, 12, 18, 9][rng.random_range(0..6)];
            }
        }
        scans.sort_unstable();
        let judge = |beginning: i64| {
            let rows_of = scans.iter().enumerate().map(|(number, (at, sensor))| {
                format!(
                    "{},{number},{sensor},d{number},{at},0",
                    time(beginning + at)
                )
            });
            let detections = table("time_s,scan,sensor_id,detection_id,x_m,y_m", rows_of);
            let mut texts = Texts::of("csv");
            let body = json!({
                "truth": texts.dataset(&rows("time_s,truth_id,x_m,y_m", &truth, beginning)),
                "tracks": texts.dataset(&rows("time_s,track_id,x_m,y_m", &tracks, beginning)),
                "detections": texts.dataset(&detections),
                "metrics": metrics(&["clear", "siap"]), "comparison": {"gate_m": 30.0},
                "tfa": {"symbols": {"kind": "nearest_truth", "gate_m": 30.0}}
            });
            told(&texts.judge(&body).unwrap())
        };
        let expected = judge(0);
        for beginning in BEGINNINGS {
            let what = format!("case {case} from {}", time(beginning));
            assert_alike(&judge(beginning), &expected, &what);
        }
    }
}
