//! Datasets in the formats of other programs.

use crate::helpers::{Api, id, scenario};
use serde_json::json;

/// On the equator a millionth of a degree is 11 cm.
const TRUTH: &str = "time,truth_id,lat_deg,lon_deg\n2016-01-12T13:02:11Z,a,0,10\n2016-01-12T13:02:21Z,a,0,10.000001\n";
const PLANE: &str = "time_s,truth_id,x_m,y_m\n0,a,0,0\n1,a,1,0\n";

#[tokio::test(flavor = "multi_thread")]
async fn a_dataset_is_written_in_the_format_that_is_asked_for() {
    let api = Api::start().await;
    let content = format!("/v1/datasets/{}/content", api.dataset(TRUTH).await);
    let answer = api.get(&format!("{content}?format=geojson")).await;
    let feature = answer.ok(200)["features"][0].clone();
    assert_eq!(answer.header("content-type"), "application/geo+json");
    assert_eq!(
        answer.header("content-disposition"),
        "attachment; filename=\"file.geojson\"; filename*=UTF-8''file.geojson"
    );
    assert_eq!(
        answer.header("content-length"),
        answer.text.len().to_string()
    );
    assert_eq!(
        feature["geometry"]["coordinates"],
        json!([[10, 0], [10.000001, 0]])
    );
    assert_eq!(feature["properties"]["end"], "2016-01-12T13:02:21Z");
    let kml = api.get(&format!("{content}?format=kml")).await;
    assert_eq!(kml.text.matches("<when>").count(), 2);
    assert_eq!(
        api.get(&content).await.text,
        TRUTH,
        "without a format as uploaded"
    );
    let known = api.get(&format!("{content}?format=xml")).await.problem();
    assert_eq!(known["errors"][0]["pointer"], "/query/format");
    assert!(
        known["errors"][0]["allowed"]
            .as_str()
            .unwrap()
            .starts_with("csv, json, geojson")
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn what_a_format_lacks_is_told_with_those_that_do() {
    let api = Api::start().await;
    let content = format!("/v1/datasets/{}/content", api.dataset(PLANE).await);
    for (format, code, allowed) in [
        ("geojson", "no_frame", "`origin`"),
        ("mot", "unsupported", "geojson"),
        ("stonesoup_polar", "unsupported", "csv, json, geojson"),
    ] {
        let answer = api.get(&format!("{content}?format={format}")).await;
        assert_eq!(answer.problem()["status"], 422, "{format}");
        let fault = answer.problem()["errors"][0].clone();
        assert_eq!(fault["code"], code, "{format}");
        assert_eq!(fault["pointer"], "/query/format", "{format}");
        assert!(
            fault["allowed"].as_str().unwrap().contains(allowed),
            "{fault}"
        );
    }
    let meta = json!({"origin": {"lat_deg": 0, "lon_deg": 10}});
    let placed = api.upload(&meta, PLANE).await.ok(201);
    let path = format!("/v1/datasets/{}/content?format=geojson", id(&placed));
    let written = api.get(&path).await.ok(200);
    assert_eq!(
        written["features"][0]["geometry"]["coordinates"][0],
        json!([10, 0])
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn a_file_of_a_job_is_written_where_it_is_a_dataset() {
    let api = Api::start().await;
    let job = api.run("simulate", &json!({"scenario": scenario(3)})).await;
    let files = format!("/v1/jobs/{}/artifacts", id(&job));
    let soup = api
        .get(&format!("{files}/truth.csv?format=stonesoup"))
        .await;
    assert!(
        soup.text.starts_with("time_s,truth_id,x_m,y_m,"),
        "{}",
        soup.text
    );
    let report = api
        .get(&format!("{files}/report.json?format=csv"))
        .await
        .problem();
    assert_eq!(report["errors"][0]["code"], "unsupported");
}
