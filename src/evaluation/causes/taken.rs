//! What tracks took: the detection that each point was most probably given, and whose it is.

use super::Of;
use super::around::Around;
use crate::evaluation::EvaluationInput;
use crate::evaluation::comparison::Comparison;
use crate::evaluation::identities::Identities;
use crate::model::scan::Scan;
use crate::model::space::Place;
use crate::model::track::{TrackPoint, TrackSet};
use std::collections::HashMap;

/// What a point of a track took.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Took {
    /// The tracks do not say, or name a detection that is not in the recording.
    Unknown,
    Nothing,
    Detection(Of),
}

/// Reads what tracks took.
pub struct Reader<'a> {
    comparison: &'a Comparison,
    tracks: Option<&'a TrackSet>,
    /// Whether any track says that it was given a detection.
    are_given: bool,
    identities: Option<Identities<'a>>,
    /// The place of each scan's first detection in the recording, and of each scan in time.
    firsts: Vec<usize>,
    origins_known: bool,
    /// Of each target of the recording, the truth of that name.
    truths: Vec<Option<u32>>,
}

impl<'a> Reader<'a> {
    pub fn new(comparison: &'a Comparison, input: Option<&EvaluationInput<'a>>) -> Self {
        let recording = input.and_then(|input| input.recording);
        let tracks = input.map(|input| input.tracks);
        let by_name: HashMap<&str, u32> = comparison
            .truth_ids
            .iter()
            .map(String::as_str)
            .zip(0..)
            .collect();
        let of_name = |name: &String| by_name.get(name.as_str()).copied();
        let targets = recording.map_or(&[][..], |recording| &recording.targets);
        let firsts = recording
            .into_iter()
            .flat_map(|recording| recording.scans_with_firsts());
        Reader {
            comparison,
            tracks,
            are_given: tracks.is_some_and(|tracks| !tracks.detection_ids.is_empty()),
            identities: recording
                .zip(tracks)
                .map(|(recording, tracks)| Identities::new(Some(recording), &tracks.detection_ids)),
            firsts: firsts.map(|(first, _)| first).collect(),
            origins_known: recording.is_some_and(|recording| recording.origins_known),
            truths: targets.iter().map(of_name).collect(),
        }
    }

    /// The points of a track.
    pub fn points(&self, track: u32) -> &'a [TrackPoint] {
        let tracks = self.tracks.map_or(&[][..], |tracks| &tracks.tracks);
        tracks
            .get(track as usize)
            .map_or(&[], |track| &track.points)
    }

    /// When a track was last given a detection at or before a time.
    pub fn last_detection_s(&self, track: u32, time_s: f64) -> Option<f64> {
        if !self.are_given {
            return None;
        }
        let points = self.points(track);
        let behind = points.partition_point(|point| point.time_s <= time_s);
        let given = |point: &&TrackPoint| self.best(point).is_some_and(|best| best.is_some());
        let last = points[..behind].iter().rev().find(given)?;
        Some(last.time_s)
    }

    /// The most probable candidate; `None` where nothing is said.
    fn best(&self, point: &TrackPoint) -> Option<Option<u32>> {
        let best = self.tracks?.most_probable(point)?;
        Some(best.detection)
    }

    /// What a point took; `step` is the one that it belongs to.
    pub fn took(&mut self, point: &TrackPoint, step: usize, around: &Around) -> Took {
        let Some(best) = self.best(point) else {
            return Took::Unknown;
        };
        let Some(index) = best else {
            return Took::Nothing;
        };
        let scans = around.scans_of(step);
        let Some(identities) = &mut self.identities else {
            return Took::Unknown;
        };
        let first = around.first_scan_of(step);
        for (offset, scan) in scans.iter().enumerate() {
            let place = first + offset;
            if scan.time_s != point.time_s || !identities.is_in(place, index) {
                continue;
            }
            let identity = identities.resolve(place, index);
            if self.origins_known {
                let origin = identities.origin(identity);
                let truth = origin.and_then(|origin| self.truths[origin as usize]);
                return Took::Detection(match (origin, truth) {
                    (Some(_), None) => return Took::Unknown,
                    (_, Some(truth)) => Of::Target(truth),
                    (None, None) => Of::Nobody,
                });
            }
            let inside = identity as usize - self.firsts[place];
            return self.by_place(scan, inside, step, around);
        }
        Took::Unknown
    }

    /// Of the nearest target within the gate.
    fn by_place(&self, scan: &Scan, detection: usize, step: usize, around: &Around) -> Took {
        let Some(place_m) = around.place_of(scan, detection) else {
            return Took::Unknown;
        };
        let z_m = scan.detections[detection].measurement.z_m();
        let step = &self.comparison.steps[step];
        let space = self.comparison.space.unwrap_or_default();
        let mut nearest = (self.comparison.gate, Of::Nobody);
        for truth in &self.comparison.truths[step.truths.clone()] {
            let seen_m: Place = space.cut(place_m.push(z_m.unwrap_or(truth.position_m.z)));
            let distance_m = (seen_m - truth.position_m).norm();
            if distance_m <= nearest.0 {
                nearest = (distance_m, Of::Target(truth.id));
            }
        }
        Took::Detection(nearest.1)
    }
}
