//! Which track follows which target when.
//!
//! # Method
//! 1. At each step at which it exists, a track's candidate is the nearest target within the gate; the lower index of two.
//! 2. The same candidate `confirm_steps` times in a row: the track follows it, from the first of these steps on.
//! 3. Another candidate or none `end_steps` times in a row: it followed up to the last step at which the candidate was its.
//!    Steps in between count as followed, whatever the distance.
//! 4. A track that is absent at a step has no candidate there. Steps at which nothing is due are no steps of which it could be absent.

use super::{Compat, SiapSettings};
use crate::evaluation::comparison::{ComparedStep, Comparison};

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
    let places = places_of_due(comparison);
    for (track, sightings) in sightings.iter().enumerate() {
        let first = pieces.len();
        let rule = Rule {
            settings,
            places: &places,
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

/// What makes a track follow a target.
struct Rule<'s> {
    settings: &'s SiapSettings,
    /// Of each step, how many steps at which something may be due come before the next one.
    places: &'s [usize],
}

impl Rule<'_> {
    /// At how many steps a track was absent that was there at two, and not between them.
    fn absences(&self, from: usize, to: usize) -> u32 {
        let between = self.places[to].saturating_sub(self.places[from] + 1);
        u32::try_from(between).unwrap_or(u32::MAX)
    }
}

fn places_of_due(comparison: &Comparison) -> Vec<usize> {
    let mut passed = 0;
    let place_of = |step: &ComparedStep| {
        passed += usize::from(!step.is_extra);
        passed
    };
    comparison.steps.iter().map(place_of).collect()
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
