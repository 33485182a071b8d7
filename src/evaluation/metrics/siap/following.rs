//! Which track follows which target when.
//!
//! # Method
//! 1. At each step at which it exists, a track's candidate is the nearest target within the gate; the lower index of two.
//! 2. The same candidate `confirm_steps` times in a row: the track follows it, from the first of these steps on.
//! 3. Another candidate or none `end_steps` times in a row: it followed up to the last step at which the candidate was its.
//!    Steps in between count as followed, whatever the distance.
//! 4. A track that is absent has no candidate: once for each of its usual gaps that an absence leaves out. The usual gap, in steps,
//!    is the 75 % quantile of those of the track, or of all tracks where it has fewer than four; so a track that is there at
//!    every third step alone is not absent.

use super::{Compat, SiapSettings};
use crate::evaluation::comparison::Comparison;

/// An unbroken stretch of following, by the steps at its ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Piece {
    pub truth: u32,
    pub track: u32,
    pub from: usize,
    pub to: usize,
}

pub struct Following {
    /// Rising by track, then time.
    pub pieces: Vec<Piece>,
    /// Of each track presence of the comparison: the target that it follows, if that exists at the step.
    pub truth_of: Vec<Option<u32>>,
}

pub fn follow(comparison: &Comparison, settings: &SiapSettings) -> Following {
    let nearest = nearest_truths(comparison, settings.siap_compat);
    let mut pieces = Vec::new();
    let mut truth_of = vec![None; comparison.tracks.len()];
    let sightings = sightings(comparison);
    let usual_of_all = usual_gap(sightings.iter().map(Vec::as_slice));
    for (track, sightings) in sightings.iter().enumerate() {
        let first = pieces.len();
        let usual_gap = if sightings.len() > FEWEST_GAPS {
            usual_gap([sightings.as_slice()].into_iter())
        } else {
            usual_of_all
        };
        let rule = Rule {
            settings,
            usual_gap,
        };
        follow_one(track as u32, sightings, &nearest, &rule, &mut pieces);
        let mut of_track = pieces[first..].iter().peekable();
        for &(step, presence) in sightings {
            while of_track.next_if(|piece| piece.to < step).is_some() {}
            let piece = of_track.peek().filter(|piece| piece.from <= step);
            truth_of[presence] = piece
                .map(|piece| piece.truth)
                .filter(|&truth| exists(comparison, step, truth));
        }
    }
    Following { pieces, truth_of }
}

/// A track with fewer gaps does not show a usual one.
const FEWEST_GAPS: usize = 4;

/// What makes a track follow a target, and how often it is there.
struct Rule<'s> {
    settings: &'s SiapSettings,
    /// In steps.
    usual_gap: usize,
}

impl Rule<'_> {
    /// How often a track that was there at two steps, and not between them, was absent.
    fn absences(&self, from: usize, to: usize) -> u32 {
        let gaps = (to - from + self.usual_gap / 2) / self.usual_gap;
        u32::try_from(gaps.saturating_sub(1)).unwrap_or(u32::MAX)
    }
}

/// The smallest gap that at least 75 % of all do not exceed; 1 where there is none.
fn usual_gap<'s>(tracks: impl Iterator<Item = &'s [(usize, usize)]>) -> usize {
    let mut gaps: Vec<usize> = tracks
        .flat_map(|sightings| sightings.windows(2).map(|pair| pair[1].0 - pair[0].0))
        .collect();
    gaps.sort_unstable();
    gaps.get((3 * gaps.len()).div_ceil(4).saturating_sub(1))
        .copied()
        .unwrap_or(1)
}

/// For each track its steps, each with the index of its presence.
fn sightings(comparison: &Comparison) -> Vec<Vec<(usize, usize)>> {
    let mut lists = vec![Vec::new(); comparison.track_ids.len()];
    for (index, step) in comparison.steps.iter().enumerate() {
        for presence in step.tracks.clone() {
            lists[comparison.tracks[presence].id as usize].push((index, presence));
        }
    }
    lists
}

/// Method 1, for each track presence.
fn nearest_truths(comparison: &Comparison, compat: Compat) -> Vec<Option<u32>> {
    let mut nearest: Vec<Option<(f64, u32)>> = vec![None; comparison.tracks.len()];
    for pair in &comparison.pairs {
        let is_near = match compat {
            Compat::None => pair.distance <= comparison.gate,
            Compat::StoneSoup => pair.distance < comparison.gate,
        };
        let best = &mut nearest[pair.track as usize];
        if is_near && best.is_none_or(|(distance, _)| pair.distance < distance) {
            *best = Some((pair.distance, comparison.truths[pair.truth as usize].id));
        }
    }
    nearest
        .into_iter()
        .map(|best| best.map(|(_, truth)| truth))
        .collect()
}

/// Methods 2 to 4.
fn follow_one(
    track: u32,
    sightings: &[(usize, usize)],
    nearest: &[Option<u32>],
    rule: &Rule,
    pieces: &mut Vec<Piece>,
) {
    let settings = rule.settings;
    let mut current: Option<Piece> = None;
    let mut failures = 0u32;
    // A target, the first step at which it was the candidate, and how often in a row.
    let mut candidate: Option<(u32, usize, u32)> = None;
    let mut before = None;
    for &(step, presence) in sightings {
        let near = nearest[presence];
        let absences = before
            .replace(step)
            .map_or(0, |before| rule.absences(before, step));
        if absences > 0 {
            candidate = None;
            failures = failures.saturating_add(absences);
        }
        if failures >= settings.end_steps {
            pieces.extend(current.take());
        }
        if let Some(piece) = &mut current {
            if near == Some(piece.truth) {
                piece.to = step;
                (failures, candidate) = (0, None);
                continue;
            }
            failures += 1;
            if failures >= settings.end_steps {
                pieces.extend(current.take());
            }
        }
        candidate = near.map(|truth| match candidate {
            Some((same, from, count)) if same == truth => (truth, from, count + 1),
            _ => (truth, step, 1),
        });
        if let (None, Some((truth, from, count))) = (current, candidate)
            && count >= settings.confirm_steps
        {
            current = Some(Piece {
                truth,
                track,
                from,
                to: step,
            });
            failures = 0;
        }
    }
    pieces.extend(current);
}

fn exists(comparison: &Comparison, step: usize, truth: u32) -> bool {
    let truths = &comparison.truths[comparison.steps[step].truths.clone()];
    truths
        .binary_search_by_key(&truth, |presence| presence.id)
        .is_ok()
}
