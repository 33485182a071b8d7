//! Why a track lost its target.

use super::around::Around;
use super::taken::{Reader, Took};
use super::{Cause, Fate, Of};
use crate::evaluation::comparison::Comparison;
use crate::evaluation::events::{Event, EventKind, EventLog};

/// Farther back nobody looks for the detection that drew a track away.
const MOST_POINTS: usize = 100;

/// Why a track lost its target at a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Loss {
    pub cause: Cause,
    pub fate: Fate,
    pub track: u32,
    pub other_truth: Option<u32>,
    pub taken: u32,
    pub unseen_scans: Option<u32>,
    pub last_detection_time_s: Option<f64>,
}

/// Who lost whom, and what is known of the target.
#[derive(Debug, Clone, Copy)]
pub struct Lost {
    pub truth: u32,
    pub track: u32,
    pub step: usize,
    /// Steps up to this one, in a row, that did not see the target.
    pub unseen_scans: Option<u32>,
    pub is_covered: bool,
}

/// What a track took since it last took its target.
#[derive(Debug, Clone, Copy, Default)]
pub struct Takings {
    /// The last other target, and how many detections of other targets.
    pub other: Option<u32>,
    pub of_others: u32,
    pub of_nobody: u32,
    pub nothing: u32,
}

impl Takings {
    pub fn add(&mut self, took: Took) {
        match took {
            Took::Unknown => {}
            Took::Nothing => self.nothing += 1,
            Took::Detection(Of::Nobody) => self.of_nobody += 1,
            Took::Detection(Of::Target(other)) => {
                self.other.get_or_insert(other);
                self.of_others += 1;
            }
        }
    }
}

pub fn explain(
    comparison: &Comparison,
    log: &EventLog,
    around: &Around,
    reader: &mut Reader,
    lost: Lost,
) -> Loss {
    let step = &comparison.steps[lost.step];
    let events = &log.events[log.steps[lost.step].clone()];
    let followed = followed_by(events, lost.track);
    let is_there = comparison.tracks[step.tracks.clone()]
        .binary_search_by_key(&lost.track, |presence| presence.id)
        .is_ok();
    let fate = match (followed, is_there) {
        (Some(_), _) => Fate::TookOtherTarget,
        (None, true) => Fate::LeftGate,
        (None, false) => Fate::Ended,
    };
    let takings = takings_since(reader, around, &lost, step.time_s);
    let cause = if followed.or(takings.other).is_some() {
        Cause::TookTarget
    } else if takings.of_nobody > 0 {
        Cause::TookClutter
    } else if !lost.is_covered {
        Cause::OutsideCoverage
    } else if lost.unseen_scans.is_some_and(|scans| scans > 0) {
        Cause::NoDetection
    } else if is_there {
        Cause::LeftGate
    } else if goes_on(reader, lost.track, step.time_s) {
        Cause::Silent
    } else {
        Cause::Ended
    };
    Loss {
        cause,
        fate,
        track: lost.track,
        other_truth: followed.or(takings.other),
        taken: if cause == Cause::TookClutter {
            takings.of_nobody
        } else {
            takings.of_others
        },
        unseen_scans: lost.unseen_scans,
        last_detection_time_s: reader.last_detection_s(lost.track, step.time_s),
    }
}

fn followed_by(events: &[Event], track: u32) -> Option<u32> {
    events
        .iter()
        .find(|event| event.kind == EventKind::Match && event.track == Some(track))
        .and_then(|event| event.truth)
}

fn takings_since(reader: &mut Reader, around: &Around, lost: &Lost, time_s: f64) -> Takings {
    let points = reader.points(lost.track);
    let behind = points.partition_point(|point| point.time_s <= time_s);
    let mut takings = Takings::default();
    for point in points[..behind].iter().rev().take(MOST_POINTS) {
        let took = match around.step_at(point.time_s) {
            Some(step) => reader.took(point, step, around),
            None => Took::Unknown,
        };
        if took == Took::Detection(Of::Target(lost.truth)) {
            break;
        }
        takings.add(took);
    }
    takings
}

/// Whether a track has points after a time.
fn goes_on(reader: &Reader, track: u32, time_s: f64) -> bool {
    let points = reader.points(track);
    points.last().is_some_and(|point| point.time_s > time_s)
}
