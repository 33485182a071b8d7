//! HOTA of scenes worked by hand.

use super::*;
use crate::evaluation::tests::{GONE, Places, assert_quantities, compare, evaluate};

fn hota(comparisons: &[Comparison]) -> MetricReport {
    evaluate("hota", json!({}), comparisons)
}

#[test]
fn thresholds_are_reached_exactly() {
    assert_eq!(
        [0.0, 0.049, 0.05, 0.1, 0.15, 0.5, 0.95, 1.0].map(alphas_reached),
        [0, 0, 1, 2, 3, 10, 19, 19]
    );
    assert_eq!(
        [0.35, 0.349_999, 0.7, 0.9 - 1e-9].map(alphas_reached),
        [7, 6, 14, 17]
    );
}

#[test]
fn one_truth_with_two_tracks_by_hand() {
    // A at 6 steps; T on it at 0..=3 at the same place, U at 4 and 5 at 10 m: similarity 1 − 10 / 20 = 0.5.
    // Up to α = 0.5: TP 6, AssA = (16 / 6 + 4 / 6) / 6 = 5 / 9, DetA 1, HOTA √(5/9), LocA 5 / 6.
    // Above: TP 4, DetA = 4 / (6 + 6 − 4) = 1 / 2, AssA = 16 / 6 / 4 = 2 / 3, HOTA √(1/3), LocA 1.
    let tracks: [Places; 2] = [
        ("T", &[0.0, 0.0, 0.0, 0.0, GONE, GONE]),
        ("U", &[GONE, GONE, GONE, GONE, 10.0, 10.0]),
    ];
    let report = hota(&[compare(&[("A", &[0.0; 6])], &tracks, 10.0)]);
    let mean = |low: f64, high: f64| Some((10.0 * low + 9.0 * high) / 19.0);
    let expected = [
        ("hota", mean((5.0f64 / 9.0).sqrt(), (1.0f64 / 3.0).sqrt())),
        ("det_a", mean(1.0, 0.5)),
        ("ass_a", mean(5.0 / 9.0, 2.0 / 3.0)),
        ("loc_a", mean(5.0 / 6.0, 1.0)),
        ("det_re", mean(1.0, 4.0 / 6.0)),
        ("det_pr", mean(1.0, 4.0 / 6.0)),
        ("ass_re", mean(5.0 / 9.0, 2.0 / 3.0)),
        ("ass_pr", mean(1.0, 1.0)),
        ("owta", mean((5.0f64 / 9.0).sqrt(), (4.0f64 / 9.0).sqrt())),
        ("hota_0", Some((5.0f64 / 9.0).sqrt())),
        ("loc_a_0", Some(5.0 / 6.0)),
    ];
    assert_quantities(&report, &expected);
    let fp = report
        .series
        .iter()
        .find(|series| series.name == "fp")
        .unwrap();
    assert_eq!(
        (fp.axis, fp.at.len(), fp.values[9], fp.values[10]),
        ("alpha", 19, Some(0.0), Some(2.0))
    );
}

#[test]
fn steps_add_up_to_the_whole() {
    // A at 3 steps; T on it at 0 and 1; U at 10 m (similarity 0.5, ten of nineteen thresholds) at 2; F far off at 0.
    let tracks: [Places; 3] = [
        ("T", &[0.0, 0.0, GONE]),
        ("U", &[GONE, GONE, 10.0]),
        ("F", &[500.0, GONE, GONE]),
    ];
    let report = hota(&[compare(&[("A", &[0.0; 3])], &tracks, 10.0)]);
    let over_time = |name: &str| -> Vec<f64> {
        let mut series = report.series.iter();
        let series = series.find(|series| series.axis == "time_s" && series.name == name);
        series.unwrap().values.iter().flatten().copied().collect()
    };
    let share = 10.0 / 19.0;
    assert_close(&over_time("tp"), &[1.0, 1.0, share]);
    assert_close(&over_time("fn"), &[0.0, 0.0, 1.0 - share]);
    assert_close(&over_time("fp"), &[1.0, 0.0, 1.0 - share]);
    // T: 2 / (3 + 2 − 2) at every α, twice; U: 1 / (3 + 1 − 1) at ten.
    assert_close(
        &over_time("association"),
        &[2.0 / 3.0, 2.0 / 3.0, share / 3.0],
    );
}

fn assert_close(found: &[f64], expected: &[f64]) {
    assert_eq!(found.len(), expected.len());
    let close = |(a, b): (&f64, &f64)| (a - b).abs() < 1e-12;
    assert!(found.iter().zip(expected).all(close), "{found:?}");
}

#[test]
fn pairs_beyond_the_gate_count_up_to_twice_the_gate() {
    // 16 m at a gate of 10: similarity 0.2, so a match up to α = 0.2.
    assert_eq!(Hota.reach_m(10.0), 20.0);
    let report = hota(&[compare(&[("A", &[0.0])], &[("T", &[16.0])], 10.0)]);
    assert_quantities(
        &report,
        &[("det_re", Some(4.0 / 19.0)), ("hota_0", Some(1.0))],
    );
}

#[test]
fn edges() {
    let truth: [Places; 2] = [("A", &[0.0; 3]), ("B", &[50.0; 3])];
    let report = hota(&[compare(&truth, &[], 10.0)]);
    assert_quantities(
        &report,
        &[
            ("hota", Some(0.0)),
            ("det_a", Some(0.0)),
            ("det_re", Some(0.0)),
            ("owta", Some(0.0)),
            ("det_pr", None),
        ],
    );
    assert_quantities(
        &report,
        &[
            ("ass_a", None),
            ("loc_a", None),
            ("ass_re", None),
            ("ass_pr", None),
            ("loc_a_0", None),
        ],
    );
    let report = hota(&[compare(&[], &truth, 10.0)]);
    assert_quantities(
        &report,
        &[
            ("hota", Some(0.0)),
            ("det_pr", Some(0.0)),
            ("det_re", None),
            ("owta", None),
            ("loc_a", None),
        ],
    );
    let report = hota(&[compare(&[], &[], 10.0)]);
    assert_quantities(
        &report,
        &[
            ("hota", None),
            ("det_a", None),
            ("ass_a", None),
            ("loc_a", None),
            ("owta", None),
            ("hota_0", None),
        ],
    );
    assert_eq!(report.series[0].values, [None; ALPHAS]);
    let report = hota(&[compare(
        &[("A", &[0.0; 5])],
        &[("T", &[0.0, 0.0, GONE, 0.0, 0.0])],
        10.0,
    )]);
    assert_quantities(
        &report,
        &[
            ("hota", Some(0.8)),
            ("det_a", Some(0.8)),
            ("ass_a", Some(0.8)),
            ("loc_a", Some(1.0)),
            ("det_pr", Some(1.0)),
        ],
    );
}

#[test]
fn sequences_combine_from_counts() {
    // One sequence found whole (TP 4), one at 1 of 4 steps (TP 1, association 1 / 4): AssA = (4 + 1 / 4) / 5,
    // DetA = 5 / 8. The mean of the two HOTAs would be (1 + 1 / 4) / 2.
    let whole = compare(&[("A", &[0.0; 4])], &[("T", &[0.0; 4])], 10.0);
    let part = compare(
        &[("A", &[0.0; 4])],
        &[("T", &[0.0, GONE, GONE, GONE])],
        10.0,
    );
    let report = hota(&[whole, part]);
    assert_quantities(
        &report,
        &[
            ("ass_a", Some(0.85)),
            ("det_a", Some(0.625)),
            ("hota", Some((0.85f64 * 0.625).sqrt())),
        ],
    );
}
