//! Requests that ask for too much or say too much: each is refused at once, by name, in few words.

use crate::helpers::{Answer, Api, id, problem, send, small, validation};
use reqwest::Method;
use reqwest::multipart::{Form, Part};
use serde_json::{Value, json};
use std::time::{Duration, Instant};

async fn one_fault(api: &Api, path: &str) -> (String, String, String) {
    let problem = api.get(path).await.problem();
    assert_eq!(
        problem["errors"].as_array().unwrap().len(),
        1,
        "{path}: {problem}"
    );
    let text = |name: &str| {
        problem["errors"][0][name]
            .as_str()
            .unwrap_or_default()
            .to_owned()
    };
    (text("pointer"), text("code"), text("detail"))
}

#[tokio::test(flavor = "multi_thread")]
async fn a_list_is_narrowed_by_sixteen_labels_at_most() {
    let api = Api::start().await;
    let query = |count: usize| {
        (0..count)
            .map(|index| format!("label=k{index}:v"))
            .collect::<Vec<_>>()
            .join("&")
    };
    api.get(&format!("/v1/jobs?{}", query(16))).await.ok(200);
    for count in [17, 1100] {
        let since = Instant::now();
        let fault = json!({"pointer": "/query/label", "code": "too_large", "detail": format!("{count} labels are named"), "allowed": "at most 16 labels"});
        let answer = api.get(&format!("/v1/jobs?{}", query(count))).await;
        assert_eq!(
            answer.problem(),
            validation(&format!("{count} labels are named"), json!([fault]))
        );
        assert!(
            since.elapsed() < Duration::from_secs(2),
            "{:?}",
            since.elapsed()
        );
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn long_lists_and_texts_in_a_query_are_refused_in_few_words() {
    let api = Api::start().await;
    let repeated = format!("/v1/jobs?state={}", vec!["queued"; 9000].join(","));
    let of = |pointer: &str, code: &str, detail: &str| {
        (pointer.to_owned(), code.to_owned(), detail.to_owned())
    };
    let twice = "a value is named more than once";
    assert_eq!(
        one_fault(&api, &repeated).await,
        of("/query/state", "duplicate", twice)
    );
    assert_eq!(
        one_fault(&api, "/v1/jobs?kind=group,group").await,
        of("/query/kind", "duplicate", twice)
    );
    assert_eq!(
        one_fault(&api, "/v1/datasets?kind=truth,tracks,truth").await,
        of("/query/kind", "duplicate", twice)
    );
    for list in ["jobs", "datasets"] {
        api.get(&format!("/v1/{list}?q={}", "ü".repeat(200)))
            .await
            .ok(200);
        assert_eq!(
            one_fault(&api, &format!("/v1/{list}?q={}", "ü".repeat(201))).await,
            of("/query/q", "too_large", "the text is too long")
        );
    }
    let many: String = (0..5000).map(|index| format!("x{index}=1&")).collect();
    let answer = api.get(&format!("/v1/version?{many}")).await;
    let faults = answer.problem()["errors"].as_array().unwrap().clone();
    assert_eq!(
        (faults.len(), &faults[100]),
        (
            101,
            &json!({"pointer": "", "code": "too_many", "detail": "4900 more faults are not listed"})
        )
    );
    assert!(answer.text.len() < 20_000, "{}", answer.text.len());
}

#[tokio::test(flavor = "multi_thread")]
async fn queries_are_text_without_control_characters() {
    let api = Api::start().await;
    let of = |pointer: &str, code: &str, detail: &str| {
        (pointer.to_owned(), code.to_owned(), detail.to_owned())
    };
    for list in ["jobs", "datasets"] {
        assert_eq!(
            one_fault(&api, &format!("/v1/{list}?q=%ff")).await,
            of("/query/q", "malformed", "the value of 'q' is not UTF-8")
        );
        let control = "the text has the control character U+0000 at character 2";
        assert_eq!(
            one_fault(&api, &format!("/v1/{list}?q=a%00")).await,
            of("/query/q", "control_character", control)
        );
    }
    let control = "the text has the control character U+001F at character 4";
    assert_eq!(
        one_fault(&api, "/v1/jobs?label=a:b%1f").await,
        of("/query/label", "control_character", control)
    );
    assert_eq!(
        one_fault(&api, "/v1/jobs?%ff=1").await,
        of(
            "/query",
            "malformed",
            "the name of a parameter is not UTF-8"
        )
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn texts_of_a_body_have_no_control_characters() {
    let api = Api::start().await;
    let mut body = small();
    body["name"] = json!("a\u{0}b");
    body["labels"] = json!({"k\u{0}": "v", "site": "\n"});
    body["scenario"]["sensors"][0]["sensor_id"] = json!("\u{1f}");
    let control = |pointer: &str, what: &str| {
        let detail = format!("the text has the control character {what}");
        json!({"pointer": pointer, "code": "control_character", "detail": detail, "allowed": "no character from U+0000 to U+001F"})
    };
    let faults = json!([
        control("/name", "U+0000 at character 2"),
        control("/labels/k\u{0}", "U+0000 at character 2"),
        control("/labels/site", "U+000A at character 1"),
        control("/scenario/sensors/0/sensor_id", "U+001F at character 1")
    ]);
    assert_eq!(
        api.post("/v1/jobs/simulate", &body).await.problem(),
        validation("4 faults", faults)
    );
    let job = api.post("/v1/jobs/simulate", &small()).await.ok(202);
    let patch = api
        .request(Method::PATCH, &format!("/v1/jobs/{}", id(&job)))
        .json(&json!({"name": "\u{0}"}));
    assert_eq!(
        send(patch).await.problem()["errors"],
        json!([control("/name", "U+0000 at character 1")])
    );
    let dataset = json!({"input": {"source": "dataset", "dataset_id": "\u{0}"}});
    let refused = api.post("/v1/jobs/associate", &dataset).await.problem();
    assert_eq!(
        refused["errors"][0],
        control("/input/dataset_id", "U+0000 at character 1")
    );
    let upload = api
        .upload(&json!({"name": "\t"}), "time_s,truth_id,x_m,y_m\n0,t,1,2\n")
        .await
        .problem();
    assert_eq!(
        upload["errors"],
        json!([control("/meta/name", "U+0009 at character 1")])
    );
}

async fn post_text(api: &Api, path: &str, body: &str) -> Answer {
    send(
        api.request(Method::POST, path)
            .header("content-type", "application/json")
            .body(body.to_owned()),
    )
    .await
}

#[tokio::test(flavor = "multi_thread")]
async fn a_member_that_is_given_twice_is_refused() {
    let api = Api::start().await;
    let body = small().to_string().replacen('{', "{\"seed\": 1,", 1);
    let fault = |pointer: &str, name: &str| {
        let detail = format!("the member '{name}' is given more than once");
        json!({"pointer": pointer, "code": "duplicate", "detail": detail, "allowed": "each member once"})
    };
    let detail = "the member 'seed' is given more than once";
    assert_eq!(
        post_text(&api, "/v1/jobs/simulate", &body).await.problem(),
        validation(detail, json!([fault("/seed", "seed")]))
    );
    let nested = r#"{"kind": "simulate", "spec": {"scenario": {"scans": 1, "scans": 2}}}"#;
    assert_eq!(
        post_text(&api, "/v1/validate", nested).await.problem()["errors"],
        json!([fault("/spec/scenario/scans", "scans")])
    );
    let form = Form::new()
        .part("meta", Part::text(r#"{"name": "a", "name": "b"}"#))
        .part("file", Part::text("x"));
    assert_eq!(
        api.upload_form(form).await.problem()["errors"],
        json!([fault("/meta/name", "name")])
    );
    assert_eq!(api.get("/v1/jobs?count=true").await.ok(200)["total"], 0);
}

#[tokio::test(flavor = "multi_thread")]
async fn compressed_bodies_are_called_that() {
    let api = Api::start().await;
    let title = "The media type is not supported";
    let gzip = b"\x1f\x8b\x08\x00\x00\x00\x00\x00\x00\x03\x03\x00\x00\x00\x00\x00\x00\x00\x00\x00"
        .to_vec();
    let json_body = || {
        api.request(Method::POST, "/v1/jobs/simulate")
            .header("content-type", "application/json")
            .body(gzip.clone())
    };
    let answer = send(json_body()).await;
    let detail = "the body is compressed (gzip); send it as it is";
    assert_eq!(
        answer.problem(),
        problem("unsupported_media_type", 415, title, detail)
    );
    assert_eq!(answer.header("accept-encoding"), "identity");
    let answer = send(json_body().header("content-encoding", "gzip")).await;
    let detail = "the body is encoded as 'gzip'; send it as it is, without Content-Encoding";
    assert_eq!(
        answer.problem(),
        problem("unsupported_media_type", 415, title, detail)
    );
    assert_eq!(answer.header("accept-encoding"), "identity");
    let upload =
        |bytes: &[u8]| Form::new().part("file", Part::bytes(bytes.to_vec()).file_name("a.csv.gz"));
    for (bytes, name) in [
        (&b"PK\x03\x04rest"[..], "zip"),
        (b"\xfd7zXZ\x00rest", "xz"),
        (b"BZh91AY", "bzip2"),
    ] {
        let answer = api.upload_form(upload(bytes)).await;
        let detail = format!("the file is compressed ({name}); upload it unpacked");
        assert_eq!(
            answer.problem(),
            problem("unsupported_media_type", 415, title, &detail)
        );
        assert_eq!(
            std::fs::read_dir(api.jobs.datasets().temp_dir())
                .unwrap()
                .count(),
            0
        );
    }
    let plain = api
        .request(Method::POST, "/v1/jobs/simulate")
        .header("content-encoding", "identity")
        .json(&small());
    send(plain).await.ok(202);
}

#[tokio::test(flavor = "multi_thread")]
async fn names_of_files_and_parts_are_short() {
    let api = Api::start().await;
    let upload = |name: String| {
        Form::new().part(
            "file",
            Part::bytes(b"time_s,truth_id,x_m,y_m\n0,t,1,2\n1,t,2,3\n".to_vec()).file_name(name),
        )
    };
    let fault = |bytes: usize| {
        let detail = format!("the name of the file has {bytes} bytes");
        validation(
            &detail,
            json!([{"pointer": "/file", "code": "too_large", "detail": detail, "allowed": "at most 255 bytes"}]),
        )
    };
    assert_eq!(
        api.upload_form(upload("ü".repeat(128))).await.problem(),
        fault(256)
    );
    let kept = api
        .upload_form(upload(format!("{}\".csv", "ü".repeat(125))))
        .await
        .ok(201);
    let content = api
        .get(&format!("/v1/datasets/{}/content", id(&kept)))
        .await;
    let disposition = content.header("content-disposition").to_owned();
    assert!(
        disposition.starts_with("attachment; filename=\"___")
            && disposition.is_ascii()
            && disposition.len() < 1100,
        "{disposition}"
    );
    let form = Form::new().part("p".repeat(1_000_000), Part::text("x"));
    let answer = api.upload_form(form).await;
    assert!(answer.text.len() < 1000, "{} bytes", answer.text.len());
    let mut body = small();
    body["f".repeat(500_000)] = json!(1);
    let answer = api.post("/v1/jobs/simulate", &body).await;
    assert_eq!(answer.problem()["errors"][0]["code"], "unknown_field");
    assert!(answer.text.len() < 5000, "{} bytes", answer.text.len());
}

#[tokio::test(flavor = "multi_thread")]
async fn edges_of_parameters_are_what_the_document_says() {
    let api = Api::start().await;
    let job = api.run("simulate", &small()).await;
    let path = format!("/v1/jobs/{}", id(&job));
    let largest = i64::MAX as u64;
    api.get(&format!("{path}/history?after={largest}"))
        .await
        .ok(200);
    for events in ["history", "events"] {
        let (pointer, code, _) =
            one_fault(&api, &format!("{path}/{events}?after={}", largest + 1)).await;
        assert_eq!(
            (pointer.as_str(), code.as_str()),
            ("/query/after", "unknown_value")
        );
    }
    let late = api
        .get_with(
            &format!("{path}/events"),
            "last-event-id",
            &(largest + 1).to_string(),
        )
        .await
        .problem();
    assert_eq!(late["errors"][0]["pointer"], "/headers/last-event-id");
    let document = api.get("/openapi.json").await.ok(200);
    let parameter = |operation: &str, name: &str| {
        let parameters = document
            .pointer(&format!(
                "/paths/{}/get/parameters",
                operation.replace('/', "~1")
            ))
            .unwrap();
        let found = parameters
            .as_array()
            .unwrap()
            .iter()
            .find(|parameter| parameter["name"] == name);
        found.unwrap_or_else(|| panic!("{operation} {name}"))["schema"].clone()
    };
    for events in ["history", "events"] {
        assert_eq!(
            parameter(&format!("/v1/jobs/{{id}}/{events}"), "after")["maximum"].as_f64(),
            Some(largest as f64)
        );
    }
    for list in ["/v1/jobs", "/v1/datasets"] {
        assert_eq!(
            one_fault(&api, &format!("{list}?sort=")).await.0,
            "/query/sort"
        );
        assert_eq!(parameter(list, "sort")["minLength"], 1);
        assert_eq!(
            api.get(&format!("{list}?cursor=")).await.problem()["code"],
            "invalid_cursor"
        );
        assert_eq!(parameter(list, "cursor")["minLength"], 1);
    }
    let confidence = parameter("/v1/compare", "confidence");
    assert_eq!(
        (
            confidence["exclusiveMinimum"].as_f64(),
            confidence["exclusiveMaximum"].as_f64()
        ),
        (Some(0.0), Some(1.0))
    );
    assert_eq!(parameter("/v1/jobs", "label")["maxItems"], 16);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_wait_that_is_no_number_is_refused_before_a_job_comes_of_it() {
    let api = Api::start().await;
    let answer = api
        .post_with("/v1/jobs/simulate", &small(), "prefer", "wait=abc")
        .await;
    let detail = "'abc' is not a number of seconds to wait";
    let fault = json!({"pointer": "/headers/prefer", "code": "unknown_value", "detail": detail, "allowed": "wait=n, a whole number of seconds"});
    assert_eq!(answer.problem(), validation(detail, json!([fault])));
    assert_eq!(api.get("/v1/jobs?count=true").await.ok(200)["total"], 0);
    api.post_with(
        "/v1/jobs/simulate",
        &small(),
        "prefer",
        "respond-async, handling=lenient",
    )
    .await
    .ok(202);
}

#[tokio::test(flavor = "multi_thread")]
async fn what_is_not_there_is_told_with_what_is() {
    let api = Api::start().await;
    let job = api.run("simulate", &small()).await;
    let path = format!("/v1/jobs/{}", id(&job));
    let detail = |answer: &Answer| answer.problem()["detail"].as_str().unwrap().to_owned();
    let files = api.get(&format!("{path}/artifacts")).await.ok(200)["items"].clone();
    let names: Vec<&str> = files
        .as_array()
        .unwrap()
        .iter()
        .map(|file| file["name"].as_str().unwrap())
        .collect();
    let answer = api.get(&format!("{path}/artifacts/foo.csv")).await;
    assert_eq!(
        detail(&answer),
        format!("the job has no file 'foo.csv'; it has {}", names.join(", "))
    );
    assert_eq!(answer.status, 404);
    let answer = api.get(&format!("{path}/cells")).await;
    assert_eq!(
        (answer.status.as_u16(), detail(&answer).as_str()),
        (
            404,
            "the job is of the kind 'simulate'; only a campaign has cells"
        )
    );
    let one = "0199e0a4-7c00-7000-8000-000000000001";
    let two = "0199e0a4-7c00-7000-8000-000000000002";
    let gone = api
        .post_with("/v1/jobs/simulate", &small(), "prefer", "wait=30")
        .await
        .json();
    assert_eq!(
        api.delete(&format!("/v1/jobs/{}", id(&gone))).await.status,
        204
    );
    let answer = api
        .get(&format!(
            "/v1/compare?job={one}&job={}&job={two}&job={}",
            id(&job),
            id(&gone)
        ))
        .await;
    let expected = format!(
        "there is no job '{one}'; there is no job '{two}'; job '{}' has been deleted",
        id(&gone)
    );
    assert_eq!((answer.status.as_u16(), detail(&answer)), (404, expected));
    let answer = api
        .get(&format!("/v1/compare?job=abc&job={}&job=x", id(&job)))
        .await
        .problem();
    let details: Vec<&Value> = answer["errors"]
        .as_array()
        .unwrap()
        .iter()
        .map(|fault| &fault["detail"])
        .collect();
    assert_eq!(
        details,
        ["'abc' is not the id of a job", "'x' is not the id of a job"]
    );
    let answer = api.get("/v1/methods/gater/x").await;
    assert!(
        detail(&answer).starts_with("there is no family 'gater'; there are associator, "),
        "{}",
        detail(&answer)
    );
    assert!(
        detail(&api.get("/v1/methods/associator/owl").await)
            .contains("there is no method 'owl'; there are nearest_neighbour, ")
    );
    assert!(
        detail(&api.get("/v1/presets/x").await)
            .starts_with("there is no preset 'x'; there are liang2009-10, ")
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn documents_that_stay_the_same_are_fetched_once() {
    let api = Api::start().await;
    for path in [
        "/v1/methods",
        "/v1/methods/associator/jpda",
        "/v1/presets",
        "/v1/presets/liang2009-10",
        "/problems",
        "/problems/gone",
    ] {
        let first = api.get(path).await;
        let tag = first.header("etag").to_owned();
        assert!(tag.len() > 40 && first.status == 200, "{path}: {tag}");
        let again = api.get_with(path, "if-none-match", &tag).await;
        assert_eq!(
            (
                again.status.as_u16(),
                again.text.as_str(),
                again.header("etag")
            ),
            (304, "", tag.as_str()),
            "{path}"
        );
        assert_eq!(api.get(path).await.text, first.text);
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn invented_methods_are_counted_as_one() {
    let api = Api::start().await;
    for index in 0..50 {
        let method = Method::from_bytes(format!("M{index:07}").as_bytes()).unwrap();
        assert_eq!(send(api.request(method, "/v1/jobs")).await.status, 405);
    }
    let metrics = api.get("/metrics").await.text;
    assert!(
        metrics.contains(
            "trackloom_http_requests_total{method=\"other\",route=\"/v1/jobs\",status=\"405\"}"
        ),
        "{metrics}"
    );
    assert!(!metrics.contains("M0000001"), "{metrics}");
}
