//! Old jobs make room: by count, by bytes, but for those that are pinned and what these were made from.

use crate::helpers::{Api, id, send, small};
use reqwest::Method;
use serde_json::{Value, json};
use std::time::{Duration, Instant};

/// A job of another seed: its files have other contents, some hundred kilobytes.
async fn job(api: &Api, seed: u32) -> Value {
    let mut body = small();
    body["seed"] = json!(seed);
    body["scenario"]["scans"] = json!(1000);
    api.run("simulate", &body).await
}

async fn pin(api: &Api, job: &Value, pinned: bool) -> Value {
    let path = format!("/v1/jobs/{}", id(job));
    let request = api.request(Method::PATCH, &path);
    send(request.json(&json!({"pinned": pinned}))).await.ok(200)
}

/// The bytes of all blobs on the disk.
fn bytes_of_blobs(api: &Api) -> u64 {
    let mut bytes = 0;
    for folder in std::fs::read_dir(api.data().join("blobs")).unwrap() {
        let folder = folder.unwrap();
        // Beside the folders of blobs lies the name of the store.
        if folder.file_name().len() == 2 {
            let blobs = std::fs::read_dir(folder.path()).unwrap();
            bytes += blobs
                .map(|blob| blob.unwrap().metadata().unwrap().len())
                .sum::<u64>();
        }
    }
    bytes
}

async fn status(api: &Api, job: &Value) -> u16 {
    let answer = api.get(&format!("/v1/jobs/{}", id(job))).await;
    answer.status.as_u16()
}

/// Waits for the upkeep.
async fn until(api: &Api, ended_jobs: u64) -> Value {
    let start = Instant::now();
    loop {
        let usage = api.get("/v1/usage").await.ok(200);
        if usage["ended_jobs"] == ended_jobs {
            return usage;
        }
        assert!(start.elapsed() < Duration::from_secs(60), "{usage}");
        tokio::time::sleep(Duration::from_millis(200)).await;
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn the_newest_jobs_are_kept_and_the_pinned_ones() {
    let api = Api::start_with(|config| config.keep_jobs = Some(2)).await;
    let first = job(&api, 1).await;
    assert_eq!(first["pinned"], false);
    assert_eq!(pin(&api, &first, true).await["pinned"], true);
    let mut others = Vec::new();
    for seed in 2..7 {
        others.push(job(&api, seed).await);
    }
    // The datasets that they made go with them; each job here makes two.
    let start = Instant::now();
    while api.get("/v1/datasets?count=true").await.ok(200)["total"] != 6 {
        assert!(start.elapsed() < Duration::from_secs(60));
        tokio::time::sleep(Duration::from_millis(200)).await;
    }
    let usage = until(&api, 2).await;
    assert_eq!(
        (&usage["pinned_jobs"], &usage["keep_jobs"]),
        (&json!(1), &json!(2))
    );
    let mut found = Vec::new();
    for other in &others {
        found.push(status(&api, other).await);
    }
    assert_eq!(found, [410, 410, 410, 200, 200]);
    assert_eq!(status(&api, &first).await, 200);
    // Their blobs go last.
    while usage["files_bytes"].as_u64() != Some(bytes_of_blobs(&api)) {
        let blobs = bytes_of_blobs(&api);
        assert!(
            start.elapsed() < Duration::from_secs(60),
            "{blobs}: {usage}"
        );
        tokio::time::sleep(Duration::from_millis(200)).await;
    }
    pin(&api, &first, false).await;
    until(&api, 2).await;
    assert_eq!(status(&api, &first).await, 410, "it is the oldest");
}

#[tokio::test(flavor = "multi_thread")]
async fn what_a_pinned_job_was_made_from_stays() {
    let api = Api::start_with(|config| config.keep_jobs = Some(0)).await;
    let mut body = small();
    body["name"] = json!("source");
    let request = api.request(Method::POST, "/v1/jobs/simulate").json(&body);
    let source = send(request).await.ok(202);
    let input = json!({"input": {"source": "job", "job_id": id(&source)}});
    let user = api.post("/v1/jobs/associate", &input).await.ok(202);
    pin(&api, &user, true).await;
    let lone = job(&api, 9).await;
    until(&api, 0).await;
    let mut found = Vec::new();
    for one in [&source, &user, &lone] {
        found.push(status(&api, one).await);
    }
    assert_eq!(found, [200, 200, 410]);
    pin(&api, &user, false).await;
    let start = Instant::now();
    while (status(&api, &source).await, status(&api, &user).await) != (410, 410) {
        assert!(start.elapsed() < Duration::from_secs(60));
        tokio::time::sleep(Duration::from_millis(200)).await;
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn what_is_kept_stays_below_its_limit() {
    let empty = Api::start().await.get("/v1/usage").await.ok(200);
    let of_job = {
        let api = Api::start().await;
        job(&api, 1).await;
        api.get("/v1/usage").await.ok(200)["files_bytes"]
            .as_u64()
            .unwrap()
    };
    let limit = empty["tables_bytes"].as_u64().unwrap() + 400_000 + 10 * of_job;
    let api = Api::start_with(|config| config.max_data_bytes = Some(limit)).await;
    let first = job(&api, 1).await;
    pin(&api, &first, true).await;
    let report = format!("/v1/jobs/{}/report", id(&first));
    let wanted = api.get(&report).await.text;
    let mut jobs = Vec::new();
    for seed in 2..40 {
        jobs.push(job(&api, seed).await);
        let blobs = bytes_of_blobs(&api);
        assert!(blobs <= limit, "{blobs} of {limit} after {seed} jobs");
    }
    assert_eq!(api.get(&report).await.text, wanted, "a pinned job is whole");
    assert_eq!(status(&api, &jobs[0]).await, 410);
    assert_eq!(status(&api, jobs.last().unwrap()).await, 200);
    // Where nothing may go, nothing new is taken, and what is there is read on.
    let left = api.get("/v1/jobs?limit=100").await.ok(200);
    for one in left["items"].as_array().unwrap() {
        pin(&api, one, true).await;
    }
    let usage = api.get("/v1/usage").await.ok(200);
    let room =
        limit - usage["files_bytes"].as_u64().unwrap() - usage["tables_bytes"].as_u64().unwrap();
    let file = "x".repeat(usize::try_from(room).unwrap() + 1_000_000);
    let refused = send(
        api.request(Method::POST, "/v1/datasets/raw?name=x")
            .body(file),
    )
    .await;
    assert_eq!(
        (refused.status.as_u16(), &refused.problem()["code"]),
        (507, &json!("insufficient_storage"))
    );
    assert!(refused.text.contains("no job may go"), "{}", refused.text);
    assert_eq!(api.get(&report).await.text, wanted);
}
