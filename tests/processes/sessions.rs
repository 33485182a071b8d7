//! Live sessions in servers that are killed at any moment: nothing that was acknowledged is lost, nothing is taken twice.

use crate::postgres::Postgres;
use crate::process::Server;
use serde_json::{Value, json};
use std::time::{Duration, Instant};

fn request(late: &str) -> Value {
    json!({
        "sensors": [{"sensor_id": "radar", "sigma_x_m": 10.0, "sigma_y_m": 10.0, "p_d": 0.9, "clutter_per_m2": 1e-8}],
        "associator": {"method": "jpda"}, "tracker": {"initial_speed_sigma_mps": 10.0}, "late": late
    })
}

/// Twenty targets on crossing ways, each missed at some scans; every ninth scan is swapped with the next.
fn scan(index: u64) -> Value {
    let time = index as f64;
    let mut detections = Vec::new();
    for target in 0..20_u64 {
        if !(index * 7 + target * 3).is_multiple_of(8) {
            let (lane, speed) = (300.0 * target as f64, 6.0 + target as f64);
            let wobble = 8.0 * (time * 1.7 + lane).sin();
            let along = speed * time + wobble;
            let (x_m, y_m) = if target % 2 == 0 {
                (along, lane - wobble)
            } else {
                (lane + wobble, along)
            };
            detections.push(json!({"x_m": x_m, "y_m": y_m}));
        }
    }
    json!({"sensor_id": "radar", "sequence": index, "time_s": time, "detections": detections})
}

fn order(count: u64) -> Vec<u64> {
    let mut order: Vec<u64> = (0..count).collect();
    for index in (8..count as usize - 1).step_by(9) {
        order.swap(index, index + 1);
    }
    order
}

async fn begin(server: &Server, body: &Value) -> String {
    let made = server
        .client
        .post(format!("{}/v1/sessions", server.url))
        .json(body)
        .send()
        .await
        .unwrap();
    assert_eq!(made.status(), 201);
    let made: Value = made.json().await.unwrap();
    made["id"].as_str().unwrap().to_owned()
}

/// The answer, where the server lived to give it.
async fn push(server: &Server, id: &str, index: u64) -> Option<Value> {
    let asked = server
        .client
        .post(format!("{}/v1/sessions/{id}/scans", server.url));
    let answer = asked.json(&scan(index)).send().await.ok()?;
    if answer.status() == 503 {
        return None;
    }
    assert_eq!(answer.status(), 200, "scan {index}");
    answer.json().await.ok()
}

/// Tracks and the latest events of a session.
async fn state(server: &Server, id: &str) -> (Value, Value) {
    let tracks = server.get(&format!("/v1/sessions/{id}/tracks")).await;
    let after = tracks["last_event"].as_u64().unwrap().saturating_sub(400);
    let events = server
        .get(&format!("/v1/sessions/{id}/history?after={after}"))
        .await;
    (tracks, events)
}

/// How often each session is killed: tests/sessions.sh asks for more.
fn kills_of_each() -> u64 {
    let asked = std::env::var("TRACKLOOM_SESSION_KILLS").ok();
    asked.map_or(25, |text| text.parse().unwrap())
}

#[tokio::test(flavor = "multi_thread")]
async fn a_session_that_is_killed_again_and_again_is_the_one_that_never_was() {
    /// Scans from kill to kill: with 25 kills more scans than a checkpoint waits for.
    const BETWEEN: u64 = 24;
    let (kills_of_each, scans) = (kills_of_each(), kills_of_each() * BETWEEN);
    for late in ["drop", "replay"] {
        let (data, quiet) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
        let whole = Server::start(quiet.path(), &[]);
        let wanted_id = begin(&whole, &request(late)).await;
        for index in order(scans) {
            push(&whole, &wanted_id, index).await.unwrap();
        }
        let wanted = state(&whole, &wanted_id).await;
        whole.kill();

        let mut server = Some(Server::start(data.path(), &[]));
        let id = begin(server.as_ref().unwrap(), &request(late)).await;
        let (mut kills, mut acknowledged) = (0, 0);
        for (place, index) in order(scans).into_iter().enumerate() {
            let is_due = place as u64 % BETWEEN == 7;
            if is_due {
                // Killed while a push is on its way, a little later each time.
                let running = server.take().unwrap();
                let client = running.client.clone();
                let url = format!("{}/v1/sessions/{id}/scans", running.url);
                let pushing = tokio::spawn(async move {
                    client
                        .post(url)
                        .json(&scan(index))
                        .send()
                        .await
                        .is_ok_and(|answer| answer.status() == 200)
                });
                tokio::time::sleep(Duration::from_micros(300 * (kills % 25))).await;
                running.kill();
                kills += 1;
                let was_acknowledged = pushing.await.unwrap();
                let next = Server::start(data.path(), &[]);
                let info = next.get(&format!("/v1/sessions/{id}")).await;
                let entries = info["entries"].as_u64().unwrap();
                assert!(
                    entries >= acknowledged + u64::from(was_acknowledged),
                    "{entries} of {acknowledged}"
                );
                server = Some(next);
            }
            let pushed = push(server.as_ref().unwrap(), &id, index).await.unwrap();
            acknowledged = pushed["entries"].as_u64().unwrap();
            assert_eq!(acknowledged, place as u64 + 1, "taken twice, or lost");
        }
        assert_eq!(kills, kills_of_each);
        let found = state(server.as_ref().unwrap(), &id).await;
        assert_eq!(found.0.to_string(), wanted.0.to_string(), "{late}");
        assert_eq!(found.1.to_string(), wanted.1.to_string(), "{late}");
        assert!(found.0["tracks"].as_array().unwrap().len() >= 15);
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn a_session_is_in_one_process_and_another_takes_it_over() {
    let Some(postgres) = Postgres::start() else {
        return;
    };
    let data = tempfile::tempdir().unwrap();
    let database = postgres.url();
    let arguments = ["--database-url", database.as_str()];
    let (first, second) = (
        Server::start(data.path(), &arguments),
        Server::start(data.path(), &arguments),
    );
    let id = begin(&first, &request("drop")).await;
    for index in 0..20 {
        push(&first, &id, index).await.unwrap();
    }
    let url = format!("{}/v1/sessions/{id}/scans", second.url);
    let refused = second
        .client
        .post(&url)
        .json(&scan(20))
        .send()
        .await
        .unwrap();
    assert_eq!(refused.status(), 409);
    let told: Value = refused.json().await.unwrap();
    assert_eq!(told["type"], "/problems/session_elsewhere", "{told}");
    let detail = told["detail"].as_str().unwrap();
    assert!(detail.contains(&format!("{};", first.url)), "{detail}");
    let before = state(&first, &id).await;
    first.kill();
    let since = Instant::now();
    let pushed = loop {
        let answer = second
            .client
            .post(&url)
            .json(&scan(20))
            .send()
            .await
            .unwrap();
        if answer.status() == 200 {
            break answer.json::<Value>().await.unwrap();
        }
        assert!(
            since.elapsed() < Duration::from_secs(15),
            "not taken over in 15 s"
        );
        tokio::time::sleep(Duration::from_millis(200)).await;
    };
    assert_eq!(pushed["entries"], 21);
    let after = state(&second, &id).await;
    let (earlier, later) = (
        before.1["items"].as_array().unwrap(),
        after.1["items"].as_array().unwrap(),
    );
    assert_eq!(earlier[..], later[..earlier.len()]);
    // One that ends in order gives its sessions back at once.
    let third = Server::start(data.path(), &arguments);
    second.terminate();
    assert!(push(&third, &id, 21).await.is_some());
}
