//! The walk along the log of events that makes the episodes.

use super::around::Around;
use super::loss::{self, Loss, Lost, Takings};
use super::taken::{Reader, Took};
use super::{Cause, Episode, Part, Seen};
use crate::evaluation::EvaluationInput;
use crate::evaluation::comparison::{ComparedStep, Comparison, Presence};
use crate::evaluation::credit::Credit;
use crate::evaluation::events::{Event, EventKind, EventLog};
use crate::model::watch::Watch;

/// What is remembered of a target.
#[derive(Debug, Clone, Copy, Default)]
struct OfTruth {
    /// The misses that go on.
    miss: Option<Episode>,
    seen: Seen,
    /// The last track that followed it, and the one before.
    follower: Option<u32>,
    before: Option<u32>,
    /// Why it was lost, while it is; and of the misses that ended at this step.
    loss: Option<Loss>,
    last_loss: Option<Loss>,
    unseen_scans: u32,
    is_covered: bool,
    /// The first track near it that was not known, of this miss.
    tentative: Option<u32>,
}

/// What is remembered of a track.
#[derive(Debug, Clone, Copy, Default)]
struct OfTrack {
    /// What goes on while it follows nobody.
    alone: Option<Episode>,
    takings: Takings,
    followed: Option<u32>,
}

struct Walk<'a> {
    comparison: &'a Comparison,
    log: &'a EventLog,
    around: Around<'a>,
    reader: Reader<'a>,
    truths: Vec<OfTruth>,
    tracks: Vec<OfTrack>,
    found: Vec<Episode>,
}

/// Every episode, by its first step, then in the order of the log. Without an input, as of boxes, only the log is read.
pub fn explain<'a>(
    comparison: &'a Comparison,
    log: &'a EventLog,
    input: Option<&EvaluationInput<'a>>,
    credit: Credit,
    watch: &Watch,
) -> Vec<Episode> {
    let mut walk = Walk {
        comparison,
        log,
        around: Around::new(comparison, input, credit),
        reader: Reader::new(comparison, input),
        truths: vec![OfTruth::default(); comparison.truth_ids.len()],
        tracks: vec![OfTrack::default(); comparison.track_ids.len()],
        found: Vec::new(),
    };
    for (index, step) in comparison.steps.iter().enumerate().take(log.steps.len()) {
        walk.enter(index, step);
        if watch.stops_after(8 * (step.truths.len() + step.tracks.len()) as u64) {
            break;
        }
    }
    walk.finish()
}

impl<'a> Walk<'a> {
    fn enter(&mut self, index: usize, step: &ComparedStep) {
        let (comparison, log) = (self.comparison, self.log);
        self.around.enter(index);
        let mut presences = comparison.truths[step.truths.clone()].iter();
        for event in &log.events[log.steps[index].clone()] {
            if let (EventKind::Match, Some(truth), Some(track)) =
                (event.kind, event.truth, event.track)
            {
                self.meet(truth, track);
            }
            let is_of_target = matches!(event.kind, EventKind::Match | EventKind::Miss);
            if is_of_target && let Some(presence) = presences.next() {
                self.look(presence);
            }
            match (event.kind, event.truth, event.track) {
                (EventKind::Miss, Some(truth), _) => self.miss(event, truth),
                (EventKind::Break, Some(truth), Some(track)) => self.lose(event, truth, track),
                (EventKind::Switch, Some(truth), Some(track)) => self.switch(event, truth, track),
                (kind, _, Some(track)) if is_of_track(kind) => self.be_alone(event, step, track),
                _ => {}
            }
        }
    }

    /// Whether the step sees a target, and who else is near it.
    fn look(&mut self, presence: &Presence) {
        let state = &mut self.truths[presence.id as usize];
        state.is_covered = true;
        if state.miss.is_none() {
            (state.seen, state.tentative) = Default::default();
        }
        state.tentative = state
            .tentative
            .or_else(|| self.around.tentative_at(&presence.position_m));
        if !self.around.has_scans() {
            return;
        }
        let is_seen = self.around.sees(&presence.position_m);
        state.unseen_scans = if is_seen { 0 } else { state.unseen_scans + 1 };
        if !self.around.has_scans_now() {
            return;
        }
        state.is_covered = is_seen || self.around.covers(&presence.position_m);
        state.seen.scans += 1;
        state.seen.seen += u32::from(is_seen);
        state.seen.covered += u32::from(state.is_covered);
    }

    fn meet(&mut self, truth: u32, track: u32) {
        self.end_alone(track);
        self.tracks[track as usize].followed = Some(truth);
        let state = &self.truths[truth as usize];
        let part = match state.follower {
            None => Part::Beginning,
            Some(_) => Part::Middle,
        };
        self.end_miss(truth, part);
        let state = &mut self.truths[truth as usize];
        state.before = state.follower.replace(track);
        state.last_loss = state.loss.take();
    }

    fn miss(&mut self, event: &Event, truth: u32) {
        let state = &mut self.truths[truth as usize];
        match &mut state.miss {
            Some(miss) => {
                miss.to_step = event.step;
                miss.steps += 1;
            }
            None => {
                let mut miss = Episode::new(EventKind::Miss, Cause::Unknown, event.step);
                miss.truth = Some(truth);
                state.miss = Some(miss);
            }
        }
    }

    fn lose(&mut self, event: &Event, truth: u32, track: u32) {
        let loss = self.loss(event, truth, track);
        self.truths[truth as usize].loss = Some(loss);
        self.found.push(Episode {
            truth: Some(truth),
            track: Some(track),
            other_truth: loss.other_truth,
            fate: Some(loss.fate),
            unseen_scans: loss.unseen_scans,
            taken: loss.taken,
            last_detection_time_s: loss.last_detection_time_s,
            ..Episode::new(EventKind::Break, loss.cause, event.step)
        });
    }

    /// The target was lost before, or its track lost it to the other one now.
    fn switch(&mut self, event: &Event, truth: u32, track: u32) {
        let state = &mut self.truths[truth as usize];
        let (Some(before), loss) = (state.before, state.last_loss.take()) else {
            return;
        };
        let loss = loss.unwrap_or_else(|| self.loss(event, truth, before));
        let events = &self.log.events[self.log.steps[event.step as usize].clone()];
        let is_beside = events.iter().any(|other| {
            (other.kind, other.truth, other.track)
                == (EventKind::Redundant, Some(truth), Some(before))
        });
        let cause = if is_beside {
            Cause::SecondTrack
        } else {
            loss.cause
        };
        self.found.push(Episode {
            truth: Some(truth),
            track: Some(track),
            other_truth: loss.other_truth.filter(|_| !is_beside),
            other_track: Some(before),
            unseen_scans: loss.unseen_scans,
            taken: if is_beside { 0 } else { loss.taken },
            last_detection_time_s: loss.last_detection_time_s,
            ..Episode::new(EventKind::Switch, cause, event.step)
        });
    }

    fn loss(&mut self, event: &Event, truth: u32, track: u32) -> Loss {
        let state = &self.truths[truth as usize];
        let lost = Lost {
            truth,
            track,
            step: event.step as usize,
            unseen_scans: self.around.has_scans().then_some(state.unseen_scans),
            is_covered: state.is_covered,
        };
        loss::explain(
            self.comparison,
            self.log,
            &self.around,
            &mut self.reader,
            lost,
        )
    }

    /// A track that follows nobody.
    fn be_alone(&mut self, event: &Event, step: &ComparedStep, track: u32) {
        let goes_on =
            |episode: &Episode| (episode.event, episode.truth) == (event.kind, event.truth);
        if !self.tracks[track as usize]
            .alone
            .as_ref()
            .is_some_and(goes_on)
        {
            self.end_alone(track);
        }
        let took = self.took(event.step as usize, step, track);
        let follower = event
            .truth
            .and_then(|truth| self.truths[truth as usize].follower);
        let state = &mut self.tracks[track as usize];
        state.takings.add(took);
        match &mut state.alone {
            Some(alone) => {
                alone.to_step = event.step;
                alone.steps += 1;
            }
            None => {
                state.alone = Some(Episode {
                    truth: event.truth,
                    track: Some(track),
                    other_track: follower.filter(|_| event.kind == EventKind::Redundant),
                    ..Episode::new(event.kind, Cause::Unknown, event.step)
                });
            }
        }
    }

    fn took(&mut self, index: usize, step: &ComparedStep, track: u32) -> Took {
        let presences = &self.comparison.tracks[step.tracks.clone()];
        let place = presences.binary_search_by_key(&track, |presence| presence.id);
        let point = place.ok().map(|place| presences[place].point as usize);
        match point.and_then(|point| self.reader.points(track).get(point)) {
            Some(point) => self.reader.took(point, index, &self.around),
            None => Took::Unknown,
        }
    }

    fn end_alone(&mut self, track: u32) {
        let state = &mut self.tracks[track as usize];
        let takings = std::mem::take(&mut state.takings);
        let Some(alone) = state.alone.take() else {
            return;
        };
        let Takings {
            other,
            of_others,
            of_nobody,
            nothing,
        } = takings;
        let (cause, taken) = if alone.event == EventKind::Redundant {
            (Cause::SecondTrack, 0)
        } else if alone.event == EventKind::FalseAlarm && state.followed.is_some() {
            (Cause::TargetGone, of_nobody)
        } else if of_others > 0 && of_others >= of_nobody && other != alone.truth {
            (Cause::TookTarget, of_others)
        } else if of_nobody > 0 {
            (Cause::TookClutter, of_nobody)
        } else if nothing > 0 {
            (Cause::NoDetection, nothing)
        } else if alone.event == EventKind::Divergence {
            (Cause::LeftGate, 0)
        } else {
            (Cause::Unknown, 0)
        };
        self.found.push(Episode {
            cause,
            taken,
            truth: match cause {
                Cause::TargetGone => state.followed,
                _ => alone.truth,
            },
            other_truth: other.filter(|_| cause == Cause::TookTarget),
            ..alone
        });
    }

    fn end_miss(&mut self, truth: u32, part: Part) {
        let has_scans = self.around.has_scans();
        let state = &mut self.truths[truth as usize];
        let Some(miss) = state.miss.take() else {
            return;
        };
        let Seen {
            scans,
            seen,
            covered,
        } = state.seen;
        let loss = state.loss;
        let cause = match (loss, state.tentative) {
            _ if scans > 0 && covered == 0 => Cause::OutsideCoverage,
            (Some(loss), _) => loss.cause,
            (None, Some(_)) => Cause::NotConfirmed,
            (None, None) if scans > 0 && seen == 0 => Cause::NoDetection,
            (None, None) => Cause::NoTrack,
        };
        let of_loss = loss.filter(|_| cause != Cause::OutsideCoverage);
        let tentative = state.tentative.filter(|_| cause == Cause::NotConfirmed);
        self.found.push(Episode {
            cause,
            part: Some(part),
            track: of_loss.map(|loss| loss.track).or(tentative),
            other_truth: of_loss.and_then(|loss| loss.other_truth),
            seen: has_scans.then_some(state.seen),
            unseen_scans: of_loss.and_then(|loss| loss.unseen_scans),
            taken: of_loss.map_or(0, |loss| loss.taken),
            last_detection_time_s: of_loss.and_then(|loss| loss.last_detection_time_s),
            ..miss
        });
    }

    fn finish(mut self) -> Vec<Episode> {
        for truth in 0..self.truths.len() {
            let part = match self.truths[truth].follower {
                None => Part::Whole,
                Some(_) => Part::End,
            };
            self.end_miss(truth as u32, part);
        }
        for track in 0..self.tracks.len() {
            self.end_alone(track as u32);
        }
        self.found.sort_by_key(|episode| {
            let is_of_track = is_of_track(episode.event);
            let whose = if is_of_track {
                episode.track
            } else {
                episode.truth
            };
            (episode.from_step, is_of_track, whose, episode.event)
        });
        self.found
    }
}

/// Whether an event is of a track that follows nobody.
fn is_of_track(kind: EventKind) -> bool {
    matches!(
        kind,
        EventKind::FalseAlarm | EventKind::Redundant | EventKind::Divergence
    )
}
