//! What every handler can reach. Built once, when the service starts.

use super::conditional::Constant;
use super::streams::Streams;
use crate::service::datasets::Datasets;
use crate::service::jobs::Jobs;
use crate::service::keys::Keys;
use crate::service::sessions::Sessions;
use metrics_exporter_prometheus::PrometheusHandle;
use std::sync::Arc;
use utoipa::ToSchema;

#[derive(Clone)]
pub struct AppState {
    pub jobs: Arc<Jobs>,
    pub datasets: Arc<Datasets>,
    pub sessions: Arc<Sessions>,
    pub keys: Arc<Keys>,
    /// Whether others reach the service by https.
    pub has_tls: bool,
    /// Largest file of an upload.
    pub max_upload_bytes: u64,
    pub metrics: PrometheusHandle,
    pub documents: Arc<Documents>,
    pub streams: Streams,
}

/// The API documents as they are served.
pub struct Documents {
    pub v3_1: Constant,
    pub v3_0: Constant,
}

/// The bytes of a file.
#[derive(ToSchema)]
#[schema(value_type = String, format = Binary)]
pub struct FileContent(#[expect(dead_code, reason = "only its schema is used")] Vec<u8>);
