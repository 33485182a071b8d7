//! The server is killed without warning, or told to stop, while jobs wait and run; the next one finishes every job,
//! each once.

use crate::process::Server;
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::time::Duration;

/// Takes about `scans / 10 000` seconds; `seed` makes each job another one.
pub fn body(scans: u32, seed: u32) -> Value {
    json!({"seed": seed, "scenario": {
        "scans": scans, "scan_period_s": 1.0,
        "sensors": [{"sensor_id": "radar", "max_range_m": 20000.0, "p_d": 0.9, "sigma_x_m": 10.0, "sigma_y_m": 10.0, "clutter_per_scan": 20.0}],
        "targets": {"kind": "random", "count": 10, "area_side_m": 10000.0, "speed_min_mps": 5.0, "speed_max_mps": 20.0}
    }})
}

#[tokio::test(flavor = "multi_thread")]
async fn twenty_queued_and_two_running_jobs_survive_a_kill_each_with_one_report() {
    let data = tempfile::tempdir().unwrap();
    let server = Server::start(data.path(), &[]);
    let mut ids = Vec::new();
    for seed in 0..22 {
        // The first two are long enough to be running when the server is killed.
        ids.push(
            server
                .submit("simulate", &body(if seed < 2 { 60_000 } else { 200 }, seed))
                .await,
        );
    }
    server.until("running", 2).await;
    assert_eq!(server.count("queued").await, 20);
    server.kill();

    let server = Server::start(data.path(), &[]);
    server.until("succeeded", 22).await;
    let mut results = BTreeSet::new();
    for (seed, id) in ids.iter().enumerate() {
        let job = server.get(&format!("/v1/jobs/{id}")).await;
        assert_eq!(job["attempt"], if seed < 2 { 2 } else { 1 }, "{job}");
        let report = server.get(&format!("/v1/jobs/{id}/report")).await;
        assert_eq!(
            (report["job_id"].as_str(), report["seed"].as_u64()),
            (Some(id.as_str()), Some(seed as u64))
        );
        results.insert(report["result"].to_string());
        let artifacts = server.get(&format!("/v1/jobs/{id}/artifacts")).await;
        let reports = artifacts["items"]
            .as_array()
            .unwrap()
            .iter()
            .filter(|artifact| artifact["name"] == "report.json")
            .count();
        assert_eq!(reports, 1);
        let events = server.get(&format!("/v1/jobs/{id}/history")).await["events"]
            .as_array()
            .unwrap()
            .clone();
        let ends = events
            .iter()
            .filter(|event| event["type"] == "done")
            .count();
        assert_eq!(ends, 1, "{events:?}");
    }
    assert_eq!(results.len(), 22, "each seed has its own result");
    assert_eq!(
        server.get("/v1/datasets?limit=1&count=true").await["total"],
        44,
        "two datasets a job, none twice"
    );
    assert_eq!(
        server.count("queued").await + server.count("running").await + server.count("failed").await,
        0
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn a_stop_is_quick_while_jobs_run_and_streams_are_open_and_loses_nothing() {
    let data = tempfile::tempdir().unwrap();
    let server = Server::start(data.path(), &[]);
    let ids = [
        server.submit("simulate", &body(20_000, 1)).await,
        server.submit("simulate", &body(20_000, 2)).await,
        server.submit("simulate", &body(200, 3)).await,
    ];
    server.until("running", 2).await;
    let stream = server
        .client
        .get(format!("{}/v1/jobs/{}/events", server.url, ids[0]))
        .send()
        .await
        .unwrap();
    assert_eq!(stream.headers()["content-type"], "text/event-stream");
    let (code, took) = server.terminate();
    assert_eq!(code, Some(0));
    assert!(took < Duration::from_secs(3), "{took:?}");
    assert!(
        !stream.text().await.unwrap().contains("event: done"),
        "the stream ended before its job"
    );

    let server = Server::start(data.path(), &[]);
    server.until("succeeded", 3).await;
    for (id, attempt) in ids.iter().zip([2, 2, 1]) {
        assert_eq!(
            server.get(&format!("/v1/jobs/{id}")).await["attempt"],
            attempt
        );
    }
}
