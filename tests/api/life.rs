//! Changing jobs: rename, cancel, run again, delete.

use crate::helpers::{Api, id, long, problem, send, small, validation};
use reqwest::Method;
use serde_json::json;
use std::time::Duration;

#[tokio::test(flavor = "multi_thread")]
async fn name_and_labels_can_be_changed_and_nothing_else() {
    let api = Api::start().await;
    let job = api.run("simulate", &small()).await;
    let path = job["links"]["self"].as_str().unwrap();
    let patch = async |body| send(api.request(Method::PATCH, path).json(&body)).await;
    let changed = patch(json!({"labels": {"paper": "fig3"}})).await.ok(200);
    assert_eq!(
        (&changed["name"], &changed["labels"]),
        (&json!("small"), &json!({"paper": "fig3"}))
    );
    assert_eq!(patch(json!({"name": "new"})).await.ok(200)["name"], "new");
    assert_eq!(patch(json!({"name": ""})).await.ok(200).get("name"), None);
    let refused = patch(json!({"seed": 4, "labels": {"a": 1}})).await;
    let faults = json!([
        {"pointer": "/labels/a", "code": "wrong_type", "detail": "expected a text, found a number", "allowed": "a text"},
        {"pointer": "/seed", "code": "unknown_field", "detail": "unknown field 'seed'", "allowed": "name, labels, pinned"}
    ]);
    assert_eq!(refused.problem(), validation("2 faults", faults));
}

#[tokio::test(flavor = "multi_thread")]
async fn a_running_job_stops_when_it_is_canceled() {
    let api = Api::start().await;
    let job = api.post("/v1/jobs/simulate", &long()).await.ok(202);
    let path = format!("/v1/jobs/{}", id(&job));
    let canceled = send(api.request(Method::POST, &format!("{path}/cancel")))
        .await
        .ok(202);
    assert_eq!(canceled["can_cancel"], false);
    api.jobs
        .wait(id(&job).parse().unwrap(), Duration::from_secs(5))
        .await
        .unwrap();
    assert_eq!(api.get(&path).await.ok(200)["state"], "canceled");
    let again = send(api.request(Method::POST, &format!("{path}/cancel"))).await;
    assert_eq!(again.status, 409);
    assert_eq!(again.problem()["code"], "job_terminal");
    let report = api.get(&format!("{path}/report")).await;
    assert_eq!(report.problem()["code"], "job_failed");
}

#[tokio::test(flavor = "multi_thread")]
async fn a_job_is_deleted_once_it_has_ended_and_is_gone_then() {
    let api = Api::start().await;
    let job = api.post("/v1/jobs/simulate", &long()).await.ok(202);
    let path = format!("/v1/jobs/{}", id(&job));
    let refused = api.delete(&path).await;
    assert_eq!(
        (refused.status.as_u16(), &refused.problem()["code"]),
        (409, &json!("job_active"))
    );
    send(api.request(Method::POST, &format!("{path}/cancel")))
        .await
        .ok(202);
    api.jobs
        .wait(id(&job).parse().unwrap(), Duration::from_secs(5))
        .await
        .unwrap();
    let deleted = api.delete(&path).await;
    assert_eq!((deleted.status.as_u16(), deleted.text.as_str()), (204, ""));
    let gone = problem(
        "gone",
        410,
        "It has been deleted",
        "the job has been deleted",
    );
    assert_eq!(api.get(&path).await.problem(), gone);
    assert_eq!(api.get(&format!("{path}/report")).await.problem(), gone);
    assert_eq!(api.delete(&path).await.problem(), gone);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_rerun_finds_the_same_result_byte_for_byte() {
    let api = Api::start().await;
    let body = json!({"input": {"source": "preset", "preset": "liang2009-30"}, "seed": 9});
    let job = api.run("evaluate", &body).await;
    let path = format!("/v1/jobs/{}/rerun", id(&job));
    let rerun = send(api.request(Method::POST, &path).header("prefer", "wait=30"))
        .await
        .ok(200);
    assert_eq!(rerun["rerun_of"], job["id"]);
    let result = async |id: &str| {
        let text = api.get(&format!("/v1/jobs/{id}/report")).await.text;
        text[text.find("\"result\":").unwrap()..].to_owned()
    };
    let (first, second) = (result(id(&job)).await, result(id(&rerun)).await);
    assert!(first.len() > 1000);
    assert_eq!(first, second);
}
