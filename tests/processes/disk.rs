//! A disk that is full for a while, a directory that cannot be written or is gone: what was accepted is done, what cannot be kept is
//! refused, and everything goes on without a restart.

use crate::campaigns::campaign;
use crate::process::{Process, Server};
use reqwest::StatusCode;
use reqwest::multipart::{Form, Part};
use serde_json::{Value, json};
use sqlx::Connection;
use sqlx::sqlite::{SqliteConnectOptions, SqliteConnection};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};

/// A small file system of its own; unmounted at the end.
struct Disk(tempfile::TempDir);

impl Disk {
    /// `None`, with the reason printed, where nothing can be mounted.
    fn mount(mebibytes: u32) -> Option<Disk> {
        let directory = tempfile::tempdir().unwrap();
        let size = format!("size={mebibytes}m");
        let mounted = Command::new("mount")
            .args(["-t", "tmpfs", "-o", &size, "trackloom-test"])
            .arg(directory.path())
            .output();
        match mounted {
            Ok(output) if output.status.success() => Some(Disk(directory)),
            Ok(output) => {
                println!(
                    "skipped: no file system can be mounted here: {}",
                    String::from_utf8_lossy(&output.stderr)
                );
                None
            }
            Err(error) => {
                println!("skipped: no file system can be mounted here: {error}");
                None
            }
        }
    }

    fn data(&self) -> PathBuf {
        self.0.path().join("data")
    }

    /// Leaves so many bytes.
    fn fill(&self, left: u64) {
        let mut file = std::fs::File::create(self.0.path().join("filler")).unwrap();
        for length in [1 << 16, 1 << 10, 1] {
            while file.write_all(&vec![7; length]).is_ok() {}
        }
        let length = file.metadata().unwrap().len();
        file.set_len(length - left).unwrap();
    }

    fn free(&self) {
        std::fs::remove_file(self.0.path().join("filler")).unwrap();
    }
}

impl Drop for Disk {
    fn drop(&mut self) {
        let _ = Command::new("umount")
            .arg("--lazy")
            .arg(self.0.path())
            .status();
    }
}

fn small(seed: u32) -> Value {
    json!({"seed": seed, "input": {"source": "preset", "preset": "liang2009-10"}})
}

/// Status, code of the problem, and `Retry-After`.
async fn post(server: &Server, path: &str, body: &Value) -> (StatusCode, Value, String) {
    let answer = server
        .client
        .post(format!("{}{path}", server.url))
        .json(body)
        .send()
        .await
        .unwrap();
    told(answer).await
}

async fn told(answer: reqwest::Response) -> (StatusCode, Value, String) {
    let retry = answer
        .headers()
        .get("retry-after")
        .map_or("", |value| value.to_str().unwrap())
        .to_owned();
    (answer.status(), answer.json().await.unwrap(), retry)
}

async fn upload(server: &Server, rows: usize) -> (StatusCode, Value, String) {
    let mut content = "time_s,scan,sensor_id,detection_id,x_m,y_m\n".to_owned();
    for row in 0..rows {
        content.push_str(&format!("{row},{row},radar,d{row},1,2\n"));
    }
    // Without a length, so that it is received before it is known to be too much.
    let form = Form::new().part("file", Part::stream(content).file_name("file.csv"));
    told(
        server
            .client
            .post(format!("{}/v1/datasets", server.url))
            .multipart(form)
            .send()
            .await
            .unwrap(),
    )
    .await
}

async fn ready(server: &Server) -> (StatusCode, String) {
    let (status, body, _) = told(
        server
            .client
            .get(format!("{}/readyz", server.url))
            .send()
            .await
            .unwrap(),
    )
    .await;
    (status, body["code"].as_str().unwrap_or("ready").to_owned())
}

/// What another process finds in the tables: it may write, and they are whole.
async fn assert_open_to_others(app: &Path) {
    let options = SqliteConnectOptions::new()
        .filename(app)
        .busy_timeout(Duration::from_secs(2));
    let mut other = SqliteConnection::connect_with(&options).await.unwrap();
    sqlx::raw_sql("BEGIN IMMEDIATE; CREATE TABLE other (x); ROLLBACK")
        .execute(&mut other)
        .await
        .unwrap();
    let whole: String = sqlx::query_scalar("PRAGMA integrity_check")
        .fetch_one(&mut other)
        .await
        .unwrap();
    assert_eq!(whole, "ok");
    other.close().await.unwrap();
}

/// Submits jobs until one is refused; gives those that were taken.
async fn submit_until_refused(server: &Server) -> Vec<String> {
    let mut taken = Vec::new();
    for seed in 100.. {
        let since = Instant::now();
        let (status, answer, retry) = post(server, "/v1/jobs/evaluate", &small(seed)).await;
        assert!(
            since.elapsed() < Duration::from_secs(10),
            "nobody waits for a lock: {:?}",
            since.elapsed()
        );
        if status != StatusCode::ACCEPTED {
            assert_eq!(
                (status.as_u16(), answer["code"].as_str(), retry.as_str()),
                (507, Some("insufficient_storage"), "30"),
                "{answer}"
            );
            break;
        }
        taken.push(answer["id"].as_str().unwrap().to_owned());
    }
    let (status, problem, retry) = upload(server, 20_000).await;
    assert_eq!(
        (status.as_u16(), problem["code"].as_str(), retry.as_str()),
        (507, Some("insufficient_storage"), "30"),
        "{problem}"
    );
    assert!(server.count("succeeded").await >= 1, "reads go on");
    taken
}

/// Fills the disk while jobs run, leaves it full for longer than any heartbeat, and makes room again.
async fn a_full_disk(min_free: &str, left: u64) {
    let Some(disk) = Disk::mount(24) else { return };
    let server = Server::start(&disk.data(), &["--min-free", min_free]);
    let first = server.submit("evaluate", &small(1)).await;
    let report = server.result(&first).await;
    let running = server.submit("campaign", &campaign(250)).await;
    let ending = server
        .submit("simulate", &crate::single::body(600, 1))
        .await;
    server
        .job_until(&running, |job| job["progress"]["done"].as_u64() > Some(0))
        .await;
    disk.fill(left);
    let mut taken = submit_until_refused(&server).await;
    if left == 0 {
        assert_eq!(
            ready(&server).await,
            (StatusCode::SERVICE_UNAVAILABLE, "disk".to_owned())
        );
    }
    tokio::time::sleep(Duration::from_secs(13)).await;
    taken.extend(submit_until_refused(&server).await);
    assert_eq!(
        server.job(&running).await["state"],
        "running",
        "its end cannot be written"
    );
    assert!(left > 0 || taken.is_empty(), "{taken:?}");
    disk.free();

    let since = Instant::now();
    assert_eq!(ready(&server).await, (StatusCode::OK, "ready".to_owned()));
    let next = server.submit("evaluate", &small(7)).await;
    server.result(&next).await;
    assert!(
        since.elapsed() < Duration::from_secs(30),
        "{:?}",
        since.elapsed()
    );
    assert_eq!(upload(&server, 10).await.0, StatusCode::CREATED);
    for id in taken.iter().chain([&running, &ending]) {
        server.result(id).await;
        assert_eq!(server.job(id).await["attempt"], 1, "nothing was done twice");
    }
    let again = server.submit("evaluate", &small(1)).await;
    assert_eq!(server.result(&again).await, report);
    let all = 5 + taken.len() as u64;
    assert_eq!(
        (
            server.count("succeeded").await,
            server.count("failed").await
        ),
        (all, 0),
        "what was refused left nothing"
    );
    assert_open_to_others(&disk.data().join("app.db")).await;
    let (code, took) = server.terminate();
    assert_eq!(code, Some(0));
    assert!(took < Duration::from_secs(3), "{took:?}");
    assert_everything_is_in_one_file(&disk.data().join("app.db"), all).await;
}

/// Whoever copies a directory of a service that has stopped may copy this file alone.
async fn assert_everything_is_in_one_file(app: &Path, jobs: u64) {
    let copied = tempfile::tempdir().unwrap();
    let copy = copied.path().join("copy.db");
    std::fs::copy(app, &copy).unwrap();
    let mut copy = SqliteConnection::connect_with(&SqliteConnectOptions::new().filename(copy))
        .await
        .unwrap();
    let count: i64 = sqlx::query_scalar("SELECT count(*) FROM jobs WHERE state = 'succeeded'")
        .fetch_one(&mut copy)
        .await
        .unwrap();
    assert_eq!(count.cast_unsigned(), jobs);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_disk_with_too_little_room_takes_nothing_new_and_loses_nothing() {
    a_full_disk("5%", 0).await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_disk_that_runs_full_in_the_midst_of_writing_loses_nothing() {
    a_full_disk("0", 4096).await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_directory_that_cannot_be_written_or_is_gone_takes_nothing_new() {
    let Some(disk) = Disk::mount(24) else { return };
    let data = disk.data();
    let server = Server::start(&data, &[]);
    let mount = |arguments: &[&str]| {
        assert!(
            Command::new("mount")
                .args(arguments)
                .arg(&data)
                .status()
                .unwrap()
                .success()
        )
    };
    let bound = data.to_str().unwrap().to_owned();
    mount(&["--bind", &bound]);
    mount(&["-o", "remount,bind,ro"]);
    assert_eq!(
        ready(&server).await,
        (StatusCode::SERVICE_UNAVAILABLE, "disk".to_owned())
    );
    assert_eq!(
        post(&server, "/v1/jobs/evaluate", &small(1))
            .await
            .0
            .as_u16(),
        507
    );
    assert_eq!(upload(&server, 10).await.0.as_u16(), 507);
    assert!(
        Command::new("umount")
            .arg(&data)
            .status()
            .unwrap()
            .success()
    );
    assert_eq!(ready(&server).await, (StatusCode::OK, "ready".to_owned()));
    server
        .result(&server.submit("evaluate", &small(1)).await)
        .await;

    std::fs::remove_dir_all(&data).unwrap();
    let (status, problem, _) = post(&server, "/v1/jobs/evaluate", &small(2)).await;
    assert_eq!(
        (status.as_u16(), problem["detail"].as_str()),
        (507, Some("the data directory is gone")),
        "{problem}"
    );
    assert_eq!(
        ready(&server).await,
        (StatusCode::SERVICE_UNAVAILABLE, "disk".to_owned())
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn a_damaged_file_is_neither_served_nor_computed_with_and_a_missing_one_is_told_of() {
    let directory = tempfile::tempdir().unwrap();
    let (data, log) = (directory.path().join("data"), directory.path().join("log"));
    let said = std::fs::File::create(&log).unwrap();
    let mut command = crate::process::trackloom();
    let process = Process::start(
        command
            .args(["serve", "--listen", "127.0.0.1:0", "--data"])
            .arg(&data)
            .stderr(said),
    );
    let server = Server::of(process);
    // More than is kept in memory.
    let (status, dataset, _) = upload(&server, 20_000).await;
    assert_eq!(status, StatusCode::CREATED);
    assert!(dataset["bytes"].as_u64() > Some(256 << 10));
    let (id, sha256) = (
        dataset["id"].as_str().unwrap(),
        dataset["sha256"].as_str().unwrap(),
    );
    let path = data.join("blobs").join(&sha256[..2]).join(sha256);
    let content = format!("{}/v1/datasets/{id}/content", server.url);
    assert_eq!(
        server.client.get(&content).send().await.unwrap().status(),
        StatusCode::OK
    );

    let mut bytes = std::fs::read(&path).unwrap();
    let last = bytes.len() - 2;
    bytes[last] ^= 1;
    std::fs::write(&path, &bytes).unwrap();
    let (status, problem, _) = told(server.client.get(&content).send().await.unwrap()).await;
    assert_eq!(
        (status.as_u16(), problem["code"].as_str()),
        (500, Some("damaged")),
        "{problem}"
    );
    let noise = json!([{"sensor_id": "radar", "sigma_x_m": 10.0, "sigma_y_m": 10.0}]);
    let body = json!({"input": {"source": "dataset", "dataset_id": id}, "sensors": noise});
    let job = server.ended(&server.submit("associate", &body).await).await;
    assert_eq!(
        (job["state"].as_str(), job["error"]["code"].as_str()),
        (Some("failed"), Some("damaged")),
        "{job}"
    );

    std::fs::remove_file(&path).unwrap();
    let (status, problem, _) = told(server.client.get(&content).send().await.unwrap()).await;
    assert_eq!(
        (status.as_u16(), problem["code"].as_str()),
        (410, Some("gone"))
    );
    drop(server);
    let said = std::fs::read_to_string(&log).unwrap();
    let path = path.to_str().unwrap();
    assert!(
        said.lines()
            .any(|line| line.contains("a file is damaged") && line.contains(path)),
        "{said}"
    );
    assert!(
        said.lines()
            .any(|line| line.contains("a file is missing") && line.contains(path)),
        "{said}"
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn what_a_power_failure_took_from_the_files_is_restored_from_the_tables() {
    let data = tempfile::tempdir().unwrap();
    let server = Server::start(data.path(), &[]);
    let id = server.submit("evaluate", &small(1)).await;
    let result = server.result(&id).await;
    server.kill();
    // As the power may leave files that were not synced: empty, half, or not there. It leaves alone what the tables have synced.
    let options = SqliteConnectOptions::new().filename(data.path().join("app.db"));
    let mut tables = SqliteConnection::connect_with(&options).await.unwrap();
    let noted: Vec<String> = sqlx::query_scalar("SELECT sha256 FROM unsynced_blobs")
        .fetch_all(&mut tables)
        .await
        .unwrap();
    tables.close().await.unwrap();
    if noted.is_empty() {
        println!("skipped: the files were synced before the process was killed");
        return;
    }
    for (index, sha256) in noted.iter().enumerate() {
        let path = data.path().join("blobs").join(&sha256[..2]).join(sha256);
        match index % 3 {
            0 => std::fs::remove_file(path).unwrap(),
            1 => std::fs::write(path, "").unwrap(),
            _ => {
                let bytes = std::fs::read(&path).unwrap();
                std::fs::write(path, &bytes[..bytes.len() / 2]).unwrap();
            }
        }
    }
    let server = Server::start(data.path(), &[]);
    assert_eq!(server.result(&id).await, result);
    let artifacts = server.get(&format!("/v1/jobs/{id}/artifacts")).await;
    for artifact in artifacts["items"].as_array().unwrap() {
        let href = artifact["href"].as_str().unwrap();
        let file = server
            .client
            .get(format!("{}{href}", server.url))
            .send()
            .await
            .unwrap();
        assert_eq!(
            (file.status(), file.bytes().await.unwrap().len() as u64),
            (StatusCode::OK, artifact["bytes"].as_u64().unwrap())
        );
    }
}
