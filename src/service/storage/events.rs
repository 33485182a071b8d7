//! Reading the events of a job.

use super::{Storage, from_micros};
use crate::service::types::{Event, EventData};
use anyhow::bail;
use sqlx::Row;
use sqlx::any::AnyRow;
use uuid::Uuid;

/// Events read at once.
const BATCH: i64 = 500;

impl Storage {
    /// The events after number `after`, at most a batch of them.
    pub async fn events(&self, id: Uuid, after: u64) -> anyhow::Result<Vec<Event>> {
        let rows = sqlx::query("SELECT seq, type, at, data FROM job_events WHERE job_id = $1 AND seq > $2 ORDER BY seq LIMIT $3")
            .bind(id.to_string())
            .bind(i64::try_from(after).unwrap_or(i64::MAX))
            .bind(BATCH)
            .fetch_all(&self.read)
            .await?;
        rows.iter().map(|row| event(id, row)).collect()
    }
}

fn event(id: Uuid, row: &AnyRow) -> anyhow::Result<Event> {
    let json: &str = row.try_get("data")?;
    let data = match row.try_get("type")? {
        "state" => EventData::State(serde_json::from_str(json)?),
        "progress" => EventData::Progress(serde_json::from_str(json)?),
        "log" => EventData::Log(serde_json::from_str(json)?),
        "done" => EventData::Done(serde_json::from_str(json)?),
        other => bail!("a stored event has the unknown type {other}"),
    };
    Ok(Event::new(
        id,
        row.try_get::<i64, _>("seq")?.cast_unsigned(),
        from_micros(row.try_get("at")?)?,
        data,
    ))
}
