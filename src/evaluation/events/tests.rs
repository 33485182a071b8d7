//! Scenes worked by hand: every event in its order.

use super::super::tests::{GONE, Places, compare};
use super::*;

/// The events as text: `step kind truth track distance`, `-` for nothing.
fn told(truths: &[Places], tracks: &[Places]) -> Vec<String> {
    let comparison = compare(truths, tracks, 10.0);
    let log = EventLog::new(&comparison);
    let tell = |event: &Event| {
        let truth = event
            .truth
            .map_or("-", |truth| &comparison.truth_ids[truth as usize]);
        let track = event
            .track
            .map_or("-", |track| &comparison.track_ids[track as usize]);
        let distance = event
            .distance
            .map_or("-".to_owned(), |distance| distance.to_string());
        format!(
            "{} {} {truth} {track} {distance}",
            event.step,
            event.kind.name()
        )
    };
    log.events.iter().map(tell).collect()
}

#[test]
fn a_pair_is_kept_while_it_is_inside_the_gate() {
    // From step 1 on the other track is nearer, but the pairs stay; at step 2 T1 is 12 from A, so both change.
    let found = told(
        &[("A", &[0.0, 0.0, 0.0]), ("B", &[9.0, 8.0, 12.0])],
        &[("T1", &[0.0, 7.0, 12.0]), ("T2", &[9.0, 1.0, 0.0])],
    );
    let expected = [
        "0 match A T1 0",
        "0 match B T2 0",
        "1 match A T1 7",
        "1 match B T2 7",
        "2 match A T2 0",
        "2 switch A T2 0",
        "2 match B T1 0",
        "2 switch B T1 0",
    ];
    assert_eq!(found, expected);
}

#[test]
fn a_distance_equal_to_the_gate_is_a_match() {
    assert_eq!(
        told(&[("A", &[0.0, 0.0])], &[("T", &[10.0, 10.5])]),
        [
            "0 match A T 10",
            "1 miss A - -",
            "1 break A T -",
            "1 divergence A T 10.5"
        ]
    );
}

#[test]
fn a_break_ends_with_a_reacquisition_by_whichever_track() {
    let truth: Places = ("A", &[0.0, 0.0, 0.0, 0.0, 0.0]);
    let found = told(
        &[truth],
        &[
            ("T1", &[1.0, GONE, 2.0, GONE, GONE]),
            ("T2", &[GONE, GONE, GONE, GONE, 3.0]),
        ],
    );
    let expected = [
        "0 match A T1 1",
        "1 miss A - -",
        "1 break A T1 -",
        "2 match A T1 2",
        "2 reacquisition A T1 2",
        "3 miss A - -",
        "3 break A T1 -",
        "4 match A T2 3",
        "4 switch A T2 3",
        "4 reacquisition A T2 3",
    ];
    assert_eq!(found, expected);
}

#[test]
fn absence_of_a_truth_is_no_break() {
    assert_eq!(
        told(
            &[("A", &[0.0, 0.0, GONE, 0.0])],
            &[("T", &[1.0, 1.0, 1.0, 1.0])]
        ),
        [
            "0 match A T 1",
            "1 match A T 1",
            "2 false_alarm - T -",
            "3 match A T 1"
        ]
    );
}

#[test]
fn an_unmatched_track_is_redundant_divergent_or_false() {
    let found = told(
        &[("A", &[0.0, 0.0, 0.0])],
        &[
            ("T1", &[1.0, 1.0, 1.0]),
            ("T2", &[GONE, 4.0, 30.0]),
            ("T3", &[100.0, 100.0, 100.0]),
        ],
    );
    let expected = [
        "0 match A T1 1",
        "0 false_alarm - T3 -",
        "1 match A T1 1",
        "1 redundant A T2 4",
        "1 false_alarm - T3 -",
        "2 match A T1 1",
        "2 false_alarm - T2 -",
        "2 false_alarm - T3 -",
    ];
    assert_eq!(found, expected);
    // T followed A; then it is out of the gate, first within reach, then beyond it. It is false once A has gone.
    let found = told(
        &[
            ("A", &[0.0, 0.0, 0.0, GONE]),
            ("B", &[GONE, GONE, GONE, 500.0]),
        ],
        &[("T", &[1.0, 15.0, 80.0, 80.0])],
    );
    let expected = [
        "0 match A T 1",
        "1 miss A - -",
        "1 break A T -",
        "1 divergence A T 15",
        "2 miss A - -",
        "2 divergence A T -",
        "3 miss B - -",
        "3 false_alarm - T -",
    ];
    assert_eq!(found, expected);
}

#[test]
fn a_step_without_any_track_does_not_make_a_pair_forgotten() {
    // At step 2 T2 is nearer, but T1 followed A at the last step that had tracks at all.
    let truth: Places = ("A", &[0.0, 0.0, 0.0]);
    let found = told(
        &[truth],
        &[("T1", &[1.0, GONE, 5.0]), ("T2", &[GONE, GONE, 1.0])],
    );
    assert_eq!(
        found[3..],
        [
            "2 match A T1 5",
            "2 reacquisition A T1 5",
            "2 redundant A T2 1"
        ]
    );
    // With a stranger at step 1 that step counts, and the nearer one is taken.
    let found = told(
        &[truth],
        &[
            ("T1", &[1.0, GONE, 5.0]),
            ("T2", &[GONE, GONE, 1.0]),
            ("T3", &[GONE, 99.0, GONE]),
        ],
    );
    assert_eq!(
        found[4..],
        [
            "2 match A T2 1",
            "2 switch A T2 1",
            "2 reacquisition A T2 1",
            "2 redundant A T1 5"
        ]
    );
}

#[test]
fn competition_is_settled_by_the_sum() {
    // A–T1 7, A–T2 1, B–T1 out of the gate, B–T2 3: the nearest pair A–T2 would leave B alone.
    let found = told(
        &[("A", &[0.0]), ("B", &[4.0])],
        &[("T1", &[-7.0]), ("T2", &[1.0])],
    );
    assert_eq!(found, ["0 match A T1 7", "0 match B T2 3"]);
}

#[test]
fn nothing_and_nobody() {
    assert_eq!(told(&[("A", &[0.0])], &[]), ["0 miss A - -"]);
    assert_eq!(told(&[], &[("T", &[0.0])]), ["0 false_alarm - T -"]);
    assert_eq!(told(&[], &[]), [""; 0]);
}

#[test]
fn a_log_knows_where_steps_begin() {
    let comparison = compare(
        &[("A", &[0.0, 0.0, 0.0])],
        &[("T", &[0.0, GONE, 0.0])],
        10.0,
    );
    let log = EventLog::new(&comparison);
    assert_eq!(log.steps, [0..1, 1..3, 3..5]);
    let counts = EventKind::ALL.map(|(kind, _)| log.count(kind));
    assert_eq!(counts, [2, 1, 0, 0, 1, 1, 0, 0]);
}
