//! Formations: where their targets start, how they move, and which sensors see them.

use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};
use std::ops::ControlFlow;
use trackloom_domain::experiment::{JobKind, plan};
use trackloom_domain::math::rng::Seed;
use trackloom_domain::model::scenario::Scenario;
use trackloom_domain::model::state::Position;
use trackloom_domain::simulation::{Simulated, simulate};

const SPACING_M: f64 = 2_500.0;

fn scenario(motion: &Value, duplicates: u32) -> Value {
    let sensor = |number: u32| {
        json!({"sensor_id": format!("S{number}"), "x_m": 0.0, "y_m": 0.0, "max_range_m": 100_000.0, "p_d": 1.0,
            "sigma_x_m": 200.0, "sigma_y_m": 200.0, "clutter_per_scan": 0.0})
    };
    json!({
        "scans": 30,
        "scan_period_s": 2.0,
        "sensors": (1..=6).map(sensor).collect::<Vec<_>>(),
        "targets": {"kind": "formation", "rows": 5, "columns": 5, "spacing_m": SPACING_M, "displacement": 0.1, "speed_mps": 250.0,
            "motion": motion},
        "coverage": {"kind": "duplicates", "count": duplicates}
    })
}

fn weaving() -> Value {
    json!({"kind": "weaving", "heading_amplitude_deg": 30.0, "period_s": 60.0})
}

fn straight() -> Value {
    json!({"kind": "constant_velocity"})
}

fn played(scenario: &Value, seed: u32) -> Simulated {
    let scenario: Scenario = serde_json::from_value(scenario.clone()).unwrap();
    simulate(&scenario, Seed { seed, run: 0 }, &mut |_| {
        ControlFlow::Continue(())
    })
    .unwrap()
    .unwrap()
}

/// Positions and velocities of a target at each scan.
fn path(simulated: &Simulated, target: usize) -> Vec<(Position, Position)> {
    let points = &simulated.truth.targets()[target].points;
    points
        .iter()
        .map(|point| (point.position.xy(), point.velocity.unwrap().xy()))
        .collect()
}

#[test]
fn duplicates_are_seen_by_all_sensors_and_the_others_by_one() {
    for duplicates in [0, 10, 15, 25] {
        let recording = played(&scenario(&straight(), duplicates), 3).recording;
        let mut instants: BTreeMap<u64, BTreeMap<u32, BTreeSet<usize>>> = BTreeMap::new();
        for scan in &recording.scans {
            let seen = instants.entry(scan.time_s as u64).or_default();
            for detection in &scan.detections {
                assert!(
                    seen.entry(detection.origin.unwrap())
                        .or_default()
                        .insert(scan.sensor),
                    "one report of a target in a scan"
                );
            }
        }
        assert_eq!(instants.len(), 30);
        let first = &instants[&0];
        let by_sensors = |count: usize| {
            first
                .values()
                .filter(|sensors| sensors.len() == count)
                .count()
        };
        assert_eq!(
            (by_sensors(6), by_sensors(1)),
            (duplicates as usize, 25 - duplicates as usize)
        );
        assert!(
            instants.values().all(|seen| seen == first),
            "who sees whom does not change with time"
        );
    }
}

#[test]
fn which_targets_are_duplicates_changes_with_the_seed_and_not_with_the_paths() {
    let duplicates = |seed| {
        let recording = played(&scenario(&straight(), 10), seed).recording;
        let counts = recording.scans[..6]
            .iter()
            .flat_map(|scan| &scan.detections)
            .fold([0; 25], |mut counts, detection| {
                counts[detection.origin.unwrap() as usize] += 1;
                counts
            });
        counts.map(|count| count == 6)
    };
    assert_ne!(duplicates(1), duplicates(2));
    let paths = |count| {
        (0..25)
            .map(|target| path(&played(&scenario(&weaving(), count), 1), target))
            .collect::<Vec<_>>()
    };
    assert_eq!(paths(10), paths(15));
}

#[test]
fn targets_start_near_their_places_in_the_grid() {
    let simulated = played(&scenario(&straight(), 10), 1);
    let mut largest: f64 = 0.0;
    for target in 0..25 {
        let place = Position::new((target % 5) as f64 - 2.0, (target / 5) as f64 - 2.0) * SPACING_M;
        let offset = path(&simulated, target)[0].0 - place;
        largest = largest.max(offset.abs().max());
    }
    assert!(
        largest <= 0.1 * SPACING_M && largest > 0.08 * SPACING_M,
        "{largest}"
    );
}

#[test]
fn a_straight_formation_flies_one_course() {
    let simulated = played(&scenario(&straight(), 10), 1);
    let velocity = path(&simulated, 0)[0].1;
    assert!((velocity.norm() - 250.0).abs() < 1e-9);
    for target in 0..25 {
        let path = path(&simulated, target);
        assert!(path.iter().all(|point| (point.1 - velocity).norm() < 1e-9));
        assert!((path[29].0 - path[0].0 - velocity * 58.0).norm() < 1e-6);
    }
}

#[test]
fn weaving_keeps_the_speed_and_comes_back_to_the_course_after_each_period() {
    let mut long = scenario(&weaving(), 10);
    long["scans"] = json!(61);
    let simulated = played(&long, 1);
    let mut headings = BTreeSet::new();
    for target in 0..25 {
        let path = path(&simulated, target);
        for pair in path.windows(2) {
            assert!(
                (pair[0].1.norm() - 250.0).abs() < 1e-9,
                "the speed is constant"
            );
            // Over 2 s the heading turns by at most 2·(π/6)·(2π/60): the chord is as long as the arc but for 0.03 %.
            assert!((500.0 - (pair[1].0 - pair[0].0).norm()).abs() < 0.3);
        }
        // A whole period is v·T·J₀(30°) along the course: J₀(π/6) = 0.932 626 6 by its power series.
        let whole = path[30].0 - path[0].0;
        assert!(
            (whole.norm() - 250.0 * 60.0 * 0.932_626_6).abs() < 0.1,
            "{}",
            whole.norm()
        );
        assert!((path[60].0 - path[30].0 - whole).norm() < 1e-6);
        let angle = |velocity: &Position| {
            (velocity.dot(&whole) / (velocity.norm() * whole.norm()))
                .acos()
                .to_degrees()
        };
        let widest = path.iter().map(|point| angle(&point.1)).fold(0.0, f64::max);
        assert!((29.5..=30.000_1).contains(&widest), "{widest}");
        headings.insert((angle(&path[0].1) * 1e6) as i64);
    }
    assert!(headings.len() > 20, "each target has a phase of its own");
}

#[test]
fn more_duplicates_than_targets_are_a_fault() {
    let faults = plan(
        JobKind::Simulate,
        &json!({"scenario": scenario(&straight(), 26)}),
    )
    .unwrap_err();
    let [fault] = faults.as_slice() else {
        panic!("{faults:?}")
    };
    assert_eq!(
        (
            fault.pointer.as_str(),
            fault.code.as_str(),
            fault.allowed.as_deref()
        ),
        ("/scenario/coverage/count", "out_of_range", Some("[0, 25]"))
    );
    let mut wild = scenario(&json!({"kind": "weaving", "period_s": 0.0}), 1);
    wild["coverage"]["kind"] = json!("none");
    let pointers: Vec<String> = plan(JobKind::Simulate, &json!({"scenario": wild}))
        .unwrap_err()
        .into_iter()
        .map(|fault| fault.pointer)
        .collect();
    assert_eq!(
        pointers,
        [
            "/scenario/targets/motion/period_s",
            "/scenario/coverage/kind"
        ]
    );
}
