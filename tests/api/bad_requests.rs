//! Job bodies that cannot be run: every fault at once, each with its pointer and what would be allowed.

use crate::helpers::{Api, failing, id, problem, small, validation};
use serde_json::{Value, json};

const NOBODY: &str = "0199e0a4-7c00-7000-8000-000000000001";

/// The problem of a refused job; no job may come of it.
async fn refusal(kind: &str, body: &Value) -> Value {
    let api = Api::start().await;
    let answer = api.post(&format!("/v1/jobs/{kind}"), body).await;
    assert_eq!(api.get("/v1/jobs?count=true").await.ok(200)["total"], 0);
    answer.problem()
}

fn preset() -> Value {
    json!({"input": {"source": "preset", "preset": "liang2009-10"}})
}

fn with(mut body: Value, pointer: &str, value: Value) -> Value {
    *body.pointer_mut(pointer).unwrap() = value;
    body
}

fn out_of_range(pointer: &str, detail: &str, allowed: &str) -> Value {
    json!({"pointer": pointer, "code": "out_of_range", "detail": detail, "allowed": allowed})
}

#[tokio::test(flavor = "multi_thread")]
async fn no_targets_and_no_scans_are_refused() {
    let body = with(small(), "/scenario/targets/targets", json!([]));
    let detail = "the list has 0 entries";
    let fault = out_of_range("/scenario/targets/targets", detail, "1 to 100000 entries");
    assert_eq!(
        refusal("simulate", &body).await,
        validation(detail, json!([fault]))
    );

    let random = json!({"kind": "random", "count": 0, "area_side_m": 100.0, "speed_min_mps": 1.0, "speed_max_mps": 2.0});
    let detail = "0 is outside the allowed range";
    let fault = out_of_range("/scenario/targets/count", detail, "[1, 100000]");
    assert_eq!(
        refusal("simulate", &with(small(), "/scenario/targets", random)).await,
        validation(detail, json!([fault]))
    );

    let fault = out_of_range("/scenario/scans", detail, "[1, 100000]");
    assert_eq!(
        refusal("simulate", &with(small(), "/scenario/scans", json!(0))).await,
        validation(detail, json!([fault]))
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn an_unknown_method_is_refused_with_the_known_ones() {
    let mut body = preset();
    body["associator"] = json!({"method": "owl"});
    let detail = "unknown method \"owl\"";
    let fault = json!({"pointer": "/associator/method", "code": "unknown_value", "detail": detail, "allowed": "nearest_neighbour, strongest_neighbour, global_nearest_neighbour, pda, jpda, fuzzy_c_means, bat, oracle"});
    assert_eq!(
        refusal("associate", &body).await,
        validation(detail, json!([fault]))
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn a_parameter_out_of_range_is_refused_with_its_range() {
    let mut body = preset();
    body["tracker"] = json!({"gate_probability": 1.5});
    let detail = "1.5 is outside the allowed range";
    let fault = out_of_range("/tracker/gate_probability", detail, "(0, 1]");
    assert_eq!(
        refusal("associate", &body).await,
        validation(detail, json!([fault]))
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn an_unknown_field_is_refused_with_the_known_ones() {
    let mut body = preset();
    body["colour"] = json!("red");
    let detail = "unknown field 'colour'";
    let allowed =
        "name, labels, limits, seed, input, detector, truth, sensors, associator, filter, tracker";
    let fault = json!({"pointer": "/colour", "code": "unknown_field", "detail": detail, "allowed": allowed});
    assert_eq!(
        refusal("associate", &body).await,
        validation(detail, json!([fault]))
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn two_faults_are_told_at_once() {
    let mut body = preset();
    body["filter"] = json!({"method": "kalman", "process_noise_m2ps3": -1});
    body["seed"] = json!("one");
    let faults = json!([
        {"pointer": "/seed", "code": "wrong_type", "detail": "expected a whole number, found a text", "allowed": "a whole number"},
        out_of_range("/filter/process_noise_m2ps3", "-1 is outside the allowed range", "[0, 1000000000] m²/s³")
    ]);
    assert_eq!(
        refusal("associate", &body).await,
        validation("2 faults", faults)
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn an_unknown_dataset_is_refused() {
    let body = json!({"input": {"source": "dataset", "dataset_id": NOBODY}});
    let detail = format!("there is no dataset '{NOBODY}'");
    let fault = json!({"pointer": "/input/dataset_id", "code": "not_found", "detail": detail});
    assert_eq!(
        refusal("associate", &body).await,
        validation(&detail, json!([fault]))
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn truth_without_detections_is_refused() {
    let api = Api::start().await;
    let truth = api
        .dataset("time_s,truth_id,x_m,y_m\n0,t,1,2\n1,t,2,3\n")
        .await;
    let tracks = api
        .dataset("time_s,track_id,x_m,y_m\n0,1,1,2\n1,1,2,3\n")
        .await;
    let data = |id| json!({"source": "dataset", "dataset_id": id});
    let body = json!({"tracks": data(tracks), "truth": data(truth), "tfa": {"symbols": {"kind": "detection_id"}}});
    let answer = api.post("/v1/jobs/evaluate", &body).await;
    let detail = "'detections' is required when the symbols are detection_id";
    assert_eq!(
        answer.problem(),
        validation(
            detail,
            json!([{"pointer": "/detections", "code": "missing", "detail": detail}])
        )
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn a_dataset_of_the_wrong_kind_is_refused() {
    let api = Api::start().await;
    let truth = api
        .dataset("time_s,truth_id,x_m,y_m\n0,t,1,2\n1,t,2,3\n")
        .await;
    let answer = api
        .post(
            "/v1/jobs/associate",
            &json!({"input": {"source": "dataset", "dataset_id": truth}}),
        )
        .await;
    let detail = format!("dataset '{truth}' holds truth, not detections");
    let fault = json!({"pointer": "/input/dataset_id", "code": "conflict", "detail": detail, "allowed": "detections"});
    assert_eq!(answer.problem(), validation(&detail, json!([fault])));
}

#[tokio::test(flavor = "multi_thread")]
async fn a_job_that_needs_a_failed_job_fails_and_says_so() {
    let api = Api::start().await;
    let failed = api.run("associate", &failing(&api).await).await;
    assert_eq!(failed["state"], "failed");
    assert_eq!(failed["error"]["code"], "validation");
    let detail = "the truth are directions (bearing_deg), and tracks of the filter 'kalman' cannot begin at them";
    assert_eq!(failed["error"]["errors"][0]["detail"], detail);
    let needs = api
        .run(
            "evaluate",
            &json!({"tracks": {"source": "job", "job_id": id(&failed)}}),
        )
        .await;
    assert_eq!(needs["state"], "failed");
    let detail = format!("job {}, whose result this job needs, failed", id(&failed));
    assert_eq!(
        needs["error"],
        problem(
            "dependency_failed",
            409,
            "A job that this job needs did not succeed",
            &detail
        )
    );
    let report = api.get(&format!("/v1/jobs/{}/report", id(&needs))).await;
    let expected = problem(
        "job_failed",
        409,
        "The job ended without a result",
        "the job failed; its error says why",
    );
    assert_eq!(report.problem(), expected);
}

#[tokio::test(flavor = "multi_thread")]
async fn json_that_is_broken_is_refused_with_line_and_column() {
    let api = Api::start().await;
    let request = api
        .request(reqwest::Method::POST, "/v1/jobs/associate")
        .header("content-type", "application/json");
    let answer = crate::helpers::send(request.body("{\"input\":\n {]}")).await;
    let detail = "the body is not JSON: key must be a string at line 2 column 3";
    assert_eq!(
        answer.problem(),
        problem("malformed_json", 400, "The body is not JSON", detail)
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn a_check_tells_faults_as_its_answer_and_queues_nothing() {
    let api = Api::start().await;
    let good = api
        .post(
            "/v1/validate",
            &json!({"kind": "simulate", "spec": small()}),
        )
        .await
        .ok(200);
    assert_eq!(
        (&good["valid"], &good["errors"]),
        (&json!(true), &json!([]))
    );
    assert!(good["estimate"]["detections"].as_u64().unwrap() > 20);
    let bad = api
        .post(
            "/v1/validate",
            &json!({"kind": "simulate", "spec": {"scenario": 3}}),
        )
        .await
        .ok(200);
    let fault = json!({"pointer": "/scenario", "code": "wrong_type", "detail": "expected an object, found a number", "allowed": "an object"});
    assert_eq!(
        bad,
        json!({"valid": false, "errors": [fault], "warnings": []})
    );
    let wrong = api
        .post(
            "/v1/validate",
            &json!({"kind": "sing", "song": 1, "spec": {}}),
        )
        .await;
    let kinds = "simulate, associate, evaluate, group, correlate, campaign";
    let faults = json!([
        {"pointer": "/kind", "code": "unknown_value", "detail": "unknown kind \"sing\"", "allowed": kinds},
        {"pointer": "/song", "code": "unknown_field", "detail": "unknown field 'song'", "allowed": "kind, spec"}
    ]);
    assert_eq!(wrong.problem(), validation("2 faults", faults));
    assert_eq!(api.get("/v1/jobs?count=true").await.ok(200)["total"], 0);
}
