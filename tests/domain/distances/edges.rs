//! What the metrics say where there is little to say.

use super::fixture::{Row, Scene, assert_close, checked, reason, values};
use serde_json::json;
use trackloom_domain::evaluation::EvaluationInput;
use trackloom_domain::evaluation::comparison::{Comparison, PointSettings};
use trackloom_domain::evaluation::credit::Credit;
use trackloom_domain::evaluation::events::EventLog;
use trackloom_domain::evaluation::metrics::Sequence;
use trackloom_domain::evaluation::paths::Alignment;
use trackloom_domain::evaluation::steps::StepSettings;
use trackloom_domain::model::scan::{Recording, RecordingParts, Scan};
use trackloom_domain::model::sensor::SensorSettings;

const ONE: [Row; 1] = [(0.0, "a", 0.0, 0.0, 1.0, 0.0)];

fn ospa() -> serde_json::Value {
    json!({"metric": "ospa", "cutoff_m": 10.0})
}

fn gospa() -> serde_json::Value {
    json!({"metric": "gospa", "cutoff_m": 10.0})
}

fn siap() -> serde_json::Value {
    json!({"metric": "siap", "confirm_steps": 1, "end_steps": 1})
}

#[test]
fn truth_without_tracks() {
    let scene = Scene::new(&ONE, &[]);
    assert_close(scene.evaluate(10.0, ospa()).value, 10.0, "OSPA is c");
    let gospa = scene.evaluate(10.0, gospa());
    assert_close(gospa.value, 50f64.sqrt(), "GOSPA is half of c² to the half");
    assert_close(gospa.quantity("missed_sum"), 50.0, "missed");
    let siap = scene.evaluate(10.0, siap());
    assert_close(siap.value, 0.0, "completeness");
    let null = [
        "ambiguity",
        "spuriousness",
        "position_accuracy",
        "velocity_accuracy",
        "track_number_change_rate",
        "longest_segment",
    ];
    for name in null {
        assert_eq!(siap.quantity(name), None, "{name}: {}", reason(&siap, name));
    }
    assert_eq!(reason(&siap, "ambiguity"), "no target is tracked");
}

#[test]
fn tracks_without_truth() {
    let scene = Scene::new(&[], &ONE);
    let ospa = scene.evaluate(10.0, ospa());
    assert_eq!(values(&ospa, "ospa"), [Some(10.0)], "c at the only step");
    let gospa = scene.evaluate(10.0, gospa());
    for (report, name) in [(&ospa, "ospa"), (&gospa, "gospa")] {
        assert_eq!(reason(report, name), "no target is due at any step");
    }
    assert_close(gospa.quantity("false_sum"), 50.0, "false");
    let siap = scene.evaluate(10.0, siap());
    assert_close(siap.quantity("spuriousness"), 1.0, "spuriousness");
    assert_eq!(
        (siap.value, reason(&siap, "completeness")),
        (None, "there is no target")
    );
}

/// A recording of scans in which nothing happened.
fn quiet(times_s: &[f64]) -> Recording {
    let scan = |(index, &time_s): (usize, &f64)| Scan {
        number: index as u32 + 1,
        time_s,
        sensor: 0,
        pose: None,
        own: Vec::new(),
        detections: Vec::new(),
    };
    Recording::new(RecordingParts {
        sensors: vec![SensorSettings::named("radar")],
        scans: times_s.iter().enumerate().map(scan).collect(),
        ..Default::default()
    })
    .unwrap()
}

#[test]
fn steps_at_which_both_are_empty_are_at_distance_zero() {
    let (scene, recording) = (Scene::new(&[], &[]), quiet(&[0.0, 1.0]));
    let input = EvaluationInput {
        recording: Some(&recording),
        ..scene.input()
    };
    let settings = PointSettings {
        alignment: Alignment::Interpolate {
            max_gap_s: Some(5.0),
        },
        gate_m: 10.0,
        reach_m: 10.0,
        steps: StepSettings::default(),
        credit: Credit::Afterwards,
    };
    let comparison = Comparison::of_points(&input, &scene.truth, &settings);
    let events = EventLog::new(&comparison);
    let sequence = Sequence {
        comparison: &comparison,
        events: &events,
        input: Some(input),
    };
    for (spec, name) in [(ospa(), "ospa"), (gospa(), "gospa")] {
        let report = checked(&spec).unwrap().evaluate(&[sequence]);
        assert_eq!(reason(&report, name), "no target is due at any step");
        assert_eq!(values(&report, name), [Some(0.0), Some(0.0)]);
    }
    let report = checked(&siap()).unwrap().evaluate(&[sequence]);
    assert!(
        report
            .quantities
            .iter()
            .all(|quantity| quantity.value.is_none() && quantity.reason.is_some())
    );
    assert_eq!(values(&report, "completeness"), [None, None]);
}

#[test]
fn nothing_at_all_has_no_step_and_no_value() {
    for spec in [ospa(), gospa(), siap()] {
        let report = Scene::new(&[], &[]).evaluate(10.0, spec);
        assert!(report.value.is_none() && report.reason.is_some());
    }
}

#[test]
fn a_pair_at_the_cutoff_or_beyond_is_one_missed_and_one_false() {
    for x in [10.0, 11.0] {
        let scene = Scene::new(&ONE, &[(0.0, "t", x, 0.0, 0.0, 0.0)]);
        let report = scene.evaluate(20.0, gospa());
        let counts = ["matched", "missed", "false"].map(|name| report.quantity(name));
        assert_eq!(counts, [Some(0.0), Some(1.0), Some(1.0)]);
        assert_close(report.value, 10.0, "GOSPA");
        assert_close(scene.evaluate(20.0, ospa()).value, 10.0, "OSPA");
    }
}

#[test]
fn accuracies_without_a_match_are_null() {
    let scene = Scene::new(&ONE, &[(0.0, "t", 500.0, 0.0, 0.0, 0.0)]);
    let report = scene.evaluate(10.0, siap());
    assert_eq!(
        reason(&report, "position_accuracy"),
        "no track follows a target"
    );
    assert_close(
        report.quantity("spuriousness"),
        1.0,
        "the track follows nobody",
    );
}

#[test]
fn clocks_that_differ_meet_by_interpolation() {
    let truth = [
        (0.0, "a", 0.0, 0.0, 10.0, 0.0),
        (2.0, "a", 20.0, 0.0, 10.0, 0.0),
    ];
    let tracks = [
        (0.5, "t", 5.0, 3.0, 10.0, 0.0),
        (1.5, "t", 15.0, -3.0, 10.0, 0.0),
    ];
    let scene = Scene::new(&truth, &tracks);
    assert_eq!(scene.compare(10.0, 10.0).warnings, Vec::<String>::new());
    assert_close(
        scene.evaluate(10.0, gospa()).value,
        3.0,
        "3 m off the line at both times",
    );
    assert_close(
        scene.evaluate(10.0, siap()).quantity("position_accuracy"),
        3.0,
        "3 m",
    );
}

#[test]
fn times_that_do_not_meet_are_warned_of_and_all_is_missed_or_false() {
    let scene = Scene::new(
        &[(0.0, "a", 0.0, 0.0, 0.0, 0.0)],
        &[(100.0, "t", 0.0, 0.0, 0.0, 0.0)],
    );
    let report = scene.evaluate(10.0, gospa());
    let counts = ["missed", "false", "steps", "due_steps"].map(|name| report.quantity(name));
    assert_eq!(counts, [1.0, 1.0, 2.0, 1.0].map(Some));
    assert_close(
        report.value,
        2.0 * 50f64.sqrt(),
        "of two steps, over the one that is due",
    );
}

#[test]
fn what_is_not_finite_never_gets_past_the_readers() {
    use trackloom_domain::formats::{ReadOptions, format_named};
    let csv = format_named("csv").unwrap();
    for text in [
        "time_s,truth_id,x_m,y_m\n0,a,NaN,0\n",
        "time_s,track_id,x_m,y_m\n0,t,0,inf\n",
    ] {
        let faults = (csv.read)(&mut text.as_bytes(), &ReadOptions::default()).unwrap_err();
        assert!(faults[0].line == Some(2), "{faults:?}");
    }
}

#[test]
fn parameters_out_of_range_are_refused_with_what_is_allowed() {
    for metric in ["ospa", "gospa"] {
        let faults = checked(&json!({"metric": metric, "cutoff_m": 0, "p": 0.5}))
            .err()
            .unwrap();
        assert_eq!(faults, ["/cutoff_m [0.001, 10000000] m", "/p [1, 10]"]);
    }
    let faults = checked(&json!({"metric": "siap", "confirm_steps": 0, "siap_compat": "best"}))
        .err()
        .unwrap();
    assert_eq!(
        faults,
        ["/confirm_steps [1, 1000]", "/siap_compat none, stonesoup"]
    );
    assert_eq!(
        checked(&json!({"metric": "gospa", "switch_penalty_m": -1}))
            .err()
            .unwrap(),
        ["/switch_penalty_m [0, 10000000] m"]
    );
}

#[test]
fn the_extremes_of_the_parameters_overflow_nothing() {
    let scene = Scene::new(&ONE, &[(0.0, "t", 1.0, 0.0, 0.0, 0.0)]);
    for (cutoff_m, penalty_m) in [(1e-3, 1e7), (1e7, 0.0)] {
        for metric in ["ospa", "gospa"] {
            let mut spec = json!({"metric": metric, "cutoff_m": cutoff_m, "p": 10.0});
            if metric == "gospa" {
                spec["switch_penalty_m"] = json!(penalty_m);
            }
            assert!(scene.evaluate(1.0, spec).value.is_some_and(f64::is_finite));
        }
    }
}
