//! Tracks of several sensors over HTTP: uploaded, put together, fused, and the system tracks judged by a job of their own.

use crate::helpers::{Api, id};
use serde_json::{Value, json};

const COVARIANCE: &str = "4,0,0,0,4,0,0,1,0,1";

/// Two targets 100 m apart, moving east at 10 m/s, as a sensor has them.
fn tracks(sensor: &str, offset_m: f64) -> String {
    let head = "time_s,track_id,sensor_id,x_m,y_m,vx_mps,vy_mps,p_xx,p_xy,p_xvx,p_xvy,p_yy,p_yvx,p_yvy,p_vxvx,p_vxvy,p_vyvy\n";
    let row = |(time_s, track): (u32, u32)| {
        let (x_m, y_m) = (
            10.0 * f64::from(time_s) + offset_m,
            100.0 * f64::from(track),
        );
        format!("{time_s},{track},{sensor},{x_m},{y_m},10,0,{COVARIANCE}\n")
    };
    let rows = (0..5).flat_map(|time_s| (0..2).map(move |track| (time_s, track)));
    head.to_owned() + &rows.map(row).collect::<String>()
}

fn truth() -> String {
    let row = |(time_s, target): (u32, u32)| {
        format!("{time_s},{target},{},{}\n", 10 * time_s, 100 * target)
    };
    let rows = (0..5).flat_map(|time_s| (0..2).map(move |target| (time_s, target)));
    "time_s,truth_id,x_m,y_m\n".to_owned() + &rows.map(row).collect::<String>()
}

fn dataset(dataset_id: &str) -> Value {
    json!({"source": "dataset", "dataset_id": dataset_id})
}

#[tokio::test(flavor = "multi_thread")]
async fn uploaded_tracks_are_put_together_and_their_system_tracks_judged() {
    let api = Api::start().await;
    let (radar, lidar) = (
        api.dataset(&tracks("radar", 1.0)).await,
        api.dataset(&tracks("lidar", -1.0)).await,
    );
    let truth = api.dataset(&truth()).await;
    let body = json!({"sets": [dataset(&radar), dataset(&lidar)], "truth": dataset(&truth), "correlator": {"method": "exact"}});
    let job = api.run("correlate", &body).await;
    assert_eq!(job["state"], "succeeded", "{job}");
    let report = api
        .get(&format!("/v1/jobs/{}/report", id(&job)))
        .await
        .ok(200);
    let result = &report["result"];
    assert_eq!(
        (&result["truth"]["share_right"], &result["gap"]),
        (&json!(1.0), &json!(0.0))
    );
    assert_eq!(result["tuples"][1]["tracks"], json!(["1", "1"]));
    let file = api
        .get(&format!("/v1/jobs/{}/artifacts/tuples.csv", id(&job)))
        .await;
    assert!(
        file.text
            .lines()
            .next()
            .unwrap()
            .ends_with("track_of_radar,track_of_lidar"),
        "{}",
        file.text
    );
    // The two offsets cancel: the system tracks lie on the targets.
    let judged = json!({"truth": dataset(&truth), "tracks": {"source": "job", "job_id": id(&job)}, "metrics": [{"metric": "gospa", "cutoff_m": 20.0}]});
    let judged = api.run("evaluate", &judged).await;
    assert_eq!(judged["state"], "succeeded", "{judged}");
    let report = api
        .get(&format!("/v1/jobs/{}/report", id(&judged)))
        .await
        .ok(200);
    assert!(
        report["result"]["metrics"]["gospa"]["value"]
            .as_f64()
            .unwrap()
            < 1e-9,
        "{}",
        report["result"]["metrics"]["gospa"]
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn sets_that_do_not_go_together_fail_with_their_place() {
    let api = Api::start().await;
    let radar = api.dataset(&tracks("radar", 0.0)).await;
    let body = json!({"sets": [dataset(&radar)], "correlator": {"method": "exact"}, "alignment": {"period_s": -1.0}});
    let refused = api.post("/v1/jobs/correlate", &body).await;
    assert_eq!(refused.status, 422);
    let faults = refused.problem();
    let pointers: Vec<&str> = faults["errors"]
        .as_array()
        .unwrap()
        .iter()
        .map(|fault| fault["pointer"].as_str().unwrap())
        .collect();
    assert!(pointers.contains(&"/alignment/period_s"), "{faults}");
    let twice =
        json!({"sets": [dataset(&radar), dataset(&radar)], "correlator": {"method": "exact"}});
    let job = api.run("correlate", &twice).await;
    assert_eq!(
        (&job["state"], &job["error"]["errors"][0]["pointer"]),
        (&json!("failed"), &json!("/sets/1")),
        "{job}"
    );
}
