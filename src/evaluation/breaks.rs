//! Why tracks break: at every [`EventKind::Break`], what became of the track that had followed the target, and whether the
//! sensors saw the target at all.
//!
//! A detection within the gate of the target's true place counts as seen, whoever made it; in a volume one without a height is at
//! that of the target.

use super::EvaluationInput;
use super::comparison::{ComparedStep, Comparison};
use super::events::{Event, EventKind, EventLog};
use crate::model::scan::Recording;
use crate::model::space::Place;
use crate::model::state::Position;
use crate::model::track::TrackSet;
use serde::{Deserialize, Serialize};

/// What became of the track that had followed a target.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum BreakCause {
    /// It was given up.
    Ended,
    /// It followed another target from then on.
    TookOtherTarget,
    /// It lived on outside the gate.
    LeftGate,
}

/// A target that was followed, and at this time is not.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema), schema(as = TrackBreak))]
pub struct Break {
    /// Where several sequences are judged: the one that it happened in.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub sequence: Option<String>,
    pub time_s: f64,
    pub truth_id: String,
    pub track_id: String,
    pub cause: BreakCause,
    /// The target that the track followed from then on.
    pub other_truth_id: Option<String>,
    // Null of directions, too.
    /// Scans up to this one, in a row, without a detection within the gate of the target; null without detections.
    pub unseen_scans: Option<u64>,
    /// When the track was last given a detection; null where tracks do not say.
    pub last_detection_time_s: Option<f64>,
}

/// Every break, in order of time, each explained when it is asked for.
pub fn explain<'a>(
    comparison: &'a Comparison,
    log: &'a EventLog,
    input: Option<&'a EvaluationInput<'a>>,
) -> impl Iterator<Item = Break> + use<'a> {
    let recording = input.and_then(|input| input.recording);
    let recording =
        recording.filter(|recording| comparison.is_in_metres() && recording.detection_count() > 0);
    let breaks = log
        .events
        .iter()
        .filter(|event| event.kind == EventKind::Break);
    breaks.filter_map(move |event| {
        let (truth, track) = (event.truth?, event.track?);
        let step = &comparison.steps[event.step as usize];
        let other = followed_by(&log.events[log.steps[event.step as usize].clone()], track);
        let cause = match (other, is_there(comparison, step, track)) {
            (Some(_), _) => BreakCause::TookOtherTarget,
            (None, true) => BreakCause::LeftGate,
            (None, false) => BreakCause::Ended,
        };
        Some(Break {
            sequence: None,
            time_s: step.time_s,
            truth_id: comparison.truth_ids[truth as usize].clone(),
            track_id: comparison.track_ids[track as usize].clone(),
            cause,
            other_truth_id: other.map(|truth| comparison.truth_ids[truth as usize].clone()),
            unseen_scans: recording.map(|recording| {
                unseen_scans(comparison, recording, event.step as usize, truth) as u64
            }),
            last_detection_time_s: input
                .and_then(|input| last_detection_s(input.tracks, track, step.time_s)),
        })
    })
}

fn followed_by(events: &[Event], track: u32) -> Option<u32> {
    events
        .iter()
        .find(|event| event.kind == EventKind::Match && event.track == Some(track))
        .and_then(|event| event.truth)
}

fn is_there(comparison: &Comparison, step: &ComparedStep, track: u32) -> bool {
    comparison.tracks[step.tracks.clone()]
        .binary_search_by_key(&track, |presence| presence.id)
        .is_ok()
}

/// Counts back from a step while no scan of that time has a detection near the target.
fn unseen_scans(comparison: &Comparison, recording: &Recording, step: usize, truth: u32) -> usize {
    let place = |step: &ComparedStep| {
        let truths = &comparison.truths[step.truths.clone()];
        truths
            .binary_search_by_key(&truth, |presence| presence.id)
            .ok()
            .map(|index| truths[index].position_m)
    };
    let steps = comparison.steps[..=step].iter().rev();
    let places = steps.map_while(|step| place(step).map(|position_m| (step.time_s, position_m)));
    places
        .take_while(|(time_s, position_m)| !is_seen(comparison, recording, *time_s, position_m))
        .count()
}

fn is_seen(
    comparison: &Comparison,
    recording: &Recording,
    time_s: f64,
    position_m: &Place,
) -> bool {
    let space = comparison.space.unwrap_or_default();
    let first = recording.scans.partition_point(|scan| scan.time_s < time_s);
    let scans = recording.scans[first..].iter();
    scans.take_while(|scan| scan.time_s == time_s).any(|scan| {
        let sensor = &recording.sensors[scan.sensor];
        let place_m = Position::new(
            sensor.x_m.unwrap_or_default(),
            sensor.y_m.unwrap_or_default(),
        );
        let place_m = scan.sensor_place_m(place_m);
        scan.detections.iter().any(|found| {
            let seen_m = found.measurement.position_seen_from(&place_m);
            let z_m = found.measurement.z_m();
            seen_m.is_some_and(|seen_m| {
                let seen_m = space.cut(seen_m.push(z_m.unwrap_or(position_m.z)));
                (seen_m - position_m).norm() <= comparison.gate
            })
        })
    })
}

/// The last point at or before `time_s` whose most probable candidate is a detection.
fn last_detection_s(tracks: &TrackSet, track: u32, time_s: f64) -> Option<f64> {
    let points = tracks.tracks[track as usize]
        .points
        .iter()
        .rev()
        .skip_while(|point| point.time_s > time_s);
    let mut detected = points.filter(|point| {
        let best = tracks
            .candidates_of(point)
            .iter()
            .max_by(|a, b| a.probability.total_cmp(&b.probability));
        best.is_some_and(|best| best.detection.is_some())
    });
    detected.next().map(|point| point.time_s)
}
