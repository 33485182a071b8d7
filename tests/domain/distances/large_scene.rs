//! A scene of 100 targets over 1000 steps, for what a large scene must not change: every number is there, and exact.

use super::fixture::{Row, Scene, assert_close};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde_json::json;

/// Targets on straight lines over a field of 20 km, tracked with errors of 10 m; each track breaks now and then.
fn large(targets: usize, steps: usize) -> Scene {
    let mut rng = ChaCha8Rng::seed_from_u64(17);
    let names: Vec<String> = (0..20 * targets).map(|name| format!("{name:05}")).collect();
    let (mut truth, mut tracks): (Vec<Row>, Vec<Row>) = Default::default();
    for target in 0..targets {
        let (x, y) = (
            rng.random_range(0.0..20_000.0),
            rng.random_range(0.0..20_000.0),
        );
        let (vx, vy) = (rng.random_range(-20.0..20.0), rng.random_range(-20.0..20.0));
        let mut life = 0;
        for step in 0..steps {
            let time_s = step as f64;
            let (x, y) = (x + vx * time_s, y + vy * time_s);
            truth.push((time_s, &names[target], x, y, vx, vy));
            life = (life + usize::from(rng.random_bool(0.005))).min(19);
            if rng.random_bool(0.95) {
                let mut error = || rng.random_range(-15.0..15.0);
                tracks.push((
                    time_s,
                    &names[20 * target + life],
                    x + error(),
                    y + error(),
                    vx,
                    vy,
                ));
            }
        }
    }
    Scene::new(&truth, &tracks)
}

#[test]
fn a_hundred_targets_over_a_thousand_steps() {
    let scene = large(100, 1000);
    for name in ["ospa", "gospa", "siap", "kinematics", "t_gospa"] {
        let report = scene.evaluate(100.0, json!({"metric": name}));
        assert!(report.value.is_some(), "{name}: {:?}", report.reason);
    }
    let gospa = scene.evaluate(100.0, json!({"metric": "gospa"}));
    let absent = 100_000.0
        - scene
            .tracks
            .tracks
            .iter()
            .map(|track| track.points.len() as f64)
            .sum::<f64>();
    assert_close(
        gospa.quantity("missed"),
        absent,
        "GOSPA matches every track point",
    );
    let whole = scene.evaluate(100.0, json!({"metric": "t_gospa"}));
    assert_eq!(whole.parameters["method"], "dynamic programming: exact");
    let parts =
        ["localisation", "missed", "false", "switching"].map(|name| whole.quantity(name).unwrap());
    assert_close(
        whole.value,
        parts.iter().sum::<f64>().sqrt(),
        "the parts add up",
    );
    let switches: usize = scene
        .truth
        .targets()
        .iter()
        .map(|target| tracks_of(&scene, &target.truth_id) - 1)
        .sum();
    assert_close(
        whole.quantity("switches"),
        switches as f64,
        "one switch for every break, none for a missing point",
    );
}

/// How many tracks were made for a target: their names follow its own.
fn tracks_of(scene: &Scene, truth_id: &str) -> usize {
    let first: usize = truth_id.parse().unwrap();
    let is_its = |name: &str| name.parse::<usize>().unwrap() / 20 == first;
    scene
        .tracks
        .tracks
        .iter()
        .filter(|track| is_its(&track.track_id))
        .count()
}
