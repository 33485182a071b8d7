//! Judging truth and tracks that trackloom did not make.

use crate::helpers::{Api, id, validation};
use serde_json::{Value, json};

const TRUTH: &str = include_str!("../../examples/data/two-targets/truth.csv");
const TRACKS: &str = include_str!("../../examples/data/two-targets/tracks.csv");

fn dataset(id: &str) -> Value {
    json!({"source": "dataset", "dataset_id": id})
}

async fn uploaded(api: &Api, truth: &str, tracks: &str) -> Value {
    json!({"truth": dataset(&api.dataset(truth).await), "tracks": dataset(&api.dataset(tracks).await)})
}

/// The two files with these settings, judged.
async fn judged(api: &Api, truth: &str, tracks: &str, settings: Value) -> Value {
    let mut body = uploaded(api, truth, tracks).await;
    body.as_object_mut()
        .unwrap()
        .extend(settings.as_object().unwrap().clone());
    api.run("evaluate", &body).await
}

async fn result_of(api: &Api, job: &Value) -> Value {
    assert_eq!(job["state"], "succeeded", "{job}");
    api.get(&format!("/v1/jobs/{}/report", id(job)))
        .await
        .ok(200)["result"]
        .clone()
}

#[track_caller]
fn close(found: &Value, expected: f64) {
    let found = found
        .as_f64()
        .unwrap_or_else(|| panic!("no number: {found}"));
    assert!(
        (found - expected).abs() < 1e-9,
        "found {found}, expected {expected}"
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn uploaded_truth_and_tracks_give_the_values_of_the_definitions() {
    let api = Api::start().await;
    let metrics = json!([
        {"metric": "gospa", "cutoff_m": 10.0, "p": 2.0}, {"metric": "gospa", "cutoff_m": 20.0, "p": 2.0},
        {"metric": "ospa", "cutoff_m": 10.0, "p": 1.0}, {"metric": "t_gospa", "cutoff_m": 10.0, "p": 2.0, "switch_penalty_m": 2.0},
        {"metric": "siap"}, {"metric": "clear"}
    ]);
    let job = judged(
        &api,
        TRUTH,
        TRACKS,
        json!({"metrics": metrics, "comparison": {"gate_m": 10.0}}),
    )
    .await;
    let result = result_of(&api, &job).await;
    let value = |pointer: &str| {
        result["metrics"]
            .pointer(pointer)
            .unwrap_or(&Value::Null)
            .clone()
    };
    close(&value("/gospa/value"), 5.649010411767257);
    close(&value("/gospa_2/value"), 8.676379987444735);
    close(&value("/ospa/value"), 3.7924282969569063);
    close(&value("/t_gospa/value"), 20.844663585675832);
    close(&value("/siap/quantities/completeness/value"), 16.0 / 18.0);
    assert_eq!(value("/gospa/unit"), "m");
    assert_eq!(value("/gospa_2/parameters/cutoff_m"), 20.0);
    let counts = &result["events"]["counts"];
    assert_eq!(
        (&counts["match"], &counts["miss"], &counts["switch"]),
        (&json!(16), &json!(2), &json!(1))
    );
    // Target A is without a track at 6 s: track T1 ended at 5 s.
    let broken = &result["events"]["breaks"][0];
    assert_eq!(
        (&broken["truth_id"], &broken["track_id"], &broken["cause"]),
        (&json!("A"), &json!("T1"), &json!("ended"))
    );
    // Without detections the automaton reads the nearest target.
    assert_eq!(result["tfa"]["parameters"]["symbols"], "nearest_truth");
}

#[tokio::test(flavor = "multi_thread")]
async fn the_files_of_a_job_say_more_than_its_report() {
    let api = Api::start().await;
    let job = judged(&api, TRUTH, TRACKS, json!({"comparison": {"gate_m": 10.0}})).await;
    let result = result_of(&api, &job).await;
    let names: Vec<&String> = result["metrics"].as_object().unwrap().keys().collect();
    assert_eq!(
        names,
        ["gospa", "ospa", "siap", "clear", "assignment", "kinematics"]
    );
    let base = format!("/v1/jobs/{}", id(&job));
    let file = async |name: &str| api.get(&format!("{base}/artifacts/{name}")).await.text;
    let events = file("events.csv").await;
    assert_eq!(
        events.lines().next(),
        Some("step,time_s,event,truth_id,track_id,distance,similarity")
    );
    let counted: u64 = result["events"]["counts"]
        .as_object()
        .unwrap()
        .values()
        .map(|count| count.as_u64().unwrap())
        .sum();
    assert_eq!(events.lines().count() as u64, counted + 1);
    assert!(events.contains("\n7,6,break,A,T1,,\n"), "{events}");
    // 16 matches: what the report says of `tp` is what the rows hold.
    let from = result["metrics"]["clear"]["from"].as_array().unwrap();
    let of_tp = from.iter().find(|entry| entry["quantity"] == "tp").unwrap();
    assert_eq!(
        *of_tp,
        json!({"quantity": "tp", "statistic": "count", "file": "events.csv", "filter": {"event": ["match"]}})
    );
    assert_eq!(
        events
            .lines()
            .filter(|line| line.contains(",match,"))
            .count(),
        16
    );
    let pairs = file("pairs.csv").await;
    assert!(
        pairs.starts_with(
            "step,time_s,truth_id,track_id,distance,similarity,gospa.power [m^p],ospa.power [m^p],"
        ),
        "{pairs}"
    );
    let series = api.get(&format!("{base}/series/metrics")).await.ok(200);
    assert_eq!(series["columns"]["time_s"].as_array().unwrap().len(), 10);
    close(
        &series["columns"]["values"]["gospa.gospa"][0],
        2.23606797749979,
    );
    assert_eq!(file("metric-truths.csv").await.lines().count(), 3);
    assert_eq!(file("metric-tracks.csv").await.lines().count(), 5);
    let text = file("metrics.txt").await;
    assert!(
        text.lines()
            .any(|line| line.starts_with("clear mota") && line.trim_end().ends_with("0.667")),
        "{text}"
    );
}

/// Boxes of ten pixels, an object at its own place: `frame,id`.
fn boxes(rows: &[(u32, u32)]) -> String {
    rows.iter()
        .map(|(frame, object)| {
            format!(
                "{frame},{object},{}.0,0.0,10.0,10.0,1,-1,-1,-1\n",
                100 * (object % 10)
            )
        })
        .collect()
}

async fn mot(api: &Api, kind: &str, text: &str) -> Value {
    dataset(
        api.upload(&json!({"format": "mot", "kind": kind}), text)
            .await
            .ok(201)["id"]
            .as_str()
            .unwrap(),
    )
}

#[tokio::test(flavor = "multi_thread")]
async fn sequences_of_boxes_are_combined_from_their_counts() {
    let api = Api::start().await;
    let first = (
        mot(&api, "truth", &boxes(&[(1, 1), (2, 1), (3, 1)])).await,
        mot(&api, "tracks", &boxes(&[(1, 11), (2, 11), (3, 11)])).await,
    );
    let second = (
        mot(&api, "truth", &boxes(&[(1, 1), (2, 1)])).await,
        mot(&api, "tracks", &boxes(&[(1, 21)])).await,
    );
    let sequence = |name: &str, (truth, tracks): &(Value, Value)| json!({"name": name, "truth": truth, "tracks": tracks});
    let body = json!({"profile": "vision", "sequences": [sequence("one", &first), sequence("two", &second)]});
    let result = result_of(&api, &api.run("evaluate", &body).await).await;
    // One miss among five boxes of truth.
    close(
        &result["metrics"]["clear"]["quantities"]["mota"]["value"],
        0.8,
    );
    close(
        &result["sequences"][0]["metrics"]["clear"]["quantities"]["mota"]["value"],
        1.0,
    );
    close(
        &result["sequences"][1]["metrics"]["clear"]["quantities"]["mota"]["value"],
        0.5,
    );
    assert_eq!(result["sequences"][1]["name"], "two");
    assert!(result["tfa"].is_null() && result["metrics"]["hota"]["curves"][0]["axis"] == "alpha");
    let alone = json!({"profile": "vision", "truth": first.0, "tracks": first.1});
    let result = result_of(&api, &api.run("evaluate", &alone).await).await;
    close(&result["metrics"]["identity"]["value"], 1.0);
}

/// The faults of a job that failed on its data.
async fn faults(api: &Api, job: &Value) -> Value {
    assert_eq!(job["state"], "failed", "{job}");
    api.get(&format!("/v1/jobs/{}", id(job))).await.ok(200)["error"]["errors"].clone()
}

#[tokio::test(flavor = "multi_thread")]
async fn data_that_cannot_be_compared_are_named() {
    let api = Api::start().await;
    let late = "time_s,track_id,x_m,y_m\n100,1,0,0\n101,1,1,0\n";
    let found = faults(
        &api,
        &judged(&api, TRUTH, late, json!({"profile": "tracking"})).await,
    )
    .await;
    assert_eq!(
        (&found[0]["pointer"], &found[0]["code"]),
        (&json!("/truth"), &json!("disjoint")),
        "{found}"
    );
    assert_eq!(
        found[0]["detail"],
        "the times of truth (0 to 9 s) and of tracks (100 to 101 s) do not meet"
    );
    let (truth, tracks) = (
        mot(&api, "truth", &boxes(&[(1, 1)])).await,
        mot(&api, "tracks", &boxes(&[(1, 1)])).await,
    );
    let in_metres = api
        .run(
            "evaluate",
            &json!({"truth": truth, "tracks": tracks, "metrics": [{"metric": "ospa"}]}),
        )
        .await;
    let found = faults(&api, &in_metres).await;
    assert_eq!(
        (&found[0]["pointer"], &found[0]["code"]),
        (&json!("/metrics"), &json!("unsupported")),
        "{found}"
    );
    let mixed =
        json!({"truth": truth, "tracks": dataset(&api.dataset(TRACKS).await), "profile": "vision"});
    let found = faults(&api, &api.run("evaluate", &mixed).await).await;
    assert_eq!(found[0]["detail"], "truth and tracks are not of one kind");
}

#[tokio::test(flavor = "multi_thread")]
async fn nothing_to_compare_is_no_error_and_no_number() {
    let api = Api::start().await;
    let settings = json!({"metrics": [{"metric": "clear"}, {"metric": "gospa", "cutoff_m": 10.0}, {"metric": "kinematics"}]});
    let no_tracks = judged(&api, TRUTH, "time_s,track_id,x_m,y_m\n", settings.clone()).await;
    let result = result_of(&api, &no_tracks).await;
    let metrics = &result["metrics"];
    close(&metrics["clear"]["quantities"]["mota"]["value"], 0.0);
    assert!(
        metrics["kinematics"]["value"].is_null() && metrics["kinematics"]["reason"].is_string(),
        "{metrics}"
    );
    let no_truth = judged(&api, "time_s,truth_id,x_m,y_m\n", TRACKS, settings).await;
    let result = result_of(&api, &no_truth).await;
    assert!(
        result["metrics"]["clear"]["quantities"]["mota"]["value"].is_null(),
        "{}",
        result["metrics"]["clear"]
    );
    assert_eq!(result["events"]["counts"]["false_alarm"], 19);
}

#[tokio::test(flavor = "multi_thread")]
async fn settings_that_make_no_sense_are_refused_together() {
    let api = Api::start().await;
    let mut body = uploaded(&api, TRUTH, TRACKS).await;
    body["profile"] = json!("radar");
    body["comparison"] = json!({"gate_m": -1.0, "min_iou": 1.5, "alignment": {"method": "spline"}});
    body["metrics"] = json!([{"metric": "gospa", "cutoff_m": 0.0}, {"metric": "ospa", "p": 0.5}, {"metric": "hota2"}]);
    let answer = api.post("/v1/jobs/evaluate", &body).await.problem();
    let found: Vec<(&str, &str)> = answer["errors"]
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
        ("/profile", "unknown_value"),
        ("/metrics/0/cutoff_m", "out_of_range"),
        ("/metrics/1/p", "out_of_range"),
        ("/metrics/2/metric", "unknown_value"),
        ("/comparison/gate_m", "out_of_range"),
        ("/comparison/min_iou", "out_of_range"),
        ("/comparison/alignment/method", "unknown_value"),
    ];
    assert_eq!(found, expected);
    let alone = json!({"tracks": body["tracks"]});
    let detail = "'truth' is required to judge tracks, or 'detections' that know which target they came from";
    let fault = json!({"pointer": "/truth", "code": "missing", "detail": detail});
    assert_eq!(
        api.post("/v1/jobs/evaluate", &alone).await.problem(),
        validation(detail, json!([fault]))
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn files_with_impossible_rows_are_refused_by_line() {
    let api = Api::start().await;
    for (meta, text, line, code) in [
        (
            json!({}),
            "time_s,truth_id,x_m,y_m\n0,A,1,2\n0,A,3,4\n",
            3,
            "duplicate",
        ),
        (
            json!({}),
            "time_s,track_id,x_m,y_m\n0,1,1,2\n1,1,NaN,4\n",
            3,
            "not_finite",
        ),
        (
            json!({"format": "mot", "kind": "truth"}),
            "1,1,0,0,10,-10,1,-1,-1,-1\n",
            1,
            "out_of_range",
        ),
        (
            json!({"format": "mot", "kind": "tracks"}),
            "1,1,0,0,10,10,1,-1,-1,-1\n1,1,5,0,10,10,1,-1,-1,-1\n",
            2,
            "duplicate",
        ),
    ] {
        let fault = api.upload(&meta, text).await.problem()["errors"][0].clone();
        assert_eq!(
            (&fault["line"], &fault["code"]),
            (&json!(line), &json!(code)),
            "{fault}"
        );
    }
}
