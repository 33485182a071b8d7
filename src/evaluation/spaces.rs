//! The space in which truth and tracks are put beside each other: their own, or the plane where only one of them has a third
//! axis.

use crate::model::space::{Place, Space};
use crate::model::track::TrackSet;
use crate::model::truth::TruthSet;

/// A set without points is of any space. Directions beside places have no space in common, and nothing of them is compared.
pub fn common(truth: &TruthSet, tracks: &TrackSet) -> Space {
    let has_truth = truth
        .targets()
        .iter()
        .any(|target| !target.points.is_empty());
    match (truth.space(), tracks.space) {
        (Space::Volume, Space::Plane) if tracks.tracks.is_empty() => Space::Volume,
        (Space::Plane, Space::Volume) if !has_truth => Space::Volume,
        (of_truth, of_tracks) if of_truth == of_tracks => of_truth,
        _ => Space::Plane,
    }
}

/// What a user is told where heights are left out.
pub fn warning(truth: &TruthSet, tracks: &TrackSet) -> Option<String> {
    let (flat, high) = match (truth.space(), tracks.space) {
        (Space::Plane, Space::Volume) => ("the truth is", "the tracks are"),
        (Space::Volume, Space::Plane) => ("the tracks are", "the truth is"),
        _ => return None,
    };
    (common(truth, tracks) == Space::Plane).then(|| {
        format!(
            "{flat} of the plane and {high} of a volume (z_m): they are compared in the plane, without heights"
        )
    })
}

/// A place of a truth or a track as it is compared: a direction in degrees from 0 to 360.
pub fn compared(space: Space, place: &Place) -> Place {
    match space {
        Space::Bearing => Place::new(place.x.to_degrees().rem_euclid(360.0), 0.0, 0.0),
        Space::Plane | Space::Volume => space.cut(*place),
    }
}

/// How far apart two compared places are: of directions, in degrees, the shorter way round.
pub fn distance(space: Space, left: &Place, right: &Place) -> f64 {
    let distance = (left - right).norm();
    if space == Space::Bearing {
        distance.min(360.0 - distance)
    } else {
        distance
    }
}
