//! What is planned of a request, and what is refused.

use super::*;
use crate::experiment::presets;
use crate::model::dataset::DatasetKind;
use serde_json::json;

const ID: &str = "0197";

fn pointers(kind: JobKind, body: Value) -> Vec<(String, String)> {
    plan(kind, &body)
        .unwrap_err()
        .into_iter()
        .map(|fault| (fault.pointer, fault.code))
        .collect()
}

fn roles(body: Value) -> Vec<(&'static str, DatasetKind, bool)> {
    plan(JobKind::Evaluate, &body)
        .unwrap()
        .inputs
        .iter()
        .map(|input| (&*input.pointer.clone().leak(), input.role, input.optional))
        .collect()
}

#[test]
fn every_preset_is_a_plan_and_its_spec_is_the_same_plan() {
    for preset in presets::all() {
        let first = plan(preset.kind, &preset.body).unwrap();
        let again = plan(preset.kind, &first.spec).unwrap();
        assert_eq!(first.spec, again.spec, "{}", preset.name);
        assert!(first.cost.detections > 0 && first.inputs.is_empty());
    }
}

#[test]
fn a_preset_as_a_source_is_written_out() {
    let body = json!({"input": {"source": "preset", "preset": "liang2009-30"}});
    let made = plan(JobKind::Associate, &body).unwrap();
    assert_eq!(
        made.spec.pointer("/input/scenario/targets/count"),
        Some(&json!(30))
    );
    let unknown = json!({"input": {"source": "preset", "preset": "liang2010"}});
    assert_eq!(
        pointers(JobKind::Associate, unknown),
        [("/input/preset".into(), "unknown_value".into())]
    );
}

#[test]
fn evaluate_takes_input_or_tracks_but_not_both_nor_neither() {
    let tracks = json!({"source": "dataset", "dataset_id": ID});
    let input = json!({"source": "job", "job_id": ID});
    assert_eq!(
        pointers(JobKind::Evaluate, json!({})),
        [("".into(), "missing".into())]
    );
    let both = json!({"tracks": tracks, "input": input});
    assert_eq!(
        pointers(JobKind::Evaluate, both),
        [("/tracks".into(), "conflict".into())]
    );
    let settings = json!({"tracks": input, "filter": {"method": "kalman"}});
    assert_eq!(
        pointers(JobKind::Evaluate, settings),
        [("/filter".into(), "conflict".into())]
    );
    assert_eq!(
        pointers(JobKind::Evaluate, json!({"tracks": tracks})),
        [("/truth".into(), "missing".into())]
    );
    let by_id = json!({"tracks": tracks, "tfa": {}});
    assert_eq!(
        pointers(JobKind::Evaluate, by_id),
        [("/detections".into(), "missing".into())]
    );
    let by_truth =
        json!({"tracks": tracks, "tfa": {"symbols": {"kind": "nearest_truth", "gate_m": 10}}});
    assert_eq!(
        pointers(JobKind::Evaluate, by_truth),
        [("/truth".into(), "missing".into())]
    );
}

#[test]
fn faults_of_single_fields_and_of_their_meaning_are_reported_together() {
    let body = json!({
        "input": {"source": "preset", "preset": "x"},
        "tracker": {"confirm_hits": 9, "confirm_window": 4, "max_missed": 0},
        "wings": 2
    });
    let found: Vec<String> = pointers(JobKind::Associate, body)
        .into_iter()
        .map(|(pointer, _)| pointer)
        .collect();
    assert_eq!(
        found,
        [
            "/tracker/max_missed",
            "/wings",
            "/input/preset",
            "/tracker/confirm_hits"
        ]
    );
    assert_eq!(
        pointers(JobKind::Evaluate, json!(7)),
        [("".into(), "wrong_type".into())]
    );
}

#[test]
fn a_job_brings_along_its_detections_and_its_truth() {
    use DatasetKind::{Detections, Tracks, Truth};
    let job = json!({"source": "job", "job_id": ID});
    let dataset = json!({"source": "dataset", "dataset_id": ID});
    assert_eq!(
        roles(json!({"tracks": job})),
        [
            ("/tracks", Tracks, false),
            ("/tracks", Detections, true),
            ("/tracks", Truth, true)
        ]
    );
    assert_eq!(
        roles(json!({"input": job})),
        [("/input", Detections, false), ("/input", Truth, true)]
    );
    let own_truth = json!({"tracks": job, "truth": dataset});
    assert_eq!(
        roles(own_truth),
        [
            ("/tracks", Tracks, false),
            ("/truth", Truth, false),
            ("/tracks", Detections, true)
        ]
    );
}

#[test]
fn a_request_too_large_for_the_machine_is_refused_before_it_runs() {
    let mut body = presets::find("liang2009").unwrap().body;
    body["input"]["scenario"]["scans"] = json!(100_000);
    body["input"]["scenario"]["targets"]["count"] = json!(100_000);
    assert_eq!(
        pointers(JobKind::Evaluate, body),
        [("/input/scenario".into(), "too_large".into())]
    );
}

#[test]
fn confirmation_needs_as_many_scans_as_detections() {
    let mut body = presets::find("liang2009").unwrap().body;
    body["tracker"]["confirm_hits"] = json!(6);
    assert_eq!(
        pointers(JobKind::Evaluate, body),
        [("/tracker/confirm_hits".into(), "out_of_range".into())]
    );
}

#[test]
fn sequences_are_judged_by_metrics_alone() {
    let data = json!({"source": "dataset", "dataset_id": ID});
    let sequence = json!({"name": "a", "truth": data, "tracks": data});
    let other = json!({"name": "b", "truth": data, "tracks": data});
    let body = json!({"sequences": [sequence, other], "profile": "vision"});
    use DatasetKind::{Tracks, Truth};
    let expected = [
        ("/sequences/0/truth", Truth),
        ("/sequences/0/tracks", Tracks),
        ("/sequences/1/truth", Truth),
        ("/sequences/1/tracks", Tracks),
    ];
    assert_eq!(
        roles(body.clone()),
        expected.map(|(pointer, role)| (pointer, role, false))
    );
    let with_more =
        json!({"sequences": [sequence], "tfa": {}, "truth": data, "filter": {"method": "kalman"}});
    let found: Vec<String> = pointers(JobKind::Evaluate, with_more)
        .into_iter()
        .map(|(pointer, _)| pointer)
        .collect();
    assert_eq!(found, ["/filter", "/truth", "/tfa"]);
    let both = json!({"sequences": [sequence], "tracks": data});
    assert_eq!(
        pointers(JobKind::Evaluate, both)[0],
        ("/sequences".into(), "conflict".into())
    );
}

#[test]
fn a_profile_becomes_its_metrics_and_metrics_need_truth() {
    let names = |body: Value| -> Vec<String> {
        let spec = plan(JobKind::Evaluate, &body).unwrap().spec;
        spec["metrics"]
            .as_array()
            .unwrap()
            .iter()
            .map(|metric| metric["metric"].as_str().unwrap().to_owned())
            .collect()
    };
    let job = json!({"source": "job", "job_id": ID});
    let dataset = json!({"source": "dataset", "dataset_id": ID});
    assert_eq!(
        names(json!({"tracks": job, "profile": "vision"})),
        ["hota", "clear", "identity"]
    );
    assert_eq!(
        names(json!({"tracks": job})),
        ["gospa", "ospa", "siap", "clear", "assignment", "kinematics"]
    );
    assert_eq!(names(json!({"tracks": job, "profile": "tfa"})), [""; 0]);
    assert_eq!(
        names(json!({"tracks": dataset, "detections": dataset})),
        [""; 0],
        "there is no truth to compare with"
    );
    let gate = plan(
        JobKind::Evaluate,
        &json!({"tracks": job, "comparison": {"gate_m": 7.5}}),
    )
    .unwrap()
    .spec;
    assert_eq!(gate["metrics"][0]["cutoff_m"], 7.5);
    let asked = json!({"tracks": dataset, "detections": dataset, "metrics": [{"metric": "clear"}]});
    assert_eq!(
        pointers(JobKind::Evaluate, asked),
        [("/truth".into(), "missing".into())]
    );
    let unknown = json!({"tracks": job, "profile": "radar", "metrics": [{"metric": "mota"}], "comparison": {"gate_m": 0}});
    let found: Vec<String> = pointers(JobKind::Evaluate, unknown)
        .into_iter()
        .map(|(pointer, _)| pointer)
        .collect();
    assert_eq!(
        found,
        ["/profile", "/metrics/0/metric", "/comparison/gate_m"]
    );
}

#[test]
fn sequences_have_names_of_their_own_and_are_judged_by_metrics() {
    let source = json!({"source": "dataset", "dataset_id": ID});
    let sequence = json!({"name": "a", "truth": source, "tracks": source});
    let body = json!({"sequences": [sequence, sequence], "profile": "tfa"});
    let found = pointers(JobKind::Evaluate, body);
    assert_eq!(
        found,
        [
            ("/sequences/1/name".into(), "duplicate".into()),
            ("/profile".into(), "unsupported".into())
        ]
    );
}

#[test]
fn sensors_go_with_tracks_where_detections_are_known() {
    let source = json!({"source": "dataset", "dataset_id": ID});
    let mut body = json!({"tracks": source, "truth": source, "sensors": [{"sensor_id": "radar", "x_m": 0.0, "y_m": 0.0}]});
    assert_eq!(
        pointers(JobKind::Evaluate, body.clone()),
        [("/sensors".into(), "conflict".into())]
    );
    body["detections"] = source;
    assert!(plan(JobKind::Evaluate, &body).is_ok());
}

#[test]
fn every_kind_has_its_line() {
    for (kind, definition) in JobKind::ALL.into_iter().zip(&JOBS) {
        assert_eq!(definition.kind, kind);
    }
}
