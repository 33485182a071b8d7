//! What is counted for monitoring, in the text format of Prometheus. `docs/monitoring.md` has the same table.

use anyhow::Context;
use metrics_exporter_prometheus::{PrometheusBuilder, PrometheusHandle};
use std::sync::OnceLock;

pub const REQUESTS: &str = "trackloom_http_requests_total";
pub const REQUEST_SECONDS: &str = "trackloom_http_request_duration_seconds";
pub const JOBS: &str = "trackloom_jobs";
pub const SESSIONS: &str = "trackloom_sessions";
pub const SESSION_TRACKS: &str = "trackloom_session_tracks";
pub const SESSION_WAITING: &str = "trackloom_session_waiting_scans";
pub const SESSION_LAG: &str = "trackloom_session_lag_seconds";
pub const DISK_FREE: &str = "trackloom_disk_free_bytes";

/// Upper ends of the classes of durations (s).
const BUCKETS_S: [f64; 8] = [0.001, 0.005, 0.025, 0.1, 0.5, 2.5, 10.0, 30.0];

/// Values of now: name and what it says.
const GAUGES: [(&str, &str); 6] = [
    (
        JOBS,
        "Jobs by state, of all processes that share the tables.",
    ),
    (SESSIONS, "Live sessions that this process has open."),
    (
        SESSION_TRACKS,
        "Tracks of these sessions, tentative ones among them.",
    ),
    (
        SESSION_WAITING,
        "Scans that these sessions hold back for others that may come late.",
    ),
    (
        SESSION_LAG,
        "How far the session that is most behind is behind what was heard of its sensors (s).",
    ),
    (
        DISK_FREE,
        "Bytes that are free on the disk of the data directory.",
    ),
];

/// The recorder is one for the process; several servers in one process share it.
///
/// # Errors
/// Another recorder is installed.
pub fn recorder() -> anyhow::Result<PrometheusHandle> {
    static HANDLE: OnceLock<Option<PrometheusHandle>> = OnceLock::new();
    HANDLE
        .get_or_init(install)
        .clone()
        .context("metrics cannot be recorded: another recorder is installed")
}

fn install() -> Option<PrometheusHandle> {
    let builder = PrometheusBuilder::new().set_buckets(&BUCKETS_S).ok()?;
    let handle = builder.install_recorder().ok()?;
    for (name, help) in GAUGES {
        metrics::describe_gauge!(name, help);
    }
    metrics::describe_counter!(
        REQUESTS,
        "Requests that were answered, by method, route and status."
    );
    metrics::describe_histogram!(
        REQUEST_SECONDS,
        "Time until an answer began (s), by method, route and status."
    );
    Some(handle)
}
