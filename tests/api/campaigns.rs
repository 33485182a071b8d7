//! Campaigns over HTTP: accepted, run, read, refused, canceled.

use crate::helpers::{Api, id};
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
    let report = api.get(&format!("/v1/jobs/{}/report", id(&job))).await.ok(200);
    let cells = report["result"]["cells"].as_array().unwrap();
    assert_eq!(cells.iter().map(|cell| cell["name"].as_str().unwrap()).collect::<Vec<_>>(), ["NN", "JPDA"]);
    // The same scenes: as many targets in every cell.
    assert!(cells[1]["outcomes"]["targets"]["mean"].as_f64().unwrap() > 8.0);
    assert_eq!(cells[1]["differences"]["targets"]["mean"], 0.0);
    assert_eq!(cells[1]["compared_with"], "NN");
    // The difference of the means is the mean of the differences.
    let mean = |cell: usize| cells[cell]["outcomes"]["correct"]["mean"].as_f64().unwrap();
    assert!((cells[1]["differences"]["correct"]["mean"].as_f64().unwrap() - (mean(1) - mean(0))).abs() < 1e-12);
    assert_eq!(report["timing"]["cells"][0]["timed_runs"], 1);
    let runs = api.get(&format!("/v1/jobs/{}/artifacts/runs.csv", id(&job))).await.text;
    assert_eq!((runs.lines().next(), runs.lines().count()), (Some("cell,run,seed,correct,targets"), 1 + 2 * 4));
}

#[tokio::test(flavor = "multi_thread")]
async fn a_campaign_that_cannot_run_is_refused_with_every_fault() {
    let api = Api::start().await;
    let mut body = campaign();
    body["runs"] = json!(0);
    body["base"]["tracker"] = json!({"gate_probability": 2});
    let pointers = |answer: Value| -> Vec<String> {
        answer["errors"].as_array().unwrap().iter().map(|fault| fault["pointer"].as_str().unwrap().to_owned()).collect()
    };
    let refused = api.post("/v1/jobs/campaign", &body).await;
    assert_eq!(refused.status, 422);
    assert_eq!(pointers(refused.problem()), ["/runs", "/base/tracker/gate_probability"]);
    let mut long = campaign();
    long["runs"] = json!(1_000_000);
    // More numbers than are kept.
    long["outcomes"] = (0..30).map(|number| json!({"name": number.to_string(), "path": "tfa.counts.correct"})).collect();
    let refused = api.post("/v1/jobs/campaign", &long).await;
    assert_eq!(pointers(refused.problem()), ["/runs"]);
}
