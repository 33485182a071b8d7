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

fn side(spec: Value, result: Value) -> Side {
    let job = ComparedJob {
        id: uuid::Uuid::nil(),
        kind: crate::service::types::JobKind::Campaign,
        name: None,
        seed: 1,
        total_s: 0.0,
    };
    Side {
        job,
        spec,
        result,
        metrics: MetricTable::default(),
        truths: None,
        runs: None,
    }
}

#[test]
fn campaigns_that_differ_in_tracker_or_limits_read_the_same_data() {
    let campaign = |more: &dyn Fn(&mut Value)| {
        let mut spec = json!({
            "base": {"input": {"preset": "a"}, "tracker": {"max_missed": 3}},
            "grid": [{"by": "values", "path": "/associator/method", "values": ["jpda"]}]
        });
        more(&mut spec);
        side(spec, Value::Null)
    };
    let base = campaign(&|_| {});
    let differs = |more: &dyn Fn(&mut Value)| reads_other_data(&campaign(more), &base);
    assert!(!differs(
        &|spec| spec["base"]["tracker"] = json!({"max_missed": 5})
    ));
    assert!(!differs(
        &|spec| spec["limits"] = json!([{"quantity": "x", "at_least": 1}])
    ));
    assert!(!differs(
        &|spec| spec["grid"][0]["values"] = json!(["pda", "jpda"])
    ));
    assert!(differs(&|spec| spec["base"]["input"]["preset"] = json!("b")));
    assert!(differs(
        &|spec| spec["grid"][0]["path"] = json!("/input/scenario/scans")
    ));
    let set = json!([{"set": [{"path": "/input/preset", "value": "c"}]}]);
    assert!(differs(
        &|spec| spec["grid"] = json!([{"by": "variants", "variants": set}])
    ));
}

#[test]
fn requirements_have_a_direction_and_thresholds_that_are_lost_are_told() {
    let items = json!([
        {"requirement": "detection", "at_least": 0.9},
        {"requirement": "position_rms", "name": "rms", "at_most": 100},
        {"requirement": "latency", "name": "late"}
    ]);
    let spec = json!({"base": {"requirements": {"items": items}}});
    let path = |name: &str| held::better(&format!("requirements.values.terminal.{name}"), &spec);
    for name in [
        "detection",
        "detection_2.value",
        "late",
        "mode_a_correct",
        "detection.met",
    ] {
        assert_eq!(path(name), Some(true), "{name}");
    }
    for name in [
        "rms",
        "position_beyond",
        "address_false",
        "false_tracks",
        "continuity",
    ] {
        assert_eq!(path(name), Some(false), "{name}");
    }
    assert_eq!(path("mine"), None);

    let result = |share: f64, met: bool| {
        json!({
            "requirements": {"values": {"terminal": {"detection": {"value": share, "met": met}}}},
            "limits": {"checks": [{"quantity": "requirements.terminal.detection", "at_least": 0.9, "met": met}]}
        })
    };
    let plain = json!({"requirements": {"items": items}});
    let sides = [
        side(plain.clone(), result(0.95, true)),
        side(plain, result(0.8, false)),
    ];
    let name = "requirements.terminal.detection, at least 0.9".to_owned();
    assert_eq!(kept_limits(&sides[0], &sides[1]), [(name, false)]);
    assert!(kept_limits(&sides[1], &sides[0]).is_empty());
    let [number] = &of(&sides, 0, 0.95).numbers[..] else {
        panic!("one number")
    };
    assert_eq!(number.path, "requirements.values.terminal.detection");
    assert_eq!(
        (number.higher_is_better, number.values[1]),
        (Some(true), Some(0.8))
    );
}
