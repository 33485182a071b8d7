//! A service in a temporary directory, and the bodies of small and long jobs.

use futures::StreamExt;
use serde_json::{Value, json};
use sha2::{Digest, Sha256};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;
use tempfile::TempDir;
use trackloom::model::fault::Fault;
use trackloom::service::config::Config;
use trackloom::service::datasets::DatasetMeta;
use trackloom::service::datasets::ReceivedFile;
use trackloom::service::error::ServiceError;
use trackloom::service::jobs::Jobs;
use trackloom::service::types::{DatasetInfo, Event, Job, JobKind, JobState};
use uuid::Uuid;

pub struct Service {
    pub jobs: Arc<Jobs>,
    pub directory: TempDir,
    database: Option<String>,
}

impl std::ops::Deref for Service {
    type Target = Arc<Jobs>;
    fn deref(&self) -> &Arc<Jobs> {
        &self.jobs
    }
}

pub async fn start() -> Service {
    start_with(|_| {}).await
}

pub async fn start_with(change: impl FnOnce(&mut Config)) -> Service {
    let directory = tempfile::tempdir().unwrap();
    let database = new_database().await;
    let jobs = open_on(&database, directory.path(), change).await;
    Service {
        jobs,
        directory,
        database,
    }
}

pub async fn open(directory: &Path, change: impl FnOnce(&mut Config)) -> Arc<Jobs> {
    open_on(&None, directory, change).await
}

async fn open_on(
    database: &Option<String>,
    directory: &Path,
    change: impl FnOnce(&mut Config),
) -> Arc<Jobs> {
    let mut config = Config::new(directory);
    config.slots = 2;
    config.child_program = Some(env!("CARGO_BIN_EXE_trackloom").into());
    config.database_url.clone_from(database);
    change(&mut config);
    Jobs::open(config).await.unwrap()
}

/// A database of its own on the PostgreSQL that the environment names, so that the same tests are run on it; `None`: on a file.
async fn new_database() -> Option<String> {
    let server = std::env::var("TRACKLOOM_TEST_DATABASE_SERVER").ok()?;
    let name = format!("jobs_{}", Uuid::now_v7().simple());
    let pool = sqlx::PgPool::connect(&format!("{server}/postgres"))
        .await
        .unwrap();
    sqlx::query(sqlx::AssertSqlSafe(format!("CREATE DATABASE {name}")))
        .execute(&pool)
        .await
        .unwrap();
    pool.close().await;
    Some(format!("{server}/{name}"))
}

impl Service {
    /// Stops the service, lets `meanwhile` at its tables, and starts it again.
    pub async fn restart(self, meanwhile: &[&'static str]) -> Service {
        self.jobs.shutdown().await;
        let Service {
            jobs,
            directory,
            database,
        } = self;
        drop(jobs);
        let url = database
            .clone()
            .unwrap_or_else(|| format!("sqlite://{}", directory.path().join("app.db").display()));
        let pool = sqlx::AnyPool::connect(&url).await.unwrap();
        for statement in meanwhile {
            sqlx::query(*statement).execute(&pool).await.unwrap();
        }
        pool.close().await;
        let jobs = open_on(&database, directory.path(), |_| {}).await;
        Service {
            jobs,
            directory,
            database,
        }
    }

    pub async fn submit_ok(&self, kind: JobKind, body: Value) -> Job {
        self.submit(kind, body, None).await.unwrap().job
    }

    pub async fn refused(&self, kind: JobKind, body: Value) -> Vec<Fault> {
        match self.submit(kind, body, None).await {
            Err(ServiceError::Invalid(faults)) => faults,
            other => panic!("not refused: {other:?}"),
        }
    }

    /// Waits for the end of a job.
    pub async fn ended(&self, id: Uuid) -> Job {
        let job = self.wait(id, Duration::from_secs(60)).await.unwrap();
        assert!(
            job.state.is_terminal(),
            "still {:?} with {:?}",
            job.state,
            job.progress
        );
        job
    }

    pub async fn succeeded(&self, id: Uuid) -> Job {
        let job = self.ended(id).await;
        assert_eq!(job.state, JobState::Succeeded, "{:?}", job.error);
        job
    }

    /// Waits until a job runs and tells progress.
    pub async fn in_progress(&self, id: Uuid) {
        let mut events = Box::pin(self.events(id, 0).await.unwrap());
        while let Some(event) = events.next().await {
            if matches!(event, Event::Progress(_)) {
                return;
            }
        }
        panic!("the job ended without progress");
    }

    pub async fn all_events(&self, id: Uuid) -> Vec<Event> {
        self.events(id, 0).await.unwrap().collect().await
    }

    pub async fn report_of(&self, id: Uuid) -> Value {
        let file = self.report(id).await.unwrap();
        serde_json::from_slice(&file.content.read().unwrap()).unwrap()
    }

    /// Where a content lies on the disk.
    pub fn blob(&self, sha256: &str) -> PathBuf {
        let blobs = self.directory.path().join("blobs");
        blobs.join(&sha256[..2]).join(sha256)
    }

    pub async fn upload(
        &self,
        content: &str,
        meta: DatasetMeta,
    ) -> Result<(DatasetInfo, bool), ServiceError> {
        let path = self.datasets().temp_dir().join(Uuid::now_v7().to_string());
        std::fs::write(&path, content).unwrap();
        self.datasets()
            .add(
                ReceivedFile {
                    path,
                    sha256: sha256(content.as_bytes()),
                    bytes: content.len() as u64,
                },
                meta,
            )
            .await
    }
}

pub fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes)
        .iter()
        .map(|byte| format!("{byte:02x}"))
        .collect()
}

pub fn scenario(scans: u32, targets: u32, clutter_per_scan: f64) -> Value {
    json!({
        "scans": scans, "scan_period_s": 1.0,
        "sensors": [{"sensor_id": "radar", "x_m": 0.0, "y_m": 0.0, "max_range_m": 20000.0, "p_d": 0.9,
                     "sigma_x_m": 10.0, "sigma_y_m": 10.0, "clutter_per_scan": clutter_per_scan}],
        "targets": {"kind": "random", "count": targets, "area_side_m": 10000.0, "speed_min_mps": 5.0, "speed_max_mps": 20.0}
    })
}

/// Runs for some milliseconds.
pub fn small(seed: u32) -> Value {
    json!({"scenario": scenario(10, 3, 1.0), "seed": seed})
}

/// Runs for many seconds, asking often whether it should stop.
pub fn long() -> Value {
    json!({"scenario": scenario(100_000, 10, 100.0)})
}

pub fn of_job(id: Uuid) -> Value {
    json!({"source": "job", "job_id": id})
}
