//! What can be set, with its defaults.

use super::storage::blobs::BucketUrl;
use super::storage::room::MinFree;
use std::net::SocketAddr;
use std::path::PathBuf;
use std::time::Duration;

/// Where the service listens, and how it keeps and runs jobs.
#[derive(Debug, Clone)]
pub struct Config {
    /// Port 0 takes any free port.
    pub listen: SocketAddr,
    /// The largest upload that is accepted.
    pub max_upload_bytes: u64,
    /// Everything the service keeps is below this directory; one process at a time may use it.
    pub data_dir: PathBuf,
    /// PostgreSQL that several processes share; a file in the data directory when absent.
    pub database_url: Option<String>,
    /// Where the files of datasets and jobs are kept instead of in `data_dir`.
    pub artifacts: Option<BucketUrl>,
    /// What has to stay free on the disk of `data_dir`; below it nothing new is taken.
    pub min_free: MinFree,
    /// Jobs that run at the same time.
    pub slots: usize,
    /// Jobs that may be queued before a new one is refused.
    pub queue_limit: u64,
    /// A job that runs longer than this fails with `time_limit`.
    pub job_time_limit: Duration,
    /// A job that was running this often when the process died fails with `crashed`.
    pub crash_limit: u32,
}

impl Config {
    /// The defaults, with everything kept below `data_dir`.
    pub fn new(data_dir: impl Into<PathBuf>) -> Self {
        Config {
            listen: SocketAddr::from(([127, 0, 0, 1], 8080)),
            max_upload_bytes: 1 << 30,
            data_dir: data_dir.into(),
            database_url: None,
            artifacts: None,
            min_free: MinFree::Usual,
            slots: std::thread::available_parallelism().map_or(1, usize::from),
            queue_limit: 10_000,
            job_time_limit: Duration::from_secs(3600),
            crash_limit: 3,
        }
    }
}
