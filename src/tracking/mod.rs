//! The tracker: predict → gate → associate → update → manage, once a scan.

mod history;
mod lifecycle;
mod tracker;

pub use history::History;
pub use lifecycle::{LIFECYCLE, Lifecycle};
pub use tracker::{Nis, ScanOutcome, Tracker, TrackerParts};
