//! Following a job: the stream, resuming it, and its JSON twin.

use crate::helpers::{Api, id, long, send, small, validation};
use futures::StreamExt;
use reqwest::Method;
use serde_json::{Value, json};

/// The events of a stream's text: id, type and data.
fn events(text: &str) -> Vec<(u64, String, Value)> {
    let field = |block: &str, name: &str| {
        block
            .lines()
            .find_map(|line| line.strip_prefix(name).map(|rest| rest.trim().to_owned()))
    };
    let blocks = text.split("\n\n").filter(|block| block.contains("data:"));
    blocks
        .map(|block| {
            let data = serde_json::from_str(&field(block, "data:").unwrap()).unwrap();
            (
                field(block, "id:").unwrap().parse().unwrap(),
                field(block, "event:").unwrap(),
                data,
            )
        })
        .collect()
}

#[tokio::test(flavor = "multi_thread")]
async fn a_stream_tells_everything_in_order_and_ends_when_the_job_does() {
    let api = Api::start().await;
    let job = api.post("/v1/jobs/simulate", &small()).await.ok(202);
    let answer = api.get(&format!("/v1/jobs/{}/events", id(&job))).await;
    assert_eq!(answer.header("content-type"), "text/event-stream");
    assert!(answer.text.starts_with("retry: 2000"), "{}", answer.text);
    let seen = events(&answer.text);
    let numbers: Vec<u64> = seen.iter().map(|event| event.0).collect();
    assert_eq!(numbers, (1..=seen.len() as u64).collect::<Vec<_>>());
    assert_eq!(
        seen.first().unwrap().2["data"],
        json!({"state": "queued", "attempt": 0})
    );
    let (_, name, last) = seen.last().unwrap();
    assert_eq!(
        (name.as_str(), &last["data"]),
        ("done", &json!({"state": "succeeded"}))
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn a_resumed_stream_has_no_gap_and_no_double() {
    let api = Api::start().await;
    let job = api.run("simulate", &small()).await;
    let path = format!("/v1/jobs/{}/events", id(&job));
    let all = events(&api.get(&path).await.text);
    assert!(all.len() >= 4, "{all:?}");
    for after in [0, 1, 2, all.len() - 1, all.len()] {
        let resumed = events(
            &api.get_with(&path, "last-event-id", &after.to_string())
                .await
                .text,
        );
        assert_eq!(resumed, all[after..], "after {after}");
        assert_eq!(
            events(&api.get(&format!("{path}?after={after}")).await.text),
            all[after..]
        );
    }
    let both = send(
        api.request(Method::GET, &format!("{path}?after=0"))
            .header("last-event-id", "2"),
    )
    .await;
    assert_eq!(
        events(&both.text),
        all[2..],
        "the header goes before the query"
    );
    let refused = api.get_with(&path, "last-event-id", "soon").await;
    let fault = json!({"pointer": "/headers/last-event-id", "code": "unknown_value", "detail": "the event's id is not a number",
        "allowed": "the id of an event of this job"});
    assert_eq!(
        refused.problem(),
        validation("the event's id is not a number", json!([fault]))
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn a_live_stream_can_be_left_and_taken_up() {
    let api = Api::start().await;
    let job = api.post("/v1/jobs/simulate", &long()).await.ok(202);
    let path = format!("/v1/jobs/{}/events", id(&job));
    let mut stream = api
        .request(Method::GET, &path)
        .send()
        .await
        .unwrap()
        .bytes_stream();
    let mut text = String::new();
    while events(&text).len() < 2 {
        text.push_str(std::str::from_utf8(&stream.next().await.unwrap().unwrap()).unwrap());
    }
    drop(stream);
    let first = events(&text[..text.rfind("\n\n").unwrap()]);
    let last = first.last().unwrap().0;
    send(api.request(Method::POST, &format!("/v1/jobs/{}/cancel", id(&job))))
        .await
        .ok(202);
    let rest = events(
        &api.get_with(&path, "last-event-id", &last.to_string())
            .await
            .text,
    );
    assert_eq!(rest.first().unwrap().0, last + 1);
    assert_eq!(rest.last().unwrap().2["data"]["state"], "canceled");
}

#[tokio::test(flavor = "multi_thread")]
async fn the_history_is_the_same_as_json() {
    let api = Api::start().await;
    let job = api.run("simulate", &small()).await;
    let base = format!("/v1/jobs/{}", id(&job));
    let streamed: Vec<Value> = events(&api.get(&format!("{base}/events")).await.text)
        .into_iter()
        .map(|event| event.2)
        .collect();
    let history = api.get(&format!("{base}/history")).await.ok(200);
    assert_eq!(history["events"], json!(streamed));
    assert_eq!(history["next_after"], streamed.len());
    let rest = api
        .get(&format!("{base}/history?after={}&wait=20", streamed.len()))
        .await
        .ok(200);
    assert_eq!(
        rest,
        json!({"events": [], "next_after": streamed.len()}),
        "an ended job keeps nobody waiting"
    );
    assert_eq!(
        api.get(&format!("{base}/history?wait=31")).await.problem()["errors"][0]["allowed"],
        "[0, 30]"
    );
}
