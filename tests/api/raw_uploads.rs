//! A file as the body of a request, what is known of it in the query.

use crate::helpers::{Answer, Api, eventually, problem, send, validation};
use futures::stream;
use reqwest::{Body, Method};
use serde_json::{Value, json};

const DETECTIONS: &str = "time_s,scan,sensor_id,detection_id,x_m,y_m\n0,1,radar,a,1,2\n8,2,radar,b,3,4\n8,2,radar,c,5,6\n";

async fn upload(
    api: &Api,
    query: &[(&str, &str)],
    media_type: &str,
    body: impl Into<Body>,
) -> Answer {
    let query: String = query
        .iter()
        .map(|(name, value)| format!("{name}={}&", encoded(value)))
        .collect();
    let request = api
        .request(Method::POST, &format!("/v1/datasets/raw?{query}"))
        .body(body);
    send(if media_type.is_empty() {
        request
    } else {
        request.header("content-type", media_type)
    })
    .await
}

/// Every byte written as its number.
fn encoded(text: &str) -> String {
    text.bytes().map(|byte| format!("%{byte:02X}")).collect()
}

#[tokio::test(flavor = "multi_thread")]
async fn a_raw_body_becomes_the_dataset_that_a_form_would() {
    let api = Api::start().await;
    let meta = json!({"name": "trial", "sensors": [{"sensor_id": "radar", "p_d": 0.8}]});
    let of_form = api.upload(&meta, DETECTIONS).await.ok(201);
    let sensors = meta["sensors"].to_string();
    let query = [
        ("name", "trial"),
        ("sensors", &*sensors),
        ("file_name", "file.csv"),
    ];
    for media_type in ["application/octet-stream", "text/csv; charset=utf-8", ""] {
        let answer = upload(&api, &query, media_type, DETECTIONS).await;
        assert_eq!(answer.ok(200), of_form, "{media_type}");
        assert_eq!(answer.header("location"), of_form["links"]["self"]);
    }
    let other = upload(&api, &[("file_name", "trial.csv")], "text/csv", DETECTIONS)
        .await
        .ok(201);
    assert_eq!(
        (&other["name"], &other["origin"]["file_name"]),
        (&json!("trial.csv"), &json!("trial.csv"))
    );
    // Generated clients accept JSON where a refusal may be JSON, and get the file all the same.
    let content = api
        .get_with(
            other["links"]["content"].as_str().unwrap(),
            "accept",
            "application/problem+json",
        )
        .await;
    assert_eq!(
        (
            content.status.as_u16(),
            content.header("content-type"),
            &*content.text
        ),
        (200, "text/csv", DETECTIONS)
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn columns_kind_and_format_of_the_query_are_used() {
    let api = Api::start().await;
    let renamed = DETECTIONS.replace("x_m", "east");
    let query = [
        ("columns", r#"{"east":"x_m"}"#),
        ("kind", "detections"),
        ("format", "csv"),
    ];
    assert_eq!(
        upload(&api, &query, "text/csv", renamed).await.ok(201)["rows"],
        3
    );
    let boxes = "1,3,10,20,5,6,1,-1,-1,-1\n2,3,11,20,5,6,1,-1,-1,-1\n";
    assert_eq!(
        upload(&api, &[("kind", "truth")], "text/plain", boxes)
            .await
            .ok(201)["format"],
        "mot"
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn faults_of_the_query_are_told_at_once_and_those_of_the_file_at_their_lines() {
    let api = Api::start().await;
    let long = "x".repeat(256);
    let query = [
        ("kind", "stars"),
        ("sensors", r#"[{"p_d": 2}]"#),
        ("columns", "{"),
        ("colour", "1"),
        ("file_name", &*long),
    ];
    let refused = upload(&api, &query, "text/csv", DETECTIONS).await.problem();
    let faults: Vec<(&str, &str)> = refused["errors"]
        .as_array()
        .unwrap()
        .iter()
        .map(|fault| {
            (
                fault["pointer"].as_str().unwrap(),
                fault["code"].as_str().unwrap(),
            )
        })
        .collect();
    let expected = [
        ("/query/columns", "malformed"),
        ("/query/file_name", "too_large"),
        ("/query/kind", "unknown_value"),
        ("/query/sensors/0/sensor_id", "missing"),
        ("/query/sensors/0/p_d", "out_of_range"),
        ("/query/colour", "unknown_field"),
    ];
    assert_eq!(faults, expected);
    let bad_line = DETECTIONS.replace("3,4", "3,x");
    let detail = "expected a number, found 'x'";
    let fault =
        json!({"pointer": "", "code": "malformed", "detail": detail, "line": 3, "column": "y_m"});
    assert_eq!(
        upload(&api, &[], "text/csv", bad_line).await.problem(),
        validation(detail, json!([fault]))
    );
    let unlike = upload(
        &api,
        &[("format", "npy"), ("kind", "truth")],
        "",
        DETECTIONS,
    )
    .await
    .problem();
    assert_eq!(unlike["errors"][0]["pointer"], "/query/kind");
    assert_eq!(api.get("/v1/datasets?count=true").await.ok(200)["total"], 0);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_form_and_other_types_are_no_file() {
    let api = Api::start().await;
    for media_type in [
        "multipart/form-data; boundary=x",
        "application/x-www-form-urlencoded",
    ] {
        let answer = upload(&api, &[], media_type, DETECTIONS).await;
        assert_eq!(
            answer.header("accept"),
            "application/gpx+xml, application/json, application/octet-stream, application/vnd.apache.arrow.file, application/vnd.apache.parquet, text/csv, text/plain"
        );
        assert_eq!(
            answer.problem()["code"],
            "unsupported_media_type",
            "{media_type}"
        );
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn a_raw_body_over_the_limit_is_refused_announced_or_not_and_one_that_breaks_off_leaves_nothing()
 {
    let api = Api::start_with(|config| config.max_upload_bytes = 100_000).await;
    let files = || {
        std::fs::read_dir(api.jobs.datasets().temp_dir())
            .unwrap()
            .count()
    };
    let expected = problem(
        "payload_too_large",
        413,
        "The body is too large",
        "the body is larger than 100000 bytes",
    );
    assert_eq!(
        upload(&api, &[], "text/csv", "x".repeat(6_000_000))
            .await
            .problem(),
        expected,
        "by its length"
    );
    let chunks = stream::iter((0..50).map(|_| Ok::<_, std::io::Error>(vec![b'x'; 10_000])));
    assert_eq!(
        upload(&api, &[], "text/csv", Body::wrap_stream(chunks))
            .await
            .problem(),
        expected,
        "by counting"
    );
    assert_eq!(files(), 0);
    let first = stream::iter([Ok::<_, std::io::Error>(DETECTIONS.as_bytes().to_vec())]);
    let endless = Body::wrap_stream(futures::StreamExt::chain(first, stream::pending()));
    let request = api
        .request(Method::POST, "/v1/datasets/raw")
        .header("content-type", "text/csv")
        .body(endless);
    let broken = tokio::spawn(request.send());
    eventually(|| files() == 1).await;
    broken.abort();
    eventually(|| files() == 0).await;
    assert_eq!(
        api.get("/v1/datasets?count=true").await.ok(200)["total"],
        Value::from(0)
    );
}
