//! The catalogue, the documents and the numbers.

use crate::helpers::{Api, id};
use serde_json::{Value, json};

#[tokio::test(flavor = "multi_thread")]
async fn methods_come_with_their_parameters() {
    let api = Api::start().await;
    let catalogue = api.get("/v1/methods").await.ok(200);
    let families: Vec<&str> = catalogue["families"]
        .as_array()
        .unwrap()
        .iter()
        .map(|family| family["family"].as_str().unwrap())
        .collect();
    assert_eq!(families, ["associator", "filter", "grouper", "correlator"]);
    for kind in ["simulate", "associate", "evaluate"] {
        assert_eq!(
            catalogue["requests"][kind]["additionalProperties"], false,
            "{kind}"
        );
    }
    for family in catalogue["families"].as_array().unwrap() {
        for method in family["methods"].as_array().unwrap() {
            let path = format!(
                "/v1/methods/{}/{}",
                family["family"].as_str().unwrap(),
                method["name"].as_str().unwrap()
            );
            assert_eq!(&api.get(&path).await.ok(200), method);
        }
    }
    let noise = &api.get("/v1/methods/filter/kalman").await.ok(200)["parameters"]["properties"]["process_noise_m2ps3"];
    assert_eq!(
        (&noise["x-unit"], &noise["minimum"]),
        (&json!("m²/s³"), &json!(0.0))
    );
    assert_eq!(api.get("/v1/methods/filter/coffee").await.status, 404);
}

#[tokio::test(flavor = "multi_thread")]
async fn every_preset_can_be_posted_as_it_is() {
    let api = Api::start_with(|config| config.slots = 1).await;
    let presets = api.get("/v1/presets").await.ok(200);
    let presets = presets["items"].as_array().unwrap();
    assert!(presets.len() >= 5);
    for preset in presets {
        assert_eq!(preset["body"]["kind"], preset["kind"]);
        assert_eq!(
            api.post("/v1/validate", &preset["body"]).await.ok(200)["valid"],
            true,
            "{}",
            preset["name"]
        );
        assert_eq!(
            &api.get(&format!("/v1/presets/{}", preset["name"].as_str().unwrap()))
                .await
                .ok(200),
            preset
        );
    }
    assert_eq!(api.get("/v1/presets/none").await.status, 404);
}

#[tokio::test(flavor = "multi_thread")]
async fn the_documents_are_those_of_the_program() {
    let api = Api::start().await;
    for (path, version, document) in [
        (
            "/openapi.json",
            "3.1.0",
            trackloom::service::openapi::document(),
        ),
        (
            "/openapi-3.0.json",
            "3.0.3",
            trackloom::service::openapi::document_3_0(),
        ),
    ] {
        let answer = api.get(path).await;
        let served: Value = answer.ok(200);
        assert_eq!((&served["openapi"], &served), (&json!(version), &document));
        assert_eq!(
            api.get_with(path, "if-none-match", answer.header("etag"))
                .await
                .status,
            304
        );
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn the_documentation_page_asks_nobody_else() {
    let api = Api::start().await;
    let page = api.get("/docs/").await;
    assert_eq!(page.status, 200);
    let outside = |part: &&str| part.starts_with("http") || part.starts_with("//");
    assert_eq!(
        page.text.split(['"', '\'']).find(outside),
        None,
        "the page refers to another host"
    );
    let scripts = page
        .text
        .split("src=\"")
        .skip(1)
        .map(|rest| rest.split('"').next().unwrap());
    for script in scripts {
        assert_eq!(
            api.get(&format!("/docs/{}", script.trim_start_matches("./")))
                .await
                .status,
            200,
            "{script}"
        );
    }
    assert!(
        api.get("/docs/swagger-initializer.js")
            .await
            .text
            .contains("/openapi.json")
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn numbers_are_by_route_and_by_state() {
    let api = Api::start().await;
    let job = api.run("simulate", &crate::helpers::small()).await;
    api.get(&format!("/v1/jobs/{}", id(&job))).await.ok(200);
    let text = api.get("/metrics").await.text;
    assert!(
        text.contains("trackloom_jobs{state=\"succeeded\"} "),
        "{text}"
    );
    assert!(
        text.contains(
            "trackloom_http_requests_total{method=\"GET\",route=\"/v1/jobs/{id}\",status=\"200\"}"
        ),
        "{text}"
    );
    assert!(
        text.contains("trackloom_http_request_duration_seconds_bucket{"),
        "{text}"
    );
    assert!(!text.contains(id(&job)), "an id is no label");
    let page = include_str!("../../docs/monitoring.md");
    for line in text.lines().filter_map(|line| line.strip_prefix("# TYPE ")) {
        let (name, kind) = line.split_once(' ').unwrap();
        assert!(
            text.contains(&format!("# HELP {name} ")),
            "{name} has no words"
        );
        assert!(page.contains(&format!("| `{name}` | {kind} |")), "{line}");
    }
    let free = text
        .lines()
        .find_map(|line| line.strip_prefix("trackloom_disk_free_bytes "));
    assert!(free.unwrap().parse::<f64>().unwrap() > 0.0);
}
