//! Fresh tables, and a job to put into them.

use super::{Database, NewJob, Storage};
use crate::service::types::JobKind;

pub(super) async fn storage() -> (Storage, tempfile::TempDir) {
    let directory = tempfile::tempdir().unwrap();
    let database = Database::Sqlite(directory.path().join("app.db"));
    (Storage::open(&database).await.unwrap(), directory)
}

pub(super) fn new_job(kind: JobKind, priority: i64) -> NewJob {
    NewJob {
        kind,
        name: None,
        labels: Default::default(),
        spec: "{}".into(),
        spec_sha256: "x".into(),
        seed: 1,
        priority,
        engine_version: "0",
        sources: Vec::new(),
        rerun_of: None,
        idempotency: None,
    }
}
