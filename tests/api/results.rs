//! Reports, files, series and the plan view.

use crate::helpers::{Answer, Api, id, long, problem, send, validation};
use reqwest::Method;
use serde_json::{Value, json};
use trackloom::service::types::ArtifactList;

/// An evaluated scene of ten targets, and its path.
async fn evaluated(api: &Api) -> String {
    let preset = api.get("/v1/presets/liang2009-10").await.ok(200);
    let job = api.run("evaluate", &preset["body"]).await;
    assert_eq!(job["state"], "succeeded", "{job}");
    format!("/v1/jobs/{}", id(&job))
}

fn columns_agree(layer: &Value) -> usize {
    let lengths: Vec<usize> = layer["columns"]
        .as_object()
        .unwrap()
        .values()
        .map(|column| column.as_array().unwrap().len())
        .collect();
    assert!(
        lengths.iter().all(|length| *length == lengths[0]),
        "{lengths:?}"
    );
    assert_eq!(layer["returned_points"], lengths[0]);
    lengths[0]
}

#[tokio::test(flavor = "multi_thread")]
async fn the_report_of_each_kind_is_what_the_document_says() {
    let api = Api::start().await;
    let simulated = api.run("simulate", &crate::helpers::small()).await;
    let counts = &report_of(&api, &simulated, "simulate").await["result"]["counts"];
    assert_eq!(
        (&counts["scans"], &counts["targets"]),
        (&json!(20), &json!(2))
    );
    assert_eq!(
        counts["detections"].as_u64().unwrap(),
        counts["clutter"].as_u64().unwrap() + detections_of_targets(&api, &simulated).await
    );

    let associated = api
        .run(
            "associate",
            &json!({"input": {"source": "job", "job_id": id(&simulated)}}),
        )
        .await;
    let report = report_of(&api, &associated, "associate").await;
    let association = &report["result"]["association"];
    assert_eq!(association["counts"]["scans"], 20);
    let tracks = association["tracks"].as_array().unwrap().len();
    assert_eq!(association["counts"]["tracks"], tracks);

    let judged = api
        .run(
            "evaluate",
            &json!({"tracks": {"source": "job", "job_id": id(&associated)}}),
        )
        .await;
    let result = &report_of(&api, &judged, "evaluate").await["result"];
    let counts = &result["tfa"]["counts"];
    assert_eq!(counts["targets"], 2);
    let verdicts = ["correct", "missed", "false"].map(|verdict| counts[verdict].as_u64().unwrap());
    assert_eq!(verdicts.iter().sum::<u64>(), 2);
    assert!(result.get("association").is_none());
}

/// The report, with the head that every kind has.
async fn report_of(api: &Api, job: &Value, kind: &str) -> Value {
    assert_eq!(job["state"], "succeeded", "{job}");
    let path = format!("/v1/jobs/{}/report", id(job));
    let report = api.get(&path).await.ok(200);
    assert_eq!(
        (&report["kind"], &report["job_id"]),
        (&json!(kind), &job["id"])
    );
    for member in [
        "spec",
        "seed",
        "engine_version",
        "inputs",
        "warnings",
        "timing",
    ] {
        assert!(report.get(member).is_some(), "{member}: {report}");
    }
    report
}

async fn detections_of_targets(api: &Api, job: &Value) -> u64 {
    let plan = api.get(&format!("/v1/jobs/{}/plan", id(job))).await.ok(200);
    let origins = plan["detections"]["columns"]["truth_id"]
        .as_array()
        .unwrap();
    origins.iter().filter(|origin| !origin.is_null()).count() as u64
}

#[tokio::test(flavor = "multi_thread")]
async fn a_report_that_is_not_ready_says_when_to_come_back() {
    let api = Api::start().await;
    let job = api.post("/v1/jobs/simulate", &long()).await.ok(202);
    let refused = api.get(&format!("/v1/jobs/{}/report", id(&job))).await;
    assert_eq!(
        (refused.status.as_u16(), &refused.problem()["code"]),
        (409, &json!("result_not_ready"))
    );
    assert_eq!(refused.header("retry-after"), "1");
    send(api.request(Method::POST, &format!("/v1/jobs/{}/cancel", id(&job))))
        .await
        .ok(202);
}

#[tokio::test(flavor = "multi_thread")]
async fn reports_and_files_have_strong_tags_and_ranges() {
    let api = Api::start().await;
    let base = evaluated(&api).await;
    let list: ArtifactList =
        serde_json::from_value(api.get(&format!("{base}/artifacts")).await.ok(200)).unwrap();
    let names: Vec<&str> = list.items.iter().map(|item| item.name.as_str()).collect();
    let of_automaton = ["automaton.json", "automaton.dot", "truth_probability.csv"];
    let of_metrics = [
        "events.csv",
        "pairs.csv",
        "metric-series.csv",
        "metric-truths.csv",
        "metric-tracks.csv",
        "causes.csv",
        "metrics.txt",
    ];
    let datasets = ["scans.csv", "detections.csv", "truth.csv", "tracks.csv"];
    assert_eq!(
        names,
        [&datasets[..], &of_automaton, &of_metrics, &["report.json"]].concat()
    );
    for item in &list.items {
        let whole = api.get(&item.href).await;
        assert_eq!(
            (whole.text.len() as u64, whole.header("content-type")),
            (item.bytes, item.media_type.as_str())
        );
        let tag = format!("\"{}\"", item.sha256);
        assert_eq!(whole.header("etag"), tag);
        assert_eq!(
            api.get_with(&item.href, "if-none-match", &tag).await.status,
            304
        );
        let part = api.get_with(&item.href, "range", "bytes=5-24").await;
        assert_eq!(
            (part.status.as_u16(), part.text.as_str()),
            (206, &whole.text[5..25])
        );
        assert_eq!(
            part.header("content-range"),
            format!("bytes 5-24/{}", item.bytes)
        );
        let stale = send(
            api.request(Method::GET, &item.href)
                .header("range", "bytes=5-24")
                .header("if-range", "\"old\""),
        )
        .await;
        assert_eq!(stale.status, 200);
        let outside = api.get_with(&item.href, "range", "bytes=999999999-").await;
        let detail = format!("the file has {} bytes", item.bytes);
        assert_eq!(
            outside.problem(),
            problem(
                "range_not_satisfiable",
                416,
                "The range is outside the file",
                &detail
            )
        );
        assert_eq!(
            outside.header("content-range"),
            format!("bytes */{}", item.bytes)
        );
    }
    let report = api.get(&format!("{base}/report")).await;
    assert_eq!(
        report.text,
        api.get(&format!("{base}/artifacts/report.json")).await.text
    );
    assert_eq!(
        report.header("cache-control"),
        "private, max-age=31536000, immutable"
    );
    assert_eq!(
        api.get(&format!("{base}/artifacts/other.csv")).await.status,
        404
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn the_plan_view_holds_all_layers_and_says_when_it_is_reduced() {
    let api = Api::start().await;
    let base = evaluated(&api).await;
    let plan = api.get(&format!("{base}/plan")).await.ok(200);
    for layer in ["truth", "detections", "tracks"] {
        let points = columns_agree(&plan[layer]);
        assert!(points > 50, "{layer}");
        assert_eq!(
            (&plan[layer]["source_points"], &plan[layer]["method"]),
            (&json!(points), &json!("all"))
        );
    }
    assert_eq!(plan["scans"].as_array().unwrap().len(), 30);
    assert_eq!(
        (&plan["extent"]["from_s"], &plan["extent"]["to_s"]),
        (&json!(0.0), &json!(232.0))
    );
    let reduced = api.get(&format!("{base}/plan?max_points=20")).await.ok(200);
    for layer in ["truth", "detections", "tracks"] {
        assert!(columns_agree(&reduced[layer]) <= 20);
        assert_eq!(reduced[layer]["method"], "every_nth");
        assert_eq!(
            reduced[layer]["source_points"],
            plan[layer]["source_points"]
        );
    }
    let counts: Vec<u64> =
        serde_json::from_value(reduced["density"]["columns"]["count"].clone()).unwrap();
    assert_eq!(
        json!(counts.iter().sum::<u64>()),
        plan["detections"]["source_points"],
        "the density counts all detections"
    );
    assert_eq!(
        (&reduced["density"]["source_points"], plan.get("density")),
        (&plan["detections"]["source_points"], None)
    );
    let window = api
        .get(&format!("{base}/plan?from=16&to=24&track=1"))
        .await
        .ok(200);
    let times: Vec<f64> =
        serde_json::from_value(window["detections"]["columns"]["time_s"].clone()).unwrap();
    assert!(!times.is_empty() && times.iter().all(|time_s| [16.0, 24.0].contains(time_s)));
    let tracks: Vec<String> =
        serde_json::from_value(window["tracks"]["columns"]["track_id"].clone()).unwrap();
    assert_eq!(tracks, ["1", "1"]);
}

#[tokio::test(flavor = "multi_thread")]
async fn series_are_columns_with_units() {
    let api = Api::start().await;
    let base = evaluated(&api).await;
    let probability = api
        .get(&format!("{base}/series/track_probability"))
        .await
        .ok(200);
    let rows = columns_agree(&probability);
    assert_eq!(probability["units"], json!({"time_s": "s"}));
    let values: Vec<f64> =
        serde_json::from_value(probability["columns"]["probability"].clone()).unwrap();
    assert!(values.iter().all(|p| (0.0..=1.0).contains(p)));
    let reduced = api
        .get(&format!("{base}/series/track_probability?max_points=10"))
        .await
        .ok(200);
    assert!(columns_agree(&reduced) <= 10);
    assert_eq!(
        (&reduced["method"], &reduced["source_points"]),
        (&json!("min_max"), &json!(rows))
    );

    let counts = api.get(&format!("{base}/series/scan_counts")).await.ok(200);
    assert_eq!(columns_agree(&counts), 30);
    let detections: Vec<u64> =
        serde_json::from_value(counts["columns"]["detections"].clone()).unwrap();
    let plan = api.get(&format!("{base}/plan")).await.ok(200);
    assert_eq!(
        json!(detections.iter().sum::<u64>()),
        plan["detections"]["source_points"]
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn gates_are_where_the_tracks_were_expected() {
    let api = Api::start().await;
    let base = evaluated(&api).await;
    let plan = api.get(&format!("{base}/plan")).await.ok(200);
    let gates = api
        .get(&format!("{base}/series/gates?track=1&from=16&to=32"))
        .await
        .ok(200);
    assert_eq!(columns_agree(&gates), 3, "scans at 16, 24 and 32 s");
    assert!(
        (gates["threshold"].as_f64().unwrap() - -2.0 * 0.001f64.ln()).abs() < 1e-9,
        "{}",
        gates["threshold"]
    );
    assert_eq!(
        (&gates["units"]["s_xx"], &gates["columns"]["range_m"]),
        (&json!("m²"), &json!([null, null, null]))
    );
    // A constant velocity from the point before, 8 s earlier.
    let columns = &plan["tracks"]["columns"];
    let row = (0..)
        .find(|&row| columns["track_id"][row] == "1" && columns["time_s"][row] == 8.0)
        .unwrap();
    let value = |name: &str| columns[name][row].as_f64().unwrap();
    assert!(
        (gates["columns"]["x_m"][0].as_f64().unwrap() - (value("x_m") + 8.0 * value("vx_mps")))
            .abs()
            < 1e-6
    );
    assert!(
        (gates["columns"]["y_m"][0].as_f64().unwrap() - (value("y_m") + 8.0 * value("vy_mps")))
            .abs()
            < 1e-6
    );
    assert!(
        gates["columns"]["s_xx"][0].as_f64().unwrap() > value("p_xx"),
        "the innovation is less certain than the track"
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn a_sonar_has_a_bearing_time_series_and_a_plan_that_says_what_it_lacks() {
    let api = Api::start().await;
    let mut body: Value =
        serde_json::from_str(include_str!("../../examples/bearing-crossing.json")).unwrap();
    body.as_object_mut().unwrap().remove("kind");
    let job = api.run("evaluate", &body).await;
    assert_eq!(job["state"], "succeeded", "{job}");
    let report = report_of(&api, &job, "evaluate").await;
    assert_eq!(report["result"]["tfa"]["counts"]["targets"], 2);
    let base = format!("/v1/jobs/{}", id(&job));
    let plan = api.get(&format!("{base}/plan")).await.ok(200);
    assert_eq!(
        (
            columns_agree(&plan["truth"]),
            columns_agree(&plan["tracks"])
        ),
        (162, 0),
        "two ships at 81 scans, and no track in the plane"
    );
    let note = "the tracks are directions (bearing_deg), which have no place in the plane: see the series bearing_time";
    assert_eq!(plan["notes"], json!([note]));
    let series = api
        .get(&format!("{base}/series/bearing_time"))
        .await
        .ok(200);
    let layers: Vec<String> = serde_json::from_value(series["columns"]["layer"].clone()).unwrap();
    let count = |wanted: &str| layers.iter().filter(|layer| *layer == wanted).count() as u64;
    assert_eq!(
        columns_agree(&series) as u64,
        count("truth") + count("detection") + count("track")
    );
    assert_eq!(
        (count("truth"), json!(count("detection"))),
        (162, plan["detections"]["source_points"].clone())
    );
    assert_eq!(
        report["result"]["association"]["counts"]["track_points"],
        count("track")
    );
    let bearings: Vec<f64> =
        serde_json::from_value(series["columns"]["bearing_deg"].clone()).unwrap();
    assert!(
        bearings
            .iter()
            .all(|degrees| (0.0..360.0).contains(degrees))
    );
    assert_eq!(series["units"]["bearing_deg"], "deg");
}

#[tokio::test(flavor = "multi_thread")]
async fn windows_and_series_that_make_no_sense_are_refused() {
    let api = Api::start().await;
    let base = evaluated(&api).await;
    let answer: Answer = api.get(&format!("{base}/series/happiness")).await;
    let detail = "there is no series 'happiness'; there are track_probability, association_map, mode_probability, scan_counts, bearing_time, gates, metrics";
    assert_eq!(
        answer.problem(),
        problem("not_found", 404, "There is no such thing", detail)
    );
    let answer = api
        .get(&format!("{base}/plan?from=9&to=3&max_points=1"))
        .await;
    let faults = json!([
        {"pointer": "/query/max_points", "code": "unknown_value", "detail": "'1' is not a value of 'max_points'", "allowed": "[2, 1000000]"},
        {"pointer": "/query/to", "code": "out_of_range", "detail": "the window ends before it begins", "allowed": ">= 9"}
    ]);
    assert_eq!(answer.problem(), validation("2 faults", faults));
}
