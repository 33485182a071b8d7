//! Groupers on instants made by hand, and what holds for all of them.

use super::*;
use crate::registry::check;
use proptest::prelude::*;
use serde_json::{Value, json};

const SIGMA_M: f64 = 10.0;

fn place(x_m: f64, y_m: f64) -> Place {
    Place {
        position_m: Position::new(x_m, y_m),
        covariance: PositionCovariance::identity() * (SIGMA_M * SIGMA_M),
    }
}

/// Reports as (sensor, x, y).
fn reports(list: &[(u32, f64, f64)]) -> Vec<SensorReport> {
    list.iter()
        .map(|&(sensor, x_m, y_m)| SensorReport {
            place: place(x_m, y_m),
            sensor,
        })
        .collect()
}

fn grouper(method: &str, parameters: &Value) -> Box<dyn Grouper> {
    let entry = GROUPERS.iter().find(|entry| entry.name == method).unwrap();
    (entry.build)(
        &check(parameters, entry.parameters).unwrap(),
        Seed { seed: 1, run: 0 },
    )
    .unwrap()
}

fn groups(
    method: &str,
    parameters: Value,
    list: &[(u32, f64, f64)],
    predictions: &[Place],
) -> Vec<usize> {
    let reports = reports(list);
    grouper(method, &parameters)
        .group(&Snapshot {
            number: 0,
            reports: &reports,
            predictions,
            described: None,
        })
        .unwrap()
        .group_of
}

/// Two targets 200 m apart, each seen by three sensors.
const TWO: [(u32, f64, f64); 6] = [
    (0, 0.0, 5.0),
    (0, 200.0, 0.0),
    (1, 205.0, 3.0),
    (1, -4.0, 0.0),
    (2, 8.0, 1.0),
    (2, 190.0, 0.0),
];

fn variants() -> Vec<(&'static str, Value)> {
    let two = json!({"by": "count", "count": 2});
    vec![
        ("nearest_neighbour", json!({"gate_sigmas": 3.0})),
        ("nearest_neighbour", json!({"one_per_sensor": true})),
        ("sequential_nearest_neighbour", json!({})),
        (
            "sequential_nearest_neighbour",
            json!({"one_per_sensor": true}),
        ),
        ("fuzzy_c_means", json!({})),
        (
            "fuzzy_c_means",
            json!({"one_per_sensor": true, "fuzzifier": 1.5}),
        ),
        (
            "fuzzy_c_means",
            json!({"initial": {"from": "sensor", "clusters": two}}),
        ),
        (
            "fuzzy_c_means",
            json!({"initial": {"from": "memberships", "clusters": two}}),
        ),
        (
            "fuzzy_c_means",
            json!({"initial": {"from": "genetic", "clusters": two, "population": 4, "generations": 2}}),
        ),
        (
            "fuzzy_c_means",
            json!({"initial": {"from": "sensor", "clusters": {"by": "validity", "max": 3}}}),
        ),
        ("constrained_hard_c_means", json!({})),
    ]
}

#[test]
fn every_grouper_tells_two_targets_apart() {
    for (method, parameters) in variants() {
        let found = groups(
            method,
            parameters.clone(),
            &TWO,
            &[place(10.0, 0.0), place(195.0, 0.0)],
        );
        let expected = [0, 1, 1, 0, 0, 1].map(|target| found[target]);
        assert_eq!(found, expected, "{method} {parameters}");
        assert_ne!(found[0], found[1], "{method} {parameters}");
    }
}

#[test]
fn a_gate_splits_what_lies_outside_it() {
    // S = 200 on each axis: 3σ is 42.4 m.
    let list = [(0, 0.0, 42.0), (1, 0.0, 43.0), (2, 44.0, 0.0)];
    let gated = json!({"gate_sigmas": 3.0});
    assert_eq!(
        groups("nearest_neighbour", gated, &list, &[place(0.0, 0.0)]),
        [0, 1, 2]
    );
    assert_eq!(
        groups("nearest_neighbour", json!({}), &list, &[place(0.0, 0.0)]),
        [0, 0, 0]
    );
}

#[test]
fn with_one_report_per_sensor_the_closest_pair_goes_first() {
    let list = [(0, 10.0, 0.0), (0, 20.0, 0.0), (1, 20.0, 0.0)];
    let predictions = [place(0.0, 0.0), place(100.0, 0.0)];
    assert_eq!(
        groups("nearest_neighbour", json!({}), &list, &predictions),
        [0, 0, 0]
    );
    assert_eq!(
        groups(
            "nearest_neighbour",
            json!({"one_per_sensor": true}),
            &list,
            &predictions
        ),
        [0, 1, 0]
    );
    let gated = json!({"one_per_sensor": true, "gate_sigmas": 3.0});
    assert_eq!(
        groups("nearest_neighbour", gated, &list, &predictions),
        [0, 2, 0],
        "the loser founds a group"
    );
}

#[test]
fn the_optimal_assignment_differs_from_the_closest_pair() {
    // Closest first: 1 → 1 (4 m), 0 → 0 (60 m); least sum of squares 0 → 1, 1 → 0: 30² + 26² < 60² + 4².
    let list = [(0, 60.0, 0.0), (0, 26.0, 0.0)];
    let predictions = [place(0.0, 0.0), place(30.0, 0.0)];
    assert_eq!(
        groups(
            "nearest_neighbour",
            json!({"one_per_sensor": true}),
            &list,
            &predictions
        ),
        [0, 1]
    );
    assert_eq!(
        groups("constrained_hard_c_means", json!({}), &list, &predictions),
        [1, 0]
    );
}

#[test]
fn equal_distances_go_to_the_first() {
    let predictions = [place(0.0, 0.0), place(20.0, 0.0)];
    assert_eq!(
        groups(
            "nearest_neighbour",
            json!({}),
            &[(0, 10.0, 0.0), (1, 10.0, 0.0)],
            &predictions
        ),
        [0, 0]
    );
    let one = json!({"one_per_sensor": true});
    assert_eq!(
        groups(
            "nearest_neighbour",
            one,
            &[(0, 10.0, 0.0), (0, 10.0, 0.0)],
            &predictions
        ),
        [0, 1]
    );
}

#[test]
fn one_sensor_alone_founds_its_groups_and_nothing_gives_nothing() {
    let list = [(3, 0.0, 0.0), (3, 1.0, 0.0)];
    assert_eq!(
        groups("sequential_nearest_neighbour", json!({}), &list, &[]),
        [0, 1]
    );
    for (method, parameters) in [
        ("nearest_neighbour", json!({})),
        ("sequential_nearest_neighbour", json!({})),
        ("constrained_hard_c_means", json!({})),
    ] {
        assert_eq!(groups(method, parameters, &[], &[]), [0; 0], "{method}");
    }
}

#[test]
fn a_later_sensor_joins_the_mean_of_those_before() {
    // After 0 and 20 the centre is 10 with variance 50; S = 150: 4σ is 49 m.
    let list = [
        (0, 0.0, 0.0),
        (1, 20.0, 0.0),
        (2, 58.0, 0.0),
        (3, 90.0, 0.0),
    ];
    assert_eq!(
        groups("sequential_nearest_neighbour", json!({}), &list, &[]),
        [0, 0, 0, 1]
    );
}

#[test]
fn a_number_of_clusters_beyond_the_reports_is_named() {
    let reports = reports(&TWO);
    let parameters =
        json!({"initial": {"from": "random", "clusters": {"by": "count", "count": 7}}});
    let faults = grouper("fuzzy_c_means", &parameters)
        .group(&Snapshot {
            number: 0,
            reports: &reports,
            predictions: &[],
            described: None,
        })
        .unwrap_err();
    let fault = &faults[0];
    assert_eq!(
        (fault.pointer.as_str(), fault.code.as_str()),
        ("/initial/clusters", "out_of_range")
    );
    assert_eq!(
        fault.allowed.as_deref(),
        Some("[2, 6], the number of objects")
    );
    let parameters =
        check(&json!({"fuzzifier": 1.0}), fuzzy_c_means::METHOD.parameters).unwrap_err();
    assert_eq!(parameters[0].pointer, "/fuzzifier");
}

#[test]
fn the_history_keeps_cost_centres_and_memberships() {
    let reports = reports(&TWO);
    let mut grouper = grouper("fuzzy_c_means", &json!({"trace": true}));
    let predictions = [place(10.0, 0.0), place(195.0, 0.0)];
    let found = grouper
        .group(&Snapshot {
            number: 4,
            reports: &reports,
            predictions: &predictions,
            described: None,
        })
        .unwrap();
    let history = grouper.trace().unwrap();
    assert_eq!(
        history.iterations.len() as u32,
        found.iterations.unwrap() + 1
    );
    assert!(
        history
            .iterations
            .windows(2)
            .all(|pair| pair[1].cost <= pair[0].cost + 1e-12)
    );
    let first = &history.iterations[0];
    assert_eq!(
        (first.snapshot, first.iteration, first.centres.as_slice()),
        (4, 0, &[10.0, 0.0, 195.0, 0.0][..])
    );
    assert_eq!(first.memberships.len(), 12);
}

proptest! {
    #[test]
    fn every_report_is_in_one_group_and_the_constraint_holds(
        list in proptest::collection::vec((0u32..4, -100.0f64..100.0, -100.0f64..100.0), 4..25),
        centres in proptest::collection::vec((-100.0f64..100.0, -100.0f64..100.0), 2..4),
    ) {
        let mut list = list;
        list.sort_by_key(|report| report.0);
        let reports = reports(&list);
        let predictions: Vec<Place> = centres.iter().map(|&(x_m, y_m)| place(x_m, y_m)).collect();
        for (method, parameters) in variants() {
            let found = grouper(method, &parameters).group(&Snapshot { number: 1, reports: &reports, predictions: &predictions, described: None }).unwrap();
            prop_assert_eq!(found.group_of.len(), reports.len());
            prop_assert_eq!(found.memberships.len(), reports.len());
            prop_assert!(found.count() >= 1 && found.count() <= reports.len());
            prop_assert!(found.memberships.iter().flatten().all(|membership| (0.0..=1.0).contains(membership)));
            if parameters["one_per_sensor"] == true || method == "constrained_hard_c_means" {
                let mut taken: Vec<(usize, u32)> = found.group_of.iter().zip(&reports).map(|(group, report)| (*group, report.sensor)).collect();
                taken.sort_unstable();
                prop_assert!(taken.windows(2).all(|pair| pair[0] != pair[1]), "{} {}", method, parameters);
            }
        }
    }
}
