//! Live sessions: one row each, and a log of what was pushed into it.

use super::change::parse_id;
use super::database::Durability;
use super::filter::Paging;
use super::page::{Cursor, Page};
use super::statement::Statement;
use super::{Storage, from_micros, now, to_micros};
use crate::service::types::SessionState;
use jiff::{SignedDuration, Timestamp};
use serde_json::{Value, json};
use sqlx::any::AnyRow;
use sqlx::{AnyConnection, Row};
use std::collections::BTreeMap;
use uuid::Uuid;

/// How long a process has a session without saying so again.
const LEASE: SignedDuration = SignedDuration::from_secs(10);
/// Entries that are read at once.
const LOG_PAGE: i64 = 500;

/// A session about to be kept.
#[derive(Debug)]
pub struct NewSession {
    pub name: Option<String>,
    pub labels: BTreeMap<String, String>,
    pub spec: Value,
}

/// The row of a session.
#[derive(Debug, Clone)]
pub struct StoredSession {
    pub id: Uuid,
    pub name: Option<String>,
    pub labels: BTreeMap<String, String>,
    pub spec: Value,
    pub state: SessionState,
    pub fault: Option<Value>,
    pub entries: u64,
    pub log_bytes: u64,
    pub dataset_id: Option<Uuid>,
    pub job_id: Option<Uuid>,
    pub track_ids: Option<Vec<String>>,
    pub created_at: Timestamp,
    pub closed_at: Option<Timestamp>,
    pub deleted: bool,
}

/// What a session knew after some entries.
pub struct Checkpoint {
    pub bytes: Vec<u8>,
    pub entries: u64,
    pub version: String,
}

/// Who has a session.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Lease {
    /// Whoever asked, with the number by which it writes.
    Ours { fence: i64 },
    /// Another process, which is reached there.
    Theirs { address: Option<String> },
}

/// Entries of one session that are to be kept together.
#[derive(Debug, Clone)]
pub struct LogAppend {
    pub session: Uuid,
    pub fence: i64,
    /// Entries that the log has.
    pub after: u64,
    /// As JSON.
    pub entries: Vec<String>,
}

/// How a session ends.
#[derive(Debug, Clone, Default)]
pub struct SessionEnd {
    pub fault: Option<Value>,
    pub dataset_id: Option<Uuid>,
    pub job_id: Option<Uuid>,
    /// What the tracks of the job were called.
    pub track_ids: Option<Vec<String>>,
}

const COLUMNS: &str = "SELECT id, name, labels, spec, state, fault, entries, log_bytes, dataset_id, job_id, track_ids, created_at, closed_at,
    CASE WHEN deleted_at IS NULL THEN 0 ELSE 1 END AS deleted FROM sessions WHERE ";

impl Storage {
    pub async fn add_session(&self, new: &NewSession) -> anyhow::Result<Uuid> {
        let id = Uuid::now_v7();
        let mut change = self.begin().await?;
        sqlx::query("INSERT INTO sessions (id, name, labels, spec, state, created_at) VALUES ($1, $2, $3, $4, 'open', $5)")
            .bind(id.to_string())
            .bind(&new.name)
            .bind(serde_json::to_string(&new.labels)?)
            .bind(new.spec.to_string())
            .bind(to_micros(now()))
            .execute(&mut *change)
            .await?;
        change.commit().await?;
        Ok(id)
    }

    pub async fn session(&self, id: Uuid) -> anyhow::Result<Option<StoredSession>> {
        let mut query = Statement::new(COLUMNS);
        query.push("id = ").bind(id.to_string());
        let row = query.query().fetch_optional(&self.read).await?;
        row.as_ref().map(stored).transpose()
    }

    pub async fn sessions(
        &self,
        paging: &Paging,
        after: Option<Cursor>,
    ) -> anyhow::Result<Page<StoredSession>> {
        let count = "SELECT count(*) FROM sessions WHERE ";
        let condition = Statement::new("deleted_at IS NULL");
        self.page((COLUMNS, count), condition, (paging, after), stored)
            .await
    }

    /// All that are open.
    pub async fn open_sessions(&self) -> anyhow::Result<Vec<StoredSession>> {
        let query = Statement::new("state = 'open' AND deleted_at IS NULL").after(COLUMNS);
        let rows = query.query().fetch_all(&self.read).await?;
        rows.iter().map(stored).collect()
    }

    /// Takes a session for this process, unless another one has it.
    pub async fn lease_session(&self, id: Uuid, address: &str) -> anyhow::Result<Lease> {
        let until = to_micros(now() + LEASE);
        let mut change = self.begin().await?;
        let fence: Option<i64> = sqlx::query_scalar(
            "UPDATE sessions SET owner = $1, address = $2, leased_until = $3, fence = fence + 1
             WHERE id = $4 AND (owner IS NULL OR owner = $1 OR leased_until < $5) RETURNING fence",
        )
        .bind(&self.owner)
        .bind(address)
        .bind(until)
        .bind(id.to_string())
        .bind(to_micros(now()))
        .fetch_optional(&mut *change)
        .await?;
        if let Some(fence) = fence {
            change.commit().await?;
            return Ok(Lease::Ours { fence });
        }
        let address: Option<Option<String>> =
            sqlx::query_scalar("SELECT address FROM sessions WHERE id = $1")
                .bind(id.to_string())
                .fetch_optional(&mut *change)
                .await?;
        Ok(Lease::Theirs {
            address: address.flatten(),
        })
    }

    /// Has this process keep the sessions that it has.
    pub async fn renew_sessions(&self) -> anyhow::Result<()> {
        let mut change = self.begin_with(Durability::Passing).await?;
        sqlx::query("UPDATE sessions SET leased_until = $1 WHERE owner = $2 AND state = 'open'")
            .bind(to_micros(now() + LEASE))
            .bind(&self.owner)
            .execute(&mut *change)
            .await?;
        Ok(change.commit().await?)
    }

    /// Gives back what this process has, so that another one need not wait.
    pub async fn release_sessions(&self) -> anyhow::Result<()> {
        let mut change = self.begin().await?;
        sqlx::query("UPDATE sessions SET owner = NULL WHERE owner = $1")
            .bind(&self.owner)
            .execute(&mut *change)
            .await?;
        Ok(change.commit().await?)
    }

    /// Appends to several logs in one change; tells for each whether it was taken: not where another process has the session
    /// by now, nor where it is no longer open.
    pub async fn append_to_logs(&self, appends: &[LogAppend]) -> anyhow::Result<Vec<bool>> {
        let mut change = self.begin().await?;
        let mut taken = Vec::with_capacity(appends.len());
        for append in appends {
            taken.push(append_one(&mut change, append).await?);
        }
        change.commit().await?;
        Ok(taken)
    }

    /// Entries of a log after a position, oldest first: a page of them.
    pub async fn log_page(&self, id: Uuid, after: u64) -> anyhow::Result<Vec<String>> {
        let query = "SELECT entry FROM session_log WHERE session_id = $1 AND position > $2 ORDER BY position LIMIT $3";
        Ok(sqlx::query_scalar(query)
            .bind(id.to_string())
            .bind(after.cast_signed())
            .bind(LOG_PAGE)
            .fetch_all(&self.work)
            .await?)
    }

    pub async fn checkpoint(&self, id: Uuid) -> anyhow::Result<Option<Checkpoint>> {
        let query = "SELECT checkpoint, checkpoint_entries, checkpoint_version FROM sessions WHERE id = $1 AND checkpoint IS NOT NULL";
        let row = sqlx::query(query)
            .bind(id.to_string())
            .fetch_optional(&self.work)
            .await?;
        let read = |row: AnyRow| {
            Ok(Checkpoint {
                bytes: row.try_get(0)?,
                entries: row.try_get::<i64, _>(1)?.cast_unsigned(),
                version: row.try_get(2)?,
            })
        };
        row.map(read).transpose()
    }

    /// Keeps a checkpoint in the place of the one before, unless another process has the session by now. It may be lost when the power
    /// fails: the log is not.
    pub async fn keep_checkpoint(
        &self,
        id: Uuid,
        fence: i64,
        checkpoint: Checkpoint,
    ) -> anyhow::Result<()> {
        let mut change = self.begin_with(Durability::Passing).await?;
        sqlx::query(
            "UPDATE sessions SET checkpoint = $1, checkpoint_entries = $2, checkpoint_version = $3
             WHERE id = $4 AND fence = $5 AND checkpoint_entries <= $2",
        )
        .bind(checkpoint.bytes)
        .bind(checkpoint.entries.cast_signed())
        .bind(checkpoint.version)
        .bind(id.to_string())
        .bind(fence)
        .execute(&mut *change)
        .await?;
        Ok(change.commit().await?)
    }

    /// Ends a session that this process has.
    pub async fn end_session(
        &self,
        id: Uuid,
        fence: i64,
        end: &SessionEnd,
    ) -> anyhow::Result<bool> {
        let state = if end.fault.is_some() {
            SessionState::Failed
        } else {
            SessionState::Closed
        };
        let mut change = self.begin().await?;
        let ended = sqlx::query(
            "UPDATE sessions SET state = $1, fault = $2, dataset_id = $3, job_id = $4, track_ids = $5, closed_at = $6
             WHERE id = $7 AND fence = $8 AND state = 'open'",
        )
        .bind(state.name())
        .bind(end.fault.as_ref().map(Value::to_string))
        .bind(end.dataset_id.map(|id| id.to_string()))
        .bind(end.job_id.map(|id| id.to_string()))
        .bind(end.track_ids.as_ref().map(|ids| json!(ids).to_string()))
        .bind(to_micros(now()))
        .bind(id.to_string())
        .bind(fence)
        .execute(&mut *change)
        .await?;
        change.commit().await?;
        Ok(ended.rows_affected() == 1)
    }

    /// Deletes a session with its log; what was made of it stays.
    pub async fn delete_session(&self, id: Uuid) -> anyhow::Result<()> {
        let mut change = self.begin().await?;
        sqlx::query(
            "UPDATE sessions SET deleted_at = $1, checkpoint = NULL, state = 'closed', fence = fence + 1 WHERE id = $2",
        )
        .bind(to_micros(now()))
        .bind(id.to_string())
        .execute(&mut *change)
        .await?;
        sqlx::query("DELETE FROM session_log WHERE session_id = $1")
            .bind(id.to_string())
            .execute(&mut *change)
            .await?;
        Ok(change.commit().await?)
    }
}

async fn append_one(connection: &mut AnyConnection, append: &LogAppend) -> anyhow::Result<bool> {
    let (session, count) = (append.session.to_string(), append.entries.len() as i64);
    let bytes: usize = append.entries.iter().map(String::len).sum();
    let noted = sqlx::query(
        "UPDATE sessions SET entries = entries + $1, log_bytes = log_bytes + $5
         WHERE id = $2 AND fence = $3 AND entries = $4 AND state = 'open'",
    )
    .bind(count)
    .bind(&session)
    .bind(append.fence)
    .bind(append.after.cast_signed())
    .bind(bytes as i64)
    .execute(&mut *connection)
    .await?;
    if noted.rows_affected() != 1 {
        return Ok(false);
    }
    for (entry, position) in append.entries.iter().zip(append.after + 1..) {
        sqlx::query("INSERT INTO session_log (session_id, position, entry) VALUES ($1, $2, $3)")
            .bind(&session)
            .bind(position.cast_signed())
            .bind(entry)
            .execute(&mut *connection)
            .await?;
    }
    Ok(true)
}

fn stored(row: &AnyRow) -> anyhow::Result<StoredSession> {
    let id_at = |name| -> anyhow::Result<Option<Uuid>> {
        let text: Option<String> = row.try_get(name)?;
        text.map(|text| parse_id(&text)).transpose()
    };
    let fault: Option<String> = row.try_get("fault")?;
    let track_ids: Option<String> = row.try_get("track_ids")?;
    let closed_at: Option<i64> = row.try_get("closed_at")?;
    Ok(StoredSession {
        id: parse_id(row.try_get("id")?)?,
        name: row.try_get("name")?,
        labels: serde_json::from_str(row.try_get("labels")?)?,
        spec: serde_json::from_str(row.try_get("spec")?)?,
        state: SessionState::from_name(row.try_get("state")?),
        fault: fault.map(|text| serde_json::from_str(&text)).transpose()?,
        entries: row.try_get::<i64, _>("entries")?.cast_unsigned(),
        log_bytes: row.try_get::<i64, _>("log_bytes")?.cast_unsigned(),
        dataset_id: id_at("dataset_id")?,
        job_id: id_at("job_id")?,
        track_ids: track_ids
            .map(|text| serde_json::from_str(&text))
            .transpose()?,
        created_at: from_micros(row.try_get("created_at")?)?,
        closed_at: closed_at.map(from_micros).transpose()?,
        deleted: row.try_get::<i64, _>("deleted")? != 0,
    })
}
