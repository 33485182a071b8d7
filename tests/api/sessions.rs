//! A live session: scans go in, tracks and events come out, and what is wrong is told before anything is taken.

use crate::helpers::{Answer, Api, send};
use reqwest::Method;
use serde_json::{Value, json};

fn request() -> Value {
    json!({
        "name": "harbour", "labels": {"site": "north"},
        "sensors": [{"sensor_id": "radar", "sigma_x_m": 10.0, "sigma_y_m": 10.0, "p_d": 0.9, "clutter_per_m2": 1e-8}],
        "tracker": {"initial_speed_sigma_mps": 10.0}
    })
}

trait Told {
    /// The body of a refusal with this code.
    fn refused(&self, code: &str) -> Value;
    /// A success without a body.
    fn nothing(&self);
}

impl Told for Answer {
    #[track_caller]
    fn refused(&self, code: &str) -> Value {
        let body = self.problem();
        assert_eq!(body["type"], format!("/problems/{code}"), "{body}");
        body
    }

    #[track_caller]
    fn nothing(&self) {
        assert_eq!((self.status.as_u16(), self.text.as_str()), (204, ""));
    }
}

/// Two targets, one going east and one north.
fn scan(index: u64) -> Value {
    let along_m = 20.0 * index as f64;
    json!({"sensor_id": "radar", "sequence": index, "time_s": 2.0 * index as f64, "detections": [
        {"detection_id": "a", "x_m": along_m, "y_m": 0.0}, {"detection_id": "b", "x_m": -3000.0, "y_m": along_m}
    ]})
}

async fn session(api: &Api, body: &Value) -> String {
    let made = api.post("/v1/sessions", body).await;
    let path = made.header("location").to_owned();
    let made = made.ok(201);
    assert_eq!(
        path,
        format!("/v1/sessions/{}", made["id"].as_str().unwrap())
    );
    assert_eq!(
        (&made["state"], &made["entries"]),
        (&json!("open"), &json!(0))
    );
    path
}

async fn push_lines(api: &Api, path: &str, text: String) -> Answer {
    let request = api.request(Method::POST, &format!("{path}/scans"));
    send(
        request
            .header("content-type", "application/x-ndjson")
            .body(text),
    )
    .await
}

#[tokio::test(flavor = "multi_thread")]
async fn a_session_is_fed_asked_and_closed_into_a_dataset_and_a_job() {
    let api = Api::start().await;
    let path = session(&api, &request()).await;
    for index in 0..8 {
        let pushed = api
            .post(&format!("{path}/scans"), &scan(index))
            .await
            .ok(200);
        assert_eq!(
            pushed["scans"],
            json!([{"fate": "taken", "sensor_id": "radar", "sequence": index}])
        );
        assert_eq!(
            (&pushed["entries"], &pushed["processed_to_s"]),
            (&json!(index + 1), &json!(2.0 * index as f64))
        );
    }
    let again = api.post(&format!("{path}/scans"), &scan(3)).await.ok(200);
    assert_eq!(
        (&again["scans"][0]["fate"], &again["entries"]),
        (&json!("duplicate"), &json!(8))
    );
    let tracks = api.get(&format!("{path}/tracks")).await.ok(200);
    let tracks = tracks["tracks"].as_array().unwrap().clone();
    assert_eq!(tracks.len(), 2);
    for track in &tracks {
        assert_eq!(
            (&track["status"], &track["detections"]),
            (&json!("confirmed"), &json!(8))
        );
    }
    let east = tracks
        .iter()
        .find(|track| track["x_m"].as_f64().unwrap() > 0.0)
        .unwrap();
    assert!(
        (east["x_m"].as_f64().unwrap() - 140.0).abs() < 5.0
            && (east["vx_mps"].as_f64().unwrap() - 10.0).abs() < 1.5
    );
    let ahead = api.get(&format!("{path}/tracks?at_s=24")).await.ok(200);
    let moved_m = ahead["tracks"][0]["x_m"].as_f64().unwrap() - tracks[0]["x_m"].as_f64().unwrap();
    assert!((moved_m - 10.0 * tracks[0]["vx_mps"].as_f64().unwrap()).abs() < 1e-6);
    let history = api.get(&format!("{path}/tracks/1")).await.ok(200);
    assert_eq!(history["points"].as_array().unwrap().len(), 8);
    let info = api.get(&path).await.ok(200);
    assert_eq!(
        (
            &info["labels"]["site"],
            &info["live"]["confirmed"],
            &info["live"]["counts"]["detections"]
        ),
        (&json!("north"), &json!(2), &json!(16))
    );

    let closed = api.post(&format!("{path}/close"), &json!({})).await.ok(200);
    assert_eq!(
        (&closed["state"], &closed["track_ids"]),
        (&json!("closed"), &json!(["1", "2"]))
    );
    let job = closed["job_id"].as_str().unwrap();
    api.jobs
        .wait(job.parse().unwrap(), std::time::Duration::from_secs(30))
        .await
        .unwrap();
    let report = api.get(&format!("/v1/jobs/{job}/report")).await.ok(200);
    let tracked = report["result"]["association"]["tracks"].as_array();
    assert_eq!(tracked.map(Vec::len), Some(2), "{report}");
    let dataset = api
        .get(&format!(
            "/v1/datasets/{}",
            closed["dataset_id"].as_str().unwrap()
        ))
        .await
        .ok(200);
    assert_eq!(
        (&dataset["scans"], &dataset["reports"][0]["positions"]),
        (&json!(8), &json!(16)),
        "{dataset}"
    );
    api.post(&format!("{path}/scans"), &scan(9))
        .await
        .refused("session_closed");
    api.delete(&path).await.nothing();
    api.get(&path).await.refused("gone");
    assert_eq!(api.get("/v1/sessions").await.ok(200)["items"], json!([]));
}

#[tokio::test(flavor = "multi_thread")]
async fn of_a_batch_with_a_fault_nothing_is_taken() {
    let api = Api::start().await;
    let path = session(&api, &request()).await;
    let good: Vec<String> = (0..3).map(|index| scan(index).to_string()).collect();
    let bad = json!({"sensor_id": "sonar", "time_s": 1.0, "detections": [{"x_m": 1.0}]});
    let worse = json!({"sensor_id": "radar", "time_s": 7.0, "detections": [{"x_m": 1.0}, {"x_m": "far", "y_m": 2.0}]});
    let text = format!("{}\n\n{bad}\n{worse}\n{}", good[0], good[1]);
    let told = push_lines(&api, &path, text).await.refused("validation");
    let places: Vec<(u64, &str)> = told["errors"]
        .as_array()
        .unwrap()
        .iter()
        .map(|fault| {
            (
                fault["line"].as_u64().unwrap(),
                fault["pointer"].as_str().unwrap(),
            )
        })
        .collect();
    assert_eq!(places, [(3, "/sensor_id"), (4, "/detections/1/x_m")]);
    assert_eq!(api.get(&path).await.ok(200)["entries"], 0);
    let pushed = push_lines(&api, &path, good.join("\n")).await.ok(200);
    assert_eq!(
        (
            pushed["scans"].as_array().unwrap().len(),
            &pushed["entries"]
        ),
        (3, &json!(3))
    );
    // Twice in one batch is once.
    let twice = push_lines(&api, &path, format!("{}\n{}", scan(3), scan(3)))
        .await
        .ok(200);
    let fates: Vec<&Value> = twice["scans"]
        .as_array()
        .unwrap()
        .iter()
        .map(|one| &one["fate"])
        .collect();
    assert_eq!(fates, ["taken", "duplicate"]);
    let late = json!({"sensor_id": "radar", "sequence": 9, "time_s": 0.5, "detections": []});
    let late = api.post(&format!("{path}/scans"), &late).await.ok(200);
    assert_eq!(late["scans"][0]["fate"], "late_dropped");
    let kinds: Vec<&Value> = late["events"]
        .as_array()
        .unwrap()
        .iter()
        .map(|event| &event["kind"])
        .collect();
    assert_eq!(kinds, ["gap", "late_dropped"]);
    let text = api
        .request(Method::POST, &format!("{path}/scans"))
        .header("content-type", "text/csv")
        .body("a,b");
    send(text).await.refused("unsupported_media_type");
    let unknown = "/v1/sessions/0198c0de-0000-7000-8000-000000000000";
    api.get(unknown).await.refused("not_found");
    let refused = api
        .post(
            "/v1/sessions",
            &json!({"sensors": [{"sensor_id": "r", "sigma_x_m": 1.0, "sigma_y_m": 1.0}]}),
        )
        .await;
    assert_eq!(
        refused.refused("validation")["errors"][0]["pointer"],
        "/sensors/0/p_d"
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn events_are_followed_without_gap_and_waited_for() {
    let api = Api::start().await;
    let path = session(&api, &request()).await;
    let waiting = {
        let request = api.request(Method::GET, &format!("{path}/history?wait=20"));
        tokio::spawn(send(request))
    };
    tokio::time::sleep(std::time::Duration::from_millis(200)).await;
    api.post(&format!("{path}/scans"), &scan(0)).await.ok(200);
    let first = waiting.await.unwrap().ok(200);
    assert_eq!(first["items"][0]["kind"], "started");
    for index in 1..6 {
        api.post(&format!("{path}/scans"), &scan(index))
            .await
            .ok(200);
    }
    // Nothing is detected any more: both tracks coast, then end.
    for index in 6..30 {
        let empty = json!({"sensor_id": "radar", "sequence": index, "time_s": 2.0 * index as f64});
        api.post(&format!("{path}/scans"), &empty).await.ok(200);
    }
    let all = api.get(&format!("{path}/history")).await.ok(200);
    let kinds: Vec<&str> = all["items"]
        .as_array()
        .unwrap()
        .iter()
        .map(|event| event["kind"].as_str().unwrap())
        .collect();
    assert_eq!(
        kinds,
        [
            "started",
            "started",
            "confirmed",
            "confirmed",
            "coasted",
            "coasted",
            "ended",
            "ended"
        ]
    );
    let mut response = api
        .request(Method::GET, &format!("{path}/events"))
        .header("last-event-id", "5")
        .send()
        .await
        .unwrap();
    assert_eq!(response.headers()["content-type"], "text/event-stream");
    let mut text = String::new();
    while !text.contains("id: 8") {
        text.push_str(std::str::from_utf8(&response.chunk().await.unwrap().unwrap()).unwrap());
    }
    let ids: Vec<&str> = text
        .lines()
        .filter_map(|line| line.strip_prefix("id: "))
        .collect();
    assert_eq!(ids, ["6", "7", "8"]);
    assert!(text.contains("event: ended"));
    api.post(&format!("{path}/scans"), &scan(30)).await.ok(200);
    api.delete(&format!("{path}/tracks/3")).await.nothing();
    api.delete(&format!("{path}/tracks/3"))
        .await
        .refused("not_found");
    let told = api.get(&format!("{path}/history?after=8")).await.ok(200);
    let last = told["items"].as_array().unwrap().last().unwrap().clone();
    assert_eq!(
        (&last["kind"], &last["track_id"]),
        (&json!("ended"), &json!("3"))
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn an_open_session_is_recorded_up_to_now() {
    let api = Api::start().await;
    let path = session(&api, &request()).await;
    let nothing = api.post(&format!("{path}/recording"), &json!({})).await;
    assert_eq!(nothing.refused("validation")["errors"][0]["code"], "empty");
    let lines: Vec<String> = (0..5).map(|index| scan(index).to_string()).collect();
    push_lines(&api, &path, lines.join("\n")).await.ok(200);
    let first = api
        .post(&format!("{path}/recording"), &json!({}))
        .await
        .ok(201);
    let same = api
        .post(&format!("{path}/recording"), &json!({}))
        .await
        .ok(200);
    assert_eq!(first["id"], same["id"]);
    api.post(&format!("{path}/scans"), &scan(5)).await.ok(200);
    let more = api
        .post(&format!("{path}/recording"), &json!({}))
        .await
        .ok(201);
    assert_eq!((&first["scans"], &more["scans"]), (&json!(5), &json!(6)));
    let listed = api.get("/v1/sessions?count=true").await.ok(200);
    assert_eq!(
        (&listed["total"], &listed["items"][0]["name"]),
        (&json!(1), &json!("harbour"))
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn tracks_are_begun_and_ended_by_hand_and_a_paused_session_takes_no_scan() {
    let api = Api::start().await;
    let path = session(&api, &request()).await;
    let track =
        json!({"x_m": 5000.0, "y_m": 40.0, "vy_mps": -3.0, "sigma_m": 20.0, "sigma_mps": 2.0});
    let early = api.post(&format!("{path}/tracks"), &track).await;
    assert!(
        early
            .refused("validation")
            .to_string()
            .contains("before the first scan")
    );
    api.post(&format!("{path}/scans"), &scan(0)).await.ok(200);
    let begun = api.post(&format!("{path}/tracks"), &track).await;
    let place = begun.header("location").to_owned();
    let begun = begun.ok(201);
    assert_eq!(
        (&begun["status"], &begun["x_m"]),
        (&json!("confirmed"), &json!(5000.0))
    );
    assert_eq!(begun["covariance"][0], json!(400.0));
    assert_eq!(api.get(&place).await.ok(200)["track"], begun);
    let wrong = api
        .post(&format!("{path}/tracks"), &json!({"x_m": 1.0}))
        .await;
    let wrong = wrong.refused("validation");
    let places: Vec<&str> = wrong["errors"]
        .as_array()
        .unwrap()
        .iter()
        .map(|fault| fault["pointer"].as_str().unwrap())
        .collect();
    assert_eq!(places, ["/y_m", "/sigma_m", "/sigma_mps"]);
    let paused = api.post(&format!("{path}/pause"), &json!({})).await.ok(200);
    assert_eq!(paused["live"]["is_paused"], json!(true));
    assert_eq!(
        api.post(&format!("{path}/pause"), &json!({})).await.ok(200)["entries"],
        paused["entries"]
    );
    let held = api.post(&format!("{path}/scans"), &scan(1)).await;
    assert_eq!(held.status.as_u16(), 409);
    held.refused("session_paused");
    api.delete(&place).await.nothing();
    let resumed = api
        .post(&format!("{path}/resume"), &json!({}))
        .await
        .ok(200);
    assert_eq!(
        (
            &resumed["live"]["is_paused"],
            &resumed["live"]["counts"]["by_hand"]
        ),
        (&json!(false), &json!(2))
    );
    api.post(&format!("{path}/scans"), &scan(1)).await.ok(200);
    let metrics = api.get("/metrics").await;
    assert!(
        metrics.text.contains("trackloom_sessions 1\n"),
        "{}",
        metrics.text
    );
    assert!(metrics.text.contains("trackloom_session_tracks 2\n"));
    assert!(metrics.text.contains("trackloom_session_lag_seconds 0\n"));
    // The job does not know what was done by hand, so its tracks have no other names.
    let closed = api.post(&format!("{path}/close"), &json!({})).await.ok(200);
    assert!(
        closed["job_id"].is_string() && closed.get("track_ids").is_none(),
        "{closed}"
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn a_picture_has_tracks_and_the_scans_since_the_one_before() {
    let api = Api::start().await;
    let path = session(&api, &request()).await;
    let empty = api.get(&format!("{path}/picture")).await.ok(200);
    assert_eq!(
        (&empty["last_scan"], &empty["scans"], &empty["tracks"]),
        (&json!(0), &json!([]), &json!([]))
    );
    assert_eq!(empty["sensors"], json!([{"sensor_id": "radar"}]));
    let waiting = {
        let request = api.request(Method::GET, &format!("{path}/picture?after_scan=0&wait=20"));
        tokio::spawn(send(request))
    };
    tokio::time::sleep(std::time::Duration::from_millis(200)).await;
    api.post(&format!("{path}/scans"), &scan(1)).await.ok(200);
    let first = waiting.await.unwrap().ok(200);
    assert_eq!(
        first["scans"],
        json!([{
            "number": 1, "sensor_id": "radar", "time_s": 2.0, "detections": 2,
            "x_m": [20.0, -3000.0], "y_m": [0.0, 20.0], "bearing_deg": []
        }])
    );
    for index in 2..6 {
        api.post(&format!("{path}/scans"), &scan(index))
            .await
            .ok(200);
    }
    let next = api
        .get(&format!("{path}/picture?after_scan=3&wait=20"))
        .await
        .ok(200);
    let numbers: Vec<&Value> = next["scans"]
        .as_array()
        .unwrap()
        .iter()
        .map(|scan| &scan["number"])
        .collect();
    assert_eq!(numbers, [4, 5]);
    assert_eq!(
        (&next["processed_to_s"], &next["lag_s"], &next["last_event"]),
        (&json!(10.0), &json!(0.0), &json!(4))
    );
    let tracks = api.get(&format!("{path}/tracks")).await.ok(200);
    assert_eq!(next["tracks"], tracks["tracks"]);
    assert_eq!(next.get("ways"), None);
    let whole = api.get(&format!("{path}/picture")).await.ok(200);
    assert_eq!(
        whole["ways"][0]["time_s"],
        json!([2.0, 4.0, 6.0, 8.0, 10.0])
    );
    let listed = api.get("/v1/sessions").await.ok(200);
    assert_eq!(
        (
            &listed["items"][0]["live"]["confirmed"],
            &listed["items"][0]["live"]["counts"]["scans"]
        ),
        (&json!(2), &json!(5))
    );
    // Whoever waits is told when it is closed.
    let waiting = {
        let request = api.request(Method::GET, &format!("{path}/picture?after_scan=5&wait=20"));
        tokio::spawn(send(request))
    };
    tokio::time::sleep(std::time::Duration::from_millis(200)).await;
    api.post(&format!("{path}/close"), &json!({})).await.ok(200);
    waiting.await.unwrap().refused("session_closed");
    api.get(&format!("{path}/picture?after_scan=-1"))
        .await
        .refused("validation");
}

#[tokio::test(flavor = "multi_thread")]
async fn a_session_takes_scans_at_its_rate_and_is_closed_at_its_size() {
    let api = Api::start().await;
    let mut body = request();
    body["max_scans_per_s"] = json!(0.01);
    body["max_log_bytes"] = json!(500);
    let path = session(&api, &body).await;
    let first = scan(0);
    api.post(&format!("{path}/scans"), &first).await.ok(200);
    let early = api.post(&format!("{path}/scans"), &scan(1)).await;
    assert_eq!(early.status.as_u16(), 429);
    assert!(early.header("retry-after").parse::<u64>().unwrap() >= 1);
    early.refused("session_full");
    let open = api.get(&path).await.ok(200);
    let bytes = open["log_bytes"].as_u64().unwrap();
    // An entry says of which kind it is, too.
    let text = first.to_string().len() as u64;
    assert!((text..text + 50).contains(&bytes), "{bytes} of {text}");
    assert_eq!(open["entries"], json!(1));

    body["max_scans_per_s"] = json!(1000.0);
    let path = session(&api, &body).await;
    for index in 0..4 {
        api.post(&format!("{path}/scans"), &scan(index))
            .await
            .ok(200);
    }
    assert!(api.get(&path).await.ok(200)["log_bytes"].as_u64().unwrap() >= 500);
    let closed = until_closed(&api, &path).await;
    assert!(closed["dataset_id"].is_string() && closed["job_id"].is_string());
    assert_eq!(closed["entries"], json!(4));
}

#[tokio::test(flavor = "multi_thread")]
async fn an_old_session_is_closed() {
    let api = Api::start().await;
    let mut body = request();
    body["max_age_s"] = json!(1.0);
    let path = session(&api, &body).await;
    let kept = session(&api, &request()).await;
    let closed = until_closed(&api, &path).await;
    // Nothing came, so there is no data set.
    assert!(closed.get("dataset_id").is_none());
    let refused = api.post(&format!("{path}/scans"), &scan(0)).await;
    refused.refused("session_closed");
    assert_eq!(api.get(&kept).await.ok(200)["state"], json!("open"));
}

async fn until_closed(api: &Api, path: &str) -> Value {
    for _ in 0..300 {
        let session = api.get(path).await.ok(200);
        if session["state"] == json!("closed") {
            return session;
        }
        tokio::time::sleep(std::time::Duration::from_millis(100)).await;
    }
    panic!("it was not closed");
}
