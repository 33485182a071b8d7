//! Trackers: what takes scans and tells tracks. One folder a tracker, one line of [`TRACKERS`].

mod bits;
pub mod group_tracks;
mod history;
mod outcome;
pub mod poisson_multi_bernoulli;
pub mod recorder;
pub mod single_hypothesis;
mod smoothing;

use crate::association::{Associator, Trace};
use crate::filtering::AnyFilter;
use crate::model::fault::Fault;
use crate::model::scan::Scan;
use crate::model::sensor::Sensor;
use crate::model::sight::clutter::ClutterMap;
use crate::model::track::TrackStatus;
use crate::model::watch::{Halt, Watch};
use crate::registry::Method;

pub use group_tracks::GroupTracks;
pub use history::{History, Merge};
pub use outcome::{Nis, ScanOutcome};
pub use recorder::Recorder;
pub use single_hypothesis::confirmation::{Confirmation, ScoreRule};
pub use single_hypothesis::existence::ExistenceRule;
pub use single_hypothesis::initiation::{Initiation, SPEED_REACH};
pub use single_hypothesis::lifecycle::{LIFECYCLE, Lifecycle};
pub use single_hypothesis::multi_scan::MultiScan;
pub use single_hypothesis::twins::Merging;
pub use single_hypothesis::undetected::{Births, Undetected};
pub use smoothing::Smoothing;

/// A multi-target tracker. Feed it scans in order of time.
pub trait Tracker: Send {
    /// Takes one scan and tells the recorder what becomes of the tracks.
    ///
    /// # Errors
    /// [`Halt::Late`] for a scan before the last one, which changes nothing. [`Halt::Stopped`] when the watch says so, and
    /// [`Halt::TooLarge`] when there are more candidates than a tracker may hold; then the tracker is of no use any more.
    fn step(
        &mut self,
        scan: &Scan,
        recorder: &mut dyn Recorder,
        watch: &Watch,
    ) -> Result<ScanOutcome, Halt>;

    /// The living tracks as they are believed to be at the last scan.
    fn tracks(&self) -> Vec<TrackEstimate> {
        self.tracks_at(None)
    }

    /// The same predicted to a time at or after the last scan; an earlier one, or none, is the last scan.
    fn tracks_at(&self, time_s: Option<f64>) -> Vec<TrackEstimate>;

    /// Begins a confirmed track by hand at the last scan, whose kinematics are packed as those of a [`TrackEstimate`], and gives its
    /// serial; `None` for another number of values. Its life is that of a track that was confirmed by itself.
    fn begin(&mut self, kinematics: &[f64], recorder: &mut dyn Recorder) -> Option<u32>;

    /// Ends tracks by hand, by serial; those that do not live are passed over.
    fn forget(&mut self, serials: &[u32], recorder: &mut dyn Recorder);

    /// Tells the recorder what is still open; no scan follows.
    fn finish(&mut self, _recorder: &mut dyn Recorder) {}

    /// The same tracker once more, to go another way from here.
    fn fork(&self) -> Box<dyn Tracker>;

    /// All that it knows, from which [`Tracker::read_back`] continues to the bit.
    fn write_down(&self) -> Vec<u8>;

    /// Takes the place of the tracker that wrote this down, whose parts were the same.
    ///
    /// # Errors
    /// Bytes that no tracker of this kind wrote.
    fn read_back(&mut self, written: &[u8]) -> Result<(), Box<Fault>>;

    /// How well the detections fitted so far.
    fn nis(&self) -> Nis;

    /// The map of clutter of each sensor that learns one.
    fn clutter_maps(&self) -> &[Option<ClutterMap>];

    /// What a user should know of how it went.
    fn warnings(&self) -> Vec<String>;

    /// What the associator says of all it did so far.
    fn diagnostics(&self) -> Option<serde_json::Value>;

    /// What the associator wrote down step by step.
    fn trace(&self) -> Option<&Trace>;

    /// From now on the problems of the confirmed tracks are kept, for [`Tracker::decide_again`].
    fn keep_problems(&mut self);

    /// Gives the kept problems to the associator once more, and does nothing with what it says: for those who time it.
    fn decide_again(&mut self, watch: &Watch);
}

/// What a tracker believes of one track.
#[derive(Debug, Clone, PartialEq)]
pub struct TrackEstimate {
    /// Number of the track in order of initiation, tentative ones counted too.
    pub serial: u32,
    pub time_s: f64,
    pub status: TrackStatus,
    /// Mean of the kinematics, then the upper triangle of its covariance row by row.
    pub kinematics: Vec<f64>,
}

/// What a tracker is made of.
pub struct TrackerParts {
    pub filter: AnyFilter,
    pub associator: Box<dyn Associator>,
    pub lifecycle: Lifecycle,
    /// Of a tracker whose tracks begin from undetected targets.
    pub undetected: Option<Undetected>,
    /// In the order of the recording's sensors.
    pub sensors: Vec<Sensor>,
    /// Tracks that are there from the start and never end.
    pub given: Vec<GivenTrack>,
}

/// A track that is there at the time of the first scan.
#[derive(Debug, Clone, PartialEq)]
pub struct GivenTrack {
    pub name: String,
    /// Its target, for an associator that is told where detections came from.
    pub origin: Option<u32>,
    /// Packed as those of a [`TrackEstimate`].
    pub kinematics: Vec<f64>,
}

/// Builds a tracker.
pub type BuildTracker = fn(TrackerParts) -> Box<dyn Tracker>;

/// Every tracker.
pub const TRACKERS: &[Method<BuildTracker>] =
    &[single_hypothesis::METHOD, poisson_multi_bernoulli::METHOD];
