//! Jobs side by side, and the tuples of a correlation with what is true of them.

use crate::helpers::{Api, id};
use serde_json::{Value, json};
use trackloom::service::types::{Comparison, PairedOver};

async fn report_of(api: &Api, job: &Value) -> Value {
    assert_eq!(job["state"], "succeeded", "{job}");
    api.get(&format!("/v1/jobs/{}/report", id(job)))
        .await
        .ok(200)
}

/// The scene of 30 targets, by this associator.
async fn evaluated(api: &Api, method: &str) -> Value {
    let mut body = api.get("/v1/presets/liang2009-30").await.ok(200)["body"].clone();
    body["associator"] = json!({"method": method});
    api.run("evaluate", &body).await
}

async fn compared(api: &Api, query: &str) -> Comparison {
    serde_json::from_value(api.get(&format!("/v1/compare?{query}")).await.ok(200)).unwrap()
}

#[tokio::test(flavor = "multi_thread")]
async fn evaluations_are_compared_by_numbers_steps_verdicts_and_requests() {
    let api = Api::start().await;
    let jobs = [
        evaluated(&api, "nearest_neighbour").await,
        evaluated(&api, "jpda").await,
    ];
    let reports = [
        report_of(&api, &jobs[0]).await,
        report_of(&api, &jobs[1]).await,
    ];
    let found = compared(&api, &format!("job={}&job={}", id(&jobs[0]), id(&jobs[1]))).await;
    assert_eq!(found.baseline.to_string(), id(&jobs[0]));
    let gospa = found
        .numbers
        .iter()
        .find(|number| number.path == "metrics.gospa.quantities.gospa")
        .unwrap();
    let reported = |report: &Value| report["result"]["metrics"]["gospa"]["value"].as_f64();
    assert_eq!(
        (gospa.unit.as_str(), &gospa.values),
        ("m", &vec![reported(&reports[0]), reported(&reports[1])])
    );

    // GOSPA is the mean over the steps, so the mean of the differences is the difference of the means.
    let paired = found
        .paired
        .iter()
        .find(|paired| paired.name == "gospa.gospa")
        .unwrap();
    assert_eq!(
        (paired.over, paired.differences[0]),
        (PairedOver::Steps, None)
    );
    let difference = paired.differences[1].unwrap();
    assert_eq!(difference.pairs, reports[0]["result"]["events"]["steps"]);
    assert!(
        (difference.mean - (gospa.values[1].unwrap() - gospa.values[0].unwrap())).abs() < 1e-9,
        "{difference:?}"
    );
    assert!(difference.smaller + difference.larger <= difference.pairs);

    let correct = |report: &Value| {
        report["result"]["tfa"]["counts"]["correct"]
            .as_u64()
            .unwrap()
    };
    let verdicts = found.verdicts.unwrap()[0];
    assert_eq!(
        (
            verdicts.both_correct + verdicts.lost,
            verdicts.both_correct + verdicts.gained
        ),
        (correct(&reports[0]), correct(&reports[1]))
    );
    let method = found
        .request
        .iter()
        .find(|difference| difference.pointer == "/associator/method")
        .unwrap();
    assert_eq!(
        method.values,
        [
            Some("\"nearest_neighbour\"".to_owned()),
            Some("\"jpda\"".to_owned())
        ]
    );
    assert!(found.notes.is_empty(), "{:?}", found.notes);

    let turned = compared(
        &api,
        &format!(
            "job={0}&job={1}&baseline={1}&confidence=0.5",
            id(&jobs[0]),
            id(&jobs[1])
        ),
    )
    .await;
    let back = turned
        .paired
        .iter()
        .find(|paired| paired.name == "gospa.gospa")
        .unwrap()
        .differences[0]
        .unwrap();
    assert!((back.mean + difference.mean).abs() < 1e-9);
    let width = |difference: trackloom::service::types::PairedDifference| {
        difference
            .interval
            .map(|interval| interval.high - interval.low)
    };
    assert!(width(back) < width(difference));
}

#[tokio::test(flavor = "multi_thread")]
async fn campaigns_are_compared_run_by_run_in_the_cells_they_share() {
    let api = Api::start().await;
    let campaign = |gate: f64, values: [f64; 2]| {
        json!({
            "base": {"kind": "evaluate", "input": {"source": "preset", "preset": "liang2009-10"}, "tracker": {"gate_probability": gate}},
            "grid": [{"by": "values", "name": "P_D", "path": "/input/scenario/sensors/0/p_d", "values": values}],
            "runs": 3, "seed": 3, "outcomes": [{"name": "correct", "path": "tfa.counts.correct"}]
        })
    };
    let jobs = [
        api.run("campaign", &campaign(0.99, [0.7, 0.8])).await,
        api.run("campaign", &campaign(0.9, [0.8, 0.9])).await,
    ];
    let found = compared(&api, &format!("job={}&job={}", id(&jobs[0]), id(&jobs[1]))).await;
    let [only] = found.paired.as_slice() else {
        panic!("one cell is shared: {:?}", found.paired)
    };
    assert_eq!(
        (only.cell.as_deref(), only.name.as_str(), only.over),
        (Some("0.8"), "correct", PairedOver::Runs)
    );
    let mean = |report: &Value, cell: usize| {
        report["result"]["cells"][cell]["outcomes"]["correct"]["mean"].as_f64()
    };
    assert_eq!(
        only.means,
        [
            mean(&report_of(&api, &jobs[0]).await, 1),
            mean(&report_of(&api, &jobs[1]).await, 0)
        ]
    );
    assert_eq!(only.differences[1].unwrap().pairs, 3);
    assert_eq!(
        found.notes,
        ["the jobs read different data or scenes: see where the requests differ"]
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn what_cannot_be_compared_is_refused() {
    let api = Api::start().await;
    let job = api.run("simulate", &crate::helpers::small()).await;
    let one = id(&job);
    let faults = |answer: crate::helpers::Answer| -> Vec<String> {
        assert_eq!(answer.status, 422, "{}", answer.text);
        let body = answer.problem();
        body["errors"]
            .as_array()
            .unwrap()
            .iter()
            .map(|fault| {
                format!(
                    "{} {}",
                    fault["pointer"].as_str().unwrap(),
                    fault["code"].as_str().unwrap()
                )
            })
            .collect()
    };
    assert_eq!(
        faults(api.get(&format!("/v1/compare?job={one}")).await),
        ["/query/job out_of_range"]
    );
    assert_eq!(
        faults(api.get(&format!("/v1/compare?job={one}&job={one}")).await),
        ["/query/job duplicate"]
    );
    let query = format!("job={one}&job=x&baseline=y&confidence=1&nothing=1");
    let expected = [
        "/query/job unknown_value",
        "/query/baseline unknown_value",
        "/query/confidence unknown_value",
        "/query/nothing unknown_field",
    ];
    assert_eq!(
        faults(api.get(&format!("/v1/compare?{query}")).await),
        expected
    );
    let absent = "00000000-0000-7000-8000-000000000000";
    assert_eq!(
        api.get(&format!("/v1/compare?job={one}&job={absent}"))
            .await
            .status,
        404
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn tuples_say_whether_they_are_right_and_local_tracks_are_kept() {
    let api = Api::start().await;
    let mut body = api.get("/v1/presets/huo2008").await.ok(200)["body"].clone();
    let tracks = body["input"]["tracks"].as_object_mut().unwrap();
    tracks.extend(
        json!({"spacing_m": 150.0, "false_tracks": 3.0, "p_d": 0.8})
            .as_object()
            .unwrap()
            .clone(),
    );
    let job = api.run("correlate", &body).await;
    let result = &report_of(&api, &job).await["result"];
    let tuples = result["tuples"].as_array().unwrap();
    let right = tuples.iter().filter(|tuple| tuple["right"] == true).count();
    assert_eq!(result["truth"]["tuples_right"], right);
    assert!(
        right > 0 && right < tuples.len(),
        "some are right, some wrong: {right}"
    );
    let text = api
        .get(&format!("/v1/jobs/{}/artifacts/local_tracks.csv", id(&job)))
        .await
        .text;
    let mut lines = text.lines();
    let head = "time_s,track_id,sensor_id,x_m,y_m,vx_mps,vy_mps,p_xx,p_xy,p_xvx,p_xvy,p_yy,p_yvx,p_yvy,p_vxvx,p_vxvy,p_vyvy";
    assert_eq!(lines.next(), Some(head));
    let names: std::collections::BTreeSet<_> = lines
        .map(|line| line.split(',').skip(1).take(2).collect::<Vec<_>>())
        .collect();
    assert_eq!(result["counts"]["tracks"], names.len());
}
