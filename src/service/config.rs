//! What can be set, with its defaults.

use super::keys::MasterKey;
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
    /// Where others reach it, if not at the address on which it listens.
    pub public_url: Option<String>,
    /// From which the keys come that the service asks for; it asks for none when absent.
    pub master_key: Option<MasterKey>,
    /// Names besides `localhost` and the addresses themselves by which the service is asked.
    pub allowed_hosts: Vec<String>,
    /// Sites whose pages may use the service, such as `https://radar.example.org`.
    pub allowed_origins: Vec<String>,
    pub connections: ConnectionLimits,
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
    /// What may be kept; above it the jobs that ended first go. No limit when absent.
    pub max_data_bytes: Option<u64>,
    /// How many jobs that have ended are kept. All when absent.
    pub keep_jobs: Option<u64>,
    /// Jobs that run at the same time.
    pub slots: usize,
    /// Jobs that may be queued before a new one is refused.
    pub queue_limit: u64,
    /// A job that runs longer than this fails with `time_limit`.
    pub job_time_limit: Duration,
    /// Memory that a job, or the check of an upload, may use; its share of the machine's when absent.
    pub job_memory_bytes: Option<u64>,
    /// The program whose processes do the work, where that is not the program of this process: `trackloom`, of the same version.
    pub child_program: Option<PathBuf>,
    /// A job that was running this often when the process died fails with `crashed`.
    pub crash_limit: u32,
}

impl Config {
    /// The defaults, with everything kept below `data_dir`.
    pub fn new(data_dir: impl Into<PathBuf>) -> Self {
        Config {
            listen: SocketAddr::from(([127, 0, 0, 1], 8080)),
            public_url: None,
            master_key: None,
            allowed_hosts: Vec::new(),
            allowed_origins: Vec::new(),
            connections: ConnectionLimits::default(),
            max_upload_bytes: 1 << 30,
            data_dir: data_dir.into(),
            database_url: None,
            artifacts: None,
            min_free: MinFree::Usual,
            max_data_bytes: None,
            keep_jobs: None,
            slots: std::thread::available_parallelism().map_or(1, usize::from),
            queue_limit: 10_000,
            job_time_limit: Duration::from_secs(3600),
            job_memory_bytes: None,
            child_program: None,
            crash_limit: 3,
        }
    }

    /// Whether others reach the service by https, which a proxy ends.
    pub fn has_tls(&self) -> bool {
        let url = self.public_url.as_deref();
        url.is_some_and(|url| url.starts_with("https://"))
    }
}

/// What clients may use of the service, and for how long it waits for them.
#[derive(Debug, Clone)]
pub struct ConnectionLimits {
    /// Open at the same time; one more is answered with `too_many_connections`.
    pub connections: usize,
    /// Event streams open at the same time, of all clients together.
    pub streams: usize,
    /// Event streams of one client address.
    pub streams_per_client: usize,
    /// From the first byte of a request until its headers are complete.
    pub header_time: Duration,
    /// Without a request; what is connected longer is closed.
    pub idle_time: Duration,
    /// A client that sends a body or reads an answer must move at least [`Self::least_bytes`] in each such time.
    pub transfer_time: Duration,
    pub least_bytes: usize,
}

/// Connections by default, however many files may be open, and however few.
const CONNECTIONS: (usize, usize) = (8, 4096);
/// Files that the database, the queue and refusals of connections take.
const OWN_FILES: usize = 64;
/// What a system without `/proc` allows a process at least.
const USUAL_OPEN_FILES: usize = 256;

impl Default for ConnectionLimits {
    fn default() -> Self {
        ConnectionLimits::of(connections_of(
            open_file_limit().unwrap_or(USUAL_OPEN_FILES),
        ))
    }
}

impl ConnectionLimits {
    /// The defaults around so many connections: half of them may be streams.
    pub fn of(connections: usize) -> Self {
        let streams = (connections / 2).max(1);
        ConnectionLimits {
            connections,
            streams,
            streams_per_client: streams.min(128),
            header_time: Duration::from_secs(10),
            idle_time: Duration::from_secs(60),
            transfer_time: Duration::from_secs(30),
            least_bytes: 16 << 10,
        }
    }
}

/// Half of the files that may be open, so that each answer can have a file, too.
fn connections_of(open_files: usize) -> usize {
    (open_files / 2)
        .min(open_files.saturating_sub(OWN_FILES))
        .clamp(CONNECTIONS.0, CONNECTIONS.1)
}

/// How many files the process may open, where the system tells.
fn open_file_limit() -> Option<usize> {
    read_limit(&std::fs::read_to_string("/proc/self/limits").ok()?)
}

fn read_limit(limits: &str) -> Option<usize> {
    let row = limits
        .lines()
        .find_map(|line| line.strip_prefix("Max open files"))?;
    match row.split_whitespace().next()? {
        "unlimited" => Some(usize::MAX),
        number => number.parse().ok(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn connections_take_half_of_the_files_that_may_be_open() {
        let table = "Limit                     Soft Limit           Hard Limit           Units\n\
                     Max processes             127398               127398               processes\n\
                     Max open files            1024                 524288               files\n";
        assert_eq!(read_limit(table), Some(1024));
        assert_eq!(
            read_limit("Max open files            unlimited            unlimited            files"),
            Some(usize::MAX)
        );
        assert_eq!(read_limit("Max cpu time  unlimited"), None);
        assert_eq!(
            [32, 64, 100, 256, 1024, 1 << 20].map(connections_of),
            [8, 8, 36, 128, 512, 4096]
        );
        let limits = ConnectionLimits::of(512);
        assert_eq!(
            (
                limits.connections,
                limits.streams,
                limits.streams_per_client
            ),
            (512, 256, 128)
        );
        assert_eq!(ConnectionLimits::of(1).streams_per_client, 1);
    }
}
