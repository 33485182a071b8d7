//! One change of the tables. What becomes of its connection is never left open: a connection on which a begin, a commit or a rollback
//! failed is closed, for nobody knows what it is in the midst of. A full disk is enough for that.

use super::recall::Changes;
use sqlx::pool::PoolConnection;
use sqlx::{Any, AnyConnection, AnyPool, Executor};
use std::ops::{Deref, DerefMut};

/// Taken back when it is dropped without a commit.
#[derive(Debug)]
pub(super) struct Change {
    /// Absent when it has ended.
    connection: Option<PoolConnection<Any>>,
    changes: Changes,
}

const HELD: &str = "a change has its connection until it ends";

impl Change {
    /// `statements` begin it; it is counted when it has ended.
    pub async fn begin(
        pool: &AnyPool,
        statements: &'static str,
        changes: &Changes,
    ) -> sqlx::Result<Change> {
        // Made before the first statement, so that a caller who goes away meanwhile leaves nothing open either.
        let mut change = Change {
            connection: Some(pool.acquire().await?),
            changes: changes.clone(),
        };
        if let Err(error) = change.execute(sqlx::raw_sql(statements)).await {
            change.close();
            return Err(error);
        }
        Ok(change)
    }

    pub async fn commit(mut self) -> sqlx::Result<()> {
        let committed = self.execute(sqlx::raw_sql("COMMIT")).await;
        match committed {
            Ok(_) => self.connection = None,
            Err(_) => self.close(),
        }
        self.changes.count();
        committed.map(|_| ())
    }

    fn close(&mut self) {
        if let Some(mut connection) = self.connection.take() {
            connection.close_on_drop();
        }
    }
}

impl Drop for Change {
    fn drop(&mut self) {
        let Some(mut connection) = self.connection.take() else {
            return;
        };
        let changes = self.changes.clone();
        tokio::spawn(async move {
            if let Err(error) = connection.execute(sqlx::raw_sql("ROLLBACK")).await {
                tracing::debug!(%error, "a change was not taken back; its connection is closed");
                connection.close_on_drop();
            }
            // A commit that its caller did not wait for has taken effect before this.
            changes.count();
        });
    }
}

impl Deref for Change {
    type Target = AnyConnection;

    fn deref(&self) -> &AnyConnection {
        self.connection.as_deref().expect(HELD)
    }
}

impl DerefMut for Change {
    fn deref_mut(&mut self) -> &mut AnyConnection {
        self.connection.as_deref_mut().expect(HELD)
    }
}
