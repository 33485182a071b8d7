//! The log of events: who follows whom at each step, and what changed. One log a comparison; metrics count its events, and
//! every count can be followed to them.
//!
//! # Reference
//! K. Bernardin, R. Stiefelhagen, Evaluating Multiple Object Tracking Performance: The CLEAR MOT Metrics, EURASIP Journal on
//! Image and Video Processing, 2008; the matching rule is TrackEval's.
//!
//! # Method
//! At each step one assignment of truths to tracks within the gate: it keeps as many pairs of the step before as possible,
//! and among those assignments it has the largest sum of similarities. A step at which nothing or nobody is tracked is
//! skipped by the memory of who followed whom.
//! 1. A matched truth is a [`EventKind::Match`]. With another track than the last that ever followed it, also a
//!    [`EventKind::Switch`]; after missing steps, by whichever track, also a [`EventKind::Reacquisition`].
//! 2. An unmatched truth is a [`EventKind::Miss`]; when it was matched at its step before, also a [`EventKind::Break`] of
//!    the track that followed it. Steps at which a truth does not exist are neither.
//! 3. An unmatched track is exactly one of: [`EventKind::Redundant`] (a truth within its gate; it is matched to another),
//!    [`EventKind::Divergence`] (the truth that it last followed exists, outside the gate), [`EventKind::FalseAlarm`].
//!
//! So each reacquisition ends the interruption that a break began.

#[cfg(test)]
mod tests;

use super::comparison::{ComparedStep, Comparison, Pair};
use super::matching::StepMatcher;
use crate::model::watch::Watch;
use serde::Serialize;
use std::ops::Range;

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum EventKind {
    Match,
    Miss,
    FalseAlarm,
    Switch,
    Break,
    Reacquisition,
    Redundant,
    Divergence,
}

impl EventKind {
    /// Every kind, in the order of the report.
    pub const ALL: [(EventKind, &'static str); 8] = [
        (EventKind::Match, "match"),
        (EventKind::Miss, "miss"),
        (EventKind::FalseAlarm, "false_alarm"),
        (EventKind::Switch, "switch"),
        (EventKind::Break, "break"),
        (EventKind::Reacquisition, "reacquisition"),
        (EventKind::Redundant, "redundant"),
        (EventKind::Divergence, "divergence"),
    ];

    pub fn name(self) -> &'static str {
        Self::ALL[self as usize].1
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Event {
    /// Index of the step.
    pub step: u32,
    pub kind: EventKind,
    /// Indices into the ids of the comparison.
    pub truth: Option<u32>,
    pub track: Option<u32>,
    /// Distance of the pair, in the unit of the comparison; `None` where there is none or it is out of reach.
    pub distance: Option<f64>,
}

/// The events of a comparison in order of steps.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct EventLog {
    pub events: Vec<Event>,
    /// Where the events of each step stand.
    pub steps: Vec<Range<usize>>,
}

impl EventLog {
    pub fn new(comparison: &Comparison) -> EventLog {
        EventLog::new_until(comparison, &Watch::never())
    }

    /// The same, unless the watch says to stop; then it is not whole.
    pub fn new_until(comparison: &Comparison, watch: &Watch) -> EventLog {
        let events = Vec::with_capacity(comparison.truths.len() + comparison.tracks.len());
        let mut log = EventLog {
            events,
            steps: Vec::with_capacity(comparison.steps.len()),
        };
        let mut matcher = StepMatcher::until(watch);
        let mut memory = Memory::new(comparison);
        for (index, step) in comparison.steps.iter().enumerate() {
            let first = log.events.len();
            memory.meet(step, &mut matcher);
            memory.tell_truths(index as u32, step, &mut log.events);
            memory.tell_tracks(index as u32, step, &mut log.events);
            log.steps.push(first..log.events.len());
            if watch
                .stops_after(8 * (step.truths.len() + step.tracks.len() + step.pairs.len()) as u64)
            {
                break;
            }
        }
        log
    }

    pub fn count(&self, kind: EventKind) -> usize {
        self.events
            .iter()
            .filter(|event| event.kind == kind)
            .count()
    }
}

/// Worth of keeping a pair, against similarities of at most 1.
const KEEP: f64 = 1000.0;
const NONE: u32 = u32::MAX;

/// What is remembered of a truth.
#[derive(Debug, Clone, Copy)]
struct Past {
    /// The last track that ever followed it, and in which round (see [`Memory::round`]).
    track: u32,
    round: u32,
    /// Whether it was matched when it last existed.
    was_matched: bool,
}

struct Memory<'a> {
    comparison: &'a Comparison,
    /// Counts the steps that had both truths and tracks.
    round: u32,
    pasts: Vec<Past>,
    /// For each track: the truth that it last followed.
    followed: Vec<u32>,
    /// For each truth and each track of the step: the pair that it is matched by.
    pair_of_truth: Vec<u32>,
    pair_of_track: Vec<u32>,
    /// For each track of the step: the pair with the nearest truth within the gate, and with the truth it last followed.
    nearest: Vec<u32>,
    old: Vec<u32>,
}

impl<'a> Memory<'a> {
    fn new(comparison: &'a Comparison) -> Self {
        Memory {
            comparison,
            round: 0,
            pasts: vec![
                Past {
                    track: NONE,
                    round: 0,
                    was_matched: false
                };
                comparison.truth_ids.len()
            ],
            followed: vec![NONE; comparison.track_ids.len()],
            pair_of_truth: Vec::new(),
            pair_of_track: Vec::new(),
            nearest: Vec::new(),
            old: Vec::new(),
        }
    }

    /// Matches the truths and tracks of a step.
    fn meet(&mut self, step: &ComparedStep, matcher: &mut StepMatcher) {
        let comparison = self.comparison;
        restart(&mut self.pair_of_truth, step.truths.len());
        restart(&mut self.pair_of_track, step.tracks.len());
        if step.truths.is_empty() || step.tracks.is_empty() {
            return;
        }
        self.round += 1;
        let worth = |_: usize, pair: &Pair| {
            if pair.distance > comparison.gate {
                return 0.0;
            }
            let past = &self.pasts[comparison.truths[pair.truth as usize].id as usize];
            let is_kept = past.round + 1 == self.round
                && past.track == comparison.tracks[pair.track as usize].id;
            pair.similarity + if is_kept { KEEP } else { 0.0 }
        };
        for &index in matcher.best(comparison, step, worth) {
            let pair = &comparison.pairs[index as usize];
            self.pair_of_truth[pair.truth as usize - step.truths.start] = index;
            self.pair_of_track[pair.track as usize - step.tracks.start] = index;
        }
    }

    fn tell_truths(&mut self, index: u32, step: &ComparedStep, events: &mut Vec<Event>) {
        let comparison = self.comparison;
        for (presence, &pair) in comparison.truths[step.truths.clone()]
            .iter()
            .zip(&self.pair_of_truth)
        {
            let past = &mut self.pasts[presence.id as usize];
            let mut push = |kind, track, distance| {
                events.push(Event {
                    step: index,
                    kind,
                    truth: Some(presence.id),
                    track,
                    distance,
                })
            };
            let Some(&Pair {
                track, distance, ..
            }) = comparison.pairs.get(pair as usize)
            else {
                push(EventKind::Miss, None, None);
                if past.was_matched {
                    push(EventKind::Break, Some(past.track), None);
                }
                past.was_matched = false;
                continue;
            };
            let track = comparison.tracks[track as usize].id;
            push(EventKind::Match, Some(track), Some(distance));
            if past.track != NONE && past.track != track {
                push(EventKind::Switch, Some(track), Some(distance));
            }
            if past.track != NONE && !past.was_matched {
                push(EventKind::Reacquisition, Some(track), Some(distance));
            }
            *past = Past {
                track,
                round: self.round,
                was_matched: true,
            };
            self.followed[track as usize] = presence.id;
        }
    }

    fn tell_tracks(&mut self, index: u32, step: &ComparedStep, events: &mut Vec<Event>) {
        if !self.pair_of_track.contains(&NONE) {
            return;
        }
        self.look_around(step);
        for (offset, presence) in self.comparison.tracks[step.tracks.clone()]
            .iter()
            .enumerate()
        {
            if self.pair_of_track[offset] == NONE {
                let (kind, truth, distance) = self.unmatched(step, offset, presence.id);
                events.push(Event {
                    step: index,
                    kind,
                    truth,
                    track: Some(presence.id),
                    distance,
                });
            }
        }
    }

    /// Finds the nearest and the old truth of every track of the step.
    fn look_around(&mut self, step: &ComparedStep) {
        let comparison = self.comparison;
        restart(&mut self.nearest, step.tracks.len());
        restart(&mut self.old, step.tracks.len());
        for index in step.pairs.clone() {
            let pair = &comparison.pairs[index];
            let offset = pair.track as usize - step.tracks.start;
            if self.followed[comparison.tracks[pair.track as usize].id as usize]
                == comparison.truths[pair.truth as usize].id
            {
                self.old[offset] = index as u32;
            }
            let is_nearer = comparison
                .pairs
                .get(self.nearest[offset] as usize)
                .is_none_or(|other| pair.distance < other.distance);
            if pair.distance <= comparison.gate && is_nearer {
                self.nearest[offset] = index as u32;
            }
        }
    }

    /// What a track without a truth of its own is: kind, the truth it has to do with, their distance.
    fn unmatched(
        &self,
        step: &ComparedStep,
        offset: usize,
        track: u32,
    ) -> (EventKind, Option<u32>, Option<f64>) {
        let comparison = self.comparison;
        let pair = |index: u32| comparison.pairs.get(index as usize);
        if let Some(pair) = pair(self.nearest[offset]) {
            return (
                EventKind::Redundant,
                Some(comparison.truths[pair.truth as usize].id),
                Some(pair.distance),
            );
        }
        let followed = self.followed[track as usize];
        let truths = &comparison.truths[step.truths.clone()];
        if truths
            .binary_search_by_key(&followed, |presence| presence.id)
            .is_err()
        {
            return (EventKind::FalseAlarm, None, None);
        }
        (
            EventKind::Divergence,
            Some(followed),
            pair(self.old[offset]).map(|pair| pair.distance),
        )
    }
}

/// As many times "no pair".
fn restart(pairs: &mut Vec<u32>, length: usize) {
    pairs.clear();
    pairs.resize(length, NONE);
}
