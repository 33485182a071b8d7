//! Targets that meet: their spread at the meeting and away from it, against the variances of the walk.

use serde_json::{Value, json};
use std::ops::ControlFlow;
use trackloom_domain::math::rng::Seed;
use trackloom_domain::model::scenario::Scenario;
use trackloom_domain::model::truth::TruthSet;
use trackloom_domain::simulation::simulate;

fn scenario(more: &Value) -> Scenario {
    let mut targets = json!({
        "kind": "meeting", "count": 400, "leaving": 100, "meeting_s": 19.0, "x_m": 50.0, "y_m": -30.0, "sigma_m": 2.0,
        "speed_sigma_mps": 0.5, "process_noise_m2ps3": 0.02
    });
    for (name, value) in more.as_object().unwrap() {
        targets[name] = value.clone();
    }
    let scenario = json!({
        "scans": 31, "scan_period_s": 2.0,
        "sensors": [{
            "sensor_id": "radar", "x_m": 0.0, "y_m": 0.0, "max_range_m": 1000.0, "p_d": 1.0, "sigma_x_m": 1.0, "sigma_y_m": 1.0
        }],
        "targets": targets
    });
    serde_json::from_value(scenario).unwrap()
}

fn truth(more: &Value) -> TruthSet {
    let seed = Seed { seed: 3, run: 0 };
    let simulated = simulate(&scenario(more), seed, &mut |_| ControlFlow::Continue(()));
    simulated.unwrap().unwrap().truth
}

/// Mean and variance of the coordinates at a time, about the place of the meeting, and of how many targets.
fn spread(truth: &TruthSet, time_s: f64) -> (f64, f64, usize) {
    let mut offsets = Vec::new();
    for target in truth.targets() {
        let here = target.points.iter().filter(|point| point.time_s == time_s);
        for point in here {
            offsets.extend([point.position.x - 50.0, point.position.y + 30.0]);
        }
    }
    let count = offsets.len() as f64;
    let mean = offsets.iter().sum::<f64>() / count;
    let squares: f64 = offsets.iter().map(|offset| (offset - mean).powi(2)).sum();
    (mean, squares / (count - 1.0), offsets.len() / 2)
}

/// The meeting is at 20 s, the first scan at or after 19 s. |t| away from it the variance is σ² + t² σ_v² + q |t|³ / 3.
#[test]
fn targets_are_near_each_other_at_the_meeting_and_wander_before_and_after() {
    let truth = truth(&json!({}));
    for (time_s, away_s, targets) in [
        (0.0, 20.0, 400),
        (18.0, 2.0, 400),
        (20.0, 0.0, 300),
        (60.0, 40.0f64, 300),
    ] {
        let variance = 4.0 + 0.25 * away_s.powi(2) + 0.02 * away_s.powi(3) / 3.0;
        let (mean, found, count) = spread(&truth, time_s);
        assert_eq!(count, targets, "at {time_s} s");
        // Four standard errors, of 2 N coordinates.
        let values = 2.0 * targets as f64;
        assert!(
            mean.abs() < 4.0 * (variance / values).sqrt(),
            "{mean} at {time_s} s"
        );
        let error = 4.0 * variance * (2.0 / values).sqrt();
        assert!(
            (found - variance).abs() < error,
            "{found} is not {variance} at {time_s} s"
        );
    }
}

#[test]
fn without_noise_targets_go_straight_through_the_meeting() {
    let truth = truth(&json!({"count": 5, "leaving": 0, "process_noise_m2ps3": 0.0}));
    for target in truth.targets() {
        let first = target.points[0].position;
        let last = target.points[30].position;
        for (scan, point) in target.points.iter().enumerate() {
            let wanted = first + (last - first) * (scan as f64 / 30.0);
            assert!((point.position - wanted).norm() < 1e-9);
        }
    }
}

#[test]
fn a_meeting_after_the_last_scan_is_at_the_last() {
    let truth = truth(&json!({"count": 200, "leaving": 0, "meeting_s": 1e6}));
    let (_, variance, _) = spread(&truth, 60.0);
    assert!((3.0..5.0).contains(&variance), "{variance}");
}
