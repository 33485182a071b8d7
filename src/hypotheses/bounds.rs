//! How many candidates a tracker may hold: counted while they are found, so that what is too much is refused before memory is.

use crate::model::allowance::{
    MAX_CANDIDATES, MAX_CANDIDATES_OF_SCAN, MAX_TIMED_CANDIDATES, too_large,
};
use crate::model::scan::Scan;
use crate::model::watch::{Halt, Watch};

const REMEDY: &str = "a smaller gate_probability, fewer detections at one place, or an associator that gives a track one detection";

/// `timed` counts the candidates of the problems that are kept for timing.
pub fn check_timed(timed: usize, scan: &Scan) -> Result<(), Halt> {
    refuse_above(MAX_TIMED_CANDIDATES, timed, "candidates to be timed", scan)
}

/// `surplus` counts the candidates that a history holds beyond the first of each track and scan.
#[inline]
pub fn check_history(surplus: usize, scan: &Scan) -> Result<(), Halt> {
    if surplus <= MAX_CANDIDATES {
        return Ok(());
    }
    refuse_above(
        MAX_CANDIDATES,
        surplus,
        "candidates of tracks to be remembered",
        scan,
    )
}

/// Counts the candidates of all tracks in one scan.
#[inline]
pub fn check_scan(candidates: usize, scan: &Scan) -> Result<(), Halt> {
    if candidates <= MAX_CANDIDATES_OF_SCAN {
        return Ok(());
    }
    refuse_above(
        MAX_CANDIDATES_OF_SCAN,
        candidates,
        "candidates of tracks in one scan",
        scan,
    )
}

/// Whether the watch lets the work go on.
#[inline]
pub fn go_on(watch: &Watch) -> Result<(), Halt> {
    if watch.is_stopped() {
        Err(Halt::Stopped)
    } else {
        Ok(())
    }
}

#[cold]
fn refuse_above(most: usize, found: usize, what: &str, scan: &Scan) -> Result<(), Halt> {
    if found <= most {
        return Ok(());
    }
    let fault = too_large("/tracker/gate_probability", what, found, most, REMEDY);
    let detail = format!(
        "at scan {} ({} s) {}",
        scan.number, scan.time_s, fault.detail
    );
    Err(Halt::TooLarge(Box::new(crate::model::fault::Fault {
        detail,
        ..fault
    })))
}
