//! Which target each update is of.
//!
//! # Method
//! Update by update, in the order of time of each track:
//! 1. the target of its identity (the address, else callsign and Mode A), if that is within the gate;
//! 2. else the target of the track's last update, if that is within the gate;
//! 3. else the nearest target within the gate;
//! 4. else, far from everybody, the target of the track's last update, of its next one, or of the identity of the track.
//!
//! A track of which no update finds a target is false.

use super::reference::reference_at;
use super::settings::{Code, Pairing, Settings};
use super::words::{Words, normal};
use crate::model::state::Position;
use crate::model::track::{Track, TrackPoint, TrackStatus};
use crate::model::truth::Target;
use crate::model::watch::Watch;
use serde::Serialize;
use std::collections::BTreeMap;

/// Of one point of a track.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Paired {
    /// Not known at the time, or only predicted.
    NoUpdate,
    Nobody,
    Target(u32),
}

/// How updates found their targets.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema), schema(as = PairedUpdates))]
pub struct PairedUpdates {
    pub by_identity: u64,
    /// Within the gate.
    pub by_place: u64,
    /// Beyond the gate of every target: by the rest of their track.
    pub by_track: u64,
    pub nobody: u64,
}

/// Point by point of each track.
pub struct Pairs {
    pub of: Vec<Vec<Paired>>,
    /// Of each track; `None` of one that is of no target.
    pub spans: Vec<Option<TargetSpan>>,
    pub updates: PairedUpdates,
}

/// When a track is on which targets.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TargetSpan {
    first: (u32, f64),
    /// The first and the last time on any other target than the first and the last one.
    first_other_s: Option<f64>,
    last: (u32, f64),
    last_other_s: Option<f64>,
}

impl TargetSpan {
    fn of(track: &Track, pairs: &[Paired]) -> Option<Self> {
        let points = track.points.iter().zip(pairs);
        let on_targets = points.filter_map(|(point, paired)| match paired {
            Paired::Target(target) => Some((*target, point.time_s)),
            _ => None,
        });
        let mut span: Option<TargetSpan> = None;
        for (target, time_s) in on_targets {
            let now = (target, time_s);
            let span = span.get_or_insert(TargetSpan {
                first: now,
                first_other_s: None,
                last: now,
                last_other_s: None,
            });
            if target != span.first.0 {
                span.first_other_s.get_or_insert(time_s);
            }
            if target != span.last.0 {
                span.last_other_s = Some(span.last.1);
            }
            span.last = now;
        }
        span
    }

    /// The first time on another target than this one.
    pub fn first_elsewhere_s(&self, target: u32) -> Option<f64> {
        if self.first.0 == target {
            self.first_other_s
        } else {
            Some(self.first.1)
        }
    }

    /// The last time on another target than this one.
    pub fn last_elsewhere_s(&self, target: u32) -> Option<f64> {
        if self.last.0 == target {
            self.last_other_s
        } else {
            Some(self.last.1)
        }
    }
}

/// Finds the targets of all updates.
pub fn pair(words: Words, settings: &Settings, watch: &Watch) -> Pairs {
    let finder = Finder::new(words, settings);
    let mut pairs = Pairs {
        of: Vec::with_capacity(words.tracks.tracks.len()),
        spans: Vec::with_capacity(words.tracks.tracks.len()),
        updates: PairedUpdates::default(),
    };
    for track in &words.tracks.tracks {
        // Without a target a track has no pairs; the caller says that it was stopped.
        let of_track = if watch.stops_after(track.points.len() as u64) {
            Vec::new()
        } else {
            finder.pair_track(track, &mut pairs.updates)
        };
        pairs.spans.push(TargetSpan::of(track, &of_track));
        pairs.of.push(of_track);
    }
    pairs
}

struct Finder<'a> {
    words: Words<'a>,
    settings: &'a Settings,
    /// From when to when each target is known, and the box around it and its gate.
    spans: Vec<Span>,
    /// Targets by what they call themselves.
    named: BTreeMap<(&'static str, String), Vec<u32>>,
}

struct Span {
    times_s: (f64, f64),
    low: Position,
    high: Position,
}

impl Span {
    fn of(target: &Target, gate_m: f64) -> Self {
        let mut low = Position::repeat(f64::INFINITY);
        let mut high = -low;
        let mut times_s = (f64::INFINITY, f64::NEG_INFINITY);
        for point in &target.points {
            let place = point.position.xy();
            (low, high) = (low.inf(&place), high.sup(&place));
            times_s = (times_s.0.min(point.time_s), times_s.1.max(point.time_s));
        }
        let margin = Position::repeat(gate_m);
        Span {
            times_s,
            low: low - margin,
            high: high + margin,
        }
    }

    fn may_hold(&self, time_s: f64, place: &Position) -> bool {
        time_s >= self.times_s.0
            && time_s <= self.times_s.1
            && *place >= self.low
            && *place <= self.high
    }
}

impl<'a> Finder<'a> {
    fn new(words: Words<'a>, settings: &'a Settings) -> Self {
        let targets = words.truth.targets();
        let mut named: BTreeMap<(&'static str, String), Vec<u32>> = BTreeMap::new();
        for (number, target) in targets.iter().enumerate() {
            for code in [Code::Address, Code::Callsign] {
                let truth = words.truth;
                let said =
                    truth
                        .changes
                        .words(&truth.attributes, &target.truth_id, code.attribute());
                for word in said {
                    let key = (code.attribute(), normal(code, word));
                    let known = named.entry(key).or_default();
                    if known.last() != Some(&(number as u32)) {
                        known.push(number as u32);
                    }
                }
            }
        }
        Finder {
            words,
            settings,
            spans: targets
                .iter()
                .map(|target| Span::of(target, settings.gate_m))
                .collect(),
            named,
        }
    }

    fn pair_track(&self, track: &Track, updates: &mut PairedUpdates) -> Vec<Paired> {
        let mut pairs = Vec::with_capacity(track.points.len());
        let mut last = None;
        for point in &track.points {
            if !self.is_update(point) {
                pairs.push(Paired::NoUpdate);
                continue;
            }
            let found = match self.by_identity(track, point) {
                Some(target) => {
                    updates.by_identity += 1;
                    Some(target)
                }
                None => {
                    let found = self.by_place(point, last);
                    updates.by_place += u64::from(found.is_some());
                    found
                }
            };
            last = found.or(last);
            pairs.push(found.map_or(Paired::Nobody, Paired::Target));
        }
        self.carry(track, &mut pairs, updates);
        pairs
    }

    fn is_update(&self, point: &TrackPoint) -> bool {
        let is_coasted = point.status == Some(TrackStatus::Coasted);
        self.settings.credit.counts(point) && (self.settings.counts_coasted || !is_coasted)
    }

    /// Gives what is nobody's to the target of the update before, of the one after, or of the identity of the track.
    fn carry(&self, track: &Track, pairs: &mut [Paired], updates: &mut PairedUpdates) {
        let targets = pairs.iter().find_map(|paired| match paired {
            Paired::Target(target) => Some(*target),
            _ => None,
        });
        let mut near = targets.or_else(|| self.usual_identity(track));
        for paired in pairs.iter_mut() {
            match (*paired, near) {
                (Paired::Target(target), _) => near = Some(target),
                (Paired::Nobody, Some(target)) => {
                    updates.by_track += 1;
                    *paired = Paired::Target(target);
                }
                (Paired::Nobody, None) => updates.nobody += 1,
                (Paired::NoUpdate, _) => {}
            }
        }
    }

    fn distance_m(&self, target: u32, point: &TrackPoint) -> Option<f64> {
        let reach_s = self.settings.reference_reach_s;
        let reference = reference_at(self.words.truth, target as usize, point.time_s, reach_s)?;
        let distance_m = (reference.place.xy() - point.estimate.position.xy()).norm();
        (distance_m <= self.settings.gate_m).then_some(distance_m)
    }

    fn by_identity(&self, track: &Track, point: &TrackPoint) -> Option<u32> {
        if self.settings.pairing == Pairing::Nearest || self.named.is_empty() {
            return None;
        }
        let named = self.named_by(track, point.time_s);
        self.nearest(named.iter().copied(), point)
    }

    /// Targets that have the address, else the callsign and the Mode A code, that a track says at a time.
    fn named_by(&self, track: &Track, time_s: f64) -> Vec<u32> {
        let word = |code| self.words.of_track(&track.track_id, time_s, code);
        let by_address = word(Code::Address).map(|word| self.called(Code::Address, word));
        if let Some(targets) = by_address.filter(|targets| !targets.is_empty()) {
            return targets.to_vec();
        }
        let (Some(callsign), Some(mode_a)) = (word(Code::Callsign), word(Code::ModeA)) else {
            return Vec::new();
        };
        let mut targets = self.called(Code::Callsign, callsign).to_vec();
        targets.retain(|target| self.has_mode_a(*target, mode_a));
        targets
    }

    /// Targets that have a code of their own so.
    fn called(&self, code: Code, word: &str) -> &[u32] {
        let key = (code.attribute(), normal(code, word));
        self.named.get(&key).map(Vec::as_slice).unwrap_or_default()
    }

    fn has_mode_a(&self, target: u32, mode_a: &str) -> bool {
        let truth = self.words.truth;
        let truth_id = &truth.targets()[target as usize].truth_id;
        let name = Code::ModeA.attribute();
        let wanted = normal(Code::ModeA, mode_a);
        let said = truth.changes.words(&truth.attributes, truth_id, name);
        said.into_iter()
            .any(|word| normal(Code::ModeA, word) == wanted)
    }

    fn by_place(&self, point: &TrackPoint, last: Option<u32>) -> Option<u32> {
        if let Some(last) = last
            && self.distance_m(last, point).is_some()
        {
            return Some(last);
        }
        let place = point.estimate.position.xy();
        let spans = self.spans.iter().enumerate();
        let may_hold = spans.filter(|(_, span)| span.may_hold(point.time_s, &place));
        self.nearest(may_hold.map(|(target, _)| target as u32), point)
    }

    fn nearest(&self, targets: impl Iterator<Item = u32>, point: &TrackPoint) -> Option<u32> {
        let near = targets.filter_map(|target| Some((self.distance_m(target, point)?, target)));
        near.min_by(|one, other| one.0.total_cmp(&other.0))
            .map(|(_, target)| target)
    }

    /// The target that most updates of a track name, the first of several.
    fn usual_identity(&self, track: &Track) -> Option<u32> {
        if self.settings.pairing == Pairing::Nearest || self.named.is_empty() {
            return None;
        }
        let mut counts: BTreeMap<u32, usize> = BTreeMap::new();
        for point in track.points.iter().filter(|point| self.is_update(point)) {
            if let Some(target) = self.named_by(track, point.time_s).first() {
                *counts.entry(*target).or_default() += 1;
            }
        }
        let most = counts.values().copied().max()?;
        counts
            .into_iter()
            .find(|(_, count)| *count == most)
            .map(|(target, _)| target)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluation::tests::tracks_of;

    #[test]
    fn a_span_knows_the_first_and_the_last_time_elsewhere() {
        let tracks = tracks_of(&[("T", &[0.0; 6])]);
        let on = |targets: [u32; 6]| {
            let pairs = targets.map(|target| match target {
                9 => Paired::Nobody,
                target => Paired::Target(target),
            });
            TargetSpan::of(&tracks.tracks[0], &pairs)
        };
        let span = on([0, 0, 1, 2, 0, 0]).unwrap();
        let elsewhere = |target| {
            (
                span.first_elsewhere_s(target),
                span.last_elsewhere_s(target),
            )
        };
        assert_eq!(elsewhere(0), (Some(2.0), Some(3.0)));
        assert_eq!(elsewhere(1), (Some(0.0), Some(5.0)));
        let alone = on([9, 1, 1, 1, 9, 1]).unwrap();
        assert_eq!(alone.first_elsewhere_s(1), None);
        assert_eq!(alone.last_elsewhere_s(1), None);
        assert_eq!(on([9; 6]), None);
    }
}
