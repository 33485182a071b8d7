//! Where datasets and jobs are kept: tables in a SQLite file or a PostgreSQL database, and blobs named by their content.
//!
//! This is the truth about every job; the queue only repeats it. Each change is one short transaction, one at a time, so
//! that two changes never meet half-way: SQLite has a single writing connection, PostgreSQL a table that writers lock. The
//! SQL is the same for both: ids and JSON are text, times and counts are 64-bit integers, parameters are numbered.

mod admission;
pub mod blobs;
mod change;
mod chunks;
mod database;
mod datasets;
mod events;
mod filter;
mod jobs;
mod keys;
mod life;
mod migrations;
pub mod notices;
mod outbox;
mod page;
mod recall;
mod retention;
pub mod room;
mod sessions;
mod statement;
mod transaction;
mod unsynced;

pub use admission::{Admission, IdempotencyKey, NewJob, SourceId, SourceRef};
pub use change::{Changed, Ready};
pub use chunks::{Chunk, ChunkKind, ChunkResult, ClaimedChunk, NewChunk};
pub use database::{Database, NoSweeping, Storage};
pub use datasets::{NewDataset, StoredDataset};
pub use filter::{DatasetFilter, JobFilter, Paging, Sort};
pub use jobs::{Cancellation, Deletion, StoredArtifact};
pub use keys::{NewKey, StoredKey};
pub use life::{Claim, ClaimedJob, Ending, NewArtifact};
pub use page::{Cursor, Page};
pub use retention::EndOfJob;
pub use sessions::{Checkpoint, Lease, LogAppend, NewSession, SessionEnd, StoredSession};

use anyhow::Context;
use jiff::Timestamp;

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

#[cfg(test)]
mod tests;
