//! Stopping: soon, with streams open and work running.

use crate::helpers::{Api, id, long, problem};
use futures::StreamExt;
use reqwest::Method;
use std::time::{Duration, Instant};

#[tokio::test(flavor = "multi_thread")]
async fn a_stop_ends_streams_and_waits_and_is_soon_over() {
    let mut api = Api::start().await;
    let job = api.post("/v1/jobs/simulate", &long()).await.ok(202);
    let path = format!("/v1/jobs/{}/events", id(&job));
    let stream = api
        .request(Method::GET, &path)
        .send()
        .await
        .unwrap()
        .bytes_stream();
    let reader = tokio::spawn(stream.for_each(|_| async {}));
    let waiting = api
        .request(
            Method::GET,
            &format!("/v1/jobs/{}/history?after=1000&wait=30", id(&job)),
        )
        .send();
    let waiting = tokio::spawn(waiting);
    tokio::time::sleep(Duration::from_millis(200)).await;
    let start = Instant::now();
    api.stop().await;
    let took = start.elapsed();
    assert!(took < Duration::from_secs(3), "{took:?}");
    tokio::time::timeout(Duration::from_secs(1), reader)
        .await
        .expect("the stream is closed")
        .unwrap();
    tokio::time::timeout(Duration::from_secs(1), waiting)
        .await
        .expect("nobody is kept waiting")
        .unwrap()
        .ok();
    assert!(
        api.client.get(&api.base).send().await.is_err(),
        "nobody listens any more"
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn a_service_that_stops_says_so_and_takes_no_work() {
    let api = Api::start().await;
    api.get("/readyz").await.ok(200);
    api.jobs.shutdown().await;
    let title = "The service is shutting down";
    assert_eq!(
        api.get("/readyz").await.problem(),
        problem("shutting_down", 503, title, "the service is shutting down")
    );
    assert_eq!(api.get("/healthz").await.status, 200);
    let refused = api
        .post("/v1/jobs/simulate", &crate::helpers::small())
        .await;
    assert_eq!(
        refused.problem(),
        problem("shutting_down", 503, title, "the service is shutting down")
    );
    assert_eq!(refused.header("retry-after"), "5");
}

#[tokio::test(flavor = "multi_thread")]
async fn a_full_queue_says_when_to_come_back() {
    let api = Api::start_with(|config| (config.slots, config.queue_limit) = (1, 1)).await;
    let mut refused = None;
    for _ in 0..4 {
        let answer = api.post("/v1/jobs/simulate", &long()).await;
        if answer.status == 503 {
            refused = Some(answer);
        }
    }
    let refused = refused.expect("a queue of one is full at the fourth job");
    assert_eq!(
        refused.problem(),
        problem("queue_full", 503, "The queue is full", "the queue is full")
    );
    assert_eq!(refused.header("retry-after"), "5");
}
