//! Campaigns on a file: what a chunk that kills its process does, what is made again, who goes first, and a million runs.

use crate::process::Server;
use serde_json::{Value, json};
use sqlx::sqlite::{SqliteConnectOptions, SqlitePool};
use std::path::Path;
use std::time::{Duration, Instant};

/// Liang's scene with ten targets under two associators: a few milliseconds a run.
pub fn campaign(runs: u32) -> Value {
    let variant = |name: &str| json!({"name": name, "set": [{"path": "/associator", "value": {"method": name}}]});
    json!({
        "seed": 5, "runs": runs,
        "base": {
            "kind": "evaluate", "input": {"source": "preset", "preset": "liang2009-10"}, "comparison": {"gate_m": 1000.0},
            "tracker": {"gate_probability": 0.999, "initial_speed_sigma_mps": 430.0}
        },
        "grid": [{"by": "variants", "name": "associator", "variants": [variant("nearest_neighbour"), variant("jpda")]}],
        "outcomes": [
            {"path": "tfa.probability.correct", "name": "correct"}, {"path": "metrics.gospa.quantities.gospa", "name": "gospa"},
            {"path": "tfa.counts.correct", "name": "targets", "interval": "bootstrap"}
        ]
    })
}

/// One target for one scan.
fn moment(runs: u32) -> Value {
    json!({
        "runs": runs, "timed_runs": 0, "outcomes": [{"path": "counts.detections", "name": "detections"}],
        "base": {"kind": "simulate", "scenario": {
            "scans": 1, "scan_period_s": 1.0,
            "sensors": [{"sensor_id": "radar", "max_range_m": 20000.0, "p_d": 0.9, "sigma_x_m": 10.0, "sigma_y_m": 10.0, "clutter_per_scan": 1.0}],
            "targets": {"kind": "random", "count": 1, "area_side_m": 1000.0, "speed_min_mps": 5.0, "speed_max_mps": 20.0}
        }}
    })
}

/// The chunk that runs, after the first that finds out how long a run takes; 0 where none does.
const RUNNING: &str =
    "SELECT coalesce(min(number), 0) FROM chunks WHERE number > 1 AND state = 'running'";

/// The number that a query of the tables gives.
pub async fn number(data: &Path, query: &'static str) -> i64 {
    let options = SqliteConnectOptions::new()
        .filename(data.join("app.db"))
        .read_only(true);
    let pool = SqlitePool::connect_with(options).await.unwrap();
    let number = sqlx::query_scalar(query).fetch_one(&pool).await.unwrap();
    pool.close().await;
    number
}

async fn logged(server: &Server, id: &str) -> Vec<String> {
    let events = server.get(&format!("/v1/jobs/{id}/history")).await["events"]
        .as_array()
        .unwrap()
        .clone();
    events
        .iter()
        .filter_map(|event| event["data"]["message"].as_str().map(str::to_owned))
        .collect()
}

#[tokio::test(flavor = "multi_thread")]
async fn runs_that_kill_the_process_are_given_up_and_a_rerun_makes_them_alone() {
    let data = tempfile::tempdir().unwrap();
    let mut server = Server::start(data.path(), &["--workers", "1"]);
    // A chunk has to last longer than a process takes to begin on a machine with much to do.
    let mut body = campaign(400);
    body["base"]["input"]["preset"] = json!("liang2009-50");
    let id = server.submit("campaign", &body).await;
    // A chunk may end before its process is dead: then it is the next one's turn.
    let (mut doomed, mut deaths) = (0, 0);
    while deaths < 3 {
        let since = Instant::now();
        while number(data.path(), RUNNING).await == 0 {
            assert!(
                since.elapsed() < Duration::from_secs(60),
                "no chunk runs after {deaths} deaths"
            );
            tokio::time::sleep(Duration::from_millis(20)).await;
        }
        server.kill();
        let died = number(data.path(), RUNNING).await;
        deaths = match died {
            0 => 0,
            same if same == doomed => deaths + 1,
            _ => 1,
        };
        doomed = died;
        server = Server::start(data.path(), &["--workers", "1"]);
    }
    let job = server.ended(&id).await;
    assert_eq!(
        (job["state"].as_str(), job["error"]["code"].as_str()),
        (Some("failed"), Some("crashed")),
        "{job}"
    );
    let detail = job["error"]["detail"].as_str().unwrap();
    assert!(
        detail.starts_with("the process ended again and again while it made ")
            && detail.contains(", from cell '"),
        "{detail}"
    );
    let done = number(data.path(), "SELECT runs_done FROM campaigns").await;
    assert!(done > 0 && done < 800, "{done} of 800 runs are kept");

    let again = server.ask(&id, "rerun").await["id"]
        .as_str()
        .unwrap()
        .to_owned();
    let result = server.result(&again).await;
    assert_eq!(
        logged(&server, &again).await,
        [format!("{done} runs are taken over from job {id}")]
    );
    let whole = server.submit("campaign", &body).await;
    assert!(
        result == server.result(&whole).await,
        "put together from two jobs it is another result"
    );
    assert_eq!(
        number(
            data.path(),
            "SELECT count(*) FROM campaigns WHERE runs_done = runs_total"
        )
        .await,
        2
    );
    assert_eq!(number(data.path(), "SELECT count(*) FROM chunks JOIN jobs ON jobs.id = job_id WHERE jobs.state = 'succeeded'").await, 0);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_small_job_does_not_wait_behind_a_campaign_and_a_canceled_one_goes_on_from_where_it_was()
{
    let data = tempfile::tempdir().unwrap();
    let server = Server::start(data.path(), &["--workers", "1"]);
    let id = server.submit("campaign", &campaign(2000)).await;
    server
        .job_until(&id, |job| job["progress"]["done"].as_u64() > Some(0))
        .await;
    let since = Instant::now();
    let small = server.submit("simulate", &crate::single::body(20, 1)).await;
    server.result(&small).await;
    // One chunk of the campaign ends before, and another may have been given out; all of it takes more than a dozen.
    assert_eq!(server.job(&id).await["state"], "running");
    assert!(
        since.elapsed() < Duration::from_secs(20),
        "{:?}",
        since.elapsed()
    );

    let canceled = server.ask(&id, "cancel").await;
    assert_eq!(canceled["state"], "canceled");
    assert_eq!(
        number(
            data.path(),
            "SELECT count(*) FROM chunks WHERE state <> 'done'"
        )
        .await,
        0
    );
    let done = number(data.path(), "SELECT runs_done FROM campaigns").await;
    let again = server.ask(&id, "rerun").await["id"]
        .as_str()
        .unwrap()
        .to_owned();
    let job = server
        .job_until(&again, |job| job["progress"]["done"].as_i64() > Some(done))
        .await;
    assert_eq!(
        (job["state"].as_str(), job["progress"]["total"].as_u64()),
        (Some("running"), Some(4000))
    );
    server.ask(&again, "cancel").await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_million_runs_are_accepted_make_progress_and_are_canceled_at_once() {
    let data = tempfile::tempdir().unwrap();
    let server = Server::start(data.path(), &[]);
    let validated = server
        .client
        .post(format!("{}/v1/validate", server.url))
        .json(&json!({"kind": "campaign", "spec": moment(1_000_000)}));
    let validated: Value = validated.send().await.unwrap().json().await.unwrap();
    assert!(
        validated["estimate"]["cost_s"].as_f64() > Some(1.0),
        "{validated}"
    );
    let id = server.submit("campaign", &moment(1_000_000)).await;
    let job = server
        .job_until(&id, |job| job["progress"]["done"].as_u64() > Some(1000))
        .await;
    assert_eq!(job["progress"]["total"], 1_000_000);
    let since = Instant::now();
    server.ask(&id, "cancel").await;
    assert_eq!(server.ended(&id).await["state"], "canceled");
    assert!(
        since.elapsed() < Duration::from_secs(5),
        "{:?}",
        since.elapsed()
    );
    assert_eq!(
        number(
            data.path(),
            "SELECT count(*) FROM chunks WHERE state <> 'done'"
        )
        .await,
        0
    );
    // What is left of it in the queue holds nobody up.
    let small = server.submit("simulate", &crate::single::body(20, 1)).await;
    server.result(&small).await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_cell_that_ends_early_ends_so_in_chunks_too() {
    let data = tempfile::tempdir().unwrap();
    let server = Server::start(data.path(), &[]);
    let mut body = campaign(400);
    body["stop_at"] = json!({"outcome": "correct", "half_width": 0.02});
    let id = server.submit("campaign", &body).await;
    let result: Value =
        serde_json::from_str(server.result(&id).await.strip_suffix('}').unwrap()).unwrap();
    let file = data.path().join("job.json");
    body["kind"] = json!("campaign");
    std::fs::write(&file, body.to_string()).unwrap();
    let alone = crate::process::trackloom()
        .arg("run")
        .arg(&file)
        .args(["--format", "json"])
        .output()
        .unwrap();
    let alone: Value = serde_json::from_slice(&alone.stdout).unwrap();
    assert_eq!(result, alone["result"]);
    let runs: Vec<u64> = result["cells"]
        .as_array()
        .unwrap()
        .iter()
        .map(|cell| cell["runs"].as_u64().unwrap())
        .collect();
    assert!(
        runs.iter()
            .all(|runs| [10, 20, 40, 80, 160, 320, 400].contains(runs))
            && runs.iter().any(|&runs| runs < 400),
        "{runs:?}"
    );
}
