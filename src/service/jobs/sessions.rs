//! Ending sessions: what they took becomes a job.

use super::Jobs;
use crate::service::error::ServiceError;
use crate::service::types::{JobKind, SessionInfo};
use uuid::Uuid;

impl Jobs {
    /// Closes a session: what it took becomes a dataset, and a job tracks it with the same settings.
    pub async fn close_session(&self, id: Uuid) -> Result<SessionInfo, ServiceError> {
        let submit = async |body| {
            let submitted = self.submit(JobKind::Associate, body, None).await?;
            Ok(submitted.job.id)
        };
        self.sessions.close(id, submit).await
    }

    /// Closes the sessions that have reached their age or their size. One that another process has is closed there.
    pub(super) async fn close_sessions_that_are_over(&self) -> anyhow::Result<()> {
        for id in self.sessions.over().await? {
            match self.close_session(id).await {
                Ok(_) => {
                    tracing::info!(session = %id, "a session had reached its end and was closed")
                }
                Err(ServiceError::Conflict {
                    code: "session_elsewhere",
                    ..
                }) => {}
                Err(error) => {
                    tracing::warn!(session = %id, %error, "a session that has reached its end was not closed");
                }
            }
        }
        Ok(())
    }
}
