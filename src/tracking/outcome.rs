//! What a tracker says of its work: scan by scan, and of how well detections fitted.

use super::bits;
use serde::{Deserialize, Serialize};

/// What happened in one scan.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ScanOutcome {
    /// Tracks alive after the scan.
    pub tracks: u32,
    pub confirmed: u32,
    /// Detections that no track used.
    pub unused: u32,
    /// Tracks that such detections started: one each, or one a pair. Of the first scan, the given ones too.
    pub started: u32,
}

/// Normalised innovation squared of the updates of confirmed tracks, each detection counted by its weight. A filter whose
/// covariances are honest has a mean near the number of values of a measurement.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Nis {
    #[serde(with = "bits")]
    weighted_sum: f64,
    #[serde(with = "bits")]
    weight: f64,
    /// Updates with a detection.
    pub updates: u64,
}

impl Nis {
    /// One update by detections of this weight together, with their squared distances summed by weight.
    pub(super) fn add(&mut self, weighted_sum: f64, weight: f64) {
        self.weighted_sum += weighted_sum;
        self.weight += weight;
        self.updates += 1;
    }

    /// `None` before the first update.
    pub fn mean(&self) -> Option<f64> {
        (self.weight > 0.0).then(|| self.weighted_sum / self.weight)
    }
}
