//! How much is kept.

use serde::Serialize;
use utoipa::ToSchema;

/// What is kept, and how much of it may be.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct Usage {
    /// Bytes of the files of datasets and jobs, each content once.
    pub files_bytes: u64,
    /// Bytes of the tables, with the logs of live sessions.
    pub tables_bytes: u64,
    /// What both together may be (`--max-data`): above it the jobs that ended first go. Absent without a limit.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub max_data_bytes: Option<u64>,
    /// Jobs that have ended and may go.
    pub ended_jobs: u64,
    /// Jobs that stay.
    pub pinned_jobs: u64,
    /// How many ended jobs are kept (`--keep-jobs`). Absent without a limit.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub keep_jobs: Option<u64>,
    /// Bytes that are free on the disk of the data directory.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub disk_free_bytes: Option<u64>,
}
