//! Work in children: what one of them needs too much of, dies of or does not hear takes nobody else with it.

use crate::campaigns::{campaign, number};
use crate::process::{Server, signal, trackloom};
use crate::single::body;
use reqwest::multipart::{Form, Part};
use serde_json::{Value, json};
use std::io::{Read, Write};
use std::process::Stdio;
use std::time::{Duration, Instant};

const PATIENCE: Duration = Duration::from_secs(120);

async fn upload(server: &Server, meta: &Value, content: Vec<u8>) -> (u16, Value) {
    let form = Form::new()
        .part("meta", Part::text(meta.to_string()))
        .part("file", Part::bytes(content).file_name("file"));
    let answer = server
        .client
        .post(format!("{}/v1/datasets", server.url))
        .multipart(form)
        .send()
        .await
        .unwrap();
    (answer.status().as_u16(), answer.json().await.unwrap())
}

async fn dataset(server: &Server, kind: &str, content: &str) -> Value {
    let (status, answer) =
        upload(server, &json!({"kind": kind}), content.as_bytes().to_vec()).await;
    assert_eq!(status, 201, "{answer}");
    json!({"source": "dataset", "dataset_id": answer["id"]})
}

/// Objects that go the same way, named in one column.
fn on_one_line(name: &str, objects: u32, times: u32) -> String {
    let mut text = format!("time_s,{name},x_m,y_m\n");
    for time in 0..times {
        (0..objects).for_each(|object| text.push_str(&format!("{time},{object},{time},0\n")));
    }
    text
}

/// A comparison of trajectories that is at it for minutes.
async fn deaf(server: &Server) -> Value {
    let (truth, tracks) = (
        on_one_line("truth_id", 600, 50),
        on_one_line("track_id", 600, 50),
    );
    let (truth, tracks) = (
        dataset(server, "truth", &truth).await,
        dataset(server, "tracks", &tracks).await,
    );
    json!({"truth": truth, "tracks": tracks, "metrics": [{"metric": "t_gospa"}]})
}

/// The processes that a process has started, with the hundredths of a second that each has computed.
fn children(process: u32) -> Vec<(u32, u64)> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir("/proc").unwrap() {
        let Ok(id) = entry.unwrap().file_name().to_string_lossy().parse::<u32>() else {
            continue;
        };
        // After the name in brackets: state, parent, ten more, then the time spent by itself and for it.
        let Ok(line) = std::fs::read_to_string(format!("/proc/{id}/stat")) else {
            continue;
        };
        let fields: Vec<&str> = line
            .rsplit_once(')')
            .unwrap()
            .1
            .split_whitespace()
            .collect();
        if fields[1] == process.to_string() && fields[0] != "Z" {
            found.push((
                id,
                fields[11].parse::<u64>().unwrap() + fields[12].parse::<u64>().unwrap(),
            ));
        }
    }
    found
}

/// The child that computes: the first that has done so for a fifth of a second.
async fn busy_child(server: &Server) -> u32 {
    child_at_work(server, 20).await
}

/// The first child that has computed for so many hundredths of a second.
async fn child_at_work(server: &Server, hundredths: u64) -> u32 {
    let (before, since) = (children(server.id()), Instant::now());
    loop {
        let spent = |id: u32| {
            before
                .iter()
                .find(|(known, _)| *known == id)
                .map_or(0, |(_, ticks)| *ticks)
        };
        if let Some((id, _)) = children(server.id())
            .into_iter()
            .find(|&(id, ticks)| ticks >= spent(id) + hundredths)
        {
            return id;
        }
        assert!(since.elapsed() < PATIENCE, "no child computes: {before:?}");
        tokio::time::sleep(Duration::from_millis(20)).await;
    }
}

async fn is_alive(server: &Server) -> bool {
    server
        .client
        .get(format!("{}/healthz", server.url))
        .send()
        .await
        .unwrap()
        .status()
        == 200
}

#[tokio::test(flavor = "multi_thread")]
async fn what_needs_too_much_memory_fails_alone() {
    let data = tempfile::tempdir().unwrap();
    let server = Server::start(data.path(), &["--job-memory", "100MiB"]);
    let beside = server.submit("simulate", &body(2_000, 1)).await;
    // Three million detections.
    let job = server.submit("simulate", &body(100_000, 2)).await;
    let ended = server.ended(&job).await;
    let problem = json!({
        "type": "/problems/memory_limit", "title": "It needs more memory than it may have", "status": 413, "code": "memory_limit",
        "detail": "the job needs more memory than the 100 MiB that --job-memory allows", "errors": []
    });
    assert_eq!(
        (&ended["state"], &ended["error"], &ended["attempt"]),
        (&json!("failed"), &problem, &json!(1))
    );
    server.result(&beside).await;

    // Three million points, all of them right.
    let points = on_one_line("truth_id", 1000, 3000).into_bytes();
    let (status, answer) = upload(&server, &json!({"kind": "truth"}), points).await;
    assert_eq!(
        (status, &answer["code"]),
        (413, &json!("memory_limit")),
        "{answer}"
    );
    assert_eq!(
        answer["detail"],
        "reading the file needs more memory than the 100 MiB that --job-memory allows"
    );
    assert!(is_alive(&server).await);
    dataset(&server, "truth", &on_one_line("truth_id", 2, 3)).await;
    server
        .result(&server.submit("simulate", &body(100, 3)).await)
        .await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_job_whose_process_dies_is_made_again_and_gives_the_same_and_twice_is_enough() {
    let data = tempfile::tempdir().unwrap();
    let server = Server::start(data.path(), &["--workers", "1"]);
    let reference = server.submit("simulate", &body(30_000, 7)).await;
    let reference = server.result(&reference).await;

    let job = server.submit("simulate", &body(30_000, 7)).await;
    let first = busy_child(&server).await;
    // A stop of the whole group is for the service to hear.
    signal(first, "TERM");
    signal(first, "INT");
    assert_eq!(busy_child(&server).await, first);
    signal(first, "KILL");
    assert_eq!(server.result(&job).await, reference);
    assert_eq!(server.job(&job).await["attempt"], 1);

    let job = server.submit("simulate", &body(100_000, 7)).await;
    let first = busy_child(&server).await;
    signal(first, "KILL");
    let second = busy_child(&server).await;
    assert_ne!(first, second);
    signal(second, "KILL");
    let ended = server.ended(&job).await;
    assert_eq!(
        (&ended["state"], &ended["error"]["code"]),
        (&json!("failed"), &json!("crashed"))
    );
    let detail = "the process of the job died twice, the second time while nothing else ran (signal: 9 (SIGKILL))";
    assert_eq!(ended["error"]["detail"], detail);
    server
        .result(&server.submit("simulate", &body(100, 8)).await)
        .await;
}

#[tokio::test(flavor = "multi_thread")]
async fn runs_whose_process_dies_twice_are_given_up_after_the_others_and_made_by_a_rerun() {
    let data = tempfile::tempdir().unwrap();
    let server = Server::start(data.path(), &["--workers", "1"]);
    let id = server.submit("campaign", &campaign(1000)).await;
    server
        .job_until(&id, |job| job["progress"]["done"].as_u64() > Some(0))
        .await;
    let failed = "SELECT count(*) FROM chunks WHERE state = 'failed'";
    while number(data.path(), failed).await == 0 {
        let child = child_at_work(&server, 5).await;
        signal(child, "KILL");
    }
    let job = server.ended(&id).await;
    assert_eq!(
        (&job["state"], &job["error"]["code"]),
        (&json!("failed"), &json!("crashed"))
    );
    let detail = job["error"]["detail"].as_str().unwrap();
    assert!(
        detail.starts_with("the process ended again and again while it made ")
            && detail.contains(", from cell '"),
        "{detail}"
    );
    let again = server.ask(&id, "rerun").await["id"]
        .as_str()
        .unwrap()
        .to_owned();
    let (result, whole) = (
        server.result(&again).await,
        server.submit("campaign", &campaign(1000)).await,
    );
    assert!(
        result == server.result(&whole).await,
        "put together from two jobs it is another result"
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn a_job_that_does_not_hear_frees_its_slot_when_it_is_canceled() {
    let data = tempfile::tempdir().unwrap();
    let server = Server::start(data.path(), &["--workers", "1"]);
    let deaf = deaf(&server).await;
    for is_stopped in [false, true] {
        let job = server.submit("evaluate", &deaf).await;
        let next = server.submit("simulate", &body(100, 3)).await;
        // Then it has read its data.
        let child = child_at_work(&server, 150).await;
        if is_stopped {
            signal(child, "STOP");
        }
        let since = Instant::now();
        server.ask(&job, "cancel").await;
        server
            .job_until(&next, |job| job["started_at"].is_string())
            .await;
        assert!(
            since.elapsed() < Duration::from_secs(5),
            "{:?}",
            since.elapsed()
        );
        assert_eq!(server.ended(&job).await["state"], "canceled");
        // A process that hears goes on with other work; one that does not is killed, and the system takes a moment to end it.
        while is_stopped && children(server.id()).iter().any(|(id, _)| *id == child) {
            assert!(
                since.elapsed() < Duration::from_secs(5),
                "its process lives on"
            );
            tokio::time::sleep(Duration::from_millis(20)).await;
        }
        server.result(&next).await;
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn no_child_outlives_its_service() {
    let data = tempfile::tempdir().unwrap();
    let server = Server::start(data.path(), &[]);
    let job = server.submit("evaluate", &deaf(&server).await).await;
    busy_child(&server).await;
    let before = children(server.id());
    assert!(before.len() >= 2, "one a slot: {before:?}");
    server.kill();
    let since = Instant::now();
    let is_gone = |id: u32| {
        let stat = std::fs::read_to_string(format!("/proc/{id}/stat"));
        stat.map_or(true, |line| {
            line.rsplit_once(')')
                .unwrap()
                .1
                .trim_start()
                .starts_with('Z')
        })
    };
    while !before.iter().all(|(id, _)| is_gone(*id)) {
        assert!(
            since.elapsed() < Duration::from_secs(5),
            "some of {before:?} live on"
        );
        tokio::time::sleep(Duration::from_millis(20)).await;
    }
    let server = Server::start(data.path(), &[]);
    server
        .job_until(&job, |job| job["state"] == "running" && job["attempt"] == 2)
        .await;
    server.ask(&job, "cancel").await;
    assert_eq!(server.ended(&job).await["state"], "canceled");
}

/// The next text that a child says.
fn said(output: &mut impl Read) -> Value {
    let mut length = [0; 4];
    output.read_exact(&mut length).unwrap();
    let mut text = vec![0; u32::from_le_bytes(length) as usize];
    output.read_exact(&mut text).unwrap();
    serde_json::from_slice(&text).unwrap()
}

#[test]
fn the_end_of_its_input_ends_a_child_whatever_it_does() {
    let directory = tempfile::tempdir().unwrap();
    for is_busy in [false, true] {
        let mut child = trackloom()
            .args(["child", "--memory", "1000000000"])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let (mut input, mut output) = (child.stdin.take().unwrap(), child.stdout.take().unwrap());
        assert_eq!(
            said(&mut output),
            json!({"Ready": {"version": env!("CARGO_PKG_VERSION")}})
        );
        if is_busy {
            let job = json!({
                "id": "01a22e59-a379-7579-bd41-3fdb911f7343", "kind": "simulate", "spec": body(100_000, 1), "inputs": [],
                "directory": directory.path()
            });
            let text = json!({"Work": {"Job": job}}).to_string();
            input.write_all(&(text.len() as u32).to_le_bytes()).unwrap();
            input.write_all(text.as_bytes()).unwrap();
            assert_eq!(said(&mut output)["Progress"]["step"], "load");
        }
        let since = Instant::now();
        drop(input);
        assert_eq!(child.wait().unwrap().code(), Some(0));
        assert!(
            since.elapsed() < Duration::from_secs(5),
            "{:?}",
            since.elapsed()
        );
    }
}

#[test]
fn a_size_that_is_none_is_refused_with_what_would_do() {
    let data = tempfile::tempdir().unwrap();
    for (given, said) in [
        (
            "2G",
            "a size is a whole number of bytes, or one with KiB, MiB, GiB or TiB",
        ),
        ("1MiB", "at least 64 MiB"),
    ] {
        let (stderr, code) = crate::process::refused(data.path(), &["--job-memory", given]);
        assert_eq!(code, Some(2));
        assert!(stderr.contains(said), "{stderr}");
    }
}
