//! A database that is not there, goes away, or is not the right one; and two servers that want the same file.

use crate::campaigns::campaign;
use crate::postgres::Postgres;
use crate::process::{Process, Server, refused, trackloom};
use crate::single::body;
use std::time::{Duration, Instant};

/// Claims are not waited for on the disk, so a database that crashes may forget the last of them: what was made then is dropped, and must
/// be made again.
#[tokio::test(flavor = "multi_thread")]
async fn what_a_database_that_crashed_has_forgotten_is_done_again() {
    let Some(postgres) = Postgres::start() else {
        return;
    };
    let (url, data) = (postgres.url(), tempfile::tempdir().unwrap());
    let server = Server::start(data.path(), &["--database-url", &url, "--workers", "1"]);
    let job = server.submit("simulate", &body(20_000, 1)).await;
    server.until("running", 1).await;
    let forgotten = postgres
        .number(
            "WITH lost AS (UPDATE jobs SET state = 'queued', attempt = attempt - 1, entry = NULL WHERE state = 'running' RETURNING 1)
             SELECT count(*) FROM lost",
        )
        .await;
    assert_eq!(forgotten, 1);
    assert_eq!(server.ended(&job).await["state"], "succeeded");
    let campaign = server.submit("campaign", &campaign(300)).await;
    let lose = "WITH lost AS (UPDATE chunks SET state = 'queued', attempt = attempt - 1, entry = NULL WHERE state = 'running' RETURNING 1)
                SELECT count(*) FROM lost";
    while postgres.number(lose).await == 0 {
        tokio::time::sleep(Duration::from_millis(5)).await;
    }
    assert_eq!(server.ended(&campaign).await["state"], "succeeded");
}

#[tokio::test(flavor = "multi_thread")]
async fn jobs_of_a_server_are_run_by_a_worker_and_heard_of_at_once() {
    let Some(postgres) = Postgres::start() else {
        return;
    };
    let (url, data) = (postgres.url(), tempfile::tempdir().unwrap());
    let server = Server::start(data.path(), &["--database-url", &url, "--workers", "1"]);
    // The server's own slot is taken, so that the worker has to run what follows.
    let long = server.submit("simulate", &body(100_000, 1)).await;
    server.until("running", 1).await;
    let worker = Process::worker(&url, data.path(), 1);
    let id = server.submit("simulate", &body(200, 2)).await;
    let waited = server
        .client
        .get(format!("{}/v1/jobs/{id}/events", server.url))
        .send()
        .await
        .unwrap()
        .text()
        .await
        .unwrap();
    assert!(waited.contains("\"state\":\"succeeded\""), "{waited}");
    let report = server.get(&format!("/v1/jobs/{id}/report")).await;
    assert_eq!(report["seed"], 2);
    // The worker is told of each job; a look at the queue every second would find half of them later.
    let mut waits_ms = Vec::new();
    for seed in 10..19 {
        let since = Instant::now();
        let id = server.submit("simulate", &body(1, seed)).await;
        server
            .job_until(&id, |job| job["started_at"].is_string())
            .await;
        waits_ms.push(since.elapsed().as_millis());
    }
    waits_ms.sort_unstable();
    assert!(waits_ms[4] < 300, "{waits_ms:?}");
    // A wish reaches the process that runs the job.
    let since = Instant::now();
    server.ask(&long, "cancel").await;
    assert_eq!(server.ended(&long).await["state"], "canceled");
    assert!(
        since.elapsed() < Duration::from_secs(5),
        "{:?}",
        since.elapsed()
    );
    // So it is with two at once, whichever process has which.
    let long = [
        server.submit("simulate", &body(100_000, 3)).await,
        server.submit("simulate", &body(100_000, 4)).await,
    ];
    server
        .job_until(&long[0], |job| job["state"] == "running")
        .await;
    for id in &long {
        server.ask(id, "cancel").await;
        assert_eq!(server.ended(id).await["state"], "canceled");
    }
    assert_eq!(worker.terminate().0, Some(0));
}

#[tokio::test(flavor = "multi_thread")]
async fn a_database_that_goes_away_is_told_of_and_waited_for() {
    let Some(postgres) = Postgres::start() else {
        return;
    };
    let (url, data) = (postgres.url(), tempfile::tempdir().unwrap());
    let server = Server::start(data.path(), &["--database-url", &url]);
    let id = server.submit("simulate", &body(200, 1)).await;
    let before = server.result(&id).await;
    postgres.down();
    let ready = server
        .client
        .get(format!("{}/readyz", server.url))
        .send()
        .await
        .unwrap();
    assert_eq!(ready.status(), 503);
    let problem: serde_json::Value = ready.json().await.unwrap();
    assert_eq!(problem["code"], "unavailable", "{problem}");
    let since = Instant::now();
    let submitted = server
        .client
        .post(format!("{}/v1/jobs/simulate", server.url))
        .json(&body(200, 3))
        .send()
        .await
        .unwrap();
    assert_eq!(
        (
            submitted.status().as_u16(),
            submitted.headers()["retry-after"].to_str().unwrap()
        ),
        (503, "5")
    );
    assert!(
        since.elapsed() < Duration::from_secs(8),
        "who asks is told soon: {:?}",
        since.elapsed()
    );
    postgres.up();
    server.get("/readyz").await;
    assert_eq!(server.result(&id).await, before);
    let next = server.submit("simulate", &body(200, 2)).await;
    server.result(&next).await;
}

#[tokio::test(flavor = "multi_thread")]
async fn what_cannot_be_used_is_refused_with_the_reason() {
    let data = tempfile::tempdir().unwrap();
    let (said, code) = refused(
        data.path(),
        &["--database-url", "mysql://me:secret@localhost/db"],
    );
    assert_eq!(code, Some(1));
    assert!(
        said.contains("mysql://localhost/db")
            && said.contains("postgres://user:password@host/database")
            && !said.contains("secret"),
        "{said}"
    );
    let (said, code) = refused(
        data.path(),
        &["--database-url", "postgres://me:secret@127.0.0.1:1/db"],
    );
    assert_eq!(code, Some(1));
    assert!(
        said.contains("cannot use the database postgres://127.0.0.1:1/db")
            && said.contains("tried for 20 s")
            && !said.contains("secret"),
        "{said}"
    );

    let server = Server::start(data.path(), &[]);
    let (said, code) = refused(data.path(), &[]);
    assert_eq!(code, Some(1));
    assert!(said.contains("is in use by another trackloom"), "{said}");
    drop(server);

    let Some(postgres) = Postgres::start() else {
        return;
    };
    let url = postgres.url();
    drop(Server::start(data.path(), &["--database-url", &url]));
    postgres
        .execute("INSERT INTO _sqlx_migrations (version, description, success, checksum, execution_time) VALUES (99, 'later', true, '', 0)")
        .await;
    let (said, code) = refused(data.path(), &["--database-url", &url]);
    assert_eq!(code, Some(1));
    assert!(
        said.contains("version 99") && said.contains("a newer trackloom has written it"),
        "{said}"
    );
    let worker = trackloom()
        .args(["worker", "--database-url", &url, "--data"])
        .arg(data.path())
        .output()
        .unwrap();
    assert_eq!(worker.status.code(), Some(1));
    assert!(
        String::from_utf8(worker.stderr)
            .unwrap()
            .contains("version 99")
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn what_was_ready_and_never_queued_is_found_and_another_place_for_files_is_refused() {
    let Some(postgres) = Postgres::start() else {
        return;
    };
    let (url, data, elsewhere) = (
        postgres.url(),
        tempfile::tempdir().unwrap(),
        tempfile::tempdir().unwrap(),
    );
    let server = Server::start(data.path(), &["--database-url", &url, "--workers", "1"]);
    let long = server.submit("simulate", &body(100_000, 1)).await;
    server.until("running", 1).await;
    let waiting = server.submit("simulate", &body(200, 2)).await;
    // As if the process had died after it took the job in and before it queued it.
    server.kill();
    postgres
        .execute("DELETE FROM queue WHERE worker IS NULL")
        .await;
    postgres
        .execute("UPDATE jobs SET enqueued_at = NULL WHERE state = 'queued'")
        .await;

    let (said, code) = refused(elsewhere.path(), &["--database-url", &url]);
    assert_eq!(code, Some(1));
    assert!(
        said.contains("the files of this database are kept elsewhere"),
        "{said}"
    );

    let server = Server::start(data.path(), &["--database-url", &url, "--workers", "2"]);
    server.result(&waiting).await;
    // What the dead process ran is given out again when it has missed three heartbeats.
    let since = Instant::now();
    let job = server.job_until(&long, |job| job["attempt"] == 2).await;
    assert!(
        since.elapsed() < Duration::from_secs(40),
        "{:?}",
        since.elapsed()
    );
    assert_eq!(job["state"], "running");
    server.ask(&long, "cancel").await;
}
