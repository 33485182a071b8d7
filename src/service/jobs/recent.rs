//! The data of the jobs that were looked at last, kept in memory: the views of a job ask for them again and again, and they
//! never change.

use crate::service::error::ServiceError;
use crate::service::views::layers::JobLayers;
use std::future::Future;
use std::sync::{Arc, Mutex, PoisonError};
use tokio::sync::OnceCell;
use uuid::Uuid;

/// Jobs that are kept at most, and bytes of the files that their data were read from; the newest one is kept however large.
const MOST_JOBS: usize = 8;
const MOST_BYTES: u64 = 256 << 20;

/// Data once they are read; requests that come meanwhile wait for them instead of reading the files too.
type Slot = Arc<OnceCell<Arc<JobLayers>>>;

#[derive(Default)]
pub(super) struct Recent {
    /// The one that was asked for last stands at the end.
    entries: Mutex<Vec<Entry>>,
}

struct Entry {
    id: Uuid,
    /// Of the files.
    bytes: u64,
    slot: Slot,
}

impl Recent {
    /// The data of a job whose files have this many bytes: those in memory, else what `read` reads.
    pub(super) async fn get<F>(
        &self,
        id: Uuid,
        bytes: u64,
        read: impl FnOnce() -> F,
    ) -> Result<Arc<JobLayers>, ServiceError>
    where
        F: Future<Output = Result<JobLayers, ServiceError>>,
    {
        let slot = self.slot(id, bytes);
        slot.get_or_try_init(|| async { read().await.map(Arc::new) })
            .await
            .cloned()
    }

    /// The slot of the job, the newest from now on; older ones go where there is too much.
    fn slot(&self, id: Uuid, bytes: u64) -> Slot {
        let mut entries = self.entries.lock().unwrap_or_else(PoisonError::into_inner);
        let known = entries
            .iter()
            .position(|entry| entry.id == id)
            .map(|index| entries.remove(index));
        let entry = known.unwrap_or_else(|| Entry {
            id,
            bytes,
            slot: Slot::default(),
        });
        let slot = entry.slot.clone();
        entries.push(entry);
        while entries.len() > MOST_JOBS
            || entries.len() > 1
                && entries.iter().map(|entry| entry.bytes).sum::<u64>() > MOST_BYTES
        {
            entries.remove(0);
        }
        slot
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicUsize, Ordering};

    /// Asks for a job of so many bytes; counts the readings.
    async fn ask(recent: &Recent, id: u128, bytes: u64, readings: &AtomicUsize) {
        let read = || async {
            readings.fetch_add(1, Ordering::Relaxed);
            tokio::task::yield_now().await;
            Ok(JobLayers::default())
        };
        recent.get(Uuid::from_u128(id), bytes, read).await.unwrap();
    }

    fn kept(recent: &Recent) -> Vec<u128> {
        recent
            .entries
            .lock()
            .unwrap()
            .iter()
            .map(|entry| entry.id.as_u128())
            .collect()
    }

    #[tokio::test]
    async fn data_are_read_once_also_by_those_who_ask_at_the_same_time() {
        let (recent, readings) = (Recent::default(), AtomicUsize::new(0));
        tokio::join!(
            ask(&recent, 1, 5, &readings),
            ask(&recent, 1, 5, &readings),
            ask(&recent, 1, 5, &readings)
        );
        ask(&recent, 1, 5, &readings).await;
        assert_eq!(readings.load(Ordering::Relaxed), 1);
    }

    #[tokio::test]
    async fn what_was_asked_for_longest_ago_goes_first() {
        let (recent, readings) = (Recent::default(), AtomicUsize::new(0));
        for id in 0..8 {
            ask(&recent, id, 1, &readings).await;
        }
        ask(&recent, 0, 1, &readings).await;
        ask(&recent, 8, 1, &readings).await;
        assert_eq!(kept(&recent), [2, 3, 4, 5, 6, 7, 0, 8]);
        ask(&recent, 9, MOST_BYTES - 1, &readings).await;
        assert_eq!(kept(&recent), [8, 9]);
        ask(&recent, 10, MOST_BYTES * 2, &readings).await;
        assert_eq!(kept(&recent), [10], "one is kept however large");
        assert_eq!(readings.load(Ordering::Relaxed), 11);
    }

    #[tokio::test]
    async fn a_reading_that_failed_is_tried_again() {
        let (recent, readings) = (Recent::default(), AtomicUsize::new(0));
        let failed = recent
            .get(Uuid::nil(), 1, || async {
                Err(ServiceError::NotFound("file"))
            })
            .await;
        assert!(failed.is_err());
        ask(&recent, 0, 1, &readings).await;
        assert_eq!(readings.load(Ordering::Relaxed), 1);
    }
}
