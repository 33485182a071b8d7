//! What HTTP itself can refuse, and what every answer carries.

use crate::helpers::{Api, problem, send, small, validation};
use axum::routing::get;
use reqwest::Method;
use serde_json::json;

#[tokio::test(flavor = "multi_thread")]
async fn a_path_that_is_nothing_is_a_problem() {
    let api = Api::start().await;
    let expected = problem(
        "not_found",
        404,
        "There is no such thing",
        "there is nothing at /v1/nothing",
    );
    assert_eq!(api.get("/v1/nothing").await.problem(), expected);
    assert_eq!(
        api.get_with(
            "/v1/nothing",
            "accept",
            "text/html,application/problem+json"
        )
        .await
        .problem(),
        expected
    );
    let answer = api.get("/v1/jobs/not-an-id").await;
    assert_eq!(
        answer.problem(),
        problem(
            "not_found",
            404,
            "There is no such thing",
            "'not-an-id' is not the id of anything"
        )
    );
    let answer = api
        .get("/v1/jobs/0199e0a4-7c00-7000-8000-000000000001")
        .await;
    assert_eq!(
        answer.problem(),
        problem(
            "not_found",
            404,
            "There is no such thing",
            "there is no such job"
        )
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn a_method_that_is_not_allowed_is_a_problem_that_names_the_others() {
    let api = Api::start().await;
    let answer = send(api.request(Method::PUT, "/v1/jobs")).await;
    let expected = problem(
        "method_not_allowed",
        405,
        "The method is not allowed here",
        "the header Allow names the methods that are",
    );
    assert_eq!(answer.problem(), expected);
    assert_eq!(answer.header("allow"), "POST,GET,HEAD");
}

#[tokio::test(flavor = "multi_thread")]
async fn a_body_of_another_type_is_refused() {
    let api = Api::start().await;
    let request = api
        .request(Method::POST, "/v1/jobs/simulate")
        .header("content-type", "text/csv")
        .body("a,b");
    let title = "The media type is not supported";
    let expected = problem(
        "unsupported_media_type",
        415,
        title,
        "the body must be application/json, not 'text/csv'",
    );
    assert_eq!(send(request).await.problem(), expected);
    let detail = "the body must be multipart/form-data with the parts 'meta' and 'file'";
    assert_eq!(
        api.post("/v1/datasets", &json!({})).await.problem(),
        problem("unsupported_media_type", 415, title, detail)
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn a_json_body_over_the_limit_is_refused_announced_or_not() {
    let api = Api::start().await;
    let expected = problem(
        "payload_too_large",
        413,
        "The body is too large",
        "the body is larger than 1048576 bytes",
    );
    let body = vec![b' '; 1_100_000];
    let announced = api
        .request(Method::POST, "/v1/jobs/simulate")
        .header("content-type", "application/json")
        .body(body.clone());
    assert_eq!(send(announced).await.problem(), expected);
    let chunks = futures::stream::iter(
        body.chunks(50_000)
            .map(|chunk| Ok::<_, std::io::Error>(chunk.to_vec()))
            .collect::<Vec<_>>(),
    );
    let streamed = api
        .request(Method::POST, "/v1/jobs/simulate")
        .header("content-type", "application/json");
    assert_eq!(
        send(streamed.body(reqwest::Body::wrap_stream(chunks)))
            .await
            .problem(),
        expected
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn a_client_that_reads_no_json_is_refused_before_anything_happens() {
    let api = Api::start().await;
    let answer = api
        .post_with("/v1/jobs/simulate", &small(), "accept", "text/csv")
        .await;
    let expected = problem(
        "not_acceptable",
        406,
        "No representation is acceptable",
        "the answer here is application/json",
    );
    assert_eq!(answer.problem(), expected);
    assert_eq!(api.get("/v1/jobs?count=true").await.ok(200)["total"], 0);
    assert_eq!(
        api.get_with("/v1/version", "accept", "image/png")
            .await
            .problem(),
        expected
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn a_panic_is_a_problem_that_tells_nothing() {
    async fn fall() -> &'static str {
        panic!("a secret")
    }
    let api = Api::start_wrapped(|_| {}, |application| application.route("/fall", get(fall))).await;
    let expected = problem(
        "internal",
        500,
        "An error inside the service",
        "the service could not do it; its log says why",
    );
    assert_eq!(api.get("/fall").await.problem(), expected);
    assert_eq!(api.get("/healthz").await.ok(200), json!({"status": "ok"}));
}

#[tokio::test(flavor = "multi_thread")]
async fn queries_are_read_strictly() {
    let api = Api::start().await;
    let answer = api
        .get("/v1/jobs?state=queued,asleep&limit=0&label=x&page=2&q=a&q=b&created_after=noon")
        .await;
    let names = "state, kind, label, created_after, created_before, q, sort, limit, cursor, count";
    let faults = json!([
        {"pointer": "/query/state", "code": "unknown_value", "detail": "'asleep' is not a value of 'state'",
         "allowed": "queued, running, succeeded, failed, canceled"},
        {"pointer": "/query/label", "code": "unknown_value", "detail": "'x' is not a value of 'label'", "allowed": "key:value"},
        {"pointer": "/query/created_after", "code": "unknown_value", "detail": "'noon' is not a value of 'created_after'",
         "allowed": "an RFC 3339 time such as 2026-01-31T12:00:00Z"},
        {"pointer": "/query/q", "code": "duplicate", "detail": "the parameter is given more than once", "allowed": "once"},
        {"pointer": "/query/limit", "code": "unknown_value", "detail": "'0' is not a value of 'limit'", "allowed": "[1, 200]"},
        {"pointer": "/query/page", "code": "unknown_field", "detail": "unknown query parameter 'page'", "allowed": names}
    ]);
    assert_eq!(answer.problem(), validation("6 faults", faults));
    let answer = api.get("/v1/version?verbose=1").await;
    let fault = json!({"pointer": "/query/verbose", "code": "unknown_field", "detail": "unknown query parameter 'verbose'",
        "allowed": "no parameter"});
    assert_eq!(
        answer.problem(),
        validation("unknown query parameter 'verbose'", json!([fault]))
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn every_answer_is_named_and_guarded() {
    let api = Api::start().await;
    for path in ["/v1/version", "/v1/nothing", "/", "/docs/", "/metrics"] {
        let answer = api.get(path).await;
        assert!(answer.header("x-request-id").len() == 36, "{path}");
        assert_eq!(answer.header("x-content-type-options"), "nosniff", "{path}");
        let policy = "default-src 'self'; img-src 'self' data: blob:; style-src 'self' 'unsafe-inline'; frame-ancestors 'none'";
        assert_eq!(answer.header("content-security-policy"), policy, "{path}");
    }
    assert_eq!(
        api.get_with("/v1/nothing", "x-request-id", "mine-7")
            .await
            .json()["request_id"],
        "mine-7"
    );
}
