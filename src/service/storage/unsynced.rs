//! Contents of files that may not be on the disk by themselves yet. They are written in the change that names the files, so that this
//! one change makes all of them safe; later the files are synced together, and the contents are forgotten.

use super::{Storage, now, to_micros};
use crate::service::storage::database::Durability;
use crate::service::storage::statement::Statement;
use sqlx::{AnyConnection, Row};
use std::time::Duration;
use uuid::Uuid;

/// Notes that are read or forgotten at once: the contents of the files of as many jobs fit into memory.
const BATCH: i64 = 500;

/// A file whose content is safe in the tables alone, when its machine has lost power.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct UnsyncedBlob {
    pub id: String,
    pub sha256: String,
    pub content: Vec<u8>,
}

impl Storage {
    /// Ids of what this process has noted; at most a batch of them.
    pub async fn unsynced(&self) -> anyhow::Result<Vec<String>> {
        let ids = sqlx::query_scalar(
            "SELECT id FROM unsynced_blobs WHERE owner = $1 ORDER BY id LIMIT $2",
        );
        Ok(ids
            .bind(&self.owner)
            .bind(BATCH)
            .fetch_all(&self.work)
            .await?)
    }

    /// What a process noted at least so long ago, or at any time, and has not forgotten since; some of it.
    pub async fn left_unsynced(&self, age: Option<Duration>) -> anyhow::Result<Vec<UnsyncedBlob>> {
        let before = match age {
            Some(age) => to_micros(now()) - i64::try_from(age.as_micros())?,
            None => i64::MAX,
        };
        let rows = sqlx::query("SELECT id, sha256, content FROM unsynced_blobs WHERE noted_at <= $1 ORDER BY id LIMIT 20")
            .bind(before)
            .fetch_all(&self.work)
            .await?;
        let blob = |row: &sqlx::any::AnyRow| {
            Ok(UnsyncedBlob {
                id: row.try_get("id")?,
                sha256: row.try_get("sha256")?,
                content: row.try_get("content")?,
            })
        };
        rows.iter().map(blob).collect()
    }

    /// The files are on the disk.
    pub async fn forget_unsynced(&self, ids: Vec<String>) -> anyhow::Result<()> {
        if ids.is_empty() {
            return Ok(());
        }
        // One that comes again after a power failure costs a look at a file.
        let mut change = self.begin_with(Durability::Passing).await?;
        let mut statement = Statement::new("DELETE FROM unsynced_blobs WHERE id IN ");
        statement.bind_list(ids.into_iter());
        statement.query().execute(&mut *change).await?;
        Ok(change.commit().await?)
    }
}

pub(super) async fn note_unsynced(
    connection: &mut AnyConnection,
    owner: &str,
    sha256: &str,
    content: &[u8],
) -> anyhow::Result<()> {
    sqlx::query("INSERT INTO unsynced_blobs (id, sha256, owner, content, noted_at) VALUES ($1, $2, $3, $4, $5)")
        .bind(Uuid::now_v7().to_string())
        .bind(sha256)
        .bind(owner)
        .bind(content.to_vec())
        .bind(to_micros(now()))
        .execute(connection)
        .await?;
    Ok(())
}
