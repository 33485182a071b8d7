//! The faults of one file, in the order of its lines and never too many.

use crate::formats::MAX_FAULTS;
use crate::model::fault::Fault;

/// Collects faults until there are [`MAX_FAULTS`]; then readers stop.
#[derive(Default)]
pub struct FaultLog {
    faults: Vec<Fault>,
    overflowed: bool,
}

impl FaultLog {
    pub fn push(&mut self, fault: Fault) {
        if self.is_full() {
            self.overflowed = true;
        } else {
            self.faults.push(fault);
        }
    }

    pub fn is_full(&self) -> bool {
        self.faults.len() >= MAX_FAULTS
    }

    pub fn is_empty(&self) -> bool {
        self.faults.is_empty()
    }

    /// The faults so far, after which it is empty; none while it is full.
    pub fn take(&mut self) -> Vec<Fault> {
        if self.is_full() {
            return Vec::new();
        }
        std::mem::take(&mut self.faults)
    }

    /// # Errors
    /// The faults in the order of their lines, if there are any; where the log was full, a last one says so.
    pub fn finish(mut self) -> Result<(), Vec<Fault>> {
        if self.faults.is_empty() {
            return Ok(());
        }
        self.faults.sort_by_key(|fault| fault.line);
        if self.is_full() {
            let more = if self.overflowed {
                "there are more"
            } else {
                "there may be more"
            };
            self.faults.push(Fault::new(
                "/file",
                "too_large",
                format!("reading stopped after {MAX_FAULTS} faults; {more}"),
            ));
        }
        Err(self.faults)
    }
}
