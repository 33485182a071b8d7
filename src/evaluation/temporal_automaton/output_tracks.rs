//! What each output track follows: the target with most of its detections.
//!
//! A track is *false* when more than half of its detections are clutter, or when it has none. Else it follows the
//! target with most of its detections (ties to the smaller id). Of the followers of a target the one with the most of
//! its detections is *matched* (then fewest errors, earliest start, smaller id), the others are *redundant*.
//! The errors of a track are the scans at which it and the target, all its strings together, differ.

use crate::evaluation::strings::Strings;
use crate::evaluation::strings::normal_form::{StringSet, TrackString};
use crate::evaluation::strings::step::EPSILON;
use serde::Serialize;
use std::cmp::Reverse;

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum TrackClass {
    Matched,
    Redundant,
    False,
}

/// The target that an output string follows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Following {
    pub target: u32,
    /// Detections of the track that are the target's.
    pub hits: usize,
    pub errors: usize,
}

/// What became of the output strings.
pub struct Classes {
    /// For each output string; `None` is a false track.
    pub following: Vec<Option<Following>>,
    /// For each target the output string that is matched to it.
    pub matched: Vec<Option<usize>>,
}

impl Classes {
    pub fn class(&self, output: usize) -> TrackClass {
        match self.following[output] {
            None => TrackClass::False,
            Some(following) if self.matched[following.target as usize] == Some(output) => {
                TrackClass::Matched
            }
            Some(_) => TrackClass::Redundant,
        }
    }
}

pub fn classify(strings: &Strings, target_ranks: &[u32], track_ranks: &[u32]) -> Classes {
    let outputs = &strings.outputs.strings;
    let real_of_target: Vec<usize> = (0..strings.truth.owners())
        .map(|owner| {
            strings.truth.strings()[strings.truth.of_owner(owner)]
                .iter()
                .map(|s| s.real)
                .sum()
        })
        .collect();
    let (mut targets, mut following) = (Vec::new(), Vec::new());
    let mut best = vec![None; strings.target_ids.len()];
    for (index, string) in outputs.strings().iter().enumerate() {
        let Some((target, hits)) = most_hit(strings, target_ranks, string, &mut targets) else {
            following.push(None);
            continue;
        };
        let errors =
            real_of_target[target as usize] + string.real - agreement(strings, string, target);
        let merit = Reverse((
            Reverse(hits),
            errors,
            string.start,
            track_ranks[string.owner as usize],
            string.part,
        ));
        let slot = &mut best[target as usize];
        *slot = (*slot).max(Some((merit, index)));
        following.push(Some(Following {
            target,
            hits,
            errors,
        }));
    }
    Classes {
        following,
        matched: best
            .into_iter()
            .map(|best| best.map(|(_, index)| index))
            .collect(),
    }
}

/// The target with most detections of a string and how many; `None` for a false track.
fn most_hit(
    strings: &Strings,
    target_ranks: &[u32],
    string: &TrackString,
    targets: &mut Vec<u32>,
) -> Option<(u32, usize)> {
    let symbols = strings
        .outputs
        .strings
        .symbols_of(string)
        .iter()
        .filter(|&&symbol| symbol != EPSILON);
    targets.clear();
    targets.extend(symbols.filter_map(|&symbol| strings.target_of(symbol)));
    if 2 * (string.real - targets.len()) > string.real {
        return None;
    }
    // Most tracks follow one target all their life.
    if let Some(&target) = targets
        .first()
        .filter(|first| targets.iter().all(|target| target == *first))
    {
        return Some((target, targets.len()));
    }
    targets.sort_unstable();
    let counted = targets
        .chunk_by(|a, b| a == b)
        .map(|same| (same.len(), Reverse(target_ranks[same[0] as usize]), same[0]));
    counted.max().map(|(hits, _, target)| (target, hits))
}

/// Scans at which both have a real symbol, counted twice where it is the same: what they agree on is no error of
/// either, what they disagree on is one error and not two.
fn agreement(strings: &Strings, output: &TrackString, target: u32) -> usize {
    let truth = &strings.truth.strings()[strings.truth.of_owner(target as usize)];
    let from = truth.partition_point(|piece| piece.end() <= output.start);
    let overlapping = truth[from..]
        .iter()
        .take_while(|piece| piece.start < output.end());
    overlapping
        .map(|piece| agreement_with(&strings.outputs.strings, output, &strings.truth, piece))
        .sum()
}

fn agreement_with(
    outputs: &StringSet,
    output: &TrackString,
    truth: &StringSet,
    piece: &TrackString,
) -> usize {
    let from = output.start.max(piece.start);
    let taken = &outputs.symbols_of(output)[from - output.start..];
    let expected = &truth.symbols_of(piece)[from - piece.start..];
    let both = taken
        .iter()
        .zip(expected)
        .filter(|(taken, expected)| **taken != EPSILON && **expected != EPSILON);
    both.map(|(taken, expected)| 1 + usize::from(taken == expected))
        .sum()
}
