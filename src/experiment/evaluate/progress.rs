//! Progress of the metrics of a job: told after each one, and asked about while one works.

use crate::experiment::job::RunError;
use crate::experiment::observer::{Observer, Step, report_progress};
use crate::model::watch::Watch;
use std::cell::RefCell;

/// How many of the metrics are done.
pub struct MetricProgress<'o> {
    observer: &'o mut dyn Observer,
    done: u64,
    total: u64,
}

impl<'o> MetricProgress<'o> {
    pub fn new(observer: &'o mut dyn Observer, total: u64) -> Self {
        MetricProgress {
            observer,
            done: 0,
            total,
        }
    }

    /// Tells that one more is done.
    ///
    /// # Errors
    /// [`RunError::Stopped`] when the observer says so.
    pub fn one_more(&mut self) -> Result<(), RunError> {
        self.done += 1;
        report_progress(self.observer, Step::Evaluate, self.done, self.total)?;
        Ok(())
    }

    /// Does work that asks on the way whether to go on.
    ///
    /// # Errors
    /// [`RunError::Stopped`] when the observer said so; the work's answer then is none.
    pub fn watching<T>(&mut self, work: impl FnOnce(&Watch) -> T) -> Result<T, RunError> {
        // Nothing done yet would tell that evaluation has not begun.
        let (done, total) = (self.done.max(1), self.total);
        let observer = RefCell::new(&mut *self.observer);
        let question = || observer.borrow_mut().progress(Step::Evaluate, done, total);
        let watch = Watch::new(&question);
        let answer = work(&watch);
        if watch.is_stopped() {
            Err(RunError::Stopped)
        } else {
            Ok(answer)
        }
    }
}
