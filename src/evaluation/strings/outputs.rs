//! From tracks to output strings: what each track decided at each scan.
//!
//! The decision is the most probable candidate; ε competes with its own probability, ties go to the detection listed
//! first. A scan without candidates or without a track point is ε. Under `all_gated` every candidate of at least the
//! least weight is kept beside the decision, ε also where nothing else is. Under `nearest_detection` and `nearest_truth`
//! the symbol is the nearest detection or target instead.

use super::normal_form::StringSet;
use super::step::StringStep;
use super::{DecisionPolicy, Source};
use crate::evaluation::axis::Axis;
use crate::evaluation::credit::Credit;
use crate::evaluation::identities::Identities;
use crate::model::track::{Candidate, Track, TrackPoint, TrackSet, TrackStatus};

/// A track decided on a detection, or named one the scan does not have.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Consumed {
    pub track: u32,
    /// Index into the axis.
    pub scan: u32,
    pub detection: u32,
}

/// A track that claims several detections of one scan: their probabilities are more than one in all.
#[derive(Debug, Clone, PartialEq)]
pub struct Crowded {
    pub track: u32,
    pub scan: u32,
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
    /// Track points that belong to no scan.
    pub lost: usize,
}

const EXAMPLES: usize = 3;
/// Probabilities that are one in all may be a little more by rounding.
const ROUNDING: f64 = 1e-6;

pub fn read<'a>(
    tracks: &TrackSet,
    axis: &Axis,
    identities: &mut Identities<'a>,
    (source, credit): (Source<'_, 'a>, Credit),
    max_missed: u32,
    warnings: &mut Vec<String>,
) -> Outputs {
    let with_choices = matches!(source, Source::Candidates(DecisionPolicy::AllGated { .. }));
    let points: usize = tracks.tracks.iter().map(|track| track.points.len()).sum();
    let mut strings = StringSet::weighted(max_missed, with_choices);
    strings.reserve(points, tracks.tracks.len());
    let outputs = Outputs {
        strings,
        empty_tracks: Vec::new(),
        decisions: Vec::with_capacity(points),
        crowded: Vec::new(),
        unknown: Vec::new(),
        lost: 0,
    };
    let (at_scan, choices, lost_points) = (Vec::new(), Vec::new(), Vec::new());
    let mut reader = Reader {
        tracks,
        axis,
        identities,
        source,
        credit,
        outputs,
        at_scan,
        choices,
        lost_points,
        between: 0,
        never_confirmed: 0,
    };
    let mut points = Vec::new();
    for (index, track) in tracks.tracks.iter().enumerate() {
        reader.read_track(index as u32, track, &mut points);
    }
    reader.warn(warnings);
    reader.outputs
}

struct Reader<'r, 'a> {
    tracks: &'r TrackSet,
    axis: &'r Axis,
    identities: &'r mut Identities<'a>,
    source: Source<'r, 'a>,
    credit: Credit,
    outputs: Outputs,
    /// The candidates of the track at hand at the scan at hand, and the choices they leave it.
    at_scan: Vec<Candidate>,
    choices: Vec<StringStep>,
    /// The first points that belong to no scan, in words.
    lost_points: Vec<String>,
    /// Lost points that may be of several scans.
    between: usize,
    never_confirmed: usize,
}

impl Reader<'_, '_> {
    /// `points` is memory that goes from track to track.
    fn read_track(&mut self, index: u32, track: &Track, points: &mut Vec<(usize, usize)>) {
        if track
            .points
            .iter()
            .all(|point| point.status == Some(TrackStatus::Tentative))
        {
            self.never_confirmed += 1;
            self.outputs.strings.end_owner();
            return;
        }
        self.place_on_axis(track, points);
        for same_scan in points.chunk_by(|a, b| a.0 == b.0) {
            self.read_scan(index, track, same_scan);
        }
        self.outputs.strings.end_owner();
        if self.outputs.strings.of_owner(index as usize).is_empty() {
            self.outputs.empty_tracks.push(index);
        }
    }

    /// The track's points, by index, with the scans they belong to in order.
    fn place_on_axis(&mut self, track: &Track, points: &mut Vec<(usize, usize)>) {
        points.clear();
        let mut guess = 0;
        for (index, point) in track.points.iter().enumerate() {
            if !self.credit.counts(point) {
                continue;
            }
            match self
                .axis
                .scan_near(point, guess)
                .or_else(|| self.scan_named_by(point))
            {
                Some(scan) => {
                    points.push((scan, index));
                    guess = scan + 1;
                }
                // Of no detection it is ε, at whichever scan.
                None if self.is_between(point) && self.named_by(point).next().is_none() => {}
                None => {
                    self.outputs.lost += 1;
                    self.between += usize::from(self.is_between(point));
                    if self.lost_points.len() < EXAMPLES {
                        self.lost_points
                            .push(format!("track '{}' at {} s", track.track_id, point.time_s));
                    }
                }
            }
        }
        if !points.is_sorted_by_key(|&(scan, _)| scan) {
            points.sort_by_key(|&(scan, _)| scan);
        }
        if matches!(self.source, Source::NearestTruth(_)) {
            self.keep_nearest(track, points);
        }
    }

    /// Of the points of a scan the one nearest in time, of two as near the later one.
    fn keep_nearest(&self, track: &Track, points: &mut Vec<(usize, usize)>) {
        let far_s = |&(scan, point): &(usize, usize)| {
            (track.points[point].time_s - self.axis.scans()[scan].time_s).abs()
        };
        points.dedup_by(|next, kept| {
            let is_same = next.0 == kept.0;
            if is_same && far_s(next) <= far_s(kept) {
                *kept = *next;
            }
            is_same
        });
    }

    /// Whether several scans are at the time of a point that names no sensor.
    fn is_between(&self, point: &TrackPoint) -> bool {
        point.sensor.is_none() && self.axis.scans_at(point.time_s).len() > 1
    }

    /// The scan of a point that names no sensor, told by the detections that it names: the only scan at its time that has any.
    fn scan_named_by(&self, point: &TrackPoint) -> Option<usize> {
        if !self.is_between(point) {
            return None;
        }
        let has_any = |&scan: &usize| {
            let recorded = self.axis.recorded(scan);
            self.named_by(point)
                .any(|name| recorded.is_some_and(|scan| self.identities.is_in(scan, name)))
        };
        let mut found = self.axis.scans_at(point.time_s).filter(has_any);
        found.next().filter(|_| found.next().is_none())
    }

    fn named_by(&self, point: &TrackPoint) -> impl Iterator<Item = u32> {
        self.tracks
            .candidates_of(point)
            .iter()
            .filter_map(|candidate| candidate.detection)
    }

    /// The step of a track at one scan, from all its points there (more than one only in careless files).
    fn read_scan(&mut self, index: u32, track: &Track, points: &[(usize, usize)]) {
        let (scan, first) = points[0];
        self.choices.clear();
        let alone = if let [(_, point)] = points {
            self.only_candidate(&track.points[*point])
        } else {
            None
        };
        let decision = match alone {
            Some(one) => StringStep {
                symbol: one
                    .detection
                    .and_then(|name| self.identify(index, scan, name)),
                weight: one.probability,
            },
            None => self.decide_of_many(index, scan, track, points),
        };
        if let Some(detection) = decision.symbol {
            self.outputs.decisions.push(Consumed {
                track: index,
                scan: scan as u32,
                detection,
            });
        }
        let step = match self.source {
            Source::NearestTruth(nearest) => {
                let point = &track.points[first];
                let place_m = &point.estimate.position;
                StringStep {
                    symbol: nearest.symbol(self.axis, scan, point.time_s, place_m),
                    weight: 1.0,
                }
            }
            _ => decision,
        };
        self.outputs
            .strings
            .push_step(self.axis.scans()[scan].position, step, &self.choices);
    }

    /// What a track decides among the candidates of all its points at a scan.
    fn decide_of_many(
        &mut self,
        index: u32,
        scan: usize,
        track: &Track,
        points: &[(usize, usize)],
    ) -> StringStep {
        self.gather(
            index,
            scan,
            points.iter().map(|&(_, point)| &track.points[point]),
        );
        match self.source {
            Source::Candidates(DecisionPolicy::AllGated { min_weight }) => {
                allow(&self.at_scan, min_weight, &mut self.choices);
                decide(self.choices.iter().map(|step| Candidate {
                    detection: step.symbol,
                    probability: step.weight,
                }))
            }
            Source::Candidates(DecisionPolicy::MostProbable) | Source::NearestTruth(_) => {
                self.report_crowd(index, scan);
                decide(self.at_scan.iter().copied())
            }
            Source::NearestDetection(nearest) => {
                let symbol = points.first().and_then(|&(_, first)| {
                    nearest.nearest(scan, &track.points[first].estimate.position)
                });
                StringStep {
                    symbol,
                    weight: 1.0,
                }
            }
        }
    }

    /// The candidate of a point that has no other, where it is the decision as it stands: nearly every point of a tracker that
    /// decides hard, so it is not copied about.
    fn only_candidate(&self, point: &TrackPoint) -> Option<Candidate> {
        match (self.source, self.tracks.candidates_of(point)) {
            (Source::Candidates(DecisionPolicy::MostProbable) | Source::NearestTruth(_), [one])
                if !one.probability.is_nan() =>
            {
                Some(*one)
            }
            _ => None,
        }
    }

    /// Collects the candidates of points, with identities.
    fn gather<'p>(
        &mut self,
        track: u32,
        scan: usize,
        points: impl Iterator<Item = &'p TrackPoint>,
    ) {
        self.at_scan.clear();
        if matches!(self.source, Source::NearestDetection(_)) {
            return;
        }
        for point in points {
            for &Candidate {
                detection,
                probability,
            } in self.tracks.candidates_of(point)
            {
                let name = detection;
                let detection = name.and_then(|index| self.identify(track, scan, index));
                if name.is_some() == detection.is_some() {
                    self.at_scan.push(Candidate {
                        detection,
                        probability,
                    });
                }
            }
        }
    }

    /// `None` at a step that no recording has: nothing was detected there.
    fn identify(&mut self, track: u32, scan: usize, index: u32) -> Option<u32> {
        let detection = self.identities.resolve(self.axis.recorded(scan)?, index);
        if self.identities.is_unknown(detection) {
            self.outputs.unknown.push(Consumed {
                track,
                scan: scan as u32,
                detection,
            });
        }
        Some(detection)
    }

    fn report_crowd(&mut self, track: u32, scan: usize) {
        if self.at_scan.len() < 2 {
            return;
        }
        let mut detections: Vec<u32> = Vec::new();
        let mut total = 0.0;
        for candidate in &self.at_scan {
            if let Some(detection) = candidate
                .detection
                .filter(|it| candidate.probability > 0.0 && !detections.contains(it))
            {
                detections.push(detection);
                total += candidate.probability;
            }
        }
        if detections.len() > 1 && total > 1.0 + ROUNDING {
            self.outputs.crowded.push(Crowded {
                track,
                scan: scan as u32,
                detections,
            });
        }
    }

    fn warn(&self, warnings: &mut Vec<String>) {
        if self.outputs.lost > 0 {
            let examples = self.lost_points.join(", ");
            warnings.push(format!(
                "{} track point(s) belong to no {} and were left out, first: {examples}",
                self.outputs.lost,
                self.axis.place_name()
            ));
        }
        if self.between > 0 {
            warnings.push(format!(
                "{} of these points name no sensor at a time of several scans, and no detection that one of the scans alone has: a column \
                 'sensor_id' would tell",
                self.between
            ));
        }
        if self.never_confirmed > 0 {
            warnings.push(format!(
                "{} track(s) were never confirmed and are not output tracks",
                self.never_confirmed
            ));
        }
    }
}

/// The most probable candidate; ε when there is none.
fn decide(candidates: impl Iterator<Item = Candidate>) -> StringStep {
    let best = candidates.fold(None, Candidate::more_probable);
    best.map_or(StringStep::NOTHING, |best| StringStep {
        symbol: best.detection,
        weight: best.probability,
    })
}

/// Every candidate of at least the least weight; where there is none, ε with what is said of it or what is left for it.
fn allow(candidates: &[Candidate], min_weight: f64, choices: &mut Vec<StringStep>) {
    for candidate in candidates
        .iter()
        .filter(|candidate| candidate.probability >= min_weight)
    {
        match choices
            .iter_mut()
            .find(|choice| choice.symbol == candidate.detection)
        {
            Some(known) => known.weight = known.weight.max(candidate.probability),
            None => choices.push(StringStep {
                symbol: candidate.detection,
                weight: candidate.probability,
            }),
        }
    }
    if choices.is_empty() {
        let said = candidates
            .iter()
            .find(|candidate| candidate.detection.is_none())
            .map(|candidate| candidate.probability);
        let taken: f64 = candidates
            .iter()
            .map(|candidate| candidate.probability)
            .filter(|probability| !probability.is_nan())
            .sum();
        choices.push(StringStep {
            symbol: None,
            weight: said.unwrap_or((1.0 - taken).max(0.0)),
        });
    }
}

#[cfg(test)]
mod tests;
