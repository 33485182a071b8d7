//! The data of a job in one plane: what was measured from another origin is measured from the first one's.

use super::JobData;
use crate::geodesy::{Geodetic, Stereographic, turned};
use crate::model::fault::Fault;
use crate::model::scan::Recording;
use crate::model::space::{Frame, Place, Space};
use crate::model::track::TrackSet;
use crate::model::truth::TruthSet;

/// Puts truth, tracks and sets of tracks into the plane of the detections, else of the first of them.
///
/// # Errors
/// Some have an origin on the Earth and others do not: nobody knows where those are.
pub(super) fn unite(data: &mut JobData) -> Result<(), Vec<Fault>> {
    let frames = frames_of(data);
    let Some(frame) = frames.iter().find_map(|(_, frame)| *frame) else {
        return Ok(());
    };
    let mut faults = Vec::new();
    for (what, _) in frames.iter().filter(|(_, frame)| frame.is_none()) {
        let detail = format!(
            "the {what} have no origin on the Earth, but other data of this job have: `origin` says where they are measured from"
        );
        faults.push(Fault::new(format!("/{what}"), "conflict", detail));
    }
    if !faults.is_empty() {
        return Err(faults);
    }
    if let Some(truth) = data.truth.as_mut() {
        move_truth(truth, frame)?;
    }
    for tracks in data.tracks.iter_mut().chain(&mut data.sets) {
        move_tracks(tracks, frame);
    }
    Ok(())
}

/// What the job has that lies in a plane, with its origin.
fn frames_of(data: &JobData) -> Vec<(&'static str, Option<Frame>)> {
    let mut frames = Vec::new();
    let located = |recording: &&Recording| {
        recording.frame.is_some()
            || recording
                .detections()
                .any(|one| !one.measurement.is_direction())
    };
    frames.extend(
        data.recording
            .as_ref()
            .filter(located)
            .map(|recording| ("input", recording.frame)),
    );
    let truth = data
        .truth
        .as_ref()
        .filter(|truth| truth.space().has_places() && !truth.targets().is_empty());
    frames.extend(truth.map(|truth| ("truth", truth.frame)));
    let sets = data.tracks.iter().chain(&data.sets);
    let sets = sets.filter(|set| set.space.has_places() && !set.tracks.is_empty());
    frames.extend(sets.map(|set| ("tracks", set.frame)));
    frames
}

/// From one plane to another, or in a volume from the axes of one origin to those of another.
struct Move {
    from: Stereographic,
    to: Stereographic,
    space: Space,
    origins: [Geodetic; 2],
}

impl Move {
    /// `None` where the two are the same.
    fn between(from: Option<Frame>, to: Frame, space: Space) -> Option<Move> {
        let from = from.filter(|from| *from != to)?;
        Some(Move {
            from: Stereographic::from(from),
            to: Stereographic::from(to),
            space,
            origins: [Geodetic::from(&from), Geodetic::from(&to)],
        })
    }

    fn apply(&self, position: &mut Place, velocity: Option<&mut Place>) {
        if self.space == Space::Volume {
            let [from, to] = &self.origins;
            *position = to.enu_of(&from.at_enu(position));
            if let Some(velocity) = velocity {
                *velocity = from.turn_to(to) * *velocity;
            }
            return;
        }
        let (lat_deg, lon_deg) = self.from.unproject(&position.xy());
        let moved_m = self.to.project(lat_deg, lon_deg);
        (position.x, position.y) = (moved_m.x, moved_m.y);
        if let Some(velocity) = velocity {
            let turn_rad =
                self.to.turn_rad(lat_deg, lon_deg) - self.from.turn_rad(lat_deg, lon_deg);
            *velocity = turned(velocity, turn_rad);
        }
    }
}

/// Puts truth that has an origin into the plane of another.
///
/// # Errors
/// Places that are not finite there.
pub fn move_truth(truth: &mut TruthSet, frame: Frame) -> Result<(), Vec<Fault>> {
    let Some(way) = Move::between(truth.frame, frame, truth.space()) else {
        return Ok(());
    };
    let mut targets = truth.targets().to_vec();
    for point in targets.iter_mut().flat_map(|target| &mut target.points) {
        way.apply(&mut point.position, point.velocity.as_mut());
    }
    let moved = TruthSet::new(truth.space(), targets)?;
    let (time_base, attributes) = (truth.time_base, std::mem::take(&mut truth.attributes));
    *truth = moved;
    (truth.frame, truth.time_base, truth.attributes) = (Some(frame), time_base, attributes);
    Ok(())
}

/// Covariances stay as they are: between neighbouring origins the axes turn by less than they are known.
fn move_tracks(tracks: &mut TrackSet, frame: Frame) {
    let Some(way) = Move::between(tracks.frame, frame, tracks.space) else {
        return;
    };
    for point in tracks.tracks.iter_mut().flat_map(|track| &mut track.points) {
        way.apply(
            &mut point.estimate.position,
            point.estimate.velocity.as_mut(),
        );
    }
    tracks.frame = Some(frame);
}
