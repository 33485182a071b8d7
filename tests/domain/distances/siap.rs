//! SIAP by the small scenes and by hand.

use super::fixture::{Scene, assert_close, assert_series, evaluate_all, values};
use super::scenes;
use serde_json::json;
use trackloom_domain::evaluation::metrics::MetricReport;

const NAMES: [&str; 7] = [
    "completeness",
    "ambiguity",
    "spuriousness",
    "position_accuracy",
    "velocity_accuracy",
    "track_number_change_rate",
    "longest_segment",
];

fn siap(scene: &Scene, gate_m: f64, confirm: u32, end: u32, compat: &str) -> MetricReport {
    scene.evaluate(gate_m, json!({"metric": "siap", "confirm_steps": confirm, "end_steps": end, "siap_compat": compat}))
}

fn assert_summary(report: &MetricReport, expected: [f64; 7]) {
    for (name, expected) in NAMES.iter().zip(expected) {
        assert_close(report.quantity(name), expected, name);
    }
}

#[test]
fn confirmed_after_three_and_ended_after_two_both_ways_of_counting_agree() {
    for compat in ["none", "stonesoup"] {
        let main = siap(&scenes::main(), 10.0, 3, 2, compat);
        let expected = [
            0.8888888888888888,
            1.0,
            0.15789473684210525,
            2.5443830646610093,
            0.5507978256670257,
            0.07692307692307693,
            0.6875,
        ];
        assert_summary(&main, expected);
        let swap = siap(&scenes::swap(), 10.0, 3, 2, compat);
        assert_summary(&swap, [1.0, 1.0, 0.0, 0.75, 0.0, 0.1111111111111111, 0.5]);
    }
}

#[test]
fn stone_soup_counts_the_same_track_again_as_a_change_and_adds_its_pieces() {
    let report = siap(&scenes::main(), 10.0, 1, 1, "stonesoup");
    let expected = [
        0.8333333333333334,
        1.0,
        0.21052631578947367,
        2.0473419356384097,
        0.5486446680791921,
        0.18181818181818182,
        0.5625,
    ];
    assert_summary(&report, expected);
    assert_series(
        &report,
        "completeness",
        &[1.0, 1.0, 0.5, 1.0, 1.0, 1.0, 0.5, 0.5, 1.0, 1.0],
    );
    assert_series(&report, "ambiguity", &[1.0; 10]);
    assert_series(
        &report,
        "spuriousness",
        &[0.0, 0.0, 0.0, 0.0, 1.0 / 3.0, 1.0 / 3.0, 0.5, 0.5, 0.0, 0.0],
    );
}

#[test]
fn ours_is_contiguous_and_the_same_track_again_is_no_change() {
    // A gate just below the one error of 10 m breaks B's track at t = 7: pieces of 3 s and 1 s, tracked 7 + 4 s.
    let report = siap(&scenes::main(), 9.5, 1, 1, "none");
    assert_summary(
        &report,
        [
            15.0 / 18.0,
            1.0,
            4.0 / 19.0,
            2.0473419356384097,
            0.5486446680791921,
            1.0 / 11.0,
            8.0 / 16.0,
        ],
    );
    assert_close(
        report.per_truth[0].quantities[1].value,
        1.0,
        "A changes from T1 to T3",
    );
    assert_close(
        report.per_truth[1].quantities[1].value,
        0.0,
        "B has T2 again",
    );
    let t4 = report
        .per_track
        .iter()
        .find(|line| line.id == "T4")
        .unwrap();
    assert_close(t4.quantities[0].value, 0.0, "T4 follows nobody");
}

#[test]
fn a_distance_equal_to_the_gate_follows() {
    let report = siap(&scenes::main(), 10.0, 1, 1, "none");
    assert_close(
        report.quantity("completeness"),
        16.0 / 18.0,
        "T2 follows B at t = 7, too",
    );
    assert_close(
        report.quantity("longest_segment"),
        11.0 / 16.0,
        "B's segment is not broken",
    );
    let stone_soup = siap(&scenes::main(), 10.0, 1, 1, "stonesoup");
    assert_close(
        stone_soup.quantity("completeness"),
        15.0 / 18.0,
        "Stone Soup takes it for no match",
    );
}

#[test]
fn spare_tracks_raise_ambiguity_and_need_no_number() {
    // S1 follows A for all five steps, S2 beside it in the middle three.
    let truth: Vec<_> = (0..5)
        .map(|step| (f64::from(step), "A", 0.0, 0.0, 0.0, 0.0))
        .collect();
    let mut tracks: Vec<_> = (0..5)
        .map(|step| (f64::from(step), "S1", 1.0, 0.0, 0.0, 0.0))
        .collect();
    tracks.extend((1..4).map(|step| (f64::from(step), "S2", 0.0, 3.0, 0.0, 4.0)));
    let report = siap(&Scene::new(&truth, &tracks), 10.0, 1, 1, "none");
    assert_summary(
        &report,
        [1.0, 8.0 / 5.0, 0.0, 14.0 / 8.0, 12.0 / 8.0, 0.0, 1.0],
    );
    assert_eq!(
        values(&report, "ambiguity"),
        [1.0, 2.0, 2.0, 2.0, 1.0].map(Some)
    );
}

#[test]
fn sequences_combine_from_counts() {
    let report = evaluate_all(
        &[&scenes::main(), &scenes::swap()],
        10.0,
        json!({"metric": "siap"}),
    );
    assert_close(
        report.quantity("completeness"),
        (16.0 + 22.0) / (18.0 + 22.0),
        "completeness",
    );
    assert_close(
        report.quantity("track_number_change_rate"),
        3.0 / (13.0 + 18.0),
        "rate",
    );
    assert_close(
        report.quantity("longest_segment"),
        (11.0 + 10.0) / (16.0 + 20.0),
        "longest",
    );
    assert!(report.series.is_empty());
    assert!(report.per_truth.is_empty());
}
