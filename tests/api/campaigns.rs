//! Campaigns over HTTP: accepted, run, read, refused, canceled.

use crate::helpers::{Api, id, send, small};
use serde_json::{Value, json};

fn campaign() -> Value {
    let axis = json!({"by": "variants", "name": "associator", "variants": [
        {"name": "NN", "set": [{"path": "/associator", "value": {"method": "nearest_neighbour"}}]},
        {"name": "JPDA", "set": [{"path": "/associator", "value": {"method": "jpda"}}]}
    ]});
    json!({
        "base": {"kind": "evaluate", "input": {"source": "preset", "preset": "liang2009-10"}},
        "grid": [axis], "runs": 4, "seed": 3, "timed_runs": 1,
        "outcomes": [{"name": "correct", "path": "tfa.counts.correct"}, {"name": "targets", "path": "tfa.counts.targets"}]
    })
}

#[tokio::test(flavor = "multi_thread")]
async fn a_campaign_answers_with_cells_intervals_and_files() {
    let api = Api::start().await;
    let job = api.run("campaign", &campaign()).await;
    assert_eq!(job["state"], "succeeded", "{job}");
    let report = api
        .get(&format!("/v1/jobs/{}/report", id(&job)))
        .await
        .ok(200);
    let cells = report["result"]["cells"].as_array().unwrap();
    assert_eq!(
        cells
            .iter()
            .map(|cell| cell["name"].as_str().unwrap())
            .collect::<Vec<_>>(),
        ["NN", "JPDA"]
    );
    // The same scenes: as many targets in every cell.
    assert!(cells[1]["outcomes"]["targets"]["mean"].as_f64().unwrap() > 8.0);
    assert_eq!(cells[1]["differences"]["targets"]["mean"], 0.0);
    assert_eq!(cells[1]["compared_with"], "NN");
    // The difference of the means is the mean of the differences.
    let mean = |cell: usize| cells[cell]["outcomes"]["correct"]["mean"].as_f64().unwrap();
    assert!(
        (cells[1]["differences"]["correct"]["mean"].as_f64().unwrap() - (mean(1) - mean(0))).abs()
            < 1e-12
    );
    assert_eq!(report["timing"]["cells"][0]["timed_runs"], 1);
    let runs = api
        .get(&format!("/v1/jobs/{}/artifacts/runs.csv", id(&job)))
        .await
        .text;
    assert_eq!(
        (runs.lines().next(), runs.lines().count()),
        (Some("cell,run,seed,correct,targets"), 1 + 2 * 4)
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn a_campaign_that_cannot_run_is_refused_with_every_fault() {
    let api = Api::start().await;
    let mut body = campaign();
    body["runs"] = json!(0);
    body["base"]["tracker"] = json!({"gate_probability": 2});
    let pointers = |answer: Value| -> Vec<String> {
        answer["errors"]
            .as_array()
            .unwrap()
            .iter()
            .map(|fault| fault["pointer"].as_str().unwrap().to_owned())
            .collect()
    };
    let refused = api.post("/v1/jobs/campaign", &body).await;
    assert_eq!(refused.status, 422);
    assert_eq!(
        pointers(refused.problem()),
        ["/runs", "/base/tracker/gate_probability"]
    );
    let mut long = campaign();
    long["runs"] = json!(1_000_000);
    // More numbers than are kept.
    long["outcomes"] = (0..30)
        .map(|number| json!({"name": number.to_string(), "path": "tfa.counts.correct"}))
        .collect();
    let refused = api.post("/v1/jobs/campaign", &long).await;
    assert_eq!(pointers(refused.problem()), ["/runs"]);
}

#[tokio::test(flavor = "multi_thread")]
async fn the_cells_of_a_campaign_are_told_while_it_runs_after_it_was_canceled_and_when_it_has_ended()
 {
    let api = Api::start().await;
    let mut body = campaign();
    // Some seconds of work, so that it is running while it is asked.
    (body["runs"], body["timed_runs"]) = (json!(20_000), json!(0));
    let job = api.post("/v1/jobs/campaign", &body).await.ok(202);
    let path = format!("/v1/jobs/{}/cells", id(&job));
    let so_far = loop {
        let answer = api.get(&path).await;
        if answer.status == 200 {
            break answer.ok(200);
        }
        assert_eq!(answer.status, 409);
        assert_eq!(answer.problem()["code"], "result_not_ready");
        tokio::time::sleep(std::time::Duration::from_millis(50)).await;
    };
    assert_eq!(so_far["is_final"], false);
    let cells = so_far["result"]["cells"].as_array().unwrap();
    let runs = so_far["runs"].as_u64().unwrap();
    assert!(runs > 0 && runs < 40_000, "{runs}");
    assert_eq!(
        cells
            .iter()
            .map(|cell| (cell["runs"].as_u64(), cell["ended"].as_str()))
            .collect::<Vec<_>>(),
        [(Some(runs / 2), Some("not_yet")); 2]
    );
    assert_eq!(cells[1]["differences"]["targets"]["mean"], 0.0);
    send(api.request(
        reqwest::Method::POST,
        &format!("/v1/jobs/{}/cancel", id(&job)),
    ))
    .await
    .ok(202);
    let kept = api.get(&path).await.ok(200);
    assert!(kept["runs"].as_u64() >= Some(runs) && kept["is_final"] == false);

    let ended = api.run("campaign", &campaign()).await;
    let all = api
        .get(&format!("/v1/jobs/{}/cells", id(&ended)))
        .await
        .ok(200);
    let report = api
        .get(&format!("/v1/jobs/{}/report", id(&ended)))
        .await
        .ok(200);
    assert_eq!(
        (&all["is_final"], &all["runs"], &all["result"]),
        (&json!(true), &json!(8), &report["result"])
    );
    let other = api.run("simulate", &small()).await;
    assert_eq!(
        api.get(&format!("/v1/jobs/{}/cells", id(&other)))
            .await
            .status,
        404
    );
}
