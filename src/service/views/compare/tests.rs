//! Pairs, batches and where requests differ.

use super::*;
use serde_json::json;

#[test]
fn batches_keep_their_order_and_the_mean() {
    assert_eq!(batch_means(&[1.0, 3.0, 5.0, 7.0]), [2.0, 6.0]);
    assert_eq!(batch_means(&[1.0, 2.0, 3.0, 4.0, 6.0]), [1.5, 13.0 / 3.0]);
    assert!(batch_means(&[]).is_empty());
}

#[test]
fn steps_are_paired_by_time_and_counted() {
    let ours = [
        ("0".to_owned(), 2.0),
        ("1".to_owned(), 1.0),
        ("2".to_owned(), 5.0),
        ("9".to_owned(), 100.0),
        ("3".to_owned(), 4.0),
    ];
    let theirs: Values = [("0", 1.0), ("1", 2.0), ("2", 1.0), ("3", 4.0)]
        .map(|(key, value)| (key.to_owned(), value))
        .into();
    let found = difference(&ours, &theirs, 0.95, PairedOver::Steps).unwrap();
    // 1, −1, 4, 0: batches have the means 0 and 2; t of one degree of freedom is 12.706, s / √2 is 1.
    assert_eq!(
        (found.pairs, found.mean, found.smaller, found.larger),
        (4, 1.0, 1, 2)
    );
    assert!((found.interval.unwrap().high - (1.0 + 12.706_204_7)).abs() < 1e-6);
    assert_eq!(difference(&[], &theirs, 0.95, PairedOver::Runs), None);
}

#[test]
fn requests_are_compared_leaf_by_leaf() {
    let (mut one, mut two) = (BTreeMap::new(), BTreeMap::new());
    leaves(
        &json!({"a/b": [1, {"c": "x"}], "d": {}}),
        String::new(),
        &mut one,
    );
    leaves(&json!({"a/b": [1]}), String::new(), &mut two);
    let pairs: Vec<_> = one
        .iter()
        .map(|(pointer, value)| (pointer.as_str(), value.as_str()))
        .collect();
    assert_eq!(
        pairs,
        [("/a~1b/0", "1"), ("/a~1b/1/c", "\"x\""), ("/d", "{}")]
    );
    assert_eq!(two.len(), 1);
}

#[test]
fn a_step_that_one_side_lacks_has_no_errors_there() {
    let ours = [("0".to_owned(), 2.0)];
    let theirs: Values = [("0", 1.0), ("1", 3.0)]
        .map(|(key, value)| (key.to_owned(), value))
        .into();
    let keys = |name: &str| filled(name, &ours, &theirs).len();
    for name in [
        "clear.fp",
        "gospa.gospa",
        "gospa_2.missed",
        "hota_2.fn",
        "siap.spuriousness",
    ] {
        assert_eq!(keys(name), 2, "{name}");
    }
    for name in [
        "siap.completeness",
        "kinematics.position_rmse",
        "ospa2.ospa2_of_window",
    ] {
        assert_eq!(keys(name), 1, "{name}");
    }
}
