//! What the operator saw: a track that is confirmed late, or begins in the past, was not there before.

use super::{metrics, quantity, table};
use crate::origins::jobs::Texts;
use serde_json::{Value, json};
use trackloom_domain::experiment::Outcome;

/// One target that is always detected, confirmed by eight of ten.
fn judged(tracker: Value, comparison: Value) -> Outcome {
    let row = |id: &str, time: u32| format!("{time},{id},{},0", 10 * time);
    let detections = table(
        "time_s,scan,sensor_id,detection_id,x_m,y_m",
        (0..20).map(|time| format!("{time},{time},r,a{time},{},0", 10 * time)),
    );
    let truth = table(
        "time_s,truth_id,x_m,y_m",
        (0..20).map(|time| row("A", time)),
    );
    let mut texts = Texts::of("csv");
    let body = json!({
        "input": texts.dataset(&detections), "truth": texts.dataset(&truth),
        "sensors": [{"sensor_id": "r", "p_d": 0.9, "clutter_per_m2": 1e-8, "sigma_x_m": 5.0, "sigma_y_m": 5.0}],
        "associator": {"method": "global_nearest_neighbour"},
        "filter": {"method": "kalman", "process_noise_m2ps3": 1.0},
        "tracker": tracker, "comparison": comparison,
        "tfa": {"symbols": {"kind": "nearest_truth", "gate_m": 100.0}, "max_missed": 9},
        "metrics": metrics(&["clear", "assignment", "siap"])
    });
    texts.judge(&body).unwrap()
}

fn lateness(outcome: &Outcome) -> [f64; 3] {
    [
        ("clear", "fn"),
        ("assignment", "mean_establishment_length"),
        ("siap", "completeness"),
    ]
    .map(|(metric, name)| quantity(outcome, metric, name))
}

#[test]
fn a_track_that_is_confirmed_at_the_eighth_scan_is_seven_scans_late() {
    let eight = json!({"confirm_hits": 8, "confirm_window": 10});
    let outcome = judged(eight.clone(), json!({}));
    assert_eq!(lateness(&outcome), [7.0, 7.0, 13.0 / 20.0]);
    let head = &outcome.result["comparison"];
    assert_eq!(head["credit"], "at_the_time");
    assert_eq!(head["points_not_known_then"], 7);
    // The automaton expects the target at each of these scans, too.
    assert_eq!(outcome.result["tfa"]["targets"][0]["least_errors"], 7);
    let outcome = judged(eight, json!({"credit": "afterwards"}));
    assert_eq!(lateness(&outcome), [0.0, 0.0, 1.0]);
    assert_eq!(outcome.result["comparison"]["points_not_known_then"], 0);
    assert_eq!(outcome.result["tfa"]["targets"][0]["least_errors"], 0);
}

#[test]
fn the_past_of_a_beginning_over_several_scans_was_not_known_then() {
    let begun =
        json!({"initiation": {"method": "multi_scan"}, "confirm_hits": 1, "confirm_window": 1});
    let outcome = judged(begun.clone(), json!({}));
    // The window of five scans is full at the fifth.
    assert_eq!(lateness(&outcome)[..2], [4.0, 4.0]);
    assert_eq!(
        lateness(&judged(begun, json!({"credit": "afterwards"})))[..2],
        [0.0, 0.0]
    );
}
