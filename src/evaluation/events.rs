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
//!    [`EventKind::Switch`]; with the same track after missing steps, also a [`EventKind::Reacquisition`].
//! 2. An unmatched truth is a [`EventKind::Miss`]; when it was matched at its step before, also a [`EventKind::Break`].
//! 3. An unmatched track is exactly one of: [`EventKind::Redundant`] (a truth within its gate; it is matched to another),
//!    [`EventKind::Divergence`] (the truth that it last followed exists, outside the gate), [`EventKind::FalseAlarm`].

use super::comparison::{Comparison, Pair, Step};
use crate::math::assignment::AssignmentSolver;
use serde::Serialize;
use std::ops::Range;

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
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
        let mut log = EventLog::default();
        let mut matcher = Matcher::new(comparison);
        for index in 0..comparison.steps.len() {
            let first = log.events.len();
            matcher.step(index, &mut log.events);
            log.steps.push(first..log.events.len());
        }
        log
    }

    pub fn count(&self, kind: EventKind) -> usize {
        self.events.iter().filter(|event| event.kind == kind).count()
    }
}

/// Worth of keeping a pair, against similarities of at most 1.
const KEEP: f64 = 1000.0;

struct Matcher<'a> {
    comparison: &'a Comparison,
    solver: AssignmentSolver,
    /// For each truth: its track at the last step that had both truths and tracks, and the last that ever followed it.
    before: Vec<Option<u32>>,
    last: Vec<Option<u32>>,
    /// For each truth: whether it was matched when it last existed.
    was_matched: Vec<bool>,
    /// For each track: the truth that it last followed.
    followed: Vec<Option<u32>>,
    /// For each truth presence and each track presence of the step: the pair that it was matched by.
    pair_of_truth: Vec<Option<u32>>,
    pair_of_track: Vec<Option<u32>>,
}

impl<'a> Matcher<'a> {
    fn new(comparison: &'a Comparison) -> Self {
        let (truths, tracks) = (comparison.truth_ids.len(), comparison.track_ids.len());
        Matcher {
            comparison,
            solver: AssignmentSolver::default(),
            before: vec![None; truths],
            last: vec![None; truths],
            was_matched: vec![false; truths],
            followed: vec![None; tracks],
            pair_of_truth: Vec::new(),
            pair_of_track: Vec::new(),
        }
    }

    fn step(&mut self, index: usize, events: &mut Vec<Event>) {
        let comparison = self.comparison;
        let step = &comparison.steps[index];
        self.assign(step);
        if !step.truths.is_empty() && !step.tracks.is_empty() {
            self.before.fill(None);
        }
        let mut push = |kind, truth, track, distance| events.push(Event { step: index as u32, kind, truth, track, distance });
        for (offset, truth) in comparison.truths[step.truths.clone()].iter().enumerate() {
            let id = truth.id as usize;
            match self.pair_of_truth[offset] {
                Some(pair) => {
                    let Pair { track, distance, .. } = comparison.pairs[pair as usize];
                    let track = comparison.tracks[track as usize].id;
                    push(EventKind::Match, Some(truth.id), Some(track), Some(distance));
                    match self.last[id] {
                        Some(last) if last != track => push(EventKind::Switch, Some(truth.id), Some(track), Some(distance)),
                        Some(_) if !self.was_matched[id] => push(EventKind::Reacquisition, Some(truth.id), Some(track), Some(distance)),
                        _ => {}
                    }
                    (self.before[id], self.last[id]) = (Some(track), Some(track));
                    self.followed[track as usize] = Some(truth.id);
                }
                None => {
                    push(EventKind::Miss, Some(truth.id), None, None);
                    if self.was_matched[id] {
                        push(EventKind::Break, Some(truth.id), self.last[id], None);
                    }
                }
            }
            self.was_matched[id] = self.pair_of_truth[offset].is_some();
        }
        for (offset, track) in comparison.tracks[step.tracks.clone()].iter().enumerate() {
            if self.pair_of_track[offset].is_none() {
                let (kind, truth, distance) = self.unmatched(step, (step.tracks.start + offset) as u32, track.id);
                push(kind, truth, Some(track.id), distance);
            }
        }
    }

    /// Matches the truths of a step: row by row its matchable pairs, no partner at no worth.
    fn assign(&mut self, step: &Step) {
        let comparison = self.comparison;
        self.solver.clear();
        self.pair_of_truth.clear();
        self.pair_of_truth.resize(step.truths.len(), None);
        self.pair_of_track.clear();
        self.pair_of_track.resize(step.tracks.len(), None);
        let pairs = &comparison.pairs[step.pairs.clone()];
        let mut from = 0;
        let mut first_of_row = Vec::with_capacity(step.truths.len());
        for truth in step.truths.clone() {
            let until = from + pairs[from..].partition_point(|pair| pair.truth as usize == truth);
            first_of_row.push(from);
            let before = self.before[comparison.truths[truth].id as usize];
            for pair in &pairs[from..until] {
                let is_kept = before == Some(comparison.tracks[pair.track as usize].id);
                let worth = if pair.distance <= comparison.gate { pair.similarity + if is_kept { KEEP } else { 0.0 } } else { f64::NAN };
                self.solver.push_edge(pair.track - step.tracks.start as u32, -worth);
            }
            self.solver.end_row(0.0);
            from = until;
        }
        let is_solved = self.solver.solve().is_some();
        debug_assert!(is_solved, "an assignment in which everyone may stay alone exists");
        for (row, first) in first_of_row.into_iter().enumerate() {
            if let Some(edge) = self.solver.edge_of(row) {
                let pair = first + edge;
                self.pair_of_truth[row] = Some((step.pairs.start + pair) as u32);
                self.pair_of_track[pairs[pair].track as usize - step.tracks.start] = Some((step.pairs.start + pair) as u32);
            }
        }
    }

    /// What a track without a truth of its own is: kind, the truth it has to do with, their distance.
    fn unmatched(&self, step: &Step, presence: u32, track: u32) -> (EventKind, Option<u32>, Option<f64>) {
        let comparison = self.comparison;
        let of_track = || comparison.pairs[step.pairs.clone()].iter().filter(|pair| pair.track == presence);
        let nearest = of_track().filter(|pair| pair.distance <= comparison.gate).min_by(|a, b| a.distance.total_cmp(&b.distance));
        if let Some(pair) = nearest {
            return (EventKind::Redundant, Some(comparison.truths[pair.truth as usize].id), Some(pair.distance));
        }
        let followed = self.followed[track as usize];
        let is_there = |truth: u32| comparison.truths[step.truths.clone()].binary_search_by_key(&truth, |presence| presence.id).is_ok();
        match followed.filter(|&truth| is_there(truth)) {
            Some(truth) => {
                let pair = of_track().find(|pair| comparison.truths[pair.truth as usize].id == truth);
                (EventKind::Divergence, Some(truth), pair.map(|pair| pair.distance))
            }
            None => (EventKind::FalseAlarm, None, None),
        }
    }
}
