//! How high points are: the third coordinate of a volume.

use super::Reduced;
use crate::model::space::Space;
use crate::model::track::{TrackPoint, TrackSet};
use crate::model::truth::{TruthPoint, TruthSet};

/// Height of a point of truth (m).
pub fn of_truth(truth: &TruthSet, point: &TruthPoint) -> Option<f64> {
    (truth.space() == Space::Volume).then_some(point.position.z)
}

/// Height of a point of a track (m).
pub fn of_track(set: &TrackSet, point: &TrackPoint) -> Option<f64> {
    (set.space == Space::Volume).then_some(point.estimate.position.z)
}

/// The column of the rows that were kept, where any of them has a height.
pub fn column(kept: &Reduced, of: impl Fn(usize) -> Option<f64>) -> Option<Vec<Option<f64>>> {
    let heights: Vec<Option<f64>> = kept.column(of);
    heights.iter().any(Option::is_some).then_some(heights)
}
