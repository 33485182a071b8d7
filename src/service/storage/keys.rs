//! Keys: what each allows. The keys themselves are nowhere.

use super::change::parse_id;
use super::{Storage, from_micros, now, to_micros};
use jiff::Timestamp;
use sqlx::Row;
use sqlx::any::AnyRow;
use uuid::Uuid;

/// Keys that are listed.
const MOST: i64 = 1000;

pub struct NewKey {
    pub name: String,
    pub actions: Vec<String>,
    pub expires_at: Option<Timestamp>,
    pub requests_per_minute: Option<u32>,
}

#[derive(Debug, Clone)]
pub struct StoredKey {
    pub id: Uuid,
    pub name: String,
    pub actions: Vec<String>,
    pub requests_per_minute: Option<u32>,
    pub created_at: Timestamp,
    pub expires_at: Option<Timestamp>,
    pub revoked_at: Option<Timestamp>,
}

impl Storage {
    pub async fn add_key(&self, new: NewKey) -> anyhow::Result<StoredKey> {
        let (id, created_at) = (Uuid::now_v7(), now());
        let mut change = self.begin().await?;
        sqlx::query(
            "INSERT INTO keys (id, name, actions, requests_per_minute, created_at, expires_at) VALUES ($1, $2, $3, $4, $5, $6)",
        )
        .bind(id.to_string())
        .bind(&new.name)
        .bind(serde_json::to_string(&new.actions)?)
        .bind(new.requests_per_minute.map(i64::from))
        .bind(to_micros(created_at))
        .bind(new.expires_at.map(to_micros))
        .execute(&mut *change)
        .await?;
        change.commit().await?;
        Ok(StoredKey {
            id,
            name: new.name,
            actions: new.actions,
            requests_per_minute: new.requests_per_minute,
            created_at,
            expires_at: new.expires_at,
            revoked_at: None,
        })
    }

    pub async fn key(&self, id: Uuid) -> anyhow::Result<Option<StoredKey>> {
        let row = sqlx::query("SELECT * FROM keys WHERE id = $1")
            .bind(id.to_string())
            .fetch_optional(&self.read)
            .await?;
        row.as_ref().map(stored).transpose()
    }

    /// Those that are not revoked, newest first.
    pub async fn keys(&self) -> anyhow::Result<Vec<StoredKey>> {
        let query = "SELECT * FROM keys WHERE revoked_at IS NULL ORDER BY created_at DESC, id DESC LIMIT $1";
        let rows = sqlx::query(query).bind(MOST).fetch_all(&self.read).await?;
        rows.iter().map(stored).collect()
    }

    /// Whether there was one to revoke.
    pub async fn revoke_key(&self, id: Uuid) -> anyhow::Result<bool> {
        let mut change = self.begin().await?;
        let revoked =
            sqlx::query("UPDATE keys SET revoked_at = $1 WHERE id = $2 AND revoked_at IS NULL")
                .bind(to_micros(now()))
                .bind(id.to_string())
                .execute(&mut *change)
                .await?;
        change.commit().await?;
        Ok(revoked.rows_affected() == 1)
    }
}

fn stored(row: &AnyRow) -> anyhow::Result<StoredKey> {
    let moment = |name| -> anyhow::Result<Option<Timestamp>> {
        let micros: Option<i64> = row.try_get(name)?;
        micros.map(from_micros).transpose()
    };
    let most: Option<i64> = row.try_get("requests_per_minute")?;
    Ok(StoredKey {
        id: parse_id(row.try_get("id")?)?,
        name: row.try_get("name")?,
        actions: serde_json::from_str(row.try_get("actions")?)?,
        requests_per_minute: most.map(u32::try_from).transpose()?,
        created_at: from_micros(row.try_get("created_at")?)?,
        expires_at: moment("expires_at")?,
        revoked_at: moment("revoked_at")?,
    })
}
