//! Losses, swaps and errors of scenes worked by hand.

use super::*;
use crate::evaluation::tests::{GONE, assert_quantities, compare, evaluate};

fn report(comparisons: &[Comparison]) -> MetricReport {
    evaluate("track_keeping", json!({"sigma": 1.0}), comparisons)
}

#[test]
fn a_swap_is_told_at_the_first_step_at_which_the_targets_are_apart_again() {
    // The targets are 20, 2, 4 and 8 apart; the tracks change sides at the third step, and 4 is not yet apart (6).
    let truths: [(&str, &[f64]); 2] = [
        ("a", &[-10.0, -1.0, 2.0, 4.0]),
        ("b", &[10.0, 1.0, -2.0, -4.0]),
    ];
    let swapped = compare(
        &truths,
        &[
            ("a", &[-10.0, -1.0, -2.0, -4.0]),
            ("b", &[10.0, 1.0, 2.0, 4.0]),
        ],
        50.0,
    );
    let found = report(std::slice::from_ref(&swapped));
    let expected = [
        ("identity", Some(0.0)),
        ("stay", Some(0.0)),
        ("mean_absolute_error", Some(3.0)),
        ("mean_absolute_error_kept", None),
    ];
    assert_quantities(&found, &expected);
    let target = &found.findings["targets"][0];
    assert_eq!(
        (
            &target["lost_step"],
            &target["lost_time_s"],
            &target["swapped_with"]
        ),
        (&json!(4), &json!(3.0), &json!("b"))
    );
    let kept = compare(&truths, &truths, 50.0);
    assert_quantities(
        &report(&[swapped, kept]),
        &[
            ("identity", Some(0.5)),
            ("mean_absolute_error", Some(1.5)),
            ("targets_identity", Some(2.0)),
        ],
    );
}

#[test]
fn a_lag_of_more_than_five_sigma_breaks_stay_and_of_more_than_ten_identity() {
    let of = |error: f64| {
        report(&[compare(
            &[("a", &[0.0, 0.0])],
            &[("a", &[0.0, error])],
            50.0,
        )])
    };
    for (error, identity, stay) in [
        (5.0, 1.0, 1.0),
        (5.01, 1.0, 0.0),
        (10.0, 1.0, 0.0),
        (10.01, 0.0, 0.0),
    ] {
        assert_quantities(
            &of(error),
            &[("identity", Some(identity)), ("stay", Some(stay))],
        );
    }
    assert_eq!(
        of(11.0).findings["targets"][0]["swapped_with"],
        Value::Null,
        "there is no other target"
    );
}

#[test]
fn a_missing_track_is_a_lost_one_and_names_and_sigma_are_needed() {
    let truths: [(&str, &[f64]); 2] = [("a", &[0.0, 0.0]), ("b", &[50.0, 50.0])];
    let found = report(&[compare(
        &truths,
        &[("a", &[0.0, 0.0]), ("b", &[50.0, GONE])],
        50.0,
    )]);
    assert_quantities(
        &found,
        &[
            ("identity", Some(0.0)),
            ("stay", Some(0.0)),
            ("targets_identity", Some(1.0)),
            ("missing_points", Some(1.0)),
        ],
    );
    assert_eq!(found.findings["targets"][1]["lost_step"], 2);
    let strangers = report(&[compare(&truths, &[("1", &[0.0, 0.0])], 50.0)]);
    assert_quantities(
        &strangers,
        &[("identity", None), ("mean_absolute_error", None)],
    );
    let unknown = evaluate(
        "track_keeping",
        json!({}),
        &[compare(&truths, &truths, 50.0)],
    );
    assert_quantities(
        &unknown,
        &[("identity", None), ("mean_absolute_error", Some(0.0))],
    );
    assert_eq!(unknown.reason, Some(NO_SIGMA));
}
