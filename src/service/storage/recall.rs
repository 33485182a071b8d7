//! Rows of jobs that were read last, kept in memory until anything changes. Only where one process has the tables to itself:
//! there every change of a job goes through [`super::transaction::Change`], which is counted here when it has ended.

use super::StoredArtifact;
use super::jobs::StoredJob;
use std::collections::HashMap;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use uuid::Uuid;

/// Jobs whose rows are kept; then all are forgotten.
const MOST_JOBS: usize = 256;

/// Counts the changes that have ended, also those that were taken back.
#[derive(Debug, Clone, Default)]
pub(super) struct Changes(Arc<AtomicU64>);

impl Changes {
    /// Called after the database has the change, and before anybody is told of it.
    pub fn count(&self) {
        self.0.fetch_add(1, Ordering::SeqCst);
    }

    fn so_far(&self) -> u64 {
        self.0.load(Ordering::SeqCst)
    }
}

/// What was read of each job, as it is after so many changes.
#[derive(Debug, Default)]
pub(super) struct Recall {
    changes: Changes,
    read: Mutex<(u64, HashMap<Uuid, Rows>)>,
}

#[derive(Debug, Default)]
struct Rows {
    job: Option<StoredJob>,
    artifacts: Option<Vec<StoredArtifact>>,
}

impl Recall {
    pub fn new(changes: Changes) -> Self {
        Recall {
            changes,
            read: Mutex::default(),
        }
    }

    /// To be asked before rows are read that are then kept.
    pub fn now(&self) -> u64 {
        self.changes.so_far()
    }

    pub fn job(&self, id: Uuid) -> Option<StoredJob> {
        self.on_rows(self.now(), |rows| rows.get(&id)?.job.clone())
    }

    pub fn artifacts(&self, id: Uuid) -> Option<Vec<StoredArtifact>> {
        self.on_rows(self.now(), |rows| rows.get(&id)?.artifacts.clone())
    }

    /// `at` is what [`Self::now`] was before the row was read.
    pub fn keep_job(&self, at: u64, id: Uuid, job: &StoredJob) {
        self.on_rows(at, |rows| {
            rows.entry(id).or_default().job = Some(job.clone());
        });
    }

    pub fn keep_artifacts(&self, at: u64, id: Uuid, artifacts: &[StoredArtifact]) {
        self.on_rows(at, |rows| {
            rows.entry(id).or_default().artifacts = Some(artifacts.to_vec());
        });
    }

    /// Looks at the rows as they were read after `at` changes; older ones are forgotten, and to an older reader nothing is known.
    fn on_rows<T: Default>(&self, at: u64, look: impl FnOnce(&mut HashMap<Uuid, Rows>) -> T) -> T {
        let mut read = self.read.lock().unwrap_or_else(PoisonError::into_inner);
        if read.0 > at {
            return T::default();
        }
        if read.0 < at || read.1.len() > MOST_JOBS {
            *read = (at, HashMap::new());
        }
        look(&mut read.1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn artifact(name: &str) -> StoredArtifact {
        StoredArtifact {
            name: name.to_owned(),
            media_type: "text/csv".to_owned(),
            bytes: 1,
            sha256: String::new(),
            dataset_id: None,
        }
    }

    fn names(recall: &Recall, id: Uuid) -> Option<Vec<String>> {
        let artifacts = recall.artifacts(id)?;
        Some(
            artifacts
                .into_iter()
                .map(|artifact| artifact.name)
                .collect(),
        )
    }

    #[test]
    fn rows_are_known_until_something_changes_and_late_readers_bring_nothing_old() {
        let changes = Changes::default();
        let recall = Recall::new(changes.clone());
        let id = Uuid::from_u128(1);
        let early = recall.now();
        recall.keep_artifacts(early, id, &[artifact("a")]);
        assert_eq!(names(&recall, id), Some(vec!["a".to_owned()]));
        assert_eq!(names(&recall, Uuid::from_u128(2)), None);
        changes.count();
        assert_eq!(names(&recall, id), None);
        recall.keep_artifacts(early, id, &[artifact("a")]);
        assert_eq!(names(&recall, id), None, "it was read before the change");
        recall.keep_artifacts(recall.now(), id, &[artifact("b")]);
        assert_eq!(names(&recall, id), Some(vec!["b".to_owned()]));
    }

    #[test]
    fn memory_stays_bounded() {
        let recall = Recall::default();
        for id in 0..10_000 {
            recall.keep_artifacts(0, Uuid::from_u128(id), &[]);
        }
        assert!(recall.read.lock().unwrap().1.len() <= MOST_JOBS + 1);
    }
}
