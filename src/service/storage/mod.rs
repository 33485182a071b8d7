//! Where datasets and jobs are kept: `app.db`, and a directory of blobs named by their content.
//!
//! This is the truth about every job; the queue only repeats it. Each change is one short transaction on the single
//! writing connection, so that two changes never meet half-way; reading has its own connections.

mod admission;
pub mod blobs;
mod change;
mod datasets;
mod events;
mod filter;
mod jobs;
mod life;
mod page;

pub use admission::{Admission, IdempotencyKey, NewJob, SourceId, SourceRef};
pub use change::Changed;
pub use datasets::{NewDataset, StoredDataset};
pub use filter::{DatasetFilter, JobFilter, Sort};
pub use jobs::{Cancellation, Deletion, StoredArtifact};
pub use life::{Claim, ClaimedJob, Ending, NewArtifact};
pub use page::Cursor;

use anyhow::Context;
use jiff::Timestamp;
use sqlx::migrate::Migrator;
use sqlx::sqlite::{SqliteConnectOptions, SqliteJournalMode, SqlitePool, SqlitePoolOptions, SqliteSynchronous};
use std::path::Path;
use std::time::Duration;

static MIGRATIONS: Migrator = sqlx::migrate!("src/service/storage/migrations");

/// Connections that may read at the same time.
const READERS: u32 = 4;

/// The tables of one data directory.
#[derive(Debug, Clone)]
pub struct Storage {
    read: SqlitePool,
    write: SqlitePool,
}

impl Storage {
    /// Opens the file, making it and bringing its tables up to date where needed.
    pub async fn open(path: &Path) -> anyhow::Result<Storage> {
        // FULL: what was answered is on the disk, also when the power fails.
        let options = SqliteConnectOptions::new()
            .filename(path)
            .create_if_missing(true)
            .journal_mode(SqliteJournalMode::Wal)
            .synchronous(SqliteSynchronous::Full)
            .foreign_keys(true)
            .busy_timeout(Duration::from_secs(30));
        let pool = |size| SqlitePoolOptions::new().max_connections(size).acquire_timeout(Duration::from_secs(60));
        let write = pool(1).connect_with(options.clone()).await.with_context(|| format!("cannot open {}", path.display()))?;
        MIGRATIONS.run(&write).await.with_context(|| format!("cannot bring {} up to date", path.display()))?;
        let read = pool(READERS).connect_with(options.read_only(true).create_if_missing(false)).await?;
        Ok(Storage { read, write })
    }

    /// Writes nothing from now on; reading goes on until the last reader has gone.
    pub async fn close(&self) {
        self.write.close().await;
    }
}

fn to_micros(time: Timestamp) -> i64 {
    time.as_microsecond()
}

fn from_micros(micros: i64) -> anyhow::Result<Timestamp> {
    Timestamp::from_microsecond(micros).context("a stored time is out of range")
}

/// Now, to the microsecond that is stored.
fn now() -> Timestamp {
    let now = Timestamp::now();
    Timestamp::from_microsecond(now.as_microsecond()).unwrap_or(now)
}
