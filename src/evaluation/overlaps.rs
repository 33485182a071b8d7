//! Boxes of truth and tracks side by side, frame by frame, with the pairs that overlap.
//!
//! # Method
//! The steps are the frames in which anything is, of truth or of tracks. A box of truth meets only the tracks whose left
//! edge lies between its own, less the greatest width, and its right edge; pairs that do not overlap are not listed.
//!
//! Tracks on distractors are forgiven as the benchmark has it: in each frame all boxes of truth, of whatever class, are matched to the
//! tracks with the greatest sum of overlaps of [`FORGIVING`] and more; a box of a track that a distractor gets is left out.
//!
//! # Reference
//! A. Milan, L. Leal-Taixé, I. Reid, S. Roth, K. Schindler, MOT16: A Benchmark for Multi-Object Tracking, 2016, section 4.1.

use super::comparison::{ComparedStep, Comparison, Pair, Presence};
use super::extent::Extent;
use super::matching::StepMatcher;
use crate::model::boxes::{BoxSet, ObjectBox};
use crate::model::space::Place;
use crate::model::watch::Watch;

/// Overlap from which a track is on a distractor.
const FORGIVING: f64 = 0.5;

impl Comparison {
    /// Compares boxes; they match from an intersection over union of `min_overlap` on. Times are frame numbers,
    /// positions the centres of boxes in pixels, and [`Presence::point`] counts the boxes of the set.
    pub fn of_boxes(truth: &BoxSet, tracks: &BoxSet, min_overlap: f64) -> Comparison {
        Comparison::of_boxes_within(
            truth,
            tracks,
            min_overlap,
            &mut Extent::unbounded(&Watch::never()),
        )
    }

    /// The same of what the extent allows; its [`Extent::finish`] says whether the comparison is whole.
    pub fn of_boxes_within(
        truth: &BoxSet,
        tracks: &BoxSet,
        min_overlap: f64,
        extent: &mut Extent,
    ) -> Comparison {
        let forgiven = forgiven(truth, tracks.boxes(), extent);
        if forgiven.is_empty() {
            return compare(truth, tracks, min_overlap, extent);
        }
        let kept = tracks.without(&forgiven);
        let mut comparison = compare(truth, &kept, min_overlap, extent);
        let is_kept = |index: &u32| forgiven.binary_search(index).is_err();
        let points = (0..tracks.boxes().len() as u32).filter(is_kept);
        for (presence, point) in comparison.tracks.iter_mut().zip(points) {
            presence.point = point;
        }
        comparison.warnings.push(format!(
            "{} boxes of tracks are on distractors: they are neither right nor false",
            forgiven.len()
        ));
        comparison
    }
}

fn compare(truth: &BoxSet, tracks: &BoxSet, min_overlap: f64, extent: &mut Extent) -> Comparison {
    extent.add_ids(truth.object_ids().len() + tracks.object_ids().len());
    let mut comparison = compare_boxes(truth.boxes(), tracks.boxes(), min_overlap, extent);
    comparison.truth_ids = truth.object_ids().to_vec();
    comparison.track_ids = tracks.object_ids().to_vec();
    comparison
}

/// Of boxes alone: the names of their objects are not known yet.
fn compare_boxes(
    truth: &[ObjectBox],
    tracks: &[ObjectBox],
    min_overlap: f64,
    extent: &mut Extent,
) -> Comparison {
    extent.add_points(truth.len() + tracks.len());
    let mut comparison = Comparison {
        space: None,
        gate: 1.0 - min_overlap,
        truth_ids: Vec::new(),
        track_ids: Vec::new(),
        steps: Vec::new(),
        truths: presences(truth),
        tracks: presences(tracks),
        pairs: Vec::with_capacity(truth.len() + tracks.len()),
        warnings: warnings(truth, tracks),
        ..Comparison::default()
    };
    let mut sweep = Sweep::default();
    let (mut truth_from, mut track_from) = (0, 0);
    while let Some(frame) = next_frame(&truth[truth_from..], &tracks[track_from..]) {
        let truths = truth_from..truth_from + in_frame(&truth[truth_from..], frame);
        let seen = track_from..track_from + in_frame(&tracks[track_from..], frame);
        let first_pair = comparison.pairs.len();
        sweep.restart(tracks, seen.clone());
        for index in truths.clone() {
            let looked_at = sweep.meet(truth, index as u32, tracks, &mut comparison.pairs);
            // One truth has no more pairs than there are tracks in the frame.
            if !extent.goes_on_with(comparison.pairs.len() - first_pair, 8 * looked_at) {
                return comparison;
            }
        }
        extent.end_step(comparison.pairs.len() - first_pair);
        comparison.pairs[first_pair..].sort_unstable_by_key(|pair| (pair.truth, pair.track));
        (truth_from, track_from) = (truths.end, seen.end);
        let pairs = first_pair..comparison.pairs.len();
        comparison.steps.push(ComparedStep {
            time_s: f64::from(frame),
            is_extra: false,
            truths,
            tracks: seen,
            pairs,
        });
    }
    comparison
}

/// The boxes of tracks that lie on distractors, by their indices, rising.
fn forgiven(truth: &BoxSet, tracks: &[ObjectBox], extent: &mut Extent) -> Vec<u32> {
    if !truth.others().iter().any(|other| other.forgives) {
        return Vec::new();
    }
    let asked = truth.boxes().iter().map(|one| (*one, false));
    let others = truth.others().iter();
    let mut all: Vec<(ObjectBox, bool)> = asked
        .chain(others.map(|other| (other.one, other.forgives)))
        .collect();
    all.sort_by_key(|(one, _)| one.frame);
    let boxes: Vec<ObjectBox> = all.iter().map(|(one, _)| *one).collect();
    let comparison = compare_boxes(&boxes, tracks, FORGIVING, extent);
    let mut matcher = StepMatcher::default();
    let mut found = Vec::new();
    for step in &comparison.steps {
        let matched = matcher.best(&comparison, step, |_, pair| {
            let counts = pair.similarity >= FORGIVING - f64::EPSILON;
            if counts { pair.similarity } else { 0.0 }
        });
        for &pair in matched {
            let pair = &comparison.pairs[pair as usize];
            if all[pair.truth as usize].1 {
                found.push(pair.track);
            }
        }
    }
    found.sort_unstable();
    found
}

fn presences(boxes: &[ObjectBox]) -> Vec<Presence> {
    let presence = |(point, one): (usize, &ObjectBox)| {
        let centre_px = Place::new(
            one.left_px + one.width_px / 2.0,
            one.top_px + one.height_px / 2.0,
            0.0,
        );
        Presence::new(one.object, centre_px, None, point as u32)
    };
    boxes.iter().enumerate().map(presence).collect()
}

fn next_frame(truths: &[ObjectBox], tracks: &[ObjectBox]) -> Option<u32> {
    [truths.first(), tracks.first()]
        .into_iter()
        .flatten()
        .map(|one| one.frame)
        .min()
}

fn in_frame(boxes: &[ObjectBox], frame: u32) -> usize {
    boxes.iter().take_while(|one| one.frame == frame).count()
}

/// The tracks of one frame by their left edges.
#[derive(Default)]
struct Sweep {
    by_left: Vec<(f64, u32)>,
    greatest_width_px: f64,
}

impl Sweep {
    fn restart(&mut self, tracks: &[ObjectBox], seen: std::ops::Range<usize>) {
        self.by_left.clear();
        self.by_left.extend(
            seen.clone()
                .map(|index| (tracks[index].left_px, index as u32)),
        );
        self.by_left.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        self.greatest_width_px = tracks[seen]
            .iter()
            .map(|one| one.width_px)
            .fold(0.0, f64::max);
    }

    /// Lists the pairs of one truth, and says how many tracks it looked at.
    fn meet(
        &self,
        truths: &[ObjectBox],
        index: u32,
        tracks: &[ObjectBox],
        pairs: &mut Vec<Pair>,
    ) -> usize {
        let mut looked_at = 0;
        let truth = &truths[index as usize];
        let from = self
            .by_left
            .partition_point(|&(left_px, _)| left_px < truth.left_px - self.greatest_width_px);
        let right_px = truth.left_px + truth.width_px;
        for &(_, track) in self.by_left[from..]
            .iter()
            .take_while(|&&(left_px, _)| left_px < right_px)
        {
            looked_at += 1;
            let similarity = truth.overlap(&tracks[track as usize]);
            if similarity > 0.0 {
                pairs.push(Pair {
                    truth: index,
                    track,
                    distance: 1.0 - similarity,
                    similarity,
                });
            }
        }
        looked_at
    }
}

fn warnings(truths: &[ObjectBox], tracks: &[ObjectBox]) -> Vec<String> {
    let (Some(first), Some(last)) = (truths.first(), truths.last()) else {
        return Vec::new();
    };
    let frames = first.frame..=last.frame;
    let outside = tracks
        .chunk_by(|one, next| one.frame == next.frame)
        .filter(|frame| !frames.contains(&frame[0].frame))
        .count();
    let warn = |outside: usize| {
        let (first, last) = (first.frame, last.frame);
        format!(
            "{outside} frames with tracks are outside the frames of truth, {first} to {last}: what is tracked there is false"
        )
    };
    (outside > 0).then(|| warn(outside)).into_iter().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Frame, object, left; 10 wide and high.
    fn set(boxes: &[(u32, u32, f64)]) -> BoxSet {
        let one = |&(frame, object, left_px): &(u32, u32, f64)| ObjectBox {
            frame,
            object,
            left_px,
            top_px: 0.0,
            width_px: 10.0,
            height_px: 10.0,
            confidence: 1.0,
        };
        BoxSet::new(
            (0..4).map(|id| id.to_string()).collect(),
            boxes.iter().map(one).collect(),
        )
        .unwrap()
    }

    #[test]
    fn frames_of_truth_and_tracks_are_joined_and_overlaps_listed() {
        // Frame 1: truth 0 at 0, 1 at 8; tracks 2 at 5, 3 at 30. Frame 2: a track alone. Frame 4: a truth alone.
        let comparison = Comparison::of_boxes(
            &set(&[(1, 0, 0.0), (1, 1, 8.0), (4, 0, 0.0)]),
            &set(&[(1, 2, 5.0), (1, 3, 30.0), (2, 3, 0.0)]),
            0.5,
        );
        let steps: Vec<_> = comparison
            .steps
            .iter()
            .map(|step| {
                (
                    step.time_s,
                    step.truths.clone(),
                    step.tracks.clone(),
                    step.pairs.clone(),
                )
            })
            .collect();
        assert_eq!(
            steps,
            [
                (1.0, 0..2, 0..2, 0..2),
                (2.0, 2..2, 2..3, 2..2),
                (4.0, 2..3, 3..3, 2..2)
            ]
        );
        // Shared 5 of 15 and 7 of 13 columns.
        let found: Vec<_> = comparison
            .pairs
            .iter()
            .map(|pair| (pair.truth, pair.track, pair.similarity))
            .collect();
        assert_eq!(found, [(0, 0, 50.0 / 150.0), (1, 0, 70.0 / 130.0)]);
        assert_eq!(
            (
                comparison.gate,
                comparison.pairs[1].distance,
                comparison.truths[1].position_m.x
            ),
            (0.5, 1.0 - 70.0 / 130.0, 13.0)
        );
        assert_eq!(
            comparison.similarity(comparison.pairs[1].distance),
            1.0 - (1.0 - 70.0 / 130.0)
        );
        assert!(comparison.warnings.is_empty());
    }

    #[test]
    fn tracks_outside_the_frames_of_truth_are_warned_of() {
        let comparison = Comparison::of_boxes(
            &set(&[(2, 0, 0.0)]),
            &set(&[(1, 0, 0.0), (3, 0, 0.0), (3, 1, 0.0)]),
            0.5,
        );
        assert_eq!(
            comparison.warnings,
            [
                "2 frames with tracks are outside the frames of truth, 2 to 2: what is tracked there is false"
            ]
        );
        assert!(
            Comparison::of_boxes(&set(&[]), &set(&[]), 0.5)
                .steps
                .is_empty()
        );
    }
}
