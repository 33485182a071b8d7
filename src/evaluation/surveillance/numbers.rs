//! The life of track numbers on a target: more than one at a time, one after another, and the first of all.

use super::flights::{Update, View};
use super::pairing::Pairs;
use std::collections::BTreeMap;

/// From the first to the last update of a track number without a longer silence.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Life {
    pub track: u32,
    pub from_s: f64,
    pub to_s: f64,
    pub updates: u32,
}

/// The lives of the numbers of updates in the order of time; they end after so much silence. In the order of their begins.
pub fn lives<'u>(updates: impl IntoIterator<Item = &'u Update>, ends_after_s: f64) -> Vec<Life> {
    let mut lives: Vec<Life> = Vec::new();
    let mut latest: BTreeMap<u32, usize> = BTreeMap::new();
    for update in updates {
        let (track, time_s) = (update.track, update.time_s);
        match latest.get(&track).map(|&index| &mut lives[index]) {
            Some(life) if time_s - life.to_s <= ends_after_s => {
                life.to_s = time_s;
                life.updates += 1;
            }
            _ => {
                latest.insert(track, lives.len());
                lives.push(Life {
                    track,
                    from_s: time_s,
                    to_s: time_s,
                    updates: 1,
                });
            }
        }
    }
    lives
}

/// A new number takes a target over.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Handover {
    /// The last time of the number before, or the first of the new one, whatever is later.
    pub time_s: f64,
    pub from: u32,
    pub to: u32,
}

/// Each change of the number that carries a target: a number carries it until its life ends, whatever others there are.
pub fn handovers(lives: &[Life]) -> Vec<Handover> {
    let mut handovers = Vec::new();
    let mut carrier: Option<Life> = None;
    // In the order of their begins; those that end before the carrier does never carry.
    for life in lives {
        let Some(before) = carrier else {
            carrier = Some(*life);
            continue;
        };
        if life.to_s <= before.to_s {
            continue;
        }
        if life.track != before.track {
            handovers.push(Handover {
                time_s: life.from_s.max(before.to_s),
                from: before.track,
                to: life.track,
            });
        }
        carrier = Some(*life);
    }
    handovers
}

/// Whether the new number was on another target before, or the old one is on another afterwards: the two were swapped.
pub fn is_swap(handover: &Handover, target: usize, pairs: &Pairs) -> bool {
    let (target, time_s) = (target as u32, handover.time_s);
    let span = |track: u32| pairs.spans.get(track as usize).copied().flatten();
    let was_elsewhere = span(handover.to)
        .and_then(|span| span.first_elsewhere_s(target))
        .is_some_and(|first_s| first_s < time_s);
    let is_elsewhere = span(handover.from)
        .and_then(|span| span.last_elsewhere_s(target))
        .is_some_and(|last_s| last_s >= time_s);
    was_elsewhere || is_elsewhere
}

/// Of the updates of a flight, how many are of its most frequent number, and how many there are.
pub fn longest(view: &View) -> (u64, u64) {
    let mut counts: BTreeMap<u32, u64> = BTreeMap::new();
    for (update, _) in view.judged() {
        *counts.entry(update.track).or_default() += 1;
    }
    let most = counts.values().copied().max().unwrap_or(0);
    (most, counts.values().sum())
}
