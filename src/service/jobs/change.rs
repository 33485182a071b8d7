//! Changing jobs that exist: names, cancelling, deleting.

use super::control::Stop;
use super::{JobPatch, Jobs};
use crate::registry::{self, Kind, Object, optional, text_map};
use crate::service::error::ServiceError;
use crate::service::storage::{Cancellation, Changed, Deletion};
use crate::service::types::Job;
use serde_json::{Map, json};
use uuid::Uuid;

/// What a patch of a job may hold, with the limits of a request's own `name` and `labels`.
pub static JOB_PATCH: Object = Object {
    name: "JobPatch",
    summary: "What to change of a job; absent members stay.",
    fields: &[
        optional(
            "name",
            "The name from now on; an empty one removes it.",
            Kind::Text { max_length: 100 },
        ),
        optional("labels", "All labels from now on.", text_map(32, 100)),
        optional(
            "pinned",
            "Whether it stays when old jobs make room; only who asks deletes it then.",
            Kind::Flag,
        ),
    ],
};

impl Jobs {
    pub async fn patch(&self, id: Uuid, patch: JobPatch) -> Result<Job, ServiceError> {
        self.get(id).await?;
        let JobPatch {
            name,
            labels,
            pinned,
        } = patch;
        let mut body = Map::new();
        body.extend(name.as_ref().map(|name| ("name".to_owned(), json!(name))));
        body.extend(
            labels
                .as_ref()
                .map(|labels| ("labels".to_owned(), json!(labels))),
        );
        registry::check(&body.into(), &JOB_PATCH).map_err(ServiceError::Invalid)?;
        self.storage
            .patch_job(id, name.as_deref(), labels.as_ref())
            .await?;
        if let Some(is_pinned) = pinned {
            self.storage.pin_job(id, is_pinned).await?;
        }
        self.get(id).await
    }

    /// Asks a job to stop: a queued one is canceled at once, a running one as soon as it notices.
    pub async fn cancel(&self, id: Uuid) -> Result<Job, ServiceError> {
        self.get(id).await?;
        match self.storage.cancel(id).await? {
            Cancellation::Canceled(changed) | Cancellation::Requested(changed) => {
                self.running.stop(id, Stop::Canceled);
                self.publish(changed).await;
            }
            Cancellation::AlreadyEnded(state) => {
                return Err(ServiceError::conflict(
                    "job_terminal",
                    format!("the job has already {}", ended(state.name())),
                ));
            }
        }
        self.get(id).await
    }

    /// Deletes a job that has ended, with its files; datasets that it made stay.
    pub async fn delete(&self, id: Uuid) -> Result<(), ServiceError> {
        self.get(id).await?;
        match self.storage.delete_job(id).await? {
            Deletion::Deleted(contents) => {
                self.publish(Changed::touch(id)).await;
                self.datasets.collect_garbage(contents).await
            }
            Deletion::StillActive(state) => Err(ServiceError::conflict(
                "job_active",
                format!("the job is {}; cancel it first", state.name()),
            )),
            Deletion::NeededBy(users) => Err(ServiceError::in_use("the job's results are", &users)),
        }
    }
}

fn ended(state: &str) -> String {
    if state == "canceled" {
        "been canceled".to_owned()
    } else {
        state.to_owned()
    }
}
