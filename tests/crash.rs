//! The server is killed without warning, or told to stop, while jobs wait and run; the next one finishes every job,
//! each once.
#![cfg(feature = "service")]

use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

const PATIENCE: Duration = Duration::from_secs(120);

/// A real server process on a free port.
struct Server {
    process: Child,
    url: String,
    client: reqwest::Client,
}

impl Server {
    fn start(data: &Path) -> Server {
        let mut process = Command::new(env!("CARGO_BIN_EXE_trackloom"))
            .args(["serve", "--listen", "127.0.0.1:0", "--workers", "2", "--data"])
            .arg(data)
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut line = String::new();
        BufReader::new(process.stdout.take().unwrap()).read_line(&mut line).unwrap();
        let url = line.trim().strip_prefix("trackloom listening on ").unwrap_or_else(|| panic!("said '{line}'")).to_owned();
        Server { process, url, client: reqwest::Client::new() }
    }

    /// SIGKILL: no handler runs, nothing is tidied up.
    fn kill(mut self) {
        self.process.kill().unwrap();
        self.process.wait().unwrap();
    }

    /// SIGTERM; gives the exit code and how long it took.
    fn terminate(mut self) -> (Option<i32>, Duration) {
        let since = Instant::now();
        let asked = Command::new("kill").args(["-TERM", &self.process.id().to_string()]).status().unwrap();
        assert!(asked.success());
        (self.process.wait().unwrap().code(), since.elapsed())
    }

    async fn get(&self, path: &str) -> Value {
        let answer = self.client.get(format!("{}{path}", self.url)).send().await.unwrap();
        assert!(answer.status().is_success(), "{path}: {}", answer.status());
        answer.json().await.unwrap()
    }

    async fn simulate(&self, body: &Value) -> String {
        let answer = self.client.post(format!("{}/v1/jobs/simulate", self.url)).json(body).send().await.unwrap();
        assert_eq!(answer.status(), 202);
        answer.json::<Value>().await.unwrap()["id"].as_str().unwrap().to_owned()
    }

    async fn count(&self, state: &str) -> u64 {
        self.get(&format!("/v1/jobs?state={state}&limit=1&count=true")).await["total"].as_u64().unwrap()
    }

    async fn until(&self, state: &str, count: u64) {
        let since = Instant::now();
        while self.count(state).await != count {
            assert!(since.elapsed() < PATIENCE, "{} jobs are {state}, not {count}", self.count(state).await);
            tokio::time::sleep(Duration::from_millis(20)).await;
        }
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// Takes about `scans / 10 000` seconds; `seed` makes each job another one.
fn body(scans: u32, seed: u32) -> Value {
    json!({"seed": seed, "scenario": {
        "scans": scans, "scan_period_s": 1.0,
        "sensors": [{"sensor_id": "radar", "max_range_m": 20000.0, "p_d": 0.9, "sigma_x_m": 10.0, "sigma_y_m": 10.0, "clutter_per_scan": 20.0}],
        "targets": {"kind": "random", "count": 10, "area_side_m": 10000.0, "speed_min_mps": 5.0, "speed_max_mps": 20.0}
    }})
}

#[tokio::test(flavor = "multi_thread")]
async fn twenty_queued_and_two_running_jobs_survive_a_kill_each_with_one_report() {
    let data = tempfile::tempdir().unwrap();
    let server = Server::start(data.path());
    let mut ids = Vec::new();
    for seed in 0..22 {
        // The first two are long enough to be running when the server is killed.
        ids.push(server.simulate(&body(if seed < 2 { 20_000 } else { 200 }, seed)).await);
    }
    server.until("running", 2).await;
    assert_eq!(server.count("queued").await, 20);
    server.kill();

    let server = Server::start(data.path());
    server.until("succeeded", 22).await;
    let mut results = BTreeSet::new();
    for (seed, id) in ids.iter().enumerate() {
        let job = server.get(&format!("/v1/jobs/{id}")).await;
        assert_eq!(job["attempt"], if seed < 2 { 2 } else { 1 }, "{job}");
        let report = server.get(&format!("/v1/jobs/{id}/report")).await;
        assert_eq!((report["job_id"].as_str(), report["seed"].as_u64()), (Some(id.as_str()), Some(seed as u64)));
        results.insert(report["result"].to_string());
        let artifacts = server.get(&format!("/v1/jobs/{id}/artifacts")).await;
        let reports = artifacts["items"].as_array().unwrap().iter().filter(|artifact| artifact["name"] == "report.json").count();
        assert_eq!(reports, 1);
        let events = server.get(&format!("/v1/jobs/{id}/history")).await["events"].as_array().unwrap().clone();
        let ends = events.iter().filter(|event| event["type"] == "done").count();
        assert_eq!(ends, 1, "{events:?}");
    }
    assert_eq!(results.len(), 22, "each seed has its own result");
    assert_eq!(server.get("/v1/datasets?limit=1&count=true").await["total"], 44, "two datasets a job, none twice");
    assert_eq!(server.count("queued").await + server.count("running").await + server.count("failed").await, 0);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_stop_is_quick_while_jobs_run_and_streams_are_open_and_loses_nothing() {
    let data = tempfile::tempdir().unwrap();
    let server = Server::start(data.path());
    let ids = [server.simulate(&body(20_000, 1)).await, server.simulate(&body(20_000, 2)).await, server.simulate(&body(200, 3)).await];
    server.until("running", 2).await;
    let stream = server.client.get(format!("{}/v1/jobs/{}/events", server.url, ids[0])).send().await.unwrap();
    assert_eq!(stream.headers()["content-type"], "text/event-stream");
    let (code, took) = server.terminate();
    assert_eq!(code, Some(0));
    assert!(took < Duration::from_secs(3), "{took:?}");
    assert!(!stream.text().await.unwrap().contains("event: done"), "the stream ended before its job");

    let server = Server::start(data.path());
    server.until("succeeded", 3).await;
    for (id, attempt) in ids.iter().zip([2, 2, 1]) {
        assert_eq!(server.get(&format!("/v1/jobs/{id}")).await["attempt"], attempt);
    }
}
