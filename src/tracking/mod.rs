//! The tracker: predict → gate → associate → update → manage, once a scan.

mod bounds;
mod confirmation;
mod group_tracks;
mod history;
mod initiation;
mod lifecycle;
mod likelihood_constants;
mod outcome;
mod scan_view;
mod tracker;

pub use confirmation::{Confirmation, ScoreRule};
pub use group_tracks::GroupTracks;
pub use history::History;
pub use initiation::Initiation;
pub use lifecycle::{LIFECYCLE, Lifecycle};
pub use outcome::{Nis, ScanOutcome};
pub use tracker::{Tracker, TrackerParts};
