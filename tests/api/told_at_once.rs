//! What a dataset's row knows is told with the request, by validation and by submission alike, and not by a job in the queue.

use crate::helpers::{Api, validation};
use serde_json::{Value, json};

const PLACES: &str = "time_s,scan,sensor_id,detection_id,x_m,y_m\n0,1,radar,a,1,2\n1,2,radar,b,1,2\n2,3,radar,c,1,2\n";
const POLAR: &str = "time_s,scan,sensor_id,detection_id,range_m,bearing_deg\n0,1,radar,a,900,20\n1,2,radar,b,905,20\n2,3,radar,c,910,20\n";
const BEARINGS: &str = "time_s,scan,sensor_id,detection_id,bearing_deg\n0,1,sonar,a,20\n1,2,sonar,b,20.1\n2,3,sonar,c,20.2\n";

/// The faults of a request, which must be the same of a check and of a submission, and leave no job.
async fn refused(api: &Api, kind: &str, spec: Value) -> Value {
    let checked = api
        .post("/v1/validate", &json!({"kind": kind, "spec": spec}))
        .await
        .ok(200);
    let faults = checked["errors"].clone();
    assert_eq!(
        checked,
        json!({"valid": false, "errors": faults, "warnings": []})
    );
    let detail = if faults.as_array().unwrap().len() == 1 {
        faults[0]["detail"].as_str().unwrap().to_owned()
    } else {
        String::new()
    };
    let told = api.post(&format!("/v1/jobs/{kind}"), &spec).await;
    let problem = told.problem();
    assert_eq!(problem["errors"], faults);
    if !detail.is_empty() {
        assert_eq!(problem, validation(&detail, faults.clone()));
    }
    assert_eq!(api.get("/v1/jobs?count=true").await.ok(200)["total"], 0);
    faults
}

fn of(id: &str, more: Value) -> Value {
    let mut spec = json!({"input": {"source": "dataset", "dataset_id": id}});
    spec.as_object_mut()
        .unwrap()
        .extend(more.as_object().unwrap().clone());
    spec
}

fn radar() -> Value {
    json!([{"sensor_id": "radar", "sigma_x_m": 1.0, "sigma_y_m": 1.0}])
}

fn fault(pointer: &str, code: &str, detail: &str, allowed: &str) -> Value {
    json!({"pointer": pointer, "code": code, "detail": detail, "allowed": allowed})
}

#[tokio::test(flavor = "multi_thread")]
async fn sensors_that_are_not_there() {
    let api = Api::start().await;
    let id = api.dataset(PLACES).await;
    let unknown = of(
        &id,
        json!({"sensors": [{"sensor_id": "sonar", "sigma_x_m": 1.0, "sigma_y_m": 1.0}]}),
    );
    let expected = fault(
        "/sensors/0/sensor_id",
        "unknown_value",
        "the recording has no sensor 'sonar'",
        "radar",
    );
    assert_eq!(refused(&api, "associate", unknown).await, json!([expected]));
    let mut part = of(&id, json!({"sensors": radar()}));
    part["input"]["sensor_ids"] = json!(["radar", "lidar"]);
    let expected = fault(
        "/input/sensor_ids/1",
        "unknown_value",
        "the recording has no sensor 'lidar'",
        "radar",
    );
    assert_eq!(refused(&api, "associate", part).await, json!([expected]));
}

#[tokio::test(flavor = "multi_thread")]
async fn reports_that_the_request_cannot_use() {
    let api = Api::start().await;
    let (places, polar) = (api.dataset(PLACES).await, api.dataset(POLAR).await);
    let detail = "sensor 'radar' reports ranges and bearings, which the filter 'kalman' cannot use";
    let expected = fault(
        "/filter/method",
        "unsupported",
        detail,
        "positions (x_m, y_m)",
    );
    assert_eq!(
        refused(
            &api,
            "associate",
            of(&polar, json!({"filter": {"method": "kalman"}}))
        )
        .await,
        json!([expected])
    );
    let oracle = of(
        &places,
        json!({"sensors": radar(), "associator": {"method": "oracle"}}),
    );
    let detail = "'oracle' needs the origin of every detection; 1 of 1 lack it";
    assert_eq!(
        refused(&api, "associate", oracle).await[0]["pointer"],
        "/associator/method",
        "{detail}"
    );
    let per_deg =
        json!([{"sensor_id": "radar", "sigma_x_m": 1.0, "sigma_y_m": 1.0, "clutter_per_deg": 1.0}]);
    assert_eq!(
        refused(&api, "associate", of(&places, json!({"sensors": per_deg}))).await[0]["pointer"],
        "/sensors/0/clutter_per_deg"
    );
    let grouped = of(
        &places,
        json!({"sensors": radar(), "grouper": {"method": "nearest_neighbour"}}),
    );
    assert_eq!(
        refused(&api, "group", grouped).await[0]["detail"],
        "the input has 1 sensor, whose reports have nothing to be put together with"
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn a_campaign_tells_it_at_the_variant_or_in_the_base() {
    let api = Api::start().await;
    let id = api.dataset(POLAR).await;
    let sensors = json!([{"sensor_id": "radar", "sigma_range_m": 5.0, "sigma_bearing_deg": 0.3}]);
    let mut base = of(&id, json!({"sensors": sensors}));
    base["kind"] = json!("associate");
    let variant =
        |name: &str| json!({"name": name, "set": [{"path": "/filter", "value": {"method": name}}]});
    let grid = json!([{"by": "variants", "name": "filter", "variants": [variant("unscented"), variant("kalman")]}]);
    let told = refused(
        &api,
        "campaign",
        json!({"base": base, "grid": grid, "runs": 1}),
    )
    .await;
    assert_eq!(
        (told.as_array().unwrap().len(), &told[0]["pointer"]),
        (1, &json!("/grid/0/variants/1/set/0/value/method"))
    );
    base["sensors"] = json!([{"sensor_id": "sonar", "sigma_range_m": 5.0}]);
    let told = refused(&api, "campaign", json!({"base": base, "runs": 1})).await;
    assert_eq!(
        (told.as_array().unwrap().len(), &told[0]["pointer"]),
        (1, &json!("/base/sensors/0/sensor_id"))
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn a_recording_without_truth_is_tracked_and_judged_only_with_truth() {
    let api = Api::start().await;
    let id = api.dataset(PLACES).await;
    let told = refused(&api, "evaluate", of(&id, json!({"sensors": radar()}))).await;
    assert_eq!(
        (&told[0]["pointer"], &told[0]["code"]),
        (&json!("/truth"), &json!("missing"))
    );
    assert_eq!(
        api.run("associate", &of(&id, json!({"sensors": radar()})))
            .await["state"],
        "succeeded"
    );
    // With origins alone the automaton judges, and a warning says what is absent and why.
    let named =
        api.dataset("time_s,scan,sensor_id,detection_id,x_m,y_m,truth_id\n0,1,radar,a,1,2,T\n1,2,radar,b,1,2,T\n2,3,radar,c,1,2,T\n").await;
    let job = api
        .run("evaluate", &of(&named, json!({"sensors": radar()})))
        .await;
    assert_eq!(job["state"], "succeeded", "{job}");
    let report = api
        .get(&format!("/v1/jobs/{}/report", job["id"].as_str().unwrap()))
        .await
        .ok(200);
    assert_eq!(report["result"]["tfa"]["counts"]["correct"], 1);
    assert!(report["result"].get("metrics").is_none());
    let warnings = report["warnings"].to_string();
    assert!(
        warnings.contains("there is no truth with positions") && warnings.contains("GOSPA"),
        "{warnings}"
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn the_filter_is_chosen_at_submission_and_the_row_tells_what_a_job_costs() {
    let api = Api::start().await;
    for (content, method, sensors) in [
        (PLACES, "kalman", radar()),
        (
            POLAR,
            "unscented",
            json!([{"sensor_id": "radar", "sigma_range_m": 5.0, "sigma_bearing_deg": 0.3}]),
        ),
        (
            BEARINGS,
            "bearing_only",
            json!([{"sensor_id": "sonar", "sigma_bearing_deg": 0.3}]),
        ),
    ] {
        let spec = of(&api.dataset(content).await, json!({"sensors": sensors}));
        let checked = api
            .post("/v1/validate", &json!({"kind": "associate", "spec": spec}))
            .await
            .ok(200);
        assert_eq!(
            (
                &checked["valid"],
                &checked["estimate"]["detections"],
                &checked["warnings"]
            ),
            (&json!(true), &json!(3), &json!([]))
        );
        let job = api.run("associate", &spec).await;
        assert_eq!(job["state"], "succeeded", "{job}");
        let report = api
            .get(&format!("/v1/jobs/{}/report", job["id"].as_str().unwrap()))
            .await
            .ok(200);
        assert_eq!(report["spec"]["filter"]["method"], method);
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn what_a_queued_job_will_make_is_not_checked_and_that_is_said() {
    let api = Api::start().await;
    let first = api
        .post("/v1/jobs/simulate", &crate::helpers::long())
        .await
        .ok(202);
    let id = first["id"].as_str().unwrap();
    let spec =
        json!({"input": {"source": "job", "job_id": id}, "sensors": [{"sensor_id": "nobody"}]});
    let checked = api
        .post("/v1/validate", &json!({"kind": "associate", "spec": spec}))
        .await
        .ok(200);
    assert_eq!(
        checked["warnings"],
        json!([format!(
            "not checked: /input: job '{id}' has not made its detections yet"
        )])
    );
    api.post(&format!("/v1/jobs/{id}/cancel"), &json!({})).await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_dataset_says_what_each_sensor_reported() {
    let api = Api::start().await;
    let content = "time_s,scan,sensor_id,detection_id,x_m,y_m,amplitude,truth_id\n0,1,A,a,1,2,3,T\n0,1,A,b,5,2,3,\n1,1,B,c,1,2,3,T\n";
    let info = api.upload(&json!({}), content).await.ok(201);
    let reports = |sensor: &str, detections: u64| {
        json!({
            "sensor_id": sensor, "scans": 1, "detections": detections, "positions": detections, "ranges": 0, "bearings": 0,
            "range_rates": 0, "amplitudes": detections
        })
    };
    assert_eq!(
        (&info["reports"], &info["has_truth_id"]),
        (&json!([reports("A", 2), reports("B", 1)]), &json!(true))
    );
}
