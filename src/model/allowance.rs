//! How much the tables may hold that are a product of their inputs: detections by tracks, truths by tracks. Each bound is a
//! number of entries, chosen so that a job at all of them at once needs some gigabytes; what is beyond is refused with the
//! number, the bound and what helps, before it is held. They are fixed, so that a job fits everywhere or nowhere.

use super::fault::Fault;

/// Candidates of all tracks in one scan, about 150 bytes each while they are decided, up to 500 by six motion models.
pub const MAX_CANDIDATES_OF_SCAN: usize = 4_000_000;

/// Candidates that a tracker remembers of all its scans, beyond the first of each track and scan: 16 bytes each, and a row of
/// `tracks.csv` of some hundred.
pub const MAX_CANDIDATES: usize = 4_000_000;

/// Candidates of all scans that are kept to time the associator, 24 bytes each.
pub const MAX_TIMED_CANDIDATES: usize = 20_000_000;

/// Pairs of a truth and a track within reach of each other in one step, about 160 bytes each while they are matched.
pub const MAX_PAIRS_OF_STEP: usize = 4_000_000;

/// The same of all steps and sequences of a job, about 100 bytes each.
pub const MAX_PAIRS: usize = 20_000_000;

/// Points of truth and of tracks at the steps of all sequences of a job, about 200 bytes each with their events.
pub const MAX_POINTS: usize = 10_000_000;

/// Targets and tracks of all sequences of a job, a kilobyte each with what the metrics say of it.
pub const MAX_IDS: usize = 1_000_000;

/// The fault of a table that would hold more than `most`; `found` may be where counting stopped.
pub fn too_large(
    pointer: impl Into<String>,
    what: &str,
    found: usize,
    most: usize,
    remedy: &str,
) -> Fault {
    Fault::new(
        pointer,
        "too_large",
        format!("there are {found} {what} or more"),
    )
    .allowing(format!("at most {most}; {remedy}"))
}
