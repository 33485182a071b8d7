//! Who takes down what a tracker does: a job keeps a whole history, a live feed the latest points.

use crate::model::scan::Scan;
use crate::model::track::{Candidate, TrackStatus};
use crate::model::watch::Halt;

/// Takes down what becomes of tracks. A track has points from its start to its end; each names its track by serial.
pub trait Recorder {
    /// A track that was there before the first scan, by its name.
    fn given(&mut self, serial: u32, name: &str);

    /// A track at one scan, which may be an earlier one.
    fn point(&mut self, point: &RecordedPoint);

    /// Whether there is room for more; asked on the way through a scan.
    ///
    /// # Errors
    /// [`Halt::TooLarge`].
    fn check(&self, _scan: &Scan) -> Result<(), Halt> {
        Ok(())
    }

    /// A track has no more points.
    fn end(&mut self, serial: u32);

    /// A track ends after this time, for `into` follows the same target.
    fn merged(&mut self, _serial: u32, _into: u32, _time_s: f64) {}
}

/// A track at one scan.
#[derive(Debug, Clone, Copy)]
pub struct RecordedPoint<'a> {
    /// Number of the track in order of initiation, tentative ones counted too.
    pub serial: u32,
    /// How many scans the tracker had taken before this one.
    pub scan_index: u32,
    pub time_s: f64,
    /// When the tracker knew of it: later than its time where a track begins in the past.
    pub known_at_s: f64,
    /// Index of its sensor.
    pub sensor: usize,
    pub status: TrackStatus,
    /// r: the probability that there is a target, where the life cycle keeps one.
    pub existence: Option<f64>,
    /// Mean of the kinematics, then the upper triangle of its covariance row by row.
    pub kinematics: &'a [f64],
    /// All that the filter believes ([`Filter::pack`](crate::filtering::Filter::pack)), where tracks are smoothed afterwards; else empty.
    pub belief: &'a [f64],
    /// Normalised innovation squared, where a detection updated the track.
    pub nis: Option<f64>,
    /// How probable each model of motion is, where the filter has several.
    pub modes: &'a [f64],
    /// What may have continued the track; each names its detection by its index in the scan.
    pub candidates: &'a [Candidate],
}
