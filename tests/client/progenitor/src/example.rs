//! The example of docs/api-clients.md.

use super::{Client, types};
use serde_json::json;

pub async fn track(url: &str) -> Result<i64, Box<dyn std::error::Error>> {
    let client = Client::new(url);
    let (file, name) = (std::fs::read("detections.csv")?, "trial 7".parse()?);
    let dataset = client
    .upload_raw_dataset(
        None, None, None, None, None, None, None, None,
        None, None, None, None, None, None, None,
        Some(&name), None, None, None, None, None,
        None, None, None, None, None,
        file,
    )
    .await?;
    let request: types::AssociateRequest = serde_json::from_value(json!({
        "input": {"source": "dataset", "dataset_id": dataset.id},
        "sensors": [{"sensor_id": "radar", "p_d": 0.95, "clutter_per_m2": 1e-9, "sigma_x_m": 10.0, "sigma_y_m": 10.0}],
    }))?;
    let job = client.create_associate_job(None, Some("wait=30"), &request).await?;
    match client.get_job_report(&job.id).await?.into_inner() {
        types::Report::AssociateReport(report) => Ok(report.result.association.counts.detections),
        other => Err(format!("not the report of a tracker: {other:?}").into()),
    }
}
