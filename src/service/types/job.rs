//! Jobs on the wire.

use super::problem::Problem;
pub use crate::experiment::JobKind;
pub use crate::experiment::observer::Step as ProgressStep;
use jiff::Timestamp;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::time::Duration;
use utoipa::ToSchema;
use uuid::Uuid;

/// Where a job is in its life.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum JobState {
    Queued,
    Running,
    Succeeded,
    Failed,
    Canceled,
}

impl JobState {
    pub const ALL: [JobState; 5] = [
        JobState::Queued,
        JobState::Running,
        JobState::Succeeded,
        JobState::Failed,
        JobState::Canceled,
    ];

    pub fn name(self) -> &'static str {
        match self {
            JobState::Queued => "queued",
            JobState::Running => "running",
            JobState::Succeeded => "succeeded",
            JobState::Failed => "failed",
            JobState::Canceled => "canceled",
        }
    }

    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|state| state.name() == name)
    }

    /// Nothing will change it any more.
    pub fn is_terminal(self) -> bool {
        matches!(
            self,
            JobState::Succeeded | JobState::Failed | JobState::Canceled
        )
    }
}

/// How far a running job is.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Progress {
    pub step: ProgressStep,
    /// Pieces of the step that are done.
    pub done: u64,
    /// Pieces that the step has.
    pub total: u64,
    /// Share of the whole job that is done, from 0 to 1.
    #[schema(minimum = 0, maximum = 1)]
    pub fraction: f64,
    /// Estimated seconds to the end; absent while unknown.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub eta_s: Option<f64>,
}

/// Progress is told at most this often, and ever less often in long jobs, so that its events stay few.
const PAUSE: Duration = Duration::from_millis(250);
const LONGEST_PAUSE: Duration = Duration::from_secs(5);
const SHARE_OF_ELAPSED: u32 = 100;
/// No estimate of the rest before this much is known.
const ETA_AFTER: (Duration, f64) = (Duration::from_millis(500), 0.02);

impl Progress {
    /// How long nothing is told after something was.
    pub fn pause_after(elapsed: Duration) -> Duration {
        (elapsed / SHARE_OF_ELAPSED).clamp(PAUSE, LONGEST_PAUSE)
    }

    /// Seconds to the end, if the rest is made as fast as what is done; `None` while too little is known.
    pub fn left_s(elapsed: Duration, fraction: f64) -> Option<f64> {
        let is_known = elapsed > ETA_AFTER.0 && fraction > ETA_AFTER.1;
        is_known.then(|| elapsed.as_secs_f64() * (1.0 - fraction) / fraction)
    }
}

/// A job.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Job {
    pub id: Uuid,
    pub kind: JobKind,
    pub state: JobState,
    /// How often the job has been started.
    pub attempt: u32,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub name: Option<String>,
    pub labels: BTreeMap<String, String>,
    #[schema(value_type = String, format = DateTime)]
    pub created_at: Timestamp,
    #[schema(value_type = String, format = DateTime)]
    pub queued_at: Timestamp,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<String>, format = DateTime, nullable = false)]
    pub started_at: Option<Timestamp>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<String>, format = DateTime, nullable = false)]
    pub finished_at: Option<Timestamp>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<String>, format = DateTime, nullable = false)]
    pub cancel_requested_at: Option<Timestamp>,
    pub can_cancel: bool,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub progress: Option<Progress>,
    /// Why the job failed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub error: Option<Problem>,
    pub warnings: Vec<String>,
    /// Jobs whose results this job needs.
    pub depends_on: Vec<Uuid>,
    pub seed: u32,
    /// Version of the program that ran, or will run, the job.
    pub engine_version: String,
    pub spec_sha256: String,
    /// An earlier job that did exactly the same and succeeded.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub duplicate_of: Option<Uuid>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub rerun_of: Option<Uuid>,
    /// It stays, however old it is and whatever room is wanted.
    pub pinned: bool,
    pub links: JobLinks,
}

/// Paths of what belongs to a job.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct JobLinks {
    #[serde(rename = "self")]
    pub self_path: String,
    pub cancel: String,
    pub rerun: String,
    pub events: String,
    pub history: String,
    pub report: String,
    pub artifacts: String,
    pub ui: String,
}

impl JobLinks {
    pub fn of(id: Uuid) -> Self {
        let base = format!("/v1/jobs/{id}");
        JobLinks {
            cancel: format!("{base}/cancel"),
            rerun: format!("{base}/rerun"),
            events: format!("{base}/events"),
            history: format!("{base}/history"),
            report: format!("{base}/report"),
            artifacts: format!("{base}/artifacts"),
            ui: format!("/?view=job&job={id}"),
            self_path: base,
        }
    }
}

/// One page of jobs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct JobPage {
    pub items: Vec<Job>,
    /// Give it back as `cursor` to get the next page; absent on the last one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub next_cursor: Option<String>,
    /// How many jobs match; only when asked for with `count=true`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub total: Option<u64>,
}

/// A file that a job left behind.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ArtifactInfo {
    pub name: String,
    pub media_type: String,
    pub bytes: u64,
    pub sha256: String,
    /// Set where the file is a dataset that other jobs can use.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub dataset_id: Option<Uuid>,
    pub href: String,
}

/// Every file that a job left behind.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ArtifactList {
    pub items: Vec<ArtifactInfo>,
}
