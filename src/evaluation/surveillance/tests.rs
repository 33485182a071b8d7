//! Worked examples of periods, gaps, references and components, by hand.

use super::gaps::{Count, GapRule, Period, covers, periods};
use super::numbers::{Handover, Life, handovers};
use super::reference::{Phase, doings, reference_at};
use crate::model::space::{Place, Space};
use crate::model::state::Position;
use crate::model::truth::{Target, TruthPoint, TruthSet};

fn rule(update_interval_s: f64, tolerance_s: f64) -> GapRule {
    GapRule {
        update_interval_s,
        tolerance_s,
        min_gap_s: None,
        max_gap_s: None,
        count: Count::Gaps,
    }
}

/// Expected and missed.
fn counts(rule: &GapRule, periods: &[Period], times_s: &[f64]) -> (u64, u64) {
    let updates: Vec<(f64, Option<bool>)> =
        times_s.iter().map(|&time_s| (time_s, Some(true))).collect();
    let missed = rule.missed(periods, &updates);
    let misses = missed.iter().map(|(_, misses)| misses).sum();
    (rule.expected(periods), misses)
}

fn every(step_s: f64, from_s: f64, to_s: f64) -> Vec<f64> {
    let count = ((to_s - from_s) / step_s).round() as usize;
    (0..=count)
        .map(|index| from_s + step_s * index as f64)
        .collect()
}

const MINUTE: [Period; 1] = [(0.0, 60.0)];
const A: [f64; 10] = [1.0, 6.0, 11.0, 16.0, 31.0, 36.0, 41.0, 46.0, 51.0, 56.0];

#[test]
fn gaps_count_as_many_misses_as_whole_intervals() {
    let b = every(10.0, 0.0, 60.0);
    assert_eq!(counts(&rule(5.0, 0.1), &MINUTE, &A), (12, 2));
    assert_eq!(counts(&rule(5.0, 0.0), &MINUTE, &A), (12, 3));
    assert_eq!(counts(&rule(5.0, 0.1), &MINUTE, &b), (12, 6));
    assert_eq!(counts(&rule(5.0, 0.0), &MINUTE, &b), (12, 12));
    assert_eq!(counts(&rule(5.0, 0.1), &MINUTE, &[]), (12, 11));
}

#[test]
fn slots_count_each_interval_without_an_update() {
    let slots = GapRule {
        count: Count::Slots,
        ..rule(5.0, 0.0)
    };
    let c = [
        every(5.0, 0.0, 15.0),
        vec![32.0, 37.0, 42.0, 47.0, 52.0, 57.0],
    ]
    .concat();
    assert_eq!(counts(&slots, &MINUTE, &A), (12, 2));
    assert_eq!(counts(&slots, &MINUTE, &every(10.0, 0.0, 60.0)), (12, 6));
    assert_eq!(counts(&slots, &MINUTE, &c), (12, 2));
}

#[test]
fn long_gaps_count_from_the_shortest_to_the_longest() {
    let long = GapRule {
        min_gap_s: Some(16.5),
        ..rule(5.0, 0.0)
    };
    let first = every(5.0, 0.0, 15.0);
    let of = |second: &[f64]| counts(&long, &MINUTE, &[first.as_slice(), second].concat());
    assert_eq!(of(&[32.0, 37.0, 42.0, 47.0, 52.0, 57.0]), (12, 3));
    assert_eq!(of(&[31.5, 36.0, 41.0, 46.0, 51.0, 56.0]), (12, 3));
    assert_eq!(of(&[31.4, 36.0, 41.0, 46.0, 51.0, 56.0]), (12, 0));
    let classes = [(3.0, Some(5.0), 24.0, 3), (5.0, None, 26.0, 5)];
    for (least_s, max_gap_s, again_s, wanted) in classes {
        let class = GapRule {
            min_gap_s: Some(least_s),
            max_gap_s,
            ..rule(1.0, 0.1)
        };
        let times_s = [every(1.0, 0.0, 20.0), every(1.0, again_s, 60.0)].concat();
        assert_eq!(counts(&class, &MINUTE, &times_s), (60, wanted));
    }
}

#[test]
fn what_is_equal_is_no_miss() {
    let of = |tolerance_s: f64, gap_s: f64| rule(5.0, tolerance_s).misses(gap_s);
    assert_eq!([of(0.0, 5.0), of(0.1, 5.1), of(0.0, 5.001)], [0, 0, 1]);
    // 36.1 − 31 is above 5.1 by a rounding.
    assert_eq!(of(0.1, 36.1 - 31.0), 0);
    // So do times of the year 2023.
    let epoch_s = 1.7e9;
    assert_eq!(of(0.1, (epoch_s + 36.1) - (epoch_s + 31.0)), 0);
    let bounded = GapRule {
        min_gap_s: Some(6.0),
        max_gap_s: Some(12.0),
        ..rule(5.0, 0.0)
    };
    let misses = [5.9, 6.0, 12.0, 12.1].map(|gap_s| bounded.misses(gap_s));
    assert_eq!(misses, [0, 1, 2, 0]);
    // Updates at the begin and the end of a period belong to it, and two at one time are one.
    let ends = [0.0, 0.0, 5.0, 10.0, 10.0];
    assert_eq!(counts(&rule(5.0, 0.0), &[(0.0, 10.0)], &ends), (2, 0));
}

#[test]
fn an_update_that_is_outside_breaks_the_count() {
    let updates = [
        (0.0, Some(true)),
        (20.0, None),
        (40.0, Some(true)),
        (52.0, Some(true)),
    ];
    let missed = rule(5.0, 0.1).missed(&MINUTE, &updates);
    assert_eq!(missed, [((40.0, 52.0), 2), ((52.0, 60.0), 1)]);
    // A wrong one is as if it were not there.
    let wrong = [(15.0, Some(true)), (20.0, Some(false)), (35.0, Some(true))];
    let missed = rule(5.0, 0.1).missed(&[(15.0, 35.0)], &wrong);
    assert_eq!(missed, [((15.0, 35.0), 3)]);
}

#[test]
fn periods_end_where_the_truth_is_lost_or_outside() {
    let inside = |times_s: &[f64]| -> Vec<(f64, bool)> {
        times_s.iter().map(|&time_s| (time_s, true)).collect()
    };
    let lost = [every(1.0, 0.0, 20.0), every(1.0, 26.0, 60.0)].concat();
    let found = periods(inside(&lost), 5.0);
    assert_eq!(found, [(0.0, 20.0), (26.0, 60.0)]);
    let d = [
        1.0, 6.0, 11.0, 16.0, 27.0, 32.0, 37.0, 42.0, 47.0, 52.0, 57.0,
    ];
    assert_eq!(counts(&rule(5.0, 0.1), &found, &d), (10, 0));
    let lengths = [4.9, 5.0, 5.1].map(|gap_s| {
        let times_s = [
            every(1.0, 0.0, 10.0),
            every(1.0, 10.0 + gap_s, 30.0 + gap_s),
        ];
        periods(inside(&times_s.concat()), 5.0).len()
    });
    assert_eq!(lengths, [1, 1, 2]);
    let kept = [1.0, 0.999].map(|length_s| periods(inside(&[7.0, 7.0 + length_s]), 5.0).len());
    assert_eq!(kept, [1, 0]);
    let mut crossing = inside(&every(1.0, 0.0, 10.0));
    crossing[5].1 = false;
    let found = periods(crossing, 5.0);
    assert_eq!(found, [(0.0, 4.0), (6.0, 10.0)]);
    assert_eq!(
        [0.0, 4.0, 5.0, 6.0, 10.5].map(|time_s| covers(&found, time_s)),
        [true, true, false, true, false]
    );
}

fn truth(points: &[(f64, f64, f64)], velocity: Option<(f64, f64)>) -> TruthSet {
    let velocity = velocity.map(|(x, y)| Position::new(x, y));
    let point =
        |&(time_s, x_m, y_m)| TruthPoint::in_plane(time_s, Position::new(x_m, y_m), velocity);
    let target = Target {
        truth_id: "A".to_owned(),
        points: points.iter().map(point).collect(),
    };
    TruthSet::new(Space::Plane, vec![target]).unwrap()
}

#[test]
fn a_reference_needs_a_point_on_both_sides_within_reach() {
    let of = |gap_s: f64, time_s: f64| {
        let truth = truth(&[(0.0, 0.0, 0.0), (gap_s, 100.0, 0.0)], None);
        reference_at(&truth, 0, time_s, 5.0).map(|reference| reference.place.x)
    };
    assert_eq!(of(10.0, 5.0), Some(50.0));
    assert_eq!(
        of(10.0, 4.9),
        None,
        "4.9 s from one and 5.1 s from the other"
    );
    assert_eq!(of(9.8, 4.9), Some(50.0));
    assert_eq!(of(100.0, 100.0), Some(100.0));
    assert_eq!([of(10.0, -0.1), of(10.0, 10.1)], [None, None]);
}

#[test]
fn headings_go_the_shorter_way_round() {
    let turn = |degrees: f64| {
        let (sin, cos) = degrees.to_radians().sin_cos();
        Position::new(100.0 * sin, 100.0 * cos)
    };
    for (from, to, half) in [(90.0, 100.0, 95.0), (350.0, 20.0, 365.0)] {
        let point =
            |time_s, degrees| TruthPoint::in_plane(time_s, Position::zeros(), Some(turn(degrees)));
        let target = Target {
            truth_id: "A".to_owned(),
            points: vec![point(0.0, from), point(4.0, to)],
        };
        let truth = TruthSet::new(Space::Plane, vec![target]).unwrap();
        let reference = reference_at(&truth, 0, 2.0, 5.0).unwrap();
        let heading_deg = reference
            .heading_rad
            .unwrap()
            .to_degrees()
            .rem_euclid(360.0);
        assert!((heading_deg - half % 360.0).abs() < 1e-9, "{heading_deg}");
        assert!((reference.speed_mps.unwrap() - 100.0).abs() < 1e-9);
    }
    let standing = truth(&[(0.0, 0.0, 0.0), (4.0, 0.0, 0.0)], None);
    let reference = reference_at(&standing, 0, 2.0, 5.0).unwrap();
    assert_eq!(
        (reference.speed_mps, reference.heading_rad),
        (Some(0.0), None)
    );
}

#[test]
fn a_target_turns_and_climbs_by_its_path() {
    // A turn of 3 deg/s from 10 s on, a climb of 600 ft/min from 20 s on.
    let point = |time: u32| {
        let time_s = f64::from(time);
        let heading_rad = (3.0 * (time_s - 10.0).max(0.0)).to_radians();
        let velocity = Place::new(heading_rad.sin(), heading_rad.cos(), 0.0) * 100.0;
        TruthPoint {
            time_s,
            position: Place::zeros(),
            velocity: Some(velocity),
            height_m: Some(1000.0 + 3.048 * (time_s - 20.0).max(0.0)),
        }
    };
    let target = Target {
        truth_id: "A".to_owned(),
        points: (0..30).map(point).collect(),
    };
    let doings = doings(Space::Plane, &target);
    let of = |point: usize| {
        [Phase::Steady, Phase::Turning, Phase::Climbing].map(|phase| phase.holds(doings[point]))
    };
    assert_eq!(of(5), [true, false, false]);
    assert_eq!(of(15), [false, true, false]);
    assert_eq!(of(25), [false, true, true]);
}

#[test]
fn a_number_carries_a_target_until_its_life_ends() {
    let life = |track, from_s, to_s| Life {
        track,
        from_s,
        to_s,
        updates: 10,
    };
    let lives = [
        life(0, 0.0, 60.0),
        life(1, 10.0, 50.0),
        life(2, 30.0, 90.0),
        life(2, 500.0, 600.0),
        life(3, 650.0, 700.0),
    ];
    let of = |time_s, from, to| Handover { time_s, from, to };
    let wanted = [of(60.0, 0, 2), of(650.0, 2, 3)];
    assert_eq!(handovers(&lives), wanted);
    assert_eq!(handovers(&[]), []);
}
