//! What a list can be narrowed to.

use crate::model::dataset::DatasetKind;
use crate::model::fault::Fault;
use crate::registry::control_character_fault;
use crate::service::types::{JobKind, JobState};
use jiff::Timestamp;

/// The order of a list by `created_at`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Sort {
    #[default]
    NewestFirst,
    OldestFirst,
}

/// Which part of a list, in which order.
#[derive(Debug, Clone, Default)]
pub struct Paging {
    pub sort: Sort,
    /// 1 to 200; 0 stands for 50.
    pub limit: u32,
    pub cursor: Option<String>,
    /// Count every match.
    pub count: bool,
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
    pub paging: Paging,
}

/// Which datasets to list.
#[derive(Debug, Clone, Default)]
pub struct DatasetFilter {
    pub kinds: Vec<DatasetKind>,
    /// Part of the name or the start of the id.
    pub q: Option<String>,
    pub paging: Paging,
}

/// Labels that a list can be narrowed to at once; each costs the database a look of its own.
const MAX_LABELS: usize = 16;
/// Longest text to search for; no name is longer.
const MAX_SEARCH: usize = 200;

impl JobFilter {
    /// What no list should be asked for, at the query parameter that says it.
    pub fn faults(&self) -> Vec<Fault> {
        let mut faults = Vec::new();
        faults.extend(repeated("state", &self.states));
        faults.extend(repeated("kind", &self.kinds));
        if self.labels.len() > MAX_LABELS {
            let fault = Fault::new(
                "/query/label",
                "too_large",
                format!("{} labels are named", self.labels.len()),
            );
            faults.push(fault.allowing(format!("at most {MAX_LABELS} labels")));
        }
        let texts = self.labels.iter().flat_map(|(key, value)| [key, value]);
        faults.extend(
            texts
                .filter_map(|text| control_character_fault(text, "/query/label"))
                .take(1),
        );
        faults.extend(search_fault(self.q.as_deref()));
        faults
    }
}

impl DatasetFilter {
    /// The same for datasets.
    pub fn faults(&self) -> Vec<Fault> {
        repeated("kind", &self.kinds)
            .into_iter()
            .chain(search_fault(self.q.as_deref()))
            .collect()
    }
}

fn repeated<T: PartialEq>(name: &str, entries: &[T]) -> Option<Fault> {
    let is_repeated = entries
        .iter()
        .enumerate()
        .any(|(index, entry)| entries[..index].contains(entry));
    is_repeated.then(|| {
        Fault::new(
            format!("/query/{name}"),
            "duplicate",
            "a value is named more than once",
        )
        .allowing("each value once")
    })
}

fn search_fault(q: Option<&str>) -> Option<Fault> {
    let q = q?;
    if q.chars().count() > MAX_SEARCH {
        return Some(
            Fault::new("/query/q", "too_large", "the text is too long")
                .allowing(format!("at most {MAX_SEARCH} characters")),
        );
    }
    control_character_fault(q, "/query/q")
}
