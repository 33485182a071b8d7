//! Datasets through the front door.

use crate::helpers::{Api, eventually, id, problem, send, validation};
use futures::stream;
use reqwest::multipart::{Form, Part};
use reqwest::{Body, Method};
use serde_json::json;
use std::time::Duration;

const DETECTIONS: &str = "time_s,scan,sensor_id,detection_id,x_m,y_m\n0,1,radar,a,1,2\n8,2,radar,b,3,4\n8,2,radar,c,5,6\n";

#[tokio::test(flavor = "multi_thread")]
async fn an_upload_becomes_a_dataset_that_can_be_read_again() {
    let api = Api::start().await;
    let answer = api
        .upload(
            &json!({"name": "trial", "sensors": [{"sensor_id": "radar", "p_d": 0.8}]}),
            DETECTIONS,
        )
        .await;
    let dataset = answer.ok(201);
    assert_eq!(answer.header("location"), dataset["links"]["self"]);
    for (member, expected) in [
        ("name", json!("trial")),
        ("kind", json!("detections")),
        ("format", json!("csv")),
        ("bytes", json!(DETECTIONS.len())),
        ("sensor_ids", json!(["radar"])),
        ("scans", json!(2)),
        ("rows", json!(3)),
        ("start_s", json!(0.0)),
        ("end_s", json!(8.0)),
        ("origin", json!({"kind": "upload", "file_name": "file.csv"})),
        ("sensors", json!([{"sensor_id": "radar", "p_d": 0.8}])),
    ] {
        assert_eq!(dataset[member], expected, "{member}");
    }
    let content = api.get(dataset["links"]["content"].as_str().unwrap()).await;
    assert_eq!(content.text, DETECTIONS);
    assert_eq!(
        content.header("etag"),
        format!("\"{}\"", dataset["sha256"].as_str().unwrap())
    );
    assert_eq!(
        content.header("content-disposition"),
        "attachment; filename=\"file.csv\"; filename*=UTF-8''file.csv"
    );
    assert_eq!(
        api.get("/v1/datasets?kind=detections&q=tri").await.ok(200)["items"],
        json!([dataset])
    );
    assert_eq!(
        api.get("/v1/datasets?kind=truth").await.ok(200)["items"],
        json!([])
    );
}

/// Of a file with names, units and times of its own, and a wrong line; the next file is read likewise without a word more.
#[tokio::test(flavor = "multi_thread")]
async fn what_an_upload_was_told_reads_the_next_one() {
    let api = Api::start().await;
    let text =
        "ID;Lat;Lon;Alt ft;When\na;50;-1;100;1000\na;50.001;-1;x;2000\na;50.002;-1;110;3000\n";
    let meta = json!({
        "columns": {"ID": "truth_id", "Lat": "lat_deg", "Lon": "lon_deg", "Alt ft": "height_m [ft]", "When": "time_s [ms]"},
        "origin": {"lat_deg": 50, "lon_deg": -1}, "time_base": "utc", "max_rejected": 0.5
    });
    let first = api.upload(&meta, text).await.ok(201);
    let units = json!({"called": "line", "total": 3, "used": 2, "ignored": {}, "rejected": {"malformed": {"count": 1, "first": [3]}}});
    assert_eq!(first["units"], units);
    assert_eq!(first["time_base"], "utc");
    assert_eq!(first["frame"]["lat_deg"], 50.0);
    let reading = &first["reading"];
    assert_eq!(reading["kind"], "truth");
    assert_eq!(reading["format"], "csv");
    assert_eq!(reading["columns"], meta["columns"]);
    assert_eq!(reading["max_rejected"], 0.5);
    // The same word by word: it is the dataset that exists.
    assert_eq!(api.upload(reading, text).await.ok(200)["id"], first["id"]);
    let longer = format!("{text}a;50.003;-1;120;4000\n");
    let next = api.upload(reading, &longer).await.ok(201);
    for member in ["frame", "start_s", "reading"] {
        assert_eq!(next[member], first[member], "{member}");
    }
    assert_eq!((&next["rows"], &next["end_s"]), (&json!(3), &json!(4.0)));
    assert_eq!(
        (first["start_s"].clone(), first["end_s"].clone()),
        (json!(1.0), json!(3.0))
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn a_preview_shows_the_first_rows() {
    let api = Api::start().await;
    let path = format!("/v1/datasets/{}/preview", api.dataset(DETECTIONS).await);
    let preview = api.get(&format!("{path}?limit=2")).await.ok(200);
    assert_eq!(preview["total_rows"], 3);
    assert_eq!(
        preview["columns"],
        json!(["time_s", "scan", "sensor_id", "detection_id", "x_m", "y_m"])
    );
    assert_eq!(
        preview["rows"],
        json!([
            ["0", "1", "radar", "a", "1", "2"],
            ["8", "2", "radar", "b", "3", "4"]
        ])
    );
    assert_eq!(
        api.get(&path).await.ok(200)["rows"]
            .as_array()
            .unwrap()
            .len(),
        3
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn boxes_of_a_video_are_a_dataset_with_a_preview() {
    let api = Api::start().await;
    let rows = "1,3,10,20,5,6,1,-1,-1,-1\n2,3,11,20,5,6,1,-1,-1,-1\n";
    let tracks = api.upload(&json!({"kind": "tracks"}), rows).await.ok(201);
    for (member, expected) in [
        ("kind", json!("tracks")),
        ("format", json!("mot")),
        ("scans", json!(2)),
        ("rows", json!(2)),
        ("objects", json!(1)),
        ("start_s", json!(null)),
    ] {
        assert_eq!(tracks[member], expected, "{member}");
    }
    let preview = api
        .get(&format!(
            "/v1/datasets/{}/preview?limit=1",
            tracks["id"].as_str().unwrap()
        ))
        .await
        .ok(200);
    assert_eq!(preview["total_rows"], 2);
    assert_eq!(
        preview["columns"],
        json!([
            "frame",
            "track_id",
            "left_px",
            "top_px",
            "width_px",
            "height_px",
            "confidence"
        ])
    );
    assert_eq!(
        preview["rows"],
        json!([["1", "3", "10", "20", "5", "6", "1"]])
    );
    // The text does not say whether it is truth or tracks.
    assert_eq!(api.upload(&json!({}), rows).await.status, 422);
}

#[tokio::test(flavor = "multi_thread")]
async fn the_same_upload_again_is_the_same_dataset() {
    let api = Api::start().await;
    let first = api.upload(&json!({"name": "a"}), DETECTIONS).await.ok(201);
    assert_eq!(
        api.upload(&json!({"name": "a"}), DETECTIONS).await.ok(200)["id"],
        first["id"]
    );
    assert_ne!(
        api.upload(&json!({"name": "b"}), DETECTIONS).await.ok(201)["id"],
        first["id"]
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn faults_of_the_parts_are_told_at_once() {
    let api = Api::start().await;
    let refused = api
        .upload(&json!({"kind": "stars", "colour": 1}), DETECTIONS)
        .await;
    let faults = json!([
        {"pointer": "/meta/kind", "code": "unknown_value", "detail": "unknown value \"stars\"", "allowed": "detections, truth, tracks, bearing_time"},
        {"pointer": "/meta/colour", "code": "unknown_field", "detail": "unknown field 'colour'",
         "allowed": "name, kind, format, columns, bearing_time, origin, time_format, encoding, utc_offset_s, clock_offset_s, time_base, date, start, receiver, sites, max_rejected, identity, frame_s, path_gap_s, max_speed_mps, assumed_height_m, test_targets, editions, sensors"}
    ]);
    assert_eq!(refused.problem(), validation("2 faults", faults));
    let missing = api.upload_form(Form::new().text("meta", "{}")).await;
    let fault =
        json!({"pointer": "/file", "code": "missing", "detail": "the part 'file' is required"});
    assert_eq!(
        missing.problem(),
        validation("the part 'file' is required", json!([fault]))
    );
    let unknown = api.upload_form(Form::new().text("data", "x")).await;
    let fault = json!({"pointer": "/data", "code": "unknown_field", "detail": "unknown part 'data'", "allowed": "meta, file"});
    assert_eq!(
        unknown.problem(),
        validation("unknown part 'data'", json!([fault]))
    );
    let broken = api.upload_form(Form::new().text("meta", "{")).await;
    assert_eq!(broken.problem()["code"], "malformed_json");
}

#[tokio::test(flavor = "multi_thread")]
async fn an_upload_over_the_limit_is_refused_announced_or_not() {
    let api = Api::start_with(|config| config.max_upload_bytes = 100_000).await;
    let expected = problem(
        "payload_too_large",
        413,
        "The body is too large",
        "the body is larger than 100000 bytes",
    );
    let rows = "x".repeat(6_000_000);
    assert_eq!(
        api.upload(&json!({}), &rows).await.problem(),
        expected,
        "by its length"
    );
    let chunks = stream::iter((0..50).map(|_| Ok::<_, std::io::Error>(vec![b'x'; 10_000])));
    let streamed = Part::stream(Body::wrap_stream(chunks)).file_name("a.csv");
    assert_eq!(
        api.upload_form(Form::new().part("file", streamed))
            .await
            .problem(),
        expected,
        "by counting"
    );
    assert_eq!(
        std::fs::read_dir(api.jobs.datasets().temp_dir())
            .unwrap()
            .count(),
        0
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn an_upload_that_breaks_off_leaves_nothing() {
    let api = Api::start().await;
    let first = stream::iter([Ok::<_, std::io::Error>(DETECTIONS.as_bytes().to_vec())]);
    let chunks = futures::StreamExt::chain(first, stream::pending());
    let form = Form::new().part(
        "file",
        Part::stream(Body::wrap_stream(chunks)).file_name("a.csv"),
    );
    let upload = tokio::spawn(
        api.request(Method::POST, "/v1/datasets")
            .multipart(form)
            .send(),
    );
    let files = || {
        std::fs::read_dir(api.jobs.datasets().temp_dir())
            .unwrap()
            .count()
    };
    eventually(|| files() == 1).await;
    upload.abort();
    eventually(|| files() == 0).await;
    assert_eq!(api.get("/v1/datasets?count=true").await.ok(200)["total"], 0);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_dataset_in_use_stays_and_a_deleted_one_is_gone() {
    let api = Api::start_with(|config| config.slots = 1).await;
    let dataset = api.dataset(DETECTIONS).await;
    let path = format!("/v1/datasets/{dataset}");
    let blocker = api
        .post("/v1/jobs/simulate", &crate::helpers::long())
        .await
        .ok(202);
    let sensors = json!([{"sensor_id": "radar", "sigma_x_m": 1.0, "sigma_y_m": 1.0}]);
    let body = json!({"input": {"source": "dataset", "dataset_id": dataset}, "sensors": sensors});
    let user = api.post("/v1/jobs/associate", &body).await.ok(202);
    let refused = api.delete(&path).await;
    assert_eq!(
        (refused.status.as_u16(), &refused.problem()["code"]),
        (409, &json!("in_use"))
    );
    assert!(
        refused.problem()["detail"]
            .as_str()
            .unwrap()
            .contains(id(&user))
    );
    for job in [&user, &blocker] {
        send(api.request(Method::POST, &format!("/v1/jobs/{}/cancel", id(job))))
            .await
            .ok(202);
        api.jobs
            .wait(id(job).parse().unwrap(), Duration::from_secs(5))
            .await
            .unwrap();
    }
    assert_eq!(api.delete(&path).await.status, 204);
    let gone = problem(
        "gone",
        410,
        "It has been deleted",
        "the dataset has been deleted",
    );
    for answer in [
        api.get(&path).await,
        api.get(&format!("{path}/content")).await,
        api.delete(&path).await,
    ] {
        assert_eq!(answer.problem(), gone);
    }
}
