//! `trackloom demo`: the tour. Runs real jobs in the service's own data directory, prints what they found, then serves
//! the dashboard with them, and a live session beside them.

use super::demo_live;
use super::output;
use crate::experiment::presets;
use crate::experiment::text::{cell, table};
use crate::service::config::Config;
use crate::service::datasets::DatasetMeta;
use crate::service::error::ServiceError;
use crate::service::jobs::Jobs;
use crate::service::server;
use crate::service::storage::blobs::ReceivedFile;
use crate::service::storage::blobs::sha256_hex;
use crate::service::types::{Job, JobKind, JobState};
use anyhow::{Context, bail};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde_json::{Value, json};
use std::time::Duration;
use uuid::Uuid;

/// The recording of the tour: its files, shipped with the program, and the job that judges it.
const RADAR_DETECTIONS: &[u8] =
    include_bytes!("../../../examples/data/autoferry-scenario2/detections.json");
const RADAR_TRUTH: &[u8] =
    include_bytes!("../../../examples/data/autoferry-scenario2/groundTruth.json");
const RADAR_JOB: &str = include_str!("../../../examples/autoferry-scenario2.json");
/// A sonar that knows directions alone.
const SONAR_JOB: &str = include_str!("../../../examples/bearing-crossing.json");

/// What the columns of the tour's table mean.
const LEGEND: &str = "\
correct, missed, false: the automaton's verdicts. They forgive nothing: a target whose track begins one scan late is missed.
P correct is of the tracks, P missed of the targets. Mean GOSPA is 0 for a perfect picture; each missed target and each false
track adds to it.";

/// What to do after the tour.
const OWN_FILES: &str = "\
Your own detections: a CSV with time_s, scan, sensor_id, detection_id, x_m, y_m; drop it on the dashboard, or begin with
examples/autoferry-scenario2.json and `trackloom run JOB`.";

/// A port that is taken is told before the tour, not after it.
fn check_address(config: &Config) -> anyhow::Result<()> {
    let taken = || {
        format!(
            "cannot listen on {}; choose another address with --listen",
            config.listen
        )
    };
    std::net::TcpListener::bind(config.listen)
        .map(drop)
        .with_context(taken)
}

/// The tour, then, unless `once`, the service until it is told to stop.
pub(super) async fn demo(config: Config, once: bool) -> anyhow::Result<()> {
    if !once {
        check_address(&config)?;
    }
    let jobs = Jobs::open(config.clone()).await?;
    if let Err(error) = tour(&jobs).await {
        jobs.shutdown().await;
        return Err(error);
    }
    if once {
        jobs.shutdown().await;
        output::print(format_args!(
            "\n{OWN_FILES}\n`trackloom serve` shows these jobs in the dashboard."
        ))?;
        return Ok(());
    }
    output::print(format_args!(
        "\n{OWN_FILES}\nThe dashboard shows these jobs; end with Ctrl-C."
    ))?;
    let feed = demo_live::begin(&jobs, &serde_json::from_str(RADAR_JOB)?, RADAR_DETECTIONS).await?;
    let session = feed.session;
    let playing = tokio::spawn(feed.play(jobs.clone()));
    let served = server::serve_jobs(config, jobs, |address| {
        // Nobody need read it: the page lists the session.
        let _ = output::print(format_args!(
            "the recording as a live session: http://{address}/?view=session&session={session}"
        ));
    });
    let outcome = served.await;
    playing.abort();
    outcome
}

async fn tour(jobs: &Jobs) -> anyhow::Result<()> {
    output::print(format_args!(
        "trackloom tour: scenes and a recording, tracked and judged by the temporal automaton and by metrics\n"
    ))?;
    let preset = presets::find("liang2009-100").context("the preset of the tour is missing")?;
    let mut submitted = Vec::new();
    for (method, name) in [("nearest_neighbour", "nearest neighbour"), ("jpda", "JPDA")] {
        let mut body = preset.body.clone();
        body["name"] = json!(format!("Liang 2009, {name}"));
        body["associator"] = json!({"method": method});
        submitted.push((
            format!("Liang 2009, radar scene, {name}"),
            submit(jobs, body).await?,
        ));
    }
    submitted.push((
        "autoferry 2, radar, recorded".to_owned(),
        submit(jobs, radar_job(jobs).await?).await?,
    ));
    let mut sonar: Value = serde_json::from_str(SONAR_JOB)?;
    without_kind(&mut sonar);
    submitted.push((
        "two ships crossing, bearings alone".to_owned(),
        submit(jobs, sonar).await?,
    ));
    let mut rows = Vec::new();
    for (scene, job) in submitted {
        rows.push(row(&scene, &follow(jobs, job).await?));
    }
    let header = [
        "scene",
        "scans",
        "detections",
        "targets",
        "tracks",
        "correct",
        "missed",
        "false",
        "P correct",
        "P missed",
        "mean GOSPA (m)",
        "seconds",
    ];
    output::print(format_args!("{}\n\n{LEGEND}", table(&header, &rows)))?;
    Ok(())
}

fn without_kind(body: &mut Value) {
    if let Some(fields) = body.as_object_mut() {
        fields.shift_remove("kind");
    }
}

/// The example job, its files replaced by datasets.
async fn radar_job(jobs: &Jobs) -> anyhow::Result<Value> {
    let mut body: Value = serde_json::from_str(RADAR_JOB)?;
    for (name, file_name, bytes) in [
        ("input", "detections.json", RADAR_DETECTIONS),
        ("truth", "groundTruth.json", RADAR_TRUTH),
    ] {
        let dataset_id = upload(jobs, file_name, bytes).await?;
        let mut source = json!({"source": "dataset", "dataset_id": dataset_id});
        if let Some(sensor_ids) = body[name].get("sensor_ids") {
            source["sensor_ids"] = sensor_ids.clone();
        }
        body[name] = source;
    }
    without_kind(&mut body);
    Ok(body)
}

async fn upload(jobs: &Jobs, file_name: &str, bytes: &[u8]) -> anyhow::Result<Uuid> {
    let path = jobs.datasets().temp_dir().join(Uuid::now_v7().to_string());
    tokio::fs::write(&path, bytes).await?;
    let sha256 = sha256_hex(bytes);
    let file = ReceivedFile {
        path,
        sha256,
        bytes: bytes.len() as u64,
    };
    let meta = DatasetMeta {
        name: Some(format!("autoferry scenario 2, {file_name}")),
        format: Some("autoferry".to_owned()),
        file_name: Some(file_name.to_owned()),
        ..Default::default()
    };
    Ok(jobs.datasets().add(file, meta).await.map_err(explain)?.0.id)
}

async fn submit(jobs: &Jobs, mut body: Value) -> anyhow::Result<Job> {
    body["labels"] = json!({"tour": "demo"});
    Ok(jobs
        .submit(JobKind::Evaluate, body, None)
        .await
        .map_err(explain)?
        .job)
}

/// Waits for the job with a progress bar (shown when stderr is a terminal), and gives its report.
async fn follow(jobs: &Jobs, job: Job) -> anyhow::Result<Value> {
    let bar = ProgressBar::with_draw_target(Some(1000), ProgressDrawTarget::stderr());
    bar.set_style(
        ProgressStyle::with_template("{msg:36} {bar:40} {percent:>3} %")
            .unwrap_or_else(|_| ProgressStyle::default_bar()),
    );
    bar.set_message(job.name.clone().unwrap_or_default());
    let mut job = job;
    while !job.state.is_terminal() {
        job = jobs
            .wait(job.id, Duration::from_millis(200))
            .await
            .map_err(explain)?;
        bar.set_position(
            job.progress
                .as_ref()
                .map_or(0, |progress| (progress.fraction * 1000.0) as u64),
        );
    }
    bar.finish_and_clear();
    if job.state != JobState::Succeeded {
        bail!(
            "job {} {}: {}",
            job.id,
            job.state.name(),
            serde_json::to_string(&job.error)?
        );
    }
    let report = jobs.report(job.id).await.map_err(explain)?;
    let bytes = tokio::task::spawn_blocking(move || report.content.read()).await??;
    Ok(serde_json::from_slice(&bytes)?)
}

fn row(scene: &str, report: &Value) -> Vec<String> {
    let value = |pointer: &str| cell(report.pointer(pointer).unwrap_or(&Value::Null));
    let mut cells = vec![scene.to_owned()];
    cells.extend(
        [
            "/result/association/counts/scans",
            "/result/association/counts/detections",
            "/result/tfa/counts/targets",
            "/result/tfa/counts/output_tracks",
            "/result/tfa/counts/correct",
            "/result/tfa/counts/missed",
            "/result/tfa/counts/false",
            "/result/tfa/probability/correct",
            "/result/tfa/probability/missed",
            "/result/metrics/gospa/value",
            "/timing/total_s",
        ]
        .map(value),
    );
    cells
}

fn explain(error: ServiceError) -> anyhow::Error {
    anyhow::anyhow!("{error}")
}
