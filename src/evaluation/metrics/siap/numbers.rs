//! The track numbers of each target: how many, how long, how often they change.
//!
//! # Method
//! As few pieces as cover the tracked times: at the first time not yet covered, of the pieces that hold it the one that
//! lasts longest; of equals the track before, then the lower index.

use super::Compat;
use super::following::{Following, Piece};
use crate::evaluation::comparison::Comparison;
use std::cmp::Reverse;
use std::collections::BTreeMap;

#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Numbers {
    /// Steps at which it exists, and at which a track follows it.
    pub steps: usize,
    pub tracked_steps: usize,
    pub life_s: f64,
    pub tracked_s: f64,
    pub changes: usize,
    pub longest_s: f64,
}

/// One entry a target of the comparison.
pub fn numbers(comparison: &Comparison, following: &Following, compat: Compat) -> Vec<Numbers> {
    let mut of_truth = vec![Vec::new(); comparison.truth_ids.len()];
    for piece in &following.pieces {
        of_truth[piece.truth as usize].push(*piece);
    }
    let mut numbers: Vec<Numbers> = of_truth
        .into_iter()
        .map(|pieces| of_pieces(comparison, pieces, compat))
        .collect();
    count_steps(comparison, following, &mut numbers);
    numbers
}

fn of_pieces(comparison: &Comparison, mut pieces: Vec<Piece>, compat: Compat) -> Numbers {
    let length_s =
        |from: usize, to: usize| comparison.steps[to].time_s - comparison.steps[from].time_s;
    let (mut of_track, mut longest_piece_s) = (BTreeMap::<u32, f64>::new(), 0.0f64);
    for piece in &pieces {
        let piece_s = length_s(piece.from, piece.to);
        *of_track.entry(piece.track).or_default() += piece_s;
        longest_piece_s = longest_piece_s.max(piece_s);
    }
    let longest_s = match compat {
        Compat::None => longest_piece_s,
        Compat::StoneSoup => of_track.into_values().fold(0.0, f64::max),
    };
    pieces.sort_by_key(|piece| (piece.from, Reverse(piece.to), piece.track));
    let mut changes = 0;
    for pair in fewest(&pieces).windows(2) {
        let is_change = compat == Compat::StoneSoup || pair[0].track != pair[1].track;
        changes += usize::from(is_change);
    }
    Numbers {
        longest_s,
        changes,
        tracked_s: union(&pieces).map(|(from, to)| length_s(from, to)).sum(),
        ..Numbers::default()
    }
}

/// The cover of the method; `pieces` are sorted by their beginnings.
fn fewest(pieces: &[Piece]) -> Vec<Piece> {
    let mut chosen: Vec<Piece> = Vec::new();
    let (mut next, mut uncovered) = (0, 0);
    // Of the pieces that have begun the one that lasts longest; once it is chosen, no other of them reaches further.
    let mut best: Option<Piece> = None;
    loop {
        let before = chosen.last().map(|piece| piece.track);
        let worth = |piece: &Piece| (piece.to, before == Some(piece.track), Reverse(piece.track));
        while let Some(piece) = pieces.get(next).filter(|piece| piece.from <= uncovered) {
            best = best
                .filter(|best| worth(best) >= worth(piece))
                .or(Some(*piece));
            next += 1;
        }
        match (best.filter(|piece| piece.to >= uncovered), pieces.get(next)) {
            (Some(piece), _) => {
                chosen.push(piece);
                uncovered = piece.to + 1;
            }
            (None, Some(piece)) => uncovered = piece.from,
            (None, None) => return chosen,
        }
    }
}

/// The stretches of steps that pieces cover, each as its first and last step; `pieces` are sorted by their beginnings.
fn union(pieces: &[Piece]) -> impl Iterator<Item = (usize, usize)> {
    let mut stretches: Vec<(usize, usize)> = Vec::new();
    for piece in pieces {
        match stretches.last_mut() {
            Some((_, to)) if piece.from <= *to => *to = piece.to.max(*to),
            _ => stretches.push((piece.from, piece.to)),
        }
    }
    stretches.into_iter()
}

fn count_steps(comparison: &Comparison, following: &Following, numbers: &mut [Numbers]) {
    let mut first_s: Vec<Option<f64>> = vec![None; numbers.len()];
    let mut last_tracked = vec![usize::MAX; numbers.len()];
    for (index, step) in comparison.steps.iter().enumerate() {
        for truth in &comparison.truths[step.truths.clone()] {
            let id = truth.id as usize;
            numbers[id].steps += 1;
            numbers[id].life_s = step.time_s - *first_s[id].get_or_insert(step.time_s);
        }
        for truth in following.truth_of[step.tracks.clone()].iter().flatten() {
            let id = *truth as usize;
            if last_tracked[id] != index {
                last_tracked[id] = index;
                numbers[id].tracked_steps += 1;
            }
        }
    }
}
