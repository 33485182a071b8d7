//! How many may connect, and for how long they are waited for. Over plain sockets, with times short enough for a test.

use crate::helpers::{Api, id, long, send, small};
use reqwest::Method;
use std::time::{Duration, Instant};
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::TcpStream;
use tokio::time::{sleep, timeout};

const HEADERS: Duration = Duration::from_millis(500);
const IDLE: Duration = Duration::from_millis(2500);
const PATIENCE: Duration = Duration::from_secs(30);

async fn hasty() -> Api {
    Api::start_with(|config| {
        let limits = &mut config.connections;
        (limits.header_time, limits.idle_time, limits.transfer_time) =
            (HEADERS, IDLE, Duration::from_millis(700));
    })
    .await
}

async fn connect(api: &Api) -> TcpStream {
    TcpStream::connect(api.base.strip_prefix("http://").unwrap())
        .await
        .unwrap()
}

/// What is still sent, and how long it takes until the server closes the connection.
async fn until_closed(stream: &mut TcpStream) -> (String, Duration) {
    let since = Instant::now();
    let mut said = Vec::new();
    // A reset is an end, too.
    let _ = timeout(PATIENCE, stream.read_to_end(&mut said))
        .await
        .expect("the server never closes it");
    (String::from_utf8_lossy(&said).into_owned(), since.elapsed())
}

const ASK: &[u8] = b"GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n";

#[tokio::test(flavor = "multi_thread")]
async fn who_sends_half_a_header_is_cut_off() {
    let api = hasty().await;
    let mut stream = connect(&api).await;
    stream
        .write_all(b"GET /healthz HTTP/1.1\r\nHost: local")
        .await
        .unwrap();
    let (said, took) = until_closed(&mut stream).await;
    assert_eq!(said, "");
    assert!(
        took >= HEADERS - Duration::from_millis(50) && took < IDLE,
        "{took:?}"
    );
    // Sending on, byte by byte, does not help; nor does a complete request before.
    let mut stream = connect(&api).await;
    stream.write_all(ASK).await.unwrap();
    sleep(Duration::from_millis(100)).await;
    let since = Instant::now();
    while since.elapsed() < PATIENCE && stream.write_all(b"G").await.is_ok() {
        sleep(Duration::from_millis(50)).await;
    }
    assert!(
        since.elapsed() < 4 * HEADERS,
        "the time of the headers, not that of idling: {:?}",
        since.elapsed()
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn an_idle_connection_is_closed_and_a_slow_answer_is_not() {
    let api = hasty().await;
    let mut stream = connect(&api).await;
    let (said, took) = until_closed(&mut stream).await;
    assert_eq!(said, "", "it has never asked");
    assert!(took >= IDLE - Duration::from_millis(50), "{took:?}");
    let mut stream = connect(&api).await;
    stream.write_all(ASK).await.unwrap();
    let (said, took) = until_closed(&mut stream).await;
    assert!(
        said.starts_with("HTTP/1.1 200 OK") && said.ends_with("{\"status\":\"ok\"}"),
        "{said}"
    );
    assert!(took >= IDLE - Duration::from_millis(50), "{took:?}");
    let job = api.post("/v1/jobs/simulate", &long()).await.ok(202);
    let since = Instant::now();
    let history = api
        .get(&format!(
            "/v1/jobs/{}/history?after=1000000&wait=6",
            id(&job)
        ))
        .await
        .ok(200);
    assert_eq!(history["events"], serde_json::json!([]));
    assert!(
        since.elapsed() > 2 * IDLE,
        "whoever waits for an answer is not idle"
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn a_body_that_stops_coming_is_refused_and_one_that_comes_is_not() {
    let api = hasty().await;
    let head = "POST /v1/jobs/simulate HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\nContent-Length: 200000\r\n\r\n";
    let mut stream = connect(&api).await;
    stream.write_all(head.as_bytes()).await.unwrap();
    stream.write_all(b"{ ").await.unwrap();
    let mut answer = vec![0; 4096];
    let length = timeout(PATIENCE, stream.read(&mut answer))
        .await
        .unwrap()
        .unwrap();
    let answer = String::from_utf8_lossy(&answer[..length]).into_owned();
    assert!(
        answer.starts_with("HTTP/1.1 408 ") && answer.contains("\"code\":\"request_timeout\""),
        "{answer}"
    );
    // 20 000 bytes each quarter of a second are enough, although the whole takes far longer than one stretch.
    let mut stream = connect(&api).await;
    stream
        .write_all(
            head.replace("\r\n\r\n", "\r\nConnection: close\r\n\r\n")
                .as_bytes(),
        )
        .await
        .unwrap();
    for _ in 0..10 {
        stream.write_all(&[b' '; 20_000]).await.unwrap();
        sleep(Duration::from_millis(250)).await;
    }
    let (said, _) = until_closed(&mut stream).await;
    assert!(
        said.starts_with("HTTP/1.1 400 ") && said.contains("malformed_json"),
        "it was read to its end: {said}"
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn who_does_not_read_is_cut_off() {
    let api = hasty().await;
    let mut body = small();
    body["scenario"]["scans"] = serde_json::json!(4000);
    body["scenario"]["sensors"][0]["clutter_per_scan"] = serde_json::json!(50.0);
    let job = api.run("simulate", &body).await;
    let path = format!("/v1/jobs/{}/artifacts/detections.csv", id(&job));
    let length = api.get(&path).await.text.len();
    assert!(length > 8 << 20, "more than sockets keep: {length}");
    let mut stream = connect(&api).await;
    stream
        .write_all(format!("GET {path} HTTP/1.1\r\nHost: localhost\r\n\r\n").as_bytes())
        .await
        .unwrap();
    sleep(Duration::from_secs(4)).await;
    let (said, _) = until_closed(&mut stream).await;
    assert!(
        said.len() < length,
        "all of {length} bytes were sent to who did not read"
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn one_connection_too_many_is_told_so() {
    let api = Api::start_with(|config| config.connections.connections = 2).await;
    let mut first = connect(&api).await;
    let mut second = connect(&api).await;
    for stream in [&mut first, &mut second] {
        stream.write_all(ASK).await.unwrap();
        assert!(stream.read(&mut [0; 1024]).await.unwrap() > 0);
    }
    let mut third = connect(&api).await;
    third.write_all(ASK).await.unwrap();
    let (said, _) = until_closed(&mut third).await;
    assert!(
        said.starts_with("HTTP/1.1 503 ")
            && said.contains("retry-after: 5")
            && said.contains("\"code\":\"too_many_connections\""),
        "{said}"
    );
    drop(first);
    let since = Instant::now();
    loop {
        let mut next = connect(&api).await;
        next.write_all(ASK).await.unwrap();
        let mut answer = [0; 1024];
        let length = next.read(&mut answer).await.unwrap();
        if answer[..length].starts_with(b"HTTP/1.1 200") {
            break;
        }
        assert!(since.elapsed() < PATIENCE);
        sleep(Duration::from_millis(50)).await;
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn event_streams_are_counted_for_each_client_and_for_all() {
    for (streams, of_client, detail) in [
        (
            100,
            2,
            "127.0.0.1 has 2 event streams open, as many as one client may",
        ),
        (
            2,
            100,
            "2 event streams are open, as many as the service has",
        ),
    ] {
        let api = Api::start_with(|config| {
            (
                config.connections.streams,
                config.connections.streams_per_client,
            ) = (streams, of_client);
        })
        .await;
        let job = api.post("/v1/jobs/simulate", &long()).await.ok(202);
        let path = format!("/v1/jobs/{}/events", id(&job));
        let open = async || api.request(Method::GET, &path).send().await.unwrap();
        let (first, _second) = (open().await, open().await);
        assert_eq!(
            (
                first.status(),
                first.headers()["content-type"].to_str().unwrap()
            ),
            (200.try_into().unwrap(), "text/event-stream")
        );
        assert_eq!(first.headers()["x-accel-buffering"], "no");
        let refused = api.get(&path).await;
        assert_eq!(refused.header("retry-after"), "5");
        let problem = refused.problem();
        assert_eq!(
            (
                problem["code"].as_str(),
                problem["detail"].as_str(),
                refused.status.as_u16()
            ),
            (Some("too_many_streams"), Some(detail), 503)
        );
        api.get(&format!("/v1/jobs/{}", id(&job))).await.ok(200);
        drop(first);
        let since = Instant::now();
        while open().await.status() != 200 {
            assert!(
                since.elapsed() < PATIENCE,
                "the place of a stream that was closed is free again"
            );
            sleep(Duration::from_millis(50)).await;
        }
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn an_answer_with_a_file_does_not_wait_for_the_clients_acknowledgement() {
    let api = Api::start().await;
    let job = api.run("simulate", &small()).await;
    let path = format!("/v1/jobs/{}/report", id(&job));
    let mut took = Vec::new();
    for _ in 0..60 {
        let since = Instant::now();
        send(api.request(Method::GET, &path)).await.ok(200);
        took.push(since.elapsed());
    }
    // Systems delay acknowledgements by 40 ms; the first ones of a connection are not delayed.
    let quickest = took[30..].iter().min().unwrap();
    assert!(*quickest < Duration::from_millis(25), "{took:?}");
}
