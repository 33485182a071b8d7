//! From tracks to output strings: what each track decided at each scan.
//!
//! The decision is the most probable candidate; ε competes with its own probability, ties go to the detection listed
//! first. A scan without candidates or without a track point is ε. Under `nearest_truth` the symbol is the nearest
//! target instead, but which detections the tracks consumed is read all the same.

use super::normal_form::{Step, StringSet};
use crate::evaluation::axis::Axis;
use crate::evaluation::identities::Identities;
use crate::evaluation::nearest_truth::NearestTruth;
use crate::model::track::{Candidate, Track, TrackPoint, TrackSet, TrackStatus};

/// A track decided on a detection, or named one the scan does not have.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Consumed {
    pub track: u32,
    /// Index into the axis.
    pub scan: usize,
    pub detection: u32,
}

/// A track that gave weight to several detections of one scan.
#[derive(Debug, Clone, PartialEq)]
pub struct Crowded {
    pub track: u32,
    pub scan: usize,
    pub detections: Vec<u32>,
}

/// Everything read from the tracks; owners of the strings are the tracks in their order.
#[derive(Debug)]
pub struct Outputs {
    pub strings: StringSet,
    /// Confirmed tracks that are ε throughout.
    pub empty_tracks: Vec<u32>,
    pub decisions: Vec<Consumed>,
    pub crowded: Vec<Crowded>,
    /// Identities that are not among the detections of their scan; empty without a recording.
    pub unknown: Vec<Consumed>,
}

const EXAMPLES: usize = 3;

pub fn read<'a>(
    tracks: &TrackSet,
    axis: &Axis,
    identities: &mut Identities<'a>,
    nearest: Option<&NearestTruth<'a>>,
    max_missed: u32,
    warnings: &mut Vec<String>,
) -> Outputs {
    let outputs = Outputs {
        strings: StringSet::new(max_missed),
        empty_tracks: Vec::new(),
        decisions: Vec::new(),
        crowded: Vec::new(),
        unknown: Vec::new(),
    };
    let mut reader = Reader { tracks, axis, identities, nearest, outputs, lost_points: Vec::new(), lost: 0, never_confirmed: 0 };
    for (index, track) in tracks.tracks.iter().enumerate() {
        reader.read_track(index as u32, track);
    }
    reader.warn(warnings);
    reader.outputs
}

struct Reader<'r, 'a> {
    tracks: &'r TrackSet,
    axis: &'r Axis,
    identities: &'r mut Identities<'a>,
    nearest: Option<&'r NearestTruth<'a>>,
    outputs: Outputs,
    /// The first points that belong to no scan, in words.
    lost_points: Vec<String>,
    lost: usize,
    never_confirmed: usize,
}

impl Reader<'_, '_> {
    fn read_track(&mut self, index: u32, track: &Track) {
        if !track.points.iter().any(|point| point.status != Some(TrackStatus::Tentative)) {
            self.never_confirmed += 1;
            self.outputs.strings.push_owner([]);
            return;
        }
        let mut points = self.on_axis(track);
        points.sort_by_key(|&(scan, _)| scan);
        let of_scan = points.chunk_by(|a, b| a.0 == b.0);
        let steps: Vec<(usize, Step)> =
            of_scan.map(|same| (self.axis.scans()[same[0].0].position, self.read_scan(index, same[0].0, same))).collect();
        self.outputs.strings.push_owner(steps);
        if self.outputs.strings.of_owner(index as usize).is_empty() {
            self.outputs.empty_tracks.push(index);
        }
    }

    /// The track's points with the scans they belong to.
    fn on_axis<'t>(&mut self, track: &'t Track) -> Vec<(usize, &'t TrackPoint)> {
        let mut points = Vec::with_capacity(track.points.len());
        for point in &track.points {
            match self.axis.scan_of(point) {
                Some(scan) => points.push((scan, point)),
                None => {
                    self.lost += 1;
                    if self.lost_points.len() < EXAMPLES {
                        self.lost_points.push(format!("track '{}' at {} s", track.track_id, point.time_s));
                    }
                }
            }
        }
        points
    }

    /// The step of a track at one scan, from all its points there (more than one only in careless files).
    fn read_scan(&mut self, track: u32, scan: usize, points: &[(usize, &TrackPoint)]) -> Step {
        let mut decision = None;
        let mut weighted: Vec<u32> = Vec::new();
        for &candidate in points.iter().flat_map(|(_, point)| self.tracks.candidates_of(point)) {
            let detection = candidate.detection.map(|index| self.identify(track, scan, index));
            let candidate = Candidate { detection, ..candidate };
            weighted.extend(detection.filter(|detection| candidate.probability > 0.0 && !weighted.contains(detection)));
            decision = more_probable(decision, candidate);
        }
        if weighted.len() > 1 {
            self.outputs.crowded.push(Crowded { track, scan, detections: weighted });
        }
        if let Some(detection) = decision.and_then(|decision| decision.detection) {
            self.outputs.decisions.push(Consumed { track, scan, detection });
        }
        match self.nearest {
            None => decision.map_or(Step::NOTHING, |decision| Step { symbol: decision.detection, weight: decision.probability }),
            Some(nearest) => {
                let plane = points[0].1.estimate.plane();
                Step { symbol: plane.and_then(|plane| nearest.symbol(scan, &plane.position_m())), weight: 1.0 }
            }
        }
    }

    fn identify(&mut self, track: u32, scan: usize, index: u32) -> u32 {
        let detection = self.identities.resolve(scan, index);
        if self.identities.is_unknown(detection) {
            self.outputs.unknown.push(Consumed { track, scan, detection });
        }
        detection
    }

    fn warn(&self, warnings: &mut Vec<String>) {
        if self.lost > 0 {
            let examples = self.lost_points.join(", ");
            warnings.push(format!("{} track point(s) belong to no scan and were left out, first: {examples}", self.lost));
        }
        if self.never_confirmed > 0 {
            warnings.push(format!("{} track(s) were never confirmed and are not output tracks", self.never_confirmed));
        }
    }
}

/// The better of two candidates, the earlier one first; a probability that is not a number never wins.
fn more_probable(best: Option<Candidate>, next: Candidate) -> Option<Candidate> {
    if next.probability.is_nan() {
        return best;
    }
    let Some(kept) = best else { return Some(next) };
    let tie_to_detection = next.probability == kept.probability && kept.detection.is_none() && next.detection.is_some();
    Some(if next.probability > kept.probability || tie_to_detection { next } else { kept })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn decide(candidates: &[(Option<u32>, f64)]) -> Option<Option<u32>> {
        let candidates = candidates.iter().map(|&(detection, probability)| Candidate { detection, probability });
        candidates.fold(None, more_probable).map(|decision| decision.detection)
    }

    #[test]
    fn the_most_probable_candidate_counts_and_ties_go_to_the_first_detection() {
        assert_eq!(decide(&[]), None);
        assert_eq!(decide(&[(None, 0.5), (Some(1), 0.3), (Some(2), 0.2)]), Some(None));
        assert_eq!(decide(&[(None, 0.2), (Some(1), 0.4), (Some(2), 0.4)]), Some(Some(1)));
        assert_eq!(decide(&[(None, 0.5), (Some(7), 0.5)]), Some(Some(7)));
        assert_eq!(decide(&[(Some(7), 0.5), (None, 0.5)]), Some(Some(7)));
        assert_eq!(decide(&[(Some(7), f64::NAN), (None, 0.1)]), Some(None));
    }
}
