//! Telling other processes that jobs have changed. A notice only says "look again"; what has changed stands in the tables.

use super::Storage;
use super::change::parse_id;
use sqlx::AssertSqlSafe;
use sqlx::postgres::PgListener;
use uuid::Uuid;

const CHANNEL: &str = "trackloom_jobs";
/// Where it is told that something is in the queue.
pub const QUEUE_CHANNEL: &str = "trackloom_queue";
/// A notice holds at most 8 000 bytes.
const IDS_AT_ONCE: usize = 200;

impl Storage {
    /// Tells every process that shares the tables.
    pub async fn notify(&self, ids: &[Uuid]) -> anyhow::Result<()> {
        if !self.is_shared {
            return Ok(());
        }
        for ids in ids.chunks(IDS_AT_ONCE) {
            let ids = ids
                .iter()
                .map(Uuid::to_string)
                .collect::<Vec<_>>()
                .join(",");
            // A notice takes no parameters; the text is made of ids alone.
            sqlx::raw_sql(AssertSqlSafe(format!("NOTIFY {CHANNEL}, '{ids}'")))
                .execute(&self.write)
                .await?;
        }
        Ok(())
    }
}

/// Hears of changes, those of its own process as well.
pub struct Notices(PgListener);

/// What was heard.
pub enum Notice {
    Changed(Vec<Uuid>),
    /// There is something in the queue.
    Queued,
    /// The connection was lost for a while: anything may have changed.
    Anything,
}

impl Notices {
    pub async fn listen(url: &str) -> anyhow::Result<Notices> {
        let mut listener = PgListener::connect(url).await?;
        listener.listen_all([CHANNEL, QUEUE_CHANNEL]).await?;
        Ok(Notices(listener))
    }

    /// The next notice. After a lost connection it connects again by itself.
    pub async fn next(&mut self) -> anyhow::Result<Notice> {
        Ok(match self.0.try_recv().await? {
            Some(notice) if notice.channel() == QUEUE_CHANNEL => Notice::Queued,
            Some(notice) => Notice::Changed(
                notice
                    .payload()
                    .split(',')
                    .filter_map(|id| parse_id(id).ok())
                    .collect(),
            ),
            None => Notice::Anything,
        })
    }
}
