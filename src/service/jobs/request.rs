//! What callers of the facade ask for, and what they get besides the wire types.

use crate::experiment::Cost;
use crate::model::fault::Fault;
use crate::service::types::Job;
use serde::Deserialize;
use std::collections::BTreeMap;

/// A job that was submitted.
#[derive(Debug, Clone)]
pub struct Submitted {
    pub job: Job,
    /// The idempotency key had been used for the same request before: this is the job of that time.
    pub replayed: bool,
}

/// What a check of a request found.
#[derive(Debug, Clone)]
pub struct Validation {
    pub faults: Vec<Fault>,
    pub warnings: Vec<String>,
    /// Absent when there are faults.
    pub estimate: Option<Cost>,
}

/// What to change of a job; absent members stay.
#[derive(Debug, Clone, Default, Deserialize)]
pub struct JobPatch {
    /// An empty name removes it.
    pub name: Option<String>,
    /// All labels from now on.
    pub labels: Option<BTreeMap<String, String>>,
    /// Whether it stays when old jobs make room.
    pub pinned: Option<bool>,
}
