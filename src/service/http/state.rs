//! What every handler can reach. Built once, when the service starts.

use super::streams::Streams;
use crate::service::jobs::Jobs;
use crate::service::openapi::Documents;
use metrics_exporter_prometheus::PrometheusHandle;
use std::sync::Arc;
use utoipa::ToSchema;

#[derive(Clone)]
pub struct AppState {
    pub jobs: Jobs,
    /// Largest file of an upload.
    pub max_upload_bytes: u64,
    pub metrics: PrometheusHandle,
    pub documents: Arc<Documents>,
    pub streams: Streams,
}

/// The bytes of a file.
#[derive(ToSchema)]
#[schema(value_type = String, format = Binary)]
pub struct FileContent(#[expect(dead_code, reason = "only its schema is used")] Vec<u8>);
