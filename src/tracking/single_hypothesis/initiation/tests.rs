//! Pairs of points worked by hand, and who may be one.

use super::*;
use crate::model::state::{Covariance, State};

const RULE: PairRule = PairRule {
    max_speed_mps: 10.0,
    max_wait_scans: 1,
    gate_threshold: 9.0,
    by_origin: false,
};

/// A point with R = [xx, xy; xy, yy] that knows nothing of its speed.
fn point(time_s: f64, [x, y]: [f64; 2], [xx, xy, yy]: [f64; 3]) -> Point<4> {
    let mut covariance = Covariance::from_diagonal_element(1e4);
    (
        covariance[(0, 0)],
        covariance[(0, 1)],
        covariance[(1, 0)],
        covariance[(1, 1)],
    ) = (xx, xy, xy, yy);
    let state = GaussianState {
        mean: State::new(x, y, 0.0, 0.0),
        covariance,
    };
    Point {
        after_s: 0.0,
        scan_index: time_s as u32,
        time_s,
        sensor: 0,
        detection: x as u32,
        origin: None,
        state,
    }
}

fn exact(time_s: f64, place: [f64; 2]) -> Point<4> {
    point(time_s, place, [1e-9, 0.0, 1e-9])
}

fn end_scan(initiator: &mut Initiator<4>, sensor: usize, rule: &PairRule) {
    let scan = Scan {
        number: 1,
        time_s: 0.0,
        sensor,
        pose: None,
        own: Vec::new(),
        detections: Vec::new(),
    };
    initiator.pair(&scan, rule, &Watch::never()).unwrap();
}

/// The x of the two points of each pair, of one sensor seen at 0 s and at 1 s.
fn paired(rule: &PairRule, first: &[Point<4>], second: &[Point<4>]) -> Vec<(f64, f64)> {
    let mut initiator = Initiator::default();
    for points in [first, second] {
        points.iter().for_each(|point| initiator.push(*point));
        end_scan(&mut initiator, 0, rule);
    }
    initiator
        .pairs()
        .iter()
        .map(|pair| (pair.first.state.mean[0], pair.second.state.mean[0]))
        .collect()
}

#[test]
fn two_points_are_the_state_worked_by_hand() {
    // T = 2; R₁ = [4 1; 1 9], R₂ = [8 2; 2 7]. Δ = (6, −4): v = (3, −2).
    // R₂ / T = [4 1; 1 3.5]; (R₁ + R₂) / T² = [3 0.75; 0.75 4].
    let state = difference(
        &point(1.0, [10.0, 20.0], [4.0, 1.0, 9.0]),
        &point(3.0, [16.0, 16.0], [8.0, 2.0, 7.0]),
    );
    let covariance = Covariance::new(
        8.0, 2.0, 4.0, 1.0, 2.0, 7.0, 1.0, 3.5, 4.0, 1.0, 3.0, 0.75, 1.0, 3.5, 0.75, 4.0,
    );
    assert!((state.mean - State::new(16.0, 16.0, 3.0, -2.0)).norm() < 1e-12);
    assert!(
        (state.covariance - covariance).abs().max() < 1e-12,
        "{}",
        state.covariance
    );
}

#[test]
fn the_reach_is_the_highest_speed_and_some_noise() {
    assert_eq!(
        paired(
            &RULE,
            &[exact(0.0, [0.0, 0.0])],
            &[exact(1.0, [9.999, 0.0])]
        )
        .len(),
        1
    );
    assert_eq!(
        paired(
            &RULE,
            &[exact(0.0, [0.0, 0.0])],
            &[exact(1.0, [10.01, 0.0])]
        )
        .len(),
        0
    );
    // σ² of x = 3 + 1 = 4, γ = 9: three times 2 m more, and along y nothing more.
    let noisy = |time_s, place, xx| point(time_s, place, [xx, 0.0, 1e-9]);
    assert_eq!(
        paired(
            &RULE,
            &[noisy(0.0, [0.0, 0.0], 3.0)],
            &[noisy(1.0, [15.99, 0.0], 1.0)]
        )
        .len(),
        1
    );
    assert_eq!(
        paired(
            &RULE,
            &[noisy(0.0, [0.0, 0.0], 3.0)],
            &[noisy(1.0, [16.01, 0.0], 1.0)]
        )
        .len(),
        0
    );
    assert_eq!(
        paired(
            &RULE,
            &[noisy(0.0, [0.0, 0.0], 3.0)],
            &[noisy(1.0, [0.0, 10.01], 1.0)]
        )
        .len(),
        0
    );
}

#[test]
fn all_pairs_compete_at_once() {
    // Firsts at 0 and 4, seconds at 3 and −5: the closest pair, (4, 3), would leave (0, −5): 1 + 25. The other way is
    // (0, 3) and (4, −5): 9 + 81. With seconds at 3 and 12, (4, 12) and (0, 3) cost 64 + 9, (4, 3) alone 1 + 100.
    let firsts = [exact(0.0, [0.0, 0.0]), exact(0.0, [4.0, 0.0])];
    assert_eq!(
        paired(
            &RULE,
            &firsts,
            &[exact(1.0, [3.0, 0.0]), exact(1.0, [-5.0, 0.0])]
        ),
        [(0.0, -5.0), (4.0, 3.0)]
    );
    assert_eq!(
        paired(
            &RULE,
            &firsts,
            &[exact(1.0, [3.0, 0.0]), exact(1.0, [12.0, 0.0])]
        ),
        [(0.0, 3.0), (4.0, 12.0)]
    );
}

#[test]
fn a_point_waits_for_one_scan_of_its_own_sensor() {
    let mut initiator = Initiator::default();
    let mut scan = |sensor: usize, points: &[Point<4>]| {
        points.iter().for_each(|point| initiator.push(*point));
        end_scan(&mut initiator, sensor, &RULE);
        initiator.pairs().len()
    };
    assert_eq!(scan(0, &[exact(0.0, [0.0, 0.0])]), 0);
    assert_eq!(
        scan(1, &[exact(0.0, [0.0, 0.0])]),
        0,
        "another sensor's point is not a second one"
    );
    assert_eq!(
        scan(0, &[exact(1.0, [1.0, 0.0]), exact(1.0, [50.0, 0.0])]),
        1
    );
    assert_eq!(
        scan(0, &[exact(2.0, [2.0, 0.0])]),
        0,
        "what became a track is no first point any more"
    );
    assert_eq!(
        scan(0, &[exact(3.0, [51.0, 0.0])]),
        0,
        "and what stayed alone for a scan is forgotten"
    );
    assert_eq!(
        scan(1, &[exact(3.0, [20.0, 0.0])]),
        1,
        "successive scans of one sensor may be far apart"
    );
}

#[test]
fn a_point_waits_as_long_as_it_is_allowed_to() {
    // Seen at 0 s and missed at 1, 2, … s: paired at 2 s with two scans to wait, at 3 s only with three.
    let paired_at = |max_wait_scans: u32, seen_again_s: u32| {
        let (mut initiator, rule) = (
            Initiator::default(),
            PairRule {
                max_wait_scans,
                ..RULE
            },
        );
        initiator.push(exact(0.0, [0.0, 0.0]));
        end_scan(&mut initiator, 0, &rule);
        for time_s in 1..=seen_again_s {
            if time_s == seen_again_s {
                initiator.push(exact(f64::from(time_s), [9.0 * f64::from(time_s), 0.0]));
            }
            end_scan(&mut initiator, 0, &rule);
        }
        initiator
            .pairs()
            .iter()
            .map(|pair| (pair.missed, pair.state.mean[2]))
            .collect::<Vec<_>>()
    };
    assert_eq!([paired_at(1, 1), paired_at(1, 2)], [vec![(0, 9.0)], vec![]]);
    assert_eq!([paired_at(2, 2), paired_at(2, 3)], [vec![(1, 9.0)], vec![]]);
    assert_eq!([paired_at(3, 3), paired_at(3, 4)], [vec![(2, 9.0)], vec![]]);
    // With clutter in between that is out of reach, too; and who found a partner waits no longer.
    let (mut initiator, rule) = (
        Initiator::default(),
        PairRule {
            max_wait_scans: 2,
            ..RULE
        },
    );
    let mut scan = |time_s: f64, places: &[f64]| {
        places
            .iter()
            .for_each(|&x| initiator.push(exact(time_s, [x, 0.0])));
        end_scan(&mut initiator, 0, &rule);
        initiator
            .pairs()
            .iter()
            .map(|pair| (pair.first.state.mean[0], pair.second.state.mean[0]))
            .collect::<Vec<_>>()
    };
    assert_eq!(scan(0.0, &[0.0]), []);
    assert_eq!(scan(1.0, &[100.0]), []);
    assert_eq!(scan(2.0, &[18.0, 119.0]), [(0.0, 18.0)]);
    assert_eq!(
        scan(3.0, &[5.0, 118.0]),
        [(119.0, 118.0)],
        "1 + 20² (100 alone) is less than 18² + 10² (119 alone)"
    );
}

#[test]
fn the_oracle_pairs_points_of_one_target() {
    let of = |origin, point: Point<4>| Point { origin, ..point };
    let first = [of(Some(7), exact(0.0, [0.0, 0.0])), exact(0.0, [3.0, 0.0])];
    let second = [
        of(Some(8), exact(1.0, [1.0, 0.0])),
        of(Some(7), exact(1.0, [5.0, 0.0])),
        exact(1.0, [3.5, 0.0]),
    ];
    assert_eq!(
        paired(
            &PairRule {
                by_origin: true,
                ..RULE
            },
            &first,
            &second
        ),
        [(0.0, 5.0)]
    );
}
