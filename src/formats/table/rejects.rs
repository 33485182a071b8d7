//! Rows that may be wrong: where a share of them is allowed, each wrong one is counted by its reason and left out.

use super::FaultLog;
use crate::formats::{Reading, Reason, Units};
use crate::model::fault::Fault;

/// The wrong rows of a table.
pub struct Rejects {
    max_share: f64,
    /// Only the rejected ones are counted here.
    units: Units,
    /// The first faults, of a table that has too many.
    first: FaultLog,
}

impl Rejects {
    /// `None` where no row may be wrong.
    pub fn allowed_by(reading: &Reading, row_word: &str) -> Option<Self> {
        let max_share = reading.max_rejected.filter(|share| *share > 0.0)?;
        Some(Rejects {
            max_share,
            units: Units::called(row_word),
            first: FaultLog::default(),
        })
    }

    pub fn count(&self) -> u64 {
        self.units.rejected_count()
    }

    /// Leaves out one row for all these faults, of which the first is its reason.
    pub fn add_row(&mut self, row: u64, faults: Vec<Fault>) {
        if let Some(fault) = faults.first() {
            self.units.reject(reason_of(&fault.code), row, 1);
        }
        for fault in faults {
            self.first.push(fault);
        }
    }

    /// Adds the rejected rows so far to the units of a table.
    pub fn add_to(&self, units: &mut Units) {
        units.total += self.count();
        units.rejected.clone_from(&self.units.rejected);
    }

    /// Adds the rejected rows to the units of a table.
    ///
    /// # Errors
    /// The first faults, where more rows are wrong than may be.
    pub fn settle(mut self, units: &mut Units) -> Result<(), Vec<Fault>> {
        units.total += self.count();
        if self.count() as f64 > self.max_share * units.total as f64 {
            let (count, total, called) = (self.count(), units.total, &units.called);
            let detail = format!("{count} of {total} {called}s are wrong");
            let allowed = format!(
                "max_rejected {}; `max_rejected` allows more",
                self.max_share
            );
            self.first
                .push(Fault::new("/file", "rejected", detail).allowing(allowed));
            return self.first.finish();
        }
        units.rejected = self.units.rejected;
        Ok(())
    }
}

fn reason_of(code: &str) -> Reason {
    match code {
        "not_finite" => Reason::NotFinite,
        "out_of_range" => Reason::OutOfRange,
        "missing" => Reason::Missing,
        _ => Reason::Malformed,
    }
}
