//! A job has one shape: the text of a job file is what every route takes.

use crate::helpers::{Api, id, scenario, send, validation};
use reqwest::Method;
use serde_json::{Value, json};

const KINDS: &str = "simulate, associate, evaluate, group, correlate, campaign";

fn job() -> Value {
    json!({"kind": "simulate", "name": "shape", "seed": 3, "scenario": scenario(20)})
}

#[tokio::test(flavor = "multi_thread")]
async fn one_text_is_checked_queued_by_either_route_and_given_back() {
    let api = Api::start().await;
    assert_eq!(
        api.post("/v1/validate", &job()).await.ok(200)["valid"],
        true
    );
    let first = api
        .post_with("/v1/jobs", &job(), "prefer", "wait=30")
        .await
        .ok(200);
    assert_eq!(
        (&first["kind"], &first["name"], &first["state"]),
        (&json!("simulate"), &json!("shape"), &json!("succeeded"))
    );
    let mut without_kind = job();
    without_kind.as_object_mut().unwrap().shift_remove("kind");
    for body in [job(), without_kind] {
        let again = api.run("simulate", &body).await;
        assert_eq!(
            (&again["spec_sha256"], &again["duplicate_of"]),
            (&first["spec_sha256"], &first["id"])
        );
    }
    let spec = api.get(&format!("/v1/jobs/{}/spec", id(&first))).await.text;
    assert!(
        spec.starts_with(r#"{"kind":"simulate","seed":3,"#),
        "{spec}"
    );
    let report = api
        .get(&format!("/v1/jobs/{}/report", id(&first)))
        .await
        .ok(200);
    assert_eq!(report["spec"].to_string(), spec);
    assert_eq!(
        api.post_with("/v1/jobs", &report["spec"], "prefer", "wait=30")
            .await
            .ok(200)["duplicate_of"],
        first["id"]
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn a_key_stands_for_the_job_whichever_route_it_took() {
    let api = Api::start().await;
    let first = api
        .post_with("/v1/jobs", &job(), "idempotency-key", "k")
        .await
        .ok(202);
    let again = api
        .post_with("/v1/jobs/simulate", &job(), "idempotency-key", "k")
        .await;
    assert_eq!(
        (again.header("idempotent-replayed"), &again.json()["id"]),
        ("true", &first["id"])
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn a_kind_that_is_missing_unknown_or_another_is_a_fault() {
    let api = Api::start().await;
    let of = |kind: Value| {
        let mut body = job();
        body["kind"] = kind;
        body
    };
    let missing = json!({"pointer": "/kind", "code": "missing", "detail": "'kind' is required in a job", "allowed": KINDS});
    for path in ["/v1/jobs", "/v1/validate"] {
        let answer = api.post(path, &json!({"scenario": scenario(20)})).await;
        assert_eq!(
            answer.problem(),
            validation("'kind' is required in a job", json!([missing])),
            "{path}"
        );
        let answer = api.post(path, &json!([])).await;
        let fault = json!({"pointer": "", "code": "wrong_type", "detail": "expected an object", "allowed": "an object"});
        assert_eq!(
            answer.problem(),
            validation("expected an object", json!([fault])),
            "{path}"
        );
    }
    for (path, kind, code, detail, allowed) in [
        (
            "/v1/jobs",
            json!("sing"),
            "unknown_value",
            "unknown kind \"sing\"",
            KINDS,
        ),
        (
            "/v1/jobs/simulate",
            json!(7),
            "unknown_value",
            "unknown kind 7",
            KINDS,
        ),
        (
            "/v1/jobs/group",
            json!("simulate"),
            "conflict",
            "the job is of the kind 'simulate', not 'group'",
            "group",
        ),
    ] {
        let fault = json!({"pointer": "/kind", "code": code, "detail": detail, "allowed": allowed});
        assert_eq!(
            api.post(path, &of(kind)).await.problem(),
            validation(detail, json!([fault])),
            "{path}"
        );
    }
    let wrapped = api
        .post("/v1/validate", &json!({"kind": "group", "spec": job()}))
        .await
        .problem();
    assert_eq!(wrapped["errors"][0]["pointer"], "/spec/kind");
    assert_eq!(api.get("/v1/jobs?count=true").await.ok(200)["total"], 0);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_list_of_jobs_is_still_read_where_jobs_are_asked_for() {
    let api = Api::start().await;
    assert_eq!(api.get("/v1/jobs").await.ok(200)["items"], json!([]));
    assert_eq!(
        send(api.request(Method::PUT, "/v1/jobs").json(&job()))
            .await
            .status,
        405
    );
}
