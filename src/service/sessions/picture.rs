//! The picture of a session for pages: what is believed now, and the scans since the picture before.

use super::Sessions;
use crate::service::error::ServiceError;
use crate::service::types::SessionPicture;
use std::time::Duration;
use tokio::time::timeout;
use uuid::Uuid;

impl Sessions {
    /// What is believed, with the scans after a number; where there are none yet it waits for news.
    pub async fn picture(
        &self,
        id: Uuid,
        after_scan: Option<u64>,
        patience: Duration,
    ) -> Result<SessionPicture, ServiceError> {
        let live = self.live(id).await?;
        let mut news = live.news.subscribe();
        let is_new = after_scan.is_none_or(|after| live.session().last_scan() > after);
        if !is_new && !patience.is_zero() {
            // Whether there was news or not, what there is is told.
            let _ = timeout(patience, news.changed()).await;
        }
        if live.is_spoilt() {
            // It was closed, or has to be read from its log.
            let live = self.live(id).await?;
            return Ok(live.session().picture(after_scan));
        }
        Ok(live.session().picture(after_scan))
    }
}
