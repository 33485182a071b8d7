//! One campaign, many processes: whatever happens to them and to the database, its result is the same to the last byte.

use crate::campaigns::campaign;
use crate::postgres::Postgres;
use crate::process::{Process, Server};
use std::path::Path;
use std::time::Duration;

/// Runs of each of the two cells: some twenty chunks.
const RUNS: u32 = 1500;

#[tokio::test(flavor = "multi_thread")]
async fn a_campaign_has_one_result_on_a_file_and_on_many_processes_that_are_killed_stopped_and_cut_off()
 {
    let Some(postgres) = Postgres::start() else {
        return;
    };
    let alone = tempfile::tempdir().unwrap();
    let server = Server::start(alone.path(), &["--workers", "1"]);
    let expected = server
        .result(&server.submit("campaign", &campaign(RUNS)).await)
        .await;
    drop(server);
    let data = tempfile::tempdir().unwrap();
    one_round(&postgres, data.path(), &expected).await;
}

async fn one_round(postgres: &Postgres, data: &Path, expected: &str) {
    let url = postgres.url();
    let server = Server::start(data, &["--database-url", &url, "--workers", "1"]);
    let [killed, stopped, _left] = [1, 1, 1].map(|slots| Process::worker(&url, data, slots));
    let id = server.submit("campaign", &campaign(RUNS)).await;
    let has_done =
        |runs: u64| move |job: &serde_json::Value| job["progress"]["done"].as_u64() >= Some(runs);
    server.job_until(&id, has_done(200)).await;
    killed.kill();
    server.job_until(&id, has_done(400)).await;
    let (code, took) = stopped.terminate();
    assert_eq!(code, Some(0));
    assert!(took < Duration::from_secs(5), "{took:?}");
    postgres.down();
    tokio::time::sleep(Duration::from_secs(8)).await;
    postgres.up();
    let result = server.result(&id).await;
    assert!(
        result == expected,
        "the result differs from that of one process on a file"
    );
    let events = server.get(&format!("/v1/jobs/{id}/history")).await["events"]
        .as_array()
        .unwrap()
        .clone();
    let counts: Vec<u64> = events
        .iter()
        .filter(|event| event["type"] == "progress")
        .filter_map(|event| event["data"]["done"].as_u64())
        .collect();
    assert!(
        counts.is_sorted() && counts.last() == Some(&u64::from(2 * RUNS)),
        "runs are counted once: {counts:?}"
    );
    assert_eq!(
        events
            .iter()
            .filter(|event| event["type"] == "done")
            .count(),
        1
    );
    assert_eq!(postgres.number("SELECT count(*) FROM chunks").await, 0);
    assert_eq!(
        server.count("queued").await + server.count("running").await + server.count("failed").await,
        0
    );
}
