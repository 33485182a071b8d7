//! What a list can be narrowed to.

use crate::model::dataset::DatasetKind;
use crate::service::types::{JobKind, JobState};
use jiff::Timestamp;

/// The order of a list by `created_at`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Sort {
    #[default]
    NewestFirst,
    OldestFirst,
}

/// Which jobs to list. Empty lists and absent values do not restrict.
#[derive(Debug, Clone, Default)]
pub struct JobFilter {
    pub states: Vec<JobState>,
    pub kinds: Vec<JobKind>,
    /// All must match.
    pub labels: Vec<(String, String)>,
    pub created_after: Option<Timestamp>,
    pub created_before: Option<Timestamp>,
    /// Part of the name or the start of the id.
    pub q: Option<String>,
    pub sort: Sort,
    /// 1 to 200; 0 stands for 50.
    pub limit: u32,
    pub cursor: Option<String>,
    /// Count every match.
    pub count: bool,
}

/// Which datasets to list.
#[derive(Debug, Clone, Default)]
pub struct DatasetFilter {
    pub kinds: Vec<DatasetKind>,
    /// Part of the name or the start of the id.
    pub q: Option<String>,
    pub sort: Sort,
    /// 1 to 200; 0 stands for 50.
    pub limit: u32,
    pub cursor: Option<String>,
    /// Count every match.
    pub count: bool,
}
