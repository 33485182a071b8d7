//! From a request to a queued job.

use super::inputs::source_refs;
use super::{Jobs, Submitted, Validation};
use crate::experiment::{self, Plan};
use crate::model::fault::Fault;
use crate::service::canonical::sorted;
use crate::service::child::report::ENGINE_VERSION;
use crate::service::error::ServiceError;
use crate::service::storage::blobs::sha256_hex;
use crate::service::storage::{Admission, IdempotencyKey, NewJob};
use crate::service::types::{Job, JobKind};
use anyhow::Context;
use serde_json::Value;
use std::collections::BTreeMap;
use uuid::Uuid;

impl Jobs {
    /// Checks a request and queues its job. A key that was used for the same request gives the job of that time.
    pub async fn submit(
        &self,
        kind: JobKind,
        body: Value,
        idempotency_key: Option<String>,
    ) -> Result<Submitted, ServiceError> {
        self.submit_rerun(kind, body, idempotency_key, None).await
    }

    async fn submit_rerun(
        &self,
        kind: JobKind,
        body: Value,
        key: Option<String>,
        rerun_of: Option<Uuid>,
    ) -> Result<Submitted, ServiceError> {
        if self.closing.is_cancelled() {
            return Err(ServiceError::ShuttingDown);
        }
        let idempotency = key.map(|key| IdempotencyKey {
            key,
            request_sha256: request_sha256(kind, &body),
        });
        // A repeated request is answered as before, even if it would be refused by now.
        if let Some(key) = &idempotency
            && let Some(admission) = self.storage.remembered(key).await?
        {
            return self.answer(admission).await;
        }
        self.make_room(0).await?;
        self.room.check(0)?;
        let mut plan = planned(kind, body).await?.map_err(ServiceError::Invalid)?;
        let (known, _) = self.known_of(&plan).await?;
        let faults = experiment::check_known(&mut plan, &known);
        if !faults.is_empty() {
            return Err(ServiceError::Invalid(faults));
        }
        let new = new_job(kind, plan, rerun_of, idempotency)?;
        let admission = self.storage.admit(&new, self.config.queue_limit).await?;
        self.answer(admission).await
    }

    async fn answer(&self, admission: Admission) -> Result<Submitted, ServiceError> {
        match admission {
            Admission::Admitted(id, changed) => {
                // As it was taken in: a moment later it may be running.
                let job = self.get(id).await;
                self.publish(changed).await;
                Ok(Submitted {
                    job: job?,
                    replayed: false,
                })
            }
            Admission::Replayed(id) => Ok(Submitted {
                job: self.get(id).await?,
                replayed: true,
            }),
            Admission::Mismatch => Err(ServiceError::IdempotencyMismatch),
            Admission::QueueFull => Err(ServiceError::QueueFull),
            Admission::Missing(faults) => Err(ServiceError::Invalid(faults)),
        }
    }

    /// The same checks as [`Self::submit`], without a job.
    pub async fn validate(&self, kind: JobKind, body: Value) -> Result<Validation, ServiceError> {
        let refused = |faults| Validation {
            faults,
            warnings: Vec::new(),
            estimate: None,
        };
        let mut plan = match planned(kind, body).await? {
            Ok(plan) => plan,
            Err(faults) => return Ok(refused(faults)),
        };
        let missing: Vec<Fault> = self.storage.missing_sources(&source_refs(&plan)).await?;
        if !missing.is_empty() {
            return Ok(refused(missing));
        }
        let (known, warnings) = self.known_of(&plan).await?;
        let faults = experiment::check_known(&mut plan, &known);
        if !faults.is_empty() {
            return Ok(refused(faults));
        }
        Ok(Validation {
            faults,
            warnings,
            estimate: Some(plan.cost),
        })
    }

    /// Queues a new job with the spec of this one.
    pub async fn rerun(&self, id: Uuid) -> Result<Job, ServiceError> {
        let Job {
            kind, name, labels, ..
        } = self.get(id).await?;
        let mut body = self.storage.spec(id).await?;
        if let (Value::Object(members), Some(name)) = (&mut body, name) {
            members.insert("name".to_owned(), name.into());
        }
        if let (Value::Object(members), false) = (&mut body, labels.is_empty()) {
            members.insert(
                "labels".to_owned(),
                labels
                    .into_iter()
                    .map(|(key, value)| (key, Value::from(value)))
                    .collect(),
            );
        }
        Ok(self.submit_rerun(kind, body, None, Some(id)).await?.job)
    }
}

/// Checks a request. The cells of a large campaign take a second, too long for the threads that answer requests.
pub(super) async fn planned(
    kind: JobKind,
    body: Value,
) -> anyhow::Result<Result<Plan, Vec<Fault>>> {
    tokio::task::spawn_blocking(move || experiment::plan(kind, &body))
        .await
        .context("planning panicked")
}

fn new_job(
    kind: JobKind,
    plan: Plan,
    rerun_of: Option<Uuid>,
    idempotency: Option<IdempotencyKey>,
) -> Result<NewJob, ServiceError> {
    let sources = source_refs(&plan);
    let priority = priority(kind, &plan);
    let mut spec = plan.spec;
    let (name, labels) = take_names(&mut spec);
    // What is filled in stands last, and in its place when the spec is asked for again: the order does not count.
    let spec_sha256 = sha256_hex(sorted(&spec).to_string().as_bytes());
    let spec = serde_json::to_string(&spec).map_err(anyhow::Error::from)?;
    Ok(NewJob {
        kind,
        name,
        labels,
        spec_sha256,
        spec,
        seed: plan.seed,
        priority,
        engine_version: ENGINE_VERSION,
        sources,
        rerun_of,
        idempotency,
    })
}

/// Nobody waits behind a campaign with a job that takes a moment, nor behind a long campaign with a short one.
fn priority(kind: JobKind, plan: &Plan) -> i64 {
    if kind == JobKind::Campaign {
        90 - (10.0 * plan.cost.cost_s.clamp(1.0, 1e8).log10()).round() as i64
    } else {
        100
    }
}

/// Takes what people call the job out of what it does: two jobs that differ in nothing else are duplicates.
fn take_names(spec: &mut Value) -> (Option<String>, BTreeMap<String, String>) {
    let Value::Object(members) = spec else {
        return (None, BTreeMap::new());
    };
    let name = members
        .shift_remove("name")
        .and_then(|name| name.as_str().map(str::to_owned))
        .filter(|name| !name.is_empty());
    let labels = members
        .shift_remove("labels")
        .and_then(|labels| serde_json::from_value(labels).ok())
        .unwrap_or_default();
    (name, labels)
}

/// Of the kind and the body, whatever the order of its members.
fn request_sha256(kind: JobKind, body: &Value) -> String {
    sha256_hex(format!("{} {}", kind.name(), sorted(body)).as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn the_order_of_members_does_not_make_another_request() {
        let one = json!({"a": 1, "b": {"c": [1, 2], "d": null}});
        let same = json!({"b": {"d": null, "c": [1, 2]}, "a": 1});
        let other = json!({"b": {"d": null, "c": [2, 1]}, "a": 1});
        assert_eq!(
            request_sha256(JobKind::Simulate, &one),
            request_sha256(JobKind::Simulate, &same)
        );
        assert_ne!(
            request_sha256(JobKind::Simulate, &one),
            request_sha256(JobKind::Simulate, &other)
        );
        assert_ne!(
            request_sha256(JobKind::Simulate, &one),
            request_sha256(JobKind::Associate, &one)
        );
    }

    #[test]
    fn names_are_not_part_of_what_a_job_does() {
        let mut spec = json!({"name": "a", "labels": {"k": "v"}, "seed": 1});
        let (name, labels) = take_names(&mut spec);
        assert_eq!((name.as_deref(), labels["k"].as_str()), (Some("a"), "v"));
        assert_eq!(spec, json!({"seed": 1}));
    }
}
