//! A session with the client of progenitor: upload, associate, evaluate, wait, report, a typed refusal.

mod example;

use serde_json::{Value, json};
use std::path::Path;
use types::{DatasetInfo, Job, JobState, Problem, UploadRawDatasetKind};

progenitor::generate_api!(spec = "../../../openapi/openapi-3.0.json");

type Refused = Box<dyn std::error::Error>;

#[tokio::main(flavor = "current_thread")]
async fn main() -> Result<(), Refused> {
    let mut arguments = std::env::args().skip(1);
    let (address, data) = (arguments.next().ok_or("no address")?, arguments.next().ok_or("no data")?);
    let client = Client::new(&address);
    let detections = upload(&client, &data, "detections.csv", UploadRawDatasetKind::Detections).await?;
    let truth = upload(&client, &data, "truth.csv", UploadRawDatasetKind::Truth).await?;
    assert_eq!((detections.rows, truth.objects), (24, 2));
    let associated = succeeded(client.create_associate_job(None, Some("wait=30"), &request(&detections, json!(1))?).await?.into_inner());
    let spec = serde_json::from_value(json!({
        "kind": "evaluate",
        "tracks": {"source": "job", "job_id": associated.id},
        "truth": {"source": "dataset", "dataset_id": truth.id},
    }))?;
    assert!(client.validate_job(&spec).await?.valid);
    let judged = succeeded(client.create_job(None, Some("wait=30"), &spec).await?.into_inner());
    judge(&client, &judged).await?;
    be_refused(&client, &detections).await?;
    live(&client).await?;
    std::env::set_current_dir(&data)?;
    assert_eq!(example::track(&address).await?, 24);
    println!("progenitor: ok");
    Ok(())
}

/// A live session: scans in, tracks out, closed into a job.
async fn live(client: &Client) -> Result<(), Refused> {
    let session = client.create_session(&serde_json::from_value(json!({
        "sensors": [{"sensor_id": "radar", "p_d": 0.95, "clutter_per_m2": 1e-9, "sigma_x_m": 10.0, "sigma_y_m": 10.0}],
        "tracker": {"initial_speed_sigma_mps": 60.0},
    }))?).await?.into_inner();
    for index in 0..4_i32 {
        let scan = json!({
            "sensor_id": "radar", "sequence": index, "time_s": 2.0 * f64::from(index),
            "detections": [{"x_m": 100.0 * f64::from(index), "y_m": 5.0}],
        });
        let pushed = client.push_scans(&session.id, &serde_json::from_value(scan)?).await?.into_inner();
        assert_eq!(pushed.entries, i64::from(index) + 1);
    }
    let live = client.list_session_tracks(&session.id, None).await?.into_inner();
    assert_eq!((live.tracks.len(), live.tracks[0].status.as_str()), (1, "confirmed"));
    let closed = client.close_session(&session.id).await?.into_inner();
    assert_eq!((closed.state, closed.track_ids), (types::SessionState::Closed, vec!["1".to_owned()]));
    Ok(())
}

async fn upload(client: &Client, data: &str, name: &str, kind: UploadRawDatasetKind) -> Result<DatasetInfo, Refused> {
    let bytes = std::fs::read(Path::new(data).join(name))?;
    let name = name.parse()?;
    Ok(client
        .upload_raw_dataset(
            None, None, None, None, None, None, None, None,
            None, None, None, None, Some(kind), None, None, Some(&name),
            None, None, None, None, None,
            None, None, None, None, None, bytes,
        )
        .await?
        .into_inner())
}

fn request(detections: &DatasetInfo, seed: Value) -> Result<types::AssociateRequest, Refused> {
    Ok(serde_json::from_value(json!({
        "seed": seed,
        "input": {"source": "dataset", "dataset_id": detections.id},
        "sensors": [{"sensor_id": "radar", "p_d": 0.95, "clutter_per_m2": 1e-9, "sigma_x_m": 10.0, "sigma_y_m": 10.0}],
        "associator": {"method": "nearest_neighbour"},
        "tracker": {"initial_speed_sigma_mps": 60.0},
    }))?)
}

fn succeeded(job: Job) -> Job {
    assert_eq!(job.state, JobState::Succeeded, "{job:?}");
    job
}

async fn judge(client: &Client, judged: &Job) -> Result<(), Refused> {
    let types::Report::EvaluateReport(report) = client.get_job_report(&judged.id).await?.into_inner() else {
        return Err("not the report of an evaluation".into());
    };
    let counts = report.result.tfa.ok_or("no verdicts")?.counts;
    assert_eq!((counts.targets, counts.correct, counts.missed, counts.false_), (2, 2, 0, 0));
    Ok(())
}

async fn be_refused(client: &Client, detections: &DatasetInfo) -> Result<(), Refused> {
    let Err(Error::ErrorResponse(refusal)) = client.create_associate_job(None, None, &request(detections, json!(-1))?).await else {
        return Err("the request was not refused".into());
    };
    assert_eq!(refusal.status(), 422);
    let problem: Problem = refusal.into_inner();
    let faults: Vec<(&str, &str)> = problem.errors.iter().map(|fault| (fault.pointer.as_str(), fault.code.as_str())).collect();
    assert_eq!((problem.code.as_str(), faults), ("validation", vec![("/seed", "out_of_range")]));
    Ok(())
}
